//! Recording an object's calls.

use std::path::Path;

use crate::{CullingResult, DrawOptions, Error, MaskedOcclusionCulling, RecordingError, Vertices};

impl MaskedOcclusionCulling {
    /// Starts recording clears, draws and queries to a file, for [`Recording`](crate::Recording) and for Intel MOC's
    /// own player.
    ///
    /// The file stores a single near plane and resolution: changing either ends it, once it contains a call. Start
    /// before the clear of a frame, so that the recording begins with an empty buffer. Merges and binned lists are not
    /// recorded; see [`Self::record_render_triangles`].
    ///
    /// # Errors
    /// [`RecordingError::Busy`] if it is already recording; [`RecordingError::File`].
    pub fn recorder_start(&self, path: impl AsRef<Path>) -> Result<(), RecordingError> {
        self.recorder.start(path.as_ref(), (self.near_clip_plane(), self.resolution()))
    }

    /// Ends the recording, if there is one; so does dropping the object.
    ///
    /// # Errors
    /// [`RecordingError::File`] if a write failed, now or earlier. The file is then truncated.
    pub fn recorder_stop(&self) -> Result<(), RecordingError> {
        self.recorder.stop()
    }

    /// Records a draw that does not go through [`Self::render_triangles`], such as that of a binned mesh. Has no effect
    /// without a recording.
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
