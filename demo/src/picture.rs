//! The result of culling in four panels: the view, the occlusion buffer, the hidden objects, and everything from above.

use glam::{Mat4, Vec2, Vec3};

use crate::camera::{Camera, box_corners};
use crate::depth_picture::depth_picture;
use crate::exchange::{Fate, Outcome};
use crate::image::Image;
use crate::raster::{NOTHING, ZBuffer, orthographic};
use crate::scene::Scene;
use crate::shade::Light;

/// Size of a panel in pixels; the picture is two by two panels.
const WIDTH: usize = 800;
const HEIGHT: usize = 450;

/// Opacity with which drawn objects show through what covers them from above.
const SHOWS_THROUGH: f32 = 0.15;

const DRAWN: Vec3 = Vec3::new(0.36, 0.86, 0.74);
const CULLED: Vec3 = Vec3::new(1.0, 0.36, 0.28);
const OUTSIDE: Vec3 = Vec3::new(0.62, 0.64, 0.68);
const WHITE: Vec3 = Vec3::new(0.95, 0.96, 0.97);
const DARK: Vec3 = Vec3::new(0.10, 0.115, 0.135);

/// All four panels.
pub fn compose(scene: &Scene, camera: &Camera, outcome: &Outcome, size: (u32, u32)) -> Image {
    let light = Light::new(scene, camera.up, camera.look - camera.eye);
    let fitted = fit(size);
    let count = |fate| outcome.fates.iter().filter(|f| **f == fate).count();
    let (drawn, culled, outside) = (count(Fate::Visible), count(Fate::Culled), count(Fate::Outside));
    let mut picture = Image::new(WIDTH * 2, HEIGHT * 2, DARK);

    let view = view(scene, camera, outcome, &light, fitted);
    let behind = behind(scene, camera, outcome, &light, &view);
    let mut panel = |image: Image, column: usize, row: usize, label: &[(&str, Vec3)]| {
        let mut panel = Image::new(WIDTH, HEIGHT, DARK);
        panel.paste(&image, (WIDTH - image.width) / 2, (HEIGHT - image.height) / 2);
        panel.label(16, 14, label);
        picture.paste(&panel, column * WIDTH, row * HEIGHT);
    };
    panel(view.halved(), 0, 0, &[(&format!("drawn: {drawn} objects"), WHITE)]);
    panel(behind.halved(), 1, 0, &[("behind what is drawn: ", WHITE), (&format!("{culled} culled"), CULLED)]);
    let buffer_size = format!("occlusion buffer, {} x {}", size.0, size.1);
    panel(depth_picture(&outcome.depth, size, fitted), 0, 1, &[(&buffer_size, WHITE)]);
    panel(
        from_above(scene, camera, outcome, &light),
        1,
        1,
        &[
            ("from above: ", WHITE),
            (&format!("{drawn} drawn "), DRAWN),
            (&format!("{culled} culled "), CULLED),
            (&format!("{outside} outside the view"), OUTSIDE),
        ],
    );
    for i in 0..WIDTH * 2 {
        for thick in -2..2 {
            picture.blend(i as i32, HEIGHT as i32 + thick, DARK, 1.0);
            picture.blend(WIDTH as i32 + thick, i as i32, DARK, 1.0);
        }
    }
    picture
}

/// The largest size within a panel with the aspect ratio of the occlusion buffer.
fn fit((width, height): (u32, u32)) -> (usize, usize) {
    let (width, height) = (width as usize, height as usize);
    if width * HEIGHT >= height * WIDTH {
        (WIDTH, (WIDTH * height / width).max(1))
    } else {
        ((HEIGHT * width / height).max(1), HEIGHT)
    }
}

/// Only the objects that are drawn, at twice the size.
fn view(scene: &Scene, camera: &Camera, outcome: &Outcome, light: &Light, (width, height): (usize, usize)) -> Image {
    let clip = camera.clip_from_world();
    let mut buffer = ZBuffer::new(width * 2, height * 2);
    draw(&mut buffer, scene, &clip, camera.near, |i| outcome.fates[i] == Fate::Visible);
    let sky = |y: f32| Vec3::new(0.40, 0.60, 0.84).lerp(Vec3::new(0.83, 0.89, 0.94), (y * 1.7).min(1.0));
    let (lo, hi) = scene.bounds();
    light.picture(scene, &buffer, &clip, |_, colour| colour, sky, Some((camera.eye, (hi - lo).length() * 2.5)))
}

/// The view in grey, with the culled objects showing through.
fn behind(scene: &Scene, camera: &Camera, outcome: &Outcome, light: &Light, view: &Image) -> Image {
    let clip = camera.clip_from_world();
    let mut buffer = ZBuffer::new(view.width, view.height);
    draw(&mut buffer, scene, &clip, camera.near, |i| outcome.fates[i] == Fate::Culled);
    let culled = light.picture(scene, &buffer, &clip, |_, _| CULLED.powf(1.3), |_| Vec3::ZERO, None);
    let mut image = Image::new(view.width, view.height, Vec3::ZERO);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        let grey = Vec3::splat(view.pixels[i].dot(Vec3::new(0.3, 0.59, 0.11)));
        *pixel = if buffer.owner[i].0 == NOTHING {
            grey * 0.62 + DARK * 0.3
        } else {
            // Edges between objects are drawn where neighbouring pixels differ.
            let neighbour = buffer.owner[if i % view.width == 0 { i } else { i - 1 }].0;
            let edge = if neighbour == buffer.owner[i].0 { 1.0 } else { 0.6 };
            grey * 0.22 + culled.pixels[i] * 0.82 * edge
        };
    }
    image
}

