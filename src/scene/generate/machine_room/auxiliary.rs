//! What stands along the hull: pumps, coolers, switchboards, air bottles, filters; lockers and bottles at the upper level; tanks
//! in the bilge, lamps and ducts overhead.
//!
//! Every place draws its kind by the seed. Made for starboard: z grows towards the hull.

use glam::{Mat3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::piping::{bolts, flange, pipe, torus, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::machines::pump_set;
use super::parts::{Assembly, Room, along_x, facing, paint, tubes};
use super::plan::{BAY, OPENING, UPPER};

/// Middle of what stands along the hull, from the room's middle, and its front.
const STAND: f32 = 4.26;
/// Middle of what stands at the upper level.
const SHELF: f32 = 4.16;

pub(super) fn auxiliaries(room: &mut Room) {
    let stock = &mut room.stock;
    let lower = [pumps(stock), coolers(stock), switchboard(stock), bottles(stock), filters(stock)];
    let upper = [lockers(stock), flasks(stock), starters(stock)];
    let bilge = tanks(stock);
    let mut pump = Assembly::default();
    pump_set(&mut pump, stock, Vec3::new(0.9, -1.5, 2.9), paint::BILGE);
    let lamp = lamp(stock);
    let duct = duct(stock);
    for bay in 0..room.plan.bays {
        let middle = room.plan.bay(bay) + BAY * 0.5;
        for side in [1.0, -1.0] {
            let mut random = Random::keyed(room.seed, 0x1000 + 4 * bay as u64 + u64::from(side > 0.0));
            lower[random.below(lower.len())].place(room, Vec3::new(middle, 0.0, STAND * side), side);
            upper[random.below(upper.len())].place(room, Vec3::new(middle, UPPER, SHELF * side), side);
            bilge.place(room, Vec3::new(middle, 0.0, 0.0), side);
            if (side > 0.0) == bay.is_multiple_of(2) {
                pump.place(room, Vec3::new(middle, 0.0, 0.0), side);
            }
            for z in [0.95, 2.3] {
                lamp.place(room, Vec3::new(middle - 0.8, if z < 1.0 { 5.0 } else { 5.25 }, z * side), side);
            }
            // None where one comes up the stair.
            if side < 0.0 || middle > OPENING {
                lamp.place(room, Vec3::new(middle + 0.8, UPPER - 0.3, 3.3 * side), side);
            }
        }
        duct.place(room, Vec3::new(middle, 0.0, 0.0), 1.0);
    }
}

/// Two pump sets one behind the other, and a strainer between.
fn pumps(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    pump_set(&mut set, stock, Vec3::new(-0.8, 0.0, -0.05), paint::MOTOR);
    pump_set(&mut set, stock, Vec3::new(0.75, 0.0, -0.05), paint::SEA);
    let mut header = Solid::default();
    let way = [(-1.25, 0.95, 0.07), (-1.25, 1.35, 0.07), (1.45, 1.35, 0.07), (1.45, 2.5, 0.07)]
        .map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut header, 14, 0.065, &way, (0.15, 5));
    pipe(&mut header, 14, 0.065, &[Vec3::new(0.3, 0.95, 0.07), Vec3::new(0.3, 1.35, 0.07)], (0.0, 1));
    for x in [-0.6, 0.9] {
        header.join(&flange(14, 0.065, 6), upright_to(Vec3::X), Vec3::new(x, 1.35, 0.07));
    }
    header.join(&flange(14, 0.065, 6), Mat3::IDENTITY, Vec3::new(1.45, 1.9, 0.07));
    set.once(stock, Rank::Detail, "pumps/header", header, paint::SEA);
    let (mut board, mut dials) = (Solid::default(), Solid::default());
    board.block(-0.2, 1.45, 0.36, Vec3::new(2.2, 0.8, 0.06));
    board.block(-0.2, 1.5, 0.32, Vec3::new(2.1, 0.7, 0.03));
    for k in 0..12 {
        let mut dial = Solid::default();
        dial.lathe(12, &[(0.09, 0.0), (0.09, 0.04), (0.075, 0.04), (0.07, 0.03)]);
        let at = Vec3::new((k % 6) as f32 * 0.33 - 1.02, 1.68 + (k / 6) as f32 * 0.32, 0.305);
        dials.join(&dial, upright_to(Vec3::NEG_Z), at);
        dials.block(at.x, at.y - 0.14, 0.295, Vec3::new(0.12, 0.03, 0.02));
    }
    set.once(stock, Rank::Detail, "pumps/board", board, paint::CABINET);
    set.once(stock, Rank::Detail, "pumps/dials", dials, paint::DARK);
    set
}

/// Two heat exchangers one above the other on saddles.
fn coolers(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let (mut shell, mut round) = (Solid::default(), Solid::default());
    round.lathe(22, &[(0.28, 0.0), (0.3, 0.02), (0.3, 2.1), (0.28, 2.12)]);
    along_x(&mut shell, &round, Vec3::new(-1.05, 0.0, 0.0));
    let (mut head, mut round) = (Solid::default(), Solid::default());
    for y in [0.0, 2.12] {
        for (y0, y1) in [(y - 0.06, y - 0.005), (y + 0.005, y + 0.06)] {
            round.column(22, Vec2::ZERO, (y0, 0.37), (y1, 0.37));
        }
        bolts(&mut round, 20, 0.335, 0.015, (y - 0.09, y + 0.09));
    }
    round.lathe(22, &[(0.0, -0.26), (0.14, -0.23), (0.26, -0.14), (0.3, -0.05)]);
    round.lathe(22, &[(0.3, 2.17), (0.26, 2.26), (0.14, 2.35), (0.0, 2.38)]);
    along_x(&mut head, &round, Vec3::new(-1.05, 0.0, 0.0));
    let mut saddle = Solid::default();
    for x in [-0.6, 0.6] {
        saddle.block(x, -0.5, 0.0, Vec3::new(0.1, 0.3, 0.5));
    }
    let levels = [0.5, 1.4].map(|y| (Mat3::IDENTITY, Vec3::new(0.0, y, 0.0)));
    set.many(stock, Rank::Must, "cooler/shell", shell, paint::FRESH, &levels);
    set.many(stock, Rank::Detail, "cooler/head", head, paint::STEEL, &levels);
    set.many(stock, Rank::Detail, "cooler/saddle", saddle, paint::DARK, &levels);
    let mut bundle = Solid::default();
    along_x(&mut bundle, &tubes(0.27, 0.085, 2.1), Vec3::new(-1.05, 0.0, 0.0));
    set.many(stock, Rank::Detail, "cooler/tubes", bundle, paint::BRASS, &levels);
    let mut nozzle = Solid::default();
    nozzle.column(14, Vec2::ZERO, (0.25, 0.075), (0.48, 0.075));
    nozzle.join(&flange(14, 0.075, 8), Mat3::IDENTITY, Vec3::Y * 0.44);
    let places =
        [(-0.8, 0.5), (0.8, 0.5), (-0.8, 1.4), (0.8, 1.4)].map(|(x, y)| (Mat3::IDENTITY, Vec3::new(x, y, 0.0)));
    set.many(stock, Rank::Detail, "cooler/nozzle", nozzle, paint::SEA, &places);
    set
}

/// Four cabinets with doors, meters, handles and lamps.
fn switchboard(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut cabinet = Solid::default();
    cabinet.block(0.0, 0.0, 0.0, Vec3::new(0.7, 0.1, 0.56));
    cabinet.block(0.0, 0.1, 0.0, Vec3::new(0.71, 1.85, 0.6));
    for (y, height) in [(0.14, 0.6), (0.78, 0.5), (1.32, 0.58)] {
        cabinet.block(0.0, y, -0.31, Vec3::new(0.66, height, 0.03));
        cabinet.block(-0.3, y + 0.1, -0.33, Vec3::new(0.02, 0.06, 0.03));
        cabinet.block(-0.3, y + height - 0.16, -0.33, Vec3::new(0.02, 0.06, 0.03));
    }
    cabinet.block(0.0, 1.95, 0.0, Vec3::new(0.2, 0.6, 0.12));
    let mut front = Solid::default();
    for k in 0..6 {
        let mut dial = Solid::default();
        dial.lathe(10, &[(0.075, 0.0), (0.075, 0.03), (0.065, 0.03), (0.06, 0.02)]);
        let place = Vec3::new((k % 3) as f32 * 0.2 - 0.2, 1.52 + (k / 3) as f32 * 0.2, -0.325);
        front.join(&dial, upright_to(Vec3::NEG_Z), place);
    }
    for k in 0..8 {
        let mut knob = Solid::default();
        knob.column(6, Vec2::ZERO, (0.0, 0.022), (0.05, 0.018));
        let place = Vec3::new((k % 4) as f32 * 0.15 - 0.22, 0.85 + (k / 4) as f32 * 0.13, -0.325);
        front.join(&knob, upright_to(Vec3::NEG_Z), place);
    }
    for (y, z) in [(0.4, -0.35), (1.08, -0.35)] {
        front.block(0.28, y, z, Vec3::new(0.03, 0.16, 0.04));
    }
    let mut breakers = Solid::default();
    for k in 0..12 {
        let (x, y) = ((k % 3) as f32 * 0.2 - 0.2, 0.2 + (k / 3) as f32 * 0.42);
        breakers.block(x, y, 0.0, Vec3::new(0.15, 0.3, 0.2));
        breakers.block(x, y + 0.08, -0.12, Vec3::new(0.04, 0.12, 0.06));
    }
    for x in [-0.2, 0.0, 0.2] {
        breakers.block(x, 0.15, 0.2, Vec3::new(0.06, 1.7, 0.02));
    }
    let places = [-1.08, -0.36, 0.36, 1.08].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.0, 0.02)));
    set.many(stock, Rank::Detail, "switchboard/cabinet", cabinet, paint::CABINET, &places);
    set.many(stock, Rank::Detail, "switchboard/breakers", breakers, paint::BRASS, &places);
    set.many(stock, Rank::Detail, "switchboard/front", front, paint::DARK, &places);
    set
}

