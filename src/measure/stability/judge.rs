//! One case's pictures, states and verdicts, at every level, against each other and against the item buffer.

use std::collections::HashMap;

use homcull_simd::Level;

use super::depth::{RayTriangle, Truth};
use super::{Known, StabilityRow};
use crate::cull::hom::{self, HomFrame};
use crate::cull::vfc::{self, VfcMemory, World};
use crate::cull::{HomParameters, Update};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::occlusion::{
    DepthReading, DepthRepresentation, Occluders, OcclusionBuffer, OcclusionSettings, ProgressiveJob, ProjectedBoxes,
    Verdict,
};
use crate::scene::{PreparedScene, Scene};
use crate::view::View;
use crate::workers::Workers;

/// Samples of a view whose depth is compared, at most.
const COMPARED: usize = 4000;
/// Triangles between updates of the multi-pass method: few, so that there are several passes.
const UPDATE_TRIANGLES: u64 = 40;
/// Faults of one kind that are told one by one.
const MOST_TOLD: usize = 3;

/// What one level found in one view.
#[derive(PartialEq)]
struct Found {
    /// By object: hidden, each with the way it was found.
    hidden: Vec<(&'static str, Vec<bool>)>,
    reasons: Vec<Verdict>,
    states: Vec<u64>,
    picture: u64,
}

/// Buffers and pictures of one level.
struct Bench<'a> {
    scene: &'a PreparedScene,
    world: &'a World<'a>,
    level: Level,
    workers: Workers,
    buffer: OcclusionBuffer,
    boxes: ProjectedBoxes,
    full: Canvas,
    culled: Canvas,
    shown: Vec<u32>,
}

/// Looks at all views at all levels.
pub(super) fn pictures(
    scene: &Scene,
    world: &World<'_>,
    views: &[View],
    levels: &[Level],
    row: &mut StabilityRow,
) -> Result<()> {
    row.levels = levels.len();
    let mut gold: Vec<Found> = Vec::new();
    for (l, &level) in levels.iter().enumerate() {
        let Some(first) = views.first() else { return Ok(()) };
        let mut bench = Bench::new(world, level, first)?;
        for (v, view) in views.iter().enumerate() {
            let found = bench.look(view, v, row)?;
            if l == 0 {
                let hidden = found.hidden[0].1.iter().filter(|&&h| h).count() as u64;
                row.hidden += hidden;
                row.visible += scene.objects.len() as u64 - hidden;
                bench.compare_depths(scene, view, v, row);
                gold.push(found);
            } else if let Some(what) = found.difference(&gold[v]) {
                row.levels_equal = false;
                tell(row, format!("view {v}: {what} at {} differs from {}", level.name(), levels[0].name()));
            }
        }
    }
    Ok(())
}

fn tell(row: &mut StabilityRow, failure: String) {
    if row.failures.len() < 4 * MOST_TOLD {
        row.failures.push(failure);
    }
}

impl Found {
    fn difference(&self, gold: &Found) -> Option<&'static str> {
        if self.picture != gold.picture {
            return Some("the picture");
        }
        if self.states != gold.states {
            return Some("a state");
        }
        if self.reasons != gold.reasons {
            return Some("a verdict");
        }
        let set = self.hidden.iter().zip(&gold.hidden).find(|(a, b)| a != b);
        set.map(|(a, _)| a.0)
    }
}

