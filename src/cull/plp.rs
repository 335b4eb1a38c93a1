//! Prioritized-layered projection (Correa, Klosowski and Silva 2002, *Fast and simple occlusion culling*; Klosowski and Silva 2000).
//!
//! A front of cells grows away from where the view begins. A cell that leaves it is *projected*: its objects are looked at, its neighbours
//! join the front; until a budget of triangles is spent. What is left out is not known to be hidden: the set is
//! **approximate**, the front only its best guess. Two heuristics say what the budget is spent on:
//!
//! * **Layer** (the gem's): the cell of the fewest layers is next, and all of its objects are taken.
//! * **Accumulated solidity** (after Klosowski and Silva 2000): the nearest cell is next, and is asked how much of its rectangle the objects met
//!   before leave open (`accumulated_solidity.rs`). One of which less than a thousandth is expected to show waits. Of the objects met, those with
//!
//! ```text
//! samples that are expected to show it / its triangles
//! ```
//!
//!   the greatest are taken, as far as the budget goes; if it goes further, the cells that waited follow, in the same way.
//!
//! Why: on the plant (12.7 million triangles, 10 frames) the visible objects have 191,000 triangles, of which 5,800 show. A budget of 140,000
//! could get 98.7 percent of the pixels right; layers get 79 to 88, by their leaves' size, as two thirds of what they take is near,
//! large and hidden; accumulated solidity gets 97. A front that goes for the least solidity first (49), or for the greatest gain (89), runs off
//! along open rays before what is near has closed them.
//!
//! Beside the gem:
//!
//! * The view begins in every cell that touches the near plane in the frustum. If the eye lies outside the octree, it also begins in all
//!   cells of the frustum at those sides of the whole that face the eye: a ray enters the octree through one of them or not
//!   at all. (The gem begins in the one cell nearest to the eye, and stops dead if that and its neighbours are not in the
//!   frustum.) An orthographic view begins at all sides.
//! * Cells and objects outside the frustum, or whose rectangle holds no sample, take nothing of the budget.
//! * The set is of objects, each counted once, with all of its triangles: subdivide those that are large (`plant:split=100`). The first is always
//!   taken; the walk ends before the budget would be passed.
//! * Leaves of the hierarchy do not fill space: where their front runs dry, it begins anew in the nearest cell not met.
//!
//! **Cost**: all cells and objects in the frustum are projected onto the screen, 16 at a time; then a few dozen nanoseconds for
//! each projected cell's neighbour, and with accumulated solidity some tenth of a microsecond an object. Nothing is drawn. See
//! `cplp.rs` for the conservative version.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use homcull_simd::Level;

use super::VisibleSet;
use super::accumulated_solidity::AccumulatedSolidity;
use super::front::{CellState, Front};
use super::plp_cells::{PlpCells, Unmet};
use super::plp_parameters::{Heuristic, PlpParameters};
use super::vfc::World;
use crate::geometry::Aabb;
use crate::occlusion::{Project, ProjectedBox, ProjectedBoxes};
use crate::view::View;

/// In lists of places: not in the frustum.
pub(super) const NOWHERE: u32 = u32::MAX;
/// An eye nearer to a side than this part of the octree counts as beyond it.
const SIDE_SLACK: f64 = 1e-4;
/// A cell of whose samples less than this share is expected to be open waits.
const OPEN: f32 = 1e-3;

