//! The diesel sets: a V12 engine with its heads, crankcase doors, exhaust and turbochargers, and a generator behind it.
//!
//! Everything that is there several times is one mesh: a head, a door, a mount. About 25,000 triangles a set.

use glam::{Mat3, Vec2, Vec3};

use super::super::piping::{beam, bolts, flange, pipe, rod, torus, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::parts::{Assembly, about_y, along_x, extrude, facing, paint, tilted};

/// Cylinders of a bank, metres from one to the next, and where the first stands.
const CYLINDERS: usize = 6;
const PITCH: f32 = 0.54;
const FIRST: f32 = -2.0;
/// Half the angle of the V, in degrees, and the foot of a head, up and aside.
const BANK: f32 = 28.0;
const HEAD: (f32, f32) = (1.36, 0.4);
/// Where the crankcase begins and ends, and where the generator does.
const CASE: (f32, f32) = (-2.35, 1.05);
const GENERATOR: (f32, f32) = (1.3, 2.6);

/// A diesel set around its middle, its free end aft.
pub(super) fn diesel(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    bed(&mut set, stock);
    crankcase(&mut set, stock);
    heads(&mut set, stock);
    fuel(&mut set, stock);
    exhaust(&mut set, stock);
    free_end(&mut set, stock);
    running_gear(&mut set, stock);
    generator(&mut set, stock, Vec3::new(GENERATOR.0, 1.0, 0.0), GENERATOR.1 - GENERATOR.0);
    panel(&mut set, stock, Vec3::new(1.15, 0.5, 0.62));
    set
}

fn cylinder(k: usize) -> f32 {
    FIRST + k as f32 * PITCH
}

/// Two girders with cross members on resilient mounts.
fn bed(set: &mut Assembly, stock: &mut Stock) {
    let mut girders = Solid::default();
    for z in [-0.56, 0.56] {
        for (y, size) in [(0.14, Vec2::new(0.2, 0.02)), (0.24, Vec2::new(0.03, 0.2)), (0.34, Vec2::new(0.2, 0.02))] {
            beam(&mut girders, Vec3::new(-2.5, y, z), Vec3::new(2.6, y, z), size);
        }
        for k in 0..9 {
            girders.block(-2.3 + 0.6 * k as f32, 0.15, z, Vec3::new(0.02, 0.18, 0.18));
        }
    }
    for k in 0..5 {
        girders.block(-2.3 + 1.2 * k as f32, 0.16, 0.0, Vec3::new(0.16, 0.16, 1.1));
    }
    set.once(stock, Rank::Must, "diesel/bed", girders, paint::DARK);
    let mut mount = Solid::default();
    mount.lathe(10, &[(0.13, 0.0), (0.13, 0.03), (0.07, 0.04), (0.1, 0.08), (0.07, 0.12), (0.09, 0.13)]);
    let places: Vec<(Mat3, Vec3)> =
        (0..10).map(|k| at(-2.3 + 1.2 * (k / 2) as f32, 0.0, if k % 2 == 0 { -0.58 } else { 0.58 })).collect();
    set.many(stock, Rank::Detail, "diesel/mount", mount, paint::CABLE, &places);
}

/// A place without a turn.
fn at(x: f32, y: f32, z: f32) -> (Mat3, Vec3) {
    (Mat3::IDENTITY, Vec3::new(x, y, z))
}

fn crankcase(set: &mut Assembly, stock: &mut Stock) {
    let mut case = Solid::default();
    // The valley of the V makes the section concave: two halves, each convex.
    let half = [(0.34, 0.0), (1.35, 0.0), (1.5, 0.14), (1.22, 0.66), (0.9, 0.62), (0.34, 0.5)];
    extrude(&mut case, CASE.0, CASE.1, &half.map(|(y, z)| Vec2::new(y, z)));
    let other: Vec<Vec2> = half.iter().rev().map(|&(y, z)| Vec2::new(y, -z)).collect();
    extrude(&mut case, CASE.0, CASE.1, &other);
    for k in 0..=CYLINDERS {
        let x = FIRST + (k as f32 - 0.5) * PITCH;
        for side in [-1.0f32, 1.0] {
            let (z0, z1) = (side * 0.5, side * 0.66);
            case.cuboid(Vec3::new(x - 0.025, 0.36, z0.min(z1)), Vec3::new(x + 0.025, 1.2, z0.max(z1)));
        }
    }
    set.once(stock, Rank::Must, "diesel/crankcase", case, paint::ENGINE);
    let mut door = Solid::default();
    // Lying on y = 0, turned upright below.
    door.column(8, Vec2::ZERO, (0.0, 0.2), (0.025, 0.2));
    door.lathe(12, &[(0.13, 0.025), (0.12, 0.05), (0.0, 0.06)]);
    bolts(&mut door, 8, 0.17, 0.013, (0.02, 0.045));
    let mut places = Vec::new();
    for k in 0..CYLINDERS {
        for side in [-1.0, 1.0] {
            places.push((tilted(side * 102.0), Vec3::new(cylinder(k), 0.62, side * 0.56)));
        }
    }
    set.many(stock, Rank::Detail, "diesel/door", door, paint::ENGINE, &places);
}

/// Cylinder heads on both banks: jacket, cover, studs, injector and its lead.
fn heads(set: &mut Assembly, stock: &mut Stock) {
    let (mut jacket, mut cover, mut gear) = (Solid::default(), Solid::default(), Solid::default());
    jacket.column(16, Vec2::ZERO, (-0.25, 0.2), (0.02, 0.22));
    jacket.block(0.0, 0.02, 0.0, Vec3::new(0.48, 0.17, 0.44));
    jacket.block(0.0, 0.06, 0.24, Vec3::new(0.2, 0.1, 0.1));
    for (x, z) in [(-0.21, -0.19), (0.21, -0.19), (-0.21, 0.19), (0.21, 0.19), (-0.21, 0.0), (0.21, 0.0)] {
        jacket.column(6, Vec2::new(x, z), (0.18, 0.024), (0.235, 0.024));
    }
    let rounded = |half: Vec2, cut: f32| {
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].into_iter().flat_map(move |(x, z): (f32, f32)| {
            let (a, b) = (Vec2::new(x * half.x, z * (half.y - cut)), Vec2::new(x * (half.x - cut), z * half.y));
            if x * z > 0.0 { [a, b] } else { [b, a] }
        })
    };
    let outline = |x: f32, z: f32, cut: f32| rounded(Vec2::new(x, z), cut).collect::<Vec<_>>();
    cover.loft(&outline(0.2, 0.18, 0.05), 0.19, &outline(0.2, 0.18, 0.05), 0.28);
    cover.loft(&outline(0.2, 0.18, 0.05), 0.28, &outline(0.14, 0.12, 0.04), 0.33);
    cover.lathe(8, &[(0.03, 0.33), (0.03, 0.36), (0.045, 0.36), (0.045, 0.375)]);
    gear.column(8, Vec2::new(0.0, 0.22), (0.1, 0.035), (0.3, 0.03));
    let lead =
        [Vec3::new(0.0, 0.28, 0.22), Vec3::new(0.0, 0.34, 0.22), Vec3::new(0.1, 0.34, 0.3), Vec3::new(0.1, -0.1, 0.32)];
    pipe(&mut gear, 5, 0.012, &lead, (0.04, 2));
    gear.block(0.1, -0.28, 0.3, Vec3::new(0.12, 0.2, 0.12));
    gear.column(8, Vec2::new(0.1, 0.3), (-0.08, 0.035), (0.0, 0.03));
    let places = banks();
    set.many(stock, Rank::Detail, "diesel/head", jacket, paint::HEAD, &places);
    set.many(stock, Rank::Detail, "diesel/cover", cover, paint::COVER, &places);
    set.many(stock, Rank::Detail, "diesel/injector", gear, paint::STEEL, &places);
}

