//! The other machines of the rows: turbine sets, distilling plants, air compressors.
//!
//! Some 8,000 to 14,000 triangles each; bolts and nozzles are most of them.

use glam::{Mat3, Vec2, Vec3};

use super::super::piping::{beam, bolts, flange, pipe, torus, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::engine::{generator, panel};
use super::parts::{Assembly, about_y, along_x, facing, paint, tubes};

/// A steam turbine over its condenser, a gear and a generator, around its middle.
pub(super) fn turbine(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut bed = Solid::default();
    for z in [-0.55, 0.55] {
        beam(&mut bed, Vec3::new(-2.5, 0.2, z), Vec3::new(2.5, 0.2, z), Vec2::new(0.22, 0.4));
    }
    bed.cuboid(Vec3::new(-2.5, 0.4, -0.7), Vec3::new(2.5, 0.44, 0.7));
    set.once(stock, Rank::Must, "turbine/bed", bed, paint::DARK);
    let (mut casing, mut round) = (Solid::default(), Solid::default());
    let profile =
        [(0.2, 0.0), (0.36, 0.05), (0.4, 0.3), (0.5, 0.55), (0.62, 1.0), (0.64, 1.5), (0.45, 1.7), (0.25, 1.78)];
    round.lathe(26, &profile);
    for (y, r) in [(0.3, 0.44), (0.62, 0.56), (1.02, 0.66), (1.48, 0.68)] {
        round.column(26, Vec2::ZERO, (y - 0.03, r), (y + 0.03, r));
    }
    round.lathe(16, &[(0.15, -0.25), (0.26, -0.2), (0.26, 0.0)]);
    round.lathe(16, &[(0.24, 1.75), (0.24, 1.98), (0.12, 2.0)]);
    along_x(&mut casing, &round, Vec3::new(-2.2, 1.15, 0.0));
    set.once(stock, Rank::Must, "turbine/casing", casing, paint::LAGGING);
    turbine_rotor(&mut set, stock);
    turbine_joint(&mut set, stock);
    enclosure(&mut set, stock);
    turbine_steam(&mut set, stock);
    let mut gear = Solid::default();
    gear.block(0.35, 0.44, 0.0, Vec3::new(0.9, 0.72, 1.2));
    gear.block(0.35, 1.16, 0.0, Vec3::new(1.0, 0.05, 1.3));
    let half = |x: f32, z: f32| [(-x, -z), (-x, z), (x, z), (x, -z)].map(|(x, z)| Vec2::new(0.35 + x, z));
    gear.loft(&half(0.45, 0.6), 1.21, &half(0.38, 0.35), 1.62);
    for k in 0..16 {
        let (x, z) = ((k % 8) as f32 * 0.13 - 0.11, if k < 8 { -0.62 } else { 0.62 });
        gear.column(6, Vec2::new(x, z), (1.12, 0.02), (1.26, 0.02));
    }
    set.once(stock, Rank::Must, "turbine/gear", gear, paint::ENGINE);
    generator(&mut set, stock, Vec3::new(1.1, 1.12, 0.0), 1.4);
    panel(&mut set, stock, Vec3::new(0.35, 0.5, 0.68));
    set
}

/// The sound-proof housing around turbine and gear: panels in frames, doors, louvres, an uptake. It hides them.
fn enclosure(set: &mut Assembly, stock: &mut Stock) {
    let (x0, x1, half, top) = (-2.36, 0.95, 0.74, 2.5);
    let mut walls = Solid::default();
    walls.cuboid(Vec3::new(x0, 0.44, -half), Vec3::new(x1, top, -half + 0.04));
    walls.cuboid(Vec3::new(x0, 0.44, half - 0.04), Vec3::new(x1, top, half));
    for x in [x0, x1 - 0.04] {
        walls.cuboid(Vec3::new(x, 0.44, -half + 0.04), Vec3::new(x + 0.04, top, half - 0.04));
    }
    walls.cuboid(Vec3::new(x0 - 0.03, top, -half - 0.03), Vec3::new(x1 + 0.03, top + 0.05, half + 0.03));
    walls.block(-1.4, top + 0.05, 0.0, Vec3::new(0.8, 5.3 - top, 0.7));
    set.once(stock, Rank::Must, "enclosure/walls", walls, paint::BULKHEAD);
    let mut frames = Solid::default();
    for side in [-1.0, 1.0] {
        let z = side * (half + 0.015);
        for k in 0..=4 {
            frames.block(x0 + (x1 - x0) * k as f32 / 4.0, 0.44, z, Vec3::new(0.06, top - 0.44, 0.03));
        }
        for k in [0, 2, 3] {
            let x = x0 + (x1 - x0) * (k as f32 + 0.5) / 4.0;
            frames.block(x, 0.6, z, Vec3::new(0.64, 1.7, 0.02));
            frames.block(x + 0.26, 1.35, z + side * 0.02, Vec3::new(0.03, 0.16, 0.03));
            for y in [0.8, 2.0] {
                frames.block(x - 0.3, y, z + side * 0.015, Vec3::new(0.04, 0.12, 0.02));
            }
        }
        let x = x0 + (x1 - x0) * 1.5 / 4.0;
        for k in 0..14 {
            frames.block(x, 0.8 + 0.1 * k as f32, z, Vec3::new(0.6, 0.05, 0.06));
        }
    }
    for y in [3.1, 3.9, 4.7] {
        frames.block(-1.4, y, 0.0, Vec3::new(0.88, 0.06, 0.78));
    }
    set.once(stock, Rank::Detail, "enclosure/frames", frames, paint::FRAMES);
}

/// A screen across a row, between two machines: stiffened plate with a gauge board and an extinguisher.
pub(super) fn screen(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut plate = Solid::default();
    plate.cuboid(Vec3::new(-0.01, 0.0, -0.76), Vec3::new(0.01, 2.72, 0.86));
    plate.cuboid(Vec3::new(-0.07, 2.72, -0.78), Vec3::new(0.07, 2.74, 0.88));
    for k in 0..5 {
        let z = -0.7 + 0.375 * k as f32;
        plate.cuboid(Vec3::new(0.01, 0.0, z - 0.008), Vec3::new(0.09, 2.72, z + 0.008));
        plate.cuboid(Vec3::new(0.09, 0.0, z - 0.035), Vec3::new(0.1, 2.72, z + 0.035));
    }
    set.once(stock, Rank::Must, "screen/plate", plate, paint::BULKHEAD);
    let mut board = Solid::default();
    board.cuboid(Vec3::new(-0.06, 1.2, -0.6), Vec3::new(-0.01, 2.3, 0.6));
    for k in 0..15 {
        let mut dial = Solid::default();
        dial.lathe(12, &[(0.09, 0.0), (0.09, 0.04), (0.075, 0.04), (0.07, 0.03)]);
        let at = Vec3::new(-0.06, 1.45 + (k / 5) as f32 * 0.3, (k % 5) as f32 * 0.23 - 0.46);
        board.join(&dial, upright_to(Vec3::NEG_X), at);
    }
    set.once(stock, Rank::Detail, "screen/board", board, paint::DARK);
    let mut bottle = Solid::default();
    vessel(&mut bottle, 14, 0.09, 0.6);
    bottle.column(8, Vec2::ZERO, (0.58, 0.03), (0.7, 0.03));
    bottle.block(0.04, 0.68, 0.0, Vec3::new(0.2, 0.03, 0.03));
    set.many(
        stock,
        Rank::Detail,
        "screen/extinguisher",
        bottle,
        paint::FIRE,
        &[(Mat3::IDENTITY, Vec3::new(-0.12, 0.35, -0.62))],
    );
    set
}

/// Inside the casing: a shaft with wheels of blades.
fn turbine_rotor(set: &mut Assembly, stock: &mut Stock) {
    let (mut rotor, mut round) = (Solid::default(), Solid::default());
    round.column(14, Vec2::ZERO, (-0.2, 0.1), (1.9, 0.1));
    for (y, tip) in [(0.2, 0.3), (0.4, 0.36), (0.65, 0.44), (0.9, 0.5), (1.15, 0.56), (1.4, 0.58)] {
        round.column(16, Vec2::ZERO, (y - 0.04, tip * 0.6), (y + 0.04, tip * 0.6));
        for k in 0..20 {
            let mut blade = Solid::default();
            blade.cuboid(Vec3::new(tip * 0.55, y - 0.05, -0.012), Vec3::new(tip, y + 0.05, 0.012));
            round.join(&blade, about_y(k as f32 * std::f32::consts::TAU / 20.0), Vec3::ZERO);
        }
    }
    along_x(&mut rotor, &round, Vec3::new(-2.2, 1.15, 0.0));
    set.once(stock, Rank::Detail, "turbine/rotor", rotor, paint::STEEL);
}

/// The bolted joint around the casing at half its height.
fn turbine_joint(set: &mut Assembly, stock: &mut Stock) {
    let mut joint = Solid::default();
    let ways = [[(-2.2, 0.42), (-1.6, 0.6)], [(-1.6, 0.6), (-1.1, 0.74)], [(-1.1, 0.74), (-0.5, 0.74)]];
    for side in [-1.0, 1.0] {
        for [(x0, z0), (x1, z1)] in ways {
            let (from, to) = (Vec3::new(x0, 1.15, z0 * side), Vec3::new(x1, 1.15, z1 * side));
            beam(&mut joint, from, to, Vec2::new(0.14, 0.1));
            for k in 0..5 {
                let at = from.lerp(to, (k as f32 + 0.5) / 5.0);
                joint.column(6, Vec2::new(at.x, at.z), (1.06, 0.025), (1.27, 0.025));
            }
        }
    }
    set.once(stock, Rank::Detail, "turbine/joint", joint, paint::STEEL);
}

/// The steam chest with its admission valves, and the pipe that brings the steam.
fn turbine_steam(set: &mut Assembly, stock: &mut Stock) {
    let mut chest = Solid::default();
    chest.block(-1.95, 1.55, 0.0, Vec3::new(0.4, 0.28, 0.8));
    for k in 0..5 {
        let z = k as f32 * 0.16 - 0.32;
        let mut servo = Solid::default();
        servo.lathe(
            12,
            &[(0.05, 0.0), (0.07, 0.06), (0.07, 0.16), (0.03, 0.18), (0.03, 0.3), (0.055, 0.31), (0.055, 0.36)],
        );
        chest.join(&servo, Mat3::IDENTITY, Vec3::new(-1.95, 1.83, z));
    }
    set.once(stock, Rank::Detail, "turbine/chest", chest, paint::STEEL);
    let mut steam = Solid::default();
    let way = [(-2.15, 1.68, 0.25), (-2.5, 1.68, 0.25), (-2.5, 5.2, 0.25)].map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut steam, 16, 0.13, &way, (0.3, 5));
    for y in [2.3, 3.6, 4.9] {
        steam.join(&flange(16, 0.13, 10), Mat3::IDENTITY, Vec3::new(-2.5, y, 0.25));
    }
    set.once(stock, Rank::Must, "turbine/steam", steam, paint::STEAM);
    let mut drains = Solid::default();
    for k in 0..6 {
        let x = -2.0 + 0.28 * k as f32;
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let way =
            [(x, 0.8, 0.2), (x, 0.62, 0.6), (x, 0.5, 0.68), (x, 0.1, 0.68)].map(|(x, y, z)| Vec3::new(x, y, z * side));
        pipe(&mut drains, 8, 0.025, &way, (0.08, 3));
    }
    set.once(stock, Rank::Detail, "turbine/drains", drains, paint::STEAM);
}

