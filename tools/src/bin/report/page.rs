//! The page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::machine::{day, machine};
use crate::tables::{self, Table};
use crate::{Findings, plots, scatter};
use demo::image::Image;
use tools::Result;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}
h1{font-size:1.7em}h2{margin-top:2em;border-bottom:1px solid #ccc}
table{border-collapse:collapse;font-size:13px;margin:1em 0;display:block;overflow-x:auto}
th,td{padding:2px 9px;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}
th:first-child,td:first-child{text-align:left}tr:hover td{background:#f4f6fa}
svg{max-width:100%;height:auto}figure{margin:0 0 1em;display:inline-block;width:49%;vertical-align:top}
figure.wide{width:100%}figure img{width:100%}figcaption{font-size:13px;color:#555}
summary{cursor:pointer}";

fn table(table: &Table) -> Markup {
    html! {
        table {
            thead { tr { @for cell in &table.head { th { (cell) } } } }
            tbody { @for row in &table.rows { tr { @for cell in row { td { (cell) } } } } }
        }
    }
}

fn picture(image: &Image, caption: &str) -> Result<Markup> {
    let mut bytes = Vec::new();
    image.write_png(&mut bytes)?;
    let source = format!("data:image/png;base64,{}", STANDARD.encode(bytes));
    Ok(html! { figure { img src=(source) alt=(caption); figcaption { (caption) } } })
}

fn plot(svg: String) -> Markup {
    html! { figure.wide { (PreEscaped(svg)) } }
}

/// The version in the library's Cargo.toml; this package has its own.
fn library_version() -> &'static str {
    let manifest = include_str!("../../../../Cargo.toml");
    manifest.lines().find_map(|line| line.strip_prefix("version = ")).map_or("", |version| version.trim_matches('"'))
}

/// The whole page, in a single file.
pub fn write(found: &Findings) -> Result<String> {
    let mut scatters = Vec::new();
    for (survey, baselines) in found.surveys.iter().zip(&found.baselines) {
        scatters.push(plot(scatter::speed_against_error(survey, baselines)?));
    }
    let mut pictures = Vec::new();
    for (image, caption) in &found.leaks {
        pictures.push(picture(image, caption)?);
    }
    let sizes = [false, true].map(|per_pixel| plots::triangle_sizes(&found.sizes, &found.libraries, per_pixel));
    let [per_triangle, per_pixel] = sizes;
    let (per_triangle, per_pixel) = (plot(per_triangle?), plot(per_pixel?));
    let surveys = &found.surveys;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "Speed against error" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Masked occlusion culling: speed against error" }
                p { (machine()) br; (day()) ", version " (library_version()) ", "
                    (found.settings) " settings per scene, medians of " (found.repeats) " repeats" }
                @if let Some(caution) = found.caution() { p { strong { (caution) } } }
                p { "Made by " code { "cargo tool report" (found.arguments) } ". Times from a machine that was also doing other work "
                    "vary between runs: compare times within this page, not across pages." }

                h2 { "What is measured" }
                p { "Each scene is viewed from one or more cameras. The occluders in view are drawn, then the rectangles of all objects in view, "
                    "and of small boxes scattered through the scene, are tested. A z-buffer with one depth per pixel of a 1920x1080 screen, which "
                    "shares no code with the library, determines what is hidden: an object if all of its pixels are behind an occluder, a box if "
                    "its whole rectangle is. The shares are percentages of these hidden objects and boxes that were culled. "
                    "\"Exact\" is what that z-buffer culls by rectangles; \"8x4 ceiling\" is what it culls when it "
                    "keeps only the farthest depth of each block of 8x4 pixels, which a buffer with layers can exceed. "
                    "\"Falsely\" counts objects and boxes culled although at least one of their pixels is visible at "
                    "the buffer's own resolution: this must be 0. \"On screen\" counts culled objects with a visible "
                    "pixel on the screen when the buffer is smaller than the screen, which such a buffer cannot "
                    "detect. \"Leaking\" pixels are those for which the buffer stores less than half of the true 1/w." }
                p { "In total: " b { (found.falsely()) } " falsely culled; " (found.same_bits()) " buffers compared between instruction "
                    "sets and thread counts, of which " b { (found.other_bits()) } " differ." }

                h2 { "Speed against error" }
                @for scatter in &scatters { (scatter) }
                h3 { "Update rules" }
                p { "Percentage of the hidden objects / boxes that were culled, at the largest resolution measured, and the time of a frame (draw and "
                    "query) relative to the quick rule in the same order. One buffer, one thread." }
                (table(&tables::rules(surveys)))
                h3 { "Other settings" }
                p { "Means over scenes and orders: drawing time relative to the baseline setting (the largest "
                    "resolution measured, one buffer, one thread, the best instruction set) with the same rule and "
                    "order, and the change in the percentage of hidden objects and boxes that were culled. Where "
                    "several buffers are merged, objects are assigned to buffers by the extent of their depth range." }
                @for t in tables::effects(surveys) { (table(&t)) }
                @for survey in surveys {
                    details { summary { "Every setting: " (survey.name) } (table(&tables::points(survey))) }
                }

                h2 { "Where pixels leak" }
                p { "As in figure 1 of Davies and Strugar's 2018 article: the exact depths, with the pixels in red for "
                    "which the buffer stores less than half of the true 1/w, so that objects far behind them may be "
                    "reported visible. 1920x1080, front to back." }
                @for picture in &pictures { (picture) }

                h2 { "How cost grows" }
                p { "Frame time as a function of the number of triangles, pixels and overlapping layers. The "
                    "z-buffer's time includes its reduction." }
                @for svg in &found.scaling { (plot(svg.clone())) }

                h2 { "The passes of a frame" }
                p { "As in table 1 of the HPG 2016 paper, for the first view of each scene at 1920x1080, front to "
                    "back. The z-buffer with one depth per pixel uses AVX-512, or AVX2 with fused multiply-add "
                    "(without these it is scalar code), computes exact coverage, and is reduced to the farthest depth "
                    "of each block of 8x8 pixels. To separate the passes, the masked buffer is drawn from a triangle "
                    "list; \"in one go\" is the frame as an engine draws it. \"Culled\" counts rectangles of objects "
                    "and boxes." }
                @for (name, rows) in &found.passes { h3 { (name) } (table(&tables::passes(rows))) }

                h2 { "Cost by triangle size" }
                p { "As in figure 11 of the HPG 2016 paper: 32,768 right isosceles triangles (fewer at the largest "
                    "sizes), at random positions and angles on a screen of " (found.sizes_on.0) "x" (found.sizes_on.1)
                    ", back to front so that none is hidden. Times include the clear, all steps from the vertex "
                    "transform on, and the z-buffer's reduction. The masked buffer is drawn through the C functions "
                    "that trust their indices; the z-buffer checks them." }
                (per_triangle) (per_pixel)
                (table(&tables::sizes(&found.sizes, &found.libraries)))

                h2 { "Merging" }
                p { "As in table 1 of the 2018 article, for the generated landscape: terrain and foreground in "
                    "separate buffers, with the time to merge them next to the time to draw both; then everything in "
                    "one buffer. The last columns give the hidden boxes culled by the single buffer and by the merged "
                    "one, and the false culls." }
                (table(&tables::merging(&found.merging)))
            }
        }
    };
    Ok(page.into_string())
}
