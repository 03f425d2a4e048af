//! The frame recorder: what an object was told and what it answered, in a file, to be played again.
//!
//! ```text
//! write.rs   calls ──> file      while an object records
//! load.rs    file ──> Recording  checked: a file is somebody else's
//! play.rs    Recording ──> an object, and its answers
//! format.rs  the bytes of both
//! ```
//!
//! Recorded are clears, draws and queries, those through a thread pool included; merges and binned lists are not. Of
//! the vertices the coordinates are written, and zeros for whatever lies between them.

mod error;
mod format;
mod load;
mod play;
mod write;

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::pipeline::Mesh;
use crate::{CullingResult, DrawOptions, MaskedOcclusionCulling, Vertices};
pub use error::RecordingError;
use format::{RENDER_TRIANGLES, TEST_TRIANGLES};
pub use load::{RecordedCall, RecordedMesh, RecordedRect, Recording};
use write::Writer;

/// The recorder of an object.
#[derive(Default)]
pub(crate) struct Recorder {
    /// Whether there is a file. All that a call costs while there is none.
    on: AtomicBool,
    state: Mutex<State>,
}

/// What a file begins with: near plane, and width and height.
type Header = (f32, (u32, u32));

#[derive(Default)]
struct State {
    file: Option<Writer<BufWriter<File>>>,
    /// The header, until something follows it.
    header: Option<Header>,
    /// Why nothing more was written.
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
                // Nothing of the call was written: what came before stays whole.
                let _ = state.end();
            }
            // Half an entry is worth nothing, and so is what follows it.
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

    /// # Safety
    /// Every vertex from the lowest to the highest index can be read.
    #[inline(always)]
    pub unsafe fn render_triangles(&self, result: Option<CullingResult>, mesh: &Mesh<'_>) {
        if self.is_on() {
            // SAFETY: the caller's contract.
            self.record(|file| unsafe { file.triangles(RENDER_TRIANGLES, result, mesh) });
        }
    }

    /// # Safety
    /// Every vertex from the lowest to the highest index can be read.
    #[inline(always)]
    pub unsafe fn test_triangles(&self, result: Option<CullingResult>, mesh: &Mesh<'_>) {
        if self.is_on() {
            // SAFETY: the caller's contract.
            self.record(|file| unsafe { file.triangles(TEST_TRIANGLES, result, mesh) });
        }
    }

    fn start(&self, path: &Path, header: Header) -> Result<(), RecordingError> {
        let mut state = self.lock();
        if state.file.is_some() {
            return Err(RecordingError::Busy);
        }
        let file = Writer::new(BufWriter::new(File::create(path)?));
        *state = State { file: Some(file), header: Some(header), failed: None };
        self.on.store(true, Relaxed);
        Ok(())
    }

    /// Ends the file. Nothing to do where there is none.
    pub fn stop(&self) -> Result<(), RecordingError> {
        let mut state = self.lock();
        self.on.store(false, Relaxed);
        if let Some(error) = state.failed.take() {
            return Err(error.into());
        }
        Ok(state.end()?)
    }

    /// The object's near plane or resolution is another one from now on. That ends a file whose header says otherwise.
    pub fn changed(&self, near: f32, resolution: Option<(u32, u32)>) {
        if self.is_on() {
            let mut state = self.lock();
            if let (Some(header), Some(resolution)) = (&mut state.header, resolution) {
                *header = (near, resolution);
                return;
            }
            self.on.store(false, Relaxed);
            // An error stays for who stops.
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
        // The header of a recording of nothing.
        let written = self.write(|_| Ok(()));
        let ended = self.file.take().map_or(Ok(()), Writer::end);
        written.and(ended)
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // Nobody is there any more to be told.
        let _ = self.stop();
    }
}

impl MaskedOcclusionCulling {
    /// Records clears, draws and queries into a file from now on, for [`Recording`] and for the player of the library
    /// that this one stands in for.
    ///
    /// The file names one near plane and one resolution: setting another of either ends it, once it holds a call.
    /// Start before the clear of a frame, so that the recording begins with an empty buffer. Merges and binned lists are not
    /// recorded; see [`Self::record_render_triangles`].
    ///
    /// # Errors
    /// [`RecordingError::Busy`] while it records already; [`RecordingError::File`].
    pub fn recorder_start(&self, path: impl AsRef<Path>) -> Result<(), RecordingError> {
        self.recorder().start(path.as_ref(), (self.near_clip_plane(), self.resolution()))
    }

    /// Ends the recording. Nothing happens where there is none; an object that is dropped ends its recording, too.
    ///
    /// # Errors
    /// [`RecordingError::File`] where something could not be written, now or before. The file is then cut.
    pub fn recorder_stop(&self) -> Result<(), RecordingError> {
        self.recorder().stop()
    }

    /// Records a draw that the object is not told of by [`Self::render_triangles`], such as that of a binned mesh. Without a
    /// recording nothing happens.
    ///
    /// # Errors
    /// As [`Self::render_triangles`]; nothing is recorded.
    pub fn record_render_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
        result: Option<CullingResult>,
    ) -> Result<(), crate::Error> {
        self.check_mesh(&vertices, triangles)?;
        // SAFETY: `check_mesh` saw that every index names a vertex of the slice.
        unsafe { self.recorder().render_triangles(result, &Mesh::new(&vertices, triangles, options)) };
        Ok(())
    }
}
