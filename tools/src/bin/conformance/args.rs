//! The command line.

use clap::{Parser, ValueEnum};

use crate::kinds::Kind;

/// Compares the coverage of random triangles with that of a graphics driver, pixel by pixel.
#[derive(Parser)]
#[command(name = "conformance")]
pub struct Args {
    /// Number of triangles for each API
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub count: u64,

    /// Conventions to compare: Vulkan's, where rows run down as in Direct3D, or OpenGL's, where they run up
    #[arg(long, value_enum, default_value_t = Api::Both)]
    pub api: Api,

    /// A screen's width and height in pixels; may be given several times (default: mostly small ones, and some of each
    /// extreme)
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Vec<(u32, u32)>,

    /// The same seed gives the same triangles
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// A part of the device's name (default: a graphics card if there is one, software if not)
    #[arg(long, value_name = "PART")]
    pub device: Option<String>,

    /// A kind of triangle; may be given several times (default: all)
    #[arg(long, value_enum)]
    pub kind: Vec<Kind>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Api {
    Vulkan,
    Opengl,
    Both,
}

/// Default sizes, and how many of every hundred triangles each gets: fewer for those that take longer to read back.
const SIZES: [((u32, u32), u64); 8] = [
    ((64, 64), 40),
    ((33, 9), 10),
    ((160, 96), 20),
    ((256, 256), 20),
    ((1920, 1080), 2),
    ((4096, 64), 3),
    ((16384, 32), 3),
    ((32, 16384), 2),
];

impl Args {
    pub fn kinds(&self) -> Vec<Kind> {
        if self.kind.is_empty() { Kind::value_variants().to_vec() } else { self.kind.clone() }
    }

    /// The screens, and the number of triangles for each.
    pub fn sizes(&self) -> Vec<((u32, u32), u64)> {
        let shares = if self.size.is_empty() {
            SIZES.to_vec()
        } else {
            self.size.iter().map(|&size| (size, 1)).collect::<Vec<_>>()
        };
        let whole: u64 = shares.iter().map(|s| s.1).sum();
        shares.into_iter().map(|(size, share)| (size, (self.count * share).div_ceil(whole))).collect()
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let (w, h) = text.split_once('x').ok_or("a size is WxH, as 640x360")?;
    let side = |text: &str| match text.parse() {
        Ok(side @ 1..=16_384) => Ok(side),
        _ => Err(format!("{text} is not a number of pixels from 1 to 16384")),
    };
    Ok((side(w)?, side(h)?))
}
