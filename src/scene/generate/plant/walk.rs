//! The walk, on the aisles of one floor a good half of the way up (the thesis walked on the ninth of UNC's plant): over a
//! bridge into the house, along the boiler's front, around it, and out by its rear, where it ends looking outward.

use glam::{DVec2, DVec3};

use super::plan::Plan;
use super::walkway::bridges;
use crate::view::{CameraPath, PathKey};

/// Height of the eye above the grating, in metres.
const EYE: f64 = 1.7;
/// Metres between keys.
const STEP: f64 = 4.0;

/// The walk through the first unit.
pub(super) fn walk(plan: &Plan) -> CameraPath {
    let [front, rear] = bridges(plan);
    let [entry, exit] = [plan.aisles[0], plan.aisles[4]];
    let far = plan.aisles[1].from.y;
    let corners = [
        DVec2::new(entry.from.x, far),
        DVec2::new(exit.from.x - super::plan::AISLE * 0.5, far),
        DVec2::new(exit.from.x - super::plan::AISLE * 0.5, exit.from.y),
    ];
    let mut walk = Walk { keys: Vec::new(), y: plan.level(plan.walk_floor) + EYE };
    // From the bridge the house is seen whole, then the eye turns to the way.
    let start = front.from + DVec2::Y * 1.5;
    for k in 0..=4 {
        let turn = 0.72 * (1.0 - f64::from(k) / 4.0);
        let look = DVec3::new(libm::sin(turn), 0.1 * turn, libm::cos(turn));
        walk.key(start.lerp(front.to, 0.16 * f64::from(k)), look);
    }
    walk.leg(start.lerp(front.to, 0.64), front.to);
    walk.leg(front.to, corners[0]);
    walk.leg(corners[0], corners[1]);
    walk.leg(corners[1], corners[2]);
    walk.leg(corners[2], rear.from);
    walk.leg(rear.from, rear.from.lerp(rear.to, 0.7));
    // Outward over the yard, from the precipitator round to the towers.
    for k in 1..=4 {
        let turn = 0.5 * f64::from(k) / 4.0;
        walk.key(rear.from.lerp(rear.to, 0.7), DVec3::new(libm::cos(turn), -0.06, libm::sin(turn)));
    }
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: Some(2000.0), up: DVec3::Y, keys: walk.keys }
}

struct Walk {
    keys: Vec<PathKey>,
    y: f64,
}

impl Walk {
    /// Along an aisle, looking ahead; turns on the spot first, in two steps.
    fn leg(&mut self, from: DVec2, to: DVec2) {
        let ahead = (to - from).normalize();
        let look = DVec3::new(ahead.x, -0.04, ahead.y).normalize();
        if let Some(last) = self.keys.last() {
            let before = (last.target - last.eye).normalize();
            for share in [0.33, 0.67] {
                let part = before.lerp(look, share).normalize();
                if before.dot(look) < 0.99 {
                    self.key(from, part);
                }
            }
        }
        let steps = ((to - from).length() / STEP).ceil().max(1.0) as usize;
        for k in 0..=steps {
            self.key(from.lerp(to, k as f64 / steps as f64), look);
        }
    }

    fn key(&mut self, at: DVec2, look: DVec3) {
        let eye = DVec3::new(at.x, self.y, at.y);
        let key = PathKey { eye, target: eye + look * 10.0 };
        if self.keys.last() != Some(&key) {
            self.keys.push(key);
        }
    }
}
