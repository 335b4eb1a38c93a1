//! Hierarchical occlusion maps (Zhang 1998, chapters 3 and 8): OccSel, Cull, and the draw of what is left.
//!
//! One pass draws selected occluders, then tests everything; multi-pass merges what turned out visible whenever enough of
//! it has gathered (2.1.4); progressive does so object by object (`progressive.rs`; with thresholds below 1, or the depth of a
//! far boundary, as multi-pass of one object a round). In all of them a **counted bypass** ends testing for the frame after a number of consecutive tests without a hidden object; and after a frame that hid next to
//! nothing, culling **rests** for some frames, which are drawn as `vfc` draws them. So open views cost next to nothing, and
//! since every frame is conservative by itself, resting can't be seen. Both go by counts, never by clocks.
//! With thresholds at 1 and the display's samples all of them are conservative: the picture stays the same, bit for bit.

use std::ops::Range;
use std::sync::Arc;

use homcull_simd::Level;

use super::hom_parameters::{HomParameters, Selection, Update};
use super::test_batch::test_batch;
use super::vfc::World;
use super::{Feedback, FeedbackLine, OccluderSources, VisibleSet, progressive};
use crate::error::{Error, Result};
use crate::occlusion::{BandJob, Occluder, OcclusionBuffer, OcclusionSettings, OverlapStatistics, ProjectedBoxes};
use crate::scene::PreparedScene;
use crate::select::WalkMemory;
use crate::view::{View, Viewport};
use crate::workers::Workers;

/// A frame did not pay if it hid fewer triangles than it drew as occluders, divided by this. Low, so that only views with
/// next to nothing to hide are left alone.
const GAIN_OVER_COST: u64 = 4;

/// Tests between two looks at the bypass counter: batches of the input order.
pub const BYPASS_BATCH: usize = 64;

/// Boxes that one thread tests in one go where there are several threads: a multiple of [`BYPASS_BATCH`].
const JOB: usize = 4 * BYPASS_BATCH;
/// Such goes a thread between two looks at the bypass counter: what is tested in vain stays small.
const JOBS_A_THREAD: usize = 2;

/// What OccSel makes of a frame: what is in the frustum, and the occluders chosen. It stands apart from the occlusion
/// buffer, so that OccSel can be ahead of the stages that use one.
pub struct Selected {
    /// The view at the resolution of the occlusion buffer.
    pub view: View,
    pub(crate) boxes: ProjectedBoxes,
    pub(crate) stack: Vec<(u32, u8)>,
    /// What occluders are chosen from: made at the first frame, or given beforehand.
    pub(crate) sources: Option<Arc<OccluderSources>>,
    walk: WalkMemory,
    chosen: Vec<u32>,
    snapped: Option<usize>,
    occluders: Vec<Occluder>,
    /// What is drawn in place of others, from the meshes of the database's stand-ins.
    stand_ins: Vec<Occluder>,
    /// What the frame hears before it is culled, what it tells after.
    pub(crate) feedback: Feedback,
    /// Whether culling rests in this frame.
    resting: bool,
    /// Whether the frame is culled through the hierarchy, progressively.
    walks_tree: bool,
}

impl Selected {
    /// For frames of one size.
    pub(crate) fn new(view: &View, viewport: Viewport) -> Selected {
        Selected {
            view: view.resized(viewport),
            boxes: ProjectedBoxes::new(),
            stack: Vec::new(),
            sources: None,
            walk: WalkMemory::default(),
            chosen: Vec::new(),
            snapped: None,
            occluders: Vec::new(),
            stand_ins: Vec::new(),
            feedback: Feedback::default(),
            resting: false,
            walks_tree: false,
        }
    }

    /// As [`HomFrame::sources`].
    fn sources(&mut self, scene: &PreparedScene, parameters: &HomParameters) -> Result<Arc<OccluderSources>> {
        if let Some(sources) = self.sources.as_ref().filter(|s| s.are_of(scene, parameters)) {
            return Ok(sources.clone());
        }
        let sources = Arc::new(OccluderSources::new(scene, parameters)?);
        self.sources = Some(sources.clone());
        Ok(sources)
    }

    /// Triangles of the chosen occluders.
    fn occluder_triangles(&self) -> u64 {
        self.sources.as_ref().map_or(0, |s| s.database.triangles(&self.view, &self.chosen))
    }

    /// Clears a buffer for this frame's occluders; its pyramid waits for [`build_pyramid`].
    ///
    /// # Errors
    /// Those of [`OcclusionBuffer::begin`].
    pub(crate) fn begin(&self, buffer: &mut OcclusionBuffer) -> Result<()> {
        buffer.pyramid_deferred = true;
        if self.resting { Ok(()) } else { buffer.begin(&self.view) }
    }
}