impl<'a> Bench<'a> {
    fn new(world: &'a World<'a>, level: Level, view: &View) -> Result<Bench<'a>> {
        let viewport = view.viewport();
        Ok(Bench {
            scene: world.scene,
            world,
            level,
            workers: Workers::new(1)?,
            buffer: OcclusionBuffer::with_level(viewport, level, OcclusionSettings::default())?,
            boxes: ProjectedBoxes::new(),
            full: Canvas::new(viewport, level)?,
            culled: Canvas::new(viewport, level)?,
            shown: vec![0; world.scene.occluders.len()],
        })
    }

    fn look(&mut self, view: &View, v: usize, row: &mut StabilityRow) -> Result<Found> {
        let all: Vec<u32> = (0..self.scene.occluders.len() as u32).collect();
        let run = |jobs: &mut [DrawJob<'_>]| jobs.iter_mut().for_each(DrawJob::run);
        self.full.draw(view, self.scene, &all, 1, run)?;
        self.full.count_items(self.scene, &mut self.shown);
        let mut found =
            Found { hidden: Vec::new(), reasons: Vec::new(), states: Vec::new(), picture: self.full.hash(self.scene) };
        self.progressive(view, v, &mut found, row)?;
        self.methods(view, &mut found)?;
        // Last, so that the full buffer is there for what follows; first in the list, for the row's counts.
        self.queries(view, v, &mut found, row)?;
        let kept: Vec<u32> = all.into_iter().filter(|&o| found.hidden.iter().all(|(_, h)| !h[o as usize])).collect();
        for (way, hidden) in &found.hidden {
            let culled = (0..hidden.len()).filter(|&o| hidden[o] && self.shown[o] > 0);
            for (n, o) in culled.enumerate() {
                row.false_culls += 1;
                if n < MOST_TOLD {
                    let at = self.level.name();
                    tell(
                        row,
                        format!("view {v}: {way} at {at} hides object {o}, of which {} samples show", self.shown[o]),
                    );
                }
            }
        }
        self.culled.draw(view, self.scene, &kept, 2, run)?;
        if !self.culled.equals(&self.full) {
            let wrong = self.culled.differing_samples(&self.full, self.scene);
            tell(
                row,
                format!("view {v}: the picture of what is left differs in {wrong} samples at {}", self.level.name()),
            );
        }
        Ok(found)
    }

    /// The boxes of the view, sorted, and everything outside as hidden.
    fn project(&mut self, view: &View) -> Result<Vec<bool>> {
        self.buffer.begin(view)?;
        self.buffer.project(&self.scene.boxes, self.scene.origin, &mut self.boxes)?;
        self.boxes.sort();
        Ok(vec![true; self.scene.occluders.len()])
    }

    fn queries(&mut self, view: &View, v: usize, found: &mut Found, row: &mut StabilityRow) -> Result<()> {
        let none = self.project(view)?;
        let (bounds, origin) = (&self.scene.bounds, self.scene.origin);
        let readings = [("query by block", DepthReading::PerBlock), ("query", DepthReading::PerSample)];
        self.buffer.submit(&self.scene.meshes, &self.scene.occluders)?;
        for (way, reading) in readings {
            let depth = DepthRepresentation::NoBackground(reading);
            let settings = OcclusionSettings { depth, ..self.buffer.settings().clone() };
            self.buffer.set_settings(settings)?;
            let mut flags = Vec::new();
            self.buffer.test_projected(&self.boxes, 0..self.boxes.len(), bounds, origin, &mut flags)?;
            let mut hidden = none.clone();
            for (b, &h) in self.boxes.boxes().iter().zip(&flags) {
                hidden[b.id() as usize] = h;
            }
            found.hidden.insert(0, (way, hidden));
        }
        for (o, &b) in bounds.iter().enumerate() {
            let verdict = self.buffer.test(b, origin)?;
            found.reasons.push(verdict);
            if verdict.is_hidden() != found.hidden[0].1[o] {
                tell(row, format!("view {v}: alone, object {o} is {verdict:?}; in a list it is not"));
            }
        }
        found.states.push(self.buffer.state_hash());
        Ok(())
    }

    fn progressive(&mut self, view: &View, v: usize, found: &mut Found, row: &mut StabilityRow) -> Result<()> {
        for (way, bands) in [("progressive", 1), ("progressive in 3 bands", 3)] {
            let mut hidden = self.project(view)?;
            let Bench { scene, buffer, boxes, .. } = self;
            let world = Occluders {
                meshes: &scene.meshes,
                occluders: &scene.occluders,
                bounds: &scene.bounds,
                origin: scene.origin,
            };
            let mut visible = Vec::new();
            let run = |jobs: &mut [ProgressiveJob<'_>]| jobs.iter_mut().for_each(ProgressiveJob::run);
            buffer.progressive(boxes, &world, &mut visible, bands, run)?;
            for (b, &visible) in boxes.boxes().iter().zip(&visible) {
                hidden[b.id() as usize] = !visible;
            }
            found.states.push(buffer.state_hash());
            found.hidden.push((way, hidden));
        }
        if found.states[0] != found.states[1] || found.hidden[0].1 != found.hidden[1].1 {
            tell(row, format!("view {v}: progressive culling depends on the bands"));
        }
        Ok(())
    }

    /// The methods through the hierarchy.
    fn methods(&mut self, view: &View, found: &mut Found) -> Result<()> {
        let hidden = |kept: &[u32]| {
            let mut hidden = vec![true; self.scene.occluders.len()];
            kept.iter().for_each(|&o| hidden[o as usize] = false);
            hidden
        };
        let set = vfc::cull(self.world, self.level, view, &mut VfcMemory::default());
        found.hidden.push(("vfc", hidden(&set.objects)));
        let updates = [
            ("hom", Update::Once),
            ("hom-multipass", Update::Batches(UPDATE_TRIANGLES)),
            ("hom-progressive", Update::Always),
        ];
        for (way, update) in updates {
            let parameters = HomParameters::new(update);
            let frame = HomFrame::new(view, self.level, &parameters)?;
            let frame = hom::select_occluders(self.world, self.level, view, &parameters, frame)?;
            let frame = hom::draw_occluders(self.world, &self.workers, frame)?;
            let (set, frame) = hom::cull(self.world, &self.workers, &parameters, hom::build_pyramid(frame))?;
            found.states.push(frame.buffer.state_hash());
            found.hidden.push((way, hidden(&set.objects)));
        }
        Ok(())
    }

    /// Drawn depths against f64, and the full buffer's depths against the drawn ones.
    fn compare_depths(&self, scene: &Scene, view: &View, v: usize, row: &mut StabilityRow) {
        let (width, height) = (self.full.width(), self.full.height());
        // An odd stride wanders over the columns.
        let step = (width * height / COMPARED).max(1) | 1;
        let mut triangles: HashMap<u32, RayTriangle> = HashMap::new();
        let (mut strays, mut nearer, mut over) = (0, 0, 0);
        let mut worst = String::new();
        for at in (0..width * height).step_by(step) {
            let (x, y) = (at % width, at / width);
            let (sx, sy) = (x as u32, y as u32);
            let item = self.full.item(x, y);
            let kept = self.buffer.depth_at(sx, sy).unwrap_or(0.0);
            nearer += u32::from(kept > item.map_or(0.0, |(z, _)| z));
            let Some((z, number)) = item else { continue };
            let triangle = triangles.entry(number).or_insert_with(|| {
                let id = self.scene.object_of(number);
                let own = number - self.scene.first_triangle[id as usize];
                RayTriangle::new(view, scene, &scene.objects[id as usize], own as usize)
            });
            match triangle.at(sx, sy) {
                Truth::Inside { depth, bound } => {
                    let error = (f64::from(z) - depth).abs();
                    row.samples += 1;
                    let relative = error / depth.abs();
                    if relative > row.depth_error || row.samples == 1 {
                        (row.depth_error, row.depth_bound) = (relative, bound / depth.abs());
                    }
                    if error > bound {
                        over += 1;
                        if error / bound > row.depth_share {
                            worst =
                                format!("triangle {number} at ({x}, {y}): drawn {z:e}, is {depth:e}, bound {bound:e}");
                        }
                    }
                    row.depth_share = row.depth_share.max(error / bound);
                }
                Truth::Outside => {
                    strays += 1;
                    if strays == 1 {
                        tell(row, format!("view {v}: triangle {number} is drawn at ({x}, {y}), where it is not"));
                    }
                }
                Truth::Unsure => {}
            }
        }
        if over > 0 {
            tell(row, format!("view {v}: {over} depths err by more than their bound, {worst}"));
        }
        if strays > 1 {
            tell(row, format!("view {v}: {strays} samples show triangles that are not there"));
        }
        if nearer > 0 {
            tell(row, format!("view {v}: {nearer} samples are kept nearer than drawn"));
        }
    }
}

/// Looks at a view whose answers are known, one level after the other, each buffer dropped before the next is made.
pub(super) fn buffer(known: &Known, levels: &[Level], row: &mut StabilityRow) -> Result<()> {
    row.levels = levels.len();
    let scene = PreparedScene::new(&known.scene)?;
    let mut gold = None;
    for &level in levels {
        let viewport = known.view.viewport();
        let mut buffer = OcclusionBuffer::with_level(viewport, level, OcclusionSettings::default())?;
        let mut found = Vec::new();
        buffer.begin(&known.view)?;
        let mut boxes = ProjectedBoxes::new();
        buffer.project(&scene.boxes, scene.origin, &mut boxes)?;
        boxes.sort();
        let world = Occluders {
            meshes: &scene.meshes,
            occluders: &scene.occluders,
            bounds: &scene.bounds,
            origin: scene.origin,
        };
        let mut visible = Vec::new();
        buffer.progressive(&boxes, &world, &mut visible, 1, |jobs| jobs.iter_mut().for_each(ProgressiveJob::run))?;
        let mut progressive = vec![true; known.hidden.len()];
        for (b, &visible) in boxes.boxes().iter().zip(&visible) {
            progressive[b.id() as usize] = !visible;
        }
        found.push(("progressive", progressive));
        // What was hidden adds nothing: drawn over it, everything leaves the state of a full draw.
        buffer.submit(&scene.meshes, &scene.occluders)?;
        let query: Result<Vec<bool>> =
            scene.bounds.iter().map(|&b| Ok(buffer.test(b, scene.origin)?.is_hidden())).collect();
        found.push(("query", query?));
        let state = buffer.state_hash();
        drop(buffer);
        for (way, hidden) in &found {
            for (o, (&is, &should)) in hidden.iter().zip(&known.hidden).enumerate() {
                if is != should {
                    row.false_culls += u64::from(is);
                    tell(row, format!("{way} at {}: object {o} hidden {is}, should be {should}", level.name()));
                }
            }
        }
        match &gold {
            None => {
                row.hidden = found[1].1.iter().filter(|&&h| h).count() as u64;
                row.visible = known.hidden.len() as u64 - row.hidden;
                gold = Some((found, state));
            }
            Some(gold) if *gold != (found, state) => {
                row.levels_equal = false;
                tell(row, format!("{} differs from {}", level.name(), levels[0].name()));
            }
            Some(_) => {}
        }
    }
    Ok(())
}