/// What `plp` and `cplp` keep from frame to frame: the cells, and working memory. Frames may change between the two, and
/// between parameters; what a frame finds does not depend on those before.
pub struct PlpFrame {
    pub(super) level: Level,
    pub(super) cells: Arc<PlpCells>,
    pub(super) front: Front,
    unmet: Unmet,
    /// Cells in the frustum, nearest first, and the place of each cell among them.
    pub(super) cell_boxes: ProjectedBoxes,
    pub(super) cell_places: Vec<u32>,
    /// Objects in the frustum, likewise.
    pub(super) objects: ProjectedBoxes,
    pub(super) object_places: Vec<u32>,
    /// By place: objects that were taken, or refused for good.
    pub(super) met: Vec<bool>,
    /// The visible set, by place, in the order in which it was taken.
    pub(super) taken: Vec<u32>,
    /// Places of the objects to be looked at next.
    pub(super) pending: Vec<u32>,
    heuristic: Heuristic,
    solidity: AccumulatedSolidity,
    /// Objects met and not taken yet, with what each triangle is expected to show, in samples.
    candidates: Vec<(f32, u32)>,
    /// Cells that wait, as little of them is expected to show.
    waiting: Vec<u32>,
    /// The first cell, by place, that may be seeded when the front is dry.
    next_seed: usize,
    stack: Vec<(u32, u8)>,
    neighbours: Vec<u32>,
    pub(super) strays: usize,
}

impl PlpFrame {
    /// For frames over these cells.
    pub fn new(level: Level, cells: Arc<PlpCells>) -> PlpFrame {
        PlpFrame {
            level,
            cells,
            front: Front::default(),
            unmet: Unmet::default(),
            cell_boxes: ProjectedBoxes::new(),
            cell_places: Vec::new(),
            objects: ProjectedBoxes::new(),
            object_places: Vec::new(),
            met: Vec::new(),
            taken: Vec::new(),
            pending: Vec::new(),
            heuristic: Heuristic::default(),
            solidity: AccumulatedSolidity::default(),
            candidates: Vec::new(),
            waiting: Vec::new(),
            next_seed: 0,
            stack: Vec::new(),
            neighbours: Vec::new(),
            strays: 0,
        }
    }

    /// The cells that are projected.
    pub fn cells(&self) -> &Arc<PlpCells> {
        &self.cells
    }

    /// Cells that the last frame projected, ascending.
    pub fn projected(&self) -> Vec<u32> {
        (0..self.cells.len() as u32).filter(|&c| self.front.state(c) == CellState::Projected).collect()
    }

    /// The visible set of `plp`, nearest first.
    pub fn plp(&mut self, world: &World<'_>, view: &View, parameters: &PlpParameters) -> VisibleSet {
        self.begin(world, view, parameters);
        self.guess(world, view, parameters.budget);
        self.set(world)
    }

    /// Begins a frame: what is in the frustum, and the cells that the view begins in.
    pub(super) fn begin(&mut self, world: &World<'_>, view: &View, parameters: &PlpParameters) {
        if !self.cells.are_of(world.scene, parameters) {
            self.cells = Arc::new(PlpCells::new(world.scene, parameters));
        }
        let box_view = world.box_view(view);
        world.collect(self.level, view, true, &mut self.stack, &mut self.objects);
        self.level.run(Project { view: &box_view, set: &self.cells.boxes, out: &mut self.cell_boxes });
        self.cell_boxes.sort();
        places(&self.objects, world.scene.bounds.len(), &mut self.object_places);
        places(&self.cell_boxes, self.cells.len(), &mut self.cell_places);
        self.heuristic = parameters.heuristic;
        self.taken.clear();
        self.begin_front(view, world.scene.origin);
    }

    /// The front where the view begins, nothing met.
    pub(super) fn begin_front(&mut self, view: &View, origin: DVec3) {
        let cells = self.cells.clone();
        self.met.clear();
        self.met.resize(self.objects.len(), false);
        self.pending.clear();
        (self.next_seed, self.strays) = (0, 0);
        cells.begin(&mut self.unmet);
        self.front.begin(cells.len());
        let facing = cells.octree().map_or(0, |octree| facing_sides(octree.cube(), eye(view, origin)));
        for place in 0..self.cell_boxes.len() {
            let b = self.cell_boxes.boxes()[place];
            let at_side = |octree: &crate::scene::Octree| octree.boundary(b.id()) & facing != 0;
            if b.touches_near_plane() || shows(&b) && cells.octree().is_some_and(at_side) {
                self.seed(b.id());
            }
        }
    }

