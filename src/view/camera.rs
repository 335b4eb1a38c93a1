//! A camera by position, target and lens.

use glam::{DMat4, DVec3, DVec4};

use super::{ClipSpace, View, Viewport};
use crate::error::{Error, Result};

/// A perspective camera, right-handed, looking from `eye` to `target`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World position, in metres.
    pub eye: DVec3,
    /// A point straight ahead.
    pub target: DVec3,
    /// The direction that is up on the screen, as far as the view allows.
    pub up: DVec3,
    /// Vertical field of view, in degrees, above 0 and below 180.
    pub fov_y_deg: f64,
    /// Distance of the near plane, above 0.
    pub near: f64,
    /// Distance of the far plane; `None` is infinity.
    pub far: Option<f64>,
}

impl Camera {
    /// The view of this camera: camera-relative from the start, so that precision does not suffer far from the origin.
    ///
    /// # Errors
    /// [`Error::View`] when a number is not finite, the target is the eye, `up` is parallel to the view direction, or
    /// the lens is impossible.
    pub fn view(&self, viewport: Viewport) -> Result<View> {
        let (rotation, forward_w) = self.rotation()?;
        debug_assert!(forward_w.is_finite());
        let aspect = f64::from(viewport.width()) / f64::from(viewport.height());
        let projection = self.projection(aspect)?;
        View::from_eye(self.eye, projection * rotation, ClipSpace::REVERSED, viewport)
    }

    /// World axes to camera axes (x right, y up, z towards the viewer), without translation.
    fn rotation(&self) -> Result<(DMat4, DVec3)> {
        let finite = [self.eye, self.target, self.up].iter().all(|v| v.is_finite());
        if !finite {
            return Err(Error::View("eye, target and up must be finite numbers".into()));
        }
        let forward = self.target - self.eye;
        let length = forward.length();
        if length.is_nan() || length <= 0.0 {
            return Err(Error::View("the target is the eye".into()));
        }
        let forward = forward / length;
        let right = forward.cross(self.up.normalize_or_zero());
        if right.length() < 1e-9 {
            return Err(Error::View("up is parallel to the view direction".into()));
        }
        let right = right.normalize();
        let up = right.cross(forward);
        let rows = [right, up, -forward].map(|r| DVec4::new(r.x, r.y, r.z, 0.0));
        Ok((DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose(), forward))
    }

    /// Reversed depth: 1 at the near plane, 0 at the far plane or at infinity.
    fn projection(&self, aspect: f64) -> Result<DMat4> {
        let lens = self.fov_y_deg > 0.0 && self.fov_y_deg < 180.0;
        if !lens {
            return Err(Error::View(format!("fov_y_deg {}: must lie between 0 and 180", self.fov_y_deg)));
        }
        let near_ok = self.near > 0.0 && self.near.is_finite();
        if !near_ok {
            return Err(Error::View(format!("near {}: must be above 0", self.near)));
        }
        let half = self.fov_y_deg.to_radians() * 0.5;
        let focal = libm::cos(half) / libm::sin(half);
        let (zz, zw) = match self.far {
            None => (0.0, self.near),
            Some(far) if far > self.near && far.is_finite() => {
                let range = far - self.near;
                (self.near / range, self.near * (far / range))
            }
            Some(far) => return Err(Error::View(format!("far {far}: must be above near, or null for infinity"))),
        };
        Ok(DMat4::from_cols(
            DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, focal, 0.0, 0.0),
            DVec4::new(0.0, 0.0, zz, -1.0),
            DVec4::new(0.0, 0.0, zw, 0.0),
        ))
    }
}
