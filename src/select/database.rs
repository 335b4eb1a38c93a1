//! The occluder database (Zhang 1998, 3.2 and 7.3): what may occlude, in a hierarchy of its own, apart from the model's.
//!
//! An occluder is one of the scene's objects, or a mesh given as an occluder and drawn nowhere else. Per view the tree is walked
//! within the frustum, nearest first, until enough is chosen: what is farther is never looked at. The order is that of a full
//! sort of what is in the frustum: a group is never farther than what is below it, in f32 as in truth, since every step of the
//! distances is monotone. What is not in the database never occludes, which costs culling and never correctness.
//! About 110 bytes an occluder; a choice of 500 of 10,000 takes some tens of microseconds.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};
use homcull_simd::{Kernel, Level, Simd};

use super::stand_ins::Form;
use super::{Order, StandIns};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::occlusion::{ALL_PLANES, BoxGroup, BoxView, Edges, Occluder, planes_left};
use crate::raster::{Grid, ObjectRows, PreparedMeshes};
use crate::scene::{Child, PreparedScene, WideHierarchy};
use crate::view::View;

/// What may occlude, and its tree.
#[derive(Debug, Clone, Default)]
pub struct OccluderDatabase {
    /// Meshes of its own; `None` when the scene's are meant.
    meshes: Option<PreparedMeshes>,
    occluders: Vec<Occluder>,
    /// About `origin`; empty for what is not in the database.
    bounds: Vec<Aabb>,
    triangles: Vec<u32>,
    origin: DVec3,
    tree: WideHierarchy,
    members: usize,
    /// What is drawn in place of them.
    stand_ins: Option<StandIns>,
}

/// The queue of a walk, and which occluders were chosen before it: reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub struct WalkMemory {
    front: BinaryHeap<Reverse<(u64, u8)>>,
    /// By id; all false between walks.
    before: Vec<bool>,
}

impl OccluderDatabase {
    /// The objects of a scene that `may_occlude`, under their own ids. What is not opaque, or has no triangles or no finite box,
    /// never gets in.
    pub fn of_scene(scene: &PreparedScene, may_occlude: impl Fn(u32) -> bool) -> OccluderDatabase {
        OccluderDatabase::of_covering(scene, false, may_occlude)
    }

    /// As [`OccluderDatabase::of_scene`], for a buffer that fuses layers: with translucent objects that add something (4.4).
    pub fn of_fused_scene(scene: &PreparedScene, may_occlude: impl Fn(u32) -> bool) -> OccluderDatabase {
        OccluderDatabase::of_covering(scene, true, may_occlude)
    }

    fn of_covering(scene: &PreparedScene, fused: bool, may_occlude: impl Fn(u32) -> bool) -> OccluderDatabase {
        let triangles: Vec<u32> = (0..scene.occluders.len() as u32).map(|id| scene.triangles(id)).collect();
        let admitted = |id: usize| scene.occluders[id].covers(fused) && triangles[id] > 0 && may_occlude(id as u32);
        let bounds = scene.bounds.iter().enumerate().map(|(id, &b)| if admitted(id) { b } else { Aabb::EMPTY });
        OccluderDatabase::build(None, scene.occluders.clone(), bounds.collect(), triangles, scene.origin)
    }

    /// Meshes given as occluders, by place; `bounds` are their boxes about `origin`. Whether they hide only what the model
    /// hides is the caller's affair: culling is conservative if each, as a set of points, lies within what is drawn.
    ///
    /// # Errors
    /// [`Error::Parameter`] when there are not as many boxes as occluders, or an occluder's mesh is not among `meshes`.
    pub fn of_meshes(
        meshes: PreparedMeshes,
        occluders: Vec<Occluder>,
        bounds: Vec<Aabb>,
        origin: DVec3,
    ) -> Result<OccluderDatabase> {
        if bounds.len() != occluders.len() {
            return Err(Error::parameter(
                "bounds",
                bounds.len(),
                format!("must be {}, one an occluder", occluders.len()),
            ));
        }
        if let Some(o) = occluders.iter().position(|o| !meshes.contains(o.mesh)) {
            return Err(Error::parameter("occluder", o, "its mesh is not among the meshes"));
        }
        let triangles: Vec<u32> = occluders.iter().map(|o| meshes.triangles(o.mesh)).collect();
        let admitted = |id: usize| occluders[id].opaque && triangles[id] > 0;
        let bounds = bounds.iter().enumerate().map(|(id, &b)| if admitted(id) { b } else { Aabb::EMPTY }).collect();
        Ok(OccluderDatabase::build(Some(meshes), occluders, bounds, triangles, origin))
    }