/// Seven upright air bottles in a rack with their manifold.
fn bottles(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut bottle = Solid::default();
    vessel(&mut bottle, 18, 0.19, 1.75);
    bottle.lathe(10, &[(0.05, 1.72), (0.05, 1.86), (0.025, 1.88), (0.025, 1.95)]);
    bottle.column(14, Vec2::ZERO, (0.0, 0.16), (0.1, 0.16));
    let places: Vec<(Mat3, Vec3)> =
        (0..7).map(|k| (Mat3::IDENTITY, Vec3::new(k as f32 * 0.41 - 1.23, 0.0, 0.06))).collect();
    set.many(stock, Rank::Detail, "bottles/bottle", bottle, paint::AIR, &places);
    let mut tap = Solid::default();
    let way = [(0.0, 1.93, 0.0), (0.0, 2.12, 0.0), (0.0, 2.12, 0.2)].map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut tap, 8, 0.018, &way, (0.06, 4));
    let mut wheel = Solid::default();
    torus(&mut wheel, 14, 0.06, 5, 0.01);
    wheel.column(6, Vec2::ZERO, (-0.12, 0.01), (0.01, 0.01));
    tap.join(&wheel, upright_to(Vec3::NEG_Z), Vec3::new(0.0, 2.0, -0.12));
    set.many(stock, Rank::Detail, "bottles/tap", tap, paint::BRASS, &places);
    let mut rack = Solid::default();
    for y in [0.45, 1.3] {
        for z in [-0.15, 0.27] {
            rack.cuboid(Vec3::new(-1.48, y, z - 0.012), Vec3::new(1.48, y + 0.06, z + 0.012));
        }
    }
    for x in [-1.47, 1.47] {
        rack.block(x, 0.0, -0.15, Vec3::new(0.05, 1.5, 0.05));
    }
    pipe(&mut rack, 10, 0.035, &[Vec3::new(-1.4, 2.12, 0.26), Vec3::new(1.4, 2.12, 0.26)], (0.0, 1));
    set.once(stock, Rank::Detail, "bottles/rack", rack, paint::DARK);
    set
}