/// A large shell on saddles with bolted heads and nozzles, a brine drum above, pumps before it.
pub(super) fn evaporator(stock: &mut Stock) -> Assembly {
    let mut plant = Assembly::default();
    let (mut shell, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 28, 0.62, 3.6);
    along_x(&mut shell, &round, Vec3::new(-2.3, 1.0, 0.0));
    for x in [-1.7, -0.5, 0.7] {
        shell.block(x, 0.0, 0.0, Vec3::new(0.14, 0.62, 1.1));
        shell.block(x, 0.0, 0.0, Vec3::new(0.3, 0.03, 1.3));
    }
    plant.once(stock, Rank::Must, "evaporator/shell", shell, paint::LAGGING);
    let mut girth = Solid::default();
    for (y0, y1) in [(-0.05, -0.004), (0.004, 0.05)] {
        girth.column(28, Vec2::ZERO, (y0, 0.72), (y1, 0.72));
    }
    bolts(&mut girth, 28, 0.675, 0.018, (-0.075, 0.075));
    let along = upright_to(Vec3::X);
    plant.many(
        stock,
        Rank::Detail,
        "evaporator/girth",
        girth,
        paint::STEEL,
        &[(along, Vec3::new(-1.95, 1.0, 0.0)), (along, Vec3::new(0.95, 1.0, 0.0))],
    );
    let mut bundle = Solid::default();
    along_x(&mut bundle, &tubes(0.55, 0.1, 3.0), Vec3::new(-2.0, 1.0, 0.0));
    plant.once(stock, Rank::Detail, "evaporator/tubes", bundle, paint::BRASS);
    let mut nozzle = Solid::default();
    nozzle.column(14, Vec2::ZERO, (0.5, 0.09), (0.86, 0.09));
    nozzle.join(&flange(14, 0.09, 8), Mat3::IDENTITY, Vec3::Y * 0.86);
    pipe(&mut nozzle, 14, 0.09, &[Vec3::Y * 0.86, Vec3::Y * 1.3, Vec3::new(0.5, 1.3, 0.0)], (0.2, 5));
    let turns = [(-1.4, 0.0), (-0.6, 0.0), (0.3, 0.0)].map(|(x, z)| (Mat3::IDENTITY, Vec3::new(x, 1.0, z)));
    plant.many(stock, Rank::Detail, "evaporator/nozzle", nozzle, paint::STEAM, &turns);
    let mut drum = Solid::default();
    let mut round = Solid::default();
    vessel(&mut round, 20, 0.3, 1.9);
    along_x(&mut drum, &round, Vec3::new(-1.6, 2.45, 0.0));
    for x in [-1.2, -0.1] {
        drum.block(x, 1.6, 0.0, Vec3::new(0.08, 0.6, 0.4));
    }
    plant.once(stock, Rank::Must, "evaporator/drum", drum, paint::FRESH);
    for (k, z) in [(0, -0.35), (1, 0.35)] {
        pump_set(&mut plant, stock, Vec3::new(1.75, 0.0, z), if k == 0 { paint::MOTOR } else { paint::SEA });
    }
    panel(&mut plant, stock, Vec3::new(0.0, 0.5, 0.68));
    plant
}

