//! Pipe runs along the whole room, overhead, below the catwalks and in the bilge; their flanges, valves and hangers; branches
//! to the machines and auxiliaries; cable trays, the crane's rail.
//!
//! A run is laid in straights of a bay, all instances of one mesh a size, with joints between; what sits on it is drawn by the
//! seed. Flanges and valves are most of the room's triangles.

use glam::{Mat3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::piping::{beam, flange, pipe, rod, torus, valve};
use super::super::solid::{Solid, upright_to};
use super::super::stock::Rank;
use super::parts::{Room, paint};
use super::plan::{BAY, END, Kind, ROW, Slot, UPPER};

/// Radius in metres, sides and bolts of the pipe sizes.
const SIZES: [(f32, usize, usize); 5] = [(0.03, 8, 4), (0.05, 10, 4), (0.075, 12, 6), (0.11, 14, 8), (0.3, 20, 16)];

/// Runs on either side: height, distance from the middle, size, paint.
const RUNS: [(f32, f32, usize, [u8; 3]); 26] = [
    (6.3, 0.72, 1, paint::STEAM),
    (6.25, 1.0, 2, paint::FRESH),
    (6.2, 1.32, 0, paint::FUEL),
    (6.25, 1.75, 1, paint::OIL),
    (6.05, 2.3, 2, paint::SEA),
    (5.6, ROW, 4, paint::LAGGING),
    (5.55, 2.55, 1, paint::FRESH),
    (5.6, 2.8, 2, paint::SEA),
    (5.5, 3.05, 0, paint::AIR),
    (5.35, 3.55, 1, paint::FIRE),
    (4.85, 3.98, 0, paint::OIL),
    (2.95, 2.4, 1, paint::FRESH),
    (2.95, 2.62, 0, paint::FUEL),
    (2.85, 3.95, 2, paint::SEA),
    (2.9, 4.2, 1, paint::OIL),
    (2.95, 4.42, 0, paint::AIR),
    (2.8, 4.65, 3, paint::FIRE),
    (-0.5, 0.3, 2, paint::BILGE),
    (-0.5, 0.7, 1, paint::SEA),
    (-0.55, 1.06, 1, paint::FRESH),
    (-0.62, 1.5, 0, paint::OIL),
    (-0.6, 2.0, 3, paint::SEA),
    (-0.5, 2.45, 1, paint::FUEL),
    (-0.55, 2.9, 2, paint::BILGE),
    (-0.5, 3.3, 0, paint::AIR),
    (-0.7, 3.7, 2, paint::OIL),
];

/// The shapes of one size.
struct Size {
    straight: u32,
    end: u32,
    flange: u32,
    body: u32,
    wheel: u32,
    hanger: u32,
}

struct Fittings {
    sizes: Vec<Size>,
}

pub(super) fn runs(room: &mut Room) {
    let fittings = Fittings::new(room);
    for (number, run) in RUNS.iter().enumerate() {
        for side in [1.0, -1.0] {
            let mut random = Random::keyed(room.seed, 0x200 + 2 * number as u64 + u64::from(side > 0.0));
            lay(room, &fittings, &mut random, *run, side);
        }
    }
    for slot in room.plan.slots.clone() {
        machine_branches(room, &fittings, slot);
    }
    for bay in 0..room.plan.bays {
        for side in [1.0, -1.0] {
            hull_branches(room, &fittings, bay, side);
        }
        crossings(room, &fittings, bay);
    }
    trays(room);
    crane(room);
}

impl Fittings {
    fn new(room: &mut Room) -> Fittings {
        let stock = &mut room.stock;
        let sizes = SIZES.iter().map(|&(radius, sides, count)| {
            let straight = |length: f32| {
                let mut solid = Solid::default();
                pipe(&mut solid, sides, radius, &[Vec3::ZERO, Vec3::X * length], (0.0, 1));
                solid
            };
            let mut joint = Solid::default();
            joint.join(&flange(sides + 2, radius, count), upright_to(Vec3::X), Vec3::ZERO);
            let [body, wheel] = valve(radius);
            let mut hanger = Solid::default();
            let mut clamp = Solid::default();
            clamp.column(8, Vec2::ZERO, (-0.02, radius * 1.1 + 0.004), (0.02, radius * 1.1 + 0.004));
            hanger.join(&clamp, upright_to(Vec3::X), Vec3::ZERO);
            rod(&mut hanger, 4, 0.01, Vec3::Y * radius, Vec3::Y * (radius + 0.2));
            Size {
                straight: stock.shape(straight(BAY)),
                end: stock.shape(straight(END)),
                flange: stock.shape(joint),
                body: stock.shape(body),
                wheel: stock.shape(wheel),
                hanger: stock.shape(hanger),
            }
        });
        Fittings { sizes: sizes.collect() }
    }
}

/// Lays a run from bulkhead to bulkhead.
fn lay(room: &mut Room, fittings: &Fittings, random: &mut Random, run: (f32, f32, usize, [u8; 3]), side: f32) {
    let (y, z, number, color) = run;
    let (size, bays) = (&fittings.sizes[number], room.plan.bays);
    let place = |x: f32| (Mat3::IDENTITY, Vec3::new(x, y, z * side));
    let last = room.plan.length() - END;
    room.put(Rank::Must, "pipe/end", size.end, place(0.0), color);
    room.put(Rank::Must, "pipe/end", size.end, place(last), color);
    // Where it goes through the bulkheads.
    for x in [0.06, room.plan.length() - 0.06].into_iter().filter(|_| number > 1) {
        room.put(Rank::Fill, "pipe/collar", size.flange, place(x), color);
    }
    // The handwheel points down from what lies high, else to the middle; near the walk there are none.
    let wheel = if y > 6.0 { Vec3::NEG_Y } else { Vec3::Z * -side };
    let valves = number < 4 && !(3.1..4.0).contains(&z) || y < UPPER;
    let turn = Mat3::from_cols(Vec3::X, wheel, Vec3::X.cross(wheel));
    for bay in 0..=bays {
        let x = room.plan.bay(bay);
        if random.chance(0.6) {
            room.put(Rank::Fill, "pipe/flange", size.flange, place(x), color);
        }
        if bay == bays {
            break;
        }
        room.put(Rank::Must, "pipe/straight", size.straight, place(x), color);
        for &dx in if number > 1 { &[0.8, 2.4][..] } else { &[1.6] } {
            room.put(Rank::Fill, "pipe/hanger", size.hanger, place(x + dx), paint::STEEL);
        }
        let at = Vec3::new(x + random.range(1.1, 2.1) as f32, y, z * side);
        if valves && random.chance(0.14) {
            room.put(Rank::Fill, "valve/body", size.body, (turn, at), color);
            room.add("valve/wheel", size.wheel, (turn, at), paint::WHEEL);
        } else if random.chance(0.12) {
            room.put(Rank::Fill, "pipe/flange", size.flange, (Mat3::IDENTITY, at), color);
        }
    }
}

/// A branch from `at`, with flanges or a valve on it; they come and go with it.
struct Branch<'a> {
    size: usize,
    color: [u8; 3],
    at: Vec3,
    way: &'a [Vec3],
    flanges: &'a [(Vec3, Vec3)],
    /// Where, along what, and where the handwheel points.
    valve: Option<(Vec3, Vec3, Vec3)>,
}

