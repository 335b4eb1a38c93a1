//! The boiler, which hangs in its shaft: lagged walls with buckstays, hopper, burners, blowers and drum; inside, out of sight,
//! the walls' tubes and banks of superheater and economizer. Coal comes from bunkers before it.

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::super::piping::{bolts, flange, pipe, rod, vessel};
use super::super::solid::{Solid, upright_to};
use super::super::stock::{Rank, Stock};
use super::plan::{BAY, Room, STOREY, Use};
use super::site::{HALF, QUARTER, Site, THREE_QUARTERS, parts, stretched};

/// Metres between the column lines around the boiler and its walls.
const CLEAR: f64 = 1.3;
const LAGGING: [u8; 3] = [184, 186, 182];
const BUCKSTAY: [u8; 3] = [116, 122, 124];
const TUBE: [u8; 3] = [126, 94, 78];
const BURNER: [u8; 3] = [120, 108, 96];
const DRUM: [u8; 3] = [200, 202, 204];
const BUNKER: [u8; 3] = [138, 128, 112];
/// Storeys of the boiler's hopper, below its walls.
const HOPPER: usize = 2;

/// Shapes of the boiler.
pub(super) struct Boiler {
    wall: u32,
    buckstays: u32,
    tubes: u32,
    platen: u32,
    coil: u32,
    burner: u32,
    blower: u32,
    downcomer: u32,
    hangers: u32,
    bunker: u32,
}

impl Boiler {
    pub fn new(stock: &mut Stock) -> Boiler {
        Boiler {
            wall: stock.shape(wall()),
            buckstays: stock.shape(buckstays()),
            tubes: stock.shape(tubes()),
            platen: stock.shape(platen()),
            coil: stock.shape(coil()),
            burner: stock.shape(burner()),
            blower: stock.shape(blower()),
            downcomer: stock.shape(downcomer()),
            hangers: stock.shape(hangers()),
            bunker: stock.shape(bunker()),
        }
    }
}

/// A storey of lagged wall, a bay along x, its face at z = 0 towards positive z.
fn wall() -> Solid {
    let mut solid = Solid::default();
    let (end, top) = (BAY as f32, STOREY as f32);
    solid.cuboid(Vec3::new(0.0, 0.0, -0.25), Vec3::new(end, top, 0.0));
    for k in 0..20 {
        let x = (k as f32 + 0.3) * end / 20.0;
        solid.cuboid(Vec3::new(x, 0.0, 0.0), Vec3::new(x + end / 50.0, top, 0.04));
    }
    solid
}

/// Beams across a storey of wall, with the plates that hold them.
fn buckstays() -> Solid {
    let mut solid = Solid::default();
    let end = BAY as f32;
    for y in [1.0f32, 3.5] {
        solid.cuboid(Vec3::new(0.0, y, 0.05), Vec3::new(end, y + 0.35, 0.08));
        solid.cuboid(Vec3::new(0.0, y + 0.16, 0.08), Vec3::new(end, y + 0.19, 0.38));
        solid.cuboid(Vec3::new(0.0, y, 0.38), Vec3::new(end, y + 0.35, 0.41));
        for k in 0..5 {
            let x = (k as f32 + 0.5) * end / 5.0;
            solid.cuboid(Vec3::new(x - 0.01, y, 0.08), Vec3::new(x + 0.01, y + 0.35, 0.38));
        }
    }
    solid
}

/// A storey of the wall's tubes from inside.
fn tubes() -> Solid {
    let mut solid = Solid::default();
    for k in 0..64 {
        let x = (k as f32 + 0.5) * BAY as f32 / 64.0;
        rod(&mut solid, 6, 0.035, Vec3::new(x, 0.0, -0.32), Vec3::new(x, STOREY as f32, -0.32));
    }
    solid
}

/// A platen of the superheater: tubes down and up again, in the plane of x.
fn platen() -> Solid {
    let mut solid = Solid::default();
    for k in 0..14 {
        let (reach, low) = (0.12 + 0.16 * k as f32, 0.1 + 0.16 * (13 - k) as f32);
        let points = [
            Vec3::new(-reach, STOREY as f32 - 0.1, 0.0),
            Vec3::new(-reach, low, 0.0),
            Vec3::new(reach, low, 0.0),
            Vec3::new(reach, STOREY as f32 - 0.1, 0.0),
        ];
        pipe(&mut solid, 6, 0.03, &points, (0.1, 2));
    }
    solid
}

