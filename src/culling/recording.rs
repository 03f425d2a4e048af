//! Recording what an object is told.

use std::path::Path;

use crate::{CullingResult, DrawOptions, Error, MaskedOcclusionCulling, RecordingError, Vertices};

impl MaskedOcclusionCulling {
    /// Records clears, draws and queries into a file from now on, for [`Recording`](crate::Recording) and for Intel MOC's own
    /// player.
    ///
    /// The file names one near plane and one resolution: setting another of either ends it, once it holds a call.
    /// Start before the clear of a frame, so that the recording begins with an empty buffer. Merges and binned lists are not
    /// recorded; see [`Self::record_render_triangles`].
    ///
    /// # Errors
    /// [`RecordingError::Busy`] while it records already; [`RecordingError::File`].
    pub fn recorder_start(&self, path: impl AsRef<Path>) -> Result<(), RecordingError> {
        self.recorder.start(path.as_ref(), (self.near_clip_plane(), self.resolution()))
    }

    /// Ends the recording. Nothing happens where there is none; an object that is dropped ends its recording, too.
    ///
    /// # Errors
    /// [`RecordingError::File`] where something could not be written, now or before. The file is then cut.
    pub fn recorder_stop(&self) -> Result<(), RecordingError> {
        self.recorder.stop()
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
    ) -> Result<(), Error> {
        self.recorder.render_triangles(result, &self.mesh(&vertices, triangles, options)?);
        Ok(())
    }
}
