//! Portals (Luebke and Georges 1995; lecture, *Portal Culling*): from the cell of the viewer through the portals into the cells
//! that can be seen, each with the region of the screen through which it is seen.
//!
//! A region is cut by each portal on its way (`clip=polygon`), or by the rectangle around what is left of it
//! (`clip=rectangle`, the papers' way). An object is drawn when, of what is in the frustum, the part of its box that lies in a
//! seen cell meets a region of that cell. Exact for cells whose walls have no cracks: the promise of [`Cells`].
//! Cells come with the scene, or are found in it ([`PreparedScene::found_cells`]).
//!
//! Invariants. A region that arrives in a cell and lies in one that was there before ends there, which ends cycles too: on its way
//! round a region only shrinks. A cell keeps a few regions; of more it keeps the rectangle around them in whole samples, so
//! that the walk ends after a number of steps that depends on cells and samples, not on the number of ways. Objects that are in no cell,
//! or partly outside the box around all cells, are always drawn. If rays begin in no cell, everything is.
//!
//! Cost: a polygon clip a portal of a seen cell and region, and a test of a clipped box an object and region.

mod region;
mod viewer;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use homcull_simd::Level;

use super::VisibleSet;
use super::vfc::{self, VfcMemory, World};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::scene::{Cells, FoundCells, ObjectCells, PreparedScene};
use crate::view::View;
use region::{Edges, Region};
use viewer::Viewer;

/// What cuts the view that a portal leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PortalClip {
    /// Its outline on the screen.
    #[default]
    Polygon,
    /// The rectangle around that.
    Rectangle,
}

/// Where cells and portals come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellsFrom {
    /// The scene, or [`PreparedScene::found_cells`] if it brings none.
    #[default]
    Any,
    /// The scene brings them.
    Given,
    /// [`PreparedScene::found_cells`], whatever the scene brings.
    Found,
}

/// Parameters of the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PortalParameters {
    /// What cuts the view.
    pub clip: PortalClip,
    /// Where cells and portals come from.
    pub cells: CellsFrom,
}

impl PortalParameters {
    /// Sets a parameter by name; `unknown` says that there is none of the name.
    pub(super) fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        match (key, value) {
            ("clip", "polygon") => self.clip = PortalClip::Polygon,
            ("clip", "rectangle") => self.clip = PortalClip::Rectangle,
            ("clip", _) => return Err(Error::parameter(key, value, "polygon or rectangle")),
            ("cells", "any") => self.cells = CellsFrom::Any,
            ("cells", "given") => self.cells = CellsFrom::Given,
            ("cells", "found") => self.cells = CellsFrom::Found,
            ("cells", _) => return Err(Error::parameter(key, value, "any, given or found")),
            _ => return Err(unknown()),
        }
        Ok(())
    }

    /// All parameters with their values.
    pub(super) fn list(&self) -> Vec<(String, String)> {
        let clip = match self.clip {
            PortalClip::Polygon => "polygon",
            PortalClip::Rectangle => "rectangle",
        };
        let cells = match self.cells {
            CellsFrom::Any => "any",
            CellsFrom::Given => "given",
            CellsFrom::Found => "found",
        };
        vec![("clip".into(), clip.into()), ("cells".into(), cells.into())]
    }
}

/// The covered part of the faces between found cells under which they are not worth walking.
const WORTHWHILE: f64 = 0.05;
/// Regions that a cell keeps apart. On oa_thor, whose found cells have many small portals, 24 leave a sixth fewer objects than 8.
const REGIONS: usize = 24;
const NONE: u32 = u32::MAX;

/// Cells, portals, and the objects in them: what does not change from frame to frame.
#[derive(Debug, Clone)]
pub struct PortalScene {
    cells: Cells,
    objects: ObjectCells,
}

impl PortalScene {
    /// The cells of a scene, as it brings them or found, with the objects in them.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it shall bring them and brings none, and when those found have next to no walls between them.
    pub fn new(scene: &PreparedScene, from: CellsFrom) -> Result<PortalScene> {
        let cells = match (from, &scene.cells) {
            (CellsFrom::Any | CellsFrom::Given, Some(cells)) => cells.clone(),
            (CellsFrom::Given, None) => {
                let reason =
                    "the scene brings no cells, as the generator rooms does, or NAME.cells.json beside NAME.obj";
                return Err(Error::parameter("method", "portals", reason));
            }
            (CellsFrom::Any, None) | (CellsFrom::Found, _) => worthwhile(scene.found_cells())?.clone(),
        };
        Ok(PortalScene { objects: ObjectCells::new(scene, &cells), cells })
    }

    /// The cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Which objects are in them.
    pub fn objects(&self) -> &ObjectCells {
        &self.objects
    }
}

/// Cells found, if walls part them.
fn worthwhile(found: &FoundCells) -> Result<&Cells> {
    let reason = match found.cells.cells().len() {
        _ if found.covered >= WORTHWHILE => return Ok(&found.cells),
        0 | 1 => "nothing to gain: no large opaque face lies across an axis, so that the scene is one cell".into(),
        n => format!(
            "nothing to gain: of the faces between the {n} cells found, opaque triangles are proven to cover {:.2} %",
            found.covered * 100.0
        ),
    };
    Err(Error::parameter("method", "portals", reason))
}

/// A region of a cell.
struct Seen {
    region: Region,
    edges: Edges,
    /// The cell's next region, or [`NONE`].
    next: u32,
    /// Whether its portals have been looked at.
    passed: bool,
}

