//! Foliage, fences, grass: strips and soups of small triangles, in which many depths meet within 8x4 pixels and nothing
//! covers a sub-tile by itself. In no case may a rule of several layers hide much less than the quick rule does, and
//! none may hide what shows. `PRINT_SOUPS=1 cargo test --test soups -- --nocapture` prints the cases.

mod oracle;
mod support;

use fastrand::Rng;
use masked_occlusion_culling::{CullingResult, Implementation, UpdateRule, Vertices, YAxis};
use oracle::Oracle;
use oracle::snap::snapped;
use support::{RULES, both_sides, object};

const SIZE: (usize, usize) = (128, 64);
const RECTANGLES: usize = 300;

/// The corners in pixels, and the w of all three.
type Piece = ([[f32; 2]; 3], f32);

#[derive(Clone, Copy, Debug)]
enum Order {
    Near,
    Far,
    Random,
    /// Across the screen: with strips, neighbours at different depths.
    Across,
}

#[derive(Clone, Copy, Debug)]
enum Backdrop {
    None,
    /// Eight times as far as the farthest piece.
    Far,
    /// A fifth farther than the farthest piece.
    Near,
}

struct Case {
    name: String,
    pieces: Vec<Piece>,
    /// The least percentage of what the quick rule hides.
    share: usize,
}

impl Case {
    fn new(name: String, mut pieces: Vec<Piece>, order: Order, backdrop: Backdrop, random: &mut Rng) -> Self {
        match order {
            Order::Near => pieces.sort_by(|a, b| a.1.total_cmp(&b.1)),
            Order::Far => pieces.sort_by(|a, b| b.1.total_cmp(&a.1)),
            Order::Random => random.shuffle(&mut pieces),
            Order::Across => {}
        }
        let farthest = pieces.iter().map(|p| p.1).fold(0.0, f32::max);
        let behind = match backdrop {
            Backdrop::None => None,
            Backdrop::Far => Some(8.0 * farthest),
            Backdrop::Near => Some(1.2 * farthest),
        };
        if let Some(w) = behind {
            let (width, height) = (SIZE.0 as f32, SIZE.1 as f32);
            pieces.insert(0, ([[-width, -height], [3.0 * width, -height], [-width, 3.0 * height]], w));
        }
        // Drawn front to back, what is just in front of a backdrop goes first, since it costs the least depth.
        let share = if matches!((order, backdrop), (Order::Near, Backdrop::Near)) { 85 } else { 90 };
        Self { name: format!("{name}, {order:?}, backdrop {backdrop:?}"), pieces, share }
    }

    fn clip_space(&self) -> Vec<[f32; 4]> {
        let vertex = |[x, y]: [f32; 2], w: f32| {
            [(x * 2.0 / SIZE.0 as f32 - 1.0) * w, (1.0 - y * 2.0 / SIZE.1 as f32) * w, 0.0, w]
        };
        self.pieces.iter().flat_map(|(corners, w)| corners.map(|c| vertex(c, *w))).collect()
    }

    /// How many of the rectangles each rule hides, and an exact buffer.
    fn hidden(&self, seed: u64) -> ([usize; 4], usize) {
        let vertices = self.clip_space();
        let indices: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut oracle = Oracle::new(SIZE.0, SIZE.1);
        for corners in vertices.chunks(3) {
            let corners = [corners[0], corners[1], corners[2]];
            oracle.draw(&corners.map(|v| snapped(v, SIZE, false).expect("a vertex within the guard band")));
        }
        let best = *Implementation::available().last().unwrap();
        let objects = RULES.map(|rule| {
            let mut moc = object(best, rule, YAxis::Down, SIZE);
            moc.render_triangles(Vertices::clip_space(&vertices), &indices, &both_sides()).unwrap();
            moc
        });
        let (nearest, farthest) = self.pieces.iter().fold((f32::MAX, 0.0_f32), |(n, f), p| (n.min(p.1), f.max(p.1)));
        let mut random = Rng::with_seed(seed);
        let (mut hidden, mut exact) = ([0; 4], 0);
        for i in 0..RECTANGLES {
            let (width, height) = (random.f32() * 36.0 + 4.0, random.f32() * 20.0 + 4.0);
            let (x, y) = (random.f32() * (SIZE.0 as f32 - width), random.f32() * (SIZE.1 as f32 - height));
            // Half of them stand behind everything, the others anywhere among it.
            let between = if i % 2 == 0 { 1.0 } else { random.f32() };
            let w = nearest * (1.01 * farthest / nearest).powf(between);
            let shows = oracle.rectangle_shows(
                (x.into(), (x + width).into()),
                (y.into(), (y + height).into()),
                1.0 / f64::from(w),
            );
            exact += usize::from(!shows);
            let ndc = |v: f32, size: usize| v * 2.0 / size as f32 - 1.0;
            for (moc, hidden) in objects.iter().zip(&mut hidden) {
                let (left, right) = (ndc(x, SIZE.0), ndc(x + width, SIZE.0));
                let (low, high) = (-ndc(y + height, SIZE.1), -ndc(y, SIZE.1));
                if moc.test_rect(left, low, right, high, w) == CullingResult::Occluded {
                    assert!(!shows, "{}: {:?} hides what shows", self.name, moc.update_rule());
                    *hidden += 1;
                }
            }
        }
        (hidden, exact)
    }
}

