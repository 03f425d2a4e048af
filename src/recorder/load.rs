//! Loads recordings. Every count is checked against the remaining size of the file before anything is allocated.

use std::path::Path;

use super::error::RecordingError;
use super::format::{CLEAR_BUFFER, END, RENDER_TRIANGLES, SIGNATURE, TEST_RECT, TEST_TRIANGLES, UNKNOWN};
use crate::allocator::{try_box, try_collect};
use crate::buffer::MAX_SIZE;
use crate::vertices::vertex_count;
use crate::{
    BackfaceWinding, ClipPlanes, ClipSpaceLayout, CullingResult, DrawOptions, Error, Matrix, VertexLayout, VertexSpace,
    Vertices,
};

/// One or more recorded frames.
///
/// ```
/// use masked_occlusion_culling::{CullingResult, DrawOptions, MaskedOcclusionCulling, Recording, Settings, Vertices};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("frame.mocrec");
/// let mut culling = MaskedOcclusionCulling::new(640, 360, Settings::default())?;
/// culling.recorder_start(&path)?;
/// culling.clear_buffer();
/// let wall = [[-10.0, -10.0, 0.0, 10.0], [30.0, -10.0, 0.0, 10.0], [-10.0, 30.0, 0.0, 10.0]];
/// culling.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default())?;
/// culling.test_rect(-0.5, -0.5, 0.0, 0.0, 12.0);
/// culling.recorder_stop()?;
///
/// let recording = Recording::load(&path)?;
/// assert_eq!(recording.calls[2].result(), Some(CullingResult::Occluded));
/// let mut again = MaskedOcclusionCulling::new(640, 360, Settings::default())?;
/// recording.play(&mut again, |call, answer| assert_eq!(answer, call.result()))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Recording {
    /// The near plane, in clip-space w.
    pub near_clip_plane: f32,
    /// Width and height in pixels.
    pub resolution: (u32, u32),
    /// The calls, in order.
    pub calls: Vec<RecordedCall>,
}

/// A recorded call.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordedCall {
    /// The buffer was cleared.
    ClearBuffer,
    /// A rectangle was tested.
    TestRect(RecordedRect),
    /// Occluders were drawn.
    RenderTriangles(Box<RecordedMesh>),
    /// Occludees were tested.
    TestTriangles(Box<RecordedMesh>),
}

/// A tested rectangle and its result.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecordedRect {
    /// The result, if known.
    pub result: Option<CullingResult>,
    /// `x_min`, `y_min`, `x_max`, `y_max` in normalised device coordinates.
    pub edges: [f32; 4],
    /// The nearest point's clip-space w.
    pub w_min: f32,
}

/// Drawn or tested triangles and their result.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecordedMesh {
    /// The result, if known.
    pub result: Option<CullingResult>,
    /// The vertices, in words that the layout interprets.
    pub vertices: Vec<f32>,
    /// Their space: the position of the coordinates within a vertex, and the matrix, if there is one.
    pub space: VertexSpace,
    /// Three vertex indices per triangle.
    pub triangles: Vec<u32>,
    /// Winding and clip planes.
    pub options: DrawOptions,
}

impl RecordedMesh {
    /// The vertices in the form that a draw takes.
    ///
    /// # Errors
    /// [`Error::InvalidLayout`], but never for a loaded recording.
    pub fn vertices(&self) -> Result<Vertices<'_>, Error> {
        Vertices::new(&self.vertices, self.space)
    }
}

impl Recording {
    /// Reads a file.
    ///
    /// # Errors
    /// [`RecordingError::File`]; [`RecordingError::OutOfMemory`]; [`RecordingError::Invalid`] for a file that is empty,
    /// truncated, or not a recording.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        Self::from_bytes(&std::fs::read(path)?)
    }

    /// Reads the bytes of a file. Anything after the end marker is ignored.
    ///
    /// # Errors
    /// [`RecordingError::OutOfMemory`], [`RecordingError::Invalid`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RecordingError> {
        let mut reader = Reader { bytes, at: 0 };
        if reader.word().ok() != Some(SIGNATURE) {
            return Err(RecordingError::Invalid { offset: 0, why: "it does not begin with a recording's signature" });
        }
        let near_clip_plane = reader.float()?;
        reader.check(near_clip_plane.is_finite(), "the near plane is not a number")?;
        let resolution = (reader.word()?, reader.word()?);
        let size = 1..=MAX_SIZE;
        reader.check(size.contains(&resolution.0) && size.contains(&resolution.1), "resolution out of range")?;
        let mut calls = Vec::new();
        loop {
            // A call may be as small as one byte of the file, so running out of memory must be an error instead of
            // aborting the program.
            calls.try_reserve(1).map_err(|_| RecordingError::OutOfMemory)?;
            reader.check(calls.len() < i32::MAX as usize, "more calls than can be counted")?;
            calls.push(match reader.byte()? {
                CLEAR_BUFFER => RecordedCall::ClearBuffer,
                TEST_RECT => RecordedCall::TestRect(reader.rect()?),
                RENDER_TRIANGLES => RecordedCall::RenderTriangles(boxed(reader.mesh()?)?),
                TEST_TRIANGLES => RecordedCall::TestTriangles(boxed(reader.mesh()?)?),
                END => return Ok(Self { near_clip_plane, resolution, calls }),
                _ => return Err(reader.invalid("no call is of this kind")),
            });
        }
    }
}

