//! The command line.

use std::path::{Path, PathBuf};

use clap::Parser;
use glam::Vec3;

use crate::camera::Camera;
use crate::options::{Isa, Rule, isa};
use crate::scene::Scene;

/// Culls a scene with a C++ program that uses the library as an engine would, and draws pictures of the result.
#[derive(Debug, Parser)]
#[command(name = "demo")]
pub struct Args {
    /// A .obj, .gltf or .glb file, or a recorded frame (.mocrec), whose camera and size are known; without one a small
    /// town is generated
    pub scene: Option<PathBuf>,

    /// Position of the camera, in the file's units (default: chosen for the scene)
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub eye: Option<Vec3>,

    /// Point that the camera looks at (default: the middle of the scene)
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub look: Option<Vec3>,

    /// The up direction
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true, default_value = "0,1,0")]
    pub up: Vec3,

    /// Vertical field of view in degrees, from 1 to 170
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = field_of_view, allow_negative_numbers = true)]
    pub fov: f32,

    /// Distance of the near plane (default: a small part of the scene's size)
    #[arg(long, value_name = "DISTANCE", value_parser = positive, allow_negative_numbers = true)]
    pub near: Option<f32>,

    /// Width and height of the occlusion buffer in pixels, each from 1 to 16384
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, default_value = "1920x1080")]
    pub size: (u32, u32),

    /// Update rule of the buffer
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    pub rule: Rule,

    /// The highest instruction set that may be used (default: the best of the processor)
    #[arg(long, value_name = "ISA", value_parser = isa)]
    pub isa: Option<Isa>,

    /// Splits meshes of more triangles than this (default: chosen to give about a thousand objects)
    #[arg(long, value_name = "TRIANGLES", value_parser = count, allow_negative_numbers = true)]
    pub split: Option<u32>,

    /// Records a frame to this file, to be played with `replay`
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,

    /// Folder for the pictures
    #[arg(long, value_name = "DIR", default_value = "target/demo")]
    pub out: PathBuf,
}

impl Args {
    /// The recording to be played, if the scene is one.
    pub fn recording(&self) -> Option<&Path> {
        let is_recording = |path: &&Path| path.extension().is_some_and(|extension| extension == "mocrec");
        self.scene.as_deref().filter(is_recording)
    }

    /// Checks that --record can be used: its folder must exist, and the scene must not itself be a recording.
    pub fn check_record(&self) -> crate::Result<()> {
        let Some(file) = &self.record else { return Ok(()) };
        if self.recording().is_some() {
            return Err("--record needs a scene: a recording cannot be recorded again".into());
        }
        match file.parent() {
            Some(folder) if folder != Path::new("") && !folder.is_dir() => {
                Err(format!("--record {}: the folder {} does not exist", file.display(), folder.display()).into())
            }
            _ => Ok(()),
        }
    }

    /// The requested camera; anything not specified is chosen for the scene.
    pub fn camera(&self, scene: &Scene) -> crate::Result<Camera> {
        let (lo, hi) = scene.bounds();
        let mut camera = Camera {
            eye: lo,
            look: (lo + hi) / 2.0,
            up: self.up,
            fov: self.fov.to_radians(),
            near: self.near.unwrap_or((hi - lo).length() * 2e-4),
            aspect: self.size.0 as f32 / self.size.1 as f32,
        };
        match (self.eye, self.look) {
            (Some(eye), look) => (camera.eye, camera.look) = (eye, look.unwrap_or(camera.look)),
            (None, _) if self.scene.is_none() => {
                let (eye, look) = crate::town::camera();
                (camera.eye, camera.look) = (eye, self.look.unwrap_or(look));
            }
            (None, _) => camera.choose(scene, self.look),
        }
        if camera.look == camera.eye {
            camera.look += camera.sideways();
        }
        if !camera.is_upright() {
            return Err("the camera looks along --up: choose another --up, --eye or --look".into());
        }
        Ok(camera)
    }
}