/// The occlusion buffer and the boxes of one frame, handed from stage to stage and back for the next frame.
pub struct HomFrame {
    /// What occluders cover.
    pub buffer: OcclusionBuffer,
    /// What OccSel made.
    pub selected: Selected,
    tests: Vec<Tests>,
    line: FeedbackLine,
}

/// Tests of a stretch of the boxes, on one thread.
#[derive(Default)]
struct Tests {
    range: Range<usize>,
    hidden: Vec<bool>,
    /// One for each batch of the bypass.
    statistics: Vec<OverlapStatistics>,
    batch: Vec<bool>,
    failed: Option<Error>,
}

impl Tests {
    fn test(&mut self, buffer: &OcclusionBuffer, scene: &PreparedScene, boxes: &ProjectedBoxes) -> Result<()> {
        self.hidden.clear();
        self.statistics.clear();
        for from in self.range.clone().step_by(BYPASS_BATCH) {
            let batch = from..(from + BYPASS_BATCH).min(self.range.end);
            let mut statistics = OverlapStatistics::default();
            test_batch(buffer, scene, boxes, batch, &mut self.batch, &mut statistics)?;
            self.hidden.extend_from_slice(&self.batch);
            self.statistics.push(statistics);
        }
        Ok(())
    }
}

impl HomFrame {
    /// A frame for views of one size.
    ///
    /// # Errors
    /// As for [`OcclusionBuffer::with_level`], [`OverlapParameters::thresholds`](super::OverlapParameters::thresholds) and
    /// [`HomParameters::check`].
    pub fn new(view: &View, level: Level, parameters: &HomParameters) -> Result<HomFrame> {
        parameters.check()?;
        let viewport = parameters.resolution.unwrap_or(view.viewport());
        let settings = OcclusionSettings { depth: parameters.depth, ..parameters.overlap.settings()? };
        let buffer = OcclusionBuffer::with_level(viewport, level, settings)?;
        Ok(HomFrame {
            buffer,
            selected: Selected::new(view, viewport),
            tests: Vec::new(),
            line: FeedbackLine::new(parameters.lag()),
        })
    }

    /// Forgets all earlier frames: for a teleport, or another scene.
    pub fn reset(&mut self) {
        self.line.reset();
    }

    /// What earlier frames tell later ones.
    pub fn memory(&self) -> &FeedbackLine {
        &self.line
    }

    /// Takes back to where [`HomFrame::memory`] was: for drawing a frame again.
    pub fn set_memory(&mut self, memory: &FeedbackLine) {
        self.line.clone_from(memory);
    }

    /// What occluders are chosen from, made now unless it is there: this takes a while, and the first frame would else take it.
    ///
    /// # Errors
    /// Those of [`OccluderSources::new`].
    pub fn sources(&mut self, scene: &PreparedScene, parameters: &HomParameters) -> Result<Arc<OccluderSources>> {
        self.selected.sources(scene, parameters)
    }

    /// Chooses from these sources, which frames may share; others are made if they are not of a frame's scene and parameters.
    pub fn set_sources(&mut self, sources: Arc<OccluderSources>) {
        self.selected.sources = Some(sources);
    }

    /// The occluders chosen for this frame, by their ids in the database.
    pub fn chosen(&self) -> &[u32] {
        &self.selected.chosen
    }

    /// The view point of the bake that chose them; `None` when none was near, or none is used.
    pub fn snapped(&self) -> Option<usize> {
        self.selected.snapped
    }

    /// The boxes in the frustum.
    pub fn boxes(&self) -> &ProjectedBoxes {
        &self.selected.boxes
    }
}

/// OccSel: begins the view, finds what is in the frustum, and chooses occluders from the database (7.3, 7.4). Multi-pass and progressive
/// choose none: there everything visible occludes.
///
/// # Errors
/// Those of [`OcclusionBuffer::begin`] and [`HomFrame::sources`].
pub fn select_occluders(
    world: &World<'_>,
    level: Level,
    view: &View,
    parameters: &HomParameters,
    frame: HomFrame,
) -> Result<HomFrame> {
    let HomFrame { mut buffer, mut selected, tests, mut line } = frame;
    line.settle();
    selected.feedback = line.begin();
    let selected = select(world, level, view, parameters, walks_tree(parameters, &buffer), selected)?;
    selected.begin(&mut buffer)?;
    Ok(HomFrame { buffer, selected, tests, line })
}

/// Whether frames are culled through the hierarchy: progressively, where both tests are one.
pub(crate) fn walks_tree(parameters: &HomParameters, buffer: &OcclusionBuffer) -> bool {
    parameters.update == Update::Always && buffer.tests_at_once()
}