    /// A cell that the view begins in, or begins anew in.
    fn seed(&mut self, cell: u32) {
        self.cells.meet(cell, &mut self.unmet);
        let rank = match self.heuristic {
            Heuristic::Layer => 0,
            Heuristic::Solidity => self.cell_places[cell as usize],
        };
        self.front.push(cell, rank);
    }

    /// Takes objects until the budget is spent or the front is empty.
    pub(super) fn guess(&mut self, world: &World<'_>, view: &View, budget: u64) {
        let mut left = Budget { triangles: budget, any: false };
        // What has no box is in no cell.
        let unbounded = world.tree.unbounded.iter().map(|&id| self.object_places[id as usize]);
        self.pending.extend(unbounded.filter(|&place| place != NOWHERE));
        if !self.take_pending(world, &mut left) {
            return;
        }
        match self.heuristic {
            Heuristic::Layer => self.guess_by_layers(world, &mut left),
            Heuristic::Solidity => self.guess_by_solidity(world, view, &mut left),
        }
    }

    fn guess_by_layers(&mut self, world: &World<'_>, left: &mut Budget) {
        while let Some(cell) = self.next() {
            self.gather(cell);
            if !self.take_pending(world, left) {
                return;
            }
            self.project(cell);
        }
    }

    fn guess_by_solidity(&mut self, world: &World<'_>, view: &View, left: &mut Budget) {
        self.solidity.begin(view, world.scene.origin);
        self.candidates.clear();
        self.waiting.clear();
        for may_wait in [true, false] {
            while let Some(cell) = self.next() {
                if may_wait && self.is_closed(cell) {
                    self.waiting.push(cell);
                    continue;
                }
                self.gather(cell);
                self.weigh_pending(world);
                self.project(cell);
            }
            self.candidates.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            self.pending.clear();
            self.pending.extend(self.candidates.drain(..).map(|(_, place)| place));
            if !self.take_pending(world, left) {
                return;
            }
            for cell in self.waiting.drain(..) {
                self.front.put_back(cell);
            }
        }
    }

    /// Whether next to nothing of a cell is expected to show.
    fn is_closed(&self, cell: u32) -> bool {
        let b = &self.cell_boxes.boxes()[self.cell_places[cell as usize] as usize];
        !b.touches_near_plane() && self.solidity.open_share(b) < OPEN
    }

    /// What is pending becomes candidates, and stands before what comes.
    fn weigh_pending(&mut self, world: &World<'_>) {
        let scene = world.scene;
        for i in 0..self.pending.len() {
            let place = self.pending[i];
            let b = self.objects.boxes()[place as usize];
            let object = b.id();
            self.met[place as usize] = true;
            let (bounds, areas) = (scene.bounds[object as usize], self.cells.areas[object as usize]);
            let samples = self.solidity.meet(&b, bounds, areas, scene.occluders[object as usize].opaque);
            self.candidates.push((samples / scene.triangles(object).max(1) as f32, place));
        }
    }

    /// Takes what is pending; false when the budget ends before.
    fn take_pending(&mut self, world: &World<'_>, left: &mut Budget) -> bool {
        for i in 0..self.pending.len() {
            let place = self.pending[i];
            let id = self.objects.boxes()[place as usize].id();
            if !left.take(world.scene.triangles(id).into()) {
                return false;
            }
            self.met[place as usize] = true;
            self.taken.push(place);
        }
        true
    }

    /// The cell of the front that is next.
    pub(super) fn next(&mut self) -> Option<u32> {
        loop {
            if let Some(cell) = self.front.pop() {
                return Some(cell);
            }
            if self.cells.octree().is_some() {
                return None;
            }
            let rest = &self.cell_boxes.boxes()[self.next_seed..];
            let clean = |b: &ProjectedBox| shows(b) && self.front.state(b.id()) == CellState::Clean;
            let skipped = rest.iter().position(clean)?;
            let cell = rest[skipped].id();
            self.next_seed += skipped + 1;
            self.seed(cell);
        }
    }

