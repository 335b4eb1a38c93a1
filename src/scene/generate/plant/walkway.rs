//! Walkways: aisles of grating with handrails on every floor, bridges on the floor of the walk, stairs, ladders and lamps.

use glam::{DVec2, DVec3, Mat3, Vec2, Vec3};

use super::super::piping::{beam, grating, ladder, rail, stairs};
use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::plan::{AISLE, Aisle, BAY, Deck, Plan, Room, STOREY, Use};
use super::site::{QUARTER, Site, along, parts, stretched};

const GRATING: [u8; 3] = [132, 136, 136];
const RAIL: [u8; 3] = [214, 176, 52];
const STEEL: [u8; 3] = [112, 132, 138];
const CONCRETE: [u8; 3] = [172, 168, 158];
/// Length of a panel of an aisle, and of a rail, in metres.
const PANEL: f64 = 2.0;
/// How far the panels of an aisle stand above the decks that they lie on, in metres.
const PROUD: f64 = 0.01;

/// Shapes of walkways.
pub(super) struct Ways {
    panel: u32,
    channels: u32,
    rail: u32,
    truss: u32,
    stairs: u32,
    stair_wall: u32,
    ladder: u32,
    lamp: u32,
}

impl Ways {
    pub fn new(stock: &mut Stock) -> Ways {
        let (panel, half) = (PANEL as f32, PANEL as f32 * 0.5);
        let mut railing = Solid::default();
        rail(&mut railing, Vec3::X * -half, Vec3::X * half);
        Ways {
            panel: stock.shape(grating(Vec2::new(panel, AISLE as f32), 0.07)),
            channels: stock.shape(channels()),
            rail: stock.shape(railing),
            truss: stock.shape(truss()),
            stairs: stock.shape(flights()),
            stair_wall: stock.shape(stair_wall()),
            ladder: stock.shape(caged_ladder()),
            lamp: stock.shape(lamp()),
        }
    }
}

/// The channels under both edges of a panel along x, and two cross pieces.
fn channels() -> Solid {
    let mut solid = Solid::default();
    let half = PANEL as f32 * 0.5;
    for side in [-1.0, 1.0] {
        let z = side * (AISLE as f32 * 0.5 + 0.01);
        for (y, size) in [(-0.06, 0.09), (-0.24, 0.09)] {
            solid.block(0.0, y - 0.01, z - side * 0.03, Vec3::new(half * 2.0, 0.015, size));
        }
        solid.block(0.0, -0.24, z, Vec3::new(half * 2.0, 0.2, 0.012));
    }
    for x in [-half * 0.5, half * 0.5] {
        solid.block(x, -0.2, 0.0, Vec3::new(0.05, 0.14, AISLE as f32));
    }
    solid
}

/// What carries 4 m of a bridge along x: two parallel trusses under its edges, with cross pieces.
fn truss() -> Solid {
    let mut solid = Solid::default();
    let half = 2.0;
    for side in [-1.0f32, 1.0] {
        let z = side * (AISLE as f32 * 0.5);
        for y in [-0.3, -1.8] {
            beam(&mut solid, Vec3::new(-half, y, z), Vec3::new(half, y, z), Vec2::new(0.12, 0.16));
        }
        for (x0, x1) in [(-half, -1.0), (0.0, -1.0), (0.0, 1.0), (half, 1.0)] {
            beam(&mut solid, Vec3::new(x0, -0.3, z), Vec3::new(x1, -1.8, z), Vec2::new(0.07, 0.07));
        }
    }
    for x in [-1.0, 1.0] {
        let z = AISLE as f32 * 0.5;
        beam(&mut solid, Vec3::new(x, -1.8, -z), Vec3::new(x, -1.8, z), Vec2::new(0.08, 0.08));
    }
    solid
}

/// Two flights of a storey with a landing between them, around the middle of their well.
fn flights() -> Solid {
    let mut solid = Solid::default();
    let half = STOREY as f32 * 0.5;
    stairs(&mut solid, Vec3::new(0.85, 0.0, -0.65), Vec3::new(-0.75, half, -0.65), 1.0);
    stairs(&mut solid, Vec3::new(-0.75, half, 0.65), Vec3::new(0.85, half * 2.0, 0.65), 1.0);
    solid.cuboid(Vec3::new(-1.4, half - 0.06, -1.2), Vec3::new(-0.75, half, 1.2));
    solid.cuboid(Vec3::new(0.85, -0.06, -1.2), Vec3::new(1.4, 0.0, 1.2));
    solid
}

