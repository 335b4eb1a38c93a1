//! A mesh taken apart: corners welded where positions are equal, parts connected over edges, and which of them are
//! closed.
//!
//! A part is *closed* when every edge is passed as often in one direction as in the other (a cycle over the integers):
//! then it has a winding number about every point off it, and what winds is enclosed. That is checked on the triangles
//! as they are; where it fails, and facing does not matter, once more with triangles turned so that neighbours agree.
//! Self-intersecting parts and edges of four triangles are closed too: the winding number does not mind. Cost: n log n.

use glam::Vec3;

use super::super::Mesh;

/// Why a part of a mesh is not closed, and therefore not replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Open {
    /// An edge belongs to an odd number of triangles.
    Border,
    /// Every edge is shared, but triangles cannot be turned so that neighbours agree; or they could, but facing
    /// matters.
    Orientation,
    /// It is closed, but nothing was proven to lie inside: it is flat, or next to it, or winds the wrong way.
    NoRoom,
}

/// A connected part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Corners, into [`Parts::positions`]; outward faces counter-clockwise in a closed part that encloses a positive
    /// volume.
    pub triangles: Vec<[u32; 3]>,
    /// `None` for a closed part.
    pub open: Option<Open>,
}

/// A mesh in parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Distinct positions.
    pub positions: Vec<Vec3>,
    /// In order of their first triangles. Triangles with two equal corners are in none.
    pub parts: Vec<Part>,
}

impl Parts {
    /// Takes a mesh apart. With `turn`, triangles of a part may be turned to make it closed, and a part that is closed
    /// inside out is turned as a whole: right where both sides of the triangles are drawn.
    pub fn new(mesh: &Mesh, turn: bool) -> Parts {
        let (positions, triangles) = weld(mesh);
        let edges = Edges::new(&triangles);
        let of = edges.connected(triangles.len());
        let mut number = vec![u32::MAX; triangles.len()];
        let mut lists: Vec<Vec<u32>> = Vec::new();
        for t in 0..triangles.len() as u32 {
            let root = of[t as usize] as usize;
            if number[root] == u32::MAX {
                number[root] = lists.len() as u32;
                lists.push(Vec::new());
            }
            lists[number[root] as usize].push(t);
        }
        let parts =
            lists.iter().map(|list| part(&positions, list.iter().map(|&t| triangles[t as usize]).collect(), turn));
        let parts = parts.collect();
        Parts { positions, parts }
    }
}

/// Distinct positions (-0 is 0), and the triangles whose corners are three of them.
pub(super) fn weld(mesh: &Mesh) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let key = |v: Vec3| (v + 0.0).to_array().map(f32::to_bits);
    let at = |i: u32| key(mesh.positions()[i as usize]);
    let mut order: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    order.sort_by_key(|&i| (at(i), i));
    let mut first = vec![0u32; order.len()];
    let mut run = 0;
    for (k, &i) in order.iter().enumerate() {
        if k == 0 || at(i) != at(order[k - 1]) {
            run = i;
        }
        first[i as usize] = run;
    }
    let mut slot = vec![u32::MAX; order.len()];
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|i| first[i as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        triangles.push([a, b, c].map(|i| {
            if slot[i as usize] == u32::MAX {
                slot[i as usize] = positions.len() as u32;
                positions.push(mesh.positions()[i as usize] + 0.0);
            }
            slot[i as usize]
        }));
    }
    (positions, triangles)
}

/// The three directed edges of a triangle.
pub(super) fn edges_of([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Directed edges with their triangles, sorted by their two ends regardless of direction.
struct Edges(Vec<(u32, u32, bool, u32)>);

impl Edges {
    fn new(triangles: &[[u32; 3]]) -> Edges {
        let directed =
            |(t, tri): (usize, &[u32; 3])| edges_of(*tri).map(|(a, b)| (a.min(b), a.max(b), a < b, t as u32));
        let mut edges: Vec<_> = triangles.iter().enumerate().flat_map(directed).collect();
        edges.sort_unstable();
        Edges(edges)
    }

    /// The uses of one edge after the other.
    fn each(&self) -> impl Iterator<Item = &[(u32, u32, bool, u32)]> {
        self.0.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1))
    }

    /// For each triangle the least triangle that it is connected to over edges.
    fn connected(&self, triangles: usize) -> Vec<u32> {
        let mut parent: Vec<u32> = (0..triangles as u32).collect();
        for uses in self.each() {
            for pair in uses.windows(2) {
                let (a, b) = (root(&mut parent, pair[0].3), root(&mut parent, pair[1].3));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        (0..triangles as u32).map(|t| root(&mut parent, t)).collect()
    }

    fn is_cycle(&self) -> bool {
        self.each().all(|uses| 2 * uses.iter().filter(|e| e.2).count() == uses.len())
    }

    fn is_even(&self) -> bool {
        self.each().all(|uses| uses.len() % 2 == 0)
    }
}

/// The root of a union of trees, its way halved.
pub(super) fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Judges a part, and turns what may be turned.
fn part(positions: &[Vec3], mut triangles: Vec<[u32; 3]>, turn: bool) -> Part {
    let edges = Edges::new(&triangles);
    if !edges.is_even() {
        return Part { triangles, open: Some(Open::Border) };
    }
    let mut closed = edges.is_cycle();
    if !closed && turn {
        let turned = agree(&triangles, &edges);
        closed = Edges::new(&turned).is_cycle();
        if closed {
            triangles = turned;
        }
    }
    if !closed {
        return Part { triangles, open: Some(Open::Orientation) };
    }
    let volume = volume(positions, &triangles);
    if turn && volume < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let open = (volume == 0.0 || !turn && volume < 0.0).then_some(Open::NoRoom);
    Part { triangles, open }
}

/// Triangles turned so that the two of every edge of two agree with each other, as far as that goes.
fn agree(triangles: &[[u32; 3]], edges: &Edges) -> Vec<[u32; 3]> {
    let mut neighbours: Vec<Vec<(u32, bool)>> = vec![Vec::new(); triangles.len()];
    for uses in edges.each() {
        if let [e, f] = uses {
            let same = e.2 == f.2;
            neighbours[e.3 as usize].push((f.3, same));
            neighbours[f.3 as usize].push((e.3, same));
        }
    }
    let mut flip: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut stack = Vec::new();
    for seed in 0..triangles.len() {
        if flip[seed].is_some() {
            continue;
        }
        flip[seed] = Some(false);
        stack.push((seed as u32, false));
        while let Some((t, flipped)) = stack.pop() {
            for &(next, same) in &neighbours[t as usize] {
                if flip[next as usize].is_none() {
                    flip[next as usize] = Some(flipped != same);
                    stack.push((next, flipped != same));
                }
            }
        }
    }
    triangles.iter().zip(flip).map(|(&[a, b, c], f)| if f == Some(true) { [a, c, b] } else { [a, b, c] }).collect()
}

/// Enclosed volume, about the first corner, in f64: only its sign is used, and a wrong one only refuses the part.
fn volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let at = |i: u32| positions[i as usize].as_dvec3();
    let Some(first) = triangles.first() else { return 0.0 };
    let origin = at(first[0]);
    let tetrahedron = |t: &[u32; 3]| (at(t[0]) - origin).dot((at(t[1]) - origin).cross(at(t[2]) - origin));
    triangles.iter().map(tetrahedron).sum::<f64>() / 6.0
}