/// A centrifugal pump and its motor about x on a base plate, 1.3 long: pump aft.
pub(super) fn pump_set(set: &mut Assembly, stock: &mut Stock, at: Vec3, color: [u8; 3]) {
    let mut base = Solid::default();
    base.block(at.x, at.y, at.z, Vec3::new(1.3, 0.12, 0.46));
    for x in [-0.55, 0.1, 0.5] {
        base.block(at.x + x, at.y + 0.12, at.z, Vec3::new(0.12, 0.14, 0.36));
    }
    set.once(stock, Rank::Detail, "pump/base", base, paint::DARK);
    let (mut motor, mut round) = (Solid::default(), Solid::default());
    round.lathe(
        18,
        &[
            (0.03, -0.12),
            (0.03, 0.0),
            (0.15, 0.0),
            (0.17, 0.03),
            (0.17, 0.55),
            (0.15, 0.58),
            (0.19, 0.58),
            (0.19, 0.68),
            (0.1, 0.7),
        ],
    );
    for k in 0..12 {
        let angle = k as f32 * std::f32::consts::TAU / 12.0;
        let mut fin = Solid::default();
        fin.cuboid(Vec3::new(0.16, 0.06, -0.006), Vec3::new(0.205, 0.52, 0.006));
        round.join(&fin, about_y(angle), Vec3::ZERO);
    }
    along_x(&mut motor, &round, at + Vec3::new(-0.05, 0.42, 0.0));
    motor.block(at.x + 0.25, at.y + 0.56, at.z, Vec3::new(0.2, 0.12, 0.16));
    set.once(stock, Rank::Detail, "pump/motor", motor, color);
    let (mut pump, mut round) = (Solid::default(), Solid::default());
    round.lathe(14, &[(0.08, -0.2), (0.08, -0.1), (0.18, -0.08), (0.22, 0.0), (0.18, 0.08), (0.1, 0.12), (0.06, 0.2)]);
    bolts(&mut round, 6, 0.17, 0.012, (-0.1, 0.1));
    round.join(&flange(12, 0.08, 4), Mat3::IDENTITY, Vec3::Y * -0.2);
    along_x(&mut pump, &round, at + Vec3::new(-0.45, 0.42, 0.0));
    let outlet = [(-0.45, 0.5, 0.12), (-0.45, 0.95, 0.12)].map(|(x, y, z)| at + Vec3::new(x, y, z));
    pipe(&mut pump, 14, 0.065, &outlet, (0.1, 1));
    pump.join(&flange(12, 0.065, 4), Mat3::IDENTITY, at + Vec3::new(-0.45, 0.85, 0.12));
    set.once(stock, Rank::Detail, "pump/casing", pump, paint::STEEL);
}

