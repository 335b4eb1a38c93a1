//! The rasterizer at work: one thread, one band of the screen, one sink.

use std::marker::PhantomData;

use glam::Mat3;
use homcull_simd::{Kernel, Simd, prefetch};

use super::facing::Facing;
use super::mesh::{Cluster, MeshId, PreparedMeshes};
use super::queue::Queues;
use super::sink::{Sink, Surface};
use super::transform::ObjectRows;

/// A mesh to be drawn, and how.
#[derive(Debug, Clone, Copy)]
pub struct Placement<'p> {
    /// Which mesh.
    pub mesh: MeshId,
    /// The view's rows for the object's position.
    pub rows: &'p ObjectRows,
    /// Applied to the mesh before its position; `None` is the identity.
    pub rotation: Option<Mat3>,
    /// Which side is drawn.
    pub facing: Facing,
    /// Number of the mesh's first triangle; the others count on from it.
    pub first_triangle: u32,
}

/// What a rasterizer did, in exact counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RasterCounts {
    /// Triangles submitted.
    pub triangles: u64,
    /// Triangles of clusters that were dropped whole: off the band, or hidden.
    pub dropped_in_clusters: u64,
    /// Small triangles that reached the kernel.
    pub small: u64,
    /// Large triangles and clipped polygons that reached the kernel.
    pub large: u64,
    /// Triangles that were clipped.
    pub clipped: u64,
}

impl std::ops::AddAssign for RasterCounts {
    fn add_assign(&mut self, o: RasterCounts) {
        self.triangles += o.triangles;
        self.dropped_in_clusters += o.dropped_in_clusters;
        self.small += o.small;
        self.large += o.large;
        self.clipped += o.clipped;
    }
}

/// The rasterizer of one band.
pub(crate) struct Engine<'q, S, K> {
    pub simd: S,
    pub sink: K,
    pub queues: &'q mut Queues,
    pub counts: RasterCounts,
    /// Whether clusters are tested against the surface before their triangles are looked at.
    pub cluster_test: bool,
}

/// Entered as kernels of their own: the code of the rasterizer would otherwise stand in every place that draws.
struct Mesh<'e, 'q, 'a, S, K>(&'e mut Engine<'q, S, K>, &'e PreparedMeshes, &'e Placement<'e>, PhantomData<&'a ()>);
struct Small<'e, 'q, 'a, S, K>(&'e mut Engine<'q, S, K>, PhantomData<&'a ()>);
struct Large<'e, 'q, 'a, S, K>(&'e mut Engine<'q, S, K>, PhantomData<&'a ()>);
struct Clipped<'e, 'q, 'a, S, K>(&'e mut Engine<'q, S, K>, [usize; 3], Facing, u32, PhantomData<&'a ()>);

impl<'a, S0: Simd, K: Sink<'a>> Kernel for Mesh<'_, '_, 'a, S0, K> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.draw_mesh(self.1, self.2);
    }
}

impl<'a, S0: Simd, K: Sink<'a>> Kernel for Small<'_, '_, 'a, S0, K> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.draw_small();
    }
}

impl<'a, S0: Simd, K: Sink<'a>> Kernel for Large<'_, '_, 'a, S0, K> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.draw_large();
    }
}

