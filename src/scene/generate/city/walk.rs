//! The walk: along the middle of streets with turns, up and over the roofs, down again, and along the border looking out.
//!
//! The eye stays on the middle lines of streets below roof height, so it never meets a building, a tree or a parked car.

use glam::{DVec2, DVec3};

use super::plan::Plan;
use crate::view::{CameraPath, PathKey};

/// Height of the eye above the street, in metres.
const EYE: f64 = 1.7;
/// Metres between keys in the street, and in the air.
const STEP: f64 = 24.0;
const STEP_AIR: f64 = 48.0;

/// The walk through a plan whose tallest roof is at `top` metres.
pub(super) fn walk(plan: &Plan, top: f64) -> CameraPath {
    let at = |x: f64, z: f64| DVec2::new(line(&plan.lines_x, x), line(&plan.lines_z, z));
    let over = top + 12.0;
    let mut walk = Walk { keys: Vec::new() };
    // In the streets: through the old town to the high-rises, past the market.
    let street = [at(0.3, 0.1), at(0.3, 0.5), at(0.55, 0.5), at(0.55, 0.75), at(0.8, 0.75)];
    for leg in street.windows(2) {
        walk.leg(leg[0].extend(EYE), leg[1].extend(EYE), STEP, 0.0);
    }
    // Up along a street to the border, over all the roofs looking down on them, down along another street.
    let (up, turn, down) = (at(0.8, 1.0), at(0.2, 0.0), at(0.2, 0.6));
    walk.leg(at(0.8, 0.75).extend(EYE), up.extend(over), STEP_AIR, -0.15);
    walk.leg(up.extend(over), turn.extend(over), STEP_AIR, -0.5);
    walk.leg(turn.extend(over), down.extend(EYE), STEP_AIR, -0.25);
    walk.leg(down.extend(EYE), at(0.0, 0.6).extend(EYE), STEP, 0.0);
    // Along the border avenue, looking outward.
    let border = [at(0.0, 0.6), at(0.0, 0.8)];
    for k in 0..=6 {
        let eye = border[0].lerp(border[1], f64::from(k) / 6.0);
        walk.key(eye.extend(EYE), DVec3::new(-1.0, 0.0, 0.15));
    }
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: Some(5000.0), up: DVec3::Y, keys: walk.keys }
}

/// The street line nearest to a fraction of the way through the city.
fn line(lines: &[f64], fraction: f64) -> f64 {
    lines[((lines.len() - 1) as f64 * fraction).round() as usize]
}

struct Walk {
    keys: Vec<PathKey>,
}

impl Walk {
    /// From one point to another (x, z, height), looking along the way on the level and `pitch` metres up for each ahead.
    /// Turns on the spot first, in two steps.
    fn leg(&mut self, from: DVec3, to: DVec3, step: f64, pitch: f64) {
        let ahead = (to - from).truncate();
        let length = (to - from).length();
        let level = ahead.length();
        let usable = level > 0.0;
        if !usable {
            return;
        }
        let look = DVec3::new(ahead.x / level, pitch, ahead.y / level).normalize();
        if let Some(last) = self.keys.last() {
            let before = (last.target - last.eye).normalize();
            let half = before + look;
            if before.dot(look) < 0.99 && half.length() > 0.1 {
                self.key(from, half.normalize());
            }
        }
        let steps = (length / step).ceil().max(1.0) as usize;
        for k in 0..=steps {
            self.key(from.lerp(to, k as f64 / steps as f64), look);
        }
    }

    /// A key at (x, z, height).
    fn key(&mut self, at: DVec3, look: DVec3) {
        let eye = DVec3::new(at.x, at.z, at.y);
        let key = PathKey { eye, target: eye + look * 10.0 };
        if self.keys.last() != Some(&key) {
            self.keys.push(key);
        }
    }
}
