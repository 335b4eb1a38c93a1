//! The surfaces of walls, floors and ceilings: the faces of the open boxes without the openings.
//!
//! Each face is cut along planes of its box. Where an opening touches a box, its edges are planes of it, and planes that cross an opening
//! belong to the boxes on both sides: so faces that share an edge share its vertices, to the bit, and there is no
//! T-junction. All surfaces have the same position, so that they are transformed alike. Objects are parts of faces up to ten metres
//! long. Cost: linear in the quads.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use glam::{DVec3, Vec3};

use super::super::solid::Solid;
use super::super::stock::{Rank, Stock};
use super::plan::{Kind, Opening, Plan, Point, Space, UNIT};

/// Length of an object's part of a face, in units.
const PART: i32 = 80;

/// Places the surfaces of all spaces.
pub(super) fn shell(stock: &mut Stock, plan: &Plan) {
    let planes = planes(plan);
    for (number, space) in plan.spaces.iter().enumerate() {
        for face in (0..6).filter(|&face| space.open >> face & 1 == 0) {
            let openings: Vec<&Opening> = plan.links[number].iter().map(|&o| &plan.openings[o]).collect();
            place_face(stock, space, &planes[number], face, &openings);
        }
    }
}

/// Where the faces of each space are cut, along each axis.
fn planes(plan: &Plan) -> Vec<[BTreeSet<i32>; 3]> {
    let of = |s: &Space| [0, 1, 2].map(|k| BTreeSet::from([s.min[k], s.max[k]]));
    let mut planes: Vec<[BTreeSet<i32>; 3]> = plan.spaces.iter().map(of).collect();
    let mut pending: VecDeque<usize> = (0..plan.openings.len()).collect();
    let mut waiting = vec![true; plan.openings.len()];
    while let Some(number) = pending.pop_front() {
        waiting[number] = false;
        let opening = &plan.openings[number];
        for k in (0..3).filter(|&k| k != opening.axis) {
            let both = opening.spaces.map(|s| &planes[s][k]);
            let mut inside: BTreeSet<i32> =
                both.iter().flat_map(|p| p.range(opening.min[k]..=opening.max[k])).copied().collect();
            inside.extend([opening.min[k], opening.max[k]]);
            for space in opening.spaces {
                let before = planes[space][k].len();
                planes[space][k].extend(&inside);
                if planes[space][k].len() > before {
                    for &link in &plan.links[space] {
                        if !std::mem::replace(&mut waiting[link], true) {
                            pending.push_back(link);
                        }
                    }
                }
            }
        }
    }
    planes
}

/// Places a face: bit 0 of its number is the side, the rest the axis.
fn place_face(stock: &mut Stock, space: &Space, planes: &[BTreeSet<i32>; 3], face: usize, openings: &[&Opening]) {
    let (axis, greater) = (face / 2, face % 2 == 1);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let at = if greater { space.max[axis] } else { space.min[axis] };
    let holes: Vec<&&Opening> = openings.iter().filter(|o| o.axis == axis && o.min[axis] == at).collect();
    let steps = |k: usize| planes[k].iter().copied().zip(planes[k].iter().copied().skip(1));
    let mut parts: BTreeMap<[i32; 2], Solid> = BTreeMap::new();
    for (u0, u1) in steps(u) {
        for (v0, v1) in steps(v) {
            let in_hole = |o: &Opening| o.min[u] <= u0 && u1 <= o.max[u] && o.min[v] <= v0 && v1 <= o.max[v];
            if holes.iter().any(|o| in_hole(o)) {
                continue;
            }
            let corner = |pu: i32, pv: i32| {
                let mut p: Point = [at; 3];
                (p[u], p[v]) = (pu, pv);
                Vec3::from_array(p.map(|c| (f64::from(c) / UNIT) as f32))
            };
            let mut corners = [corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)];
            if greater {
                corners.reverse();
            }
            let part = [(u0 - space.min[u]) / PART, (v0 - space.min[v]) / PART];
            parts.entry(part).or_default().quad(corners);
        }
    }
    for ([i, j], solid) in parts {
        let name = format!("{}/{}_{i}_{j}", space.name, FACES[face]);
        let mesh = stock.shape(solid);
        stock.place(Rank::Must, name, mesh, DVec3::ZERO, color(space, face));
    }
}

const FACES: [&str; 6] = ["west_wall", "east_wall", "floor", "ceiling", "north_wall", "south_wall"];

fn color(space: &Space, face: usize) -> [u8; 3] {
    let wall = face / 2 != 1;
    match space.kind {
        Kind::Outside if wall => [172, 142, 120],
        Kind::Outside if space.min[1] == 0 => [110, 134, 88],
        Kind::Outside => [120, 118, 116],
        Kind::Doorway | Kind::Window | Kind::Slab => [150, 128, 98],
        Kind::Room | Kind::Corridor | Kind::Stairwell if face == 2 => [158, 134, 104],
        Kind::Room | Kind::Corridor | Kind::Stairwell if face == 3 => [228, 226, 220],
        Kind::Corridor | Kind::Stairwell => [206, 204, 190],
        // Storeys and rooms differ a little.
        Kind::Room => {
            let shade = ((space.min[0] / 2 + space.min[2] / 3 + space.min[1]) % 5 * 7) as u8;
            [196 + shade, 200 + shade / 2, 188 + shade / 3]
        }
    }
}
