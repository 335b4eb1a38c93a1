//! Redundant occluders (Zhang 1998, 7.1): a clock on a wall occludes little that the wall does not.
//!
//! The thesis found no satisfactory way to see this automatically; here it is sampled. Along each of 13 directions an object is
//! drawn alone, in parallel projection, and then what is larger, in a slab that reaches a little before and behind the
//! object. Where both cover a sample, a larger occluder crosses the line of sight *close by*: whatever the object hides there,
//! from either end, the larger one hides too, but for what fits into the gap, at most half the object's own extent deep. An
//! object is redundant when that holds of so large a part of its projected area over all directions. Mere containment in a
//! closed occluder, or being seen from nowhere, would not find the clock, and the slab is all that tells it from a lamp post in
//! front of a far wall. All is drawn two-sided: a closed wall is crossed, wherever its back may be, and nobody is meant to stand
//! behind an open one.
//!
//! Larger means a larger surface of the box, ties by id; only what is kept itself makes others redundant, so of a chain
//! of attached objects the largest stays, and of two equal boards one does. Objects are therefore looked at from the
//! largest down, on one thread. The bits do not depend on the SIMD level. Cost: 1 to 13 pairs of small pictures an object, some
//! tens of microseconds each; most objects are given up after a few.

use glam::{DMat4, DVec3, DVec4};
use homcull_simd::Level;

use super::statics::{extent, half_area};
use crate::error::Result;
use crate::geometry::Aabb;
use crate::occlusion::{Occluder, OcclusionBuffer, OcclusionSettings};
use crate::raster::Facing;
use crate::scene::{Hierarchy, PreparedScene};
use crate::view::{ClipSpace, View, Viewport};

/// Samples of a picture along a side: a tile.
const SIDE: u32 = 32;
/// How far the slab reaches beyond the object, over the object's extent.
const GAP: f32 = 0.5;

/// The objects of `ids` that are redundant beside others of `ids`: `part` is the least part of the projected area that is
/// covered by them too, 0 to 1.
pub(super) fn find_redundant(scene: &PreparedScene, ids: &[u32], part: f32) -> Result<Vec<u32>> {
    let mut kept = vec![Aabb::EMPTY; scene.bounds.len()];
    for &id in ids {
        kept[id as usize] = scene.bounds[id as usize];
    }
    let tree = Hierarchy::build(&kept);
    let size = |id: u32| half_area(scene.bounds[id as usize]);
    let mut order = ids.to_vec();
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
    // Nothing is larger than what has not been looked at yet.
    kept.fill(Aabb::EMPTY);
    let mut sampler = Sampler::new(scene)?;
    let mut redundant = Vec::new();
    let mut around = Vec::new();
    for id in order {
        let b = scene.bounds[id as usize];
        attached(&tree, &kept, grown(b, GAP * extent(b)), &mut around);
        if !around.is_empty() && sampler.is_redundant(id, &around, part)? {
            redundant.push(id);
        } else {
            kept[id as usize] = b;
        }
    }
    Ok(redundant)
}

fn grown(b: Aabb, by: f32) -> Aabb {
    Aabb { min: b.min - by, max: b.max + by }
}

/// What of `kept` meets a box, by the tree's order.
fn attached(tree: &Hierarchy, kept: &[Aabb], to: Aabb, out: &mut Vec<u32>) {
    out.clear();
    let meets = |b: Aabb| b.min.cmple(to.max).all() && to.min.cmple(b.max).all();
    let mut stack = vec![0];
    while let Some(node) = stack.pop().and_then(|n: u32| tree.nodes.get(n as usize)) {
        if !meets(node.bounds) {
            continue;
        }
        if node.is_leaf() {
            let ids = &tree.objects[node.first as usize..(node.first + node.count) as usize];
            out.extend(ids.iter().copied().filter(|&id| meets(kept[id as usize])));
        } else {
            stack.extend([node.first, node.first + 1]);
        }
    }
}

