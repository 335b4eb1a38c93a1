//! Walls inside a part, that nobody sees and nothing could pass: as where two boxes stand against each other.
//!
//! Two triangles with the same corners and opposite ways round cancel; so do two halved flat quadrilaterals with the same sides,
//! halved along whichever diagonals. What is left of a closed part winds as often about every point off the part, since what
//! cancels bounds no volume; and it belongs to the same surface, so what it covers the part covers. Cost: n log n.

use glam::Vec3;

use super::parts::edges_of;
use super::predicates::side;

/// The triangles of a closed part that are left when inner walls are gone, in the order in which they were.
pub(super) fn without_inner_walls(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut pieces: Vec<Piece> = (0..triangles.len()).map(|t| Piece::new(&[triangles[t]], &[t])).collect();
    let mut gone = vec![false; triangles.len()];
    cancel(&mut pieces, &mut gone);
    let mut pieces = quadrilaterals(positions, triangles, &gone);
    cancel(&mut pieces, &mut gone);
    (0..triangles.len()).filter(|&t| !gone[t]).map(|t| triangles[t]).collect()
}

/// A triangle, or two that make a quadrilateral: its sides in order, without regard to direction, and the triangles.
struct Piece {
    sides: Vec<(u32, u32)>,
    /// Whether the least side is passed upwards: of two pieces with the same sides this tells which way round each goes.
    upwards: bool,
    triangles: Vec<usize>,
}

impl Piece {
    fn new(corners: &[[u32; 3]], triangles: &[usize]) -> Piece {
        let edges: Vec<(u32, u32)> = corners.iter().flat_map(|&t| edges_of(t)).collect();
        let outer = edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a)));
        let mut sides: Vec<((u32, u32), bool)> = outer.map(|&(a, b)| ((a.min(b), a.max(b)), a < b)).collect();
        sides.sort_unstable();
        Piece {
            upwards: sides.first().is_some_and(|side| side.1),
            sides: sides.into_iter().map(|side| side.0).collect(),
            triangles: triangles.to_vec(),
        }
    }
}

/// Marks the triangles of pieces that have the same sides and go opposite ways round, pair by pair.
fn cancel(pieces: &mut [Piece], gone: &mut [bool]) {
    pieces.sort_by(|p, q| p.sides.cmp(&q.sides).then(p.triangles.cmp(&q.triangles)));
    for same in pieces.chunk_by(|p, q| p.sides == q.sides) {
        let (mut up, mut down) = (same.iter().filter(|p| p.upwards), same.iter().filter(|p| !p.upwards));
        while let (Some(p), Some(q)) = (up.next(), down.next()) {
            // A triangle may be half of two quadrilaterals.
            let both = || p.triangles.iter().chain(&q.triangles);
            if both().all(|&t| !gone[t]) {
                both().for_each(|&t| gone[t] = true);
            }
        }
    }
}

/// Pairs of triangles that lie in one plane, exactly, on the two sides of an edge that no other triangle has.
fn quadrilaterals(positions: &[Vec3], triangles: &[[u32; 3]], gone: &[bool]) -> Vec<Piece> {
    let at = |i: u32| positions[i as usize].as_dvec3();
    let left = (0..triangles.len()).filter(|&t| !gone[t]);
    let mut edges: Vec<((u32, u32), bool, usize)> =
        left.flat_map(|t| edges_of(triangles[t]).map(|(a, b)| ((a.min(b), a.max(b)), a < b, t))).collect();
    edges.sort_unstable();
    let mut pieces = Vec::new();
    for uses in edges.chunk_by(|e, f| e.0 == f.0) {
        let &[(_, up, s), (_, other, t)] = uses else { continue };
        let plane = triangles[s].map(at);
        if up != other && triangles[t].iter().all(|&i| side(plane, at(i)) == 0) {
            pieces.push(Piece::new(&[triangles[s], triangles[t]], &[s, t]));
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two boxes that share a square wall at x = 1, whose two copies are halved along these diagonals.
    fn boxes(same_diagonal: bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corner = |x: u32, y: u32, z: u32| 4 * x + 2 * y + z;
        let positions = (0..12).map(|i| Vec3::new((i / 4) as f32, (i / 2 % 2) as f32, (i % 2) as f32)).collect();
        let mut triangles = Vec::new();
        let mut quad = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
        for x in 0..2 {
            quad([corner(x, 0, 0), corner(x, 0, 1), corner(x, 1, 1), corner(x, 1, 0)]);
            let [a, b, c, d] = [corner(x + 1, 0, 0), corner(x + 1, 1, 0), corner(x + 1, 1, 1), corner(x + 1, 0, 1)];
            quad(if same_diagonal { [a, b, c, d] } else { [b, c, d, a] });
            quad([corner(x, 0, 0), corner(x + 1, 0, 0), corner(x + 1, 0, 1), corner(x, 0, 1)]);
            quad([corner(x, 1, 0), corner(x, 1, 1), corner(x + 1, 1, 1), corner(x + 1, 1, 0)]);
            quad([corner(x, 0, 0), corner(x, 1, 0), corner(x + 1, 1, 0), corner(x + 1, 0, 0)]);
            quad([corner(x, 0, 1), corner(x + 1, 0, 1), corner(x + 1, 1, 1), corner(x, 1, 1)]);
        }
        (positions, triangles)
    }

    #[test]
    fn the_wall_between_two_boxes_goes_however_it_is_halved() {
        for same_diagonal in [true, false] {
            let (positions, triangles) = boxes(same_diagonal);
            let left = without_inner_walls(&positions, &triangles);
            let in_wall = |t: &[u32; 3]| t.iter().all(|&i| positions[i as usize].x == 1.0);
            assert_eq!((triangles.len(), left.len()), (24, 20), "same diagonal: {same_diagonal}");
            assert!(!left.iter().any(in_wall), "same diagonal: {same_diagonal}");
        }
    }

    #[test]
    fn a_wall_that_is_not_flat_stays() {
        let (mut positions, triangles) = boxes(false);
        positions[4].x = 1.25;
        assert_eq!(without_inner_walls(&positions, &triangles).len(), 24);
    }
}
