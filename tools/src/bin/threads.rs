//! Speedup of the pool over one thread, and how close it is to the machine's limit: the throughput of the same number
//! of independent threads, each drawing the whole frame into its own object. Processors share caches and memory, and a
//! hypervisor's virtual processor may be half of a physical one.
//!
//! The benches' scenes, nearest first, all three ways alternately; medians of each round's ratios. Fails if a pixel
//! differs.

use std::sync::RwLock;
use std::thread;
use std::time::{Duration, Instant};

use benches::{HEIGHT, Order, View, WIDTH, views};
use clap::Parser;
use demo::options::{Isa, Rule, isa, settings};
use masked_occlusion_culling::{CullingThreadpool, MaskedOcclusionCulling, ThreadpoolSettings};

/// Compares the thread pool with one thread, and with independent threads.
#[derive(Parser)]
#[command(name = "threads")]
struct Args {
    /// Number of threads, including the caller's (default: 2, 4, 8, ... up to the number of processors).
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(2..=256))]
    threads: Vec<u32>,
    /// Number of rounds.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Update rule of the buffer.
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    rule: Rule,
    /// The highest instruction set that may be used (default: the best of the processor).
    #[arg(long, value_name = "ISA", value_parser = isa)]
    isa: Option<Isa>,
}

/// Duration of the frames of one thread that are measured together: long, because a thread takes tens of microseconds
/// to wake.
const AT_LEAST: Duration = Duration::from_millis(10);

/// Draws a frame.
fn frame(view: &View, moc: &mut MaskedOcclusionCulling) {
    moc.clear_buffer();
    view.draw(moc);
}

fn seconds(frames: u32, mut draw: impl FnMut()) -> f64 {
    let begin = Instant::now();
    (0..frames).for_each(|_| draw());
    begin.elapsed().as_secs_f64()
}

/// Draws the frame into every object on its own thread, all at once: the time from the first start to the last end.
fn copies(view: &View, frames: u32, objects: &mut [MaskedOcclusionCulling]) -> f64 {
    let draw = |moc: &mut MaskedOcclusionCulling| {
        let begin = Instant::now();
        (0..frames).for_each(|_| frame(view, moc));
        (begin, Instant::now())
    };
    let (first, others) = objects.split_first_mut().expect("there are two at least");
    let gate = RwLock::new(());
    let times: Vec<(Instant, Instant)> = thread::scope(|scope| {
        // The gate is opened even if a thread cannot be started.
        let closed = gate.write();
        let drawn: Vec<_> = others
            .iter_mut()
            .map(|moc| {
                scope.spawn(|| {
                    drop(gate.read());
                    draw(moc)
                })
            })
            .collect();
        drop(closed);
        let own = draw(first);
        drawn.into_iter().map(|thread| thread.join().expect("it draws only")).chain([own]).collect()
    });
    let begin = times.iter().map(|time| time.0).min().expect("there are two at least");
    let end = times.iter().map(|time| time.1).max().expect("there are two at least");
    (end - begin).as_secs_f64()
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn pixels(moc: &MaskedOcclusionCulling) -> Vec<u32> {
    let mut depth = vec![0.0; (WIDTH * HEIGHT) as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).expect("there is a buffer");
    depth.into_iter().map(f32::to_bits).collect()
}

/// Speedups of the pool and of the independent threads over one thread; number of pixels that differ.
fn measure(
    view: &View,
    threads: u32,
    rounds: u32,
    object: impl Fn() -> MaskedOcclusionCulling,
) -> (Vec<[f64; 2]>, usize) {
    let mut objects: Vec<MaskedOcclusionCulling> = (0..threads).map(|_| object()).collect();
    let settings = ThreadpoolSettings::default().with_threads(threads - 1).with_processors(threads);
    let pool = CullingThreadpool::new(settings).expect("threads can be started");
    let mut pooled = object();
    pooled.set_near_clip_plane(view.near).expect("a number");
    pool.set_buffer(pooled);
    pool.wake_threads();
    view.pool_frame(&pool);
    objects.iter_mut().for_each(|moc| frame(view, moc));
    let once = seconds(2, || frame(view, &mut objects[0])) / 2.0;
    let frames = (AT_LEAST.as_secs_f64() / once).ceil() as u32;
    let speeds = (0..rounds)
        .map(|_| {
            let one = seconds(frames, || frame(view, &mut objects[0]));
            let pool = seconds(frames, || view.pool_frame(&pool));
            [one / pool, f64::from(threads) * one / copies(view, frames, &mut objects)]
        })
        .collect();
    let pooled = pixels(&pool.take_buffer().expect("it was given"));
    let differ = pixels(&objects[0]).into_iter().zip(pooled).filter(|(a, b)| a != b).count();
    (speeds, differ)
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let settings = settings(args.isa, args.rule);
    let object = || MaskedOcclusionCulling::new(WIDTH, HEIGHT, settings).expect("the size is accepted");
    let processors = thread::available_parallelism().map_or(1, |n| n.get() as u32);
    let counts = match args.threads.is_empty() {
        true => (1..11).map(|k| 1 << k).filter(|&n| n <= processors.max(2)).collect(),
        false => args.threads,
    };
    println!(
        "{WIDTH}x{HEIGHT}, {:?}, {processors} processors; speeds in those of one thread",
        object().implementation()
    );
    println!("scene    triangles  threads  pool  as many copies  pool of copies  pixels that differ");
    let mut all_differ = 0;
    for view in views(Order::Near) {
        for &threads in &counts {
            let (speeds, differ) = measure(&view, threads, args.rounds, object);
            let of = |f: fn(&[f64; 2]) -> f64| median(speeds.iter().map(f).collect());
            let (pool, copies, share) = (of(|s| s[0]), of(|s| s[1]), of(|s| s[0] / s[1]));
            println!(
                "{:<8} {:>9} {threads:>8} {pool:>5.2} {copies:>15.2} {share:>15.2} {differ:>19}",
                view.name,
                view.triangles()
            );
            all_differ += differ;
        }
    }
    if all_differ > 0 { Err(format!("{all_differ} pixels differ")) } else { Ok(()) }
}
