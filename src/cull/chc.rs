//! Coherent hierarchical culling (Bittner, Wimmer, Piringer and Purgathofer 2004).
//!
//! What was visible in the last frame is drawn at once, and asked about meanwhile; only where visible ends are nodes waited for. An inner
//! node that was visible is *opened* without a query: its state follows from its children, up by pull-up when one is found visible, down
//! because every visited node begins as hidden. Answers are taken when they are there; the walk goes on in between.
//!
//! Options of section 4: visible leaves may be assumed to stay visible for some frames (t_av; by the frame in which each was seen,
//! so that they do not all come due at once); nodes of at most n_vp visible samples may count as hidden; waiting nodes may be drawn
//! speculatively. Invariant: with n_vp = 0 the picture is that of everything in the frustum. Cost: a query a node on the border of what is
//! visible, and a visible leaf.

use std::collections::VecDeque;

use homcull_simd::Simd;

use super::VisibleSet;
use super::coherent::{Frame, Pending, QueryParameters};
use super::nearest_first::Waiting;
use super::query_device::{Query, QueryDevice};
use super::vfc::World;
use crate::geometry::Aabb;
use crate::scene::Child;

/// What a frame leaves to the next one: the states of the hierarchy's nodes, groups first, then objects.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ChcMemory {
    frame: u32,
    groups: usize,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Node {
    parent: u32,
    visible: bool,
    /// The frame in which it was visited last, and, for a leaf, drawn.
    visited: u32,
    drawn: u32,
    /// The last frame for which it is assumed visible.
    assumed: u32,
}

const NO_PARENT: u32 = u32::MAX;

impl ChcMemory {
    /// Forgets all earlier frames: for a teleport, or another scene.
    pub fn reset(&mut self) {
        self.nodes.clear();
        self.frame = 0;
    }

    /// Objects that were found visible in the last frame, by id: the visible set, of which what was drawn is a superset.
    pub fn visible_objects(&self) -> Vec<u32> {
        let objects = self.nodes.get(self.groups..).unwrap_or_default().iter();
        let seen = objects.enumerate().filter(|(_, n)| n.visible && n.visited == self.frame);
        seen.map(|(i, _)| i as u32).collect()
    }

    /// The boxes of the last frame's nodes about the scene's origin: visible objects, and what was found hidden, whole groups as one.
    pub fn classified(&self, world: &World<'_>) -> (Vec<Aabb>, Vec<Aabb>) {
        let (mut visible, mut hidden) = (Vec::new(), Vec::new());
        let visited = self.nodes.iter().enumerate().filter(|(_, node)| node.visited == self.frame);
        for (i, node) in visited {
            match i.checked_sub(self.groups) {
                None if node.visible => {}
                None => hidden.push(world.tree.bounds[i]),
                Some(object) if node.visible => visible.push(world.scene.bounds[object]),
                Some(object) => hidden.push(world.scene.bounds[object]),
            }
        }
        (visible, hidden)
    }

    /// Begins a frame of a scene; nodes of another one are forgotten.
    pub(super) fn begin(&mut self, world: &World<'_>) {
        let (groups, objects) = (world.tree.len(), world.scene.occluders.len());
        if self.groups != groups || self.nodes.len() != groups + objects || self.frame == u32::MAX {
            let unseen = Node { parent: NO_PARENT, visible: false, visited: 0, drawn: 0, assumed: 0 };
            *self = ChcMemory { frame: 1, groups, nodes: vec![unseen; groups + objects] };
            for group in 0..groups as u32 {
                for child in world.tree.children(group) {
                    let child = match child {
                        Child::Group(child) => child as usize,
                        Child::Object(id) => groups + id as usize,
                    };
                    self.nodes[child].parent = group;
                }
            }
        }
        self.frame += 1;
    }

    fn index(&self, waiting: &Waiting) -> usize {
        match waiting.group {
            Some((group, _)) => group as usize,
            None => self.groups + waiting.b.id() as usize,
        }
    }

