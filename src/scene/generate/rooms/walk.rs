//! The walk: in by the entrance, along the corridor of the first wing with a look into rooms, up the stairs through the stairwell's
//! doors, and so on from storey to storey; in the end to the window at the end of a corridor.
//!
//! The eye stays in the cells, and at least 0.3 metres from what stands about.

use glam::DVec3;

use super::plan::{CROSS, FLIGHT, HALVES, Kind, Opening, Plan, Space, UNIT, floor, passage};
use crate::view::{CameraPath, PathKey};

/// Height of the eye above the floor, metres.
const EYE: f64 = 1.65;
/// Metres between keys.
const STEP: f64 = 1.25;
/// Storeys and rooms of a corridor that the walk visits, at most.
const STOREYS: usize = 3;
const ROOMS: usize = 3;
/// How far into a room it goes, metres from the door.
const INTO: f64 = 1.0;

pub(super) fn walk(plan: &Plan) -> CameraPath {
    let mut walk = Walk { keys: Vec::new() };
    let (cross, top) = (f64::from(CROSS[0] + CROSS[1]) * 0.5 / UNIT, plan.storeys.min(STOREYS));
    let entrance = f64::from(CROSS[0] + 10) / UNIT;
    walk.key(at(entrance - 6.0, 0, -16.0), DVec3::new(0.5, 0.0, 1.0));
    walk.to(at(entrance, 0, -6.0));
    walk.to(at(entrance, 0, 1.0));
    for storey in 0..top {
        let wing = storey % plan.wings;
        let z = f64::from(passage(wing)) / UNIT;
        walk.to(at(cross, storey, z));
        let end = visit(&mut walk, plan, storey, wing);
        if storey + 1 == top {
            walk.to(at(end, storey, z));
            continue;
        }
        walk.to(at(cross, storey, z));
        climb(&mut walk, storey, cross);
    }
    CameraPath { fov_y_deg: 60.0, near: 0.05, far: None, up: DVec3::Y, keys: walk.keys }
}

/// A point at eye height.
fn at(x: f64, storey: usize, z: f64) -> DVec3 {
    DVec3::new(x, f64::from(floor(storey)) / UNIT + EYE, z)
}

/// Along a wing's corridor, into some of its rooms and out again; the x of the corridor's end.
fn visit(walk: &mut Walk, plan: &Plan, storey: usize, wing: usize) -> f64 {
    let z = passage(wing);
    let is_corridor = |s: &Space| s.kind == Kind::Corridor && s.storey == storey && s.min[2] < z && z < s.max[2];
    let corridor = plan.spaces.iter().rposition(is_corridor).unwrap_or_default();
    let end = f64::from(plan.spaces[corridor].max[0]) / UNIT - 1.0;
    let mut doors: Vec<&Opening> = plan.links[corridor].iter().map(|&o| &plan.openings[o]).collect();
    doors.retain(|o| o.axis == 2);
    doors.sort_by_key(|o| (o.min[0], o.min[2]));
    let z = f64::from(z) / UNIT;
    for k in 0..ROOMS.min(doors.len()) {
        let door = doors[(2 * k + 1) * doors.len() / (2 * ROOMS.min(doors.len()))];
        let x = f64::from(door.min[0] + door.max[0]) * 0.5 / UNIT;
        let side = if f64::from(door.min[2]) / UNIT > z { 1.0 } else { -1.0 };
        let inside = f64::from(door.min[2]) / UNIT + side * (0.25 + INTO);
        walk.to(at(x, storey, z));
        walk.to(at(x, storey, inside));
        walk.key(at(x, storey, inside), DVec3::new(0.8, -0.1, 0.4 * side));
        walk.key(at(x, storey, inside), DVec3::new(-0.8, -0.1, 0.4 * side));
        walk.to(at(x, storey, z));
    }
    end
}

/// Through the stairwell's door, up the flight, and out by the other.
fn climb(walk: &mut Walk, storey: usize, cross: f64) {
    let landing = |foot: bool| f64::from(if foot { FLIGHT[0] - 5 } else { FLIGHT[1] + 5 }) / UNIT;
    let half = HALVES[storey % 2];
    let x = f64::from(half[0] + half[1]) * 0.5 / UNIT;
    let (from, to) = (landing(storey.is_multiple_of(2)), landing(!storey.is_multiple_of(2)));
    let foot = f64::from(FLIGHT[storey % 2]) / UNIT;
    let head = f64::from(FLIGHT[1 - storey % 2]) / UNIT;
    walk.to(at(cross, storey, from));
    walk.to(at(x, storey, from));
    walk.to(at(x, storey, foot));
    walk.to(at(x, storey + 1, head));
    walk.to(at(x, storey + 1, to));
    walk.to(at(cross, storey + 1, to));
}

struct Walk {
    keys: Vec<PathKey>,
}

impl Walk {
    /// Turns to a place, and goes there.
    fn to(&mut self, to: DVec3) {
        let Some(from) = self.keys.last().map(|key| key.eye) else { return };
        let way = to - from;
        if way.length() < 1e-6 {
            return;
        }
        let ahead = way.normalize() + DVec3::new(0.0, -0.05, 0.0);
        let steps = (way.length() / STEP).ceil().max(1.0) as usize;
        for k in 0..=steps {
            self.key(from.lerp(to, k as f64 / steps as f64), ahead);
        }
    }

    fn key(&mut self, eye: DVec3, look: DVec3) {
        let key = PathKey { eye, target: eye + look.normalize() * 5.0 };
        if self.keys.last() != Some(&key) {
            self.keys.push(key);
        }
    }
}
