//! Open rolling ground with sparse trees, rocks and huts: nothing hides anything, so culling can only cost.
//!
//! Heights are a sum of a few long waves; ground is in tiles of 16 x 16 cells, each an object. The walk is over the crests
//! and in the open, looking far and a little down.

use glam::{DVec3, Vec2, Vec3};

use super::super::random::Random;
use super::Generated;
use super::solid::Solid;
use super::stock::{Rank, Spare, Stock};
use crate::view::{CameraPath, PathKey};

/// Cells of a tile, each way, and the length of a cell in metres.
const CELLS: u32 = 16;
const CELL: f64 = 4.0;
const TILE: f64 = CELLS as f64 * CELL;
/// Triangles of a tile and of an average thing on it, with the things of a tile.
const TILE_TRIANGLES: u64 = 2 * (CELLS * CELLS) as u64;
const THINGS: u64 = 5;

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let hills = Hills::new(seed);
    // Tiles take two thirds of the triangles; things are offered until the rest is certainly covered.
    let side = libm::sqrt((triangles * 2 / 3 / TILE_TRIANGLES) as f64).max(1.0) as u64;
    let mut stock = Stock::default();
    lay_tiles(&mut stock, &hills, side);
    let shapes = Shapes::new(&mut stock);
    let wanted = triangles.saturating_sub(stock.must()) + 400;
    let half = side as f64 * TILE * 0.5;
    let mut random = Random::keyed(seed, 2);
    let before = stock.triangles();
    let mut count = 0;
    while stock.triangles() - before < wanted {
        let (x, z) = (random.range(-half, half), random.range(-half, half));
        shapes.place(&mut stock, &mut random, count, DVec3::new(x, hills.height(x, z) - 0.15, z));
        count += 1;
    }
    let spare = Spare::obelisk(DVec3::new(0.0, hills.height(0.0, 0.0), 0.0));
    let scene = stock.settle("terrain", triangles, seed, &spare);
    Generated { scene, path: walk(&hills, half), frames: 120 }
}

/// Waves of ground: wave vector and phase, in radians per metre and radians, and height in metres.
struct Hills {
    waves: Vec<(f64, f64, f64, f64)>,
}

impl Hills {
    fn new(seed: u64) -> Hills {
        let mut random = Random::keyed(seed, 1);
        let wave = |k: usize| {
            let (length, angle) = (900.0 / (1.0 + 1.7 * k as f64), random.range(0.0, std::f64::consts::TAU));
            let (wave, phase) = (std::f64::consts::TAU / length, random.range(0.0, std::f64::consts::TAU));
            (libm::cos(angle) * wave, libm::sin(angle) * wave, phase, length * 0.008)
        };
        Hills { waves: (0..6).map(wave).collect() }
    }

    fn height(&self, x: f64, z: f64) -> f64 {
        self.waves.iter().map(|&(kx, kz, phase, height)| libm::sin(x * kx + z * kz + phase) * height).sum()
    }
}

fn lay_tiles(stock: &mut Stock, hills: &Hills, side: u64) {
    for k in 0..side * side {
        let (i, j) = (k % side, k / side);
        let corner = |n: u64| (n as f64 - side as f64 * 0.5) * TILE;
        let (x, z) = (corner(i), corner(j));
        let mut solid = Solid::default();
        // Heights are taken at world positions, so that neighbours agree along their seam to the bit.
        solid.sheet(CELLS, |u, v| {
            let (dx, dz) = (f64::from(u) * CELL, f64::from(v) * CELL);
            Vec3::new(dx as f32, hills.height(x + dx, z + dz) as f32, dz as f32)
        });
        let shade = ((i + j) % 2 * 8) as u8;
        let color = [104 + shade, 132 + shade, 72 + shade / 2];
        stock.place_new(Rank::Must, format!("ground_{i}_{j}"), solid, DVec3::new(x, 0.0, z), color);
    }
}

/// The things that stand about, shared by all their instances.
struct Shapes {
    trees: [u32; 3],
    rocks: [u32; 3],
    hut: u32,
}

impl Shapes {
    fn new(stock: &mut Stock) -> Shapes {
        let tree = |height: f32| {
            let mut solid = Solid::default();
            solid.column(6, Vec2::ZERO, (0.0, 0.25), (height * 0.4, 0.18));
            for (low, high, radius) in [(0.25, 0.65, 0.34), (0.45, 0.85, 0.26), (0.65, 1.0, 0.18)] {
                solid.column(9, Vec2::ZERO, (height * low, height * radius), (height * high, 0.0));
            }
            solid
        };
        let rock = |size: f32| {
            let mut solid = Solid::default();
            solid.column(8, Vec2::ZERO, (0.0, size), (size * 0.6, size * 0.8));
            solid.column(7, Vec2::new(size * 0.2, 0.0), (size * 0.6, size * 0.7), (size, size * 0.3));
            solid
        };
        let trees = [5.0, 6.5, 8.0].map(|h| stock.shape(tree(h)));
        let rocks = [0.5, 0.9, 1.4].map(|s| stock.shape(rock(s)));
        let hut = stock.shape(hut());
        Shapes { trees, rocks, hut }
    }

    fn place(&self, stock: &mut Stock, random: &mut Random, count: usize, position: DVec3) {
        let (kind, variant) = (random.below(THINGS as usize), random.below(3));
        let shade = random.below(24) as u8;
        let (name, mesh, color) = match kind {
            0 if random.chance(0.3) => ("hut", self.hut, [150 + shade, 116, 84]),
            0 | 1 => ("rock", self.rocks[variant], [128 + shade, 124 + shade, 118 + shade]),
            _ => ("tree", self.trees[variant], [58, 98 + shade, 52]),
        };
        stock.place(Rank::Fill, format!("{name}_{count}"), mesh, position, color);
    }
}

fn hut() -> Solid {
    let mut solid = Solid::default();
    solid.block(0.0, 0.0, 0.0, Vec3::new(6.0, 2.6, 4.5));
    solid.gable(Vec3::new(-3.4, 2.6, -2.7), Vec3::new(3.4, 4.6, 2.7));
    solid.block(0.0, 0.0, 2.3, Vec3::new(0.9, 2.0, 0.12));
    for x in [-1.9, 1.9] {
        solid.block(x, 1.0, 2.28, Vec3::new(0.9, 0.9, 0.1));
    }
    solid.block(1.6, 2.6, -0.8, Vec3::new(0.6, 2.6, 0.6));
    solid
}

/// A round on a wide circle, high enough to look over everything, heading along the circle and a little down.
fn walk(hills: &Hills, half: f64) -> CameraPath {
    let keys = (0..=16)
        .map(|k| {
            let at = |angle: f64| DVec3::new(libm::sin(angle), 0.0, libm::cos(angle)) * half * 0.6;
            let angle = std::f64::consts::TAU * f64::from(k) / 16.0;
            let mut eye = at(angle);
            eye.y = hills.height(eye.x, eye.z) + 26.0;
            // Across the open middle, not outward: most of the ground is in view.
            let mut target = at(angle + 2.2);
            target.y = eye.y - 20.0;
            PathKey { eye, target }
        })
        .collect();
    CameraPath { fov_y_deg: 60.0, near: 0.1, far: None, up: DVec3::Y, keys }
}
