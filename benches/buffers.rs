//! Calls on whole buffers: clear, merge, the depth of every pixel.

use benches::{HEIGHT, Order, RULES, WIDTH, views};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn buffers(c: &mut Criterion) {
    let pixels = WIDTH as usize * HEIGHT as usize;
    let mut depth = vec![0.0; pixels];
    let view = &views(Order::Near)[0];
    for (name, rule) in RULES {
        let mut group = c.benchmark_group("buffer");
        group.throughput(Throughput::Elements(pixels as u64));
        let mut drawn = benches::object(rule);
        view.draw(&mut drawn);
        let mut moc = benches::object(rule);
        group.bench_function(BenchmarkId::new("clear", name), |b| b.iter(|| moc.clear_buffer()));
        group.bench_function(BenchmarkId::new("pixel-depth", name), |b| {
            b.iter(|| drawn.compute_pixel_depth_buffer(&mut depth, false));
        });
        group.bench_function(BenchmarkId::new("merge-into-empty", name), |b| {
            b.iter_batched_ref(|| benches::object(rule), |into| into.merge_buffer(&drawn), BatchSize::LargeInput);
        });
        let mut other = benches::object(rule);
        views(Order::Random)[2].draw(&mut other);
        group.bench_function(BenchmarkId::new("merge", name), |b| {
            let prepared = || {
                let mut into = benches::object(rule);
                into.merge_buffer(&other).expect("the same size");
                into
            };
            b.iter_batched_ref(prepared, |into| into.merge_buffer(&drawn), BatchSize::LargeInput);
        });
    }
}

criterion_group!(benches, buffers);
criterion_main!(benches);
