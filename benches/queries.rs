//! Queries: rectangles from small to full-screen, hidden and visible, and hidden meshes.

use benches::{HEIGHT, Order, RULES, WIDTH, views};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fastrand::Rng;
use masked_occlusion_culling::CullingResult;

/// Rectangles of `size` pixels in normalised device coordinates.
fn rectangles(size: [u32; 2]) -> Vec<[f32; 4]> {
    let mut rng = Rng::with_seed(5);
    let span = |rng: &mut Rng, size: u32, screen: u32| {
        let low = rng.f32() * (screen - size) as f32;
        [low, low + size as f32].map(|x| x / (screen as f32 * 0.5) - 1.0)
    };
    (0..64)
        .map(|_| {
            let ([x0, x1], [y0, y1]) = (span(&mut rng, size[0], WIDTH), span(&mut rng, size[1], HEIGHT));
            [x0, y0, x1, y1]
        })
        .collect()
}

fn test_rect(c: &mut Criterion) {
    let mut group = c.benchmark_group("test-rect");
    for (name, rule) in RULES {
        let mut moc = benches::object(rule);
        benches::draw_wall(&mut moc, 10.0);
        for size in [[4, 4], [16, 16], [64, 64], [256, 256], [1000, 1000], [WIDTH, HEIGHT]] {
            let rectangles = rectangles(size);
            group.throughput(Throughput::Elements(rectangles.len() as u64));
            for (kind, w) in [("hidden", 20.0), ("visible", 5.0)] {
                let id = BenchmarkId::new(format!("{kind}/{name}"), format!("{}x{}", size[0], size[1]));
                group.bench_function(id, |b| {
                    b.iter(|| {
                        let hidden =
                            |r: &&[f32; 4]| moc.test_rect(r[0], r[1], r[2], r[3], w) == CullingResult::Occluded;
                        rectangles.iter().filter(hidden).count()
                    });
                });
            }
        }
    }
}

fn test_triangles(c: &mut Criterion) {
    let mut group = c.benchmark_group("test-triangles");
    for view in views(Order::Near) {
        group.throughput(Throughput::Elements(view.triangles()));
        for (name, rule) in RULES {
            let mut moc = benches::object(rule);
            moc.set_near_clip_plane(view.near).expect("a number");
            // Just behind the near plane: everything is hidden, so every triangle is tested.
            benches::draw_wall(&mut moc, view.near);
            let vertices = view.model_space();
            group.bench_function(BenchmarkId::new(view.name, name), |b| {
                b.iter(|| {
                    let hidden =
                        |o: &&Vec<u32>| moc.test_triangles(vertices, o, &view.options) != Ok(CullingResult::Visible);
                    view.objects.iter().filter(hidden).count()
                });
            });
        }
    }
}

criterion_group!(benches, test_rect, test_triangles);
criterion_main!(benches);
