//! The walk: forward between the machines, across, aft along the hull, up the stair, forward on the port catwalk, and from the
//! forward bridge a look back over everything.
//!
//! The eye keeps to the middle of aisles, so it never comes within a quarter of a metre of anything.

use glam::DVec3;

use super::plan::{END, Plan, SIDE, STAIR, UPPER};
use crate::view::{CameraPath, PathKey};

/// Height of the eye above what one stands on.
const EYE: f64 = 1.65;
/// Metres between keys.
const STEP: f64 = 1.2;

pub(super) fn walk(plan: &Plan) -> CameraPath {
    let (length, cross) = (f64::from(plan.length()), f64::from(plan.crossing()));
    let side = f64::from((SIDE.0 + SIDE.1) * 0.5);
    let (low, high) = (EYE, f64::from(UPPER) + EYE);
    let (foot, head) = (f64::from(STAIR.1) + 0.3, f64::from(STAIR.0) - 0.1);
    let bridge = f64::from(END) * 0.55;
    let at = DVec3::new;
    let mut walk = Walk { keys: Vec::new() };
    // Between the machines, looking at one and the other; then across to starboard.
    walk.leg(at(bridge, low, 0.0), at(cross, low, 0.0), at(1.0, -0.04, 0.0), 0.4);
    walk.leg(at(cross, low, 0.0), at(cross, low, side), at(0.1, 0.0, 1.0), 0.0);
    // Aft along the hull, then up the stair to the after bridge.
    walk.leg(at(cross, low, side), at(foot, low, side), at(-1.0, 0.02, -0.1), 0.3);
    let half = at((foot + head) * 0.5, (low + high) * 0.5, side);
    walk.leg(at(foot, low, side), half, at(-1.0, 0.25, -0.2), 0.0);
    walk.leg(half, at(head, high, side), at(0.15, -0.1, -1.0), 0.0);
    // Over to port with the whole room on the right hand.
    walk.leg(at(head, high, side), at(bridge, high, side * 0.7), at(0.25, -0.2, -1.0), 0.0);
    walk.leg(at(bridge, high, side * 0.7), at(bridge, high, -side * 0.5), at(1.0, -0.35, 0.0), 0.0);
    walk.leg(at(bridge, high, -side * 0.5), at(bridge, high, -side), at(1.0, -0.2, 0.2), 0.0);
    // Forward along the catwalk, looking down on the machines and across.
    let across = at(length - bridge - 4.0, high, -side);
    walk.leg(at(bridge, high, -side), across, at(1.0, -0.18, 0.25), 0.35);
    walk.leg(across, at(length - bridge, high, -side), at(0.1, -0.3, 1.0), 0.0);
    // On the forward bridge: the crown of the hull, then back over everything.
    let (aside, middle) = (at(length - bridge, high, -side * 0.4), at(length - bridge, high, 0.0));
    walk.leg(at(length - bridge, high, -side), aside, at(-0.8, 0.45, 0.7), 0.0);
    walk.leg(aside, middle, at(-1.0, 0.3, 0.2), 0.0);
    walk.leg(middle, at(length - bridge, high, side * 0.5), at(-1.0, -0.3, -0.05), 0.0);
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: Some(length * 4.0), up: DVec3::Y, keys: walk.keys }
}

struct Walk {
    keys: Vec<PathKey>,
}

impl Walk {
    /// From one place to another, looking `ahead` and by turns `glance` to the left and right of it. Turns first, on the
    /// spot.
    fn leg(&mut self, from: DVec3, to: DVec3, ahead: DVec3, glance: f64) {
        let ahead = ahead.normalize();
        if let Some(last) = self.keys.last() {
            let before = (last.target - last.eye).normalize();
            let half = before + ahead;
            if before.dot(ahead) < 0.9 && half.length() > 0.2 {
                self.key(from, half);
            }
        }
        let steps = ((to - from).length() / STEP).ceil().max(1.0) as usize;
        let aside = ahead.cross(DVec3::Y);
        for k in 0..=steps {
            // Straight ahead, right, ahead, left, in turn.
            let sway = [0.0, 1.0, 1.0, 0.0, -1.0, -1.0][k % 6] * if k == steps { 0.0 } else { glance };
            self.key(from.lerp(to, k as f64 / steps as f64), ahead + aside * sway);
        }
    }

    fn key(&mut self, eye: DVec3, look: DVec3) {
        let key = PathKey { eye, target: eye + look.normalize() * 5.0 };
        if self.keys.last() != Some(&key) {
            self.keys.push(key);
        }
    }
}
