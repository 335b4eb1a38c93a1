//! Teapots (after CHC, Bittner et al. 2004, section 5): 5000 of 2,304 triangles each, 11,520,000 in all, at random places
//! and turns in a long thin box. One mesh, placed many times.
//!
//! The shape is Martin Newell's (Utah, 1975; control points after F. Crow, *The origins of the teapot*, IEEE CG&A 1987),
//! with the bottom that was added later: 32 bicubic Bezier patches, each cut into 6 x 6 x 2 triangles. At the two poles, in
//! the lid's knob and the bottom, one side of four patches is a single point: 48 of the triangles have no area there. They
//! are kept, as any evaluator of the patches makes them, so that the number is the paper's. Every surface is drawn from both
//! sides: the lid does not touch the rim, and spout and handle are open ends stuck through the wall.
//!
//! What the paper says of the scene holds by the density: no teapot hides another by itself, many together do; there are
//! holes far into the box; seen from its long side almost half of the teapots can be seen, from its short side few.

use std::collections::BTreeMap;

use glam::{DVec3, Mat3, Vec3};

use super::super::model::palette;
use super::super::random::Random;
use super::super::{Facing, Mesh, Object, Scene};
use super::Generated;
use crate::view::{CameraPath, PathKey};

/// Triangles of a teapot.
const TRIANGLES: u64 = 32 * 2 * (CUTS * CUTS) as u64;
/// Parts that a patch is cut into, each way.
const CUTS: usize = 6;
/// Metres of a unit of the control points: a pot 32 cm from spout to handle.
const UNIT: f64 = 0.05;
/// What a teapot turns about, in units: about the middle of its box.
const MIDDLE: DVec3 = DVec3::new(0.2, 1.575, 0.0);

/// Room of a teapot, in cubic metres: what decides how far one sees into the box.
const ROOM: f64 = 75.0 * UNIT * UNIT * UNIT;
/// Long side of the box over each of its short ones.
const LONG: f64 = 6.0;
/// Distance of two teapots' middles, at least, in metres: bodies hardly touch, a spout may reach through a handle.
const APART: f64 = 3.4 * UNIT;
/// Places tried for a teapot before the last one is taken.
const TRIES: usize = 1000;

pub(super) fn build(seed: u64, triangles: u64) -> Generated {
    let count = (triangles / TRIANGLES).max(1) as usize;
    let thin = libm::cbrt(count as f64 * ROOM / LONG);
    let half = DVec3::new(thin * LONG, thin, thin) * 0.5;
    let places = scatter(count, half, &mut Random::keyed(seed, 1));
    let mut random = Random::keyed(seed, 2);
    let object = |(k, position): (usize, DVec3)| Object {
        name: format!("teapot_{k}"),
        mesh: 0,
        rotation: turn(&mut random),
        position,
        facing: Facing::Both,
        color: palette(k as u64),
        opacity: 1.0,
    };
    let objects = places.into_iter().enumerate().map(object).collect();
    let scene = Scene { name: "teapots".into(), meshes: vec![teapot()], objects, cells: None };
    Generated { scene, path: walk(half), frames: 120 }
}

/// Control points of a surface of revolution: (radius, height), from the top down.
type Profile = [(f64, f64); 4];

/// Lid, rim, body and bottom.
const PROFILES: [Profile; 6] = [
    [(0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7)],
    [(0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4)],
    [(1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4)],
    [(1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9)],
    [(2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15)],
    [(1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0)],
];
/// Newell's quarter of a circle: (x, z) of its control points for a radius of 1.
const QUARTER: [(f64, f64); 4] = [(1.0, 0.0), (1.0, 0.56), (0.56, 1.0), (0.0, 1.0)];

/// A tube of two patches on each side of the plane z = 0: (x, y) where its section begins, (x, y) where it ends, and the
/// distance of the two inner control points from the plane. The fourth section belongs to both patches.
type Tube = [(f64, f64, f64, f64, f64); 7];

