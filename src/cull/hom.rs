//! Hierarchical occlusion maps (Zhang 1998, chapters 3 and 8): OccSel, Cull, and the draw of what is left.
//!
//! One pass draws selected occluders, then tests everything; multi-pass merges what turned out visible whenever enough of
//! it has gathered (2.1.4); progressive does so object by object (`progressive.rs`). In all of them a **counted bypass** ends
//! testing for the frame after a number of consecutive tests without a hidden object; and after a frame that hid next to
//! nothing, culling **rests** for some frames, which are drawn as `vfc` draws them. So open views cost next to nothing, and
//! since every frame is conservative by itself, resting can't be seen. Both go by counts, never by clocks.
//! With thresholds at 1 and the display's samples all of them are conservative: the picture stays the same, bit for bit.

use glam::Vec3;
use homcull_simd::Level;

use super::method::{HomParameters, Selection, Update};
use super::test_batch::{occludes, test_batch};
use super::vfc::World;
use super::{VisibleSet, progressive};
use crate::error::Result;
use crate::occlusion::{BandJob, Occluder, OcclusionBuffer, OcclusionSettings, ProjectedBoxes};
use crate::select::{select_by_distance, select_by_z_plane};
use crate::view::{View, Viewport};
use crate::workers::Workers;

/// A frame did not pay if it hid fewer triangles than it drew as occluders, divided by this. Low, so that only views with
/// next to nothing to hide are left alone.
const GAIN_OVER_COST: u64 = 4;

/// How long culling still rests. The first rest is one frame; as long as frames keep hiding next to nothing, each is twice as
/// long as the one before, up to the parameter `rest`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rest {
    left: u32,
    in_a_row: u32,
}

impl Rest {
    /// After a frame that was culled.
    fn after(self, paid: bool, longest: u32) -> Rest {
        if paid {
            return Rest::default();
        }
        Rest { left: longest.min(1 << self.in_a_row.min(30)), in_a_row: self.in_a_row + 1 }
    }
}

/// Tests between two looks at the bypass counter: batches of the input order.
pub const BYPASS_BATCH: usize = 64;

/// The occlusion buffer and the boxes of one frame, handed from stage to stage and back for the next frame.
pub struct HomFrame {
    /// What occluders cover.
    pub buffer: OcclusionBuffer,
    /// The view as the buffer has it: at its own resolution.
    pub view: View,
    pub(crate) boxes: ProjectedBoxes,
    pub(crate) stack: Vec<(u32, u8)>,
    chosen: Vec<u32>,
    occluders: Vec<Occluder>,
    hidden: Vec<bool>,
    /// How long culling still rests, and whether it does in this frame.
    rest: Rest,
    resting: bool,
}

impl HomFrame {
    /// A frame for views of one size.
    ///
    /// # Errors
    /// As for [`OcclusionBuffer::with_level`] and [`OverlapParameters::thresholds`](super::OverlapParameters::thresholds).
    pub fn new(view: &View, level: Level, parameters: &HomParameters) -> Result<HomFrame> {
        let viewport = parameters.resolution.unwrap_or(view.viewport());
        let settings = OcclusionSettings { depth: parameters.depth, ..parameters.overlap.settings()? };
        Ok(HomFrame {
            buffer: OcclusionBuffer::with_level(viewport, level, settings)?,
            view: view.resized(viewport),
            boxes: ProjectedBoxes::new(),
            stack: Vec::new(),
            chosen: Vec::new(),
            occluders: Vec::new(),
            hidden: Vec::new(),
            rest: Rest::default(),
            resting: false,
        })
    }

    /// Ends a rest: for a teleport, or another scene.
    pub fn reset(&mut self) {
        self.rest = Rest::default();
    }

    /// How long culling still rests.
    pub fn rest(&self) -> Rest {
        self.rest
    }

    /// Takes back to where [`HomFrame::rest`] was: for drawing a frame again.
    pub fn set_rest(&mut self, rest: Rest) {
        self.rest = rest;
    }