/// Duplex strainers, a day tank on legs, and the pipes between.
fn filters(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut tank = Solid::default();
    vessel(&mut tank, 24, 0.4, 1.4);
    let mut legs = Solid::default();
    for at in super::super::solid::circle(4, Vec2::ZERO, 0.34) {
        legs.column(6, at, (0.0, 0.04), (0.8, 0.04));
    }
    legs.lathe(12, &[(0.06, 0.5), (0.06, 0.7)]);
    let places = [-0.95, 0.0].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.65, 0.0)));
    set.many(stock, Rank::Must, "filters/tank", tank, paint::OIL, &places);
    let places = [-0.95, 0.0].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.0, 0.0)));
    set.many(stock, Rank::Detail, "filters/legs", legs, paint::DARK, &places);
    let mut strainer = Solid::default();
    strainer.lathe(16, &[(0.12, 0.3), (0.16, 0.34), (0.16, 0.9), (0.21, 0.9), (0.21, 0.99), (0.1, 1.02), (0.1, 1.06)]);
    bolts(&mut strainer, 10, 0.185, 0.013, (0.86, 1.02));
    strainer.column(8, Vec2::ZERO, (0.0, 0.05), (0.32, 0.05));
    let places = [0.75, 1.2].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.0, -0.1)));
    set.many(stock, Rank::Detail, "filters/strainer", strainer, paint::FUEL, &places);
    let mut ways = Solid::default();
    let way = [(-0.95, 0.6, 0.0), (-0.95, 0.3, 0.0), (0.75, 0.3, -0.05), (0.75, 0.6, -0.05)]
        .map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut ways, 10, 0.04, &way, (0.12, 4));
    let way = [(0.75, 0.6, -0.2), (0.98, 0.6, -0.24), (1.2, 0.6, -0.2)].map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut ways, 10, 0.04, &way, (0.1, 3));
    let way =
        [(0.0, 2.0, 0.0), (0.0, 2.35, 0.0), (1.2, 2.35, 0.0), (1.2, 1.0, 0.0)].map(|(x, y, z)| Vec3::new(x, y, z));
    pipe(&mut ways, 10, 0.04, &way, (0.12, 4));
    set.once(stock, Rank::Detail, "filters/ways", ways, paint::FUEL);
    set
}

