//! Draws one of the benches' scenes several times and does nothing else: for profilers and for counting instructions
//! (`.ci/instructions`).

use benches::{HEIGHT, ORDERS, WIDTH, views};
use clap::Parser;
use demo::options::{Isa, Rule, isa, settings};
use masked_occlusion_culling::MaskedOcclusionCulling;

#[derive(Parser)]
struct Args {
    /// town, terrain or blocks.
    scene: String,
    /// How often it is drawn, each time into a cleared buffer of 1920x1080.
    #[arg(default_value_t = 1)]
    frames: u32,
    /// The highest instruction set that may be used (default: the best of the processor).
    #[arg(long, value_name = "ISA", value_parser = isa)]
    isa: Option<Isa>,
    /// Update rule of the buffer.
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    rule: Rule,
    /// near or random.
    #[arg(long, default_value = "near")]
    order: String,
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let (_, order) = ORDERS.into_iter().find(|o| o.0 == args.order).ok_or("no such order")?;
    let view = views(order).into_iter().find(|v| v.name == args.scene).ok_or("no such scene")?;
    let mut moc =
        MaskedOcclusionCulling::new(WIDTH, HEIGHT, settings(args.isa, args.rule)).map_err(|e| e.to_string())?;
    for _ in 0..args.frames {
        moc.clear_buffer();
        view.draw(&mut moc);
    }
    println!("{} triangles per frame, {:?}", view.triangles(), moc.implementation());
    Ok(())
}