/// The places of the heads on both banks.
fn banks() -> Vec<(Mat3, Vec3)> {
    let sides = [(1.0, tilted(BANK)), (-1.0, facing(-1.0) * tilted(BANK))];
    let place = |k: usize, side: f32, turn: Mat3| (turn, Vec3::new(cylinder(k), HEAD.0, side * HEAD.1));
    (0..CYLINDERS).flat_map(|k| sides.map(|(side, turn)| place(k, side, turn))).collect()
}

/// Fuel and water rails along both banks, with a branch to every head.
fn fuel(set: &mut Assembly, stock: &mut Stock) {
    let (mut rails, mut branches) = (Solid::default(), Solid::default());
    let (x0, x1) = (CASE.0, CASE.1 - 0.1);
    for (y, z, radius) in [(1.1, 0.68, 0.03), (1.02, 0.68, 0.022), (0.94, 0.7, 0.018)] {
        pipe(&mut rails, 8, radius, &[Vec3::new(x0, y, z), Vec3::new(x1, y, z)], (0.0, 1));
    }
    for k in 0..CYLINDERS {
        let x = cylinder(k) - 0.12;
        let way = [(1.1, 0.68), (1.28, 0.76), (1.46, 0.7), (1.48, 0.58)].map(|(y, z)| Vec3::new(x, y, z));
        pipe(&mut branches, 6, 0.02, &way, (0.06, 2));
    }
    let both = [at(0.0, 0.0, 0.0), (facing(-1.0), Vec3::new(x0 + x1 - 0.3, 0.0, 0.0))];
    set.many(stock, Rank::Detail, "diesel/rails", rails, paint::FUEL, &both);
    set.many(stock, Rank::Detail, "diesel/branches", branches, paint::BRASS, &both);
}

