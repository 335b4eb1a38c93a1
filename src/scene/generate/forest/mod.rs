//! A wood of leaves (after thesis figures 2.2 and 5.1): nothing hides much by itself, many small things together hide
//! nearly all.
//!
//! Oaks, firs, saplings, bushes and ferns on gently rolling ground. A plant is a few objects, its wood and one a bough, placed
//! many times from a few meshes; every leaf is two triangles, folded along its midrib and seen from both sides. Where trunks
//! end, bushes begin, so that the walk, at the height of a person, sees some twenty metres deep, and out over nothing.

mod plants;

use glam::{DVec3, Mat3, Vec3};

use super::super::Facing;
use super::super::random::Random;
use super::Generated;
use super::solid::Solid;
use super::stock::{Rank, Spare, Stock};
use crate::view::{CameraPath, PathKey};
use plants::{Kind, Plants};

/// Cells of a tile of ground, each way, and the length of one in metres.
const CELLS: u32 = 16;
const CELL: f64 = 2.0;
const TILE: f64 = CELLS as f64 * CELL;
const TILE_TRIANGLES: u64 = 2 * (CELLS * CELLS) as u64;
/// Plots of a tile, each way: a plot has one plant, and a fern.
const PLOTS: u64 = 10;
/// The colours of the ground: moss and old leaves.
const GROUND: [u8; 3] = [92, 84, 52];

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let mut stock = Stock::default();
    let plants = Plants::new(&mut stock, seed);
    let a_tile = plants.mean() * (PLOTS * PLOTS) as f64 + TILE_TRIANGLES as f64;
    let side = libm::round(libm::sqrt(triangles as f64 / a_tile)).max(1.0) as u64;
    let ground = Ground::new(seed, side);
    ground.lay(&mut stock);
    let way = Way::new(&ground);
    plant(&mut stock, &plants, &ground, &way, seed, triangles);
    // An ant hill beside the walk.
    let beside = way.at(0.5) + DVec3::Z * 2.4;
    let position = DVec3::new(beside.x, ground.height(beside.x, beside.z) - 0.05, beside.z);
    let spare = Spare { name: "ant_hill", position, radius: 0.9, height: 0.8, color: [110, 78, 50] };
    let mut scene = stock.settle("forest", triangles, seed, &spare);
    for object in &mut scene.objects {
        if object.name.contains("/leaves") {
            object.facing = Facing::Both;
        }
    }
    Generated { scene, path: way.walk(&ground), frames: 120 }
}

/// Offers plants in a shuffled order of plots, so that those left out are missing evenly: a plant and a fern a plot, then more
/// of the small ones until there are enough. Ferns to make up the number come last.
fn plant(stock: &mut Stock, plants: &Plants, ground: &Ground, way: &Way, seed: u64, triangles: u64) {
    let mut random = Random::keyed(seed, 3);
    let wanted = triangles + 4000;
    let side = ground.side * PLOTS;
    let plot = TILE / PLOTS as f64;
    let mut plots: Vec<u64> = (0..side * side).collect();
    let mut count = 0;
    for round in 0.. {
        random.shuffle(&mut plots);
        let enough = stock.triangles() >= wanted;
        for k in &plots {
            let kinds: &[Kind] = match round {
                0 => &[Kind::any(&mut random), Kind::Fern],
                _ if enough => &[Kind::Fern],
                _ => &[Kind::low(&mut random)],
            };
            for &kind in kinds {
                let corner = |n: u64| (n as f64 - side as f64 * 0.5) * plot;
                let (x, z) = (corner(k % side) + plot * random.unit(), corner(k / side) + plot * random.unit());
                let scale = random.range(0.8, 1.2);
                if way.distance(x, z) < plants.clearance(kind) * scale {
                    continue;
                }
                let position = DVec3::new(x, ground.height(x, z) - 0.08, z);
                let turn = upright(&mut random, scale);
                let rank = if enough { Rank::Fill } else { Rank::Must };
                plants.place(stock, &mut random, rank, kind, count, position, turn);
                count += 1;
            }
        }
        if enough {
            return;
        }
    }
}

/// A turn about the vertical, and a size.
fn upright(random: &mut Random, scale: f64) -> Mat3 {
    let angle = random.range(0.0, TAU);
    let (sin, cos) = ((libm::sin(angle) * scale) as f32, (libm::cos(angle) * scale) as f32);
    Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y * scale as f32, Vec3::new(sin, 0.0, cos))
}

