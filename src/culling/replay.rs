//! Replays a recording by repeating its calls.

use crate::{CullingResult, Error, MaskedOcclusionCulling, RecordedCall, RecordedRect, Recording};

impl RecordedCall {
    /// Repeats the call. Returns the answer of a draw or a query.
    ///
    /// # Errors
    /// Those of [`MaskedOcclusionCulling::render_triangles`], but never for a loaded call.
    pub fn play(&self, moc: &mut MaskedOcclusionCulling) -> Result<Option<CullingResult>, Error> {
        match self {
            Self::ClearBuffer => {
                moc.clear_buffer();
                Ok(None)
            }
            &Self::TestRect(RecordedRect { edges: [x_min, y_min, x_max, y_max], w_min, .. }) => {
                Ok(Some(moc.test_rect(x_min, y_min, x_max, y_max, w_min)))
            }
            Self::RenderTriangles(mesh) => {
                moc.render_triangles(mesh.vertices()?, &mesh.triangles, &mesh.options).map(Some)
            }
            Self::TestTriangles(mesh) => moc.test_triangles(mesh.vertices()?, &mesh.triangles, &mesh.options).map(Some),
        }
    }

    /// The recorded answer, if there is one.
    pub fn result(&self) -> Option<CullingResult> {
        match self {
            Self::ClearBuffer => None,
            Self::TestRect(rect) => rect.result,
            Self::RenderTriangles(mesh) | Self::TestTriangles(mesh) => mesh.result,
        }
    }
}

impl Recording {
    /// Gives an object the recording's near plane and resolution, clears it, and repeats all calls. `answered` receives
    /// each call and its answer.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`]; for a recording that was not loaded, also those of the calls.
    pub fn play(
        &self,
        moc: &mut MaskedOcclusionCulling,
        mut answered: impl FnMut(&RecordedCall, Option<CullingResult>),
    ) -> Result<(), Error> {
        moc.set_resolution(self.resolution.0, self.resolution.1)?;
        moc.set_near_clip_plane(self.near_clip_plane)?;
        for call in &self.calls {
            let answer = call.play(moc)?;
            answered(call, answer);
        }
        Ok(())
    }
}
