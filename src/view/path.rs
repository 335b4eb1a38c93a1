//! Camera paths: keys, and how frames are sampled between them.
//!
//! Every figure of the papers is taken along a recorded path (thesis 8.3.1). Frames are spread evenly over the key index,
//! both ends included; eyes move linearly and directions along great circles, in f64 with `libm`, so that a path gives the
//! same cameras on every machine. About 100 ns a frame.

use glam::DVec3;

use super::Camera;
use crate::error::{Error, Result};
use crate::geometry::Aabb;

/// How near to opposite two directions may be, in radians, before the turn between them goes about `up`.
const OPPOSITE: f64 = 1e-6;
/// Sine of the smallest angle between `up` and a view direction; the same as in [`Camera::view`].
const PARALLEL: f64 = 1e-9;

/// One key of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathKey {
    /// World position of the eye.
    pub eye: DVec3,
    /// A point straight ahead.
    pub target: DVec3,
}

/// A walk: a lens, an up direction and at least one key.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPath {
    /// Vertical field of view, in degrees.
    pub fov_y_deg: f64,
    /// Near distance.
    pub near: f64,
    /// Far distance; `None` is infinity.
    pub far: Option<f64>,
    /// Up.
    pub up: DVec3,
    /// In order.
    pub keys: Vec<PathKey>,
}

impl CameraPath {
    /// Samples `frames` cameras evenly in key index, both ends included; a single frame is the first key. The target of
    /// a sampled camera is one metre ahead.
    ///
    /// Directions that are within 1e-6 rad of opposite turn to the left, about the axis nearest to `up`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for 0 frames; [`Error::View`] as for [`CameraPath::check`], or when `up` is parallel to a
    /// direction between two keys.
    pub fn sample(&self, frames: usize) -> Result<Vec<Camera>> {
        if frames == 0 {
            return Err(Error::parameter("frames", frames, "must be at least 1"));
        }
        self.check()?;
        let directions: Vec<DVec3> = self.keys.iter().map(|k| (k.target - k.eye).normalize()).collect();
        let up = self.up.normalize();
        (0..frames).map(|frame| self.frame(frame, frames, &directions, up)).collect()
    }

    /// Whether the path can be walked at all.
    ///
    /// # Errors
    /// [`Error::View`] naming the key at fault: no keys, a number that is not finite, a target at the eye, `up` parallel
    /// to a direction, an impossible lens.
    pub fn check(&self) -> Result<()> {
        let fail = |reason: String| Err(Error::View(format!("camera path: {reason}")));
        if !(self.fov_y_deg > 0.0 && self.fov_y_deg < 180.0) {
            return fail(format!("fov_y_deg {}: must lie between 0 and 180", self.fov_y_deg));
        }
        if !(self.near > 0.0 && self.near.is_finite()) {
            return fail(format!("near {}: must be above 0 and finite", self.near));
        }
        if let Some(far) = self.far
            && !(far > self.near && far.is_finite())
        {
            return fail(format!("far {far}: must be above near, or null for infinity"));
        }
        if !usable(self.up) {
            return fail(format!("up {}: must be a finite direction", self.up));
        }
        if self.keys.is_empty() {
            return fail("has no keys".into());
        }
        self.keys.iter().enumerate().try_for_each(|(i, key)| check_key(i, key, self.up.normalize()))
    }

    /// An orbit outside the box of a model, once around, looking at its middle from a little above: the path of an OBJ
    /// that brings none. A box without size, or none at all, is taken to be a metre large.
    pub fn orbit(bounds: Aabb) -> CameraPath {
        let bounds = if bounds.is_finite() { bounds } else { Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ZERO } };
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let radius = if half.length() > 0.0 { half.length() } else { 1.0 };
        // At twice the radius a 60 degree lens just holds the sphere around the box.
        let (distance, height) = (2.2 * radius, 0.6 * radius);
        let keys = (0..=ORBIT_KEYS)
            .map(|i| {
                let angle = std::f64::consts::TAU * (i % ORBIT_KEYS) as f64 / ORBIT_KEYS as f64;
                let offset = DVec3::new(libm::sin(angle) * distance, height, libm::cos(angle) * distance);
                PathKey { eye: center + offset, target: center }
            })
            .collect();
        CameraPath { fov_y_deg: 60.0, near: radius * 1e-3, far: None, up: DVec3::Y, keys }
    }

    fn frame(&self, frame: usize, frames: usize, directions: &[DVec3], up: DVec3) -> Result<Camera> {
        let last = self.keys.len() - 1;
        let at = if frames > 1 { frame as f64 * last as f64 / (frames - 1) as f64 } else { 0.0 };
        let from = (at as usize).min(last);
        let (to, t) = ((from + 1).min(last), at - from as f64);
        let (a, b) = (self.keys[from].eye, self.keys[to].eye);
        let eye = if t == 0.0 { a } else { a * (1.0 - t) + b * t };
        let direction = turn(directions[from], directions[to], up, t);
        if direction.cross(up).length() < PARALLEL {
            let reason = format!("camera path: up is parallel to the direction of frame {frame}, after key {from}");
            return Err(Error::View(reason));
        }
        let Self { fov_y_deg, near, far, .. } = *self;
        Ok(Camera { eye, target: eye + direction, up: self.up, fov_y_deg, near, far })
    }
}

/// Keys of one round of an orbit: 15 degrees apart, so that chords stay near the circle.
const ORBIT_KEYS: usize = 24;

fn usable(direction: DVec3) -> bool {
    let length = direction.length();
    length.is_finite() && length > 0.0 && direction.normalize().is_finite()
}

fn check_key(index: usize, key: &PathKey, up: DVec3) -> Result<()> {
    let fail = |reason: &str| Err(Error::View(format!("camera path: key {index}: {reason}")));
    if !key.eye.is_finite() || !key.target.is_finite() {
        return fail("eye and target must be finite numbers");
    }
    let direction = key.target - key.eye;
    if !usable(direction) {
        return fail("the target is the eye, or too near or too far to give a direction");
    }
    if direction.normalize().cross(up).length() < PARALLEL {
        return fail("up is parallel to the direction");
    }
    Ok(())
}

/// The unit direction a fraction `t` of the way from `a` to `b` on the sphere (all unit vectors).
fn turn(a: DVec3, b: DVec3, up: DVec3, t: f64) -> DVec3 {
    if t == 0.0 {
        return a;
    }
    let sine = a.cross(b).length();
    let angle = libm::atan2(sine, a.dot(b));
    if angle > std::f64::consts::PI - OPPOSITE {
        // The axis is `up` without its part along `a`, so that half a turn does end at -a.
        let axis = (up - a * up.dot(a)).normalize();
        let phi = t * std::f64::consts::PI;
        return (a * libm::cos(phi) + axis.cross(a) * libm::sin(phi)).normalize();
    }
    if sine < 1e-12 {
        return (a * (1.0 - t) + b * t).normalize();
    }
    let (wa, wb) = (libm::sin((1.0 - t) * angle), libm::sin(t * angle));
    (a * wa + b * wb).normalize()
}
