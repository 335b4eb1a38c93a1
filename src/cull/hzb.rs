//! The hierarchical Z-buffer (Greene, Kass and Miller 1993; Zhang 1998, 2.2.3.5; Russin's lecture).
//!
//! The final draw is the occluder rendering. Nodes come out of a queue nearest first; each is tested against the Z-buffer as far as it
//! has been drawn, a hidden one takes everything below it along, a visible object is drawn at once. The pyramid of farthest depths is the
//! one that the draw keeps for its own early-outs: a sample, a block of 8x8, a tile of 4x4 blocks. Optionally what was visible in the previous
//! frame is drawn first.
//!
//! Nodes at next to equal distances, a *shell*, are tested together and then opened or drawn: a test needs all that waits in the rasterizer's queues
//! drawn, and half-full queues are dear. What a shell's nodes hide of each other is lost, 0.1 percent more triangles on the plant.
//!
//! Bands of the screen walk by themselves, each testing a box's part in it; an object is visible where any band says so. Invariant: what a
//! band finds hidden would change no sample of it, so the picture is that of everything in the frustum, on any number of threads and whatever was
//! drawn first; and the visible set is the same on any number of bands. Cost: a test a node, and the draw of what is visible.

use homcull_simd::{Kernel, Level, Simd};

use super::VisibleSet;
use super::nearest_first::{NearestFirst, Waiting, begin, open_group};
use super::query_device::{Drawing, Query};
use super::vfc::World;
use crate::draw::{BandDraw, Canvas, clear, shade};
use crate::error::Result;
use crate::occlusion::{BoxView, PlacedRows, ProjectedBoxes};
use crate::raster::{Engine, RasterCounts};
use crate::view::View;
use crate::workers::Workers;

/// Last bits of distances by which the nodes of a shell may differ: a 32nd of a doubling.
const SHELL: u32 = 18;

/// What a frame leaves to the next one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HzbMemory {
    /// Objects found visible in the last frame, by id, to be drawn first; none where nothing is.
    previous: Vec<u32>,
}

impl HzbMemory {
    /// Forgets the frames before: for a teleport, or another scene.
    pub fn reset(&mut self) {
        self.previous.clear();
    }
}

/// Culls and draws a frame. The objects of the set are in order of their ids; they have been drawn.
///
/// # Errors
/// [`Error::View`](crate::error::Error::View) when the view and the canvas differ in size.
pub fn draw(
    world: &World<'_>,
    workers: &Workers,
    view: &View,
    previous_first: bool,
    memory: &mut HzbMemory,
    canvas: &mut Canvas,
) -> Result<VisibleSet> {
    let box_view = world.box_view(view);
    let level = canvas.level();
    let objects = world.scene.occluders.len();
    let mut first = vec![false; if previous_first { objects } else { 0 }];
    // Another scene has other objects, and some may have no part in this frame: none of them is drawn first.
    memory.previous.retain(|&o| previous_first && (o as usize) < objects && world.takes_part(o));
    for &object in &memory.previous {
        first[object as usize] = true;
    }
    let frame = Frame { level, world, view, box_view: &box_view, previous: &memory.previous, first: &first };
    let mut jobs: Vec<BandJob<'_>> = (canvas.bands(view, workers.bands())?.into_iter())
        .map(|band| BandJob { frame, band: Some(band), visible: vec![false; objects], queries: 0, hidden: 0 })
        .collect();
    workers.run(&mut jobs, BandJob::run);
    let mut set = VisibleSet::default();
    for job in &jobs {
        set.queries += job.queries;
        set.triangles_hidden += job.hidden;
    }
    set.objects = (0..objects as u32).filter(|&o| jobs.iter().any(|job| job.visible[o as usize])).collect();
    memory.previous.clear();
    if previous_first {
        memory.previous.extend_from_slice(&set.objects);
    }
    Ok(set)
}

/// What all bands share.
#[derive(Clone, Copy)]
struct Frame<'a> {
    level: Level,
    world: &'a World<'a>,
    view: &'a View,
    box_view: &'a BoxView,
    previous: &'a [u32],
    /// By object; empty where nothing is drawn first.
    first: &'a [bool],
}

struct BandJob<'a> {
    frame: Frame<'a>,
    band: Option<BandDraw<'a>>,
    visible: Vec<bool>,
    queries: u64,
    /// Triangles below what was found hidden.
    hidden: u64,
}

impl BandJob<'_> {
    fn run(&mut self) {
        if let Some(band) = self.band.take() {
            let level = self.frame.level;
            level.run(Walk { job: self, band });
        }
    }
}

struct Walk<'j, 'a> {
    job: &'j mut BandJob<'a>,
    band: BandDraw<'a>,
}

impl Kernel for Walk<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Walk { job, band: BandDraw { mut sink, queues, image } } = self;
        let Frame { world, view, box_view, previous, first, .. } = job.frame;
        let (scene, tree) = (world.scene, &world.tree);
        clear(&mut sink);
        let engine = Engine { simd: s, sink, queues, counts: RasterCounts::default(), cluster_test: true };
        let mut drawing = Drawing { engine, placed: PlacedRows::new(view), world, box_view, threshold: 0 };
        for &object in previous {
            drawing.draw(object);
        }
        let mut front = NearestFirst::default();
        begin(tree, &mut front);
        let mut children = ProjectedBoxes::new();
        let (mut shell, mut seen): (Vec<Waiting>, Vec<Waiting>) = (Vec::new(), Vec::new());
        loop {
            shell.clear();
            front.pop_shell(SHELL, &mut shell);
            if shell.is_empty() {
                break;
            }
            job.queries += shell.len() as u64;
            seen.clear();
            for waiting in &shell {
                if drawing.answer(Query::of(waiting)) > 0 {
                    seen.push(*waiting);
                    continue;
                }
                job.hidden += match waiting.group {
                    Some((group, _)) => world.group_triangles[group as usize],
                    None => u64::from(scene.triangles(waiting.b.id())),
                };
            }
            for waiting in &seen {
                if let Some(group) = waiting.group {
                    open_group(s, box_view, tree, group, &mut children, &mut front);
                    continue;
                }
                let id = waiting.b.id();
                job.visible[id as usize] = true;
                if !first.get(id as usize).is_some_and(|&drawn| drawn) {
                    drawing.draw(id);
                }
            }
        }
        drawing.engine.flush();
        shade(s, &drawing.engine.sink, &scene.colors, image);
    }
}
