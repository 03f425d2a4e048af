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
                    (found.settings) " settings a scene, medians of " (found.repeats) " repeats" }
                @if let Some(caution) = found.caution() { p { strong { (caution) } } }
                p { "Made by " code { "cargo tool report" (found.arguments) } ". Times of a machine that does other things, too, "
                    "differ from run to run: compare those of a page with each other, not with those of another page." }

                h2 { "What is measured" }
                p { "A scene is seen from one place or several. The occluders in view are drawn, then the rectangles of all objects in "
                    "view and of small boxes strewn over the scene are tested. A z-buffer with a depth for each pixel of a screen of "
                    "1920x1080, which shares no code with the library, says what is hidden: objects of which every pixel lies behind an "
                    "occluder, and boxes whose rectangle lies behind it. Shares are the parts of those that are culled. "
                    "\"Exact\" is what that z-buffer itself culls by rectangles; \"8x4 ceiling\" what it culls with only the least "
                    "depth of each 8x4 pixels, which layers may exceed. \"Falsely\" counts what is culled and shows at the buffer's own resolution, which must be 0; "
                    "\"on screen\" objects that show on the screen when the buffer has fewer pixels than it: a small buffer cannot know them. "
                    "\"Leaking\" are pixels that claim less than half of the true 1/w." }
                p { "In all of it: " b { (found.falsely()) } " falsely culled; " (found.same_bits()) " buffers compared between instruction "
                    "sets and numbers of threads, " b { (found.other_bits()) } " of them different." }

                h2 { "Speed against error" }
                @for scatter in &scatters { (scatter) }
                h3 { "Update rules" }
                p { "Percent of the hidden objects / boxes culled at the largest resolution measured, and the time of a frame (draw and query) "
                    "over that of the quick rule in the same order. One buffer, one thread." }
                (table(&tables::rules(surveys)))
                h3 { "What else can be set" }
                p { "Means over scenes and orders: time of drawing over that of the plain setting (the largest resolution measured, one buffer, one thread, the best "
                    "instruction set) with the same rule and order, and how many percent of the hidden objects and boxes more or less are culled. "
                    "Where several buffers are merged, objects are dealt to them by how wide a range of depth they reach over." }
                @for t in tables::effects(surveys) { (table(&t)) }
                @for survey in surveys {
                    details { summary { "Every setting: " (survey.name) } (table(&tables::points(survey))) }
                }

                h2 { "Where pixels leak" }
                p { "As figure 1 of Davies and Strugar's article of 2018: the exact depths, and in red the pixels for which the buffer claims less "
                    "than half of the true 1/w, so that things far behind may count as seen. 1920x1080, front to back." }
                @for picture in &pictures { (picture) }

                h2 { "How cost grows" }
                p { "Time of a frame against triangles, pixels, and sheets one behind the other; the z-buffer's with its reduction." }
                @for svg in &found.scaling { (plot(svg.clone())) }

                h2 { "The passes of a frame" }
                p { "As table 1 of the HPG 2016 paper, for the first view of each scene, 1920x1080, the nearest first. The z-buffer of all pixels "
                    "uses AVX-512, or AVX2 with fused multiply-add (below these it is not written with vectors), draws exact coverage, and reduces to the farthest depth of "
                    "each 8x8 pixels. To have its passes apart the masked buffer is drawn by way of a list; \"in one go\" is the frame as an engine "
                    "draws it. \"Culled\" counts rectangles of objects and boxes." }
                @for (name, rows) in &found.passes { h3 { (name) } (table(&tables::passes(rows))) }

                h2 { "Cost by the size of triangles" }
                p { "As figure 11 of that paper: 32,768 right-angled isosceles triangles (fewer of the largest), anywhere on a screen of "
                    (found.sizes_on.0) "x" (found.sizes_on.1) ", turned anyhow, back to front so that none is hidden; the clear, everything from transformation on, and the z-buffer's "
                    "reduction. The masked buffer is drawn into through its C functions, which trust their indices; the z-buffer looks at them." }
                (per_triangle) (per_pixel)
                (table(&tables::sizes(&found.sizes, &found.libraries)))

                h2 { "Merging" }
                p { "As table 1 of the article of 2018, for the generated landscape: terrain and foreground in a buffer each, and the time of "
                    "merging them beside that of drawing both; then everything in one buffer. The last columns are the hidden boxes culled by the one "
                    "buffer and by the merged one, and what should not have been." }
                (table(&tables::merging(&found.merging)))
            }
        }
    };
    Ok(page.into_string())
}
