//! The depth of a triangle at a sample by ray and plane in f64, and the bound that the drawn depth must keep.
//!
//! The bound is derived in the head of [`super`]; here it stands term by term. Units: x and y in subpixels (1/256 sample).

use glam::{DVec2, DVec3, DVec4};

use crate::scene::{Object, Scene};
use crate::view::View;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;
/// Roundings of a row of a vertex.
const STEPS: f64 = 8.0;
/// What sums of f32 below its normal range may lose.
const UNDERFLOW: f64 = 1e-42;
/// 1/128 of a sample, in subpixels.
const RIM: f64 = 2.0;

/// A corner before the division, and what rounding may do to it: x, y, w, depth, near.
#[derive(Clone, Copy)]
struct Corner {
    /// About the eye.
    place: DVec3,
    clip: [f64; 5],
    error: [f64; 5],
}

/// A triangle of a scene, as f64 sees it in a view.
pub(super) struct RayTriangle {
    rows: [DVec4; 5],
    corners: [Corner; 3],
    /// Beyond the near plane, all of it.
    whole: bool,
}

/// What f64 says about a triangle at a sample.
pub(super) enum Truth {
    /// Well inside: the depth, and how far from it the drawn one may be.
    Inside { depth: f64, bound: f64 },
    /// Well outside: it must not be drawn there.
    Outside,
    /// Too close to an edge, or too much at the mercy of rounding, to say.
    Unsure,
}

impl RayTriangle {
    /// Triangle `number` of an object.
    pub fn new(view: &View, scene: &Scene, object: &Object, number: usize) -> RayTriangle {
        let mesh = &scene.meshes[object.mesh as usize];
        let corners =
            mesh.triangles()[number].map(|i| Corner::new(view, object, mesh.positions()[i as usize].as_dvec3()));
        let whole = corners.iter().all(|c| c.clip[4] > c.error[4]);
        RayTriangle { rows: *view.rows(), corners, whole }
    }

    /// At the centre of a sample.
    pub fn at(&self, sample_x: u32, sample_y: u32) -> Truth {
        let x = DVec2::new(f64::from(sample_x), f64::from(sample_y)) * 256.0 + 128.0;
        let Some(here) = Here::new(&self.corners, x) else { return Truth::Unsure };
        match here.side(&self.corners, self.whole) {
            Some(true) => {}
            Some(false) => return Truth::Outside,
            None => return Truth::Unsure,
        }
        let (depth, Some(spread)) = (self.ray(x), here.spread(&self.corners)) else { return Truth::Unsure };
        let bound = here.bound(&self.corners, depth, &spread, self.whole);
        if depth.is_finite() && bound.is_finite() { Truth::Inside { depth, bound } } else { Truth::Unsure }
    }

    /// Reversed depth where the ray through a point of the screen meets the triangle's plane.
    fn ray(&self, x: DVec2) -> f64 {
        let [row_x, row_y, row_w, row_z, _] = self.rows;
        let (first, second) = (row_x - row_w * x.x, row_y - row_w * x.y);
        let (m, n) = (first.truncate(), second.truncate());
        // The ray is where two planes meet: on both, along both.
        let along = m.cross(n);
        let start = (n.cross(along) * -first.w + along.cross(m) * -second.w) / along.length_squared();
        let [a, b, c] = self.corners.map(|c| c.place);
        let normal = (b - a).cross(c - a);
        let point = start + along * (normal.dot(a - start) / normal.dot(along));
        let value = |row: DVec4| row.truncate().dot(point) + row.w;
        value(row_z) / value(row_w)
    }
}

impl Corner {
    fn new(view: &View, object: &Object, v: DVec3) -> Corner {
        let rotation = object.rotation.as_dmat3();
        let eye = view.eye() - object.position;
        let residual = (eye - eye.as_vec3().as_dvec3()).abs();
        let place = rotation * v - eye;
        let turned = if object.rotation == glam::Mat3::IDENTITY {
            DVec3::ZERO
        } else {
            rotation.x_axis.abs() * v.x.abs() + rotation.y_axis.abs() * v.y.abs() + rotation.z_axis.abs() * v.z.abs()
        };
        let reach = place.abs() + residual * 2.0 + turned;
        let clip = view.rows().map(|r| r.truncate().dot(place) + r.w);
        let error = view.rows().map(|r| STEPS * U * (r.truncate().abs().dot(reach) + r.w.abs()) + UNDERFLOW);
        Corner { place, clip, error }
    }
}

/// The triangle from one point of the screen: everything with signs so that inside is positive.
struct Here {
    /// Corners about the point, x and y times w, and their errors.
    q: [DVec2; 3],
    q_error: [DVec2; 3],
    /// Minors: barycentrics times the determinant; their gradients and errors.
    minor: [f64; 3],
    slope: [DVec2; 3],
    minor_error: [f64; 3],
    determinant: f64,
}

/// The barycentrics of the rounded triangle at their greatest.
struct Spread([f64; 3]);

