//! Visibility preprocessing (Zhang 1998, 7.5): what is visible from the points of a grid, into a file that occluder selection
//! reads (`select/baked.rs`).
//!
//! Two passes: which points a viewer can reach (`reach.rs`), then, from those, an item-buffer cube (`cube.rs`). Both cull with
//! the library itself. Points are shared out to threads and found ones journalled in batches (`journal.rs`); each is a pure
//! function of the scene and the point, so the file is the same, byte for byte, at any SIMD level, on any number of threads and
//! however often the bake was interrupted. Cost: six pictures of `side` squared samples a point, and six small ones.

mod cube;
mod journal;
mod reach;

use std::ops::ControlFlow;
use std::path::Path;

use glam::DVec3;
use homcull_simd::Level;

use self::cube::Cube;
use self::journal::{Journal, Known};
use super::report_target::atomically;
use crate::cull::vfc::World;
use crate::error::{Error, Result};
use crate::raster::Facing;
use crate::scene::{PreparedScene, Scene};
use crate::select::{BakeHeader, Sight, ViewGrid, write_bake};
use crate::workers::Workers;

/// Samples along the side of a cube's face, unless said otherwise.
pub const DEFAULT_SIDE: u32 = 256;
/// Near distance of the cube over the diagonal of the scene, unless said otherwise.
pub const DEFAULT_NEAR: f64 = 1e-4;

/// How to bake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeOptions {
    /// The view points.
    pub grid: ViewGrid,
    /// Samples along the side of a cube's face, 1 to 16384.
    pub side: u32,
    /// Near distance of the cube, above 0.
    pub near: f64,
}

/// What a bake found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BakeSummary {
    /// View points.
    pub points: usize,
    /// Those skipped because one object encloses them.
    pub enclosed: usize,
    /// Those skipped because they see sides that are never drawn.
    pub back_sides: usize,
    /// Objects seen, summed over the points.
    pub seen: u64,
    /// Steps that the journal had done already, of two a point.
    pub resumed: usize,
}

/// The box of a scene in the world; `None` when it has none.
pub fn scene_box(scene: &Scene) -> Option<(DVec3, DVec3)> {
    let boxes = scene.objects.iter().map(|o| (scene.object_bounds(o, o.position), o.position));
    let corners = boxes
        .filter(|(b, at)| b.is_finite() && at.is_finite())
        .map(|(b, at)| (b.min.as_dvec3() + at, b.max.as_dvec3() + at));
    corners.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Bakes to `out`, or goes on with the journal beside it. `progress` gets the steps done, of two a point, after every batch; when
/// it breaks the bake ends with `None`, and the journal stays.
///
/// # Errors
/// [`Error::Parameter`] for an impossible side or near distance; [`Error::Mesh`], [`Error::View`] for a scene that cannot be
/// drawn; [`Error::File`] and [`Error::Format`] for files that cannot be written, or a journal of another bake.
pub fn bake(
    scene: &Scene,
    options: &BakeOptions,
    level: Level,
    workers: &Workers,
    out: &Path,
    mut progress: impl FnMut(usize) -> ControlFlow<()>,
) -> Result<Option<BakeSummary>> {
    if !(options.near > 0.0 && options.near.is_finite()) {
        return Err(Error::parameter("near", options.near, "must be above 0"));
    }
    let mut prepared = PreparedScene::new(scene)?;
    let objects = prepared.occluders.len();
    let BakeOptions { grid, side, near } = *options;
    let header = BakeHeader { scene: prepared.hash, objects: objects as u32, grid, side, near };
    let (mut journal, mut known) = Journal::open(out, &header)?;
    let done = |known: &[Known]| known.iter().map(steps).sum::<usize>();
    let resumed = done(&known);
    if progress(resumed).is_break() {
        return Ok(None);
    }

    prepared.occluders.iter_mut().for_each(|o| o.facing = Facing::Both);
    let world = World::new(&prepared);
    let cubes = cubes(workers, || Cube::new(reach::SIDE, near, objects, level))?;
    let find = |cube: &mut Cube, point: usize| {
        let found = reach::out_of_reach(scene, &world, cube, grid.point(point))?;
        Ok(found.map_or(Known::Reached, Known::All))
    };
    let mut batch = Batches { journal: &mut journal, known: &mut known, workers, progress: &mut progress };
    if batch.run(cubes, |k| *k == Known::Nothing, find)?.is_break() {
        return Ok(None);
    }

    for (occluder, object) in prepared.occluders.iter_mut().zip(&scene.objects) {
        occluder.facing = object.facing;
    }
    let world = World::new(&prepared);
    let cubes = self::cubes(workers, || Cube::new(side, near, objects, level))?;
    let find = |cube: &mut Cube, point: usize| Ok(Known::All(Sight::Seen(cube.sight(&world, grid.point(point))?)));
    if batch.run(cubes, |k| *k == Known::Reached, find)?.is_break() {
        return Ok(None);
    }

    let sights: Vec<Sight> =
        known.into_iter().filter_map(|k| if let Known::All(s) = k { Some(s) } else { None }).collect();
    atomically(out, |file| write_bake(file, &header, &sights))?;
    journal.remove()?;
    Ok(Some(summary(&sights, resumed)))
}

/// Steps done for a point.
fn steps(known: &Known) -> usize {
    match known {
        Known::Nothing => 0,
        Known::Reached => 1,
        Known::All(_) => 2,
    }
}

/// Cubes for a batch: a few a thread, so that uneven points even out.
fn cubes(workers: &Workers, new: impl Fn() -> Result<Cube>) -> Result<Vec<Cube>> {
    (0..4 * workers.threads()).map(|_| new()).collect()
}

/// Finds what is missing, a batch of points at a time.
struct Batches<'a, P> {
    journal: &'a mut Journal,
    known: &'a mut Vec<Known>,
    workers: &'a Workers,
    progress: &'a mut P,
}

