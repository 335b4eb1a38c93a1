//! Streets: ground, kerbs and markings, and what stands and grows along them.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::super::super::random::Random;
use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::building::KERB;
use super::facade::Side;
use super::plan::{Block, DISTRICTS, Plot};

/// The ground of a block: road out to the middle of the streets, the raised block, and the crossings' stripes.
pub(super) fn ground(stock: &mut Stock, block: &Block, label: &str) {
    let middle = block.plot.middle();
    let local = |p: DVec2| (p - middle).as_vec2();
    let position = DVec3::new(middle.x, 0.0, middle.y);
    let mut road = Solid::default();
    road.patch(local(block.cell.min), local(block.cell.max), 0.0);
    stock.place_new(Rank::Must, format!("{label}/road"), road, position, [88, 88, 92]);
    let (min, max) = (local(block.plot.min), local(block.plot.max));
    let mut pavement = Solid::default();
    pavement.cuboid(Vec3::new(min.x, -0.1, min.y), Vec3::new(max.x, KERB, max.y));
    stock.place_new(Rank::Must, format!("{label}/pavement"), pavement, position, [150, 148, 142]);
    let mut stripes = Solid::default();
    let edge = local(block.cell.max);
    let mut at = min.x + 4.0;
    while at < max.x - 4.0 {
        stripes.patch(Vec2::new(at, edge.y - 0.1), Vec2::new(at + 2.5, edge.y), 0.03);
        at += 7.0;
    }
    for k in 0..8 {
        let z = min.y + 0.6 + k as f32 * 0.9;
        stripes.patch(Vec2::new(max.x + 0.4, z), Vec2::new(edge.x, z + 0.45), 0.03);
    }
    stock.place_new(Rank::Fill, format!("{label}/stripes"), stripes, position, [208, 206, 196]);
}

/// Shapes that streets share.
pub(super) struct Furniture {
    trees: Vec<u32>,
    lamp: u32,
    benches: [u32; 2],
    cars: [u32; 4],
    bin: u32,
    signal: u32,
    shelter: u32,
    stall: u32,
}

impl Furniture {
    pub fn new(stock: &mut Stock) -> Furniture {
        let heights = [4.5, 5.5, 6.5, 7.5];
        let mut trees: Vec<u32> = heights.iter().map(|&h| stock.shape(broadleaf(h))).collect();
        trees.push(stock.shape(conifer(6.0)));
        Furniture {
            trees,
            lamp: stock.shape(lamp()),
            benches: [true, false].map(|along_x| stock.shape(bench(along_x))),
            cars: [(true, 1.45), (true, 1.9), (false, 1.45), (false, 1.9)].map(|(x, h)| stock.shape(car(x, h))),
            bin: stock.shape(bin()),
            signal: stock.shape(signal()),
            shelter: stock.shape(shelter()),
            stall: stock.shape(stall()),
        }
    }

    /// Offers furniture along the four kerbs of a block.
    pub fn line(&self, stock: &mut Stock, random: &mut Random, block: &Block, label: &str) {
        let district = &DISTRICTS[block.district];
        let mut place = Placer { stock, label, count: 0 };
        for side in super::facade::SIDES {
            let kerb = Kerb::new(block.plot, side);
            let mut at = 4.0 + random.range(0.0, 3.0);
            while at < kerb.length - 4.0 {
                let green = random.below(40) as u8;
                let tree = self.trees[random.below(self.trees.len())];
                place.put("tree", tree, kerb.at(at, 1.0), KERB, [62 + green / 2, 100 + green, 54]);
                at += district.trees * random.range(0.8, 1.25);
            }
            let lamps = (kerb.length / 18.0) as usize;
            for k in 0..lamps {
                place.put("lamp", self.lamp, kerb.at((k as f64 + 0.5) * 18.0, 0.5), KERB, [70, 74, 78]);
            }
            let mut at = 7.0 + random.range(0.0, 4.0);
            while at < kerb.length - 7.0 {
                let kind = usize::from(random.chance(0.25)) + if kerb.along_x { 0 } else { 2 };
                let color = CARS[random.below(CARS.len())];
                place.put("car", self.cars[kind], kerb.at(at, -1.3), 0.0, color);
                at += random.range(5.6, 13.0);
            }
            let bench = self.benches[usize::from(!kerb.along_x)];
            for fraction in [0.35, 0.65] {
                place.put("bench", bench, kerb.at(kerb.length * fraction, 1.9), KERB, [128, 92, 60]);
            }
            place.put("bin", self.bin, kerb.at(kerb.length * 0.5, 0.7), KERB, [60, 86, 68]);
            place.put("signal", self.signal, kerb.at(0.8, 0.8), KERB, [64, 64, 66]);
            if random.chance(0.3) && kerb.along_x {
                place.put("shelter", self.shelter, kerb.at(kerb.length * 0.25, 1.9), KERB, [120, 140, 150]);
            }
        }
    }

