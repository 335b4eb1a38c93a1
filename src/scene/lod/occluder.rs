//! Occluders of fewer triangles that cover nothing which their mesh does not (thesis 7.2, *conservative
//! occlusion-preserving simplification*).
//!
//! Closed parts are replaced by triangles strictly inside them ([`PartLevels`]), open ones keep their surface with
//! coplanar neighbours merged ([`merge_coplanar`]). Of each part there are several levels; a *price*, the area that a
//! triangle must bring, chooses among them, in one mesh or in all of a scene: small and convoluted parts go first,
//! large and plain ones stay. Cost: made once, n log n containment tests; choosing is a walk over the levels.

use glam::Vec3;

use super::super::Mesh;
use super::flat::{Merge, Merged, merge_coplanar};
use super::levels::PartLevels;
use super::parts::{Open, Parts};
use crate::raster::Facing;

/// A mesh's conservative levels.
#[derive(Debug, Clone, PartialEq)]
pub struct OccluderLevels {
    /// Levels of the closed parts, in the order of their first triangles.
    pub closed: Vec<PartLevels>,
    /// Open parts: why they are, and how many triangles they have.
    pub open: Vec<(Open, usize)>,
    /// The open parts, doubles dropped and coplanar neighbours merged.
    pub merged: Merged,
    positions: Vec<Vec3>,
    /// Triangles of the whole mesh.
    triangles: usize,
}

/// A conservative stand-in for a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifiedOccluder {
    /// Triangles strictly inside closed parts. To be drawn from both sides, and only where the eye is outside the
    /// mesh's box.
    pub inside: Mesh,
    /// The open parts, merged. To be drawn as the mesh itself is.
    pub open: Mesh,
    /// Whether `open` covers the same samples as the open parts do: no corner of an outline was dropped.
    pub open_is_sample_exact: bool,
    /// Triangles of the mesh: of its closed parts, and of its open ones.
    pub before: [usize; 2],
    /// Mean area that its closed parts cover, each for itself, and that `inside` does: over 26 directions, sampled, in
    /// square units.
    pub area: [f64; 2],
}

impl SimplifiedOccluder {
    /// Triangles of both meshes.
    pub fn triangles(&self) -> usize {
        self.inside.triangles().len() + self.open.triangles().len()
    }

    /// Both meshes in one: for objects that are drawn from both sides.
    pub fn joined(&self) -> Mesh {
        let shift = self.inside.positions().len() as u32;
        let positions = [self.inside.positions(), self.open.positions()].concat();
        let open = self.open.triangles().iter().map(|t| t.map(|i| i + shift));
        Mesh::from_checked(positions, self.inside.triangles().iter().copied().chain(open).collect())
    }
}

impl OccluderLevels {
    /// Of a mesh whose objects are drawn with `facing`.
    ///
    /// Drawn from both sides, parts may be turned to make them closed, and of open triangles with the same corners one is
    /// enough; drawn from the front, they count as they are; drawn from the back, all parts are treated as open. A part
    /// that is refused says why in [`open`](Self::open).
    pub fn new(mesh: &Mesh, facing: Facing, merge: Merge) -> OccluderLevels {
        let Parts { positions, parts } = Parts::new(mesh, facing == Facing::Both);
        let (mut closed, mut open, mut left) = (Vec::new(), Vec::new(), Vec::new());
        for part in parts {
            let mut reason = part.open.or((facing == Facing::Back).then_some(Open::Orientation));
            if reason.is_none() {
                let levels = PartLevels::new(&positions, &part.triangles);
                if levels.levels.is_empty() {
                    reason = Some(Open::NoRoom);
                } else {
                    closed.push(levels);
                }
            }
            if let Some(reason) = reason {
                open.push((reason, part.triangles.len()));
                left.extend(part.triangles);
            }
        }
        if facing == Facing::Both {
            without_doubles(&mut left);
        }
        let merged = merge_coplanar(&positions, &left, merge);
        OccluderLevels { closed, open, merged, positions, triangles: mesh.triangles().len() }
    }

    /// Triangles of the mesh.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Triangles of its closed parts.
    pub fn closed_triangles(&self) -> usize {
        self.closed.iter().map(|part| part.triangles).sum()
    }

    /// The levels whose triangles each bring at least `price`, in square units of mean covered area; 0 takes the
    /// finest.
    pub fn at(&self, price: f64) -> SimplifiedOccluder {
        let chosen: Vec<_> = self.closed.iter().filter_map(|part| part.at(price)).collect();
        let inside: Vec<[Vec3; 3]> = chosen.iter().flat_map(|level| level.triangles.iter().copied()).collect();
        let before = self.closed_triangles();
        SimplifiedOccluder {
            inside: soup(&inside),
            open: compact(&self.positions, &self.merged.triangles),
            open_is_sample_exact: self.merged.outline == 0,
            before: [before, self.open.iter().map(|part| part.1).sum()],
            area: [self.closed.iter().map(|part| part.area).sum(), chosen.iter().map(|level| level.area).sum()],
        }
    }

