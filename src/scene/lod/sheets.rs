//! Sheets instead of solids: a viewer's ray needs one sheet to be stopped, a closed surface has two.
//!
//! Two sources of candidates, both judged by what they cover ([`silhouettes`](super::silhouettes)) and proven like all
//! else: *fins*, rectangles through the middle of the part's box and along its diagonals (thesis figure 7.1: a
//! building's two diagonals, which cover all of it for whom stands on the ground at its height), and surfaces from
//! which those triangles are *dropped* that the rest covers best. A thin slab becomes 2 triangles, a pipe 4. They must
//! be drawn from both sides.

use glam::{DVec3, Vec3};

use super::enclosure::Enclosure;
use super::silhouettes::{Cover, Frames};

/// Parts of the full size that a fin is tried with: the first that is proven counts.
const SIZES: [f64; 8] = [0.9995, 0.997, 0.98, 0.95, 0.9, 0.8, 0.65, 0.5];

/// A triangle by its corners.
pub(super) type Triangle = [Vec3; 3];

/// Heaps of fins that are proven to lie inside.
pub(super) fn fins(enclosure: &Enclosure, positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec<Triangle>> {
    let (middle, [u, v, w]) = frame(positions, triangles);
    let fit = |side: DVec3, other: DVec3| {
        SIZES.iter().find_map(|&size| {
            let corner = |s: f64, t: f64| (middle + (side * s + other * t) * size).as_vec3();
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let pair = vec![[a, b, c], [a, c, d]];
            pair.iter().all(|t| enclosure.contains(*t)).then_some(pair)
        })
    };
    // Across each axis one through the middle; along each axis the two diagonals.
    let across = [fit(v, w), fit(w, u), fit(u, v)];
    let along = [[fit(u, v + w), fit(u, v - w)], [fit(v, w + u), fit(v, w - u)], [fit(w, u + v), fit(w, u - v)]];
    let mut heaps = Vec::new();
    let mut offer = |fins: &[&Option<Vec<Triangle>>]| {
        if fins.iter().all(|fin| fin.is_some()) {
            heaps.push(fins.iter().flat_map(|fin| fin.iter().flatten()).copied().collect());
        }
    };
    for i in 0..3 {
        let (one, two) = (&across[i], &across[(i + 1) % 3]);
        offer(&[one]);
        offer(&[one, two]);
        offer(&[&along[i][0], &along[i][1]]);
        offer(&[&along[i][0], &along[i][1], one]);
        offer(&[&along[i][0]]);
        offer(&[&along[i][1]]);
    }
    offer(&[&across[0], &across[1], &across[2]]);
    heaps
}

/// Half the lengths of the sides of a box around a part.
pub(super) fn half_axes(positions: &[Vec3], triangles: &[[u32; 3]]) -> DVec3 {
    let [u, v, w] = frame(positions, triangles).1;
    DVec3::new(u.length(), v.length(), w.length())
}

/// Middle and half axes of a box around a part, along its largest triangle's normal and the largest at a right angle to
/// that.
fn frame(positions: &[Vec3], triangles: &[[u32; 3]]) -> (DVec3, [DVec3; 3]) {
    let mut normals: Vec<DVec3> = triangles
        .iter()
        .map(|t| t.map(|i| positions[i as usize].as_dvec3()))
        .map(|[a, b, c]| (b - a).cross(c - a))
        .collect();
    normals.sort_by(|m, n| n.length_squared().total_cmp(&m.length_squared()));
    let first = normals.first().map_or(DVec3::X, |n| n.normalize_or(DVec3::X));
    let upright = |n: &DVec3| n.dot(first).abs() < 1e-3 * n.length();
    let second = normals.into_iter().find(upright).unwrap_or_else(|| first.any_orthonormal_vector());
    let second = (second - first * second.dot(first)).normalize_or(first.any_orthonormal_vector());
    let axes = [first, second, first.cross(second)];
    let mut middle = DVec3::ZERO;
    let halves = axes.map(|axis| {
        let along = positions.iter().map(|p| p.as_dvec3().dot(axis));
        let (min, max) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        middle += axis * ((min + max) * 0.5);
        axis * ((max - min) * 0.5)
    });
    (middle, halves)
}

/// Triangles in the order in which they are dropped, each time the one that alone covers least; with what is covered
/// when as many as the index says have been dropped.
pub(super) fn drop_order(frames: &Frames, triangles: &[Triangle]) -> Vec<(usize, f64)> {
    let covers: Vec<Cover> = triangles.iter().map(|&t| frames.cover([t].into_iter())).collect();
    let mut alive: Vec<usize> = (0..triangles.len()).collect();
    let mut area = frames.area(&union(&covers, &alive));
    // What a triangle alone covers only grows as others go: an old figure is a lower bound.
    let mut alone = vec![0.0; triangles.len()];
    let mut order = Vec::with_capacity(triangles.len());
    while !alive.is_empty() {
        let once = once(&covers, &alive);
        let mut fresh = vec![false; triangles.len()];
        let least = loop {
            let Some(&t) = alive.iter().min_by(|&&s, &&t| f64::total_cmp(&alone[s], &alone[t])) else { break 0 };
            if fresh[t] {
                break t;
            }
            alone[t] = uncovered(frames, &covers[t], &once);
            fresh[t] = true;
        };
        order.push((least, area));
        area -= alone[least];
        alive.retain(|&t| t != least);
    }
    order
}

fn union(covers: &[Cover], alive: &[usize]) -> Cover {
    let mut all = Cover::empty();
    for &t in alive {
        all.rows_mut().iter_mut().zip(covers[t].rows()).for_each(|(a, b)| *a |= b);
    }
    all
}

/// Bits that exactly one covers.
fn once(covers: &[Cover], alive: &[usize]) -> Cover {
    let (mut some, mut more) = (Cover::empty(), Cover::empty());
    for &t in alive {
        for ((some, more), row) in some.rows_mut().iter_mut().zip(more.rows_mut()).zip(covers[t].rows()) {
            *more |= *some & row;
            *some |= row;
        }
    }
    some.rows_mut().iter_mut().zip(more.rows()).for_each(|(some, more)| *some &= !more);
    some
}

/// Area of the bits that a triangle covers and that are covered once.
fn uncovered(frames: &Frames, cover: &Cover, once: &Cover) -> f64 {
    let rows = cover.rows().iter().zip(once.rows()).enumerate();
    rows.map(|(row, (a, b))| f64::from((a & b).count_ones()) * frames.row_weight(row)).sum()
}