    /// Offers plants and stalls on open ground within a block.
    pub fn yard(&self, stock: &mut Stock, random: &mut Random, plot: Plot, label: &str, market: bool) {
        let mut place = Placer { stock, label, count: 1000 };
        let area = plot.size().x.max(0.0) * plot.size().y.max(0.0);
        for _ in 0..(area / 55.0) as usize {
            let at = DVec2::new(random.range(plot.min.x, plot.max.x), random.range(plot.min.y, plot.max.y));
            if market && random.chance(0.6) {
                place.put("stall", self.stall, at, KERB, CARS[random.below(CARS.len())]);
            } else {
                let green = random.below(40) as u8;
                let tree = self.trees[random.below(self.trees.len())];
                place.put("tree", tree, at, KERB, [58 + green / 2, 96 + green, 50]);
            }
        }
    }

    /// Offers trees and sheds in the open country around the city.
    pub fn country(&self, stock: &mut Stock, random: &mut Random, city: Plot, count: usize) {
        let mut place = Placer { stock, label: "country", count: 0 };
        let reach = 260.0;
        while place.count < count {
            let outer = city.inset(-reach);
            let at = DVec2::new(random.range(outer.min.x, outer.max.x), random.range(outer.min.y, outer.max.y));
            let near = city.inset(-25.0);
            let within = at.cmpgt(near.min).all() && at.cmplt(near.max).all();
            let tree = self.trees[random.below(self.trees.len())];
            if !within {
                place.put("tree", tree, at, 0.0, [70, 112 + random.below(30) as u8, 60]);
            }
        }
    }
}

const CARS: [[u8; 3]; 7] =
    [[160, 44, 40], [44, 76, 128], [196, 196, 192], [40, 42, 46], [210, 180, 70], [70, 110, 84], [120, 124, 130]];

struct Placer<'a> {
    stock: &'a mut Stock,
    label: &'a str,
    count: usize,
}

impl Placer<'_> {
    fn put(&mut self, kind: &str, mesh: u32, at: DVec2, y: f32, color: [u8; 3]) {
        let name = format!("{}/{kind}_{}", self.label, self.count);
        self.stock.place(Rank::Fill, name, mesh, DVec3::new(at.x, f64::from(y), at.y), color);
        self.count += 1;
    }
}

/// One edge of a block, measured along it and inwards from it.
struct Kerb {
    start: DVec2,
    along: DVec2,
    inward: DVec2,
    length: f64,
    along_x: bool,
}

impl Kerb {
    fn new(plot: Plot, side: Side) -> Kerb {
        let (min, max) = (plot.min, plot.max);
        let (start, inward) = match side {
            Side::West => (min, DVec2::X),
            Side::East => (DVec2::new(max.x, min.y), -DVec2::X),
            Side::North => (min, DVec2::Y),
            Side::South => (DVec2::new(min.x, max.y), -DVec2::Y),
        };
        let along_x = inward.x == 0.0;
        let (along, length) = if along_x { (DVec2::X, plot.size().x) } else { (DVec2::Y, plot.size().y) };
        Kerb { start, along, inward, length, along_x }
    }

    fn at(&self, along: f64, inward: f64) -> DVec2 {
        self.start + self.along * along + self.inward * inward
    }
}