    fn build(
        meshes: Option<PreparedMeshes>,
        occluders: Vec<Occluder>,
        bounds: Vec<Aabb>,
        triangles: Vec<u32>,
        origin: DVec3,
    ) -> OccluderDatabase {
        let bounds: Vec<Aabb> = bounds.into_iter().map(|b| if b.is_finite() { b } else { Aabb::EMPTY }).collect();
        let tree = WideHierarchy::new(&bounds);
        let members = bounds.iter().filter(|b| !b.is_empty()).count();
        OccluderDatabase { meshes, occluders, bounds, triangles, origin, tree, members, stand_ins: None }
    }

    /// The same, with other geometry in place of its occluders: those of the scene that `stand_ins` were made of.
    pub fn with_stand_ins(self, stand_ins: Option<StandIns>) -> OccluderDatabase {
        OccluderDatabase { stand_ins, ..self }
    }

    /// What is drawn in place of some occluders, if anything is.
    pub fn stand_ins(&self) -> Option<&StandIns> {
        self.stand_ins.as_ref()
    }

    /// Occluders in it.
    pub fn len(&self) -> usize {
        self.members
    }

    /// True when nothing may occlude.
    pub fn is_empty(&self) -> bool {
        self.members == 0
    }

    /// Whether this object, or given mesh, may occlude.
    pub fn contains(&self, id: u32) -> bool {
        self.bounds.get(id as usize).is_some_and(|b| !b.is_empty())
    }

    /// What is drawn for an occluder.
    pub fn occluder(&self, id: u32) -> &Occluder {
        &self.occluders[id as usize]
    }

    /// Where the occluders' meshes are.
    pub fn meshes<'a>(&'a self, scene: &'a PreparedScene) -> &'a PreparedMeshes {
        self.meshes.as_ref().unwrap_or(&scene.meshes)
    }

    /// Triangles that occluders have together in a view: those of what stands in for them.
    pub fn triangles(&self, view: &View, ids: &[u32]) -> u64 {
        ids.iter().map(|&id| u64::from(self.cost(view, id))).sum()
    }

    /// Triangles of one in a view; 0 of an unknown one.
    fn cost(&self, view: &View, id: u32) -> u32 {
        let own = self.triangles.get(id as usize).copied().unwrap_or_default();
        self.form(view, id).map_or(own, |form| form.triangles)
    }

    fn form(&self, view: &View, id: u32) -> Option<Form> {
        self.stand_ins.as_ref()?.form(view, id, *self.bounds.get(id as usize)?, self.origin)
    }

    /// Adds what is drawn for occluders in a view: to `own` what is in [`OccluderDatabase::meshes`], to `others` what is in the
    /// meshes of its stand-ins.
    pub fn draw_list(&self, view: &View, ids: &[u32], own: &mut Vec<Occluder>, others: &mut Vec<Occluder>) {
        for &id in ids {
            let occluder = &self.occluders[id as usize];
            match self.form(view, id) {
                Some(form) => others.extend(form.occluders(occluder)),
                None => own.push(*occluder),
            }
        }
    }

    /// Chooses occluders in the frustum in an order, and appends them to `chosen`. Stops before the triangles of all that is there
    /// would pass `limit`; the first of all is always taken. What is there already is not taken again. `candidate` may turn
    /// down more, view by view; an object turned down counts nothing.
    #[allow(clippy::too_many_arguments)]
    pub fn choose(
        &self,
        level: Level,
        view: &View,
        order: Order,
        limit: u64,
        candidate: &dyn Fn(u32) -> bool,
        memory: &mut WalkMemory,
        chosen: &mut Vec<u32>,
    ) {
        let eye = (view.eye() - self.origin).as_vec3();
        let WalkMemory { front, before } = memory;
        before.resize(self.bounds.len(), false);
        mark(before, chosen, true);
        let there = chosen.len();
        let taken = Taken { triangles: self.triangles(view, chosen), limit, chosen };
        let new = |id| !before[id as usize] && candidate(id);
        level.run(Walk {
            database: self,
            seen: view,
            view: &self.box_view(view),
            eye,
            order,
            candidate: &new,
            front,
            taken,
        });
        mark(before, &chosen[..there], false);
    }

