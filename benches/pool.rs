//! A frame drawn by a thread pool, compared with the same frame drawn directly: clear, draw, flush.

use benches::{Order, views};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use masked_occlusion_culling::{CullingThreadpool, ThreadpoolSettings, UpdateRule};

fn pool(c: &mut Criterion) {
    let mut group = c.benchmark_group("pool");
    let processors = std::thread::available_parallelism().map_or(1, |n| n.get() as u32);
    let mut counts = vec![0, 1, 2, processors - 1, processors];
    counts.sort_unstable();
    counts.dedup();
    for view in views(Order::Near) {
        let vertices = view.model_space();
        group.throughput(Throughput::Elements(view.triangles()));
        let mut moc = benches::object(UpdateRule::ThreeLayer);
        moc.set_near_clip_plane(view.near).expect("a number");
        group.bench_function(BenchmarkId::new("direct", view.name), |b| {
            b.iter(|| {
                moc.clear_buffer();
                for object in &view.objects {
                    moc.render_triangles(vertices, object, &view.options).expect("indices are right");
                }
            });
        });
        for &threads in &counts {
            let settings = ThreadpoolSettings::default().with_threads(threads);
            let pool = CullingThreadpool::new(settings).expect("threads can be started");
            let mut moc = benches::object(UpdateRule::ThreeLayer);
            moc.set_near_clip_plane(view.near).expect("a number");
            pool.set_buffer(moc);
            pool.wake_threads();
            group.bench_function(BenchmarkId::new(format!("{threads} threads"), view.name), |b| {
                b.iter(|| view.pool_frame(&pool));
            });
        }
    }
}

criterion_group!(benches, pool);
criterion_main!(benches);
