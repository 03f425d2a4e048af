//! Culls a scene with cpp-examples/demo.cpp, which uses the library as an engine does, and draws pictures of the
//! result.
//!
//! This driver generates or loads the scene, compiles the C++ program against include/ and the library that cargo
//! built, runs it, checks its results against a plain z-buffer, and writes the pictures.

use std::fmt::Display;
use std::io::Write;
use std::process::{Command, ExitCode};
use std::time::Duration;
use std::{fs, io, path};

use clap::Parser;
use indicatif::ProgressBar;

use demo::args::Args;
use demo::depth_picture::{self, depth_picture};
use demo::exchange::{self, Fate};
use demo::{Result, compiler, load, native, picture, play, raster, split, town};

/// How often a recording is played for the measurement.
const REPEATS: u32 = 101;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            let _ = writeln!(io::stderr(), "demo: {e}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    args.check_record()?;
    if let Some(file) = args.recording() {
        let (rule, isa, picture) = (args.rule, args.isa, args.out.join("depth.png"));
        return play::run(&play::Options { file, rule, isa, repeats: REPEATS, picture });
    }
    let scene = match &args.scene {
        Some(path) => {
            let scene = load::load(path)?;
            let piece = args.split.map_or_else(|| split::piece_size(&scene), |n| n as usize);
            split::split(scene, piece)
        }
        None => town::generate(),
    };
    let name = args.scene.as_ref().map_or("a generated town".into(), |p| p.display().to_string());
    say(format_args!("{name}: {} objects, {} triangles\n", scene.objects.len(), scene.num_triangles()));

    let camera = step("choosing a camera", || args.camera(&scene))?;
    let list = |v: glam::Vec3| v.to_array().map(|n| n.to_string()).join(",");
    say(format_args!("camera: --eye {} --look {}\n", list(camera.eye), list(camera.look)));

    fs::create_dir_all(&args.out).map_err(|e| format!("cannot create {}: {e}", args.out.display()))?;
    // The program's files are deleted once the pictures are written. Not every system allows programs to run in its
    // temporary folder.
    let folder = tempfile::tempdir_in(path::absolute(&args.out)?)?;
    let out = folder.path();
    let (scene_file, result_file) = (out.join("scene.bin"), out.join("result.bin"));
    exchange::write_scene(&scene_file, &scene, &camera, args.size)?;
    let program = step("compiling cpp-examples/demo.cpp", || {
        compiler::find(out)?;
        Ok(native::build(&native::Program {
            source: &native::root().join("cpp-examples/demo.cpp"),
            out,
            link: native::Link::Static,
            defines: args.rule.define().as_slice(),
            flags: &[],
        })
        .map_err(compiler::complaint)?)
    })?;
    let mut command = Command::new(program);
    command.arg(&scene_file).arg(&result_file);
    command.arg(args.isa.map_or("-".into(), |isa| (isa as i32).to_string()));
    command.args(&args.record);
    let running = format!("running at {}x{}", args.size.0, args.size.1);
    say(step(&running, || Ok(native::run(&mut command)?))?);
    let outcome = exchange::read_outcome(&result_file, scene.objects.len(), args.size)?;

    let wrong = step("checking against a plain z-buffer", || {
        let hidden: Vec<bool> = outcome.fates.iter().map(|f| *f != Fate::Visible).collect();
        let size = (args.size.0 as usize, args.size.1 as usize);
        Ok(raster::falsely_hidden(&scene.objects, &hidden, size, &camera.clip_from_world(), camera.near))
    })?;
    let (width, height) = args.size;
    say(format_args!(
        "falsely culled: {wrong} (objects with a visible pixel in a plain z-buffer of {width}x{height})\n\
         On a larger screen, an object visible only through a gap narrower than one of these pixels can be culled: \
         see docs/guide.md.\n"
    ));

    let (depth_file, culled_file) = (args.out.join("depth.png"), args.out.join("culled.png"));
    step("drawing the pictures", || {
        depth_picture(&outcome.depth, args.size, depth_picture::reduced(args.size)).save(&depth_file)?;
        picture::compose(&scene, &camera, &outcome, args.size).save(&culled_file)
    })?;
    say(format_args!("pictures: {} and {}\n", depth_file.display(), culled_file.display()));
    if wrong > 0 { Err("something visible was culled".into()) } else { Ok(()) }
}

/// Prints. Errors are ignored: the pictures are drawn even if nobody reads the output.
fn say(text: impl Display) {
    let _ = write!(io::stdout(), "{text}");
}

/// Runs something that may take a while and shows progress: a spinner, or a line if there is no terminal.
fn step<T>(message: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let spinner = ProgressBar::new_spinner().with_message(message.to_owned());
    if spinner.is_hidden() {
        let _ = writeln!(io::stderr(), "{message}");
    }
    spinner.enable_steady_tick(Duration::from_millis(100));
    let done = work();
    spinner.finish_and_clear();
    done
}
