//! Shapes of pipes, of seven sizes, which half of the plant is made of: straights, bends, valves, racks, hangers, trays.

use glam::{Mat3, Vec3};

use super::super::piping::{bolts, flange, pipe, rod, valve, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::Stock;
use super::plan::{BAY, STOREY};

/// Radii in metres, with the sides of the pipe and the bolts of its flanges.
pub(super) const SIZES: [(f32, usize, usize); 7] =
    [(0.03, 8, 4), (0.05, 8, 4), (0.08, 10, 6), (0.12, 12, 8), (0.17, 14, 10), (0.24, 18, 12), (0.32, 20, 16)];
/// The underside of pipes above the floor, in metres, along x and along z.
pub(super) const UNDERSIDE: [f32; 2] = [2.72, 3.5];
/// Where a lane of pipes begins beside the column line, and how wide it is, in metres.
pub(super) const LANE: (f64, f64) = (0.4, 1.95);
/// The pipes of racks from the lowest up, as numbers of sizes.
pub(super) const RACKS: [[usize; 8]; 3] =
    [[3, 2, 2, 3, 1, 1, 2, 2], [2, 1, 3, 3, 2, 1, 2, 1], [1, 1, 2, 1, 1, 3, 2, 3]];

/// Shapes of pipes, one a size.
pub(super) struct Pipes {
    /// A bay long, from 0 along x: with flanges, lagged with bands, and in two spools with a welded branch.
    pub spools: Vec<[u32; 3]>,
    /// A storey high, from 0 along y: with flanges, and lagged.
    pub uprights: Vec<[u32; 2]>,
    /// The same with a valve, and the valve's wheel.
    pub valved: Vec<[u32; 2]>,
    /// From the end of a run that goes along x: up to the floor above, for both heights of lanes.
    pub ends_up: Vec<[u32; 2]>,
    /// And down to the floor with a valve, whose wheel comes apart.
    pub ends_down: Vec<[[u32; 2]; 2]>,
    /// From a riser's end along x to a blind flange.
    pub turns: Vec<u32>,
    pub trapezes: [u32; 2],
    pub conduits: u32,
    pub tray: u32,
    /// Racks of pipes over each other, a bay long: every other pipe apart, for colours of their own.
    pub racks: Vec<[u32; 2]>,
    pub header: u32,
}

impl Pipes {
    pub fn new(stock: &mut Stock) -> Pipes {
        let mut pipes = Pipes {
            spools: Vec::new(),
            uprights: Vec::new(),
            valved: Vec::new(),
            ends_up: Vec::new(),
            ends_down: Vec::new(),
            turns: Vec::new(),
            trapezes: [0, 1].map(|k| stock.shape(trapeze(UNDERSIDE[k]))),
            conduits: stock.shape(conduits()),
            tray: stock.shape(tray()),
            racks: RACKS.iter().map(|radii| [0, 1].map(|half| stock.shape(rack(radii, half)))).collect(),
            header: stock.shape(header()),
        };
        for size in SIZES {
            let lying = upright_to(Vec3::X);
            let straights = [spool(size, BAY as f32), lagged(size, BAY as f32), branched(size)];
            pipes.spools.push(straights.map(|solid| stock.shape(turned(&solid, lying))));
            let upright = [spool(size, STOREY as f32), lagged(size, STOREY as f32)];
            pipes.uprights.push(upright.map(|solid| stock.shape(solid)));
            pipes.valved.push(standing_valve(size, 0.0, STOREY as f32, 1.3).map(|solid| stock.shape(solid)));
            pipes.ends_up.push(UNDERSIDE.map(|under| stock.shape(end_up(size, under))));
            pipes.ends_down.push(UNDERSIDE.map(|under| end_down(size, under).map(|solid| stock.shape(solid))));
            pipes.turns.push(stock.shape(turn_out(size)));
        }
        pipes
    }
}

fn turned(solid: &Solid, turn: Mat3) -> Solid {
    let mut out = Solid::default();
    out.join(solid, turn, Vec3::ZERO);
    out
}

/// A straight pipe along y from 0 on, with a flanged joint.
fn spool((radius, sides, count): (f32, usize, usize), length: f32) -> Solid {
    let mut solid = Solid::default();
    rod(&mut solid, sides, radius, Vec3::ZERO, Vec3::Y * length);
    solid.join(&flange(sides, radius, count), Mat3::IDENTITY, Vec3::Y * (length * 0.3));
    solid
}

/// The same in lagging, with a band every metre and a clamp.
fn lagged((radius, sides, _): (f32, usize, usize), length: f32) -> Solid {
    let mut solid = Solid::default();
    let thick = radius * 1.12 + 0.012;
    rod(&mut solid, sides, thick, Vec3::ZERO, Vec3::Y * length);
    let bands = length as usize;
    for k in 0..bands {
        let y = (k as f32 + 0.5) * length / bands as f32;
        solid.column(sides, glam::Vec2::ZERO, (y - 0.02, thick * 1.03), (y + 0.02, thick * 1.03));
    }
    solid
}

/// A pipe of a bay with a tee: a branch goes up from it, with a flange.
fn branched(size: (f32, usize, usize)) -> Solid {
    let (radius, sides, count) = size;
    let mut solid = Solid::default();
    rod(&mut solid, sides, radius, Vec3::ZERO, Vec3::Y * BAY as f32);
    let joint = flange(sides, radius, count);
    solid.join(&joint, Mat3::IDENTITY, Vec3::Y * BAY as f32 * 0.35);
    // The branch is thinner and goes towards -z, which is up once the pipe lies along x.
    let thin = radius * 0.6;
    let (foot, head) = (Vec3::new(0.0, 4.6, 0.0), Vec3::new(0.0, 4.6, -radius * 1.8 - 0.12));
    rod(&mut solid, sides, thin, foot, head);
    solid.join(&flange(sides, thin, count), upright_to(Vec3::NEG_Z), head);
    for y in [2.0, 6.4] {
        solid.column(sides, glam::Vec2::ZERO, (y - 0.06, radius * 1.12), (y + 0.06, radius * 1.12));
        bolts(&mut solid, 4, radius * 1.2 + 0.01, radius * 0.12 + 0.005, (y - 0.05, y + 0.05));
    }
    solid
}

/// A pipe along y from `y0` to `y1` with a valve at `at`, and the valve's wheel towards x.
fn standing_valve((radius, sides, _): (f32, usize, usize), y0: f32, y1: f32, at: f32) -> [Solid; 2] {
    let [body, wheel] = valve(radius);
    // The valve lies along x with its stem along y: it is turned to stand, the stem towards x.
    let turn = Mat3::from_cols(Vec3::Y, Vec3::X, Vec3::NEG_Z);
    let mut stand = Solid::default();
    rod(&mut stand, sides, radius, Vec3::Y * y0, Vec3::Y * y1);
    stand.join(&body, turn, Vec3::Y * at);
    let mut hand = Solid::default();
    hand.join(&wheel, turn, Vec3::Y * at);
    [stand, hand]
}

/// Radius of a bend about the pipe's axis.
fn bend(radius: f32) -> f32 {
    radius * 3.0
}

/// How far beyond its end a run's last bend reaches.
pub(super) fn overhang(radius: f32) -> f32 {
    bend(radius) + 0.15
}

/// From the end of a run along x on the lane above `under`: a bend up and on to the floor above, a collar at the floor.
fn end_up((radius, sides, _): (f32, usize, usize), under: f32) -> Solid {
    let mut solid = Solid::default();
    // It ends within the deck, not level with it.
    let rise = STOREY as f32 - under - radius - 0.06;
    let corner = Vec3::X * overhang(radius);
    pipe(&mut solid, sides, radius, &[Vec3::ZERO, corner, corner + Vec3::Y * rise], (bend(radius), 5));
    solid.column(sides, glam::Vec2::new(corner.x, 0.0), (rise - 0.16, radius * 1.6), (rise - 0.1, radius * 1.6));
    solid
}

/// From the end of a run along x on the lane above `under`: a bend down to the floor, with a valve on the way.
fn end_down(size: (f32, usize, usize), under: f32) -> [Solid; 2] {
    let (radius, sides, _) = size;
    let fall = under + radius;
    let corner = Vec3::X * overhang(radius);
    let [stand, wheel] = standing_valve(size, -fall, -fall + 0.4, 1.25 - fall);
    let mut solid = Solid::default();
    pipe(&mut solid, sides, radius, &[Vec3::ZERO, corner, corner - Vec3::Y * (fall - 0.3)], (bend(radius), 5));
    solid.join(&stand, Mat3::IDENTITY, corner);
    solid.column(sides, glam::Vec2::new(corner.x, 0.0), (-fall, radius * 1.7), (-fall + 0.05, radius * 1.7));
    let mut hand = Solid::default();
    hand.join(&wheel, Mat3::IDENTITY, corner);
    [solid, hand]
}

/// From a riser's end upward: a bend to x, and a blind flange.
fn turn_out((radius, sides, count): (f32, usize, usize)) -> Solid {
    let mut solid = Solid::default();
    let (corner, end) = (Vec3::Y * overhang(radius), overhang(radius) + 0.5);
    pipe(&mut solid, sides, radius, &[Vec3::ZERO, corner, corner + Vec3::X * end], (bend(radius), 6));
    solid.join(&flange(sides, radius, count), upright_to(Vec3::X), corner + Vec3::X * end);
    solid.join(&flange(sides, radius, count), Mat3::IDENTITY, Vec3::ZERO);
    solid
}

/// What a lane along x hangs from: channels across it at both ends of a bay's middle, on rods from the steel.
fn trapeze(under: f32) -> Solid {
    let mut solid = Solid::default();
    let width = LANE.1 as f32 + 0.3;
    for x in [2.0, 6.0] {
        let z = width * 0.5 - 0.15;
        solid.block(x, under - 0.1, z, Vec3::new(0.1, 0.1, width));
        for z in [-0.1, width - 0.2] {
            rod(&mut solid, 6, 0.015, Vec3::new(x, under - 0.14, z), Vec3::new(x, STOREY as f32 - 0.3, z));
            solid.column(6, glam::Vec2::new(x, z), (under - 0.13, 0.03), (under - 0.1, 0.03));
        }
    }
    solid
}

/// Six thin tubes up a column's side, with clamps.
fn conduits() -> Solid {
    let mut solid = Solid::default();
    for k in 0..6 {
        let radius = [0.02, 0.014][k % 2];
        rod(&mut solid, 6, radius, Vec3::Z * (k as f32 * 0.06), Vec3::new(0.0, STOREY as f32, k as f32 * 0.06));
    }
    for y in [0.7, 1.9, 3.1, 4.3] {
        solid.cuboid(Vec3::new(-0.01, y, -0.05), Vec3::new(0.03, y + 0.04, 0.35));
    }
    solid.cuboid(Vec3::new(-0.02, 1.2, -0.04), Vec3::new(0.12, 1.6, 0.34));
    solid
}

/// A bay of cable tray along x: rails, rungs and some cables.
fn tray() -> Solid {
    let mut solid = Solid::default();
    let length = BAY as f32;
    for z in [-0.3, 0.3] {
        solid.block(length * 0.5, 0.0, z, Vec3::new(length, 0.1, 0.02));
    }
    for k in 0..24 {
        solid.block((k as f32 + 0.5) * length / 24.0, 0.01, 0.0, Vec3::new(0.03, 0.02, 0.58));
    }
    for (k, thick) in [0.03, 0.02, 0.035, 0.02, 0.025].into_iter().enumerate() {
        let z = -0.22 + 0.11 * k as f32;
        rod(&mut solid, 6, thick, Vec3::new(0.0, 0.03 + thick, z), Vec3::new(length, 0.03 + thick, z));
    }
    for x in [1.0, 5.0] {
        for z in [-0.32, 0.32] {
            rod(&mut solid, 5, 0.01, Vec3::new(x, 0.0, z), Vec3::new(x, 0.6, z));
        }
    }
    solid
}

/// Half of a rack's pipes (the other half has another colour), one over the other along x; the first half has the posts.
fn rack(sizes: &[usize], half: usize) -> Solid {
    let mut solid = Solid::default();
    let mut y = 0.3;
    for (k, &size) in sizes.iter().enumerate() {
        let (radius, sides, count) = SIZES[size];
        y += radius + 0.06;
        if k % 2 == half {
            let straight =
                if k % 4 < 2 { spool((radius, sides, count), BAY as f32) } else { lagged(SIZES[size], BAY as f32) };
            solid.join(&straight, upright_to(Vec3::X), Vec3::Y * y);
        }
        y += radius + 0.06;
    }
    for post in 0..3 * (1 - half) {
        solid.block(BAY as f32 * (post as f32 + 0.5) / 3.0, 0.0, -0.16, Vec3::new(0.08, 2.45, 0.08));
    }
    solid
}

/// What all pipes of a rack end in: an upright header, with a pipe up to the floor above.
fn header() -> Solid {
    let mut solid = Solid::default();
    vessel(&mut solid, 14, 0.16, 2.5);
    solid.column(12, glam::Vec2::ZERO, (2.4, 0.09), (STOREY as f32, 0.09));
    solid.join(&flange(14, 0.09, 8), Mat3::IDENTITY, Vec3::Y * 2.9);
    solid.block(0.0, 0.0, 0.0, Vec3::new(0.36, 0.06, 0.3));
    solid
}