/// Steel lockers with louvres.
fn lockers(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut locker = Solid::default();
    locker.block(0.0, 0.08, 0.0, Vec3::new(0.48, 1.1, 0.36));
    locker.block(0.0, 0.12, -0.185, Vec3::new(0.45, 1.02, 0.015));
    for k in 0..10 {
        locker.block(
            0.0,
            0.25 + (k % 5) as f32 * 0.05 + if k < 5 { 0.0 } else { 0.55 },
            -0.195,
            Vec3::new(0.3, 0.02, 0.015),
        );
    }
    locker.block(0.19, 0.6, -0.2, Vec3::new(0.025, 0.12, 0.03));
    for (x, z) in [(-0.2, -0.14), (0.2, -0.14), (-0.2, 0.14), (0.2, 0.14)] {
        locker.block(x, 0.0, z, Vec3::new(0.04, 0.08, 0.04));
    }
    let places = [-1.2, -0.7, -0.2, 0.3, 0.8].map(|x| (Mat3::IDENTITY, Vec3::new(x, 0.0, 0.0)));
    set.many(stock, Rank::Detail, "locker", locker, paint::DOOR, &places);
    set
}

/// Six flasks lying in a rack, three over three.
fn flasks(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let (mut flask, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 16, 0.15, 2.5);
    round.lathe(8, &[(0.03, 2.46), (0.03, 2.6), (0.05, 2.6), (0.05, 2.66)]);
    along_x(&mut flask, &round, Vec3::new(-1.3, 0.0, 0.0));
    let places = [(0.22, -0.12), (0.22, 0.2), (0.54, -0.12), (0.54, 0.2), (0.86, 0.02)];
    let places = places.map(|(y, z)| (Mat3::IDENTITY, Vec3::new(0.0, y, z)));
    set.many(stock, Rank::Detail, "flasks/flask", flask, paint::FIRE, &places);
    let mut rack = Solid::default();
    for x in [-0.8, 0.7] {
        for z in [-0.3, 0.36] {
            rack.block(x, 0.0, z, Vec3::new(0.05, 1.05, 0.04));
        }
        for y in [0.04, 0.37, 0.69] {
            rack.block(x, y, 0.03, Vec3::new(0.05, 0.03, 0.7));
        }
    }
    set.once(stock, Rank::Detail, "flasks/rack", rack, paint::DARK);
    set
}

/// Motor starters with their cables, on a frame.
fn starters(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut starter = Solid::default();
    starter.block(0.0, 0.35, 0.0, Vec3::new(0.38, 0.6, 0.24));
    starter.block(0.0, 0.37, -0.13, Vec3::new(0.34, 0.56, 0.02));
    for k in 0..4 {
        let mut knob = Solid::default();
        knob.column(6, Vec2::ZERO, (0.0, 0.025), (0.04, 0.02));
        starter.join(
            &knob,
            upright_to(Vec3::NEG_Z),
            Vec3::new((k % 2) as f32 * 0.14 - 0.07, 0.55 + (k / 2) as f32 * 0.15, -0.14),
        );
    }
    starter.block(0.12, 0.42, -0.155, Vec3::new(0.03, 0.1, 0.03));
    let mut cables = Solid::default();
    for k in 0..3 {
        let x = k as f32 * 0.09 - 0.09;
        let way = [(x, 0.4, 0.02), (x, 0.1, 0.02), (x, 0.1, 0.5), (x, -0.4, 0.6)].map(|(x, y, z)| Vec3::new(x, y, z));
        pipe(&mut cables, 5, 0.02, &way, (0.12, 2));
    }
    let places: Vec<(Mat3, Vec3)> =
        (0..6).map(|k| (Mat3::IDENTITY, Vec3::new(k as f32 * 0.48 - 1.2, 0.0, 0.0))).collect();
    set.many(stock, Rank::Detail, "starter/box", starter, paint::CABINET, &places);
    set.many(stock, Rank::Detail, "starter/cables", cables, paint::CABLE, &places);
    set
}