impl<'a, S0: Simd, K: Sink<'a>> Kernel for Clipped<'_, '_, 'a, S0, K> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.0.draw_clipped(self.1, self.2, self.3);
    }
}

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// Draws one triangle that has to be clipped, in a function of its own.
    #[inline(always)]
    pub fn run_clipped(&mut self, corners: [usize; 3], facing: Facing, id: u32) {
        self.simd.vectorize(Clipped(self, corners, facing, id, PhantomData));
    }

    /// Draws all triangles of a mesh; some may stay in the queues until [`Engine::flush`].
    #[inline(always)]
    pub fn draw(&mut self, meshes: &PreparedMeshes, placement: &Placement<'_>) {
        self.simd.vectorize(Mesh(self, meshes, placement, PhantomData));
    }

    #[inline(always)]
    fn draw_mesh(&mut self, meshes: &PreparedMeshes, placement: &Placement<'_>) {
        let range = meshes.meshes[placement.mesh.0 as usize];
        self.counts.triangles += u64::from(range.triangles);
        for cluster in &meshes.clusters[range.first_cluster as usize..range.end_cluster as usize] {
            self.draw_cluster(meshes, cluster, placement);
        }
    }

    /// Draws what waits in the queues.
    #[inline(always)]
    pub fn flush(&mut self) {
        while self.queues.small.len > 0 {
            self.run_small();
        }
        while self.queues.large.len > 0 {
            self.run_large();
        }
    }

    /// Draws the first sixteen small triangles of the queue, in a function of its own.
    #[inline(always)]
    pub fn run_small(&mut self) {
        self.simd.vectorize(Small(self, PhantomData));
    }

    /// Draws the first sixteen large triangles of the queue, in a function of its own.
    #[inline(always)]
    pub fn run_large(&mut self) {
        self.simd.vectorize(Large(self, PhantomData));
    }

    #[inline(always)]
    fn draw_cluster(&mut self, meshes: &PreparedMeshes, cluster: &Cluster, placement: &Placement<'_>) {
        let s = self.simd;
        self.queues.vertices.transform(s, meshes, cluster, placement.rows, placement.rotation.as_ref());
        if !self.queues.vertices.any_outside && !self.cluster_may_show(usize::from(cluster.groups)) {
            self.counts.dropped_in_clusters += u64::from(cluster.triangles);
            return;
        }
        for batch in 0..usize::from(cluster.batches) {
            self.draw_batch(meshes, cluster.first_batch as usize + batch, placement);
        }
    }

    /// False when no triangle of the cluster can reach a sample of the band that is not hidden.
    #[inline(always)]
    fn cluster_may_show(&mut self, groups: usize) -> bool {
        let s = self.simd;
        let v = &self.queues.vertices;
        let mut x = [s.load_i(super::transform::lanes(&v.x[..16])); 2];
        let mut y = [s.load_i(super::transform::lanes(&v.y[..16])); 2];
        let mut z = s.load_f(super::transform::lanes(&v.depth[..16]));
        if groups > 1 {
            let (x1, y1) =
                (s.load_i(super::transform::lanes(&v.x[16..])), s.load_i(super::transform::lanes(&v.y[16..])));
            x = [s.min_i(x[0], x1), s.max_i(x[1], x1)];
            y = [s.min_i(y[0], y1), s.max_i(y[1], y1)];
            z = s.max_f(z, s.load_f(super::transform::lanes(&v.depth[16..])));
        }
        let band = self.sink.surface().band;
        let sx0 = ((s.reduce_min_i(x[0]) + 127) >> 8).max(0);
        let sx1 = ((s.reduce_max_i(x[1]) - 128) >> 8).min(band.grid.width() - 1);
        let sy0 = ((s.reduce_min_i(y[0]) + 127) >> 8).max(band.first_row());
        let sy1 = ((s.reduce_max_i(y[1]) - 128) >> 8).min(band.last_row());
        if sx0 > sx1 || sy0 > sy1 {
            return false;
        }
        let blocks = [sx0 >> 3, sy0 >> 3, sx1 >> 3, sy1 >> 3];
        !self.cluster_test || self.may_show(blocks, s.reduce_max_f(z))
    }

    #[inline(always)]
    pub fn may_show(&mut self, blocks: [i32; 4], z: f32) -> bool {
        let s = self.simd;
        let surface: &Surface<'_> = self.sink.surface();
        if K::EXACT { surface.may_show::<S, true>(s, blocks, z) } else { surface.may_show::<S, false>(s, blocks, z) }
    }

    /// The samples that each triangle's rectangle holds, cut to the band: x0, y0, x1, y1, both ends inclusive.
    #[inline(always)]
    pub fn sample_bounds(&mut self, x: &[S::I; 3], y: &[S::I; 3]) -> [S::I; 4] {
        let s = self.simd;
        let band = self.sink.surface().band;
        [
            s.max_i(first_sample(s, x), s.splat_i(0)),
            s.max_i(first_sample(s, y), s.splat_i(band.first_row())),
            s.min_i(last_sample(s, x), s.splat_i(band.grid.width() - 1)),
            s.min_i(last_sample(s, y), s.splat_i(band.last_row())),
        ]
    }

    /// The first row of samples in the triangle's rectangle, in the viewport: the same for every band.
    #[inline(always)]
    pub fn viewport_first_row(&self, y: &[S::I; 3]) -> S::I {
        let s = self.simd;
        s.max_i(first_sample(s, y), s.splat_i(0))
    }

    /// Where the blocks (x, y) lie in the surface's list of blocks.
    #[inline(always)]
    pub fn block_numbers(&mut self, x: S::I, y: S::I) -> S::I {
        let s = self.simd;
        let band = self.sink.surface().band;
        let tile_y = s.sub_i(s.shr_i::<2>(y), s.splat_i(band.tile_y0 as i32));
        let tile = s.add_i(s.mul_i(tile_y, s.splat_i(band.grid.tiles_x() as i32)), s.shr_i::<2>(x));
        let three = s.splat_i(3);
        let within = s.or_i(s.shl_i::<2>(s.and_i(y, three)), s.and_i(x, three));
        s.or_i(s.shl_i::<4>(tile), within)
    }

    /// Hands a block to the sink and gives what it gives, without the samples at or beyond the far plane: their depth is not above 0.
    #[inline(always)]
    pub fn emit(&mut self, tile: usize, block: usize, word: u64, depths: [S::F; 4], id: u32, far: f32) -> f32 {
        let s = self.simd;
        let mut word = word;
        if far <= 0.0 {
            let mut before = 0;
            for i in 0..4 {
                before |= u64::from(s.gt_f(depths[i], s.splat_f(0.0))) << (16 * i);
            }
            word &= before;
        }
        if word == 0 { -1.0 } else { self.sink.samples(s, tile, block, word, depths, id) }
    }
}

