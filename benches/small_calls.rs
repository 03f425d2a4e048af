//! Boxes of twelve triangles, one per call: the fixed cost of a call.

use benches::RULES;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fastrand::Rng;
use glam::Mat4;
use masked_occlusion_culling::{DrawOptions, UpdateRule, Vertices};

const BOXES: usize = 500;
const BOX: [u32; 36] =
    [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];

/// Boxes scattered over a view whose w is z.
fn boxes() -> Vec<[[f32; 3]; 8]> {
    let mut rng = Rng::with_seed(3);
    (0..BOXES)
        .map(|_| {
            let z = 5.0 + 95.0 * rng.f32();
            let low = [(rng.f32() * 2.2 - 1.1) * z, (rng.f32() * 2.2 - 1.1) * z, z];
            let size = 0.5 + 2.0 * rng.f32();
            std::array::from_fn(|i| std::array::from_fn(|axis| low[axis] + size * (i >> axis & 1) as f32))
        })
        .collect()
}

fn small_calls(c: &mut Criterion) {
    let positions = boxes();
    let clip: Vec<[[f32; 4]; 8]> = positions.iter().map(|b| b.map(|[x, y, z]| [x, y, 0.0, z])).collect();
    let mut matrix = Mat4::IDENTITY;
    (matrix.z_axis.w, matrix.w_axis.w) = (1.0, 0.0);
    let mut group = c.benchmark_group("twelve-triangles");
    group.throughput(Throughput::Elements(BOXES as u64));
    for (name, rule) in RULES {
        let mut moc = benches::object(rule);
        group.bench_function(BenchmarkId::new("clip-space", name), |b| {
            b.iter(|| {
                moc.clear_buffer();
                for vertices in &clip {
                    moc.render_triangles(Vertices::clip_space(vertices), &BOX, &DrawOptions::default())
                        .expect("a sound mesh");
                }
            });
        });
        group.bench_function(BenchmarkId::new("matrix", name), |b| {
            b.iter(|| {
                moc.clear_buffer();
                for vertices in &positions {
                    moc.render_triangles(Vertices::model_space(vertices, matrix), &BOX, &DrawOptions::default())
                        .expect("a sound mesh");
                }
            });
        });
    }
    // Outside the view: only the front end runs.
    let mut moc = benches::object(UpdateRule::ThreeLayer);
    let away: Vec<[[f32; 4]; 8]> = clip.iter().map(|b| b.map(|[x, y, z, w]| [x + 3.0 * w, y, z, w])).collect();
    group.bench_function("outside", |b| {
        b.iter(|| {
            for vertices in &away {
                moc.render_triangles(Vertices::clip_space(vertices), &BOX, &DrawOptions::default())
                    .expect("a sound mesh");
            }
        });
    });
}

criterion_group!(benches, small_calls);
criterion_main!(benches);
