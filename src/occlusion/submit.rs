//! Drawing a list of occluders into a band of the map, with depth or without.

use homcull_simd::{Kernel, Simd};

use super::buffer::Occluder;
use super::map::{CoverageSink, OccluderSink};
use super::progressive::PlacedRows;
use crate::raster::{Engine, PreparedMeshes, Queues, RasterCounts, Sink, prefetch_mesh};
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
