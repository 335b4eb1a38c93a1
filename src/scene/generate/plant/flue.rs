//! Behind the boiler house: the flue through air heater, precipitator and fans to the stack.

use glam::{DVec3, Vec2, Vec3};

use super::super::piping::{ladder, rail};
use super::super::solid::Solid;
use super::super::stock::Rank;
use super::plan::{BRIDGE, Plan, Room};
use super::site::Site;

const DUCT: [u8; 3] = [176, 170, 156];
const FILTER: [u8; 3] = [160, 172, 178];
const STEEL: [u8; 3] = [112, 132, 138];
const FAN: [u8; 3] = [104, 130, 118];
const CONCRETE: [u8; 3] = [190, 186, 178];
const WARNING: [u8; 3] = [196, 60, 48];

/// A box with ribs around it across x every metre or so: a duct, a housing.
fn ribbed(min: Vec3, max: Vec3) -> Solid {
    let mut solid = Solid::default();
    solid.cuboid(min, max);
    let ribs = ((max.x - min.x) / 1.1).max(1.0) as usize;
    for k in 0..ribs {
        let x = min.x + (k as f32 + 0.5) * (max.x - min.x) / ribs as f32;
        let (x0, x1, out) = (x - 0.05, x + 0.05, 0.16);
        for (z0, z1) in [(min.z - out, min.z), (max.z, max.z + out)] {
            solid.cuboid(Vec3::new(x0, min.y - out, z0), Vec3::new(x1, max.y + out, z1));
        }
        for (y0, y1) in [(min.y - out, min.y), (max.y, max.y + out)] {
            solid.cuboid(Vec3::new(x0, y0, min.z), Vec3::new(x1, y1, max.z));
        }
    }
    solid
}

/// Places a ribbed box, cut along x into objects of at most `part` metres.
fn duct(site: &mut Site, kind: &str, min: DVec3, max: DVec3, part: f64, color: [u8; 3]) {
    let (count, length) = super::site::parts(max.x - min.x, part);
    for k in 0..count {
        let at = min + DVec3::X * (k as f64 * length);
        let size = DVec3::new(length, max.y - min.y, max.z - min.z).as_vec3();
        site.build(Rank::Must, kind, ribbed(Vec3::ZERO, size), at, color);
    }
}

/// Where things behind the house stand, along x from its rear wall.
struct Row {
    heater: f64,
    filter: (f64, f64),
    fans: f64,
    stack: f64,
    /// Half the breadth of the precipitator.
    half: f64,
}

impl Row {
    fn new(plan: &Plan) -> Row {
        let rear = plan.line_x(plan.bays_x);
        let half = plan.line_z(plan.bays_z) * 0.62;
        let length = half * 1.5;
        let filter = (rear + 18.0, rear + 18.0 + length);
        Row { heater: rear + 4.0, filter, fans: filter.1 + 5.0, stack: filter.1 + 22.0 + half * 0.2, half }
    }
}

/// Everything from the flue to the stack of a unit.
pub(super) fn flue(site: &mut Site) {
    let plan = site.plan;
    let row = Row::new(plan);
    let Room { min, max } = plan.flue();
    duct(site, "flue", min, max, 4.0, DUCT);
    // The air heater: a drum in a tall housing, over which the flue comes and under which it leaves.
    let low = DVec3::new(row.heater, 2.0, min.z - 1.0);
    let most = plan.level(plan.walk_floor) - BRIDGE;
    let high = DVec3::new(row.heater + 8.0, (max.y + 1.5).min(most), max.z + 1.0);
    duct(site, "air_heater", low, high, 4.0, FILTER);
    if high.y + 2.5 < most {
        let mut rotor = Solid::default();
        rotor.lathe(32, &[(3.8, 0.0), (4.3, 0.3), (4.3, 2.2), (3.8, 2.5)]);
        site.build(Rank::Must, "rotor", rotor, DVec3::new(row.heater + 4.0, high.y, 0.0), STEEL);
    }
    let base = (max.y - 3.0).max(min.y);
    duct(
        site,
        "flue",
        DVec3::new(row.heater + 8.0, base, min.z),
        DVec3::new(row.filter.0 - 2.0, max.y, max.z),
        4.0,
        DUCT,
    );
    precipitator(site, &row, base);
    fans(site, &row);
    stack(site, &row);
}

/// Housings in fields, each over its hoppers and on its legs, with rectifiers and rails on the roof.
fn precipitator(site: &mut Site, row: &Row, base: f64) {
    let (x0, x1) = row.filter;
    let legs = (base - 1.0).max(5.0);
    let height = (row.half * 0.8).clamp(5.0, 13.0);
    let fields = (((x1 - x0) / 6.0) as usize).max(1);
    let lanes = ((row.half / 4.0) as usize).max(1);
    let size = Vec3::new(((x1 - x0) / fields as f64) as f32, height as f32, (row.half * 2.0 / lanes as f64) as f32);
    for k in 0..fields * lanes {
        let (i, j) = (k % fields, k / fields);
        let at = DVec3::new(x0 + i as f64 * f64::from(size.x), legs, -row.half + j as f64 * f64::from(size.z));
        site.build(Rank::Must, "precipitator", ribbed(Vec3::ZERO, size - Vec3::new(0.2, 0.0, 0.2)), at, FILTER);
        site.build(Rank::Must, "hopper", hopper(size, legs as f32), at, STEEL);
        site.build(Rank::Fill, "rectifier", rectifier(size), at + DVec3::Y * height, FAN);
    }
    // The hoods at both ends, that spread the gas over the fields and gather it again.
    for (from, to, narrow) in [(x0 - 2.0, x0, 0.5), (x1, x1 + 3.0, 0.4)] {
        let size = DVec3::new(to - from, height * 0.8, row.half * 2.0 * (narrow + 0.4));
        let at = DVec3::new(from, legs + 0.6, -size.z * 0.5);
        site.build(Rank::Must, "hood", ribbed(Vec3::ZERO, size.as_vec3()), at, DUCT);
    }
}