/// Tanks in the bilge: a large one beside the keel with a manhole, a small one in the turn of the bilge.
fn tanks(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let (mut large, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 24, 0.8, 2.7);
    along_x(&mut large, &round, Vec3::new(-1.35, -1.85, 1.25));
    for x in [-0.8, 0.8] {
        large.block(x, -2.95, 1.25, Vec3::new(0.12, 0.5, 1.1));
    }
    set.once(stock, Rank::Must, "tank/large", large, paint::BILGE);
    let mut coil = Solid::default();
    let ways = (0..=24).map(|k| {
        let z = [-0.45, -0.45, 0.45, 0.45][k % 4];
        Vec3::new(-1.1 + 0.18 * (k / 2) as f32, -2.2 + 0.1 * (k % 2) as f32, 1.25 + z)
    });
    pipe(&mut coil, 6, 0.03, &ways.collect::<Vec<_>>(), (0.08, 1));
    set.once(stock, Rank::Detail, "tank/coil", coil, paint::STEAM);
    let mut manhole = Solid::default();
    manhole.lathe(18, &[(0.26, -1.08), (0.26, -0.98), (0.32, -0.98), (0.32, -0.92), (0.2, -0.9)]);
    bolts(&mut manhole, 10, 0.29, 0.014, (-0.96, -0.89));
    set.many(
        stock,
        Rank::Detail,
        "tank/manhole",
        manhole,
        paint::STEEL,
        &[(Mat3::IDENTITY, Vec3::new(-0.4, 0.0, 1.25))],
    );
    let (mut small, mut round) = (Solid::default(), Solid::default());
    vessel(&mut round, 20, 0.5, 1.5);
    along_x(&mut small, &round, Vec3::new(-1.2, -1.25, 3.0));
    set.once(stock, Rank::Detail, "tank/small", small, paint::FUEL);
    set
}

/// A lamp: a tube under a reflector on two rods.
fn lamp(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let (mut tube, mut round, mut hood) = (Solid::default(), Solid::default(), Solid::default());
    round.column(10, Vec2::ZERO, (-0.55, 0.035), (0.55, 0.035));
    along_x(&mut tube, &round, Vec3::ZERO);
    let outline = |x: f32, z: f32| [(-x, -z), (-x, z), (x, z), (x, -z)].map(|(x, z)| Vec2::new(x, z));
    hood.loft(&outline(0.62, 0.13), 0.02, &outline(0.6, 0.06), 0.09);
    for x in [-0.57, 0.57] {
        hood.block(x, -0.05, 0.0, Vec3::new(0.04, 0.09, 0.1));
        hood.column(5, Vec2::new(x * 0.8, 0.0), (0.08, 0.01), (0.3, 0.01));
    }
    set.once(stock, Rank::Must, "lamp/tube", tube, paint::LAMP);
    set.once(stock, Rank::Detail, "lamp/hood", hood, paint::SHELL);
    set
}

/// A bay of the ventilation duct under the crown of the hull, with joints, and branches that end in bell mouths.
fn duct(stock: &mut Stock) -> Assembly {
    let mut set = Assembly::default();
    let mut trunk = Solid::default();
    trunk.cuboid(Vec3::new(-BAY * 0.5, 6.15, -0.42), Vec3::new(BAY * 0.5, 6.6, 0.42));
    for x in [-0.8, 0.8] {
        trunk.cuboid(Vec3::new(x - 0.03, 6.11, -0.46), Vec3::new(x + 0.03, 6.64, 0.46));
    }
    set.once(stock, Rank::Must, "duct/trunk", trunk, paint::STEAM);
    let mut mouth = Solid::default();
    pipe(
        &mut mouth,
        16,
        0.13,
        &[Vec3::new(0.0, 6.3, 0.35), Vec3::new(0.0, 6.3, 1.3), Vec3::new(0.0, 5.3, 1.3)],
        (0.3, 5),
    );
    mouth.join(
        Solid::default().lathe(16, &[(0.26, 5.1), (0.2, 5.2), (0.14, 5.4)]),
        Mat3::IDENTITY,
        Vec3::new(0.0, 0.0, 1.3),
    );
    let places = [(Mat3::IDENTITY, Vec3::X * 0.5), (facing(-1.0), Vec3::X * -0.4)];
    set.many(stock, Rank::Detail, "duct/mouth", mouth, paint::STEAM, &places);
    set
}
