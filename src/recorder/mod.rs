//! The frame recorder: writes an object's calls and its answers to a file, for replay.
//!
//! ```text
//! write.rs   calls ──> file      while an object records
//! load.rs    file ──> Recording  checked, since the file may come from anywhere
//! (`culling/replay.rs` plays a Recording on an object and compares its answers.)
//! format.rs  the bytes of both
//! ```
//!
//! Clears, draws and queries are recorded, including those through a thread pool; merges and binned lists are not. Of
//! the vertices, the coordinates are written, with zeros for anything between them.

mod error;
mod format;
mod load;
mod write;

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::CullingResult;
use crate::source::Mesh;
pub use error::RecordingError;
use format::{RENDER_TRIANGLES, TEST_TRIANGLES};
pub use load::{RecordedCall, RecordedMesh, RecordedRect, Recording};
use write::Writer;

/// The recorder of an object.
#[derive(Default)]
pub(crate) struct Recorder {
    /// Whether there is a file; this flag is the only cost of a call while there is none.
    on: AtomicBool,
    state: Mutex<State>,
}

/// The beginning of a file: near plane, and width and height.
type Header = (f32, (u32, u32));

#[derive(Default)]
struct State {
    file: Option<Writer<BufWriter<File>>>,
    /// The header, until something is written after it.
    header: Option<Header>,
    /// The error that stopped the recording.
    failed: Option<io::Error>,
}

impl Recorder {
    #[inline(always)]
    pub fn is_on(&self) -> bool {
        self.on.load(Relaxed)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a call, if there still is a file.
    #[cold]
    #[inline(never)]
    fn record(&self, write: impl FnOnce(&mut Writer<BufWriter<File>>) -> io::Result<()>) {
        let mut state = self.lock();
        if let Err(error) = state.write(write) {
            if error.kind() == io::ErrorKind::InvalidInput {
                // Nothing of the call was written, so what came before is intact.
                let _ = state.end();
            }
            // A partial entry is useless, and so is anything after it.
            state.file = None;
            state.failed.get_or_insert(error);
            self.on.store(false, Relaxed);
        }
    }

    #[inline(always)]
    pub fn clear_buffer(&self) {
        if self.is_on() {
            self.record(|file| file.clear_buffer());
        }
    }

    #[inline(always)]
    pub fn test_rect(&self, result: Option<CullingResult>, edges: [f32; 4], w_min: f32) {
        if self.is_on() {
            self.record(|file| file.test_rect(result, edges, w_min));
        }
    }

    #[inline(always)]
    pub fn render_triangles(&self, result: Option<CullingResult>, mesh: &Mesh<'_>) {
        if self.is_on() {
            self.record(|file| file.triangles(RENDER_TRIANGLES, result, mesh));
        }
    }

    #[inline(always)]
    pub fn test_triangles(&self, result: Option<CullingResult>, mesh: &Mesh<'_>) {
        if self.is_on() {
            self.record(|file| file.triangles(TEST_TRIANGLES, result, mesh));
        }
    }

    pub fn start(&self, path: &Path, header: Header) -> Result<(), RecordingError> {
        let mut state = self.lock();
        if state.file.is_some() {
            return Err(RecordingError::Busy);
        }
        let file = Writer::new(BufWriter::new(File::create(path)?));
        *state = State { file: Some(file), header: Some(header), failed: None };
        self.on.store(true, Relaxed);
        Ok(())
    }

    /// Ends the file, if there is one.
    pub fn stop(&self) -> Result<(), RecordingError> {
        let mut state = self.lock();
        self.on.store(false, Relaxed);
        if let Some(error) = state.failed.take() {
            return Err(error.into());
        }
        Ok(state.end()?)
    }

    /// Tells the recorder that the object's near plane or resolution changed. That ends a file whose header differs.
    pub fn changed(&self, near: f32, resolution: Option<(u32, u32)>) {
        if self.is_on() {
            let mut state = self.lock();
            if let (Some(header), Some(resolution)) = (&mut state.header, resolution) {
                *header = (near, resolution);
                return;
            }
            self.on.store(false, Relaxed);
            // The error is kept and reported by `stop`.
            if let Err(error) = state.end() {
                state.failed.get_or_insert(error);
            }
        }
    }
}

impl State {
    /// Writes to the file, if there is one.
    fn write(&mut self, write: impl FnOnce(&mut Writer<BufWriter<File>>) -> io::Result<()>) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        if let Some((near, resolution)) = self.header.take() {
            file.header(near, resolution)?;
        }
        write(file)
    }

    fn end(&mut self) -> io::Result<()> {
        // The header of an empty recording.
        let written = self.write(|_| Ok(()));
        let ended = self.file.take().map_or(Ok(()), Writer::end);
        written.and(ended)
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // There is nobody left to report an error to.
        let _ = self.stop();
    }
}
