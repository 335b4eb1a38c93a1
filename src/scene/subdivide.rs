//! Subdivision of polygon soup and of oversized objects (thesis 8.2.1).
//!
//! Triangles are sorted into boxes by their centroids, and never cut: the box around the centroids is split into M x N x P
//! cube-shaped sub-boxes, each the same way, until few enough triangles are left or the depth is reached. Sub-boxes do not
//! overlap in centroids, the parts' own boxes may. Cost: one pass over the triangles a level.

use glam::DVec3;

use super::{Mesh, Object, Scene};

/// When to stop splitting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Subdivision {
    /// Objects of more triangles are split, and so are their parts. At least 1 is taken.
    pub max_triangles: usize,
    /// Levels of splitting, at most: the end for centroids that no box can part.
    pub max_depth: usize,
}

impl Default for Subdivision {
    /// 8,000 triangles, 16 levels.
    fn default() -> Subdivision {
        Subdivision { max_triangles: 8000, max_depth: 16 }
    }
}

impl Subdivision {
    /// For a model that is one object: parts small enough to be culled apart, large enough that their boxes pay.
    pub const SOUP: Subdivision = Subdivision { max_triangles: 500, max_depth: 16 };
}

/// The scene with every oversized object replaced, in place, by its parts `name#0`, `name#1` and so on. Objects that share
/// a mesh share its parts. The rest is untouched.
pub fn subdivide(scene: Scene, limits: &Subdivision) -> Scene {
    let Scene { name, meshes: whole, objects, cells } = scene;
    let mut whole: Vec<Option<Mesh>> = whole.into_iter().map(Some).collect();
    // Where the parts of each mesh are in the new list; made on first use, so that unused meshes are not split.
    let mut parts: Vec<Option<std::ops::Range<u32>>> = vec![None; whole.len()];
    let mut meshes = Vec::with_capacity(whole.len());
    let mut split = Vec::with_capacity(objects.len());
    for object in objects {
        let index = object.mesh as usize;
        let Some(known) = parts.get_mut(index) else { continue };
        let range = known.get_or_insert_with(|| {
            let first = meshes.len() as u32;
            meshes.extend(whole[index].take().into_iter().flat_map(|mesh| split_mesh(mesh, limits)));
            first..meshes.len() as u32
        });
        if range.len() == 1 {
            split.push(Object { mesh: range.start, ..object });
        } else {
            let part = |(k, mesh)| Object { name: format!("{}#{k}", object.name), mesh, ..object.clone() };
            split.extend(range.clone().enumerate().map(part));
        }
    }
    Scene { name, meshes, objects: split, cells }
}

fn split_mesh(mesh: Mesh, limits: &Subdivision) -> Vec<Mesh> {
    let triangles = mesh.triangles();
    if triangles.len() <= limits.max_triangles.max(1) {
        return vec![mesh];
    }
    let centroid = |t: &[u32; 3]| {
        let corner = |i: usize| mesh.positions()[t[i] as usize].as_dvec3();
        (corner(0) + corner(1) + corner(2)) / 3.0
    };
    let centroids: Vec<DVec3> = triangles.iter().map(centroid).collect();
    let mut extractor = Extractor { mesh: &mesh, slots: vec![u32::MAX; mesh.positions().len()] };
    let mut parts = Vec::new();
    let mut stack = vec![((0..triangles.len() as u32).collect::<Vec<u32>>(), 0)];
    while let Some((ids, depth)) = stack.pop() {
        let grid = if ids.len() > limits.max_triangles.max(1) && depth < limits.max_depth {
            Grid::around(&centroids, &ids)
        } else {
            None
        };
        match grid {
            None => parts.push(extractor.part(&ids)),
            Some(grid) => {
                // Pushed last first, so that parts are numbered along x, then y, then z.
                let cells = grid.deal(&centroids, &ids);
                stack.extend(cells.into_iter().rev().filter(|cell| !cell.is_empty()).map(|cell| (cell, depth + 1)));
            }
        }
    }
    parts
}

/// M x N x P sub-boxes of the box around some centroids.
struct Grid {
    min: DVec3,
    size: DVec3,
    cells: [usize; 3],
}

impl Grid {
    /// `None` when all centroids are in one place. The longest side gets at least two cells, so the two centroids at its
    /// ends always part; the edge of a cell is the middle side, within a half and an eighth of the longest.
    fn around(centroids: &[DVec3], ids: &[u32]) -> Option<Grid> {
        let points = ids.iter().map(|&id| centroids[id as usize]);
        let (min, max) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let size = max - min;
        let mut sides = size.to_array();
        sides.sort_by(f64::total_cmp);
        let edge = sides[1].clamp(sides[2] / 8.0, sides[2] / 2.0);
        let along = |side: f64| if edge > 0.0 { ((side / edge).round() as usize).clamp(1, 8) } else { 1 };
        let cells = size.to_array().map(along);
        (cells.iter().product::<usize>() > 1).then_some(Grid { min, size, cells })
    }

    fn deal(&self, centroids: &[DVec3], ids: &[u32]) -> Vec<Vec<u32>> {
        let mut dealt = vec![Vec::new(); self.cells.iter().product()];
        for &id in ids {
            let offset = centroids[id as usize] - self.min;
            let at = |axis: usize| {
                let n = self.cells[axis];
                if n == 1 { 0 } else { ((offset[axis] / self.size[axis] * n as f64) as usize).min(n - 1) }
            };
            dealt[(at(0) * self.cells[1] + at(1)) * self.cells[2] + at(2)].push(id);
        }
        dealt
    }
}

/// Makes meshes of some of a mesh's triangles, each with its own vertices only.
struct Extractor<'a> {
    mesh: &'a Mesh,
    /// For each vertex of the mesh its place in the part at hand; `u32::MAX` between parts.
    slots: Vec<u32>,
}

impl Extractor<'_> {
    fn part(&mut self, ids: &[u32]) -> Mesh {
        let mut used = Vec::new();
        let mut own = |v: u32| {
            let slot = &mut self.slots[v as usize];
            if *slot == u32::MAX {
                *slot = used.len() as u32;
                used.push(v);
            }
            *slot
        };
        let triangles = ids.iter().map(|&id| self.mesh.triangles()[id as usize].map(&mut own)).collect();
        let positions = used.iter().map(|&v| self.mesh.positions()[v as usize]).collect();
        for v in used {
            self.slots[v as usize] = u32::MAX;
        }
        Mesh::from_checked(positions, triangles)
    }
}
