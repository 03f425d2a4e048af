//! Transforms vertices by a matrix, from packed positions and from structures of arrays.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fastrand::Rng;
use masked_occlusion_culling::{Matrix, ModelSpaceLayout, transform_vertices};

fn transform(c: &mut Criterion) {
    let mut rng = Rng::with_seed(1);
    let matrix = Matrix::from(std::array::from_fn::<f32, 16, _>(|_| rng.f32()));
    let mut group = c.benchmark_group("transform");
    for count in [8, 1000, 100_000] {
        let data: Vec<f32> = (0..3 * count).map(|_| rng.f32()).collect();
        let n = count as i32;
        let mut out = vec![[0.0; 4]; count];
        group.throughput(Throughput::Elements(count as u64));
        let arrays = ModelSpaceLayout::new(4, 4 * n, 8 * n);
        for (name, layout) in [("packed", ModelSpaceLayout::XYZ), ("arrays", arrays)] {
            group.bench_function(BenchmarkId::new(name, count), |b| {
                b.iter(|| transform_vertices(matrix, &data, layout, &mut out));
            });
        }
    }
}

criterion_group!(benches, transform);
criterion_main!(benches);