/// All objects from above; the camera is on the left and looks to the right.
fn from_above(scene: &Scene, camera: &Camera, outcome: &Outcome, light: &Light) -> Image {
    let ahead = (camera.look - camera.eye).reject_from_normalized(camera.up);
    let ahead = ahead.try_normalize().unwrap_or(camera.up.any_orthonormal_vector());
    let side = ahead.cross(camera.up);
    let into = camera.up.cross(ahead * 0.8 + side * 0.6);
    let direction = (into * 0.9 - camera.up).normalize();
    let mut points = vec![camera.eye];
    for (object, _) in scene.objects.iter().zip(&outcome.fates).filter(|(_, f)| **f != Fate::Outside) {
        points.extend(box_corners(object.lo, object.hi));
    }
    let clip = orthographic(&points, direction, camera.up, WIDTH as f32, HEIGHT as f32);

    let render = |wanted: &dyn Fn(Fate) -> bool| {
        let mut buffer = ZBuffer::new(WIDTH * 2, HEIGHT * 2);
        draw(&mut buffer, scene, &clip, f32::NEG_INFINITY, |i| wanted(outcome.fates[i]));
        let paint = |i: usize, colour: Vec3| {
            let grey = 0.35 + 0.65 * colour.dot(Vec3::new(0.3, 0.59, 0.11));
            grey * match outcome.fates[i] {
                Fate::Visible => DRAWN,
                Fate::Culled => CULLED * 0.9,
                Fate::Outside => Vec3::splat(0.3),
            }
        };
        let image = light.picture(scene, &buffer, &clip, paint, |_| DARK, None);
        (buffer, image)
    };
    // The topmost object has its own colour; drawn objects below it show through a little.
    let (_, mut image) = render(&|_| true);
    let (buffer, drawn) = render(&|fate| fate == Fate::Visible);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        if buffer.owner[i].0 != NOTHING {
            *pixel = pixel.lerp(drawn.pixels[i], SHOWS_THROUGH);
        }
    }

    let mut image = image.halved();
    let on_panel = |p: Vec3| {
        let p = clip.project_point3(p);
        Vec2::new((p.x * 0.5 + 0.5) * WIDTH as f32, (0.5 - p.y * 0.5) * HEIGHT as f32)
    };
    let eye = on_panel(camera.eye);
    let (lo, hi) = scene.bounds();
    let spread = (camera.fov / 2.0).tan() * camera.aspect;
    for sign in [-1.0, 1.0] {
        let edge = (ahead + side * spread * sign).normalize() * (hi - lo).length();
        image.line(eye, on_panel(camera.eye + edge), 2.0, WHITE, 0.85);
    }
    image.line(eye, eye, 13.0, DARK, 1.0);
    image.line(eye, eye, 9.0, WHITE, 1.0);
    image
}

fn draw(buffer: &mut ZBuffer, scene: &Scene, clip: &Mat4, near: f32, wanted: impl Fn(usize) -> bool) {
    for (id, object) in scene.objects.iter().enumerate().filter(|(id, _)| wanted(*id)) {
        buffer.draw(object, id as u32, clip, near);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn a_buffer_keeps_its_shape_in_its_panel() {
        assert_eq!(fit((1920, 1080)), (800, 450));
        assert_eq!(fit((640, 640)), (450, 450));
        assert_eq!(fit((1000, 100)), (800, 80));
        assert_eq!(fit((16_384, 1)), (800, 1));
        assert_eq!(fit((1, 16_384)), (1, 450));
    }

    fn plate(scene: &mut Scene, lo: Vec3, hi: Vec3) {
        let mut mesh = Mesh::default();
        mesh.cuboid(lo, hi, Vec3::ONE);
        scene.add(mesh, true, false);
    }

    /// A drawn ground, half of it under a culled roof.
    #[test]
    fn from_above_what_is_on_top_keeps_its_colour() {
        let mut scene = Scene::default();
        plate(&mut scene, Vec3::new(-10.0, -1.0, -10.0), Vec3::new(10.0, 0.0, 10.0));
        plate(&mut scene, Vec3::new(-10.0, 1.0, -10.0), Vec3::new(0.0, 2.0, 10.0));
        let camera =
            Camera { eye: Vec3::new(0.0, 0.5, 20.0), look: Vec3::ZERO, up: Vec3::Y, fov: 1.0, near: 0.1, aspect: 1.0 };
        let light = Light::new(&scene, camera.up, camera.look - camera.eye);
        let red = |roof| {
            let outcome = Outcome { fates: vec![Fate::Visible, roof], depth: Vec::new() };
            let image = from_above(&scene, &camera, &outcome, &light);
            image.pixels.iter().filter(|p| p.x - p.y > 0.1).count()
        };
        assert_eq!(red(Fate::Visible), 0);
        assert!(red(Fate::Culled) > 20_000, "only {} pixels are red", red(Fate::Culled));
    }

    #[test]
    fn the_view_shows_what_is_drawn_only() {
        let mut scene = Scene::default();
        plate(&mut scene, Vec3::new(-1.0, -1.0, -6.0), Vec3::new(1.0, 1.0, -5.0));
        let camera = Camera { eye: Vec3::ZERO, look: Vec3::NEG_Z, up: Vec3::Y, fov: 1.0, near: 0.1, aspect: 1.0 };
        let light = Light::new(&scene, camera.up, camera.look - camera.eye);
        let middle = |fate| {
            let outcome = Outcome { fates: vec![fate], depth: Vec::new() };
            view(&scene, &camera, &outcome, &light, (20, 20)).pixels[20 * 40 + 20]
        };
        assert_ne!(middle(Fate::Visible), middle(Fate::Culled));
        assert_eq!(middle(Fate::Outside), middle(Fate::Culled));
    }
}