const HANDLE: Tube = [
    (-1.6, 2.025, -1.5, 2.25, 0.3),
    (-2.3, 2.025, -2.5, 2.25, 0.3),
    (-2.7, 2.025, -3.0, 2.25, 0.3),
    (-2.7, 1.8, -3.0, 1.8, 0.3),
    (-2.7, 1.575, -3.0, 1.35, 0.3),
    (-2.5, 1.125, -2.65, 0.9375, 0.3),
    (-2.0, 0.9, -1.9, 0.6, 0.3),
];
const SPOUT: Tube = [
    (1.7, 1.425, 1.7, 0.6, 0.66),
    (2.6, 1.425, 3.1, 0.825, 0.66),
    (2.3, 2.1, 2.4, 2.025, 0.25),
    (2.7, 2.4, 3.3, 2.4, 0.25),
    (2.8, 2.475, 3.525, 2.49375, 0.25),
    (2.9, 2.475, 3.45, 2.5125, 0.15),
    (2.8, 2.4, 3.2, 2.4, 0.15),
];

/// Sixteen control points, in rows.
type Patch = [[DVec3; 4]; 4];

/// The teapot about its middle, in metres, its lid up and its spout along x.
fn teapot() -> Mesh {
    let mut net = Net::default();
    for profile in &PROFILES {
        // A quarter turn takes (x, z) to (-z, x): exact, so that neighbours agree along their seam.
        for (cos, sin) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            let point = |(r, y): (f64, f64), (x, z): (f64, f64)| {
                DVec3::new(r * (x * cos - z * sin), y, r * (x * sin + z * cos))
            };
            net.patch(&profile.map(|row| QUARTER.map(|column| point(row, column))), false);
        }
    }
    for tube in [&HANDLE, &SPOUT] {
        for first in [0, 3] {
            for side in [1.0, -1.0] {
                let mut patch = [[DVec3::ZERO; 4]; 4];
                for (row, &(x0, y0, x1, y1, width)) in patch.iter_mut().zip(&tube[first..first + 4]) {
                    let at = |x, y, z: f64| DVec3::new(x, y, z * side);
                    *row = [at(x0, y0, 0.0), at(x0, y0, width), at(x1, y1, width), at(x1, y1, 0.0)];
                }
                net.patch(&patch, side < 0.0);
            }
        }
    }
    Mesh::from_checked(net.positions, net.triangles)
}

/// A mesh in the making: vertices of patches that are in the same place are one.
#[derive(Default)]
struct Net {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    known: BTreeMap<[u32; 3], u32>,
}

impl Net {
    /// Cuts a patch into [`CUTS`] x [`CUTS`] squares of two triangles. Outside is where columns cross rows by the right hand,
    /// or, mirrored, the other side.
    fn patch(&mut self, patch: &Patch, mirrored: bool) {
        let mut rows = [[0; CUTS + 1]; CUTS + 1];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, vertex) in row.iter_mut().enumerate() {
                *vertex = self.vertex((surface(patch, i, j) - MIDDLE) * UNIT);
            }
        }
        let mut face = |a, b, c| self.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
        for i in 0..CUTS {
            for j in 0..CUTS {
                let [a, b, c, d] = [rows[i][j], rows[i][j + 1], rows[i + 1][j + 1], rows[i + 1][j]];
                face(a, b, c);
                face(a, c, d);
            }
        }
    }

    fn vertex(&mut self, at: DVec3) -> u32 {
        // Adding 0 makes a negative zero a positive one.
        let at = at.as_vec3() + 0.0;
        let next = self.positions.len() as u32;
        let vertex = *self.known.entry(at.to_array().map(f32::to_bits)).or_insert(next);
        if vertex == next {
            self.positions.push(at);
        }
        vertex
    }
}

