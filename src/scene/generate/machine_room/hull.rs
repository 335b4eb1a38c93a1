//! The hull: plating in strakes as long as the room, frames, stringers, and the bulkheads at both ends with their doors.
//!
//! Few large polygons and many small ones side by side, as in the thesis's model. All of it closed solids with a thickness.

use glam::{Mat3, Vec2, Vec3};

use super::super::piping::{beam, rod, torus};
use super::super::solid::{Solid, upright_to};
use super::super::stock::Rank;
use super::parts::{Room, extrude, facing, paint};
use super::plan::{AXIS, FRAME, FRAME_DEPTH, RADIUS, SIDE, UPPER};

/// Steps of the circle, strakes around it, and the longest strake in metres.
const STEPS: usize = 48;
const STRAKES: usize = 12;
const LONGEST: f32 = 40.0;

pub(super) fn hull(room: &mut Room) {
    let length = room.plan.length();
    let pieces = (length / LONGEST).ceil().max(1.0);
    for strake in 0..STRAKES {
        for piece in 0..pieces as usize {
            let x = length * piece as f32 / pieces;
            let mut solid = Solid::default();
            let (steps, thick) = (STEPS / STRAKES, RADIUS + 0.05);
            arc(&mut solid, strake * steps, steps, (0.0, length / pieces), (RADIUS, thick));
            room.put_new(Rank::Must, "hull/strake", solid, Vec3::new(x, AXIS, 0.0), paint::SHELL);
        }
    }
    frames(room);
    webs(room);
    for (x, inward) in [(0.0, 1.0), (length, -1.0)] {
        bulkhead(room, x, inward);
    }
}

/// A point of the hull's section, `radius` from its axis: step 0 is at the top, on to starboard.
fn section(step: usize, x: f32, radius: f32) -> Vec3 {
    let angle = std::f64::consts::TAU * step as f64 / STEPS as f64;
    Vec3::new(x, libm::cos(angle) as f32 * radius, libm::sin(angle) as f32 * radius)
}

/// A bar along the section, closed: 8 * steps + 4 triangles.
fn arc(solid: &mut Solid, first: usize, steps: usize, (x0, x1): (f32, f32), (low, high): (f32, f32)) {
    let ring = |k| vec![section(k, x0, low), section(k, x1, low), section(k, x1, high), section(k, x0, high)];
    let rings: Vec<Vec<Vec3>> = (first..=first + steps).map(ring).collect();
    solid.skin(&rings);
}

/// T-shaped frames in quarters, and a stringer from frame to frame at every strake's edge.
fn frames(room: &mut Room) {
    let quarters: Vec<u32> = (0..4)
        .map(|quarter| {
            let (mut solid, inner) = (Solid::default(), RADIUS - FRAME_DEPTH);
            let (first, steps) = (quarter * STEPS / 4, STEPS / 4);
            arc(&mut solid, first, steps, (-0.012, 0.012), (inner + 0.02, RADIUS));
            arc(&mut solid, first, steps, (-0.08, 0.08), (inner, inner + 0.02));
            room.stock.shape(solid)
        })
        .collect();
    let mut stringer = Solid::default();
    beam(&mut stringer, Vec3::ZERO, Vec3::X * (FRAME - 0.03), Vec2::new(0.014, 0.16));
    beam(&mut stringer, Vec3::Y * -0.08, Vec3::new(FRAME - 0.03, -0.08, 0.0), Vec2::new(0.07, 0.014));
    let stringer = room.stock.shape(stringer);
    let count = (room.plan.length() / FRAME).round() as usize;
    for frame in 1..count {
        let x = frame as f32 * FRAME;
        for &mesh in &quarters {
            room.put(Rank::Must, "hull/frame", mesh, (Mat3::IDENTITY, Vec3::new(x, AXIS, 0.0)), paint::FRAMES);
        }
        for strake in 0..STRAKES {
            let step = strake * STEPS / STRAKES + 2;
            let at = section(step, x + 0.015, RADIUS - 0.08) + Vec3::Y * AXIS;
            let up = section(step, 0.0, 1.0);
            let turn = Mat3::from_cols(Vec3::X, up, Vec3::X.cross(up));
            if frame + 1 < count {
                room.put(Rank::Fill, "hull/stringer", stringer, (turn, at), paint::FRAMES);
            }
        }
    }
}

/// Deep web frames every other bay, which part the spaces along the hull from each other: below and above the upper plates.
fn webs(room: &mut Room) {
    let stand = SIDE.1 + 0.2;
    let meshes = [(0.0, UPPER - 0.1), (UPPER, 5.45)].map(|(low, high)| {
        let reach = |y: f32| Vec2::new(y, (RADIUS * RADIUS - (y - AXIS) * (y - AXIS)).sqrt());
        let arc = (0..=6).map(|k| reach(high + (low - high) * k as f32 / 6.0));
        let outline: Vec<Vec2> = [Vec2::new(low, stand), Vec2::new(high, stand)].into_iter().chain(arc).collect();
        let mut solid = Solid::default();
        extrude(&mut solid, -0.012, 0.012, &outline);
        solid.cuboid(Vec3::new(-0.09, low, stand - 0.02), Vec3::new(0.09, high, stand));
        for y in [low + (high - low) * 0.33, low + (high - low) * 0.67] {
            solid.cuboid(Vec3::new(-0.06, y - 0.01, stand), Vec3::new(0.06, y + 0.01, reach(y).y - 0.1));
        }
        room.stock.shape(solid)
    });
    for bay in (0..=room.plan.bays).step_by(2) {
        for (mesh, side) in meshes.into_iter().flat_map(|mesh| [(mesh, 1.0), (mesh, -1.0)]) {
            let at = Vec3::X * room.plan.bay(bay);
            room.put(Rank::Must, "hull/web", mesh, (facing(side), at), paint::FRAMES);
        }
    }
}