/// Lines of sight through an object, as directions to one of their ends: 13, level ones first, since they rule most objects out.
fn directions() -> Vec<DVec3> {
    let steps = [0.0, 1.0, -1.0];
    let all = steps.iter().flat_map(|&y| steps.iter().flat_map(move |&x| steps.map(|z| DVec3::new(x, y, z))));
    // Of two opposite ones the first has its first step that is not 0, in the order y, x, z, above 0.
    let first = |d: &DVec3| (d.y, d.x, d.z) > (0.0, 0.0, 0.0);
    all.filter(first).map(DVec3::normalize).collect()
}

struct Sampler<'s> {
    scene: &'s PreparedScene,
    buffer: OcclusionBuffer,
    directions: Vec<DVec3>,
    occluders: Vec<Occluder>,
}

impl Sampler<'_> {
    fn new(scene: &PreparedScene) -> Result<Sampler<'_>> {
        let viewport = Viewport::new(SIDE, SIDE)?;
        let buffer = OcclusionBuffer::with_level(viewport, Level::best(), OcclusionSettings::default())?;
        Ok(Sampler { scene, buffer, directions: directions(), occluders: Vec::new() })
    }

    fn is_redundant(&mut self, id: u32, around: &[u32], part: f32) -> Result<bool> {
        let b = self.scene.bounds[id as usize];
        let frames: Vec<Frame> = self.directions.iter().map(|&d| Frame::new(b, d)).collect();
        let mut to_come: f64 = frames.iter().map(Frame::area).sum();
        let (mut covered, mut open) = (0.0, 0.0);
        let spare = 1.0 - f64::from(part);
        for frame in &frames {
            let view = frame.view(self.scene.origin)?;
            let (alone, with_others) = (self.draw(&view, &[id])?, self.draw(&view, around)?);
            let a_sample = frame.area() / f64::from(SIDE * SIDE);
            for (own, others) in alone.iter().zip(with_others) {
                covered += f64::from((own & others).count_ones()) * a_sample;
                open += f64::from((own & !others).count_ones()) * a_sample;
            }
            to_come -= frame.area();
            if open > spare * (covered + open + to_come) {
                return Ok(false);
            }
        }
        Ok(covered > 0.0)
    }

    /// The samples that objects cover, a word a row.
    fn draw(&mut self, view: &View, objects: &[u32]) -> Result<[u32; SIDE as usize]> {
        self.occluders.clear();
        self.occluders
            .extend(objects.iter().map(|&id| Occluder { facing: Facing::Both, ..self.scene.occluders[id as usize] }));
        self.buffer.begin(view)?;
        self.buffer.submit(&self.scene.meshes, &self.occluders)?;
        let mut rows = [0; SIDE as usize];
        for (y, row) in (0..).zip(&mut rows) {
            for x in 0..SIDE {
                *row |= u32::from(self.buffer.covered(x, y) == Some(true)) << x;
            }
        }
        Ok(rows)
    }
}

/// A parallel projection that just holds a box, in a slab that reaches [`GAP`] extents beyond it.
struct Frame {
    center: DVec3,
    /// Right, up, and towards the viewer.
    axes: [DVec3; 3],
    /// Half sizes along them.
    half: [f64; 3],
}

impl Frame {
    fn new(b: Aabb, toward: DVec3) -> Frame {
        let (center, size) = ((b.min.as_dvec3() + b.max.as_dvec3()) * 0.5, (b.max - b.min).as_dvec3() * 0.5);
        let upward = if toward.y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
        let right = upward.cross(toward).normalize();
        let axes = [right, toward.cross(right), toward];
        // A flat box still has a frame.
        let half = axes.map(|a| a.abs().dot(size).max(1e-6 * size.length()));
        let gap = f64::from(GAP * extent(b));
        Frame { center, axes, half: [half[0], half[1], half[2] + gap] }
    }

    fn area(&self) -> f64 {
        4.0 * self.half[0] * self.half[1]
    }

    /// The view of it; the box is about `origin`.
    fn view(&self, origin: DVec3) -> Result<View> {
        let [right, up, toward] = self.axes;
        let [x, y, z] = self.half;
        // Depth is 1 where the slab begins and 0 where it ends.
        let rows = [(right / x).extend(0.0), (up / y).extend(0.0), (toward / (2.0 * z)).extend(0.5), DVec4::W];
        let matrix = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
        View::from_eye(origin + self.center, matrix, ClipSpace::REVERSED, Viewport::new(SIDE, SIDE)?)
    }
}
