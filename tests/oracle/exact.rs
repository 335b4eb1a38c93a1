//! The documented transform in plain f32, and coverage by integers of 128 bits.

use glam::{DVec3, Mat3, Vec3};
use homcull::raster::Facing;
use homcull::view::View;

/// 32768 samples, in subpixels: what reaches further is clipped.
const GUARD: f32 = 8_388_608.0;

/// The view's rows for objects at one position (SEMANTICS, *Samples, facing, transform*).
pub struct Transform {
    eye: [f32; 3],
    rows: [[f32; 4]; 5],
}

/// A vertex on the screen.
#[derive(Debug, Clone, Copy)]
pub struct Vertex {
    /// x, y (subpixels times w), w, depth, near.
    pub clip: [f32; 5],
    /// Snapped subpixels; meaningless where `clipped`.
    pub x: i64,
    pub y: i64,
    pub depth: f32,
    /// Beyond the near plane or the guard band.
    pub clipped: bool,
}

impl Transform {
    pub fn new(view: &View, position: DVec3) -> Transform {
        let exact = view.eye() - position;
        let eye = [exact.x as f32, exact.y as f32, exact.z as f32];
        let residual = [0, 1, 2].map(|i| exact[i] - f64::from(eye[i]));
        let rows = view.rows().map(|r| {
            let constant = r.w - (r.x * residual[0] + r.y * residual[1] + r.z * residual[2]);
            [r.x as f32, r.y as f32, r.z as f32, constant as f32]
        });
        Transform { eye, rows }
    }

    pub fn vertex(&self, rotation: Option<Mat3>, v: Vec3) -> Vertex {
        let turned = match rotation {
            None => [v.x, v.y, v.z],
            Some(m) => [0, 1, 2].map(|i| (m.x_axis[i] * v.x + m.y_axis[i] * v.y) + m.z_axis[i] * v.z),
        };
        let p = [0, 1, 2].map(|i| turned[i] - self.eye[i]);
        let clip = self.rows.map(|r| (p[0] * r[0] + p[1] * r[1]) + (p[2] * r[2] + r[3]));
        let [x, y, w, depth, near] = clip;
        let inverse = 1.0 / w;
        let inside = near >= 0.0 && x.abs() < GUARD * w && y.abs() < GUARD * w;
        Vertex {
            clip,
            x: (x * inverse).round_ties_even() as i64,
            y: (y * inverse).round_ties_even() as i64,
            depth: depth * inverse,
            clipped: !inside,
        }
    }
}

/// Twice the area of a snapped triangle on a screen whose y points down: below 0 is counter-clockwise to the viewer.
pub fn twice_area(t: &[Vertex; 3]) -> i128 {
    side([t[0].x, t[0].y], [t[1].x, t[1].y], [t[2].x, t[2].y])
}

fn side(p: [i64; 2], q: [i64; 2], s: [i64; 2]) -> i128 {
    let [dx, dy] = [0, 1].map(|i| i128::from(q[i] - p[i]));
    let [sx, sy] = [0, 1].map(|i| i128::from(s[i] - p[i]));
    dx * sy - dy * sx
}

/// Calls `hit` for each sample of the viewport that the triangle covers: inside, or on a left or a top edge.
pub fn covered_samples(t: &[Vertex; 3], facing: Facing, width: u32, height: u32, mut hit: impl FnMut(u32, u32)) {
    let area = twice_area(t);
    let drawn = match facing {
        Facing::Front => area < 0,
        Facing::Back => area > 0,
        Facing::Both => area != 0,
    };
    if !drawn {
        return;
    }
    let mut p = t.map(|v| [v.x, v.y]);
    if area < 0 {
        p.swap(1, 2);
    }
    // Clockwise to the viewer now: left edges go up, top edges to the right.
    let owns = [0, 1, 2].map(|i| {
        let (p, q) = (p[i], p[(i + 1) % 3]);
        q[1] < p[1] || q[1] == p[1] && q[0] > p[0]
    });
    let samples = |axis: usize, size: u32| {
        let low = p.iter().map(|p| p[axis]).min().unwrap().div_euclid(256) - 1;
        let high = p.iter().map(|p| p[axis]).max().unwrap().div_euclid(256) + 1;
        low.clamp(0, i64::from(size)) as u32..(high + 1).clamp(0, i64::from(size)) as u32
    };
    for y in samples(1, height) {
        for x in samples(0, width) {
            let s = [i64::from(x) * 256 + 128, i64::from(y) * 256 + 128];
            let inside = (0..3).all(|i| {
                let e = side(p[i], p[(i + 1) % 3], s);
                e > 0 || e == 0 && owns[i]
            });
            if inside {
                hit(x, y);
            }
        }
    }
}