/// A disc across the hull, stiffened upright, with a door below and one above.
fn bulkhead(room: &mut Room, x: f32, inward: f32) {
    let (at, turn) = (Vec3::new(x, AXIS, 0.0), upright_to(Vec3::X * inward));
    let mut disc = Solid::default();
    disc.lathe(STEPS, &[(RADIUS + 0.05, -0.05), (RADIUS + 0.05, 0.0)]);
    let disc = room.stock.shape(disc);
    room.put(Rank::Must, "bulkhead/plate", disc, (turn, at), paint::BULKHEAD);
    for k in -8..=8 {
        let z = k as f32 * 0.62;
        let reach = (RADIUS * RADIUS - z * z).max(0.0).sqrt();
        let mut solid = Solid::default();
        // Doors interrupt the stiffeners in the middle of the section.
        let spans: &[(f32, f32)] = if k == 0 {
            &[(-reach, -AXIS - 0.1), (2.1 - AXIS, UPPER - AXIS - 0.1), (UPPER + 2.0 - AXIS, reach)]
        } else {
            &[(-reach, reach)]
        };
        for &(low, high) in spans.iter().filter(|(low, high)| high - low > 0.1) {
            let mut bar = |near: f32, far: f32, half: f32| {
                let (x0, x1) = if inward > 0.0 { (near, far) } else { (-far, -near) };
                solid.cuboid(Vec3::new(x0, low, -half), Vec3::new(x1, high, half));
            };
            bar(0.0, 0.16, 0.01);
            bar(0.16, 0.18, 0.05);
        }
        room.put_new(Rank::Must, "bulkhead/stiffener", solid, Vec3::new(x, AXIS, z), paint::FRAMES);
    }
    for y in [0.0, UPPER] {
        door(room, Vec3::new(x, y, 0.0), turn);
    }
}

/// A watertight door made flat about y, turned upright: a frame, the leaf, its dogs and its handwheel.
fn door(room: &mut Room, sill: Vec3, turn: Mat3) {
    let (mut frame, mut leaf, mut wheel) = (Solid::default(), Solid::default(), Solid::default());
    // Made standing in x = 0, facing +x.
    let outline = |half: f32, low: f32, high: f32, cut: f32| {
        [
            Vec2::new(low, -half + cut),
            Vec2::new(low + cut, -half),
            Vec2::new(high - cut, -half),
            Vec2::new(high, -half + cut),
            Vec2::new(high, half - cut),
            Vec2::new(high - cut, half),
            Vec2::new(low + cut, half),
            Vec2::new(low, half - cut),
        ]
    };
    extrude(&mut frame, 0.0, 0.1, &outline(0.48, 0.08, 2.0, 0.16));
    extrude(&mut leaf, 0.1, 0.15, &outline(0.42, 0.15, 1.93, 0.14));
    beam(&mut leaf, Vec3::new(0.17, 0.6, -0.36), Vec3::new(0.17, 0.6, 0.36), Vec2::new(0.05, 0.06));
    beam(&mut leaf, Vec3::new(0.17, 1.5, -0.36), Vec3::new(0.17, 1.5, 0.36), Vec2::new(0.05, 0.06));
    for y in [0.35, 0.8, 1.3, 1.75] {
        for side in [-1.0, 1.0] {
            rod(&mut leaf, 6, 0.02, Vec3::new(0.18, y, side * 0.3), Vec3::new(0.16, y, side * 0.47));
        }
    }
    let mut hand = Solid::default();
    torus(&mut hand, 20, 0.2, 6, 0.016);
    for angle in 0..3 {
        let (s, c) = [(0.0, 1.0), (0.866, 0.5), (0.866, -0.5)][angle];
        rod(&mut hand, 5, 0.012, Vec3::new(-s * 0.2, 0.0, -c * 0.2), Vec3::new(s * 0.2, 0.0, c * 0.2));
    }
    hand.column(8, Vec2::ZERO, (-0.12, 0.025), (0.02, 0.025));
    wheel.join(&hand, upright_to(Vec3::X), Vec3::new(0.28, 1.05, 0.0));
    // What stands facing +x faces the room when turned as the bulkhead is.
    let stand = if turn.y_axis.x < 0.0 { Mat3::from_diagonal(Vec3::new(-1.0, 1.0, -1.0)) } else { Mat3::IDENTITY };
    for (rank, kind, solid, color) in [
        (Rank::Must, "door/frame", frame, paint::FRAMES),
        (Rank::Must, "door/leaf", leaf, paint::DOOR),
        (Rank::Detail, "door/wheel", wheel, paint::BRASS),
    ] {
        let mesh = room.stock.shape(solid);
        room.put(rank, kind, mesh, (stand, sill), color);
    }
}