/// A parallelogram as two triangles.
fn strip([a, b, c, d]: [[f32; 2]; 4], w: f32) -> [Piece; 2] {
    [([a, b, c], w), ([a, c, d], w)]
}

/// The screen covered once by strips whose depths repeat.
fn strips(direction: &str, width: usize, depths: usize, ratio: f32) -> Vec<Piece> {
    let (right, bottom, width) = (SIZE.0 as f32, SIZE.1 as f32, width as f32);
    let w = |i: usize| ratio.powi((i % depths) as i32);
    let count = |length: f32| (length / width).ceil() as usize;
    let at = |i: usize| (i as f32 * width, (i + 1) as f32 * width);
    match direction {
        "vertical" => (0..count(right))
            .flat_map(|i| {
                let (x0, x1) = at(i);
                strip([[x0, 0.0], [x1, 0.0], [x1, bottom], [x0, bottom]], w(i))
            })
            .collect(),
        "horizontal" => (0..count(bottom))
            .flat_map(|i| {
                let (y0, y1) = at(i);
                strip([[0.0, y0], [right, y0], [right, y1], [0.0, y1]], w(i))
            })
            .collect(),
        _ => (0..count(right + bottom))
            .flat_map(|i| {
                let (x0, x1) = at(i);
                strip([[x0, 0.0], [x1, 0.0], [x1 - bottom, bottom], [x0 - bottom, bottom]], w(i))
            })
            .collect(),
    }
}

/// Triangles of about `size` pixels strewn until they cover the screen `times` on average.
fn soup(random: &mut Rng, size: f32, nearest: f32, farthest: f32, times: f32) -> Vec<Piece> {
    let count = times * (SIZE.0 * SIZE.1) as f32 / (size * size / 2.0);
    (0..count as usize)
        .map(|_| {
            let (x, y) = (random.f32() * SIZE.0 as f32, random.f32() * SIZE.1 as f32);
            // On the grid of 1/256 pixel, where projecting cannot round either way.
            let grid = |v: f32| (v * 256.0).round() / 256.0;
            let mut near = |v: f32| grid(v + (random.f32() - 0.5) * 2.0 * size);
            let mut corner = || [near(x), near(y)];
            let corners = [corner(), corner(), corner()];
            (corners, nearest + random.f32() * (farthest - nearest))
        })
        .collect()
}

fn cases() -> Vec<Case> {
    let mut random = Rng::with_seed(5);
    let mut all = Vec::new();
    let backdrops = [Backdrop::None, Backdrop::Far, Backdrop::Near];
    for direction in ["vertical", "horizontal", "diagonal"] {
        for width in [1, 2, 3, 4, 6] {
            for (depths, ratio) in [(4, 1.05), (4, 2.0), (4, 4.0), (6, 1.3), (8, 2.0)] {
                for order in [Order::Near, Order::Far, Order::Random, Order::Across] {
                    for backdrop in backdrops {
                        let name =
                            format!("{direction} strips of {width} px at {depths} depths, each {ratio} times the last");
                        let pieces = strips(direction, width, depths, ratio);
                        all.push(Case::new(name, pieces, order, backdrop, &mut random));
                    }
                }
            }
        }
    }
    for size in [2.0, 4.0, 8.0, 16.0] {
        for (nearest, farthest) in [(5.0, 100.0), (1.0, 10.0), (10.0, 12.0), (1.0, 1000.0)] {
            for times in [4.0, 16.0] {
                for order in [Order::Near, Order::Far, Order::Random] {
                    for backdrop in backdrops {
                        let name = format!("triangles of {size} px at w {nearest} to {farthest}, {times} deep");
                        let pieces = soup(&mut random, size, nearest, farthest, times);
                        all.push(Case::new(name, pieces, order, backdrop, &mut random));
                    }
                }
            }
        }
    }
    all
}

#[test]
fn soups_hide_what_they_hide_with_the_quick_rule() {
    let print = std::env::var_os("PRINT_SOUPS").is_some();
    let quick = RULES.iter().position(|rule| *rule == UpdateRule::Quick).unwrap();
    let cases = cases();
    let (mut sums, mut all, mut short) = ([0; RULES.len()], 0, [0; RULES.len()]);
    let mut cliffs = Vec::new();
    for (i, case) in cases.iter().enumerate() {
        let (hidden, exact) = case.hidden(i as u64);
        all += exact;
        for (k, rule) in RULES.iter().enumerate() {
            sums[k] += hidden[k];
            let line = || format!("{rule:?}: {} of {exact}, quick {}: {}", hidden[k], hidden[quick], case.name);
            if 10 * hidden[k] < 9 * hidden[quick] {
                short[k] += 1;
                if print {
                    println!("{}", line());
                }
            }
            let several = matches!(rule, UpdateRule::ThreeLayer | UpdateRule::FourLayer);
            if several && 100 * hidden[k] < case.share * hidden[quick] {
                cliffs.push(line());
            }
        }
    }
    println!("hidden with {RULES:?}: {sums:?} of {all}; below 0.9 of quick: {short:?} of {} cases", cases.len());
    assert!(cliffs.is_empty(), "{} hide less than they should: {cliffs:#?}", cliffs.len());
}
