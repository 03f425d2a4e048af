//! Writes calls to a file.

use std::io::{self, Write};

use super::format::{CLEAR_BUFFER, END, SIGNATURE, TEST_RECT, UNKNOWN};
use crate::source::Mesh;
use crate::vertices::VertexSource;
use crate::{CullingResult, VertexLayout};

/// Vertices with a larger stride are written without the bytes between their coordinates.
const LARGEST_VERTEX: i32 = 256;

pub(super) struct Writer<W> {
    out: W,
}

impl<W: Write> Writer<W> {
    pub fn new(out: W) -> Self {
        Self { out }
    }

    pub fn header(&mut self, near: f32, (width, height): (u32, u32)) -> io::Result<()> {
        self.words(&[SIGNATURE, near.to_bits(), width, height])
    }

    pub fn clear_buffer(&mut self) -> io::Result<()> {
        self.out.write_all(&[CLEAR_BUFFER])
    }

    pub fn test_rect(&mut self, result: Option<CullingResult>, edges: [f32; 4], w_min: f32) -> io::Result<()> {
        self.out.write_all(&[TEST_RECT])?;
        self.int(of_result(result))?;
        self.words(&edges.map(f32::to_bits))?;
        self.words(&[w_min.to_bits()])
    }

    pub fn triangles(&mut self, kind: u8, result: Option<CullingResult>, mesh: &Mesh<'_>) -> io::Result<()> {
        let (vertices, triangles, matrix, options) = (mesh.vertices(), mesh.triangles(), mesh.matrix(), mesh.options());
        let bounds = triangles.iter().min().copied().zip(triangles.iter().max().copied());
        let too_large =
            || io::Error::new(io::ErrorKind::InvalidInput, "more vertices or triangles than the format can count");
        let count = bounds.map_or(0, |(low, high)| u64::from(high - low) + 1);
        let count = i32::try_from(count).map_err(|_| too_large())?;
        let num_triangles = i32::try_from(triangles.len() / 3).map_err(|_| too_large())?;
        self.out.write_all(&[kind])?;
        self.int(of_result(result))?;
        self.int(count)?;
        let Some((low, high)) = bounds else { return Ok(()) };
        let layout = written_layout(vertices.layout);
        self.int(layout.stride)?;
        for index in low..=high {
            // SAFETY: a mesh's vertices can be read.
            let coordinates = unsafe { coordinates(vertices, index) };
            let mut vertex = [0; LARGEST_VERTEX as usize];
            for (coordinate, offset) in coordinates.into_iter().zip([0, layout.offset_y, layout.offset_zw]) {
                vertex[offset as usize..][..4].copy_from_slice(&coordinate);
            }
            self.out.write_all(&vertex[..layout.stride as usize])?;
        }
        self.int(num_triangles)?;
        for index in triangles {
            self.words(&[index - low])?;
        }
        self.out.write_all(&[matrix.is_some().into()])?;
        if let Some(matrix) = matrix {
            self.words(&matrix.map(f32::to_bits))?;
        }
        self.int(options.clip_planes.bits() as i32)?;
        self.int(options.winding as i32)?;
        [layout.stride, layout.offset_y, layout.offset_zw].into_iter().try_for_each(|n| self.int(n))
    }

    pub fn end(mut self) -> io::Result<()> {
        self.out.write_all(&[END])?;
        self.out.flush()
    }

    fn words(&mut self, words: &[u32]) -> io::Result<()> {
        words.iter().try_for_each(|word| self.out.write_all(&word.to_le_bytes()))
    }

    fn int(&mut self, n: i32) -> io::Result<()> {
        self.out.write_all(&n.to_le_bytes())
    }
}

fn of_result(result: Option<CullingResult>) -> i32 {
    result.map_or(UNKNOWN, |result| result as i32)
}

/// The layout of the vertices in the file: the call's own if the coordinates of each vertex are separate from those of
/// others and word-aligned, else packed.
fn written_layout(layout: VertexLayout) -> VertexLayout {
    let VertexLayout { stride, offset_y: y, offset_zw: zw } = layout;
    let words = stride % 4 == 0 && y % 4 == 0 && zw % 4 == 0;
    let inside = |offset: i32| offset >= 4 && offset <= stride - 4;
    let kept = words && inside(y) && inside(zw) && y != zw && stride <= LARGEST_VERTEX;
    if kept { layout } else { VertexLayout::POSITIONS }
}

/// The bytes of a vertex's coordinates in the file.
///
/// # Safety
/// The vertex can be read.
unsafe fn coordinates(VertexSource { base, layout }: VertexSource, index: u32) -> [[u8; 4]; 3] {
    let vertex = base.wrapping_offset((index as isize).wrapping_mul(layout.stride as isize));
    [0, layout.offset_y, layout.offset_zw].map(|offset| {
        // SAFETY: the caller's contract.
        let bits = unsafe { vertex.wrapping_offset(offset as isize).cast::<u32>().read_unaligned() };
        bits.to_le_bytes()
    })
}