/// A field's hopper below its housing at 0, and four legs down to the ground.
fn hopper(size: Vec3, legs: f32) -> Solid {
    let mut solid = Solid::default();
    let (middle, depth) = (Vec2::new(size.x, size.z) * 0.5, (legs * 0.6).min(4.0));
    let outline = |share: f32| {
        let half = middle * share;
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| middle + half * Vec2::new(x, z))
    };
    solid.loft(&outline(0.12), -depth, &outline(0.96), 0.0);
    solid.column(10, middle, (-depth - 0.8, 0.3), (-depth, 0.3));
    for (x, z) in [(0.2, 0.2), (size.x - 0.2, 0.2), (0.2, size.z - 0.2), (size.x - 0.2, size.z - 0.2)] {
        solid.block(x, -legs, z, Vec3::new(0.35, legs, 0.35));
    }
    solid.block(middle.x, -legs * 0.5, 0.2, Vec3::new(size.x, 0.25, 0.25));
    solid
}

/// Transformers and insulators on a field's roof, with a rail.
fn rectifier(size: Vec3) -> Solid {
    let mut solid = Solid::default();
    let middle = Vec3::new(size.x, 0.0, size.z) * 0.5;
    solid.block(middle.x, 0.0, middle.z, Vec3::new(1.8, 1.5, 1.4));
    for k in 0..6 {
        solid.block(middle.x - 0.75 + 0.3 * k as f32, 0.2, middle.z + 0.8, Vec3::new(0.06, 1.1, 0.3));
    }
    for x in [-0.5, 0.5] {
        let at = Vec2::new(middle.x + x, middle.z);
        for k in 0..3 {
            let y = 1.5 + 0.2 * k as f32;
            solid.column(10, at, (y, 0.14), (y + 0.1, 0.14));
        }
        solid.column(8, at, (1.5, 0.07), (2.4, 0.07));
    }
    rail(&mut solid, Vec3::new(0.1, 0.0, 0.1), Vec3::new(size.x - 0.1, 0.0, 0.1));
    solid
}

/// Two draught fans and the ducts that take the gas to the stack.
fn fans(site: &mut Site, row: &Row) {
    for side in [-1.0, 1.0] {
        let z = side * row.half * 0.45;
        let mut fan = Solid::default();
        let mut scroll = Solid::default();
        scroll.column(32, Vec2::ZERO, (-1.4, 3.0), (1.4, 3.0));
        for y in [-1.5, -0.1, 1.3] {
            scroll.column(32, Vec2::ZERO, (y, 3.15), (y + 0.2, 3.15));
        }
        fan.join(&scroll, super::super::solid::upright_to(Vec3::Z), Vec3::Y * 4.0);
        fan.block(0.0, 0.0, 0.0, Vec3::new(6.0, 1.2, 4.0));
        fan.block(0.0, 1.2, 3.4 * side as f32, Vec3::new(1.8, 2.8, 2.2));
        site.build(Rank::Must, "fan", fan, DVec3::new(row.fans + 4.0, 0.0, z), FAN);
        let low = DVec3::new(row.fans - 2.0, 4.0, z - 1.6);
        duct(site, "flue", low, DVec3::new(row.fans + 2.2, 9.0, z + 1.6), 4.0, DUCT);
        let low = DVec3::new(row.fans + 5.0, 4.6, z.min(z * 0.4) - 1.0);
        duct(site, "flue", low, DVec3::new(row.stack, 8.6, z.max(z * 0.4) + 1.0), 4.0, DUCT);
    }
}

/// The stack in rings, with platforms, a ladder and bands of warning colour at the top.
fn stack(site: &mut Site, row: &Row) {
    let height = site.plan.top() * 2.1 + 20.0;
    let (foot, head) = (height * 0.052, height * 0.03);
    let rings = 14;
    let radius = |k: usize| (foot + (head - foot) * libm::sqrt(k as f64 / rings as f64)) as f32;
    for k in 0..rings {
        let step = (height / rings as f64) as f32;
        let mut ring = Solid::default();
        ring.lathe(36, &[(radius(k), 0.0), (radius(k + 1), step)]);
        if k % 4 == 3 {
            ring.column(36, Vec2::ZERO, (step - 0.4, radius(k + 1) + 1.1), (step - 0.2, radius(k + 1) + 1.1));
            for post in super::super::solid::circle(24, Vec2::ZERO, radius(k + 1) + 1.05) {
                ring.block(post.x, step - 0.2, post.y, Vec3::new(0.06, 1.1, 0.06));
            }
            ring.lathe(36, &[(radius(k + 1) + 1.05, step + 0.85), (radius(k + 1) + 1.05, step + 0.95)]);
        }
        ladder(&mut ring, Vec3::new(-radius(k) - 0.3, 0.0, 0.0), step, Vec3::NEG_X);
        let color = if k >= rings - 4 && k % 2 == 1 { WARNING } else { CONCRETE };
        site.build(Rank::Must, "stack", ring, DVec3::new(row.stack + foot, f64::from(step) * k as f64, 0.0), color);
    }
}
