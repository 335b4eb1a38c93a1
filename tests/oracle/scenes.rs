//! Scenes and views from seeds.

use glam::{DMat4, DVec3, DVec4, Mat3, Vec3};
use homcull::raster::Facing;
use homcull::scene::{Mesh, Object, PreparedScene, Scene};
use homcull::view::{Camera, ClipSpace, DepthRange, View, Viewport};

use super::random::Random;

/// A scene being put together.
#[derive(Default)]
pub struct Builder(pub Scene);

impl Builder {
    pub fn new() -> Builder {
        Builder::default()
    }

    /// An object with a mesh of its own.
    pub fn add(&mut self, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, facing: Facing) -> &mut Object {
        let id = self.0.objects.len();
        self.0.meshes.push(Mesh::new("mesh", positions, triangles).unwrap());
        self.0.objects.push(Object {
            name: format!("{id}"),
            mesh: self.0.meshes.len() as u32 - 1,
            rotation: Mat3::IDENTITY,
            position: DVec3::ZERO,
            facing,
            color: [(id * 37 % 251) as u8, (id * 91 % 241) as u8, (id * 17 % 239) as u8],
            opacity: 1.0,
        });
        self.0.objects.last_mut().unwrap()
    }

    pub fn triangles(&mut self, triangles: &[[Vec3; 3]], facing: Facing) -> &mut Object {
        let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        self.add(triangles.as_flattened().to_vec(), indices, facing)
    }

    pub fn cuboid(&mut self, min: Vec3, max: Vec3, facing: Facing) -> &mut Object {
        self.add(cuboid_corners(min, max).to_vec(), CUBOID.to_vec(), facing)
    }

    pub fn prepared(&self) -> PreparedScene {
        PreparedScene::new(&self.0).unwrap()
    }
}

/// Bit `axis` of a corner's number chooses the greater side.
pub fn cuboid_corners(min: Vec3, max: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|n| Vec3::from_array(std::array::from_fn(|i| if n >> i & 1 != 0 { max[i] } else { min[i] })))
}

/// Counter-clockwise from outside.
pub const CUBOID: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

pub fn viewport(width: u32, height: u32) -> Viewport {
    Viewport::new(width, height).unwrap()
}