impl Branch<'_> {
    fn lay(&self, room: &mut Room, fittings: &Fittings) {
        let ((radius, sides, _), size) = (SIZES[self.size], &fittings.sizes[self.size]);
        let mut solid = Solid::default();
        pipe(&mut solid, sides, radius, self.way, (radius * 2.5, 4));
        room.put_new(Rank::Fill, "branch/pipe", solid, self.at, self.color);
        for &(at, along) in self.flanges {
            // Fittings are made along x.
            let turn = upright_to(along) * upright_to(Vec3::X).transpose();
            room.add("branch/flange", size.flange, (turn, self.at + at), self.color);
        }
        if let Some((at, along, wheel)) = self.valve {
            let turn = Mat3::from_cols(along, wheel, along.cross(wheel));
            room.add("branch/valve", size.body, (turn, self.at + at), self.color);
            room.add("branch/wheel", size.wheel, (turn, self.at + at), paint::WHEEL);
        }
    }
}

/// From below the catwalk down to a machine's flank, and from the bilge up to its other one.
fn machine_branches(room: &mut Room, fittings: &Fittings, slot: Slot) {
    let mut random = Random::keyed(room.seed, 0x400_0000 + (slot.x * 16.0) as u64 * 2 + u64::from(slot.side > 0.0));
    let spans: &[(f64, f64)] = if slot.kind == Kind::Compressor {
        &[(-1.1, -0.7), (-0.4, 0.1)]
    } else {
        &[(-2.3, -1.6), (-1.2, -0.6), (1.8, 2.2)]
    };
    let side = slot.side;
    for &(low, high) in spans {
        let along = random.range(low, high) as f32 * side;
        let (size, color) =
            *random_of(&mut random, &[(1, paint::FRESH), (0, paint::FUEL), (1, paint::OIL), (0, paint::AIR)]);
        let low = random.range(0.5, 1.1) as f32;
        let way = [(2.9, 2.62), (2.9, 2.66), (low, 2.66), (low, 2.25)].map(|(y, z)| Vec3::new(0.0, y, z * side));
        let aim = if random.chance(0.5) { Vec3::X } else { Vec3::NEG_X };
        let drop = Branch {
            size,
            color,
            at: Vec3::X * (slot.x + along),
            way: &way,
            flanges: &[(Vec3::new(0.0, 2.5, 2.66 * side), Vec3::Y), (Vec3::new(0.0, low, 2.45 * side), Vec3::Z)],
            valve: Some((Vec3::new(0.0, random.range(1.5, 1.9) as f32, 2.66 * side), Vec3::Y, aim)),
        };
        drop.lay(room, fittings);
    }
    let count = if slot.kind == Kind::Compressor { 2 } else { 4 };
    for k in 0..count {
        let along = (k as f32 + 0.5) / count as f32 * 2.0 - 1.0;
        let (size, color) = *random_of(&mut random, &[(1, paint::SEA), (2, paint::FRESH), (1, paint::OIL)]);
        let high = random.range(0.35, 0.75) as f32;
        let way = [(-0.5, 1.12), (high, 1.12), (high, 1.45)].map(|(y, z)| Vec3::new(0.0, y, z * side));
        let riser = Branch {
            size,
            color,
            at: Vec3::X * (slot.x + along * (slot.half - 0.9)),
            way: &way,
            flanges: &[(Vec3::new(0.0, 0.15, 1.12 * side), Vec3::Y)],
            valve: None,
        };
        riser.lay(room, fittings);
    }
}