/// The first sample at or after the least of three positions in subpixels.
#[inline(always)]
fn first_sample<S: Simd>(s: S, v: &[S::I; 3]) -> S::I {
    s.shr_i::<8>(s.add_i(s.min_i(s.min_i(v[0], v[1]), v[2]), s.splat_i(127)))
}

/// The last sample at or before the greatest.
#[inline(always)]
fn last_sample<S: Simd>(s: S, v: &[S::I; 3]) -> S::I {
    s.shr_i::<8>(s.sub_i(s.max_i(s.max_i(v[0], v[1]), v[2]), s.splat_i(128)))
}

/// Asks for the memory of a mesh that will be drawn soon: `distance` 2 for its range, 1 for its first cluster, 0 for the
/// data of that cluster. Small meshes are bound by memory latency, which only a list can hide.
#[inline(always)]
pub(crate) fn prefetch_mesh(meshes: &PreparedMeshes, mesh: MeshId, distance: u32) {
    if distance == 2 {
        return prefetch(&meshes.meshes, mesh.0 as usize);
    }
    let Some(range) = meshes.meshes.get(mesh.0 as usize) else { return };
    if distance == 1 {
        return prefetch(&meshes.clusters, range.first_cluster as usize);
    }
    let Some(cluster) = meshes.clusters.get(range.first_cluster as usize) else { return };
    for g in 0..usize::from(cluster.groups) {
        if let Some(group) = meshes.groups.get(cluster.first_group as usize + g) {
            prefetch(&group.x, 0);
            prefetch(&group.y, 0);
            prefetch(&group.z, 0);
        }
    }
    for b in 0..usize::from(cluster.batches) {
        prefetch(&meshes.batches, cluster.first_batch as usize + b);
    }
}