/// A file may hold very many meshes.
fn boxed(mesh: RecordedMesh) -> Result<Box<RecordedMesh>, RecordingError> {
    try_box(mesh).ok_or(RecordingError::OutOfMemory)
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, len: usize) -> Result<&'a [u8], RecordingError> {
        let rest = &self.bytes[self.at..];
        if len > rest.len() {
            return Err(RecordingError::Invalid {
                offset: self.at,
                why: "the file ends before the end marker (was the recording stopped?)",
            });
        }
        self.at += len;
        Ok(&rest[..len])
    }

    /// An error at the bytes just read.
    fn invalid(&self, why: &'static str) -> RecordingError {
        RecordingError::Invalid { offset: self.at, why }
    }

    fn check(&self, holds: bool, why: &'static str) -> Result<(), RecordingError> {
        if holds { Ok(()) } else { Err(self.invalid(why)) }
    }

    fn byte(&mut self) -> Result<u8, RecordingError> {
        Ok(self.take(1)?[0])
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], RecordingError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn word(&mut self) -> Result<u32, RecordingError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn int(&mut self) -> Result<i32, RecordingError> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    fn float(&mut self) -> Result<f32, RecordingError> {
        Ok(f32::from_bits(self.word()?))
    }

    /// Reads words, after checking that the file has that many.
    fn words(&mut self, count: usize, each: usize, why: &'static str) -> Result<Vec<u32>, RecordingError> {
        let len = count.checked_mul(each).and_then(|n| n.checked_mul(4)).ok_or_else(|| self.invalid(why))?;
        let (from, _) = self.take(len)?.as_chunks::<4>();
        try_collect(from.iter().map(|&word| u32::from_le_bytes(word))).ok_or(RecordingError::OutOfMemory)
    }

    fn result(&mut self) -> Result<Option<CullingResult>, RecordingError> {
        match self.int()? {
            UNKNOWN => Ok(None),
            n => CullingResult::from_number(n).map(Some).ok_or_else(|| self.invalid("no answer has this number")),
        }
    }

    fn rect(&mut self) -> Result<RecordedRect, RecordingError> {
        let result = self.result()?;
        let edges = [self.float()?, self.float()?, self.float()?, self.float()?];
        Ok(RecordedRect { result, edges, w_min: self.float()? })
    }

    fn mesh(&mut self) -> Result<RecordedMesh, RecordingError> {
        let result = self.result()?;
        let count = self.int()?;
        if count == 0 {
            let (vertices, triangles) = (Vec::new(), Vec::new());
            return Ok(RecordedMesh {
                result,
                vertices,
                space: ClipSpaceLayout::XYZW.into(),
                triangles,
                options: DrawOptions::default(),
            });
        }
        let count = usize::try_from(count).map_err(|_| self.invalid("negative vertex count"))?;
        let bytes = usize::try_from(self.int()?).map_err(|_| self.invalid("negative vertex size"))?;
        self.check(bytes >= 4 && bytes.is_multiple_of(4), "a vertex is not made of words")?;
        let vertices = self.words(count, bytes / 4, "more vertices than a file can hold")?;
        let vertices: Vec<f32> = vertices.into_iter().map(f32::from_bits).collect();
        let num_triangles = usize::try_from(self.int()?).map_err(|_| self.invalid("negative triangle count"))?;
        let triangles = self.words(num_triangles, 3, "more triangles than a file can hold")?;
        let model_to_clip = match self.byte()? {
            0 => None,
            1 => {
                let mut matrix = [0.0; 16];
                for number in &mut matrix {
                    *number = self.float()?;
                }
                Some(Matrix::from(matrix))
            }
            _ => return Err(self.invalid("the matrix flag is neither 0 nor 1")),
        };
        let planes = self.int()?;
        let clip_planes = u32::try_from(planes).ok().and_then(ClipPlanes::from_bits);
        let clip_planes = clip_planes.ok_or_else(|| self.invalid("no clip planes have these bits"))?;
        let winding = BackfaceWinding::from_number(self.int()?);
        let winding = winding.ok_or_else(|| self.invalid("no winding has this number"))?;
        let layout = VertexLayout::new(self.int()?, self.int()?, self.int()?);
        let whole = vertex_count(size_of_val(vertices.as_slice()), layout)
            .map_err(|_| self.invalid("a vertex layout has a negative stride or offset"))?;
        let named = |&index: &u32| (index as usize) < whole;
        self.check(triangles.iter().all(named), "an index refers to a vertex that does not exist")?;
        let (space, options) = (VertexSpace::from_parts(layout, model_to_clip), DrawOptions { winding, clip_planes });
        Ok(RecordedMesh { result, vertices, space, triangles, options })
    }
}
