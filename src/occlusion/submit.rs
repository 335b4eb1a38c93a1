//! Drawing lists of occluders into the map, whole or in bands, with depth or without.

use glam::{DVec3, Vec3};
use homcull_simd::{Kernel, Level, Simd};

use super::buffer::{Occluder, OcclusionBuffer};
use super::layers::SubmitLayers;
use super::map::{CoverageSink, OccluderSink};
use super::progressive::PlacedRows;
use crate::error::Result;
use crate::raster::{Engine, Facing, PreparedMeshes, Queues, RasterCounts, Sink, prefetch_mesh};
use crate::view::View;

/// Draws a list of occluders into one band.
pub(crate) struct Submit<'a> {
    pub view: &'a View,
    pub sink: OccluderSink<'a>,
    pub queues: &'a mut Queues,
    pub meshes: &'a PreparedMeshes,
    pub occluders: &'a [Occluder],
    pub cluster_test: bool,
    pub keep_depth: bool,
}

impl Kernel for Submit<'_> {
    type Output = RasterCounts;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> RasterCounts {
        let Submit { view, sink, queues, meshes, occluders, cluster_test, keep_depth } = self;
        let counts = RasterCounts::default();
        if keep_depth {
            draw_list(Engine { simd: s, sink, queues, counts, cluster_test }, view, meshes, occluders)
        } else {
            s.vectorize(SubmitCoverage(Submit { view, sink, queues, meshes, occluders, cluster_test, keep_depth }))
        }
    }
}

/// The same without depth, as a function of its own: it is not worth a copy of the rasterizer in every caller.
struct SubmitCoverage<'a>(Submit<'a>);

impl Kernel for SubmitCoverage<'_> {
    type Output = RasterCounts;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> RasterCounts {
        let Submit { view, sink, queues, meshes, occluders, cluster_test, .. } = self.0;
        let engine =
            Engine { simd: s, sink: CoverageSink(sink), queues, counts: RasterCounts::default(), cluster_test };
        draw_list(engine, view, meshes, occluders)
    }
}

#[inline(always)]
fn draw_list<'a, S: Simd, K: Sink<'a>>(
    mut engine: Engine<'_, S, K>,
    view: &View,
    meshes: &PreparedMeshes,
    occluders: &[Occluder],
) -> RasterCounts {
    let mut placed = PlacedRows::new(view);
    for (i, occluder) in occluders.iter().enumerate() {
        for (distance, stage) in [(12, 2), (8, 1), (4, 0)] {
            if let Some(o) = occluders.get(i + distance) {
                prefetch_mesh(meshes, o.mesh, stage);
            }
        }
        if occluder.opaque {
            engine.draw(meshes, &placed.placement(occluder));
        }
    }
    engine.flush();
    engine.counts
}

impl OcclusionBuffer {
    /// Draws occluders, in a list: small meshes are bound by memory latency, which only a list can hide.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn submit(&mut self, meshes: &PreparedMeshes, occluders: &[Occluder]) -> Result<()> {
        let view = *self.begun()?;
        let (keep_depth, cluster_test) = (self.depth.is_in_map(), self.settings.cluster_test);
        self.depth.push(&view, self.map.grid, meshes, occluders, self.settings.fusion.is_some());
        let submit = Submit {
            view: &view,
            sink: self.map.sink(),
            queues: &mut self.queues[0],
            meshes,
            occluders,
            cluster_test,
            keep_depth,
        };
        self.counts += self.level.run(submit);
        self.submit_layers(&view, meshes, occluders);
        self.settle();
        Ok(())
    }

    /// Draws occluders band by band, as jobs that the caller runs on threads of its own: `run` gets the jobs and must call
    /// [`BandJob::run`] on each. The bits are those of [`OcclusionBuffer::submit`], whatever the number of bands.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn submit_in_bands(
        &mut self,
        meshes: &PreparedMeshes,
        occluders: &[Occluder],
        bands: usize,
        run: impl FnOnce(&mut [BandJob<'_>]),
    ) -> Result<()> {
        let view = *self.begun()?;
        let (level, keep_depth, cluster_test) = (self.level, self.depth.is_in_map(), self.settings.cluster_test);
        self.depth.push(&view, self.map.grid, meshes, occluders, self.settings.fusion.is_some());
        let bands = bands.clamp(1, self.map.grid.tiles_y());
        while self.queues.len() < bands {
            self.queues.push(Queues::new());
        }
        let mut jobs: Vec<BandJob<'_>> = (self.map.sinks(bands).zip(&mut self.queues))
            .map(|(sink, queues)| {
                let submit = Submit { view: &view, sink, queues, meshes, occluders, cluster_test, keep_depth };
                BandJob { level, submit: Some(submit), counts: RasterCounts::default() }
            })
            .collect();
        run(&mut jobs);
        // A job that the caller left out is done here: the state must not depend on it.
        let counts = jobs.iter_mut().map(BandJob::finish).fold(RasterCounts::default(), |mut a, c| {
            a += c;
            a
        });
        drop(jobs);
        self.counts += counts;
        self.submit_layers(&view, meshes, occluders);
        self.settle();
        Ok(())
    }

    /// Adds occluders to the layers, where there are any: on this thread.
    fn submit_layers(&mut self, view: &View, meshes: &PreparedMeshes, occluders: &[Occluder]) {
        if let Some(layers) = &mut self.layers {
            let (queues, dirty) = (&mut self.queues[0], &mut self.map.dirty[..]);
            self.counts += self.level.run(SubmitLayers { view, layers, queues, meshes, occluders, dirty });
        }
    }

    /// Draws a mesh that has not been prepared, e.g. one that changes every frame.
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) as for [`PreparedMeshes::add`]; [`Error::View`](crate::Error::View) when no view has begun.
    pub fn submit_triangles(
        &mut self,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        position: DVec3,
        facing: Facing,
    ) -> Result<()> {
        let mut plain = std::mem::take(&mut self.plain);
        plain.clear();
        let done = plain.add_in_order(positions, triangles).and_then(|mesh| {
            let (rotation, opaque, optical_depth, luminance) = (None, true, 0, 0);
            let occluder = Occluder { mesh, position, rotation, facing, opaque, optical_depth, luminance };
            self.submit(&plain, &[occluder])
        });
        self.plain = plain;
        done
    }
}

/// One band's share of [`OcclusionBuffer::submit_in_bands`]. May run on any thread.
pub struct BandJob<'a> {
    level: Level,
    submit: Option<Submit<'a>>,
    counts: RasterCounts,
}

impl BandJob<'_> {
    /// Draws the band. A second call does nothing.
    pub fn run(&mut self) {
        if let Some(submit) = self.submit.take() {
            self.counts = self.level.run(submit);
        }
    }

    fn finish(&mut self) -> RasterCounts {
        self.run();
        self.counts
    }
}