/// Lagged manifolds in the valley, a branch from every head, two turbochargers and the pipe up to the exhaust trunk.
fn exhaust(set: &mut Assembly, stock: &mut Stock) {
    let mut manifold = Solid::default();
    for z in [-0.13, 0.13] {
        pipe(&mut manifold, 14, 0.11, &[Vec3::new(CASE.0 - 0.1, 1.72, z), Vec3::new(CASE.1 - 0.2, 1.72, z)], (0.0, 1));
    }
    let mut branch = Solid::default();
    pipe(
        &mut branch,
        8,
        0.055,
        &[Vec3::new(0.0, 1.48, 0.28), Vec3::new(0.0, 1.66, 0.3), Vec3::new(0.0, 1.72, 0.12)],
        (0.1, 2),
    );
    branch.join(&flange(8, 0.055, 3), tilted(8.0), Vec3::new(0.0, 1.56, 0.29));
    let mut places = Vec::new();
    for k in 0..CYLINDERS {
        places.push(at(cylinder(k) + 0.1, 0.0, 0.0));
        places.push((facing(-1.0), Vec3::new(cylinder(k) - 0.1, 0.0, 0.0)));
    }
    set.once(stock, Rank::Must, "diesel/manifold", manifold, paint::LAGGING);
    set.many(stock, Rank::Detail, "diesel/exhaust", branch, paint::TURBO, &places);
    let mut turbo = Solid::default();
    let mut wheel = Solid::default();
    wheel.lathe(
        18,
        &[
            (0.08, -0.34),
            (0.2, -0.3),
            (0.24, -0.2),
            (0.24, -0.1),
            (0.12, -0.04),
            (0.12, 0.06),
            (0.2, 0.1),
            (0.2, 0.16),
            (0.1, 0.2),
        ],
    );
    bolts(&mut wheel, 8, 0.215, 0.012, (-0.22, -0.08));
    wheel.lathe(20, &[(0.17, 0.2), (0.17, 0.4), (0.05, 0.42)]);
    turbo.join(&wheel, upright_to(Vec3::NEG_Z), Vec3::ZERO);
    let mut scroll = Solid::default();
    torus(&mut scroll, 14, 0.19, 7, 0.085);
    turbo.join(&scroll, upright_to(Vec3::Z), Vec3::new(0.0, 0.0, -0.13));
    turbo.block(0.0, -0.4, 0.05, Vec3::new(0.3, 0.3, 0.2));
    let places = [at(CASE.0 - 0.02, 1.95, 0.22), (facing(-1.0), Vec3::new(CASE.0 - 0.02, 1.95, -0.22))];
    set.many(stock, Rank::Detail, "diesel/turbocharger", turbo, paint::TURBO, &places);
    let mut riser = Solid::default();
    let way = [Vec3::new(CASE.0, 2.1, 0.0), Vec3::new(CASE.0, 5.6, 0.0)];
    pipe(&mut riser, 18, 0.2, &way, (0.3, 4));
    set.once(stock, Rank::Must, "diesel/riser", riser, paint::LAGGING);
    let (mut silencer, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 24, 0.42, 3.0);
    for y in [0.5, 1.5, 2.5] {
        round.column(24, Vec2::ZERO, (y - 0.03, 0.44), (y + 0.03, 0.44));
    }
    along_x(&mut silencer, &round, Vec3::new(CASE.0 - 0.2, 4.25, 0.0));
    for x in [-1.6, 0.2] {
        silencer.block(x, 4.6, 0.0, Vec3::new(0.05, 1.0, 0.3));
    }
    set.once(stock, Rank::Must, "diesel/silencer", silencer, paint::LAGGING);
    let mut bellows = Solid::default();
    let waves = (0..=14).map(|k| (if k % 2 == 0 { 0.21 } else { 0.26 }, 2.45 + 0.034 * k as f32));
    bellows.lathe(18, &waves.collect::<Vec<_>>());
    bellows.join(&flange(18, 0.2, 12), Mat3::IDENTITY, Vec3::Y * 2.4);
    bellows.join(&flange(18, 0.2, 12), Mat3::IDENTITY, Vec3::Y * 2.98);
    set.many(stock, Rank::Detail, "diesel/bellows", bellows, paint::STEEL, &[at(CASE.0, 0.0, 0.0)]);
}

