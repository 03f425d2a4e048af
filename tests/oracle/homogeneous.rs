//! Coverage and depth of a triangle that crosses the near plane, without clipping it: every pixel's ray
//! is intersected with the triangle in homogeneous coordinates, in double.

/// The position of a pixel centre relative to a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Inside by more than the tolerance, and beyond the near plane.
    Inside,
    /// Within the tolerance of an edge or of the near plane's trace.
    Border,
    /// Outside by more than the tolerance.
    Outside,
}

/// A triangle as the barycentric weights over w of a pixel, each affine in the pixel position.
pub struct Homogeneous {
    /// Value at pixel position (0, 0), change along x, change along y: of the three weights, then of their sum, 1/w.
    terms: [[f64; 3]; 4],
    /// How much each changes over a pixel along its steepest direction.
    slopes: [f64; 4],
    near: f64,
}

impl Homogeneous {
    /// From clip-space (x, y, w); `y_up` counts rows from the bottom. `None` if it is edge-on.
    pub fn new(v: &[[f64; 3]; 3], near: f64, size: (usize, usize), y_up: bool) -> Option<Self> {
        let cross = |a: &[f64; 3], b: &[f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let rows = [cross(&v[1], &v[2]), cross(&v[2], &v[0]), cross(&v[0], &v[1])];
        let det = v[0][0] * rows[0][0] + v[0][1] * rows[0][1] + v[0][2] * rows[0][2];
        let length = |a: &[f64; 3]| a.iter().map(|c| c * c).sum::<f64>().sqrt();
        if det.abs() <= 1e-9 * length(&v[0]) * length(&v[1]) * length(&v[2]) {
            return None;
        }
        let (w, h) = (size.0 as f64, size.1 as f64);
        // Position (0, 0) is the corner at the start of row 0: x = -1 there, and y = -1 or 1.
        let (y0, dy) = if y_up { (-1.0, 2.0 / h) } else { (1.0, -2.0 / h) };
        let mut terms = [[0.0; 3]; 4];
        for i in 0..3 {
            let [a, b, c] = rows[i].map(|x| x / det);
            terms[i] = [c - a + b * y0, a * 2.0 / w, b * dy];
            let term = terms[i];
            terms[3].iter_mut().zip(term).for_each(|(sum, t)| *sum += t);
        }
        Some(Self { terms, slopes: terms.map(|[_, dx, dy]| dx.hypot(dy)), near })
    }

    fn value(&self, term: usize, x: f64, y: f64) -> f64 {
        let [c, dx, dy] = self.terms[term];
        c + dx * x + dy * y
    }

    /// 1/w at a pixel centre.
    pub fn depth(&self, column: usize, row: usize) -> f64 {
        self.value(3, column as f64 + 0.5, row as f64 + 0.5)
    }

    /// How much 1/w changes within a pixel in x and y.
    pub fn slope(&self) -> f64 {
        self.terms[3][1].abs() + self.terms[3][2].abs()
    }

    /// The position of a pixel centre; `tolerance` in pixels.
    pub fn place(&self, column: usize, row: usize, tolerance: f64) -> Place {
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        let mut place = Place::Inside;
        for term in 0..4 {
            let mut value = self.value(term, x, y);
            if term == 3 {
                if self.near <= 0.0 {
                    continue;
                }
                value = 1.0 / self.near - value;
            }
            let margin = tolerance * self.slopes[term];
            if value < -margin {
                return Place::Outside;
            }
            if value <= margin {
                place = Place::Border;
            }
        }
        place
    }

    /// The signed distance, in pixels, from a pixel's centre to a line; positive on the side where `value` is.
    fn distance(value: f64, [_, dx, dy]: [f64; 3]) -> f64 {
        let slope = (dx * dx + dy * dy).sqrt();
        if slope > 0.0 { value / slope } else { f64::INFINITY.copysign(value) }
    }

    /// The signed distance, in pixels, from a pixel's centre to the lines of the three edges: positive inside, to the
    /// nearest line; negative outside, to the farthest of the lines that it is outside of.
    pub fn within_edges_by(&self, column: usize, row: usize) -> f64 {
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        (0..3).fold(f64::INFINITY, |least, k| least.min(Self::distance(self.value(k, x, y), self.terms[k])))
    }

    /// The signed distance, in pixels, from a pixel's centre to the near plane's trace; positive on the visible side.
    pub fn beyond_near_by(&self, column: usize, row: usize) -> f64 {
        if self.near <= 0.0 {
            return f64::INFINITY;
        }
        Self::distance(1.0 / self.near - self.depth(column, row), self.terms[3])
    }

    /// The smaller of the two.
    pub fn inside_by(&self, column: usize, row: usize) -> f64 {
        self.within_edges_by(column, row).min(self.beyond_near_by(column, row))
    }

    /// The least 1/w of the plane over the block of 8x4 pixels that contains a pixel.
    pub fn block_depth(&self, column: usize, row: usize) -> f64 {
        let (x, y) = ((column / 8 * 8) as f64, (row / 4 * 4) as f64);
        let corners = [(x, y), (x + 8.0, y), (x, y + 4.0), (x + 8.0, y + 4.0)];
        corners.iter().fold(f64::MAX, |m, &(x, y)| m.min(self.value(3, x, y)))
    }
}