fn random_of<'a, T>(random: &mut Random, items: &'a [T]) -> &'a T {
    &items[random.below(items.len())]
}

/// Down to what stands along the hull, each with a valve above it; and short ones in the bilge.
fn hull_branches(room: &mut Room, fittings: &Fittings, bay: usize, side: f32) {
    let mut random = Random::keyed(room.seed, 0x800_0000 + 2 * bay as u64 + u64::from(side > 0.0));
    let x = room.plan.bay(bay);
    for k in 0..2 {
        let (size, color) =
            *random_of(&mut random, &[(1, paint::SEA), (2, paint::SEA), (1, paint::FRESH), (0, paint::OIL)]);
        let at = Vec3::X * (x + 0.8 + 1.6 * k as f32 + random.range(-0.5, 0.5) as f32);
        let way = [(2.85, 3.95), (1.95, 3.95), (1.95, 4.35), (-0.6, 4.35)].map(|(y, z)| Vec3::new(0.0, y, z * side));
        let aim = if random.chance(0.5) { Vec3::X } else { Vec3::NEG_X };
        let drop = Branch {
            size,
            color,
            at,
            way: &way,
            flanges: &[(Vec3::new(0.0, 2.6, 3.95 * side), Vec3::Y), (Vec3::new(0.0, 1.8, 4.35 * side), Vec3::Y)],
            valve: Some((Vec3::new(0.0, 2.3, 3.95 * side), Vec3::Y, aim)),
        };
        drop.lay(room, fittings);
    }
    let (size, color) = *random_of(&mut random, &[(1, paint::BILGE), (2, paint::BILGE), (1, paint::SEA)]);
    let at = Vec3::X * (x + random.range(0.6, 2.6) as f32);
    let way = [(-0.5, 0.3), (-0.8, 0.3), (-0.8, 2.0), (-1.6, 2.2)].map(|(y, z)| Vec3::new(0.0, y, z * side));
    let drain = Branch {
        size,
        color,
        at,
        way: &way,
        flanges: &[(Vec3::new(0.0, -0.8, 1.0 * side), Vec3::Z)],
        valve: Some((Vec3::new(0.0, -0.8, 0.62 * side), Vec3::Z * side, Vec3::Y)),
    };
    drain.lay(room, fittings);
}