/// What the case hides, as in a designer's model: the crankshaft, pistons on their rods, two camshafts.
fn running_gear(set: &mut Assembly, stock: &mut Stock) {
    let (mut shaft, mut round) = (Solid::default(), Solid::default());
    round.column(14, Vec2::ZERO, (-0.1, 0.09), (CASE.1 - CASE.0 + 0.2, 0.09));
    along_x(&mut shaft, &round, Vec3::new(CASE.0, 0.75, 0.0));
    for k in 0..CYLINDERS {
        let turn = tilted(120.0 * k as f32);
        let (mut throw, mut pin) = (Solid::default(), Solid::default());
        for x in [-0.13, 0.13] {
            throw.cuboid(Vec3::new(x - 0.04, -0.2, -0.11), Vec3::new(x + 0.04, 0.2, 0.11));
        }
        pin.column(12, Vec2::ZERO, (-0.13, 0.07), (0.13, 0.07));
        along_x(&mut throw, &pin, Vec3::Y * 0.13);
        shaft.join(&throw, turn, Vec3::new(cylinder(k), 0.75, 0.0));
    }
    set.once(stock, Rank::Detail, "diesel/crankshaft", shaft, paint::STEEL);
    let mut piston = Solid::default();
    let rings = [0.0, 0.14, 0.16, 0.18, 0.2, 0.24];
    let crown: Vec<(f32, f32)> =
        rings.iter().enumerate().map(|(k, &y)| (if k % 2 == 0 { 0.16 } else { 0.15 }, y - 0.36)).collect();
    piston.lathe(12, &crown);
    piston.block(0.0, -0.72, 0.0, Vec3::new(0.06, 0.42, 0.11));
    piston.column(10, Vec2::ZERO, (-0.8, 0.1), (-0.7, 0.1));
    set.many(stock, Rank::Detail, "diesel/piston", piston, paint::STEEL, &banks());
    let (mut camshaft, mut round) = (Solid::default(), Solid::default());
    round.column(10, Vec2::ZERO, (0.0, 0.035), (3.2, 0.035));
    for k in 0..CYLINDERS {
        for y in [0.28, 0.38, 0.48] {
            let y = y + PITCH * k as f32;
            round.column(8, Vec2::new(0.015, 0.02), (y, 0.06), (y + 0.05, 0.06));
        }
    }
    along_x(&mut camshaft, &round, Vec3::new(CASE.0 + 0.05, 1.05, 0.45));
    set.many(stock, Rank::Detail, "diesel/camshaft", camshaft, paint::STEEL, &[at(0.0, 0.0, 0.0), at(0.0, 0.0, -0.9)]);
}