/// The patch at (row / [`CUTS`], column / [`CUTS`]).
fn surface(patch: &Patch, row: usize, column: usize) -> DVec3 {
    let (u, v) = (bernstein(row), bernstein(column));
    let along = |points: &[DVec3; 4]| points[0] * v[0] + points[1] * v[1] + points[2] * v[2] + points[3] * v[3];
    along(&patch[0]) * u[0] + along(&patch[1]) * u[1] + along(&patch[2]) * u[2] + along(&patch[3]) * u[3]
}

/// Weights of four control points at k / [`CUTS`]: exactly the first at 0 and the last at [`CUTS`].
fn bernstein(k: usize) -> [f64; 4] {
    let t = k as f64 / CUTS as f64;
    let s = 1.0 - t;
    [s * s * s, 3.0 * (s * s * t), 3.0 * (s * t * t), t * t * t]
}

/// Random places in the box of half sizes `half` around 0, no two nearer than [`APART`] where there is room.
fn scatter(count: usize, half: DVec3, random: &mut Random) -> Vec<DVec3> {
    let mut places: Vec<DVec3> = Vec::with_capacity(count);
    // Cells as wide as the distance: what is too near is in the cell itself or next to it.
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    let cell = |p: DVec3| (p / APART).to_array().map(|v| v.floor() as i64);
    for k in 0..count {
        let mut place = DVec3::ZERO;
        for _ in 0..TRIES {
            let side = |random: &mut Random, half: f64| random.range(-half, half);
            place = DVec3::new(side(random, half.x), side(random, half.y), side(random, half.z));
            let [x, y, z] = cell(place);
            let around = (0..27).map(|n| [x + n / 9 - 1, y + n / 3 % 3 - 1, z + n % 3 - 1]);
            let mut near = around.filter_map(|key| cells.get(&key)).flatten();
            if near.all(|&other| (places[other] - place).length_squared() >= APART * APART) {
                break;
            }
        }
        cells.entry(cell(place)).or_default().push(k);
        places.push(place);
    }
    places
}

/// A turn, every one as likely as any other (K. Shoemake, *Uniform random rotations*, Graphics Gems III).
fn turn(random: &mut Random) -> Mat3 {
    let (share, a, b) = (random.unit(), random.range(0.0, TAU), random.range(0.0, TAU));
    let (p, q) = (libm::sqrt(1.0 - share), libm::sqrt(share));
    let (x, y, z, w) = (p * libm::sin(a), p * libm::cos(a), q * libm::sin(b), q * libm::cos(b));
    let vector = |x: f64, y: f64, z: f64| Vec3::new(x as f32, y as f32, z as f32);
    Mat3::from_cols(
        vector(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)),
        vector(2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)),
        vector(2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)),
    )
}

const TAU: f64 = std::f64::consts::TAU;

/// Keys of the walk; frames 25 to 90 of 120 lie between the two of [`BROADSIDE`], as in the paper.
const KEYS: usize = 24;
const BROADSIDE: (usize, usize) = (5, 18);

/// From one end, looking along the box, past the long side with the whole of it in view, to the other end, looking back.
fn walk(half: DVec3) -> CameraPath {
    let thin = half.y + 0.2;
    let key = |k: usize| {
        let (first, last) = BROADSIDE;
        let eye = if k < first || k > last {
            let (end, step) = if k < first { (-1.0, k) } else { (1.0, KEYS - k) };
            // Nearer from key to key, and a little to the side: new gaps open.
            let t = step as f64 / first as f64;
            DVec3::new(end * (half.x + thin * (3.0 - t)), thin * (0.3 - 0.2 * t), thin * (t - 0.3) * 0.8)
        } else {
            let t = (k - first) as f64 / (last - first) as f64;
            DVec3::new((t - 0.5) * 0.6 * half.x, thin * 0.6, thin + half.x * 1.45)
        };
        PathKey { eye, target: DVec3::ZERO }
    };
    CameraPath { fov_y_deg: 60.0, near: 0.02, far: None, up: DVec3::Y, keys: (0..=KEYS).map(key).collect() }
}
