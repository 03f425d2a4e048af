//! Draws one of the benches' scenes some times over and does nothing else: for profilers and for counting instructions
//! (`.ci/instructions`).

#[path = "../benches/common/mod.rs"]
mod common;

use clap::{Parser, ValueEnum};
use common::{HEIGHT, ORDERS, RULES, WIDTH, views};
use masked_occlusion_culling::{Implementation, MaskedOcclusionCulling, Settings};

#[derive(Clone, Copy, ValueEnum)]
enum Isa {
    Scalar,
    Sse2,
    Sse41,
    Avx2,
    Avx512,
}

#[derive(Parser)]
struct Args {
    /// town, terrain or blocks.
    scene: String,
    /// How often it is drawn, each time into a cleared buffer of 1920x1080.
    #[arg(default_value_t = 1)]
    frames: u32,
    /// The highest instruction set; the best of the machine otherwise.
    #[arg(long, default_value = "avx512")]
    isa: Isa,
    /// three-layer, quick or accurate.
    #[arg(long, default_value = "three-layer")]
    rule: String,
    /// near or random.
    #[arg(long, default_value = "near")]
    order: String,
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let (_, update_rule) = RULES.into_iter().find(|r| r.0 == args.rule).ok_or("no such rule")?;
    let (_, order) = ORDERS.into_iter().find(|o| o.0 == args.order).ok_or("no such order")?;
    let view = views(order).into_iter().find(|v| v.name == args.scene).ok_or("no such scene")?;
    let implementation = match args.isa {
        Isa::Scalar => Implementation::Scalar,
        Isa::Sse2 => Implementation::Sse2,
        Isa::Sse41 => Implementation::Sse41,
        Isa::Avx2 => Implementation::Avx2,
        Isa::Avx512 => Implementation::Avx512,
    };
    let mut moc = MaskedOcclusionCulling::new(Settings { implementation, update_rule, ..Settings::default() });
    moc.set_resolution(WIDTH, HEIGHT).map_err(|e| e.to_string())?;
    for _ in 0..args.frames {
        moc.clear_buffer().map_err(|e| e.to_string())?;
        view.draw(&mut moc);
    }
    println!("{} triangles a frame, {:?}", view.triangles(), moc.implementation());
    Ok(())
}
