//! Whole frames: a clear and every object of a scene, by scene, order and update rule; and by instruction set.

use benches::{ORDERS, Order, RULES, views};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use masked_occlusion_culling::{Implementation, MaskedOcclusionCulling, Settings};

fn scenes(c: &mut Criterion) {
    let mut group = c.benchmark_group("render");
    for (order_name, order) in ORDERS {
        for view in views(order) {
            group.throughput(Throughput::Elements(view.triangles()));
            for (rule_name, rule) in RULES {
                let mut moc = benches::object(rule);
                group.bench_function(BenchmarkId::new(format!("{}/{order_name}", view.name), rule_name), |b| {
                    b.iter(|| {
                        moc.clear_buffer();
                        view.draw(&mut moc);
                    });
                });
            }
        }
    }
}

fn instruction_sets(c: &mut Criterion) {
    let mut group = c.benchmark_group("instruction-set");
    for view in views(Order::Near) {
        group.throughput(Throughput::Elements(view.triangles()));
        for &implementation in Implementation::available() {
            let settings = Settings::default().with_implementation(implementation);
            let mut moc =
                MaskedOcclusionCulling::new(benches::WIDTH, benches::HEIGHT, settings).expect("the size is accepted");
            group.bench_function(BenchmarkId::new(view.name, format!("{implementation:?}")), |b| {
                b.iter(|| {
                    moc.clear_buffer();
                    view.draw(&mut moc);
                });
            });
        }
    }
}

criterion_group!(benches, scenes, instruction_sets);
criterion_main!(benches);