/// Three walls around the stairs of a storey, open to positive x.
fn stair_wall() -> Solid {
    let mut solid = Solid::default();
    let top = STOREY as f32;
    for z in [-1.45, 1.3] {
        solid.cuboid(Vec3::new(-1.45, 0.0, z), Vec3::new(1.4, top, z + 0.15));
    }
    solid.cuboid(Vec3::new(-1.45, 0.0, -1.3), Vec3::new(-1.3, top, 1.3));
    for (y, size) in [(0.0, 2.3), (4.6, 0.4)] {
        solid.block(-1.46, y, 0.0, Vec3::new(0.1, size, 1.1));
    }
    solid
}

/// A ladder of a storey that faces positive x, with hoops around whoever climbs it.
fn caged_ladder() -> Solid {
    let mut solid = Solid::default();
    ladder(&mut solid, Vec3::ZERO, STOREY as f32 + 1.0, Vec3::X);
    for k in 0..6 {
        let y = 2.2 + 0.6 * k as f32;
        let hoop = [(0.0, -0.35), (0.4, -0.38), (0.72, -0.2), (0.72, 0.2), (0.4, 0.38), (0.0, 0.35)];
        for w in hoop.windows(2) {
            let at = |(x, z): (f32, f32)| Vec3::new(x, y, z);
            beam(&mut solid, at(w[0]), at(w[1]), Vec2::new(0.008, 0.05));
        }
    }
    solid
}

/// A lamp that hangs from 1.2 m above, with its reflector.
fn lamp() -> Solid {
    let mut solid = Solid::default();
    solid.column(6, Vec2::ZERO, (0.3, 0.015), (1.2, 0.015));
    solid.lathe(12, &[(0.2, 0.0), (0.19, 0.06), (0.1, 0.2), (0.06, 0.32)]);
    solid
}

/// All walkways of a unit.
pub(super) fn walkways(site: &mut Site) {
    let plan = site.plan;
    for floor in 1..plan.floors {
        for aisle in &plan.aisles {
            lay(site, aisle, floor, false);
        }
        for (k, end) in exits(plan).into_iter().enumerate() {
            // Beyond the walls only the walk's floor goes on.
            if floor != plan.walk_floor || k == 1 {
                close(site, end, floor);
            }
        }
        steps(site, floor - 1);
    }
    steps(site, plan.floors - 1);
    for bridge in bridges(plan) {
        lay(site, &bridge, plan.walk_floor, true);
    }
    lamps(site);
}

/// Where aisles reach the outer walls: at the first bridge, opposite to it, and at the second.
fn exits(plan: &Plan) -> [DVec2; 3] {
    let [front, rear] = bridges(plan);
    let other = DVec2::new(front.to.x, -front.to.y);
    [front.to, other, rear.from]
}

/// The bridges that the walk comes and goes by: to the side of the house, and behind it.
pub(super) fn bridges(plan: &Plan) -> [Aisle; 2] {
    let (front, rear) = (plan.aisles[0], plan.aisles[4]);
    // Far enough to see the house whole: all of it in a small plant, most in a large one.
    let length = (plan.top() * 0.7 + 14.0).min(40.0);
    let along_z = Aisle { from: front.from - DVec2::Y * length, to: front.from, along_x: false };
    let along_x = Aisle { from: rear.to, to: rear.to + DVec2::X * 14.0, along_x: true };
    [along_z, along_x]
}

/// A rail across the end of an aisle.
fn close(site: &mut Site, end: DVec2, floor: usize) {
    let along_x = site.plan.line_z(0).abs() - end.y.abs() < 0.01;
    let at = DVec3::new(end.x, site.plan.level(floor), end.y);
    let turn = stretched(along(along_x), AISLE / PANEL);
    let rail = site.shapes.ways.rail;
    site.put(Rank::Must, "rail", rail, at, turn, RAIL);
}