    /// The objects of a cell that are in the frustum, may show and were not met, nearest first.
    pub(super) fn gather(&mut self, cell: u32) {
        self.pending.clear();
        for &id in self.cells.objects(cell) {
            let place = self.object_places[id as usize];
            if place != NOWHERE && !self.met[place as usize] && shows(&self.objects.boxes()[place as usize]) {
                self.pending.push(place);
            }
        }
        self.pending.sort_unstable();
    }

    /// A cell's neighbours join the front that it left.
    pub(super) fn project(&mut self, cell: u32) {
        let PlpFrame { cells, front, unmet, cell_boxes, cell_places, neighbours, heuristic, .. } = self;
        front.set_state(cell, CellState::Projected);
        cells.neighbours(cell, unmet, neighbours);
        for &to in neighbours.iter() {
            if front.state(to) != CellState::Clean {
                continue;
            }
            cells.meet(to, unmet);
            let place = cell_places[to as usize];
            if place == NOWHERE || !shows(&cell_boxes.boxes()[place as usize]) {
                front.set_state(to, CellState::Unseen);
                continue;
            }
            let rank = match heuristic {
                Heuristic::Layer => front.rank(cell) + 1,
                Heuristic::Solidity => place,
            };
            front.push(to, rank);
        }
    }

    /// What was taken, nearest first.
    pub(super) fn set(&self, world: &World<'_>) -> VisibleSet {
        let all: Vec<u32> = self.objects.boxes().iter().map(|b| b.id()).collect();
        let mut taken = self.taken.clone();
        taken.sort_unstable();
        VisibleSet {
            objects: taken.iter().map(|&place| all[place as usize]).collect(),
            in_frustum: all.len() as u32,
            triangles_in_frustum: world.triangles(&all),
            ..VisibleSet::default()
        }
    }
}

/// What is left of the budget.
struct Budget {
    triangles: u64,
    any: bool,
}

impl Budget {
    fn take(&mut self, triangles: u64) -> bool {
        let fits = triangles <= self.triangles || !self.any;
        if fits {
            (self.triangles, self.any) = (self.triangles.saturating_sub(triangles), true);
        }
        fits
    }
}

/// Whether a box in the frustum may touch a sample.
fn shows(b: &ProjectedBox) -> bool {
    b.touches_near_plane() || !b.rect().is_empty()
}

/// The place of each of `n` boxes among those in the frustum.
fn places(boxes: &ProjectedBoxes, n: usize, out: &mut Vec<u32>) {
    out.clear();
    out.resize(n, NOWHERE);
    for (place, b) in boxes.boxes().iter().enumerate() {
        out[b.id() as usize] = place as u32;
    }
}

/// Where a perspective view looks from, about the scene's origin.
fn eye(view: &View, origin: DVec3) -> Option<Vec3> {
    view.projection_center().map(|center| (view.eye() - origin + center).as_vec3())
}

/// The sides of a box that rays of the view may enter through, as [`Octree::boundary`](crate::scene::Octree::boundary) numbers them.
fn facing_sides(whole: Aabb, eye: Option<Vec3>) -> u8 {
    let Some(eye) = eye.filter(|eye| eye.is_finite()) else { return !0 };
    let eye = eye.as_dvec3();
    let slack = f64::from(whole.size().max_element()) * SIDE_SLACK + eye.abs().max_element() * 1e-6;
    (0..3).fold(0, |sides, axis| {
        let below = eye[axis] <= f64::from(whole.min[axis]) + slack;
        let above = eye[axis] >= f64::from(whole.max[axis]) - slack;
        sides | u8::from(below) << axis | u8::from(above) << (axis + 3)
    })
}
