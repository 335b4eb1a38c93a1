//! Furniture: chairs, desks, shelves, beds, plants and the like, shared by all their instances; flights of stairs; trees outside.
//!
//! A room is a grid of places of a metre and a quarter; those before doors stay free. Each thing stands within its place.

use glam::{DVec3, Mat3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::solid::{Solid, circle};
use super::super::stock::{Rank, Stock};
use super::plan::{FLIGHT, HALVES, Kind, Plan, STOREY, Space, UNIT, metres};

/// Side of a place, in units.
const PLACE: i32 = 10;
/// How far before a door things may not stand, in units.
const FREE: i32 = 14;

/// The shapes of everything.
pub(super) struct Furniture {
    things: Vec<(&'static str, u32, [u8; 3])>,
    lamp: u32,
    tree: u32,
}

impl Furniture {
    /// Makes the shapes.
    pub fn new(stock: &mut Stock) -> Furniture {
        let things = vec![
            ("chair", stock.shape(chair()), [150, 96, 60]),
            ("desk", stock.shape(desk()), [178, 150, 116]),
            ("shelf", stock.shape(shelf()), [132, 98, 70]),
            ("bed", stock.shape(bed()), [150, 166, 190]),
            ("plant", stock.shape(plant()), [74, 120, 66]),
            ("cabinet", stock.shape(cabinet()), [166, 166, 172]),
            ("sofa", stock.shape(sofa()), [146, 84, 84]),
        ];
        Furniture { things, lamp: stock.shape(lamp()), tree: stock.shape(tree()) }
    }

    /// Offers what a space may have.
    pub fn furnish(&self, stock: &mut Stock, random: &mut Random, plan: &Plan, number: usize, space: &Space) {
        match space.kind {
            Kind::Room => self.room(stock, random, plan, number, space),
            Kind::Corridor => self.lamps(stock, random, space),
            Kind::Stairwell if space.storey + 1 < plan.storeys => stairs(stock, space),
            Kind::Outside if space.min[1] == 0 => self.trees(stock, random, plan, space),
            Kind::Stairwell | Kind::Doorway | Kind::Window | Kind::Slab | Kind::Outside => {}
        }
    }

    fn room(&self, stock: &mut Stock, random: &mut Random, plan: &Plan, number: usize, space: &Space) {
        let doors: Vec<_> =
            (plan.links[number].iter().map(|&o| &plan.openings[o])).filter(|o| o.min[1] == space.min[1]).collect();
        let free = |x: i32, z: i32| {
            doors.iter().all(|d| {
                let gap = |p: i32, low: i32, high: i32| (low - p - PLACE).max(p - high).max(0);
                gap(x, d.min[0], d.max[0]).max(gap(z, d.min[2], d.max[2])) >= FREE
            })
        };
        for x in (space.min[0]..=space.max[0] - PLACE).step_by(PLACE as usize) {
            for z in (space.min[2]..=space.max[2] - PLACE).step_by(PLACE as usize) {
                let (bare, kind, turn) = (random.chance(0.2), random.below(self.things.len()), random.below(4));
                let shift = [random.range(-0.08, 0.08), random.range(-0.08, 0.08)];
                if bare || !free(x, z) {
                    continue;
                }
                let (name, mesh, color) = self.things[kind];
                let shade = random.below(24) as u8;
                let middle = metres([x, space.min[1], z]) + DVec3::new(0.625 + shift[0], 0.0, 0.625 + shift[1]);
                let name = format!("{}/{name}_{x}_{z}", space.name);
                stock.place_turned(Rank::Fill, name, mesh, QUARTERS[turn], middle, color.map(|c| c - shade));
            }
        }
        let middle = (metres(space.min) + metres(space.max)) * 0.5;
        let position = DVec3::new(middle.x, metres(space.max).y, middle.z);
        stock.place(Rank::Detail, format!("{}/lamp", space.name), self.lamp, position, [240, 232, 200]);
    }

    /// Lamps along the longer side.
    fn lamps(&self, stock: &mut Stock, random: &mut Random, space: &Space) {
        let (min, max) = (metres(space.min), metres(space.max));
        let along = if max.x - min.x > max.z - min.z { DVec3::X } else { DVec3::Z };
        let count = ((max - min).dot(along) / 4.0) as usize;
        let first = random.range(1.0, 2.0);
        for k in 0..count {
            let middle = (min + max) * 0.5 * (DVec3::ONE - along) + (min + first + 4.0 * k as f64) * along;
            let position = DVec3::new(middle.x, max.y, middle.z);
            stock.place(Rank::Detail, format!("{}/lamp_{k}", space.name), self.lamp, position, [240, 232, 200]);
        }
    }

    /// A few trees, clear of the building and of the way to its entrance.
    fn trees(&self, stock: &mut Stock, random: &mut Random, plan: &Plan, space: &Space) {
        let (min, max, outer) = (metres(space.min), metres(space.max), metres(plan.outer));
        for k in 0..12 {
            let (x, z) = (random.range(min.x + 4.0, max.x - 4.0), random.range(min.z + 4.0, max.z - 4.0));
            let near = x > -4.0 && x < outer.x + 4.0 && z > -20.0 && z < outer.z + 4.0;
            if !near {
                stock.place(
                    Rank::Fill,
                    format!("{}/tree_{k}", space.name),
                    self.tree,
                    DVec3::new(x, 0.0, z),
                    [66, 104, 58],
                );
            }
        }
    }
}

/// Quarter turns about the vertical, exact.
const QUARTERS: [Mat3; 4] = [
    Mat3::IDENTITY,
    Mat3::from_cols(Vec3::NEG_Z, Vec3::Y, Vec3::X),
    Mat3::from_cols(Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z),
    Mat3::from_cols(Vec3::Z, Vec3::Y, Vec3::NEG_X),
];

/// The flight from a storey to the next: steps of a quarter metre, a little narrower than the opening above them.
fn stairs(stock: &mut Stock, space: &Space) {
    let half = HALVES[space.storey % 2];
    let metre = |units: i32| (f64::from(units) / UNIT) as f32;
    let (count, run) = (STOREY / 2, FLIGHT[1] - FLIGHT[0]);
    let mut solid = Solid::default();
    for step in 0..count {
        let (mut z0, mut z1) = (FLIGHT[0] + step * run / count, FLIGHT[0] + (step + 1) * run / count);
        if space.storey % 2 == 1 {
            (z0, z1) = (FLIGHT[0] + FLIGHT[1] - z1, FLIGHT[0] + FLIGHT[1] - z0);
        }
        let (low, high) = ((step - 2).max(0) * 2, (step + 1) * 2);
        let min = Vec3::new(metre(half[0] + 1), metre(low), metre(z0));
        solid.cuboid(min, Vec3::new(metre(half[1] - 1), metre(high), metre(z1)));
    }
    let position = DVec3::new(0.0, metres(space.min).y, 0.0);
    stock.place_new(Rank::Must, format!("{}/stairs", space.name), solid, position, [170, 168, 160]);
}

/// A box about (x, z) on the plane y.
fn block(solid: &mut Solid, [x, y, z]: [f32; 3], size: [f32; 3]) {
    solid.block(x, y, z, Vec3::from_array(size));
}

fn chair() -> Solid {
    let mut solid = Solid::default();
    for (x, z) in [(-0.2, -0.2), (-0.2, 0.2), (0.2, -0.2), (0.2, 0.2)] {
        solid.column(6, Vec2::new(x, z), (0.0, 0.018), (0.44, 0.022));
        if z < 0.0 {
            solid.column(6, Vec2::new(x, z), (0.48, 0.018), (0.9, 0.015));
        }
    }
    block(&mut solid, [0.0, 0.44, 0.0], [0.46, 0.04, 0.46]);
    for y in [0.55, 0.66, 0.77] {
        block(&mut solid, [0.0, y, -0.2], [0.36, 0.06, 0.02]);
    }
    solid
}

fn desk() -> Solid {
    let mut solid = Solid::default();
    block(&mut solid, [0.0, 0.72, 0.0], [1.05, 0.03, 0.7]);
    for x in [-0.5, 0.5] {
        block(&mut solid, [x, 0.0, 0.0], [0.03, 0.72, 0.66]);
    }
    for y in [0.1, 0.3, 0.5] {
        block(&mut solid, [0.3, y, 0.0], [0.34, 0.18, 0.6]);
        block(&mut solid, [0.3, y + 0.08, 0.31], [0.1, 0.02, 0.02]);
    }
    // A screen, a keyboard, and a pile of books.
    block(&mut solid, [-0.1, 0.76, -0.15], [0.22, 0.02, 0.16]);
    block(&mut solid, [-0.1, 0.78, -0.17], [0.04, 0.12, 0.03]);
    block(&mut solid, [-0.1, 0.9, -0.17], [0.52, 0.31, 0.03]);
    block(&mut solid, [-0.1, 0.76, 0.12], [0.42, 0.02, 0.14]);
    for k in 0..5 {
        let k = k as f32;
        block(&mut solid, [0.36, 0.76 + 0.035 * k, 0.05 + 0.008 * k], [0.2 - 0.01 * k, 0.03, 0.26]);
    }
    solid.column(10, Vec2::new(-0.42, -0.2), (0.76, 0.07), (0.78, 0.07));
    solid.column(6, Vec2::new(-0.42, -0.2), (0.78, 0.012), (1.1, 0.012));
    solid.column(12, Vec2::new(-0.42, -0.2), (1.1, 0.09), (1.22, 0.05));
    solid
}

fn shelf() -> Solid {
    let mut solid = Solid::default();
    for x in [-0.44, 0.44] {
        block(&mut solid, [x, 0.0, 0.0], [0.03, 1.96, 0.3]);
    }
    for board in 0..6 {
        let y = 0.06 + 0.37 * board as f32;
        block(&mut solid, [0.0, y, 0.0], [0.84, 0.025, 0.3]);
        for book in 0..(if board < 5 { 9 } else { 0 }) {
            let k = (board * 9 + book) as f32;
            let (height, deep) =
                (0.2 + 0.1 * libm::fabsf(libm::sinf(k * 1.7)), 0.16 + 0.08 * libm::fabsf(libm::sinf(k)));
            block(&mut solid, [-0.37 + 0.085 * book as f32, y + 0.03, 0.0], [0.05, height, deep]);
        }
    }
    solid
}

fn bed() -> Solid {
    let mut solid = Solid::default();
    for (x, z) in [(-0.45, -0.5), (-0.45, 0.5), (0.45, -0.5), (0.45, 0.5)] {
        solid.column(8, Vec2::new(x, z), (0.0, 0.03), (0.2, 0.04));
    }
    block(&mut solid, [0.0, 0.2, 0.0], [0.98, 0.12, 1.08]);
    block(&mut solid, [0.0, 0.33, 0.0], [0.94, 0.16, 1.02]);
    block(&mut solid, [0.0, 0.33, -0.53], [0.98, 0.5, 0.02]);
    for (y, half) in [(0.5, 0.3), (0.55, 0.26)] {
        block(&mut solid, [0.0, y, -0.34], [2.0 * half, 0.045, 0.28]);
    }
    solid
}

fn plant() -> Solid {
    let mut solid = Solid::default();
    solid.lathe(14, &[(0.12, 0.0), (0.15, 0.08), (0.19, 0.3), (0.21, 0.32), (0.18, 0.32), (0.17, 0.28)]);
    for leaf in 0..18 {
        let angle = f64::from(leaf) * 2.4;
        let (s, c) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
        let (reach, height) = (0.12 + 0.016 * leaf as f32, 1.5 - 0.05 * leaf as f32);
        let foot = Vec2::new(s, c) * 0.05;
        solid.spire(&circle(5, foot, 0.022), 0.27, Vec3::new(s * reach, height, c * reach));
    }
    solid
}

fn cabinet() -> Solid {
    let mut solid = Solid::default();
    block(&mut solid, [0.0, 0.06, 0.0], [0.9, 1.14, 0.45]);
    for drawer in 0..4 {
        let y = 0.09 + 0.28 * drawer as f32;
        for x in [-0.22, 0.22] {
            block(&mut solid, [x, y, 0.235], [0.41, 0.25, 0.02]);
            block(&mut solid, [x, y + 0.11, 0.255], [0.12, 0.02, 0.02]);
        }
    }
    block(&mut solid, [0.0, 1.2, 0.0], [0.94, 0.03, 0.48]);
    solid
}

fn sofa() -> Solid {
    let mut solid = Solid::default();
    block(&mut solid, [0.0, 0.08, 0.0], [0.78, 0.24, 0.8]);
    for x in [-0.46, 0.46] {
        solid.column(10, Vec2::new(x, 0.0), (0.0, 0.04), (0.08, 0.04));
        block(&mut solid, [x, 0.08, 0.0], [0.12, 0.5, 0.8]);
    }
    for x in [-0.195, 0.195] {
        block(&mut solid, [x, 0.33, 0.06], [0.37, 0.12, 0.66]);
        block(&mut solid, [x, 0.46, -0.24], [0.36, 0.34, 0.12]);
    }
    block(&mut solid, [0.0, 0.33, -0.36], [0.78, 0.5, 0.1]);
    solid
}

/// Hangs from the ceiling.
fn lamp() -> Solid {
    let mut solid = Solid::default();
    solid.column(6, Vec2::ZERO, (-0.3, 0.01), (-0.01, 0.01));
    solid.lathe(16, &[(0.0, -0.42), (0.12, -0.4), (0.2, -0.34), (0.12, -0.3)]);
    solid
}

fn tree() -> Solid {
    let mut solid = Solid::default();
    solid.column(8, Vec2::ZERO, (0.0, 0.2), (2.4, 0.12));
    for (low, high, radius) in [(1.4, 3.4, 1.6), (2.4, 4.6, 1.2), (3.6, 6.0, 0.8)] {
        solid.column(11, Vec2::ZERO, (low, radius), (high, 0.0));
    }
    solid
}