/// A point to be looked from, and what was found there.
struct Job {
    cube: Cube,
    point: Option<usize>,
    found: Result<Known>,
}

impl<P: FnMut(usize) -> ControlFlow<()>> Batches<'_, P> {
    fn run(
        &mut self,
        cubes: Vec<Cube>,
        missing: impl Fn(&Known) -> bool,
        find: impl Fn(&mut Cube, usize) -> Result<Known> + Sync + Send,
    ) -> Result<ControlFlow<()>> {
        let points: Vec<usize> = (0..self.known.len()).filter(|&p| missing(&self.known[p])).collect();
        let mut jobs: Vec<Job> =
            cubes.into_iter().map(|cube| Job { cube, point: None, found: Ok(Known::Nothing) }).collect();
        for batch in points.chunks(jobs.len()) {
            for (i, job) in jobs.iter_mut().enumerate() {
                job.point = batch.get(i).copied();
            }
            self.workers.run(&mut jobs, |job| {
                if let Some(point) = job.point {
                    job.found = find(&mut job.cube, point);
                }
            });
            for job in &mut jobs {
                let Some(point) = job.point else { continue };
                self.known[point] = std::mem::replace(&mut job.found, Ok(Known::Nothing))?;
            }
            self.journal.append(batch.iter().map(|&p| (p, &self.known[p])))?;
            let done = self.known.iter().map(steps).sum();
            if (self.progress)(done).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }
}

fn summary(sights: &[Sight], resumed: usize) -> BakeSummary {
    let mut out = BakeSummary { points: sights.len(), resumed, ..BakeSummary::default() };
    for sight in sights {
        match sight {
            Sight::Seen(seen) => out.seen += seen.len() as u64,
            Sight::Enclosed => out.enclosed += 1,
            Sight::BackSides => out.back_sides += 1,
        }
    }
    out
}

/// The near distance that a scene of this size is baked with unless told otherwise.
pub fn default_near(corners: (DVec3, DVec3)) -> f64 {
    let diagonal = (corners.1 - corners.0).length() * DEFAULT_NEAR;
    if diagonal > 0.0 { diagonal } else { DEFAULT_NEAR }
}