/// A coil of the economizer: tubes to and fro along x, over a storey.
fn coil() -> Solid {
    let mut solid = Solid::default();
    for k in 0..4 {
        let z = 0.14 * k as f32 - 0.2;
        let points: Vec<Vec3> = (0..20)
            .map(|n| {
                let x = if (n / 2 + n) % 2 == 0 { -3.0 } else { 3.0 };
                Vec3::new(x, 0.4 + 0.44 * (n / 2) as f32 - 0.06 * k as f32, z)
            })
            .collect();
        pipe(&mut solid, 6, 0.03, &points, (0.12, 2));
    }
    solid
}

/// A burner in a wall whose face is at z = 0, along positive z, with coal pipe, air, igniter and a frame.
fn burner() -> Solid {
    let mut solid = Solid::default();
    let ahead = upright_to(Vec3::Z);
    let mut body = Solid::default();
    body.lathe(20, &[(0.85, 0.0), (0.85, 0.35), (0.6, 0.4), (0.6, 0.75), (0.35, 0.9)]);
    bolts(&mut body, 18, 0.73, 0.025, (0.3, 0.44));
    solid.join(&body, ahead, Vec3::ZERO);
    pipe(&mut solid, 14, 0.26, &[Vec3::Z * 0.7, Vec3::Z * 1.25, Vec3::new(0.0, -1.6, 1.25)], (0.4, 6));
    solid.join(&flange(16, 0.26, 12), Mat3::IDENTITY, Vec3::new(0.0, -1.2, 1.25));
    for k in 0..3 {
        let x = -0.35 + 0.35 * k as f32;
        pipe(&mut solid, 8, 0.03, &[Vec3::new(x, 0.3, 0.4), Vec3::new(x, 0.3, 1.0), Vec3::new(x, 1.6, 1.0)], (0.1, 3));
    }
    for x in [-1.05f32, 1.05] {
        solid.block(x, -1.2, 0.25, Vec3::new(0.12, 2.4, 0.5));
    }
    solid.block(0.0, 1.2, 0.25, Vec3::new(2.2, 0.15, 0.5));
    solid
}

/// A soot blower through a wall whose face is at z = 0, with its lance, box and motor.
fn blower() -> Solid {
    let mut solid = Solid::default();
    let ahead = upright_to(Vec3::Z);
    solid.join(&flange(14, 0.12, 8), ahead, Vec3::Z * 0.1);
    rod(&mut solid, 10, 0.06, Vec3::ZERO, Vec3::Z * 1.2);
    for x in [-0.16, 0.16] {
        solid.block(x, -0.2, 0.65, Vec3::new(0.03, 0.5, 1.2));
    }
    solid.block(0.0, 0.3, 0.65, Vec3::new(0.34, 0.03, 1.2));
    let mut motor = Solid::default();
    motor.lathe(12, &[(0.06, 0.0), (0.13, 0.03), (0.13, 0.35), (0.1, 0.4)]);
    solid.join(&motor, Mat3::IDENTITY, Vec3::new(0.0, 0.33, 0.9));
    let points = [Vec3::new(0.0, -0.1, 0.9), Vec3::new(0.0, -0.8, 0.9), Vec3::new(0.9, -0.8, 0.9)];
    pipe(&mut solid, 8, 0.04, &points, (0.12, 4));
    solid
}

/// A storey of a large pipe beside the boiler.
fn downcomer() -> Solid {
    let mut solid = Solid::default();
    let top = STOREY as f32;
    rod(&mut solid, 20, 0.34, Vec3::ZERO, Vec3::Y * top);
    for k in 0..4 {
        let y = 0.4 + 1.25 * k as f32;
        solid.column(20, Vec2::ZERO, (y, 0.355), (y + 0.05, 0.355));
    }
    solid.block(0.0, 2.4, 0.0, Vec3::new(0.9, 0.12, 0.2));
    solid
}

/// Rods that the boiler hangs by: a bay of them along x.
fn hangers() -> Solid {
    let mut solid = Solid::default();
    for k in 0..8 {
        let x = k as f32 + 0.5;
        rod(&mut solid, 6, 0.04, Vec3::X * x, Vec3::new(x, 2.4, 0.0));
        solid.block(x, 0.0, 0.0, Vec3::new(0.2, 0.2, 0.2));
    }
    solid
}

/// A coal bunker of one metre's height around its axis, to be stretched, with a cone below; stands on its outlet.
fn bunker() -> Solid {
    let mut solid = Solid::default();
    solid.lathe(28, &[(0.5, 0.0), (3.2, 4.2), (3.2, 10.0)]);
    for y in [4.3, 6.1, 7.9, 9.7] {
        solid.column(28, Vec2::ZERO, (y, 3.3), (y + 0.25, 3.3));
    }
    solid
}

