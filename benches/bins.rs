//! A frame drawn with triangle lists: all objects are binned, then the bins are drawn, on one thread.

use benches::{HEIGHT, Order, WIDTH, views};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use masked_occlusion_culling::{ScissorRect, TriList, UpdateRule};

const BINS: (u32, u32) = (4, 2);
const FLOATS: usize = 9;

fn bins(c: &mut Criterion) {
    let mut group = c.benchmark_group("bins");
    for view in views(Order::Near) {
        let mut moc = benches::object(UpdateRule::ThreeLayer);
        moc.set_near_clip_plane(view.near).expect("a number");
        let (bin_w, bin_h) = moc.compute_bin_size(BINS.0, BINS.1).expect("bins are larger than tiles");
        let room = view.triangles() as usize * 2 * FLOATS;
        let mut storage = vec![vec![0.0; room]; (BINS.0 * BINS.1) as usize];
        let mut lists: Vec<TriList> = storage.iter_mut().map(|s| TriList::new(s)).collect();
        let vertices = view.model_space();
        group.throughput(Throughput::Elements(view.triangles()));
        group.bench_function(BenchmarkId::new("bin", view.name), |b| {
            b.iter(|| {
                lists.iter_mut().for_each(TriList::clear);
                for object in &view.objects {
                    moc.bin_triangles(vertices, object, &mut lists, BINS.0, BINS.1, &view.options)
                        .expect("there is room");
                }
            });
        });
        group.bench_function(BenchmarkId::new("draw", view.name), |b| {
            b.iter(|| {
                moc.clear_buffer();
                for (list, i) in lists.iter().zip(0..) {
                    let (x, y) = (i % BINS.0, i / BINS.0);
                    let end = |i: u32, bins: u32, bin: u32, all: u32| if i + 1 == bins { all } else { (i + 1) * bin };
                    let rectangle = ScissorRect {
                        min_x: (x * bin_w) as i32,
                        min_y: (y * bin_h) as i32,
                        max_x: end(x, BINS.0, bin_w, WIDTH) as i32,
                        max_y: end(y, BINS.1, bin_h, HEIGHT) as i32,
                    };
                    moc.render_trilist(list, Some(rectangle)).expect("the rectangle is a bin");
                }
            });
        });
    }
}

criterion_group!(benches, bins);
criterion_main!(benches);
