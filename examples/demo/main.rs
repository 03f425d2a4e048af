//! Culls a scene with cpp-examples/demo.cpp, which uses the library as an engine does, and draws what it found.
//!
//! This driver makes or loads the scene, compiles the C++ program against include/ and the library that cargo
//! built, runs it, checks its answers against a plain z-buffer, and writes the pictures.

mod args;
mod camera;
mod exchange;
mod image;
mod load;
#[path = "../../tests/native/mod.rs"]
mod native;
mod picture;
mod raster;
mod scene;
mod shade;
mod shapes;
mod split;
mod town;

use std::process::{Command, ExitCode};
use std::time::Duration;
use std::{fs, path};

use clap::Parser;
use indicatif::ProgressBar;

use args::Args;
use camera::Camera;
use exchange::Fate;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("demo: {e}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    let scene = match &args.scene {
        Some(path) => {
            let scene = load::load(path)?;
            let piece = args.split.map_or_else(|| split::piece_size(&scene), |n| n as usize);
            split::split(scene, piece)
        }
        None => town::generate(),
    };
    let name = args.scene.as_ref().map_or("a generated town".into(), |p| p.display().to_string());
    println!("{name}: {} objects, {} triangles", scene.objects.len(), scene.num_triangles());

    let camera = step("choosing a camera", || Ok(Camera::new(args, &scene)))?;
    let list = |v: glam::Vec3| v.to_array().map(|n| format!("{n:.2}")).join(",");
    println!("camera: --eye {} --look {}", list(camera.eye), list(camera.look));

    fs::create_dir_all(&args.out).map_err(|e| format!("cannot make {}: {e}", args.out.display()))?;
    let out = path::absolute(&args.out)?;
    let (scene_file, result_file) = (out.join("scene.bin"), out.join("result.bin"));
    exchange::write_scene(&scene_file, &scene, &camera, args.size)?;
    let program = step("compiling cpp-examples/demo.cpp", || {
        Ok(native::build(&native::Program {
            source: &native::root().join("cpp-examples/demo.cpp"),
            out: &out,
            link: native::Link::Static,
            defines: args.rule.define().as_slice(),
            flags: &[],
        })?)
    })?;
    let mut command = Command::new(program);
    command.arg(&scene_file).arg(&result_file);
    command.args(args.isa.map(|isa| (isa as i32).to_string()));
    print!("{}", native::run(&mut command)?);
    let outcome = exchange::read_outcome(&result_file, scene.objects.len(), args.size)?;

    let wrong = step("checking against a plain z-buffer", || {
        let hidden: Vec<bool> = outcome.fates.iter().map(|f| *f != Fate::Visible).collect();
        let size = (args.size.0 as usize, args.size.1 as usize);
        Ok(raster::falsely_hidden(&scene.objects, &hidden, size, &camera.clip_from_world(), camera.near))
    })?;
    println!("falsely culled: {wrong} (objects with a visible pixel in a plain z-buffer)");

    let (depth_file, culled_file) = (args.out.join("depth.png"), args.out.join("culled.png"));
    step("drawing the pictures", || {
        let (width, height) = (args.size.0 as usize, args.size.1 as usize);
        picture::depth(&outcome, args.size, width, height).save(&depth_file)?;
        picture::compose(&scene, &camera, &outcome, args.size).save(&culled_file)
    })?;
    println!("pictures: {} and {}", depth_file.display(), culled_file.display());
    if wrong > 0 { Err("something visible was culled".into()) } else { Ok(()) }
}

/// Runs something that may take a while, and says so meanwhile.
fn step<T>(message: &'static str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let spinner = ProgressBar::new_spinner().with_message(message);
    spinner.enable_steady_tick(Duration::from_millis(100));
    let done = work();
    spinner.finish_and_clear();
    done
}