/// A view whose world is the screen: x and y in samples from the top left, z the reversed depth.
pub fn flat_view(viewport: Viewport) -> View {
    let (w, h) = (f64::from(viewport.width()), f64::from(viewport.height()));
    let m = DMat4::from_cols(
        DVec4::new(2.0 / w, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0 / h, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(-1.0, -1.0, 0.0, 1.0),
    );
    View::from_eye(DVec3::ZERO, m, ClipSpace { depth: DepthRange::Reversed, y_down: true }, viewport).unwrap()
}

pub fn direction(r: &mut Random) -> DVec3 {
    loop {
        let v = DVec3::new(r.range(-1.0, 1.0), r.range(-1.0, 1.0), r.range(-1.0, 1.0));
        if (0.1..1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

/// A perspective camera at `eye`, looking anywhere.
pub fn camera(r: &mut Random, eye: DVec3) -> Camera {
    let ahead = direction(r);
    let up = if ahead.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    let far = r.chance(0.3).then(|| r.range(200.0, 2000.0));
    Camera { eye, target: eye + ahead, up, fov_y_deg: r.range(25.0, 110.0), near: r.range(0.05, 0.5), far }
}

/// Reversed depth, numbers rounded so that every convention can say the same exactly.
pub fn orthographic(r: &mut Random, eye: DVec3) -> DMat4 {
    let ahead = direction(r);
    let right = ahead.cross(if ahead.y.abs() > 0.9 { DVec3::X } else { DVec3::Y }).normalize();
    let up = right.cross(ahead);
    let (half, depth) = (r.range(5.0, 40.0), r.range(60.0, 200.0));
    // z is 1 at the near plane through the eye and 0 at `depth` ahead.
    let rows = [right / half, up / half, -ahead / depth];
    let constants = [-eye.dot(right) / half, -eye.dot(up) / half, 1.0 + eye.dot(ahead) / depth];
    let rows = [0, 1, 2].map(|i| rows[i].extend(constants[i]));
    round(DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose())
}

/// A view-projection matrix over world positions, reversed depth, rounded as in [`orthographic`].
pub fn perspective(r: &mut Random, eye: DVec3) -> DMat4 {
    let camera = camera(r, eye);
    let ahead = (camera.target - eye).normalize();
    let right = ahead.cross(camera.up).normalize();
    let up = right.cross(ahead);
    let focal = 1.0 / (camera.fov_y_deg.to_radians() * 0.5).tan();
    let row = |v: DVec3| v.extend(-v.dot(eye));
    let z = match camera.far {
        None => DVec4::new(0.0, 0.0, 0.0, camera.near),
        Some(far) => {
            let k = camera.near / (far - camera.near);
            row(-ahead * k) + DVec4::new(0.0, 0.0, 0.0, camera.near + k * camera.near)
        }
    };
    round(DMat4::from_cols(row(right * focal), row(up * focal), z, row(ahead)).transpose())
}

fn round(m: DMat4) -> DMat4 {
    DMat4::from_cols_array(&m.to_cols_array().map(|v| (v * f64::from(1 << 30)).round() / f64::from(1 << 30)))
}

/// The same view in another convention.
pub fn restated(m: DMat4, space: ClipSpace) -> DMat4 {
    let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
    let y = if space.y_down { -y } else { y };
    let z = match space.depth {
        DepthRange::Reversed => z,
        DepthRange::ZeroToOne => w - z,
        DepthRange::MinusOneToOne => w - z * 2.0,
    };
    DMat4::from_cols(x, y, z, w).transpose()
}

/// Triangles for a flat view, of one of the kinds that break rasterizers.
pub const KINDS: usize = 12;

pub fn flat_triangle(r: &mut Random, kind: usize, width: u32, height: u32) -> [Vec3; 3] {
    let (w, h) = (f64::from(width), f64::from(height));
    let anywhere = |r: &mut Random| (r.range(-20.0, w + 20.0), r.range(-20.0, h + 20.0));
    let half = |r: &mut Random, n: usize| (r.below(2 * n) as f64 * 0.5, r.below(2 * n) as f64 * 0.5);
    let side = width.max(height) as usize;
    let start = anywhere(r);
    let points: [(f64, f64); 3] = match kind {
        // On the samples and between them: every edge rule is asked.
        0 => [half(r, side), half(r, side), half(r, side)],
        1 => {
            let (a, b) = (half(r, side), half(r, side));
            [a, (b.0, a.1), (a.0, b.1)]
        }
        // A needle.
        2 => [start, (start.0 + r.range(-0.02, 0.02), start.1 + r.range(-0.02, 0.02)), anywhere(r)],
        // A sliver: three points almost on a line.
        3 => {
            let b = anywhere(r);
            let t = r.range(-0.5, 1.5);
            let middle = (start.0 + t * (b.0 - start.0), start.1 + t * (b.1 - start.1));
            [start, b, (middle.0 + r.range(-0.01, 0.01), middle.1 + r.range(-0.01, 0.01))]
        }
        // To the ends of the guard band.
        4 => std::array::from_fn(|_| (r.range(-32_700.0, 32_700.0), r.range(-32_700.0, 32_700.0))),
        5 => std::array::from_fn(|_| (r.below(2) as f64 * 65_534.0 - 32_767.0, r.range(-32_767.0, 32_767.0))),
        // A huge one whose edge crosses the screen.
        6 => [start, (start.0 + r.range(-3.0e4, 3.0e4), start.1 + r.range(-3.0e4, 3.0e4)), anywhere(r)],
        // Smaller than a sample.
        7 => std::array::from_fn(|_| (start.0 + r.range(-0.4, 0.4), start.1 + r.range(-0.4, 0.4))),
        // About the greatest size of the kernel for small ones.
        8 => {
            let (a, b) = (r.range(0.0, 18.3), 0.0);
            let size = (a, 18.285 + r.range(-0.02, 0.02) - a + b);
            [start, (start.0 + size.0, start.1), (start.0 + r.range(0.0, size.0), start.1 + size.1)]
        }
        // No area.
        9 => [start, anywhere(r), start],
        // A few samples.
        10 => std::array::from_fn(|_| (start.0 + r.range(-9.0, 9.0), start.1 + r.range(-9.0, 9.0))),
        _ => [start, anywhere(r), anywhere(r)],
    };
    let z = r.range(0.1, 0.9);
    points.map(|(x, y)| {
        let z = if kind.is_multiple_of(2) { z } else { r.range(0.1, 0.9) };
        Vec3::new(x as f32, y as f32, z as f32)
    })
}

/// Streets of boxes on a plain, with the eye at `eye` somewhere among them; some objects are odd on purpose.
pub fn city(r: &mut Random, eye: Vec3, objects: usize) -> Scene {
    let mut b = Builder::new();
    let facing = |r: &mut Random| if r.chance(0.5) { Facing::Front } else { Facing::Both };
    for _ in 0..objects {
        let f = facing(r);
        let at = eye + Vec3::new(r.float(-45.0, 45.0), 0.0, r.float(-45.0, 45.0));
        let kind = r.below(14);
        let size = match kind {
            // Flat boxes, along each axis.
            0 => Vec3::new(0.0, r.float(1.0, 9.0), r.float(1.0, 9.0)),
            1 => Vec3::new(r.float(1.0, 9.0), 0.0, r.float(1.0, 9.0)),
            // Long walls beside the eye, and through its near plane.
            2 => Vec3::new(r.float(0.0, 0.5), r.float(2.0, 6.0), r.float(50.0, 200.0)),
            3 => Vec3::new(r.float(50.0, 200.0), r.float(2.0, 6.0), r.float(0.0, 0.5)),
            // Specks.
            4..=6 => Vec3::new(r.float(0.001, 0.3), r.float(0.001, 0.3), r.float(0.001, 0.3)),
            _ => Vec3::new(r.float(1.0, 8.0), r.float(2.0, 20.0), r.float(1.0, 8.0)),
        };
        let ground = eye.y - r.float(-1.0, 3.0);
        let min = Vec3::new(at.x, ground, at.z) - Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
        match r.below(8) {
            // A soup in the same place.
            0 => {
                let p =
                    |r: &mut Random| min + size * Vec3::new(r.float(0.0, 1.0), r.float(0.0, 1.0), r.float(0.0, 1.0));
                let soup: Vec<[Vec3; 3]> = (0..1 + r.below(12)).map(|_| [p(r), p(r), p(r)]).collect();
                b.triangles(&soup, Facing::Both);
            }
            // Turned, scaled, mirrored, and placed by its position.
            1 => {
                let (angle, scale) = (r.range(0.0, 6.2), r.range(0.5, 1.5));
                let object = b.cuboid(-size * 0.5, size * 0.5, f);
                let (s, c) = (angle.sin() * scale, angle.cos() * scale);
                let mirror = if r.chance(0.5) { -1.0 } else { 1.0 };
                object.rotation = Mat3::from_cols(
                    Vec3::new(c as f32 * mirror, 0.0, -s as f32 * mirror),
                    Vec3::new(0.0, scale as f32, 0.0),
                    Vec3::new(s as f32, 0.0, c as f32),
                );
                object.position = (min + size * 0.5).as_dvec3();
            }
            _ => {
                b.cuboid(min, min + size, f);
            }
        }
    }
    // Boxes around the eye: the eye is inside, and the near plane with it.
    for reach in [0.02, 0.3, 300.0] {
        let reach = Vec3::splat(reach);
        // Two-sided and close, it would hide all the others.
        let f = if reach.x > 100.0 || r.chance(0.1) { Facing::Both } else { Facing::Front };
        b.cuboid(eye - reach, eye + reach, f);
    }
    b.0
}
