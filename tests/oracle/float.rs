//! A rasterizer in f64, unsnapped and perspective-correct, by homogeneous barycentrics: what is behind the eye needs no
//! clipping. It answers *inside*, *outside*, or *too close to an edge to say*.

use glam::{DVec3, DVec4};
use homcull::view::View;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    Inside,
    Outside,
    Rim,
}

/// A triangle: x, y (subpixels times w), w, depth, near of its corners.
pub struct Triangle {
    /// Edge functions over (x, y, 1), opposite to each corner, positive inside; then the near plane's.
    edges: [DVec3; 4],
    /// Reversed depth over (x, y, 1).
    depth: DVec3,
    /// Twice the signed area's sign: below 0 is counter-clockwise to the viewer.
    pub orientation: f64,
    /// Depths of the corners, of those beyond the near plane.
    pub depths: [f64; 3],
}

/// A world position in clip space.
pub fn clip(view: &View, p: DVec3) -> [f64; 5] {
    let p = p - view.eye();
    let p = DVec4::new(p.x, p.y, p.z, 1.0);
    view.rows().map(|r| r.x * p.x + r.y * p.y + r.z * p.z + r.w * p.w)
}

impl Triangle {
    pub fn new(corners: [[f64; 5]; 3]) -> Option<Triangle> {
        let p = corners.map(|c| DVec3::new(c[0], c[1], c[2]));
        let minors = [p[1].cross(p[2]), p[2].cross(p[0]), p[0].cross(p[1])];
        let determinant = p[0].dot(minors[0]);
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let b = minors.map(|m| m / determinant);
        let sum = |c: usize| b[0] * corners[0][c] + b[1] * corners[1][c] + b[2] * corners[2][c];
        Some(Triangle {
            edges: [b[0], b[1], b[2], sum(4)],
            depth: sum(3),
            orientation: determinant,
            depths: corners.map(|c| if c[4] >= 0.0 { c[3] / c[2] } else { f64::NAN }),
        })
    }

    /// At a point in subpixels; `rim` is in subpixels too.
    pub fn at(&self, x: f64, y: f64, rim: f64) -> Answer {
        let mut answer = Answer::Inside;
        for e in self.edges {
            let value = e.x * x + e.y * y + e.z;
            let slope = e.x.hypot(e.y);
            // An edge without a slope (parallel to the screen in an orthographic view) is on one side everywhere.
            let distance = if slope > 0.0 { value / slope } else { value.signum() * f64::INFINITY };
            if distance < -rim {
                return Answer::Outside;
            }
            if distance.is_nan() || distance <= rim {
                answer = Answer::Rim;
            }
        }
        answer
    }

    pub fn depth(&self, x: f64, y: f64) -> f64 {
        self.depth.x * x + self.depth.y * y + self.depth.z
    }

    /// How much depth changes from sample to sample.
    pub fn slope(&self) -> f64 {
        256.0 * (self.depth.x.abs() + self.depth.y.abs())
    }
}

/// The middle of a sample, in subpixels.
pub fn center(sample: u32) -> f64 {
    f64::from(sample) * 256.0 + 128.0
}