    /// Goes through a list in its own order and appends what is in the database and in the frustum (7.5), under the same limit.
    /// Ids beyond the database count as not in it. True when the list came to its end within the limit.
    pub fn choose_in_order(&self, level: Level, view: &View, list: &[u32], limit: u64, chosen: &mut Vec<u32>) -> bool {
        let taken = Taken { triangles: self.triangles(view, chosen), limit, chosen };
        level.run(InOrder { database: self, seen: view, view: &self.box_view(view), list, taken })
    }

    fn box_view(&self, view: &View) -> BoxView {
        BoxView::new(ObjectRows::new(view, self.origin), Grid::new(view.viewport()), view.near_center())
    }
}

fn mark(marks: &mut [bool], ids: &[u32], as_what: bool) {
    for &id in ids {
        if let Some(mark) = marks.get_mut(id as usize) {
            *mark = as_what;
        }
    }
}

/// Under a limit: takes while it is not passed, the first whatever it has.
struct Taken<'a> {
    triangles: u64,
    limit: u64,
    chosen: &'a mut Vec<u32>,
}

impl Taken<'_> {
    /// False when the limit would be passed: then nothing more is taken.
    fn take(&mut self, id: u32, triangles: u32) -> bool {
        self.triangles = self.triangles.saturating_add(triangles.into());
        let takes = self.triangles <= self.limit || self.chosen.is_empty();
        if takes {
            self.chosen.push(id);
        }
        takes
    }
}

/// In a key, below the distance: objects come after groups as far away, so that ties come out by id.
const OBJECT: u64 = 1 << 31;

struct Walk<'a> {
    database: &'a OccluderDatabase,
    seen: &'a View,
    view: &'a BoxView,
    eye: Vec3,
    order: Order,
    candidate: &'a dyn Fn(u32) -> bool,
    front: &'a mut BinaryHeap<Reverse<(u64, u8)>>,
    taken: Taken<'a>,
}

impl Kernel for Walk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Walk { database, seen, view, eye, order, candidate, front, mut taken } = self;
        let (tree, end) = (&database.tree, order.end());
        front.clear();
        if !tree.is_empty() {
            front.push(Reverse((0, ALL_PLANES)));
        }
        while let Some(Reverse((key, active))) = front.pop() {
            let number = key as u32;
            if (key >> 32) as u32 >= end {
                return;
            }
            if key & OBJECT != 0 {
                let id = number & !(OBJECT as u32);
                if candidate(id) && !taken.take(id, database.cost(seen, id)) {
                    return;
                }
                continue;
            }
            let boxes = Edges::new(s, view, &tree.groups[number as usize]);
            let (mut k, inside) = boxes.against_planes(s, view, active, tree.used(number));
            let links = tree.links(number);
            while k != 0 {
                let lane = k.trailing_zeros() as usize;
                k &= k - 1;
                let (distance, tag) = match WideHierarchy::child(links[lane]) {
                    Child::Object(id) => (order.object(database.bounds[id as usize], eye), OBJECT | u64::from(id)),
                    Child::Group(group) => (order.group(tree.bounds[group as usize], eye), group.into()),
                };
                front.push(Reverse((u64::from(distance) << 32 | tag, planes_left(active, &inside, lane))));
            }
        }
    }
}

struct InOrder<'a> {
    database: &'a OccluderDatabase,
    seen: &'a View,
    view: &'a BoxView,
    list: &'a [u32],
    taken: Taken<'a>,
}

impl Kernel for InOrder<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> bool {
        let InOrder { database, seen, view, list, mut taken } = self;
        for ids in list.chunks(16) {
            let (mut group, mut used) = (BoxGroup::NONE, 0);
            for (lane, &id) in ids.iter().enumerate() {
                if database.contains(id) {
                    group.set(lane, database.bounds[id as usize]);
                    used |= 1 << lane;
                }
            }
            let boxes = Edges::new(s, view, &group);
            let (mut k, _) = boxes.against_planes(s, view, ALL_PLANES, used);
            while k != 0 {
                let id = ids[k.trailing_zeros() as usize];
                k &= k - 1;
                if !taken.take(id, database.cost(seen, id)) {
                    return false;
                }
            }
        }
        true
    }
}