/// From side to side below the exhaust trunks.
fn crossings(room: &mut Room, fittings: &Fittings, bay: usize) {
    let mut random = Random::keyed(room.seed, 0xc00_0000 + bay as u64);
    let x = room.plan.bay(bay);
    for k in 0..2 {
        let (size, color) =
            *random_of(&mut random, &[(2, paint::SEA), (1, paint::FRESH), (2, paint::STEAM), (1, paint::FIRE)]);
        let at = Vec3::X * (x + 0.3 + 1.9 * k as f32 + random.range(0.0, 0.5) as f32);
        let way = [(5.6, -2.8), (5.15, -2.6), (5.15, 2.6), (5.6, 2.8)].map(|(y, z)| Vec3::new(0.0, y, z));
        let joint = |z: f32| (Vec3::new(0.0, 5.15, z), Vec3::Z);
        let across = Branch { size, color, at, way: &way, flanges: &[joint(-1.3), joint(1.3)], valve: None };
        across.lay(room, fittings);
    }
}

/// Cable trays: overhead beside the middle, and below the upper plates along the hull.
fn trays(room: &mut Room) {
    let mut tray = Solid::default();
    for z in [-0.2, 0.2] {
        tray.cuboid(Vec3::new(0.0, 0.0, z - 0.006), Vec3::new(BAY, 0.08, z + 0.006));
    }
    for k in 0..11 {
        tray.block(0.15 + 0.29 * k as f32, 0.0, 0.0, Vec3::new(0.03, 0.02, 0.388));
    }
    let mut cables = Solid::default();
    for k in 0..7 {
        let (z, up) = (k as f32 * 0.052 - 0.156, (k * 5 % 7) as f32 * 0.005);
        let way = [(0.0, 0.04, 0.0), (1.6, 0.045 + up, 0.01), (BAY, 0.04, 0.0)];
        pipe(&mut cables, 5, 0.02, &way.map(|(x, y, dz)| Vec3::new(x, y, z + dz)), (0.3, 1));
    }
    let (tray, cables) = (room.stock.shape(tray), room.stock.shape(cables));
    for bay in 0..room.plan.bays {
        for (y, z) in [(5.5, 0.45), (5.5, -0.45), (2.55, 4.6), (2.55, -4.6), (4.45, 4.35), (4.45, -4.35)] {
            let place = (Mat3::IDENTITY, Vec3::new(room.plan.bay(bay), y, z));
            room.put(Rank::Detail, "tray/ladder", tray, place, paint::STEEL);
            room.put(Rank::Detail, "tray/cables", cables, place, paint::CABLE);
        }
    }
}

/// The rail of the overhead crane, hung from the frames, and its hoist.
fn crane(room: &mut Room) {
    let mut rail = Solid::default();
    for (y, size) in [(4.62, Vec2::new(0.16, 0.02)), (4.74, Vec2::new(0.02, 0.22)), (4.86, Vec2::new(0.16, 0.02))] {
        beam(&mut rail, Vec3::new(0.0, y, 0.0), Vec3::new(BAY, y, 0.0), size);
    }
    for x in [0.4, 2.0] {
        rail.block(x, 4.87, 0.0, Vec3::new(0.06, 1.3, 0.06));
    }
    let rail = room.stock.shape(rail);
    for bay in 0..room.plan.bays {
        let at = Vec3::X * room.plan.bay(bay);
        room.put(Rank::Must, "crane/rail", rail, (Mat3::IDENTITY, at), paint::RAIL);
    }
    let mut hoist = Solid::default();
    hoist.block(0.0, 4.2, 0.0, Vec3::new(0.5, 0.3, 0.3));
    for (x, z) in [(-0.18, -0.09), (0.18, -0.09), (-0.18, 0.09), (0.18, 0.09)] {
        hoist.block(x, 4.5, z, Vec3::new(0.1, 0.18, 0.02));
    }
    for k in 0..22 {
        let mut link = Solid::default();
        torus(&mut link, 8, 0.028, 5, 0.008);
        let turn = upright_to(if k % 2 == 0 { Vec3::X } else { Vec3::Z });
        hoist.join(&link, turn, Vec3::Y * (4.18 - 0.045 * k as f32));
    }
    let hook = [(0.0, 3.2), (0.0, 3.0), (0.12, 2.92), (0.05, 2.82), (-0.08, 2.9)].map(|(x, y)| Vec3::new(x, y, 0.0));
    pipe(&mut hoist, 8, 0.022, &hook, (0.06, 3));
    hoist.block(0.0, 3.15, 0.0, Vec3::new(0.12, 0.14, 0.08));
    let at = Vec3::X * (room.plan.length() * 0.8).min(room.plan.crossing() + 4.0);
    room.put_new(Rank::Must, "crane/hoist", hoist, at, paint::RAIL);
}
