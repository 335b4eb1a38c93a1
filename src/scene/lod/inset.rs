//! The part drawn in: its own triangles, every corner moved inwards by a hair.
//!
//! It is where simplification begins: a surface that is proven to lie strictly inside, except for triangles where no
//! depth of a few tried was proven, which are marked. The depth is a ten-thousandth of the part's diagonal, so what is
//! lost of its covered area is next to nothing; it buys strict tests, which need no case for touching surfaces. Cost: a
//! containment test a triangle and round.

use glam::{DVec3, Vec3};

use super::enclosure::Enclosure;

/// Depth over the diagonal of the part's box: 2^-13.
const DEPTH: f64 = 1.0 / 8192.0;
/// Depth at least, in units in the last place of the farthest coordinate: below, rounding decides where a corner goes.
const ULPS: f64 = 6.0;
/// What the depth is multiplied with from round to round, at corners of triangles that were not proven.
const ROUNDS: [f64; 6] = [1.0, 0.25, 4.0, 0.0625, 16.0, 0.5];

/// Different planes at a corner that are looked at: more are a cone's tip, where these will do.
const MOST_PLANES: usize = 64;

/// A surface in the making: corners into positions, and whether a triangle is proven to lie strictly inside.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub inside: Vec<bool>,
}

impl Surface {
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.positions[i as usize])
    }

    /// Corners of the triangles that are proven.
    pub fn proven(&self) -> impl Iterator<Item = [Vec3; 3]> + Clone {
        let pairs = self.triangles.iter().zip(&self.inside);
        pairs.filter(|(_, inside)| **inside).map(|(&t, _)| self.corners(t))
    }
}

/// Draws a closed part in. `positions` are those that its triangles use, and no others.
pub(super) fn inset(enclosure: &Enclosure, positions: &[Vec3], triangles: &[[u32; 3]]) -> Surface {
    let ways = inward(positions, triangles);
    let [min, max] = enclosure.bounds();
    let largest = min.abs().max(max.abs()).max_element();
    let depth = ((max - min).length() * DEPTH).max(largest * ULPS * f64::from(f32::EPSILON));
    let at = |i: usize, factor: f64| (positions[i].as_dvec3() + ways[i] * (depth * factor)).as_vec3();
    let mut surface = Surface {
        positions: (0..positions.len()).map(|i| at(i, 1.0)).collect(),
        triangles: triangles.to_vec(),
        inside: vec![false; triangles.len()],
    };
    // Where corners have changed since their triangle was last judged.
    let mut changed = vec![true; positions.len()];
    for round in 0..ROUNDS.len() {
        let mut again = vec![false; positions.len()];
        for t in 0..triangles.len() {
            let corners = triangles[t];
            if corners.iter().any(|&i| changed[i as usize]) {
                surface.inside[t] = enclosure.contains(surface.corners(corners));
            }
            if !surface.inside[t] {
                corners.iter().for_each(|&i| again[i as usize] = true);
            }
        }
        let Some(&factor) = ROUNDS.get(round + 1).filter(|_| again.contains(&true)) else { break };
        for i in (0..positions.len()).filter(|&i| again[i]) {
            surface.positions[i] = at(i, factor);
        }
        changed = again;
    }
    surface
}

/// For each corner a way that goes 1 below the plane of each of its triangles, where there is one that is not much
/// longer.
fn inward(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals: Vec<Vec<DVec3>> = vec![Vec::new(); positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| positions[i as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for &i in t {
            let of_corner = &mut normals[i as usize];
            if of_corner.len() < MOST_PLANES
                && normal != DVec3::ZERO
                && of_corner.iter().all(|n| n.dot(normal) < 1.0 - 1e-9)
            {
                of_corner.push(normal);
            }
        }
    }
    normals.iter().map(|of_corner| below_all(of_corner)).collect()
}

/// Projections onto one half-space after the other.
fn below_all(normals: &[DVec3]) -> DVec3 {
    let mut way = DVec3::ZERO;
    for _ in 0..24 {
        let before = way;
        for n in normals {
            way -= *n * (n.dot(way) + 1.0).max(0.0);
        }
        if way == before {
            break;
        }
    }
    let length = way.length();
    if length > 8.0 { way * (8.0 / length) } else { way }
}
