//! View-frustum culling alone: the baseline of every speed-up. Same hierarchy, same order, same draw as the other methods.

use homcull_simd::Level;

use super::VisibleSet;
use super::frustum::{ALL_PLANES, CollectInFrustum, push_unbounded};
use crate::occlusion::{BoxView, ProjectedBoxes};
use crate::raster::{Grid, ObjectRows};
use crate::scene::{PreparedScene, WideHierarchy};
use crate::view::View;

/// A scene with its hierarchy: what the methods walk.
pub struct World<'s> {
    /// The scene.
    pub scene: &'s PreparedScene,
    /// The hierarchy over its objects.
    pub tree: WideHierarchy,
    /// Triangles below each of its groups.
    pub(crate) group_triangles: Vec<u64>,
    /// By object, whether it takes part; all do when `None`.
    part: Option<Vec<bool>>,
}

impl<'s> World<'s> {
    /// Builds the hierarchy.
    pub fn new(scene: &'s PreparedScene) -> World<'s> {
        let tree = WideHierarchy::new(&scene.bounds);
        let mut group_triangles = Vec::new();
        tree.sums(|object| u64::from(scene.triangles(object)), &mut group_triangles);
        World { scene, tree, group_triangles, part: None }
    }

    /// A copy with the same hierarchy, to be restricted from frame to frame: what a stage of a composed method leaves to the next one.
    pub fn copy(&self) -> World<'s> {
        World {
            scene: self.scene,
            tree: self.tree.clone(),
            group_triangles: self.group_triangles.clone(),
            part: self.part.clone(),
        }
    }

    /// Leaves those objects alone that are named, of the world of which this is a copy. Cost: a look at every object and group.
    pub fn restrict_to(&mut self, whole: &World<'_>, objects: &[u32]) {
        let part = self.part.get_or_insert_default();
        part.clear();
        part.resize(self.scene.occluders.len(), false);
        for &object in objects {
            part[object as usize] = true;
        }
        self.tree.restrict(&whole.tree, part);
        let triangles = |o: u32| if part[o as usize] { u64::from(self.scene.triangles(o)) } else { 0 };
        self.tree.sums(triangles, &mut self.group_triangles);
    }

    /// Whether an object takes part.
    pub fn takes_part(&self, object: u32) -> bool {
        self.part.as_ref().is_none_or(|part| part[object as usize])
    }

    /// The view as the scene's boxes see it.
    pub(crate) fn box_view(&self, view: &View) -> BoxView {
        BoxView::new(ObjectRows::new(view, self.scene.origin), Grid::new(view.viewport()), view.near_center())
    }

    /// Collects the objects in the frustum, sorted nearest first.
    pub(crate) fn collect(
        &self,
        level: Level,
        view: &View,
        project: bool,
        stack: &mut Vec<(u32, u8)>,
        out: &mut ProjectedBoxes,
    ) {
        let box_view = self.box_view(view);
        out.clear();
        stack.clear();
        if !self.tree.is_empty() {
            stack.push((0, ALL_PLANES));
        }
        level.run(CollectInFrustum { view: &box_view, tree: &self.tree, project, stack, out });
        push_unbounded(&self.tree, out);
        out.sort();
    }

    /// A visible set that is everything in the frustum.
    pub(crate) fn all_of(&self, boxes: &ProjectedBoxes) -> VisibleSet {
        let objects: Vec<u32> = boxes.boxes().iter().map(|b| b.id()).collect();
        VisibleSet {
            in_frustum: objects.len() as u32,
            triangles_in_frustum: self.triangles(&objects),
            objects,
            ..VisibleSet::default()
        }
    }

    /// Triangles of objects.
    pub fn triangles(&self, objects: &[u32]) -> u64 {
        objects.iter().map(|&o| u64::from(self.scene.triangles(o))).sum()
    }
}

/// Working memory of the walk, reused from frame to frame.
#[derive(Default)]
pub struct VfcMemory {
    pub(crate) boxes: ProjectedBoxes,
    pub(crate) stack: Vec<(u32, u8)>,
}

/// Everything in the frustum, nearest first.
pub fn cull(world: &World<'_>, level: Level, view: &View, memory: &mut VfcMemory) -> VisibleSet {
    world.collect(level, view, false, &mut memory.stack, &mut memory.boxes);
    world.all_of(&memory.boxes)
}
