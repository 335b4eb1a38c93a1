//! Around the boiler house: ground, turbine hall, coal handling with its conveyor and transfer tower, cooling towers.

use glam::{DVec2, DVec3, Mat3, Vec2, Vec3};

use super::super::piping::{beam, rail, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::Rank;
use super::plan::{BAY, Plan};
use super::site::{QUARTER, Site, along, parts};
use super::walkway::bridges;

const GROUND: [u8; 3] = [150, 148, 138];
const GRASS: [u8; 3] = [112, 132, 88];
const HALL: [u8; 3] = [190, 180, 158];
const ROOF: [u8; 3] = [120, 130, 138];
const MACHINE: [u8; 3] = [88, 120, 150];
const COAL: [u8; 3] = [48, 46, 46];
const STEEL: [u8; 3] = [112, 132, 138];
const TOWER: [u8; 3] = [206, 202, 194];
/// The turbine hall's breadth, and its distance from the boiler house.
const HALL_BREADTH: f64 = 34.0;
const GAP: f64 = 5.0;

/// All that stands around a unit.
pub(super) fn yard(site: &mut Site) {
    ground(site);
    hall(site);
    turbine(site);
    coal(site);
    cooling_towers(site);
}

/// The ground of a unit: concrete below its buildings, grass around.
fn ground(site: &mut Site) {
    let plan = site.plan;
    let (x, z) = (plan.line_x(plan.bays_x), plan.line_z(plan.bays_z));
    let near = (DVec2::new(-x - 70.0, -z - 62.0), DVec2::new(x + 130.0, z + 62.0));
    let far = (near.0 - DVec2::new(250.0, 0.0), near.1 + DVec2::new(300.0, 0.0));
    let mut plates = Vec::new();
    for (k, (x0, x1)) in [(far.0.x, near.0.x), (near.0.x, near.1.x), (near.1.x, far.1.x)].into_iter().enumerate() {
        let (count, length) = parts(x1 - x0, 40.0);
        plates.extend((0..count).map(|n| (k, x0 + n as f64 * length, length)));
    }
    for (k, x0, length) in plates {
        let mut solid = Solid::default();
        let depth = near.1.y - near.0.y;
        let (rows, row) = parts(depth, 20.0);
        for n in 0..rows {
            let z = (n as f64 * row) as f32;
            solid.cuboid(Vec3::new(0.0, -0.5, z), Vec3::new(length as f32, -0.1, z + row as f32));
        }
        let color = if k == 1 { GROUND } else { GRASS };
        site.build(Rank::Must, "ground", solid, DVec3::new(x0, 0.0, near.0.y), color);
    }
}

/// Where the hall stands: its low and high corner.
fn hall_room(plan: &Plan) -> (DVec3, DVec3) {
    let front = plan.line_x(0) - GAP;
    let z = plan.line_z(plan.bays_z);
    let height = (plan.top() * 0.35).max(11.0);
    (DVec3::new(front - HALL_BREADTH, 0.0, -z), DVec3::new(front, height, z))
}

/// The hall's walls of sheet with bands of windows, and its roof with vents.
fn hall(site: &mut Site) {
    let (min, max) = hall_room(site.plan);
    let panel = wall_panel(max.y as f32);
    let mesh = site.stock.shape(panel);
    let (count, _) = parts(max.z - min.z, BAY);
    for k in 0..count {
        let z = min.z + k as f64 * BAY;
        site.put(Rank::Must, "hall_wall", mesh, DVec3::new(min.x, 0.0, z), along(false), HALL);
        site.put(Rank::Must, "hall_wall", mesh, DVec3::new(max.x, 0.0, z + BAY), QUARTER, HALL);
        let mut roof = Solid::default();
        let breadth = HALL_BREADTH as f32;
        roof.gable(Vec3::new(-0.4, 0.0, 0.0), Vec3::new(breadth + 0.4, 2.2, BAY as f32));
        for n in 0..12 {
            let x = breadth * (n as f32 + 0.5) / 12.0;
            roof.block(x, 0.0, BAY as f32 * 0.5, Vec3::new(0.12, 0.9, BAY as f32));
        }
        roof.column(12, Vec2::new(breadth * 0.5, BAY as f32 * 0.5), (1.0, 0.9), (3.4, 0.9));
        site.build(Rank::Must, "hall_roof", roof, DVec3::new(min.x, max.y, z), ROOF);
    }
    let mut end = Solid::default();
    end.cuboid(Vec3::ZERO, Vec3::new(HALL_BREADTH as f32, max.y as f32, 0.3));
    for k in 0..40 {
        let x = HALL_BREADTH as f32 * (k as f32 + 0.3) / 40.0;
        end.cuboid(Vec3::new(x, 0.3, -0.08), Vec3::new(x + 0.4, max.y as f32 - 0.2, 0.38));
    }
    let mesh = site.stock.shape(end);
    for z in [min.z, max.z - 0.3] {
        site.put(Rank::Must, "hall_wall", mesh, DVec3::new(min.x, 0.0, z), Mat3::IDENTITY, HALL);
    }
}

/// A bay of the hall's wall along x, its outside towards positive z.
fn wall_panel(height: f32) -> Solid {
    let mut solid = Solid::default();
    let end = BAY as f32;
    solid.cuboid(Vec3::new(0.0, 0.0, -0.2), Vec3::new(end, height, 0.0));
    for k in 0..16 {
        let x = (k as f32 + 0.25) * end / 16.0;
        solid.cuboid(Vec3::new(x, 1.2, 0.0), Vec3::new(x + end / 32.0, height - 0.4, 0.06));
    }
    for y in [height * 0.45, height * 0.75] {
        for k in 0..4 {
            let x = (k as f32 + 0.12) * end / 4.0;
            solid.cuboid(Vec3::new(x, y, 0.0), Vec3::new(x + end * 0.19, y + height * 0.12, 0.09));
        }
    }
    solid
}

/// The turbine set in the hall, on its table, under a crane.
fn turbine(site: &mut Site) {
    let (min, max) = hall_room(site.plan);
    let middle = (min + max) * 0.5;
    let long = (max.z - min.z) * 0.8;
    let deck = (max.y * 0.4).min(9.0) as f32;
    let mut table = Solid::default();
    let half = long as f32 * 0.5;
    table.cuboid(Vec3::new(-7.0, deck - 1.0, -half), Vec3::new(7.0, deck, half));
    for k in 0..8 {
        let z = half * ((k as f32 + 0.5) / 4.0 - 1.0);
        for x in [-5.5, 5.5] {
            table.block(x, 0.0, z, Vec3::new(1.4, deck - 1.0, 1.4));
        }
    }
    site.build(Rank::Must, "turbine_table", table, DVec3::new(middle.x, 0.0, middle.z), HALL);
    let sections = [(0.16, 1.6), (0.18, 2.1), (0.24, 3.1), (0.24, 3.1), (0.18, 2.0)];
    let mut at = -half * 0.95;
    for (share, radius) in sections {
        let length = share * long as f32 * 0.95;
        let mut body = Solid::default();
        vessel(&mut body, 32, radius, length - 0.6);
        for k in 0..(length / 1.2) as usize {
            let y = 0.8 + 1.2 * k as f32;
            body.column(32, Vec2::ZERO, (y, radius * 1.04), (y + 0.2, radius * 1.04));
        }
        let mut section = Solid::default();
        section.join(&body, upright_to(Vec3::Z), Vec3::Y * (radius * 0.4));
        section.block(0.0, 0.0, length * 0.5, Vec3::new(radius * 1.8, radius * 0.5, length * 0.8));
        let place = DVec3::new(middle.x, f64::from(deck), middle.z + f64::from(at));
        site.build(Rank::Must, "turbine", section, place, MACHINE);
        at += length;
    }
    let mut crane = Solid::default();
    let half = HALL_BREADTH as f32 * 0.5 - 0.8;
    for z in [-1.5, 1.5] {
        beam(&mut crane, Vec3::new(-half, 0.0, z), Vec3::new(half, 0.0, z), Vec2::new(0.5, 1.4));
    }
    crane.block(3.0, 0.7, 0.0, Vec3::new(3.0, 1.0, 3.6));
    rail(&mut crane, Vec3::new(-half, 0.7, 1.8), Vec3::new(half, 0.7, 1.8));
    site.build(Rank::Must, "crane", crane, DVec3::new(middle.x, max.y - 2.5, middle.z + long * 0.2), [206, 170, 60]);
}

/// The transfer tower at the bridge's end, the conveyor up to the bunkers and down to the yard, and the pile.
fn coal(site: &mut Site) {
    let plan = site.plan;
    let [bridge, _] = bridges(plan);
    let deck = plan.level(plan.walk_floor);
    let at = DVec3::new(bridge.from.x, 0.0, bridge.from.y - 5.5);
    let top = plan.level(plan.floors.max(plan.walk_floor + 2) - 1) as f32 + 3.0;
    let mut tower = Solid::default();
    tower.cuboid(Vec3::new(-9.0, deck as f32 + 4.0, -4.5), Vec3::new(4.0, top, 4.5));
    for k in 0..24 {
        let x = -9.0 + 13.0 * (k as f32 + 0.3) / 24.0;
        tower.cuboid(Vec3::new(x, deck as f32 + 4.0, -4.6), Vec3::new(x + 0.25, top - 0.3, 4.6));
    }
    tower.cuboid(Vec3::new(-9.0, deck as f32 - 0.4, -4.5), Vec3::new(4.0, deck as f32 - 0.06, 4.5));
    for (x, z) in [(-8.7, -4.2), (3.7, -4.2), (-8.7, 4.2), (3.7, 4.2)] {
        tower.block(x, 0.0, z, Vec3::new(0.5, deck as f32 + 4.0, 0.5));
    }
    for floor in 1..plan.walk_floor {
        let y = plan.level(floor) as f32;
        for z in [-4.2, 4.2] {
            beam(&mut tower, Vec3::new(-8.7, y, z), Vec3::new(3.7, y, z), Vec2::new(0.3, 0.4));
            beam(&mut tower, Vec3::new(-8.7, y, z), Vec3::new(3.7, y + 5.0, z), Vec2::new(0.15, 0.15));
        }
    }
    site.build(Rank::Must, "transfer_tower", tower, at, HALL);
    // Both galleries leave the tower where the bridge does not.
    let bunkers = DVec3::new(plan.line_x(0) + BAY * 0.5, f64::from(top) - 2.0, plan.line_z(0));
    let landing = DVec3::new(bunkers.x.min(at.x - 8.0), f64::from(top) - 3.0, at.z + 4.0);
    gallery(site, landing, DVec3::new(landing.x, bunkers.y, bunkers.z));
    let away = DVec3::new(at.x - 12.0 - plan.top() * 1.7, 2.0, at.z - 8.0);
    gallery(site, away, DVec3::new(at.x - 8.0, f64::from(top) - 4.0, at.z));
    let mut pile = Solid::default();
    let reach = (plan.top() * 0.35) as f32;
    pile.lathe(40, &[(reach, 0.0), (reach * 0.5, reach * 0.42), (0.0, reach * 0.62)]);
    site.build(Rank::Must, "coal", pile, DVec3::new(away.x - 8.0, -0.1, away.z - f64::from(reach) * 0.2), COAL);
}

/// A covered conveyor from a low end to a high end, in pieces, with trestles below.
fn gallery(site: &mut Site, from: DVec3, to: DVec3) {
    let (count, _) = parts((to - from).length(), 10.0);
    for k in 0..count {
        let at = |n: usize| from.lerp(to, n as f64 / count as f64);
        let middle = at(k);
        let (low, high) = (Vec3::ZERO, (at(k + 1) - middle).as_vec3());
        let mut piece = Solid::default();
        beam(&mut piece, low + Vec3::Y * 1.6, high + Vec3::Y * 1.6, Vec2::new(3.0, 2.6));
        for n in 0..8 {
            let rib = low.lerp(high, (n as f32 + 0.5) / 8.0) + Vec3::Y * 1.6;
            let ahead = (high - low) * 0.006;
            beam(&mut piece, rib - ahead, rib + ahead, Vec2::new(3.2, 2.8));
        }
        let leg = middle.y as f32 + 0.2;
        if leg > 3.0 {
            for z in [-1.2, 1.2] {
                piece.block(z, -leg, z, Vec3::new(0.35, leg, 0.35));
                piece.block(-z, -leg, z, Vec3::new(0.35, leg, 0.35));
            }
            piece.block(0.0, -leg * 0.5, 0.0, Vec3::new(2.4, 0.3, 2.4));
        }
        site.build(Rank::Must, "conveyor", piece, middle, STEEL);
    }
}

/// Two cooling towers far behind the stack: hyperboloids of thin shells on raking legs.
fn cooling_towers(site: &mut Site) {
    let plan = site.plan;
    let height = plan.top() * 1.35;
    let x = plan.line_x(plan.bays_x) + 120.0 + height * 1.2;
    for z in [-height * 0.75, height * 0.65] {
        let radius = |share: f64| height * 0.29 * libm::sqrt(1.0 + 1.55 * (share - 0.74) * (share - 0.74) * 4.0);
        let profile: Vec<(f32, f32)> = (0..=12)
            .map(|k| 0.08 + 0.92 * f64::from(k) / 12.0)
            .map(|share| (radius(share) as f32, (share * height) as f32))
            .collect();
        site.build(Rank::Must, "cooling_tower", shell(&profile), DVec3::new(x, 0.0, z), TOWER);
        let mut legs = Solid::default();
        let foot = (height * 0.08) as f32;
        let (low, high) = ((radius(0.0) * 1.02) as f32, radius(0.08) as f32);
        for (a, b) in super::super::solid::circle(36, Vec2::ZERO, 1.0).into_iter().zip(0..) {
            let turn = if b % 2 == 0 { Vec2::new(-a.y, a.x) } else { Vec2::new(a.y, -a.x) } * 0.08;
            let (from, to) = (a * low, (a + turn) * high);
            beam(&mut legs, Vec3::new(from.x, 0.0, from.y), Vec3::new(to.x, foot + 0.3, to.y), Vec2::splat(0.8));
        }
        site.build(Rank::Must, "cooling_tower", legs, DVec3::new(x, 0.0, z), TOWER);
    }
}

/// A shell half a metre thick around y, open above and below, whose outside has these (radius, height).
fn shell(profile: &[(f32, f32)]) -> Solid {
    let inside = profile.iter().map(|&(radius, y)| (radius - 0.5, y));
    let around: Vec<(f32, f32)> = inside.chain(profile.iter().rev().copied()).collect();
    let rings: Vec<Vec<Vec3>> = super::super::solid::circle(48, Vec2::ZERO, 1.0)
        .into_iter()
        .map(|p| around.iter().map(|&(radius, y)| Vec3::new(p.x * radius, y, p.y * radius)).collect())
        .collect();
    let mut solid = Solid::default();
    solid.hoop(&rings);
    solid
}