/// Three finned cylinders over a crankcase, a motor, a receiver beside: one bay long.
pub(super) fn compressor(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut base = Solid::default();
    base.block(0.0, 0.0, 0.0, Vec3::new(2.5, 0.25, 1.3));
    base.block(-0.6, 0.25, -0.1, Vec3::new(1.0, 0.5, 0.6));
    set.once(stock, Rank::Must, "compressor/base", base, paint::DARK);
    let mut cylinder = Solid::default();
    let fins = (0..=18).map(|k| (if k % 2 == 0 { 0.12 } else { 0.18 }, 0.03 * k as f32));
    cylinder.lathe(16, &fins.collect::<Vec<_>>());
    cylinder.lathe(12, &[(0.15, 0.54), (0.15, 0.62), (0.06, 0.66)]);
    bolts(&mut cylinder, 6, 0.12, 0.014, (0.6, 0.65));
    let stand = [-0.95, -0.6, -0.25].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.75, -0.1)));
    set.many(stock, Rank::Detail, "compressor/cylinder", cylinder, paint::STEEL, &stand);
    let mut ways = Solid::default();
    for x in [-0.95, -0.6, -0.25] {
        let way = [(x, 1.3, 0.1), (x, 1.3, 0.42), (x, 0.8, 0.42), (0.5, 0.8, 0.42)].map(|(x, y, z)| Vec3::new(x, y, z));
        pipe(&mut ways, 8, 0.03, &way, (0.1, 4));
    }
    set.once(stock, Rank::Detail, "compressor/ways", ways, paint::BRASS);
    let (mut receiver, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 20, 0.24, 2.2);
    along_x(&mut receiver, &round, Vec3::new(-1.1, 1.85, -0.1));
    for x in [-0.8, 0.8] {
        receiver.block(x, 0.25, -0.1, Vec3::new(0.08, 1.45, 0.4));
    }
    set.once(stock, Rank::Must, "compressor/receiver", receiver, paint::AIR);
    pump_set(&mut set, stock, Vec3::new(0.65, 0.25, -0.1), paint::MOTOR);
    let mut guard = Solid::default();
    torus(&mut guard, 24, 0.32, 6, 0.02);
    guard.column(24, Vec2::ZERO, (-0.05, 0.3), (0.05, 0.3));
    set.many(
        stock,
        Rank::Detail,
        "compressor/flywheel",
        guard,
        paint::WHEEL,
        &[(upright_to(Vec3::X), Vec3::new(-1.18, 0.62, -0.1))],
    );
    panel(&mut set, stock, Vec3::new(0.7, 0.5, 0.62));
    let mut tray = Solid::default();
    tray.block(0.0, 0.0, 0.0, Vec3::new(0.3, 0.12, 0.3));
    set.many(stock, Rank::Fill, "compressor/box", tray, paint::CABINET, &[(facing(-1.0), Vec3::new(1.1, 0.25, -0.5))]);
    set
}
