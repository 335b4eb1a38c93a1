//! Meshes prepared for the rasterizer: clusters of at most 32 vertices and 64 triangles.
//!
//! A cluster's transformed vertices fit two vectors, and triangles fetch them by 8-bit indices: each vertex is transformed
//! once, and no position is gathered from memory. Clusters grow greedily over shared vertices, so that they are compact on the
//! screen and can be dropped whole when hidden.

use glam::Vec3;

use crate::error::{Error, Result};
use crate::geometry::Aabb;

/// Vertices of a cluster, at most.
pub const MAX_CLUSTER_VERTICES: usize = 32;
/// Triangles of a cluster, at most.
pub const MAX_CLUSTER_TRIANGLES: usize = 64;

/// A mesh in a [`PreparedMeshes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MeshId(pub(crate) u32);

impl MeshId {
    /// The mesh that was added as number `index`, from 0.
    pub fn from_index(index: u32) -> MeshId {
        MeshId(index)
    }
}

/// Sixteen vertices, by component. Places past the end repeat the last vertex.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct VertexGroup {
    pub x: [f32; 16],
    pub y: [f32; 16],
    pub z: [f32; 16],
}

/// Sixteen triangles by the cluster's own vertex numbers, in the order that is positive on a screen whose y points down.
/// Places past the end have no area.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct TriangleBatch {
    pub corners: [[u8; 16]; 3],
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Cluster {
    pub first_group: u32,
    pub first_batch: u32,
    pub groups: u8,
    pub batches: u8,
    pub triangles: u8,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct MeshRange {
    pub first_cluster: u32,
    pub end_cluster: u32,
    pub triangles: u32,
}

/// Meshes ready for the rasterizer. Made once; read from any number of threads.
#[derive(Debug, Clone, Default)]
pub struct PreparedMeshes {
    pub(crate) meshes: Vec<MeshRange>,
    /// Boxes around the vertices of their triangles.
    bounds: Vec<Aabb>,
    pub(crate) clusters: Vec<Cluster>,
    pub(crate) groups: Vec<VertexGroup>,
    pub(crate) batches: Vec<TriangleBatch>,
    /// The mesh's own triangle number of each place in the batches.
    pub(crate) numbers: Vec<[i32; 16]>,
}

impl PreparedMeshes {
    /// No meshes yet.
    pub fn new() -> PreparedMeshes {
        PreparedMeshes::default()
    }

    /// Adds a mesh: positions in its own space, triangles as indices into them, counter-clockwise in front.
    ///
    /// # Errors
    /// [`Error::Mesh`] for a position that is not finite, an index out of range, or more data than 32 bits count.
    pub fn add(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<MeshId> {
        self.check(positions, triangles)?;
        let first_cluster = self.clusters.len() as u32;
        let mut growth = Growth::new(positions.len(), triangles);
        while let Some((vertices, members)) = growth.next_cluster(triangles) {
            self.push_cluster(positions, triangles, &vertices, &members);
        }
        Ok(self.finish_mesh(first_cluster, triangles.len()))
    }

    /// Adds a mesh as [`PreparedMeshes::add`] does, but takes the triangles as they come: faster, without memory of its own, and
    /// with clusters as good as the order is.
    ///
    /// # Errors
    /// As for [`PreparedMeshes::add`].
    pub fn add_in_order(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<MeshId> {
        self.check(positions, triangles)?;
        let first_cluster = self.clusters.len() as u32;
        let mut rest = 0..triangles.len();
        while !rest.is_empty() {
            let (mut vertices, mut members) = ([0; MAX_CLUSTER_VERTICES], [0; MAX_CLUSTER_TRIANGLES]);
            let (mut v, mut m) = (0, 0);
            while m < MAX_CLUSTER_TRIANGLES && v + 3 <= MAX_CLUSTER_VERTICES {
                let Some(t) = rest.next() else { break };
                for corner in triangles[t] {
                    if !vertices[..v].contains(&corner) {
                        vertices[v] = corner;
                        v += 1;
                    }
                }
                members[m] = t as u32;
                m += 1;
            }
            self.push_cluster(positions, triangles, &vertices[..v], &members[..m]);
        }
        Ok(self.finish_mesh(first_cluster, triangles.len()))
    }

    /// Forgets all meshes, but keeps the memory.
    pub fn clear(&mut self) {
        self.meshes.clear();
        self.bounds.clear();
        self.clusters.clear();
        self.groups.clear();
        self.batches.clear();
        self.numbers.clear();
    }

    fn finish_mesh(&mut self, first_cluster: u32, triangles: usize) -> MeshId {
        let range = MeshRange { first_cluster, end_cluster: self.clusters.len() as u32, triangles: triangles as u32 };
        self.meshes.push(range);
        self.bounds.push(self.bounds_from(first_cluster));
        MeshId(self.meshes.len() as u32 - 1)
    }

    fn check(&self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<()> {
        let fail = |reason: String| Err(Error::Mesh { object: format!("mesh {}", self.meshes.len()), reason });
        if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
            return fail(format!("vertex {i} is not finite: {}", positions[i]));
        }
        if let Some(t) = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= positions.len())) {
            return fail(format!(
                "triangle {t} has indices {:?}, but there are {} vertices",
                triangles[t],
                positions.len()
            ));
        }
        let total = self.groups.len().max(self.batches.len()) + triangles.len();
        if u32::try_from(total).is_err() || u32::try_from(self.meshes.len()).is_err() {
            return fail("more clusters than 32 bits count".into());
        }
        Ok(())
    }

    /// Whether this mesh has been added.
    pub fn contains(&self, mesh: MeshId) -> bool {
        (mesh.0 as usize) < self.meshes.len()
    }

    /// The box around all clusters from one on. Places past the end of a group repeat a vertex.
    fn bounds_from(&self, first_cluster: u32) -> Aabb {
        let Some(cluster) = self.clusters.get(first_cluster as usize) else { return Aabb::EMPTY };
        let mut bounds = Aabb::EMPTY;
        for group in &self.groups[cluster.first_group as usize..] {
            for (axis, side) in [&group.x, &group.y, &group.z].into_iter().enumerate() {
                bounds.min[axis] = side.iter().fold(bounds.min[axis], |a, &b| a.min(b));
                bounds.max[axis] = side.iter().fold(bounds.max[axis], |a, &b| a.max(b));
            }
        }
        bounds
    }

    /// The box around a mesh's triangles, in its own space; [`Aabb::EMPTY`] when it has none.
    pub fn bounds(&self, mesh: MeshId) -> Aabb {
        self.bounds[mesh.0 as usize]
    }

    /// Triangles of a mesh.
    pub fn triangles(&self, mesh: MeshId) -> u32 {
        self.meshes[mesh.0 as usize].triangles
    }

    /// Corners of a mesh's triangles, in the order in which they were given, counter-clockwise in front.
    pub fn corners(&self, mesh: MeshId) -> Vec<[Vec3; 3]> {
        let range = &self.meshes[mesh.0 as usize];
        let mut out = vec![[Vec3::ZERO; 3]; range.triangles as usize];
        for cluster in &self.clusters[range.first_cluster as usize..range.end_cluster as usize] {
            let at = |corner: u8| {
                let (group, lane) =
                    (&self.groups[cluster.first_group as usize + usize::from(corner / 16)], corner % 16);
                let lane = usize::from(lane);
                Vec3::new(group.x[lane], group.y[lane], group.z[lane])
            };
            for t in 0..usize::from(cluster.triangles) {
                let (batch, lane) = (cluster.first_batch as usize + t / 16, t % 16);
                // Stored clockwise: two corners change places again.
                let [a, c, b] = self.batches[batch].corners.map(|side| at(side[lane]));
                out[self.numbers[batch][lane] as usize] = [a, b, c];
            }
        }
        out
    }

    fn push_cluster(&mut self, positions: &[Vec3], triangles: &[[u32; 3]], vertices: &[u32], members: &[u32]) {
        let cluster = Cluster {
            first_group: self.groups.len() as u32,
            first_batch: self.batches.len() as u32,
            groups: vertices.len().div_ceil(16) as u8,
            batches: members.len().div_ceil(16) as u8,
            triangles: members.len() as u8,
        };
        for group in vertices.chunks(16) {
            let at = |lane: usize| positions[group[lane.min(group.len() - 1)] as usize];
            self.groups.push(VertexGroup {
                x: std::array::from_fn(|l| at(l).x),
                y: std::array::from_fn(|l| at(l).y),
                z: std::array::from_fn(|l| at(l).z),
            });
        }
        let local = |v: u32| vertices.iter().position(|&u| u == v).unwrap_or(0) as u8;
        for batch in members.chunks(16) {
            let mut corners = [[0; 16]; 3];
            let mut numbers = [0; 16];
            for (lane, &t) in batch.iter().enumerate() {
                let [a, b, c] = triangles[t as usize];
                // Counter-clockwise with y up is clockwise with y down: two corners change places.
                (corners[0][lane], corners[1][lane], corners[2][lane]) = (local(a), local(c), local(b));
                numbers[lane] = t as i32;
            }
            self.batches.push(TriangleBatch { corners });
            self.numbers.push(numbers);
        }
        self.clusters.push(cluster);
    }
}

/// Greedy growth of clusters: the neighbour that brings the fewest new vertices next.
struct Growth {
    /// Triangles around each vertex, as one list and where each vertex's part begins.
    around: Vec<u32>,
    begins: Vec<u32>,
    done: Vec<bool>,
    inside: Vec<bool>,
    next: usize,
}

impl Growth {
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Growth {
        let mut begins = vec![0u32; vertices + 1];
        for &v in triangles.iter().flatten() {
            begins[v as usize + 1] += 1;
        }
        for i in 0..vertices {
            begins[i + 1] += begins[i];
        }
        let mut at = begins.clone();
        let mut around = vec![0; triangles.len() * 3];
        for (t, triangle) in triangles.iter().enumerate() {
            for &v in triangle {
                around[at[v as usize] as usize] = t as u32;
                at[v as usize] += 1;
            }
        }
        Growth { around, begins, done: vec![false; triangles.len()], inside: vec![false; vertices], next: 0 }
    }

    /// The vertices and triangles of the next cluster.
    fn next_cluster(&mut self, triangles: &[[u32; 3]]) -> Option<(Vec<u32>, Vec<u32>)> {
        self.skip_done();
        if self.next == triangles.len() {
            return None;
        }
        let (mut vertices, mut members) = (Vec::new(), Vec::new());
        let mut candidate = Some(self.next as u32);
        while let Some(t) = candidate {
            self.done[t as usize] = true;
            members.push(t);
            for &v in &triangles[t as usize] {
                if !std::mem::replace(&mut self.inside[v as usize], true) {
                    vertices.push(v);
                }
            }
            candidate = if members.len() < MAX_CLUSTER_TRIANGLES { self.best(triangles, &vertices) } else { None };
        }
        for &v in &vertices {
            self.inside[v as usize] = false;
        }
        Some((vertices, members))
    }

    fn skip_done(&mut self) {
        while self.next < self.done.len() && self.done[self.next] {
            self.next += 1;
        }
    }

    fn best(&mut self, triangles: &[[u32; 3]], vertices: &[u32]) -> Option<u32> {
        /// Triangles looked at around one vertex: fans of thousands must not make this quadratic.
        const MOST_AROUND: usize = 64;
        let mut best: Option<(usize, u32)> = None;
        for &v in vertices {
            let (from, to) = (self.begins[v as usize] as usize, self.begins[v as usize + 1] as usize);
            for &t in self.around[from..to].iter().filter(|&&t| !self.done[t as usize]).take(MOST_AROUND) {
                let mut corners = triangles[t as usize];
                corners.sort_unstable();
                let new = (0..3)
                    .filter(|&k| !self.inside[corners[k] as usize] && (k == 0 || corners[k] != corners[k - 1]))
                    .count();
                if vertices.len() + new <= MAX_CLUSTER_VERTICES && best.is_none_or(|(fewest, _)| new < fewest) {
                    best = Some((new, t));
                    if new == 0 {
                        return Some(t);
                    }
                }
            }
        }
        if best.is_none() {
            self.skip_done();
            if self.next < triangles.len() && vertices.len() + 3 <= MAX_CLUSTER_VERTICES {
                return Some(self.next as u32);
            }
        }
        best.map(|(_, t)| t)
    }
}