/// The gear case with its pumps, the charge-air cooler above the coupling, two oil filters.
fn free_end(set: &mut Assembly, stock: &mut Stock) {
    let mut gear = Solid::default();
    extrude(
        &mut gear,
        CASE.0 - 0.18,
        CASE.0,
        &[(0.4, -0.6), (1.2, -0.66), (1.5, -0.3), (1.5, 0.3), (1.2, 0.66), (0.4, 0.6)].map(|(y, z)| Vec2::new(y, z)),
    );
    let mut damper = Solid::default();
    damper.lathe(20, &[(0.26, 0.0), (0.26, 0.09), (0.1, 0.1), (0.1, 0.14)]);
    bolts(&mut damper, 12, 0.2, 0.014, (0.08, 0.115));
    gear.join(&damper, upright_to(Vec3::NEG_X), Vec3::new(CASE.0 - 0.18, 0.75, 0.0));
    set.once(stock, Rank::Must, "diesel/gear_case", gear, paint::ENGINE);
    let mut pump = Solid::default();
    pump.lathe(14, &[(0.12, 0.0), (0.12, 0.08), (0.15, 0.1), (0.15, 0.2), (0.08, 0.24), (0.08, 0.3)]);
    bolts(&mut pump, 8, 0.135, 0.012, (0.08, 0.22));
    let mut upright = Solid::default();
    along_x(&mut upright, &pump, Vec3::new(-0.3, 0.0, 0.0));
    pipe(&mut upright, 12, 0.05, &[Vec3::new(-0.18, 0.0, 0.0), Vec3::new(-0.18, -0.75, 0.0)], (0.0, 1));
    upright.join(&flange(12, 0.05, 6), Mat3::IDENTITY, Vec3::new(-0.18, -0.3, 0.0));
    set.many(
        stock,
        Rank::Detail,
        "diesel/pump",
        upright,
        paint::MOTOR,
        &[at(CASE.0 - 0.18, 0.85, 0.42), at(CASE.0 - 0.18, 0.85, -0.42)],
    );
    let mut cooler = Solid::default();
    cooler.block(0.0, 0.0, 0.0, Vec3::new(0.5, 0.42, 1.0));
    for z in [-0.5, 0.5] {
        cooler.block(0.0, -0.03, z, Vec3::new(0.58, 0.48, 0.03));
        for k in 0..12 {
            let (x, y) = ((k % 6) as f32 * 0.1 - 0.25, if k < 6 { 0.0 } else { 0.42 });
            cooler.block(x, y - 0.015, z, Vec3::new(0.03, 0.03, 0.07));
        }
    }
    for k in 0..9 {
        cooler.block(0.0, 0.42, k as f32 * 0.1 - 0.4, Vec3::new(0.46, 0.03, 0.015));
    }
    set.many(stock, Rank::Detail, "diesel/cooler", cooler, paint::HEAD, &[at(CASE.1 - 0.15, 1.55, 0.0)]);
    let mut filter = Solid::default();
    vessel(&mut filter, 14, 0.13, 0.62);
    filter.join(&flange(14, 0.12, 8), Mat3::IDENTITY, Vec3::Y * 0.48);
    for side in [-0.05, 0.05] {
        rod(&mut filter, 6, 0.012, Vec3::new(side, -0.15, 0.0), Vec3::new(side, 0.05, 0.0));
    }
    set.many(
        stock,
        Rank::Detail,
        "diesel/filter",
        filter,
        paint::OIL,
        &[at(CASE.0 + 0.2, 0.5, 0.78), at(CASE.0 + 0.5, 0.5, 0.78)],
    );
}