    /// The boxes in the frustum.
    pub fn boxes(&self) -> &ProjectedBoxes {
        &self.boxes
    }

    fn viewport(&self, view: &View) -> Viewport {
        let (width, height) = self.buffer.size();
        Viewport::new(width, height).unwrap_or(view.viewport())
    }
}

/// OccSel, first half: begins the view, finds what is in the frustum, and chooses occluders (7.3). Multi-pass and progressive
/// choose none: there everything visible occludes.
///
/// # Errors
/// Those of [`OcclusionBuffer::begin`].
pub fn select_occluders(
    world: &World<'_>,
    level: Level,
    view: &View,
    parameters: &HomParameters,
    frame: HomFrame,
) -> Result<HomFrame> {
    let mut frame = frame;
    frame.view = view.resized(frame.viewport(view));
    frame.resting = frame.rest.left > 0;
    if frame.resting {
        world.collect(level, view, false, &mut frame.stack, &mut frame.boxes);
        return Ok(frame);
    }
    frame.buffer.begin(&frame.view)?;
    frame.occluders.clear();
    let walks_tree = parameters.update == Update::Always && !frame.buffer.walks_pyramid();
    if walks_tree {
        frame.boxes.clear();
        return Ok(frame);
    }
    world.collect(level, &frame.view, true, &mut frame.stack, &mut frame.boxes);
    if parameters.update != Update::Once {
        return Ok(frame);
    }
    let scene = world.scene;
    let candidates = frame.boxes.boxes().iter().map(|b| b.id()).filter(|&id| occludes(&frame.buffer, scene, id));
    let eye = (view.eye() - scene.origin).as_vec3();
    match parameters.select {
        Selection::Distance(measure) => {
            let triangles = |id| u64::from(scene.triangles(id));
            select_by_distance(
                candidates,
                &scene.bounds,
                eye,
                measure,
                triangles,
                parameters.occluder_triangles,
                &mut frame.chosen,
            );
        }
        Selection::ZPlane(distance) => {
            let w = view.rows()[2].truncate().as_vec3();
            let forward = if w == Vec3::ZERO { -view.rows()[3].truncate().as_vec3() } else { w };
            select_by_z_plane(candidates, &scene.bounds, eye, forward.normalize_or_zero(), distance, &mut frame.chosen);
        }
    }
    frame.occluders.extend(frame.chosen.iter().map(|&id| scene.occluders[id as usize]));
    Ok(frame)
}