/// OccSel without a buffer.
///
/// # Errors
/// Those of [`OccluderSources::new`].
pub(crate) fn select(
    world: &World<'_>,
    level: Level,
    view: &View,
    parameters: &HomParameters,
    walks_tree: bool,
    selected: Selected,
) -> Result<Selected> {
    let mut selected = selected;
    selected.view = view.resized(selected.view.viewport());
    selected.resting = selected.feedback.rest.is_on();
    selected.walks_tree = walks_tree;
    selected.chosen.clear();
    selected.occluders.clear();
    selected.stand_ins.clear();
    selected.snapped = None;
    if selected.resting {
        world.collect(level, view, false, &mut selected.stack, &mut selected.boxes);
        return Ok(selected);
    }
    if parameters.needs_sources() {
        selected.sources(world.scene, parameters)?;
    }
    if walks_tree {
        selected.boxes.clear();
        return Ok(selected);
    }
    world.collect(level, &selected.view, true, &mut selected.stack, &mut selected.boxes);
    if parameters.update == Update::Once {
        let sources = selected.sources(world.scene, parameters)?;
        let Selected { view, walk, chosen, snapped, feedback, occluders, stand_ins, .. } = &mut selected;
        *snapped = sources.choose(level, view, parameters, &feedback.occluded, walk, chosen);
        chosen.retain(|&object| world.takes_part(object));
        sources.database.draw_list(view, chosen, occluders, stand_ins);
    }
    Ok(selected)
}