/// The boiler of a unit with everything in and around it.
pub(super) fn boiler(site: &mut Site) {
    let shaft = site.plan.shaft();
    let casing =
        Room { min: shaft.min + DVec3::new(CLEAR, 0.0, CLEAR), max: shaft.max - DVec3::new(CLEAR, 0.0, CLEAR) };
    let top = site.plan.floors - 1;
    let first = HOPPER.min(top - 1);
    for floor in first..top {
        for (turn, from, length) in sides(&casing) {
            side(site, floor, turn, from, length);
        }
        inside(site, floor, &casing);
    }
    ends(site, &casing, first, top);
    around(site, &casing, first, top);
    bunkers(site);
}

/// The four sides of the casing: the turn of what faces positive z, where it begins, and its length.
fn sides(casing: &Room) -> [(Mat3, DVec3, f64); 4] {
    let (min, max, size) = (casing.min, casing.max, casing.max - casing.min);
    [
        (Mat3::IDENTITY, DVec3::new(min.x, 0.0, max.z), size.x),
        (HALF, DVec3::new(max.x, 0.0, min.z), size.x),
        (QUARTER, DVec3::new(max.x, 0.0, max.z), size.z),
        (THREE_QUARTERS, DVec3::new(min.x, 0.0, min.z), size.z),
    ]
}

/// A storey of one side of the casing.
fn side(site: &mut Site, floor: usize, turn: Mat3, from: DVec3, length: f64) {
    let plan = site.plan;
    let (count, width) = parts(length, BAY);
    let ahead = turn.x_axis.as_dvec3();
    let out = turn.z_axis.as_dvec3();
    let shape = stretched(turn, width / BAY);
    let is_front = turn == THREE_QUARTERS;
    for k in 0..count {
        let at = from + ahead * (k as f64 * width) + DVec3::Y * plan.level(floor);
        let boiler = &site.shapes.boiler;
        let (wall, buckstays, tubes) = (boiler.wall, boiler.buckstays, boiler.tubes);
        let (burner, blower) = (boiler.burner, boiler.blower);
        site.put(Rank::Must, "casing", wall, at, shape, LAGGING);
        site.put(Rank::Fill, "buckstays", buckstays, at, shape, BUCKSTAY);
        site.put(Rank::Fill, "tubes", tubes, at, shape, TUBE);
        let middle = at + ahead * (width * 0.5) + DVec3::Y * 2.2;
        let reach = (ahead * 1.2).abs() + DVec3::Y * 0.5;
        let low = Room { min: middle - reach, max: middle + reach };
        if plan.meets_solid(&low) {
            continue;
        }
        if is_front && floor < plan.floors * 3 / 5 {
            site.put(Rank::Must, "burner", burner, middle + out * 0.04, turn, BURNER);
        } else {
            for shift in [-0.3, 0.25] {
                if site.random.chance(0.7) {
                    let at = middle + ahead * (width * shift) + out * 0.04;
                    site.put(Rank::Fill, "blower", blower, at, turn, LAGGING);
                }
            }
        }
    }
}

/// A storey of the banks inside: superheater in the upper third, economizer behind it at the rear.
fn inside(site: &mut Site, floor: usize, casing: &Room) {
    let plan = site.plan;
    let y = plan.level(floor);
    let size = casing.max - casing.min;
    let (platen, coil) = (site.shapes.boiler.platen, site.shapes.boiler.coil);
    let (rows, apart) = parts(size.z - 1.6, 1.3);
    let upper = floor * 3 >= plan.floors * 2;
    let banks = (size.x * 0.6 / 5.2) as usize;
    for row in 0..rows {
        let z = casing.min.z + 0.8 + (row as f64 + 0.5) * apart;
        site.begin();
        if upper {
            for bank in 0..banks {
                let x = casing.min.x + 3.2 + 5.2 * bank as f64;
                site.put(Rank::Fill, "platen", platen, DVec3::new(x, y, z), Mat3::IDENTITY, TUBE);
            }
        }
        if size.x > 12.0 && !floor.is_multiple_of(3) {
            site.put(Rank::Fill, "coil", coil, DVec3::new(casing.max.x - 3.9, y, z), Mat3::IDENTITY, TUBE);
        }
        site.end();
    }
}