impl Rule {
    /// The preprocessor definition with which the C++ program is compiled, as engines define it.
    pub fn define(self) -> Option<(&'static str, &'static str)> {
        match self {
            Rule::ThreeLayer => None,
            Rule::Quick => Some(("QUICK_MASK", "1")),
            Rule::Accurate => Some(("QUICK_MASK", "0")),
            Rule::FourLayer => Some(("MOC_FOUR_LAYERS", "1")),
        }
    }
}

fn vector(text: &str) -> Result<Vec3, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse::<f32>()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers separated by commas, as in 1,2.5,-3".into()),
    }
}

fn direction(text: &str) -> Result<Vec3, String> {
    vector(text)?.try_normalize().ok_or("a direction is expected, so one of the numbers must differ from 0".into())
}

fn count(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|n| *n > 0).ok_or("a whole number above 0 is expected".into())
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let part = |n: &str| n.parse::<u32>().ok().filter(|n| (1..=16_384).contains(n));
    let (width, height) = text.split_once(['x', 'X']).ok_or("a size such as 1920x1080 is expected")?;
    part(width).zip(part(height)).ok_or("each side has from 1 to 16384 pixels".into())
}

fn positive(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|n: &f32| n.is_finite() && *n > 0.0).ok_or("a number above 0 is expected".into())
}

fn field_of_view(text: &str) -> Result<f32, String> {
    positive(text).ok().filter(|n| (1.0..=170.0).contains(n)).ok_or("an angle from 1 to 170 is expected".into())
}

#[cfg(test)]
mod tests {
    use std::ffi::OsStr;

    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn a_view_along_up_is_refused() {
        let mut scene = Scene::default();
        let mut mesh = Mesh::default();
        mesh.cuboid(Vec3::ZERO, Vec3::ONE, Vec3::ONE);
        scene.add(mesh, true, false);
        let camera = |eye, up| Args::parse_from(["demo", "a.obj", "--eye", eye, "--up", up]).camera(&scene);
        assert!(camera("0.5,9,0.5", "0,1,0").unwrap_err().to_string().contains("--up"));
        assert!(camera("0.5,9,0.5", "0,0,2").is_ok());
        assert!(camera("0.5,9,0.6", "0,1,0").is_ok());
        assert!(camera("3e38,3e38,3e38", "0,1,0").is_err());
    }

    #[test]
    fn a_recording_needs_a_folder_that_exists() {
        let folder = tempfile::tempdir().unwrap();
        let record = |scene: &str, path: &Path| {
            Args::parse_from([OsStr::new("demo"), OsStr::new(scene), OsStr::new("--record"), path.as_os_str()])
                .check_record()
        };
        assert!(record("a.obj", &folder.path().join("frame.mocrec")).is_ok());
        assert!(record("a.obj", Path::new("frame.mocrec")).is_ok());
        let absent = folder.path().join("absent");
        let error = record("a.obj", &absent.join("frame.mocrec")).unwrap_err().to_string();
        assert!(error.contains(&format!("{} does not exist", absent.display())), "{error}");
        assert!(record("a.mocrec", Path::new("frame.mocrec")).is_err());
    }

    #[test]
    fn values_are_read_and_checked() {
        let args = Args::try_parse_from(["demo", "a.obj", "--eye", "-1,2,3.5", "--size", "640x360"]).unwrap();
        assert_eq!((args.eye, args.size, args.rule), (Some(Vec3::new(-1.0, 2.0, 3.5)), (640, 360), Rule::ThreeLayer));
        for bad in [
            ["--eye", "1,2"],
            ["--look", "1,2,nan"],
            ["--size", "0x10"],
            ["--size", "99999x10"],
            ["--fov", "180"],
            ["--up", "0,0,0"],
            ["--near", "0"],
            ["--split", "0"],
            ["--isa", "mmx"],
        ] {
            assert!(Args::try_parse_from(["demo", bad[0], bad[1]]).is_err(), "{bad:?} is accepted");
        }
        // A value that looks like an option is still taken as the value.
        for (option, value) in [("--near", "-1"), ("--fov", "-30"), ("--split", "-5"), ("--size", "-8x4")] {
            let error = Args::try_parse_from(["demo", option, value]).unwrap_err().to_string();
            assert!(error.contains(option) && error.contains("expected") || error.contains("pixels"), "{error}");
        }
    }
}