/// OccDraw: draws the chosen occluders, in bands on the workers' threads.
///
/// # Errors
/// Those of [`OcclusionBuffer::submit`].
pub fn draw_occluders(world: &World<'_>, workers: &Workers, frame: HomFrame) -> Result<HomFrame> {
    let mut frame = frame;
    let HomFrame { buffer, selected, .. } = &mut frame;
    if selected.resting {
        return Ok(frame);
    }
    let database = selected.sources.as_ref().map(|s| &s.database);
    let meshes = database.map_or(&world.scene.meshes, |d| d.meshes(world.scene));
    let others = database.and_then(|d| d.stand_ins()).map_or(meshes, |s| s.meshes());
    for (meshes, occluders) in [(meshes, &selected.occluders), (others, &selected.stand_ins)] {
        if occluders.is_empty() {
            continue;
        }
        if workers.threads() == 1 {
            buffer.submit(meshes, occluders)?;
        } else {
            let run = |jobs: &mut [BandJob<'_>]| workers.run(jobs, BandJob::run);
            buffer.submit_in_bands(meshes, occluders, workers.bands(), run)?;
        }
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

/// Cull: tests what is in the frustum, nearest first. Gives the visible set, and the frame back. One pass tests on the
/// workers' threads (8.1); multi-pass and progressive test in the caller's, since there each test needs those before it.
///
/// # Errors
/// Those of the buffer.
pub fn cull(
    world: &World<'_>,
    workers: &Workers,
    parameters: &HomParameters,
    frame: HomFrame,
) -> Result<(VisibleSet, HomFrame)> {
    let (set, mut frame) = cull_selected(world, workers, parameters, frame)?;
    frame.line.tell(std::mem::take(&mut frame.selected.feedback));
    Ok((set, frame))
}

/// Cull, with what the frame tells left in it.
pub(crate) fn cull_selected(
    world: &World<'_>,
    workers: &Workers,
    parameters: &HomParameters,
    frame: HomFrame,
) -> Result<(VisibleSet, HomFrame)> {
    let mut frame = frame;
    frame.selected.feedback.occluded.forget();
    let rest = frame.selected.feedback.rest;
    if frame.selected.resting {
        frame.selected.feedback.rest = rest.shorter();
        return Ok((VisibleSet { bypassed: true, ..world.all_of(&frame.selected.boxes) }, frame));
    }
    let mut set = match parameters.update {
        Update::Once => one_pass(world, workers, parameters, &mut frame)?,
        Update::Always if frame.selected.walks_tree => progressive::cull(world, parameters, &mut frame),
        Update::Always => multi_pass(world, parameters, 0, &mut frame)?,
        Update::Batches(triangles) => multi_pass(world, parameters, triangles, &mut frame)?,
    };
    // Not the rasterizer's count for one pass: that is by bands, and so by threads.
    set.occluder_triangles = match parameters.update {
        Update::Once => frame.selected.occluder_triangles(),
        Update::Always | Update::Batches(_) => frame.buffer.counts().triangles,
    };
    let paid = set.triangles_hidden.saturating_mul(GAIN_OVER_COST) >= set.occluder_triangles;
    frame.selected.feedback.rest = rest.after(paid, parameters.rest);
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

/// Tests all boxes, stretch by stretch, several at a time where there are threads. Verdicts are counted in the input order and
/// the bypass is decided between its batches, so that neither depends on the threads.
fn one_pass(
    world: &World<'_>,
    workers: &Workers,
    parameters: &HomParameters,
    frame: &mut HomFrame,
) -> Result<VisibleSet> {
    let HomFrame { buffer, selected: Selected { boxes, feedback, .. }, tests, .. } = frame;
    let (buffer, boxes) = (&*buffer, &*boxes);
    let (scene, n) = (world.scene, boxes.len());
    if parameters.select == Selection::Temporal {
        feedback.occluded.clear(scene.occluders.len());
    }
    let mut set = VisibleSet { in_frustum: n as u32, ..VisibleSet::default() };
    let mut bypass = Bypass::new(parameters.bypass_after);
    let mut from = 0;
    while from < n && !set.bypassed {
        let tests = lay_out(tests, from, n, workers.threads());
        workers.run(tests, |t| t.failed = t.test(buffer, scene, boxes).err());
        for t in tests {
            t.failed.take().map_or(Ok(()), Err)?;
            for (hidden, statistics) in t.hidden.chunks(BYPASS_BATCH).zip(&t.statistics) {
                if set.bypassed {
                    break;
                }
                let batch = &boxes.boxes()[from..from + hidden.len()];
                for (b, &hidden) in batch.iter().zip(hidden) {
                    count(world, &mut set, b.id(), hidden);
                    bypass.saw(hidden);
                    if hidden {
                        feedback.occluded.insert(b.id());
                    }
                }
                set.overlap += statistics;
                set.queries += hidden.len() as u64;
                from += hidden.len();
                set.bypassed = bypass.is_due();
            }
        }
    }
    boxes.boxes()[from..].iter().for_each(|b| count(world, &mut set, b.id(), false));
    Ok(set)
}

/// Cuts what comes next of `n` boxes into stretches: one batch for one thread, some longer ones for several.
fn lay_out(tests: &mut Vec<Tests>, from: usize, n: usize, threads: usize) -> &mut [Tests] {
    let (length, most) = if threads == 1 { (BYPASS_BATCH, 1) } else { (JOB, JOBS_A_THREAD * threads) };
    if tests.len() < most {
        tests.resize_with(most, Tests::default);
    }
    let tests = &mut tests[..(n - from).div_ceil(length).min(most)];
    for (i, t) in tests.iter_mut().enumerate() {
        let start = from + i * length;
        t.range = start..(start + length).min(n);
    }
    tests
}

fn count(world: &World<'_>, set: &mut VisibleSet, id: u32, hidden: bool) {
    let triangles = u64::from(world.scene.triangles(id));
    set.triangles_in_frustum += triangles;
    if hidden {
        set.triangles_hidden += triangles;
    } else {
        set.objects.push(id);
    }
}

fn multi_pass(
    world: &World<'_>,
    parameters: &HomParameters,
    update_triangles: u64,
    frame: &mut HomFrame,
) -> Result<VisibleSet> {
    let HomFrame { buffer, selected: Selected { view, boxes, sources, occluders, stand_ins, .. }, tests, .. } = frame;
    let scene = world.scene;
    // Sources may be left over from other parameters.
    let forms = sources.as_ref().filter(|_| parameters.needs_sources()).and_then(|s| s.database.stand_ins());
    let mut set = VisibleSet { in_frustum: boxes.len() as u32, ..VisibleSet::default() };
    let mut bypass = Bypass::new(parameters.bypass_after);
    let mut gathered = 0;
    tests.resize_with(tests.len().max(1), Tests::default);
    let hidden = &mut tests[0].hidden;
    occluders.clear();
    stand_ins.clear();
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
        if buffer.occludes(&scene.occluders[id as usize]) {
            let occluder = &scene.occluders[id as usize];
            match forms.and_then(|f| f.form(view, id, scene.bounds[id as usize], scene.origin)) {
                Some(form) => stand_ins.extend(form.occluders(occluder)),
                None => occluders.push(*occluder),
            }
            gathered += triangles;
            if gathered > update_triangles {
                buffer.submit(&scene.meshes, occluders)?;
                if let Some(forms) = forms.filter(|_| !stand_ins.is_empty()) {
                    buffer.submit(forms.meshes(), stand_ins)?;
                }
                occluders.clear();
                stand_ins.clear();
                gathered = 0;
            }
        }
    }
    Ok(set)
}