/// A generator about x from `from` forward: frame with ribs, end bells, feet, the terminal box, and the coupling before it.
pub(super) fn generator(set: &mut Assembly, stock: &mut Stock, from: Vec3, length: f32) {
    let (mut frame, mut round) = (Solid::default(), Solid::default());
    let r = 0.62;
    round.lathe(
        24,
        &[
            (r * 0.5, 0.0),
            (r * 0.92, 0.06),
            (r, 0.12),
            (r, length - 0.12),
            (r * 0.92, length - 0.06),
            (r * 0.4, length),
        ],
    );
    for k in 0..5 {
        let y = 0.16 + (length - 0.32) * k as f32 / 4.0;
        round.column(24, Vec2::ZERO, (y - 0.012, r + 0.035), (y + 0.012, r + 0.035));
    }
    round.lathe(20, &[(0.14, -0.28), (0.2, -0.26), (0.2, -0.16), (0.3, -0.14), (0.3, 0.0)]);
    bolts(&mut round, 8, 0.25, 0.016, (-0.17, -0.11));
    along_x(&mut frame, &round, from);
    for z in [-0.5, 0.5] {
        for x in [0.2, length - 0.2] {
            frame.block(from.x + x, 0.34, z, Vec3::new(0.2, from.y - 0.6, 0.14));
        }
    }
    set.once(stock, Rank::Must, "generator/frame", frame, paint::GENERATOR);
    let (mut rotor, mut round) = (Solid::default(), Solid::default());
    round.column(14, Vec2::ZERO, (0.05, 0.1), (length - 0.05, 0.1));
    for k in 0..6 {
        let (mut pole, angle) = (Solid::default(), k as f32 * std::f32::consts::TAU / 6.0);
        pole.cuboid(Vec3::new(0.08, 0.25, -0.1), Vec3::new(0.38, length - 0.25, 0.1));
        pole.cuboid(Vec3::new(0.38, 0.22, -0.16), Vec3::new(0.45, length - 0.22, 0.16));
        for turn in 0..6 {
            let x = 0.12 + 0.04 * turn as f32;
            pole.cuboid(Vec3::new(x, 0.22, -0.15), Vec3::new(x + 0.03, length - 0.22, 0.15));
        }
        round.join(&pole, about_y(angle), Vec3::ZERO);
    }
    along_x(&mut rotor, &round, from);
    set.once(stock, Rank::Detail, "generator/rotor", rotor, paint::BRASS);
    let mut terminals = Solid::default();
    let middle = from + Vec3::X * length * 0.5;
    terminals.block(middle.x, from.y + 0.5, 0.0, Vec3::new(0.7, 0.36, 0.6));
    terminals.block(middle.x, from.y + 0.86, 0.0, Vec3::new(0.74, 0.02, 0.64));
    for k in 0..10 {
        let (x, z) = ((k % 5) as f32 * 0.15 - 0.3, if k < 5 { -0.29 } else { 0.29 });
        terminals.column(6, Vec2::new(middle.x + x, z), (from.y + 0.86, 0.014), (from.y + 0.9, 0.014));
    }
    for k in 0..5 {
        let way = [Vec3::new(0.35, 0.7, 0.0), Vec3::new(0.6, 0.7, 0.0), Vec3::new(0.6, 2.0, 0.0)];
        let shift = middle + Vec3::new(0.0, 0.0, k as f32 * 0.09 - 0.18);
        pipe(&mut terminals, 6, 0.03, &way.map(|p| p + shift), (0.15, 3));
    }
    set.once(stock, Rank::Detail, "generator/terminals", terminals, paint::CABLE);
    let mut louvres = Solid::default();
    for side in [-1.0, 1.0] {
        for k in 0..7 {
            let y = from.y - 0.25 + 0.07 * k as f32;
            louvres.block(middle.x, y, side * (r - 0.01), Vec3::new(length * 0.5, 0.03, 0.12));
        }
    }
    set.once(stock, Rank::Detail, "generator/louvres", louvres, paint::DARK);
}

/// A local panel with gauges and switches on a post, facing the aisle along the hull.
pub(super) fn panel(set: &mut Assembly, stock: &mut Stock, at: Vec3) {
    let (mut body, mut gauges) = (Solid::default(), Solid::default());
    body.block(at.x, at.y, at.z, Vec3::new(0.9, 0.9, 0.18));
    body.block(at.x, at.y + 0.88, at.z + 0.06, Vec3::new(0.94, 0.03, 0.34));
    for x in [-0.38, 0.38] {
        body.block(at.x + x, 0.0, at.z, Vec3::new(0.06, at.y, 0.06));
    }
    for k in 0..15 {
        let (column, row) = ((k % 5) as f32, (k / 5) as f32);
        let mut dial = Solid::default();
        dial.lathe(10, &[(0.065, 0.0), (0.065, 0.03), (0.055, 0.03), (0.05, 0.02)]);
        let place = at + Vec3::new(column * 0.165 - 0.33, 0.3 + row * 0.18, 0.09);
        gauges.join(&dial, upright_to(Vec3::Z), place);
    }
    for k in 0..10 {
        let mut knob = Solid::default();
        knob.column(6, Vec2::ZERO, (0.0, 0.02), (0.04, 0.016));
        gauges.join(&knob, upright_to(Vec3::Z), at + Vec3::new(k as f32 * 0.08 - 0.36, 0.12, 0.09));
    }
    set.once(stock, Rank::Must, "panel/body", body, paint::CABINET);
    set.once(stock, Rank::Detail, "panel/gauges", gauges, paint::DARK);
}
