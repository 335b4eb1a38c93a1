//! The queue of a walk that goes through the hierarchy nearest first: groups and objects, by the distance of their boxes.
//!
//! A group's children are projected sixteen at a time when it is opened. Cost: the logarithm of what waits, a node.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use homcull_simd::{Kernel, Simd};

use super::frustum::{ALL_PLANES, planes_left};
use crate::occlusion::{BoxView, Edges, NEAR, ProjectedBox, ProjectedBoxes, project_lanes};
use crate::scene::{Child, WideHierarchy};

/// What waits in the queue, beside its key.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub b: ProjectedBox,
    /// `None` for an object; else the group, and the planes it may cross.
    pub group: Option<(u32, u8)>,
}

/// The queue: keys are distance bits, then the place in the list, so that ties come out as they went in.
#[derive(Default)]
pub(super) struct NearestFirst {
    heap: BinaryHeap<Reverse<u64>>,
    waiting: Vec<Waiting>,
}

impl NearestFirst {
    pub fn push(&mut self, distance: u32, waiting: Waiting) {
        self.heap.push(Reverse(u64::from(distance) << 32 | self.waiting.len() as u64));
        self.waiting.push(waiting);
    }

    /// Moves all that waits onto a stack, the nearest last.
    pub fn move_to(&mut self, stack: &mut Vec<Waiting>) {
        let from = stack.len();
        while let Some((_, waiting)) = self.pop() {
            stack.push(waiting);
        }
        stack[from..].reverse();
        self.waiting.clear();
    }

    /// Moves the nearest out, and all others at the same distance but for its last `shift` bits.
    pub fn pop_shell(&mut self, shift: u32, shell: &mut Vec<Waiting>) {
        let Some((distance, nearest)) = self.pop() else { return };
        shell.push(nearest);
        while let Some(Reverse(key)) = self.heap.peek()
            && ((key >> 32) as u32) >> shift == distance >> shift
            && let Some((_, waiting)) = self.pop()
        {
            shell.push(waiting);
        }
    }

    pub fn pop(&mut self) -> Option<(u32, Waiting)> {
        let Reverse(key) = self.heap.pop()?;
        Some(((key >> 32) as u32, self.waiting[key as u32 as usize]))
    }
}

/// The root, and what has no box.
pub(super) fn begin(tree: &WideHierarchy, front: &mut NearestFirst) {
    if !tree.is_empty() {
        front.push(0, Waiting { b: ProjectedBox::everywhere(NEAR), group: Some((0, ALL_PLANES)) });
    }
    for &id in &tree.unbounded {
        front.push(0, Waiting { b: ProjectedBox::everywhere(id | NEAR), group: None });
    }
}

/// Puts a group's children that meet the frustum into the queue.
#[inline(always)]
pub(super) fn open_group<S: Simd>(
    s: S,
    view: &BoxView,
    tree: &WideHierarchy,
    (group, active): (u32, u8),
    children: &mut ProjectedBoxes,
    front: &mut NearestFirst,
) {
    s.vectorize(OpenGroup { view, tree, group, active, children, front });
}

/// One function a level, however many walks open groups: it is inlined nowhere.
struct OpenGroup<'a> {
    view: &'a BoxView,
    tree: &'a WideHierarchy,
    group: u32,
    active: u8,
    children: &'a mut ProjectedBoxes,
    front: &'a mut NearestFirst,
}

impl Kernel for OpenGroup<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let OpenGroup { view, tree, group, active, children, front } = self;
        let boxes = Edges::new(s, view, &tree.groups[group as usize]);
        let (k, inside) = boxes.against_planes(s, view, active, tree.used(group));
        if k == 0 {
            return;
        }
        let mut lanes = [0; 16];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = i as u32;
        }
        children.clear();
        project_lanes(s, view, &boxes, k, &lanes, children);
        let links = tree.links(group);
        for (b, distance) in children.with_distances() {
            let lane = b.id() as usize;
            let waiting = match WideHierarchy::child(links[lane]) {
                Child::Object(id) => Waiting { b: b.renumbered(id), group: None },
                Child::Group(child) => Waiting { b: *b, group: Some((child, planes_left(active, &inside, lane))) },
            };
            front.push(distance, waiting);
        }
    }
}