    /// The levels that cover most with at most `triangles` triangles in place of the closed parts.
    pub fn within(&self, triangles: usize) -> SimplifiedOccluder {
        self.at(price_within([self], triangles))
    }
}

/// The mesh with its closed parts at `ratio` of their triangles or fewer, 0 to 1, covering as much as that allows; its
/// open parts merged sample-exactly.
pub fn simplify_occluder(mesh: &Mesh, facing: Facing, ratio: f64) -> SimplifiedOccluder {
    let levels = OccluderLevels::new(mesh, facing, Merge::Inner);
    levels.within((levels.closed_triangles() as f64 * ratio) as usize)
}

/// The lowest price at which closed parts of many meshes have at most `triangles` triangles together.
///
/// Every triangle then brings at least as much as any that was left out would have, up to the last step. Areas are in
/// the meshes' own units.
pub fn price_within<'a>(meshes: impl IntoIterator<Item = &'a OccluderLevels>, triangles: usize) -> f64 {
    let mut steps: Vec<(f64, usize)> = Vec::new();
    for part in meshes.into_iter().flat_map(|mesh| &mesh.closed) {
        let mut before = 0;
        for level in &part.levels {
            steps.push((level.price, level.triangles.len() - before));
            before = level.triangles.len();
        }
    }
    steps.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut sum, mut lowest) = (0, f64::INFINITY);
    for equal in steps.chunk_by(|a, b| a.0 == b.0) {
        sum += equal.iter().map(|step| step.1).sum::<usize>();
        if sum > triangles {
            break;
        }
        lowest = equal[0].0;
    }
    lowest
}

/// Share of the closed parts' area that `triangles` triangles inside them cover, at most: a bound, however they are chosen.
///
/// Each covers at most [`PartLevels::most_a_triangle`] of its part, and all of a part at most the part.
pub fn most_within<'a>(meshes: impl IntoIterator<Item = &'a OccluderLevels>, triangles: usize) -> f64 {
    let mut parts: Vec<&PartLevels> = meshes.into_iter().flat_map(|mesh| &mesh.closed).collect();
    let whole: f64 = parts.iter().map(|part| part.area).sum();
    parts.sort_by(|p, q| q.most_a_triangle.total_cmp(&p.most_a_triangle));
    let (mut left, mut most) = (triangles as f64, 0.0);
    for part in parts {
        if part.most_a_triangle > 0.0 && left > 0.0 {
            let wanted = (part.area / part.most_a_triangle).min(left);
            most += wanted * part.most_a_triangle;
            left -= wanted;
        }
    }
    if whole > 0.0 { (most / whole).min(1.0) } else { 0.0 }
}

/// Drops all but the first of triangles with the same corners, whichever way they turn.
fn without_doubles(triangles: &mut Vec<[u32; 3]>) {
    let key = |t: &[u32; 3]| {
        let mut corners = *t;
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by_key(|&t| (key(&triangles[t]), t));
    let mut first: Vec<usize> =
        order.chunk_by(|&s, &t| key(&triangles[s]) == key(&triangles[t])).map(|same| same[0]).collect();
    first.sort_unstable();
    *triangles = first.into_iter().map(|t| triangles[t]).collect();
}

/// A mesh of triangles, equal corners shared.
fn soup(triangles: &[[Vec3; 3]]) -> Mesh {
    let key = |v: &Vec3| v.to_array().map(f32::to_bits);
    let mut positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    positions.sort_by_key(key);
    positions.dedup_by_key(|v| key(v));
    let slot = |v: Vec3| positions.partition_point(|p| key(p) < key(&v)) as u32;
    let indices = triangles.iter().map(|t| t.map(slot)).collect();
    Mesh::from_checked(positions, indices)
}

/// A mesh of some of the triangles over positions, without those that none uses.
fn compact(positions: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    let mut slots = vec![u32::MAX; positions.len()];
    let mut used = Vec::new();
    let indices = triangles
        .iter()
        .map(|t| {
            t.map(|i| {
                if slots[i as usize] == u32::MAX {
                    slots[i as usize] = used.len() as u32;
                    used.push(positions[i as usize]);
                }
                slots[i as usize]
            })
        })
        .collect();
    Mesh::from_checked(used, indices)
}
