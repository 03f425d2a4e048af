//! Small generated scenes, the same on every machine: only integers and IEEE operations with a single correct rounding
//! (no sines, no fused operations).
#![allow(dead_code, reason = "every test uses a part of it")]

pub mod town;

/// A generator that needs nothing from the platform (splitmix64).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed(self.0)
    }

    /// From 0 to 1, exclusive.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

fn mixed(n: u64) -> u64 {
    let a = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let b = (a ^ (a >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    b ^ (b >> 31)
}

/// Vertices: x, y, z and an unused float with a matrix, else clip-space x, y, z, w. Indices of each object.
pub struct Scene {
    pub name: &'static str,
    pub near: f32,
    pub matrix: Option<[f32; 16]>,
    pub vertices: Vec<[f32; 4]>,
    pub objects: Vec<Vec<u32>>,
}

impl Scene {
    fn new(name: &'static str, near: f32, matrix: Option<[f32; 16]>) -> Self {
        Self { name, near, matrix, vertices: Vec::new(), objects: Vec::new() }
    }

    /// A vertex in clip space, computed in the plainest way.
    pub fn clip(&self, index: u32) -> [f32; 4] {
        let v = self.vertices[index as usize];
        match &self.matrix {
            None => v,
            Some(m) => [0, 1, 2, 3].map(|k| m[k] * v[0] + m[4 + k] * v[1] + m[8 + k] * v[2] + m[12 + k]),
        }
    }

    /// The rectangle around an object in normalised device coordinates and its least w; if it extends behind the eye, a
    /// w that indicates this.
    pub fn rectangle(&self, object: &[u32]) -> [f32; 5] {
        let mut r = [f32::MAX, f32::MAX, -f32::MAX, -f32::MAX, f32::MAX];
        for &i in object {
            let [x, y, _, w] = self.clip(i);
            r[4] = r[4].min(w);
            if w > 0.0 {
                r = [r[0].min(x / w), r[1].min(y / w), r[2].max(x / w), r[3].max(y / w), r[4]];
            }
        }
        r
    }

    fn add_box(&mut self, low: [f32; 3], high: [f32; 3]) {
        const FACES: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let base = self.vertices.len() as u32;
        for i in 0..8 {
            let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
            self.vertices.push([pick(0), pick(1), pick(2), 1.0]);
        }
        let object = FACES.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d].map(|i| base + i)).collect();
        self.objects.push(object);
    }
}

/// A camera: w is the distance along the view direction; `zoom` is the inverse tangent of half the vertical field of
/// view.
fn look(eye: [f32; 3], target: [f32; 3], zoom: f32, aspect: f32) -> [f32; 16] {
    let normalised = |v: [f32; 3]| {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    };
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let forward = normalised([target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]]);
    let side = normalised(cross(forward, [0.0, 1.0, 0.0]));
    let up = cross(side, forward);
    let rows = [side.map(|c| c * (zoom / aspect)), up.map(|c| c * zoom), [0.0; 3], forward];
    let mut matrix = [0.0; 16];
    for (k, row) in rows.iter().enumerate() {
        for axis in 0..3 {
            matrix[4 * axis + k] = row[axis];
        }
        matrix[12 + k] = -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]);
    }
    matrix
}

/// Triangles of all sizes and depths, everywhere; some cross the near plane or the eye's plane.
fn soup() -> Scene {
    let mut scene = Scene::new("soup", 0.25, None);
    let mut n = Numbers(31);
    for object in 0..120u32 {
        let size = [0.02, 0.1, 0.6, 3.0][object as usize % 4];
        for _ in 0..20 {
            let w = n.within(0.5, 30.0);
            let (x, y) = (n.within(-1.3, 1.3), n.within(-1.3, 1.3));
            for _ in 0..3 {
                let (dx, dy) = (n.within(-size, size), n.within(-size, size));
                let w = w + if object % 5 == 0 { n.within(-1.5 * w, w) } else { n.within(-0.1, 0.1) };
                scene.vertices.push([(x + dx) * w, (y + dy) * w, 0.0, w]);
            }
        }
        scene.objects.push((object * 60..object * 60 + 60).collect());
    }
    scene
}

/// The same with values that no program should pass: NaN, infinities, denormals, enormous numbers, w = 0.
fn hostile() -> Scene {
    const ODD: [f32; 12] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        1e-45,
        0.0,
        -0.0,
        1e20,
        -1e-20,
        3.0e9,
    ];
    let mut scene = soup();
    scene.name = "hostile";
    scene.near = 0.0;
    let mut n = Numbers(41);
    // Every other object is unchanged, so that the answers are not all the same.
    for object in (1..120u64).step_by(2) {
        for _ in 0..10 {
            let vertex = &mut scene.vertices[(object * 60 + n.next() % 60) as usize];
            vertex[[0, 1, 3][(n.next() % 3) as usize]] = ODD[(n.next() % 12) as usize];
        }
    }
    scene
}

/// All scenes.
pub fn all() -> Vec<Scene> {
    vec![town::town(), town::terrain(), town::blocks(), soup(), hostile()]
}
