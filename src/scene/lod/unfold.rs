//! Flat regions whose triangles fold over each other, triangulated anew within their outline.
//!
//! Exporters fan concave polygons: some triangles then lie outside the outline and are taken back by others that face
//! the other way. The winding number does not mind, but such a surface cannot be drawn in. Of each coplanar region with
//! a fold the outline is what edges do not cancel; if it is one ring, it is triangulated anew. Only the surface that
//! simplification begins with is changed so; what triangles are proven against stays the part as it is. Cost: n log n,
//! and that of ear clipping for folded regions.

use glam::Vec3;

use super::super::polygon::triangulate;
use super::parts::{edges_of, root};
use super::predicates::{side, turn};

/// The triangles of a closed part, without folds in flat regions of one outline.
pub(super) fn unfold(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let region = regions(positions, triangles);
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.sort_by_key(|&t| (region[t as usize], t));
    let mut out = Vec::with_capacity(triangles.len());
    for list in order.chunk_by(|&s, &t| region[s as usize] == region[t as usize]) {
        let own: Vec<[u32; 3]> = list.iter().map(|&t| triangles[t as usize]).collect();
        out.extend(anew(positions, &own).unwrap_or(own));
    }
    out
}

/// For each triangle the least of its coplanar region.
fn regions(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u32> {
    let at = |i: u32| positions[i as usize].as_dvec3();
    let edge = |(t, corners): (usize, &[u32; 3])| edges_of(*corners).map(|(a, b)| (a.min(b), a.max(b), t as u32));
    let mut edges: Vec<(u32, u32, u32)> = triangles.iter().enumerate().flat_map(edge).collect();
    edges.sort_unstable();
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    for uses in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let &[(_, _, s), (_, _, t)] = uses else { continue };
        let plane = triangles[s as usize].map(at);
        if triangles[t as usize].iter().all(|&i| side(plane, at(i)) == 0) {
            let (s, t) = (root(&mut parent, s), root(&mut parent, t));
            parent[s.max(t) as usize] = s.min(t);
        }
    }
    (0..triangles.len() as u32).map(|t| root(&mut parent, t)).collect()
}

/// A folded region of one outline, triangulated anew; `None` where there is no fold, or no such outline.
fn anew(positions: &[Vec3], own: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    let at = |i: u32| positions[i as usize].as_dvec3();
    let normal = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    let largest = own.iter().max_by(|s, t| normal(s).length_squared().total_cmp(&normal(t).length_squared()))?;
    let size = normal(largest).abs().to_array();
    let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j]))?;
    let turns = |t: &[u32; 3]| turn(at(t[0]), at(t[1]), at(t[2]), axis);
    if own.iter().all(|t| turns(t) == turns(largest)) {
        return None;
    }
    let ring = outline(own)?;
    let mut new = Vec::new();
    triangulate(positions, &ring, &mut new);
    let whole = new.len() + 2 == ring.len() && new.iter().all(|t| turns(t) == turns(&new[0]));
    whole.then_some(new)
}

/// The edges that are not passed both ways, if they form one ring.
fn outline(own: &[[u32; 3]]) -> Option<Vec<u32>> {
    let mut edges: Vec<(u32, u32, i32)> =
        own.iter().flat_map(|&t| edges_of(t)).map(|(a, b)| if a < b { (a, b, 1) } else { (b, a, -1) }).collect();
    edges.sort_unstable();
    let mut next: Vec<(u32, u32)> = Vec::new();
    for uses in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        match uses.iter().map(|e| e.2).sum::<i32>() {
            0 => {}
            1 => next.push((uses[0].0, uses[0].1)),
            -1 => next.push((uses[0].1, uses[0].0)),
            _ => return None,
        }
    }
    next.sort_unstable();
    if next.is_empty() || next.windows(2).any(|e| e[0].0 == e[1].0) {
        return None;
    }
    let mut ring = vec![next[0].0];
    for _ in 0..next.len() {
        let k = next.binary_search_by_key(&ring[ring.len() - 1], |e| e.0).ok()?;
        if next[k].1 == ring[0] {
            break;
        }
        ring.push(next[k].1);
    }
    (ring.len() == next.len()).then_some(ring)
}