/// The hopper below the walls, the penthouse above them, and the drum.
fn ends(site: &mut Site, casing: &Room, first: usize, top: usize) {
    let plan = site.plan;
    let half = ((casing.max - casing.min) * 0.5).as_vec3();
    let middle = (casing.min + casing.max) * 0.5;
    let outline = |x: f32, z: f32| [Vec2::new(-x, -z), Vec2::new(-x, z), Vec2::new(x, z), Vec2::new(x, -z)];
    let mut hopper = Solid::default();
    let (low, high) = (1.6, plan.level(first) as f32);
    hopper.loft(&outline(0.8, half.z), low, &outline(half.x, half.z), high);
    for k in 1..8 {
        let share = k as f32 / 8.0;
        let (x, y) = (0.8 + (half.x - 0.8) * share, low + (high - low) * share);
        for side in [-1.0, 1.0] {
            hopper.block(side * x, y - 0.15, 0.0, Vec3::new(0.35, 0.3, half.z * 2.0 + 0.1));
        }
    }
    hopper.block(0.0, 0.0, 0.0, Vec3::new(3.0, low, half.z * 2.0));
    site.build(Rank::Must, "hopper", hopper, DVec3::new(middle.x, 0.0, middle.z), LAGGING);
    let mut roof = Solid::default();
    roof.cuboid(Vec3::new(-half.x, 0.0, -half.z), Vec3::new(half.x, 1.4, half.z));
    for k in 0..12 {
        let z = half.z * ((k as f32 + 0.5) / 6.0 - 1.0);
        roof.block(0.0, 1.4, z, Vec3::new(half.x * 2.0, 0.25, 0.2));
    }
    let y = plan.level(top);
    site.build(Rank::Must, "penthouse", roof, DVec3::new(middle.x, y, middle.z), LAGGING);
    let mut drum = Solid::default();
    let length = half.z * 2.0 - 1.0;
    let mut body = Solid::default();
    vessel(&mut body, 28, 0.95, length);
    for k in 0..(length / 2.0) as usize {
        let y = 1.2 + 2.0 * k as f32;
        body.column(28, Vec2::ZERO, (y, 0.99), (y + 0.08, 0.99));
        rod(&mut body, 12, 0.12, Vec3::new(0.9, y, 0.0), Vec3::new(1.6, y, 0.0));
    }
    drum.join(&body, upright_to(Vec3::Z), Vec3::new(0.0, 0.0, -length * 0.5));
    let at = DVec3::new(casing.min.x + 2.5, y + 2.7, middle.z);
    site.build(Rank::Must, "drum", drum, at, DRUM);
    let hangers = site.shapes.boiler.hangers;
    let rows = (half.z / 2.0) as usize;
    for row in 0..rows {
        let z = middle.z + f64::from(half.z) * ((row as f64 + 0.5) * 2.0 / rows as f64 - 1.0);
        for bay in 0..plan.bays_x - plan.rear - plan.front {
            let at = DVec3::new(plan.line_x(plan.front + bay), y + 1.6, z);
            site.put(Rank::Fill, "hangers", hangers, at, Mat3::IDENTITY, BUCKSTAY);
        }
    }
}

/// Downcomers at the corners and along the sides, from the drum to the hopper.
fn around(site: &mut Site, casing: &Room, first: usize, top: usize) {
    let plan = site.plan;
    let downcomer = site.shapes.boiler.downcomer;
    let gap = CLEAR * 0.5 + 0.05;
    for (x, z) in [(0.2, -gap), (0.5, -gap), (0.8, -gap)] {
        for mirrored in [false, true] {
            let at_x = casing.min.x + (casing.max.x - casing.min.x) * x;
            let at_z = if mirrored { casing.max.z - z } else { casing.min.z + z };
            site.begin();
            for floor in first.saturating_sub(1)..=top {
                let at = DVec3::new(at_x, plan.level(floor), at_z);
                site.put(Rank::Fill, "downcomer", downcomer, at, Mat3::IDENTITY, DRUM);
            }
            site.end();
        }
    }
}

/// A row of bunkers over the first bays.
fn bunkers(site: &mut Site) {
    let plan = site.plan;
    let room = plan.bunkers();
    let height = room.max.y - room.min.y;
    if height < STOREY {
        return;
    }
    let bunker = site.shapes.boiler.bunker;
    let turn = Mat3::from_diagonal(Vec3::new(1.0, (height / 10.2) as f32, 1.0));
    for j in (0..plan.bays_z).filter(|&j| plan.use_of(0, j) != Use::Stairs) {
        let at = DVec3::new(plan.line_x(0) + BAY * 0.5, room.min.y, plan.line_z(j) + BAY * 0.5);
        site.put(Rank::Must, "bunker", bunker, at, turn, BUNKER);
    }
}