fn broadleaf(height: f32) -> Solid {
    let mut solid = Solid::default();
    solid.column(5, Vec2::ZERO, (0.0, 0.16), (height * 0.45, 0.12));
    solid.column(7, Vec2::ZERO, (height * 0.35, height * 0.12), (height * 0.6, height * 0.26));
    solid.column(7, Vec2::ZERO, (height * 0.6, height * 0.26), (height, height * 0.1));
    solid
}

fn conifer(height: f32) -> Solid {
    let mut solid = Solid::default();
    solid.column(5, Vec2::ZERO, (0.0, 0.16), (height * 0.3, 0.13));
    solid.column(7, Vec2::ZERO, (height * 0.2, height * 0.22), (height * 0.7, 0.0));
    solid.column(7, Vec2::ZERO, (height * 0.5, height * 0.16), (height, 0.0));
    solid
}

fn lamp() -> Solid {
    let mut solid = Solid::default();
    solid.column(5, Vec2::ZERO, (0.0, 0.09), (5.2, 0.06));
    solid.block(0.0, 5.2, 0.0, Vec3::new(0.5, 0.25, 0.5));
    solid
}

/// Sizes given for a thing that lies along x, turned when it lies along z.
fn turned(along_x: bool, size: Vec3) -> Vec3 {
    if along_x { size } else { Vec3::new(size.z, size.y, size.x) }
}

fn bench(along_x: bool) -> Solid {
    let mut solid = Solid::default();
    solid.block(0.0, 0.4, 0.0, turned(along_x, Vec3::new(1.8, 0.08, 0.5)));
    for end in [-0.7, 0.7] {
        let (x, z) = if along_x { (end, 0.0) } else { (0.0, end) };
        solid.block(x, 0.0, z, turned(along_x, Vec3::new(0.1, 0.4, 0.45)));
    }
    solid
}

fn car(along_x: bool, height: f32) -> Solid {
    let mut solid = Solid::default();
    let low = turned(along_x, Vec3::new(4.2, 0.0, 1.75)) * 0.5;
    let outline = |x: f32, z: f32| [Vec2::new(-x, -z), Vec2::new(-x, z), Vec2::new(x, z), Vec2::new(x, -z)];
    solid.cuboid(Vec3::new(-low.x, 0.3, -low.z), Vec3::new(low.x, height * 0.58, low.z));
    let (foot, top) = (low * 0.92, turned(along_x, Vec3::new(2.0, 0.0, 1.45)) * 0.5);
    solid.loft(&outline(foot.x * 0.8, foot.z), height * 0.58, &outline(top.x, top.z), height);
    for end in [-1.3, 1.3] {
        let (x, z) = if along_x { (end, 0.0) } else { (0.0, end) };
        solid.block(x, 0.0, z, turned(along_x, Vec3::new(0.62, 0.62, 1.8)));
    }
    solid
}

fn bin() -> Solid {
    let mut solid = Solid::default();
    solid.column(6, Vec2::ZERO, (0.0, 0.22), (0.9, 0.26));
    solid
}

fn signal() -> Solid {
    let mut solid = Solid::default();
    solid.column(5, Vec2::ZERO, (0.0, 0.07), (2.6, 0.06));
    solid.block(0.0, 2.6, 0.0, Vec3::new(0.3, 0.9, 0.3));
    solid
}

fn shelter() -> Solid {
    let mut solid = Solid::default();
    for x in [-1.8, 1.8] {
        solid.block(x, 0.0, 0.0, Vec3::new(0.1, 2.3, 1.1));
    }
    solid.block(0.0, 0.5, -0.5, Vec3::new(3.6, 0.1, 0.1));
    solid.block(0.0, 2.3, 0.0, Vec3::new(4.0, 0.12, 1.5));
    solid
}

fn stall() -> Solid {
    let mut solid = Solid::default();
    solid.block(0.0, 0.0, 0.0, Vec3::new(2.4, 0.9, 1.2));
    for (x, z) in [(-1.3, -0.8), (1.3, -0.8), (-1.3, 0.8), (1.3, 0.8)] {
        solid.block(x, 0.0, z, Vec3::new(0.08, 2.2, 0.08));
    }
    solid.gable(Vec3::new(-1.6, 2.2, -1.1), Vec3::new(1.6, 2.9, 1.1));
    solid
}