/// OccSel, second half: draws the chosen occluders, in bands on the workers' threads.
///
/// # Errors
/// Those of [`OcclusionBuffer::submit`].
pub fn draw_occluders(world: &World<'_>, workers: &Workers, frame: HomFrame) -> Result<HomFrame> {
    let mut frame = frame;
    frame.buffer.pyramid_deferred = true;
    let meshes = &world.scene.meshes;
    if frame.resting || frame.occluders.is_empty() {
        return Ok(frame);
    }
    if workers.threads() == 1 {
        frame.buffer.submit(meshes, &frame.occluders)?;
    } else {
        let run = |jobs: &mut [BandJob<'_>]| workers.run(jobs, BandJob::run);
        frame.buffer.submit_in_bands(meshes, &frame.occluders, workers.bands(), run)?;
    }
    Ok(frame)
}

/// The hierarchical occlusion maps of the chosen occluders. With thresholds at 1 the tests need none, and none are built.
pub fn build_pyramid(frame: HomFrame) -> HomFrame {
    let mut frame = frame;
    frame.buffer.bring_pyramid_in_step();
    frame.buffer.pyramid_deferred = false;
    frame
}

/// Cull: tests what is in the frustum, nearest first. Gives the visible set, and the frame back.
///
/// # Errors
/// Those of the buffer.
pub fn cull(world: &World<'_>, parameters: &HomParameters, frame: HomFrame) -> Result<(VisibleSet, HomFrame)> {
    let mut frame = frame;
    if frame.resting {
        frame.rest.left -= 1;
        return Ok((VisibleSet { bypassed: true, ..world.all_of(&frame.boxes) }, frame));
    }
    let through_tree = !frame.buffer.walks_pyramid();
    let set = match parameters.update {
        Update::Once => one_pass(world, parameters, &mut frame)?,
        Update::Always if through_tree => progressive::cull(world, parameters, &mut frame),
        Update::Always => multi_pass(world, parameters, 0, &mut frame)?,
        Update::Batches(triangles) => multi_pass(world, parameters, triangles, &mut frame)?,
    };
    let paid = set.triangles_hidden.saturating_mul(GAIN_OVER_COST) >= frame.buffer.counts().triangles;
    frame.rest = frame.rest.after(paid, parameters.rest);
    Ok((set, frame))
}

/// Counts tests without a hidden object.
pub(crate) struct Bypass {
    after: u32,
    visible_in_a_row: u32,
}

impl Bypass {
    pub fn new(after: u32) -> Bypass {
        Bypass { after, visible_in_a_row: 0 }
    }

    #[inline(always)]
    pub fn saw(&mut self, hidden: bool) {
        self.visible_in_a_row = if hidden { 0 } else { self.visible_in_a_row + 1 };
    }

    pub fn is_due(&self) -> bool {
        self.visible_in_a_row >= self.after
    }
}

fn one_pass(world: &World<'_>, parameters: &HomParameters, frame: &mut HomFrame) -> Result<VisibleSet> {
    let HomFrame { buffer, boxes, hidden, .. } = frame;
    let mut set = VisibleSet { in_frustum: boxes.len() as u32, ..VisibleSet::default() };
    let mut bypass = Bypass::new(parameters.bypass_after);
    for from in (0..boxes.len()).step_by(BYPASS_BATCH) {
        let batch = from..(from + BYPASS_BATCH).min(boxes.len());
        if set.bypassed {
            hidden.clear();
            hidden.resize(batch.len(), false);
        } else {
            test_batch(buffer, world.scene, boxes, batch.clone(), hidden, &mut set.overlap)?;
            set.queries += batch.len() as u64;
        }
        for (b, &hidden) in boxes.boxes()[batch].iter().zip(&*hidden) {
            set.triangles_in_frustum += u64::from(world.scene.triangles(b.id()));
            bypass.saw(hidden);
            if hidden {
                set.triangles_hidden += u64::from(world.scene.triangles(b.id()));
            } else {
                set.objects.push(b.id());
            }
        }
        set.bypassed |= bypass.is_due();
    }
    Ok(set)
}

fn multi_pass(
    world: &World<'_>,
    parameters: &HomParameters,
    update_triangles: u64,
    frame: &mut HomFrame,
) -> Result<VisibleSet> {
    let HomFrame { buffer, boxes, occluders, hidden, .. } = frame;
    let scene = world.scene;
    let mut set = VisibleSet { in_frustum: boxes.len() as u32, ..VisibleSet::default() };
    let mut bypass = Bypass::new(parameters.bypass_after);
    let mut gathered = 0;
    occluders.clear();
    for (i, b) in boxes.boxes().iter().enumerate() {
        let id = b.id();
        let triangles = u64::from(scene.triangles(id));
        set.triangles_in_frustum += triangles;
        if i % BYPASS_BATCH == 0 {
            set.bypassed |= bypass.is_due();
        }
        if set.bypassed {
            set.objects.push(id);
            continue;
        }
        set.queries += 1;
        test_batch(buffer, scene, boxes, i..i + 1, hidden, &mut set.overlap)?;
        let hidden = hidden[0];
        bypass.saw(hidden);
        if hidden {
            set.triangles_hidden += triangles;
            continue;
        }
        set.objects.push(id);
        if occludes(buffer, scene, id) {
            occluders.push(scene.occluders[id as usize]);
            gathered += triangles;
            if gathered > update_triangles {
                buffer.submit(&scene.meshes, occluders)?;
                occluders.clear();
                gathered = 0;
            }
        }
    }
    Ok(set)
}