/// Working memory, reused from frame to frame.
#[derive(Default)]
pub struct PortalMemory {
    vfc: VfcMemory,
    regions: Vec<Seen>,
    /// The first region of each cell, or [`NONE`].
    first: Vec<u32>,
    /// Cells that have been seen.
    seen: Vec<u32>,
    /// Cells with regions to pass on, nearest first: squared distance from the eye as bits, number.
    pending: BinaryHeap<Reverse<(u64, u32)>>,
    begins: Vec<(u32, Region)>,
    candidates: Vec<u32>,
    /// Whether the cells say what is seen.
    inside: bool,
}

/// What is in the frustum and seen through the portals, nearest first.
pub fn cull(
    world: &World<'_>,
    level: Level,
    view: &View,
    portals: &PortalScene,
    parameters: &PortalParameters,
    memory: &mut PortalMemory,
) -> VisibleSet {
    let mut set = vfc::cull(world, level, view, &mut memory.vfc);
    memory.look(portals, view, parameters.clip);
    let Some(viewer) = Viewer::new(view).filter(|_| memory.inside) else { return set };
    let scene = world.scene;
    set.queries = set.objects.len() as u64;
    set.objects.retain(|&object| {
        let shows = memory.shows(&viewer, portals, scene, object);
        set.triangles_hidden += if shows { 0 } else { u64::from(scene.triangles(object)) };
        shows
    });
    set
}

impl PortalMemory {
    /// The cells that the last view saw, in no order worth naming; `None` when rays began in no cell, and everything may be seen.
    pub fn seen(&self) -> Option<&[u32]> {
        self.inside.then_some(&self.seen)
    }

    /// Finds the cells that a view sees, and their regions.
    fn look(&mut self, portals: &PortalScene, view: &View, clip: PortalClip) {
        let cells = &portals.cells;
        self.seen.drain(..).for_each(|c| self.first[c as usize] = NONE);
        self.first.resize(cells.cells().len(), NONE);
        self.regions.clear();
        self.pending.clear();
        self.begins.clear();
        let Some(viewer) = Viewer::new(view) else {
            self.inside = false;
            return;
        };
        let begins = &mut self.begins;
        self.inside = viewer.begin(cells, &mut self.candidates, |cell, region| begins.push((cell, region)));
        if !self.inside {
            return;
        }
        for i in 0..self.begins.len() {
            let (cell, region) = self.begins[i];
            self.arrive(cells, &viewer, cell, region);
        }
        while let Some(Reverse((_, cell))) = self.pending.pop() {
            self.pass_on(cells, &viewer, cell, clip);
        }
    }

    /// A region comes into a cell.
    fn arrive(&mut self, cells: &Cells, viewer: &Viewer<'_>, cell: u32, region: Region) {
        let (mut count, mut at, mut around) = (0, self.first[cell as usize], region);
        if at == NONE {
            self.seen.push(cell);
        }
        while at != NONE {
            let known = &self.regions[at as usize];
            if known.region.contains(&region) {
                return;
            }
            around = around.join(&known.region);
            (count, at) = (count + 1, known.next);
        }
        let (region, next) = if count < REGIONS { (region, self.first[cell as usize]) } else { (around, NONE) };
        self.first[cell as usize] = self.regions.len() as u32;
        self.regions.push(Seen { region, edges: Edges::new(&region, viewer.rows()), next, passed: false });
        let c = &cells.cells()[cell as usize];
        let gap = (c.min - viewer.eye()).max(viewer.eye() - c.max).max(glam::DVec3::ZERO);
        self.pending.push(Reverse((gap.length_squared().to_bits(), cell)));
    }

    /// The regions of a cell go through its portals.
    fn pass_on(&mut self, cells: &Cells, viewer: &Viewer<'_>, cell: u32, clip: PortalClip) {
        let mut at = self.first[cell as usize];
        while at != NONE {
            let seen = &mut self.regions[at as usize];
            let (region, passed) = (seen.region, std::mem::replace(&mut seen.passed, true));
            at = seen.next;
            if passed {
                continue;
            }
            for (portal, beyond) in cells.portals_of(cell) {
                if let Some(left) = viewer.through(portal, portal.cells[0] == cell, &region) {
                    let left = if clip == PortalClip::Rectangle { left.around() } else { left };
                    self.arrive(cells, viewer, beyond, left);
                }
            }
        }
    }

    /// Whether an object may be seen, when the cells say so.
    fn shows(&self, viewer: &Viewer<'_>, portals: &PortalScene, scene: &PreparedScene, object: u32) -> bool {
        let cells = portals.objects.of(object);
        let Aabb { min, max } = scene.bounds[object as usize];
        let shift = scene.origin - viewer.eye();
        let (min, max) = (min.as_dvec3() + shift, max.as_dvec3() + shift);
        let slack = viewer.slack(min, max);
        cells.is_empty()
            || cells.iter().any(|&number| {
                let mut at = self.first[number as usize];
                if at == NONE {
                    return false;
                }
                // Only what of it is in the cell is seen there; faces a little outwards, as for objects.
                let cell = &portals.cells.cells()[number as usize];
                let out = glam::DVec3::splat((cell.max - cell.min).max_element() * 2e-6);
                let low = min.max(cell.min - out - viewer.eye());
                let high = max.min(cell.max + out - viewer.eye());
                while at != NONE {
                    let seen = &self.regions[at as usize];
                    if seen.edges.may_meet(low, high, slack) {
                        return true;
                    }
                    at = seen.next;
                }
                false
            })
    }
}