impl Here {
    fn new(corners: &[Corner; 3], x: DVec2) -> Option<Here> {
        let q = corners.map(|c| DVec2::new(c.clip[0], c.clip[1]) - x * c.clip[2]);
        let q_error = corners.map(|c| DVec2::new(c.error[0], c.error[1]) + x.abs() * c.error[2]);
        let w = corners.map(|c| c.clip[2]);
        let pair = |i: usize| ((i + 1) % 3, (i + 2) % 3);
        let minor: [f64; 3] = std::array::from_fn(|i| q[pair(i).0].perp_dot(q[pair(i).1]));
        let determinant: f64 = (0..3).map(|i| minor[i] * w[i]).sum();
        if !determinant.is_finite() || determinant == 0.0 {
            return None;
        }
        let sign = determinant.signum();
        let slope = std::array::from_fn(|i| {
            let (j, k) = pair(i);
            DVec2::new(w[k] * q[j].y - w[j] * q[k].y, w[j] * q[k].x - w[k] * q[j].x) * sign
        });
        let minor_error = std::array::from_fn(|i| {
            let (j, k) = pair(i);
            let (a, b) = (q[j].abs() + q_error[j], q[k].abs() + q_error[k]);
            a.x * q_error[k].y + a.y * q_error[k].x + b.x * q_error[j].y + b.y * q_error[j].x
        });
        let minor = minor.map(|m| m * sign);
        Some(Here { q, q_error, minor, slope, minor_error, determinant: determinant.abs() })
    }

    /// Inside all edges, outside one, or neither for sure.
    fn side(&self, corners: &[Corner; 3], whole: bool) -> Option<bool> {
        let mut inside = true;
        let mut edge = |value: f64, slope: DVec2, error: f64| {
            let length = slope.length();
            let (distance, moved) = if length > 0.0 { (value / length, error / length) } else { (f64::NAN, 0.0) };
            let rim = RIM + 2.0 * moved;
            // An edge without a slope is on one side everywhere.
            let value = if length > 0.0 { distance } else { value.signum() * f64::INFINITY };
            inside &= value > rim;
            value < -rim
        };
        let mut outside = (0..3).any(|i| edge(self.minor[i], self.slope[i], self.minor_error[i]));
        if !whole {
            let near = corners.map(|c| c.clip[4]);
            let value = (0..3).map(|i| self.minor[i] * near[i]).sum();
            let slope = (0..3).fold(DVec2::ZERO, |a, i| a + self.slope[i] * near[i]);
            let error = (0..3)
                .map(|i| {
                    self.minor_error[i] * near[i].abs()
                        + (self.minor[i].abs() + self.minor_error[i]) * corners[i].error[4]
                })
                .sum();
            outside |= edge(value, slope, error);
        }
        match (outside, inside) {
            (true, _) => Some(false),
            (false, true) => Some(true),
            (false, false) => None,
        }
    }

    /// `None` when rounding may turn the triangle over.
    fn spread(&self, corners: &[Corner; 3]) -> Option<Spread> {
        let loss: f64 = (0..3)
            .map(|i| {
                let (w, error) = (corners[i].clip[2].abs(), corners[i].error[2]);
                self.minor_error[i] * w + (self.minor[i].abs() + self.minor_error[i]) * error
            })
            .sum();
        let least = self.determinant - loss;
        (least > 0.25 * self.determinant)
            .then(|| Spread(std::array::from_fn(|i| (self.minor[i] + self.minor_error[i]) / least)))
    }

    fn bound(&self, corners: &[Corner; 3], z: f64, spread: &Spread, whole: bool) -> f64 {
        let depth = corners.map(|c| c.clip[3]);
        let w = corners.map(|c| c.clip[2]);
        let gradient = (0..3).fold(DVec2::ZERO, |a, i| a + self.slope[i] * (depth[i] - z * w[i])) / self.determinant;
        let gradient = gradient.abs();
        let transform: f64 = (0..3)
            .map(|i| {
                spread.0[i] * (corners[i].error[3] + gradient.dot(self.q_error[i]) + z.abs() * corners[i].error[2])
            })
            .sum();
        let steps = gradient.x + gradient.y;
        let sums = 8.0 * U * (z.abs() + 62.0 * 256.0 * steps);
        let snapping = 0.5 * steps;
        let terms: f64 = (0..3)
            .map(|i| {
                let (a, b) = (self.q[(i + 1) % 3].abs(), self.q[(i + 2) % 3].abs());
                (a.x * b.y + a.y * b.x) * (depth[i].abs() + z.abs() * w[i].abs())
            })
            .sum();
        let double = terms / self.determinant * f64::EPSILON * 16.0;
        transform + sums + snapping + double + clamp(corners, z, whole) + UNDERFLOW
    }
}

/// What the clamp to the corners' rounded depths may move a depth that is in their true range.
fn clamp(corners: &[Corner; 3], z: f64, whole: bool) -> f64 {
    let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
    for c in corners.iter().filter(|c| c.clip[4] >= 0.0 && c.clip[2] > c.error[2]) {
        let depth = c.clip[3] / c.clip[2];
        let error = (c.error[3] + depth.abs() * c.error[2]) / (c.clip[2] - c.error[2]) + 4.0 * U * depth.abs();
        most = most.max(depth - error);
        least = least.min(depth + error);
    }
    let lowered = if whole { (z - most).max(0.0) } else { 0.0 };
    let raised = if least.is_finite() { (least - z).max(0.0) } else { 0.0 };
    lowered.max(raised)
}
