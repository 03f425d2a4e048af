//! However vertices are stored, and whether the matrix is applied here or beforehand, the buffer is the same.

use masked_occlusion_culling::{
    BackfaceWinding, ClipSpaceLayout, DrawOptions, Implementation, MaskedOcclusionCulling, Matrix, ModelSpaceLayout,
    Settings, Vertices, transform_vertices,
};

const SIZE: (u32, u32) = (150, 90);
const COUNT: usize = 31 * 3;

/// A column-major matrix without zeros where they could hide a mistake; w is mostly z.
const MATRIX: [f32; 16] = [1.2, 0.1, 9.0, 0.05, -0.15, 1.4, 9.0, -0.02, 0.03, -0.07, 9.0, 0.9, 0.2, -0.1, 9.0, 1.5];

const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Positions in a box in front of the camera.
fn positions() -> Vec<[f32; 3]> {
    let coordinate = |i: usize, k: usize| ((i * [37, 53, 71][k] + k * 11) % 101) as f32 / 50.0 - 1.0;
    (0..COUNT).map(|i| [coordinate(i, 0) * 2.0, coordinate(i, 1) * 2.0, coordinate(i, 2) + 1.5]).collect()
}

fn clip_space() -> Vec<[f32; 4]> {
    let (positions, mut out) = (positions(), vec![[0.0; 4]; COUNT]);
    transform_vertices(MATRIX, positions.as_flattened(), ModelSpaceLayout::XYZ, &mut out).unwrap();
    out
}

fn drawn(implementation: Implementation, vertices: Vertices<'_>) -> Vec<u32> {
    let mut moc =
        MaskedOcclusionCulling::new(SIZE.0, SIZE.1, Settings::default().with_implementation(implementation)).unwrap();
    let options = DrawOptions::default().with_winding(BackfaceWinding::None);
    let indices: Vec<u32> = (0..COUNT as u32).collect();
    moc.render_triangles(vertices, &indices, &options).unwrap();
    let mut depth = vec![0.0; (SIZE.0 * SIZE.1) as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    assert!(depth.iter().filter(|d| **d > 0.0).count() > 1000, "the test draws too little to tell");
    depth.into_iter().map(f32::to_bits).collect()
}

#[test]
fn transforming_is_the_documented_sum() {
    for (v, [x, y, z]) in clip_space().iter().zip(positions()) {
        for k in 0..4 {
            let term = |i: usize, c: f32| f64::from(MATRIX[4 * i + k]) * f64::from(c);
            let exact = term(0, x) + term(1, y) + term(2, z) + term(3, 1.0);
            assert!((f64::from(v[k]) - exact).abs() < 1e-5, "{k} of {x} {y} {z}: {} and not {exact}", v[k]);
        }
    }
}

#[test]
fn transforming_writes_what_fits() {
    let positions = positions();
    let mut out = vec![[7.5; 4]; COUNT + 3];
    transform_vertices(IDENTITY, positions.as_flattened(), ModelSpaceLayout::XYZ, &mut out).unwrap();
    for (v, [x, y, z]) in out.iter().zip(&positions) {
        assert_eq!(*v, [*x, *y, *z, 1.0]);
    }
    assert_eq!(out[COUNT..], [[7.5; 4]; 3]);
    let mut short = [[7.5; 4]; 5];
    transform_vertices(IDENTITY, positions.as_flattened(), ModelSpaceLayout::XYZ, &mut short).unwrap();
    assert_eq!(short[..], out[..5]);
    let negative = ModelSpaceLayout::new(12, -4, 8);
    let refused = transform_vertices(IDENTITY, positions.as_flattened(), negative, &mut short);
    assert_eq!(refused, Err(masked_occlusion_culling::Error::InvalidLayout));
    assert_eq!(short[..], out[..5]);
}

#[test]
fn every_layout_gives_the_same_buffer() {
    let clip = clip_space();
    let packed: Vec<f32> = clip.iter().flat_map(|v| [v[0], v[1], v[3]]).collect();
    let apart: Vec<f32> = [0, 1, 3].iter().flat_map(|k| clip.iter().map(|v| v[*k])).collect();
    // No offset can express x last and y first; w before y can be expressed.
    let turned: Vec<f32> = clip.iter().flat_map(|v| [v[0], v[3], f32::NAN, v[1], f32::NAN]).collect();
    let n = COUNT as i32;
    for &implementation in Implementation::available() {
        let want = drawn(implementation, Vertices::clip_space(&clip));
        for (name, data, layout) in [
            ("x, y, w", &packed, ClipSpaceLayout::XYW),
            ("arrays", &apart, ClipSpaceLayout::new(4, 4 * n, 8 * n)),
            ("x, w, -, y, -", &turned, ClipSpaceLayout::new(20, 12, 4)),
        ] {
            let vertices = Vertices::new(data, layout).unwrap();
            assert_eq!(vertices.len(), COUNT, "{name}");
            assert!(drawn(implementation, vertices) == want, "{implementation:?} {name}");
        }
    }
}

#[test]
fn a_matrix_gives_what_transforming_beforehand_gives() {
    let (clip, positions) = (clip_space(), positions());
    let wide: Vec<f32> = positions.iter().flat_map(|v| [v[0], v[1], v[2], f32::NAN]).collect();
    for &implementation in Implementation::available() {
        let want = drawn(implementation, Vertices::clip_space(&clip));
        let got = drawn(implementation, Vertices::model_space(&positions, MATRIX));
        assert!(got == want, "{implementation:?}");
        let got =
            drawn(implementation, Vertices::new(&wide, ModelSpaceLayout::XYZ_PADDED.with_matrix(MATRIX)).unwrap());
        assert!(got == want, "{implementation:?}, 16 bytes apart");
    }
}

/// Whatever it is made from, column by column.
#[test]
fn matrices_of_every_source_are_the_same() {
    let columns: [[f32; 4]; 4] = std::array::from_fn(|column| std::array::from_fn(|row| MATRIX[4 * column + row]));
    assert_eq!(Matrix::from(MATRIX).as_array(), &MATRIX);
    assert_eq!(Matrix::from(&MATRIX), Matrix::from(MATRIX));
    assert_eq!(Matrix::from(columns), Matrix::from(MATRIX));
    #[cfg(feature = "glam")]
    {
        let matrix = masked_occlusion_culling::glam::Mat4::from_cols_array(&MATRIX);
        assert_eq!((Matrix::from(matrix), Matrix::from(&matrix)), (Matrix::from(MATRIX), Matrix::from(MATRIX)));
    }
}

/// Vertices far apart and sparsely used take a different path through the library than a few dense ones.
#[test]
fn sparse_and_repeated_indices_give_the_same_buffer() {
    const APART: usize = 5000;
    let clip = clip_space();
    let mut sparse = vec![[f32::NAN; 4]; APART * COUNT];
    clip.iter().enumerate().for_each(|(i, v)| sparse[i * APART] = *v);
    let spread: Vec<u32> = (0..COUNT).map(|i| (i * APART) as u32).collect();
    for &implementation in Implementation::available() {
        let mut moc =
            MaskedOcclusionCulling::new(SIZE.0, SIZE.1, Settings::default().with_implementation(implementation))
                .unwrap();
        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
        moc.render_triangles(Vertices::clip_space(&sparse), &spread, &options).unwrap();
        let mut depth = vec![0.0; (SIZE.0 * SIZE.1) as usize];
        moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
        let got: Vec<u32> = depth.into_iter().map(f32::to_bits).collect();
        assert!(got == drawn(implementation, Vertices::clip_space(&clip)), "{implementation:?}");
    }
}
