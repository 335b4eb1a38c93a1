//! Which cells each object is in: every cell that one of its triangles touches (Luebke and Georges 1995).
//!
//! Triangle against box by separating axes (Akenine-Moller 2001) in f64, faces of cells moved outwards by a millionth of their size:
//! an object on a wall is in the room that it faces. Cost: an exact test a triangle and cell whose boxes meet.

use glam::DVec3;

use super::{Cells, Hierarchy, PreparedScene};
use crate::geometry::Aabb;

/// The cells of each object of a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectCells {
    /// Cells by object, each object's in order.
    cells: Vec<u32>,
    /// Where those of each object begin, and the end.
    first: Vec<u32>,
}

/// Cells move outwards by this part of their size.
const OUTWARDS: f64 = 1e-6;

impl ObjectCells {
    /// Looks at every triangle of a scene. An object is in no cell when none of its triangles touches one, and also
    /// when something of it lies outside the box around all cells, or when it has no finite box: such an object is taken
    /// to be seen from anywhere.
    pub fn new(scene: &PreparedScene, cells: &Cells) -> ObjectCells {
        let index = CellIndex::new(cells, scene.origin);
        let mut out = ObjectCells { cells: Vec::new(), first: vec![0] };
        let mut found = Vec::new();
        for (object, occluder) in scene.occluders.iter().enumerate() {
            found.clear();
            index.around(scene.bounds[object], &mut found);
            // A box within one cell touches no other: cells do not overlap.
            let inside = found.len() == 1 && index.contains(found[0], scene.bounds[object]);
            if index.holds(scene.bounds[object]) && !inside {
                let wanted = std::mem::take(&mut found);
                let mut touched = vec![false; wanted.len()];
                for corners in scene.meshes.corners(occluder.mesh) {
                    let place = |v: glam::Vec3| {
                        let v = occluder.rotation.map_or(v, |r| super::model::rotate(r, v));
                        v.as_dvec3() + (occluder.position - scene.origin)
                    };
                    let triangle = corners.map(place);
                    for (&cell, touched) in wanted.iter().zip(&mut touched).filter(|(_, touched)| !**touched) {
                        let [min, max] = index.boxes[cell as usize];
                        *touched = triangle_touches(&triangle, min, max);
                    }
                }
                found.extend(wanted.iter().zip(touched).filter(|(_, touched)| *touched).map(|(&cell, _)| cell));
            } else if !inside {
                found.clear();
            }
            found.sort_unstable();
            out.cells.extend_from_slice(&found);
            out.first.push(out.cells.len() as u32);
        }
        out
    }

    /// The cells of an object; none when it is taken to be seen from anywhere.
    pub fn of(&self, object: u32) -> &[u32] {
        &self.cells[self.first[object as usize] as usize..self.first[object as usize + 1] as usize]
    }
}

/// Cells in a hierarchy, widened, about an origin.
struct CellIndex {
    boxes: Vec<[DVec3; 2]>,
    tree: Hierarchy,
    bounds: Vec<Aabb>,
    all: [DVec3; 2],
}

impl CellIndex {
    fn new(cells: &Cells, origin: DVec3) -> CellIndex {
        let widen = |min: DVec3, max: DVec3| {
            let out = DVec3::splat((max - min).max_element() * OUTWARDS);
            [min - origin - out, max - origin + out]
        };
        let boxes: Vec<[DVec3; 2]> = cells.cells().iter().map(|c| widen(c.min, c.max)).collect();
        let (min, max) = cells.bounds();
        let outward = |[min, max]: &[DVec3; 2]| Aabb { min: min.as_vec3(), max: max.as_vec3() }.outwards();
        let bounds: Vec<Aabb> = boxes.iter().map(outward).collect();
        CellIndex { tree: Hierarchy::build(&bounds), bounds, boxes, all: widen(min, max) }
    }

    /// Whether a box has points and lies in the box around all cells.
    fn holds(&self, b: Aabb) -> bool {
        let [min, max] = self.all;
        b.is_finite() && min.cmple(b.min.as_dvec3()).all() && b.max.as_dvec3().cmple(max).all()
    }

    /// Whether a box lies well within a cell, so that it touches it whatever is in it.
    fn contains(&self, cell: u32, b: Aabb) -> bool {
        let [min, max] = self.boxes[cell as usize];
        b.is_finite() && min.cmple(b.min.as_dvec3()).all() && b.max.as_dvec3().cmple(max).all()
    }

    /// Appends the cells whose widened boxes meet a box.
    fn around(&self, b: Aabb, out: &mut Vec<u32>) {
        let meets = |other: Aabb| b.min.cmple(other.max).all() && other.min.cmple(b.max).all();
        let mut stack = Vec::new();
        stack.extend((!self.tree.nodes.is_empty()).then_some(0u32));
        while let Some(node) = stack.pop().map(|n| &self.tree.nodes[n as usize]) {
            if !meets(node.bounds) {
                continue;
            }
            if node.is_leaf() {
                let ids = &self.tree.objects[node.first as usize..(node.first + node.count) as usize];
                out.extend(ids.iter().copied().filter(|&id| meets(self.bounds[id as usize])));
            } else {
                stack.extend([node.first, node.first + 1]);
            }
        }
    }
}

/// Whether a triangle and a box have a point in common, by thirteen axes: never false when they have, but for rounding.
pub(crate) fn triangle_touches(triangle: &[DVec3; 3], min: DVec3, max: DVec3) -> bool {
    let low = triangle[0].min(triangle[1]).min(triangle[2]);
    let high = triangle[0].max(triangle[1]).max(triangle[2]);
    if !(low.cmple(max).all() && min.cmple(high).all()) {
        return false;
    }
    let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let [a, b, c] = triangle.map(|p| p - center);
    let edges = [b - a, c - b, a - c];
    // Of a triangle with no area every axis below is zero, or one of a segment.
    let apart = |axis: DVec3| {
        let reach = half.dot(axis.abs());
        let [p, q, r] = [a, b, c].map(|v| v.dot(axis));
        p.min(q).min(r) > reach || p.max(q).max(r) < -reach
    };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    !apart(edges[0].cross(edges[1])) && !edges.iter().any(|&e| axes.iter().any(|&k| apart(e.cross(k))))
}