    /// A visible node makes all above it visible.
    #[inline(always)]
    fn pull_up(&mut self, node: usize) {
        let mut node = node as u32;
        while node != NO_PARENT && !self.nodes[node as usize].visible {
            self.nodes[node as usize].visible = true;
            node = self.nodes[node as usize].parent;
        }
    }
}

/// A query under way.
struct Asked {
    node: Waiting,
    /// Whether it was drawn or opened without waiting.
    taken: bool,
}

/// One frame under way.
struct Walk<'f, 'a> {
    frame: &'f Frame<'a>,
    parameters: &'f QueryParameters,
    memory: &'f mut ChcMemory,
    pending: Pending,
    set: VisibleSet,
}

/// Walks one frame; what was drawn is in the set, in the order in which it was.
#[inline(always)]
pub(super) fn walk<S: Simd, D: QueryDevice>(
    s: S,
    frame: &Frame<'_>,
    parameters: &QueryParameters,
    memory: &mut ChcMemory,
    device: &mut D,
) -> VisibleSet {
    let pending = Pending::new(&frame.world.tree, parameters.order);
    let mut walk = Walk { frame, parameters, memory, pending, set: VisibleSet::default() };
    let mut asked: VecDeque<Asked> = VecDeque::new();
    let mut next = walk.pending.pop();
    loop {
        // Answers that are there; when nothing else is left to do, those that are not.
        while !asked.is_empty() {
            let answer = match device.ready() {
                Some(samples) => samples,
                None if next.is_some() => break,
                None => {
                    let unsure = if parameters.speculate { asked.iter_mut().find(|a| !a.taken) } else { None };
                    if let Some(unsure) = unsure {
                        unsure.taken = true;
                        walk.traverse(s, unsure.node, device);
                        next = walk.pending.pop();
                        continue;
                    }
                    device.wait()
                }
            };
            let Some(Asked { node, taken }) = asked.pop_front() else { break };
            if answer > frame.threshold {
                walk.found_visible(&node);
                if !taken {
                    walk.traverse(s, node, device);
                    if next.is_none() {
                        next = walk.pending.pop();
                    }
                }
            }
        }
        let Some(node) = next else { break };
        walk.visit(s, node, &mut asked, device);
        next = walk.pending.pop();
    }
    walk.set
}

impl Walk<'_, '_> {
    /// Visits a node: opens it, draws it, or asks about it.
    #[inline(always)]
    fn visit<S: Simd, D: QueryDevice>(&mut self, s: S, waiting: Waiting, asked: &mut VecDeque<Asked>, device: &mut D) {
        let now = self.memory.frame;
        let at = self.memory.index(&waiting);
        let leaf = waiting.group.is_none();
        let node = &mut self.memory.nodes[at];
        let was_visible = node.visible && node.visited == now - 1;
        let assumed = leaf && was_visible && node.assumed >= now;
        node.visible = false;
        node.visited = now;
        if assumed {
            self.memory.pull_up(at);
        } else if leaf || !was_visible {
            device.issue(Query::of(&waiting));
            asked.push_back(Asked { node: waiting, taken: was_visible });
            self.set.queries += 1;
        }
        if was_visible {
            self.traverse(s, waiting, device);
        }
    }

    /// Takes down that a node is visible.
    #[inline(always)]
    fn found_visible(&mut self, node: &Waiting) {
        let at = self.memory.index(node);
        self.memory.nodes[at].assumed = self.memory.frame + self.parameters.assume_visible;
        self.memory.pull_up(at);
    }

    /// Draws a leaf, or puts a group's children among what is to be visited.
    #[inline(always)]
    fn traverse<S: Simd, D: QueryDevice>(&mut self, s: S, waiting: Waiting, device: &mut D) {
        let now = self.memory.frame;
        let Some(group) = waiting.group else {
            let node = &mut self.memory.nodes[self.memory.groups + waiting.b.id() as usize];
            if node.drawn != now {
                node.drawn = now;
                device.draw(waiting.b.id());
                self.set.objects.push(waiting.b.id());
            }
            return;
        };
        self.pending.open(s, self.frame, group);
    }
}
