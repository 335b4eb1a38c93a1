//! Progressive culling through the hierarchy (Zhang 1998, 2.1.4): nearest first, top down.
//!
//! A queue holds groups and objects by the distance to their boxes; what comes out is tested against all that has been
//! drawn, a hidden group takes everything below it along, a visible object becomes an occluder at once. A group's children are
//! put into the frustum and onto the screen in one call. An object is never nearer than its group, so objects come out
//! nearest first whatever the tree.

use homcull_simd::{Kernel, Simd};

use super::VisibleSet;
use super::frustum::CollectInFrustum;
use super::hom::{BYPASS_BATCH, Bypass, HomFrame, Selected};
use super::hom_parameters::HomParameters;
use super::nearest_first::{NearestFirst, begin, open_group};
use super::vfc::World;
use crate::occlusion::{
    AtOnce, BoxView, DepthReading, OccluderSink, OcclusionSettings, PlacedRows, ProjectedBoxes, test_box,
};
use crate::raster::{Engine, Queues, RasterCounts};
use crate::scene::WideHierarchy;
use crate::select::StandIns;
use crate::view::View;

/// Walks the hierarchy of one frame.
pub(super) fn cull(world: &World<'_>, parameters: &HomParameters, frame: &mut HomFrame) -> VisibleSet {
    let HomFrame { buffer, selected: Selected { view, boxes, stack, sources, .. }, .. } = frame;
    let box_view = world.box_view(view);
    let reading = buffer.reading();
    let OcclusionSettings { no_sample_is_hidden, cluster_test, .. } = *buffer.settings();
    let (level, sink, queues, counts) = buffer.parts();
    let walk = Walk {
        world,
        stand_ins: sources.as_ref().filter(|_| parameters.needs_sources()).and_then(|s| s.database.stand_ins()),
        view,
        box_view: &box_view,
        reading,
        no_sample_is_hidden,
        cluster_test,
        bypass_after: parameters.bypass_after,
        sink,
        queues,
        counts,
        rest: boxes,
        stack,
    };
    level.run(walk)
}

struct Walk<'a, 'w, 'r> {
    world: &'a World<'w>,
    stand_ins: Option<&'a StandIns>,
    view: &'a View,
    box_view: &'a BoxView,
    reading: DepthReading,
    no_sample_is_hidden: bool,
    cluster_test: bool,
    bypass_after: u32,
    sink: OccluderSink<'r>,
    queues: &'a mut Queues,
    counts: &'a mut RasterCounts,
    /// What is left when testing is given up.
    rest: &'a mut ProjectedBoxes,
    stack: &'a mut Vec<(u32, u8)>,
}

impl Kernel for Walk<'_, '_, '_> {
    type Output = VisibleSet;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> VisibleSet {
        let Walk { world, view, box_view, reading, no_sample_is_hidden, cluster_test, bypass_after, .. } = self;
        let Walk { stand_ins, sink, queues, counts, rest, stack, .. } = self;
        let (scene, tree) = (world.scene, &world.tree);
        let mut engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test };
        let mut placed = PlacedRows::new(view);
        let mut set = VisibleSet::default();
        let mut bypass = Bypass::new(bypass_after);
        let mut front = NearestFirst::default();
        rest.clear();
        begin(tree, &mut front);
        let mut children = ProjectedBoxes::new();
        let mut objects_tested = 0;
        while let Some((_, waiting)) = front.pop() {
            let (b, group) = (waiting.b, waiting.group);
            let (asked, bounds) = match group {
                Some((group, _)) => (b.renumbered(0), std::slice::from_ref(&tree.bounds[group as usize])),
                None => (b, &scene.bounds[..]),
            };
            let state = AtOnce { map: engine.sink.view(), reading };
            let hidden: bool = test_box(s, &state, box_view, &asked, bounds, no_sample_is_hidden);
            set.queries += 1;
            match group {
                Some((group, _)) if hidden => {
                    bypass.saw(true);
                    set.triangles_hidden += world.group_triangles[group as usize];
                }
                Some(group) => open_group(s, box_view, tree, group, &mut children, &mut front),
                None => {
                    bypass.saw(hidden);
                    objects_tested += 1;
                    if hidden {
                        set.triangles_hidden += u64::from(scene.triangles(b.id()));
                    } else {
                        let (id, occluder) = (b.id(), &scene.occluders[b.id() as usize]);
                        set.objects.push(id);
                        let form = stand_ins
                            .and_then(|s| Some((s, s.form(view, id, scene.bounds[id as usize], scene.origin)?)));
                        match form {
                            Some((stand_ins, form)) => {
                                for piece in form.occluders(occluder) {
                                    engine.draw(stand_ins.meshes(), &placed.placement(&piece));
                                }
                                engine.flush();
                            }
                            None if occluder.opaque => {
                                engine.draw(&scene.meshes, &placed.placement(occluder));
                                engine.flush();
                            }
                            None => {}
                        }
                    }
                    if objects_tested % BYPASS_BATCH == 0 && bypass.is_due() {
                        set.bypassed = true;
                        take_rest(s, box_view, tree, &mut front, stack, rest);
                        break;
                    }
                }
            }
        }
        *counts += engine.counts;
        set.objects.extend(rest.boxes().iter().map(|b| b.id()));
        set
    }
}

/// Testing is given up: all that waits, and all that is below it, is drawn, nearest first.
#[inline(always)]
fn take_rest<S: Simd>(
    s: S,
    view: &BoxView,
    tree: &WideHierarchy,
    front: &mut NearestFirst,
    stack: &mut Vec<(u32, u8)>,
    rest: &mut ProjectedBoxes,
) {
    stack.clear();
    while let Some((distance, waiting)) = front.pop() {
        match waiting.group {
            Some(group) => stack.push(group),
            None => rest.push_unprojected(waiting.b.id(), distance),
        }
    }
    CollectInFrustum { view, tree, project: false, stack, out: &mut *rest }.run(s);
    rest.sort();
}