/// The panels of an aisle on a floor, and rails where the floor beside it is open.
fn lay(site: &mut Site, aisle: &Aisle, floor: usize, bridge: bool) {
    let plan = site.plan;
    let y = plan.level(floor);
    let (count, length) = parts((aisle.to - aisle.from).length(), PANEL);
    let (ahead, aside) = if aisle.along_x { (DVec2::X, DVec2::Y) } else { (DVec2::Y, DVec2::X) };
    let turn = stretched(along(aisle.along_x), length / PANEL);
    for k in 0..count {
        let middle = aisle.from + ahead * ((k as f64 + 0.5) * length);
        let at = DVec3::new(middle.x, y, middle.y);
        let half = (ahead * length * 0.5 + aside * AISLE * 0.5).extend(0.0);
        let reach = DVec3::new(half.x, 0.2, half.y);
        if plan.meets_solid(&Room { min: at - reach, max: at + reach + DVec3::Y * 2.0 }) {
            continue;
        }
        let ways = &site.shapes.ways;
        let (panel, channels, rail, truss) = (ways.panel, ways.channels, ways.rail, ways.truss);
        // A panel that is partly over a plate is laid whole.
        let ends = [-0.49, 0.49].map(|share| middle + ahead * (share * length));
        if ends.iter().any(|&end| deck_at(plan, end, floor) != Deck::Plate) {
            let color = site.worn(GRATING);
            site.put(Rank::Must, "grating", panel, at + DVec3::Y * PROUD, turn, color);
            site.put(Rank::Fill, "channels", channels, at, turn, STEEL);
        }
        if bridge && k % 2 == 0 {
            let at = at + DVec3::new(ahead.x, 0.0, ahead.y) * length * 0.5;
            site.put(Rank::Must, "truss", truss, at, along(aisle.along_x), STEEL);
        }
        for side in [-1.0, 1.0] {
            let beyond = middle + aside * side * (AISLE * 0.5 + 0.3);
            let open = deck_at(plan, beyond, floor) == Deck::Open && !on_aisle(plan, beyond);
            if open || bridge {
                let at = at + DVec3::new(aside.x, 0.0, aside.y) * side * (AISLE * 0.5 - 0.02);
                site.put(Rank::Must, "rail", rail, at, turn, RAIL);
            }
        }
    }
}

/// The deck at a point of a floor: open outside the house.
fn deck_at(plan: &Plan, at: DVec2, floor: usize) -> Deck {
    let bay = |v: f64, count: usize| {
        let k = (v / BAY + count as f64 * 0.5).floor();
        (0.0..count as f64).contains(&k).then_some(k as usize)
    };
    match (bay(at.x, plan.bays_x), bay(at.y, plan.bays_z)) {
        (Some(i), Some(j)) => plan.deck(i, j, floor),
        _ => Deck::Open,
    }
}

fn on_aisle(plan: &Plan, at: DVec2) -> bool {
    plan.aisles.iter().any(|aisle| {
        let (min, max) = aisle.ground();
        at.cmpge(min).all() && at.cmple(max).all()
    })
}

/// Stairs and their walls in the stair bays, and a ladder in some shafts.
fn steps(site: &mut Site, floor: usize) {
    let plan = site.plan;
    for j in 0..plan.bays_z {
        for i in 0..plan.bays_x {
            let corner = DVec3::new(plan.line_x(i), plan.level(floor), plan.line_z(j));
            let ways = &site.shapes.ways;
            let (stairs, wall, ladder) = (ways.stairs, ways.stair_wall, ways.ladder);
            match plan.use_of(i, j) {
                Use::Stairs => {
                    let at = corner + DVec3::new(3.95, 0.0, 4.0);
                    let turn = if i == 0 { QUARTER } else { Mat3::IDENTITY };
                    site.put(Rank::Must, "stairs", stairs, at, turn, GRATING);
                    site.put(Rank::Must, "stair_wall", wall, at, turn, CONCRETE);
                }
                Use::Shaft if site.random.chance(0.3) => {
                    let at = corner + DVec3::new(0.35, 0.0, 4.0);
                    let room = Room { min: at - DVec3::Z * 0.5, max: at + DVec3::new(0.8, STOREY, 0.5) };
                    if site.is_free(&room) {
                        site.put(Rank::Fill, "ladder", ladder, at, Mat3::IDENTITY, RAIL);
                    }
                }
                _ => {}
            }
        }
    }
}

/// Lamps over the aisles.
fn lamps(site: &mut Site) {
    let plan = site.plan;
    let lamp = site.shapes.ways.lamp;
    for floor in 1..plan.floors {
        for aisle in &plan.aisles {
            let (count, length) = parts((aisle.to - aisle.from).length(), BAY * 0.5);
            let ahead = (aisle.to - aisle.from).normalize();
            for k in 0..count {
                let at = aisle.from + ahead * ((k as f64 + 0.5) * length);
                let at = DVec3::new(at.x, plan.level(floor) + 2.5, at.y);
                site.put(Rank::Fill, "lamp", lamp, at, Mat3::IDENTITY, [226, 222, 204]);
            }
        }
    }
}
