//! Random right triangles of one size per run, front to back and back to front: the cost of a pixel.

use benches::{HEIGHT, RULES, WIDTH};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fastrand::Rng;
use masked_occlusion_culling::{BackfaceWinding, DrawOptions, Vertices};

/// Length of the legs in pixels.
const SIZES: [u32; 9] = [2, 5, 10, 20, 40, 80, 150, 300, 500];

/// Enough triangles to cover the screen several times, nearest first.
fn triangles(size: u32) -> (Vec<[f32; 4]>, Vec<u32>) {
    let count = (8 * WIDTH * HEIGHT / (size * size)).clamp(100, 20_000);
    let mut rng = Rng::with_seed(u64::from(size));
    let mut vertices = Vec::new();
    for i in 0..count {
        let w = 1.0 + 100.0 * i as f32 / count as f32;
        let (x, y) = (rng.f32() * (WIDTH - size) as f32, rng.f32() * (HEIGHT - size) as f32);
        let leg = size as f32;
        for (dx, dy) in [(0.0, 0.0), (leg, 0.0), (0.0, leg)] {
            let ndc = [(x + dx) / (WIDTH as f32 * 0.5) - 1.0, (y + dy) / (HEIGHT as f32 * 0.5) - 1.0];
            vertices.push([ndc[0] * w, ndc[1] * w, 0.0, w]);
        }
    }
    (vertices, (0..count * 3).collect())
}

fn fill(c: &mut Criterion) {
    let options = DrawOptions::default().with_winding(BackfaceWinding::None);
    for (order, backwards) in [("front-to-back", false), ("back-to-front", true)] {
        let mut group = c.benchmark_group(format!("fill/{order}"));
        for size in SIZES {
            let (vertices, mut indices) = triangles(size);
            if backwards {
                indices.reverse();
            }
            group.throughput(Throughput::Elements(indices.len() as u64 / 3));
            for (name, rule) in RULES {
                let mut moc = benches::object(rule);
                group.bench_function(BenchmarkId::new(name, size), |b| {
                    b.iter(|| {
                        moc.clear_buffer();
                        moc.render_triangles(Vertices::clip_space(&vertices), &indices, &options)
                    });
                });
            }
        }
    }
}

criterion_group!(benches, fill);
criterion_main!(benches);