const TAU: f64 = std::f64::consts::TAU;

/// The ground: square tiles around 0, over waves of wave vector (x, z) and phase, radians per metre and radians, and height.
struct Ground {
    side: u64,
    waves: Vec<(f64, f64, f64, f64)>,
}

impl Ground {
    fn new(seed: u64, side: u64) -> Ground {
        let mut random = Random::keyed(seed, 1);
        let wave = |k: usize| {
            let (length, angle) = (160.0 / (1.0 + 1.3 * k as f64), random.range(0.0, TAU));
            let (wave, phase) = (TAU / length, random.range(0.0, TAU));
            (libm::cos(angle) * wave, libm::sin(angle) * wave, phase, length * 0.009)
        };
        Ground { side, waves: (0..5).map(wave).collect() }
    }

    fn height(&self, x: f64, z: f64) -> f64 {
        self.waves.iter().map(|&(kx, kz, phase, height)| libm::sin(x * kx + z * kz + phase) * height).sum()
    }

    /// Half a side of all of it, in metres.
    fn half(&self) -> f64 {
        self.side as f64 * TILE * 0.5
    }

    fn lay(&self, stock: &mut Stock) {
        for k in 0..self.side * self.side {
            let (i, j) = (k % self.side, k / self.side);
            let (x, z) = (i as f64 * TILE - self.half(), j as f64 * TILE - self.half());
            let mut solid = Solid::default();
            // Heights are taken at world positions, so that neighbours agree along their seam to the bit.
            solid.sheet(CELLS, |u, v| {
                let (dx, dz) = (f64::from(u) * CELL, f64::from(v) * CELL);
                Vec3::new(dx as f32, self.height(x + dx, z + dz) as f32, dz as f32)
            });
            stock.place_new(Rank::Must, format!("ground_{i}_{j}"), solid, DVec3::new(x, 0.0, z), GROUND);
        }
    }
}

/// Height of the eye above the ground, and metres between points of the way.
const EYE: f64 = 1.7;
const STEP: f64 = 1.5;

/// A winding way through the wood, on the ground's plan.
struct Way {
    points: Vec<DVec3>,
}

impl Way {
    fn new(ground: &Ground) -> Way {
        let reach = ground.half() * 0.8;
        let steps = libm::ceil(2.0 * reach / STEP).max(4.0) as usize;
        let point = |k: usize| {
            let x = (k as f64 / steps as f64 * 2.0 - 1.0) * reach;
            DVec3::new(x, 0.0, (libm::sin(x * 0.11) * 0.6 + libm::sin(x * 0.037)) * (reach * 0.12).min(9.0))
        };
        Way { points: (0..=steps).map(point).collect() }
    }

    /// The point at a share of the way.
    fn at(&self, share: f64) -> DVec3 {
        self.points[((self.points.len() - 1) as f64 * share) as usize]
    }

    /// How far a place is from the way, in metres.
    fn distance(&self, x: f64, z: f64) -> f64 {
        let to = |p: &DVec3| (p.x - x) * (p.x - x) + (p.z - z) * (p.z - z);
        libm::sqrt(self.points.iter().map(to).fold(f64::INFINITY, f64::min))
    }

    /// Along the way, looking ahead and about: to both sides, and once up into the crowns.
    fn walk(&self, ground: &Ground) -> CameraPath {
        let last = self.points.len() - 1;
        let key = |k: usize| {
            let place = self.points[k];
            let eye = DVec3::new(place.x, ground.height(place.x, place.z) + EYE, place.z);
            let ahead = (self.points[(k + 1).min(last)] - self.points[k.min(last - 1)]).normalize();
            let share = k as f64 / last as f64;
            let aside = 0.9 * libm::sin(share * TAU * 2.0);
            let lift = (1.0 - (share - 0.55).abs() / 0.08).max(0.0) * 0.7;
            let side = DVec3::new(-ahead.z, 0.0, ahead.x);
            PathKey { eye, target: eye + (ahead + side * aside + DVec3::Y * lift) * 5.0 }
        };
        CameraPath { fov_y_deg: 60.0, near: 0.1, far: None, up: DVec3::Y, keys: (0..=last).map(key).collect() }
    }
}
