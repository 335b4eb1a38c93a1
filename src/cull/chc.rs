//! Coherent hierarchical culling (Bittner, Wimmer, Piringer and Purgathofer 2004).
//!
//! What was visible in the last frame is drawn at once, and asked about meanwhile; only where visible ends are nodes waited for. An inner
//! node that was visible is *opened* without a query: its state follows from its children, up by pull-up when one is found visible, down
//! because every visited node begins as hidden. Answers are taken when they are there; the walk goes on in between. What a visible leaf
//! is answered is for the next frame: when only such answers are missing, nothing is waited for.
//!
//! Options of section 4: visible leaves may be assumed to stay visible for some frames (`assumption.rs`); nodes of at most n_vp visible
//! samples may count as hidden; waiting nodes may be drawn or opened speculatively, so that nothing is ever waited for. Invariant: with
//! n_vp = 0 the picture is that of everything in the frustum. Cost: a query a node on the border of what is visible, and a visible leaf.
//!
//! Of CHC++ (Mattausch, Bittner and Wimmer 2008) there are the spread of assumptions and *idle* queries: visible leaves are asked
//! about when the walk would otherwise wait, or last. On 240 frames of a plant of 1,000,000 triangles at a latency of 20 steps that
//! leaves 0.2 of 17.4 steps waited for a frame. A leaf then faces what was drawn behind it too, so standing still the visible set may be smaller than stop-and-wait's.
//! Its *multiqueries*, several hidden nodes asked about as one until one of them shows, are left out: of at most ten nodes, chosen by
//! its cost model from batches of 64, they leave 440 of 572 queries a frame, but test 607 boxes, and every box costs a CPU a test; at
//! a latency of 20 steps they wait for 38 instead of 17, and draw 0.3 percent more triangles. On the device with a thread they gain nothing.

use std::collections::VecDeque;

use glam::DVec3;
use homcull_simd::Simd;

use super::VisibleSet;
use super::assumption::{Assumption, Now};
use super::coherent::{Frame, Pending, QueryParameters};
use super::nearest_first::Waiting;
use super::query_device::{Query, QueryDevice};
use super::vfc::World;
use crate::geometry::Aabb;
use crate::scene::Child;

/// What a frame leaves to the next one: the states of the hierarchy's nodes, groups first, then objects.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChcMemory {
    now: Now,
    eye: DVec3,
    groups: usize,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    parent: u32,
    visible: bool,
    /// Successive queries that found it visible.
    seen: u8,
    /// The frame in which it was visited last, and, for a leaf, drawn.
    visited: u32,
    drawn: u32,
    /// For how long it is assumed visible.
    assumed: Assumption,
}

const NO_PARENT: u32 = u32::MAX;

impl ChcMemory {
    /// Forgets all earlier frames: for a teleport, or another scene.
    pub fn reset(&mut self) {
        self.nodes.clear();
        self.now = Now::default();
    }

    /// Objects that were found visible in the last frame, by id: the visible set, of which what was drawn is a superset.
    pub fn visible_objects(&self) -> Vec<u32> {
        let objects = self.nodes.get(self.groups..).unwrap_or_default().iter();
        let seen = objects.enumerate().filter(|(_, n)| n.visible && n.visited == self.now.frame);
        seen.map(|(i, _)| i as u32).collect()
    }

    /// The boxes of the last frame's nodes about the scene's origin: visible objects, and what was found hidden, whole groups as one.
    pub fn classified(&self, world: &World<'_>) -> (Vec<Aabb>, Vec<Aabb>) {
        let (mut visible, mut hidden) = (Vec::new(), Vec::new());
        let visited = self.nodes.iter().enumerate().filter(|(_, node)| node.visited == self.now.frame);
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

    /// Begins a frame of a scene, seen from a place; nodes of another scene are forgotten.
    pub(super) fn begin(&mut self, world: &World<'_>, eye: DVec3) {
        let (groups, objects) = (world.tree.len(), world.scene.occluders.len());
        if self.groups != groups || self.nodes.len() != groups + objects || self.now.frame == u32::MAX {
            let unseen =
                Node { parent: NO_PARENT, visible: false, seen: 0, visited: 0, drawn: 0, assumed: Assumption::NONE };
            let now = Now { frame: 1, travelled: 0.0 };
            *self = ChcMemory { now, eye, groups, nodes: vec![unseen; groups + objects] };
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
        self.now.frame += 1;
        self.now.travelled += eye.distance(self.eye);
        self.eye = eye;
    }

    fn index(&self, waiting: &Waiting) -> usize {
        match waiting.group {
            Some((group, _)) => group as usize,
            None => self.groups + waiting.b.id() as usize,
        }
    }

    /// Takes down whether a node was found visible.
    #[inline(always)]
    fn answered(&mut self, waiting: &Waiting, visible: bool, frame: &Frame<'_>, parameters: &QueryParameters) {
        let (at, now) = (self.index(waiting), self.now);
        let node = &mut self.nodes[at];
        if !visible {
            return;
        }
        node.seen = node.seen.saturating_add(1);
        if waiting.group.is_none() {
            let leaf = waiting.b.id();
            let bounds = frame.world.scene.bounds[leaf as usize];
            node.assumed = Assumption::new(parameters, now, leaf, node.seen, bounds.min.distance(bounds.max));
        }
        self.pull_up(at);
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
    /// Queries without an answer taken, the oldest first.
    asked: VecDeque<Asked>,
    /// How many of their nodes are waited for: neither drawn nor opened.
    unsure: usize,
    /// Visible leaves that are still to be asked about, when idle.
    later: VecDeque<Waiting>,
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
    let mut walk = Walk {
        frame,
        parameters,
        memory,
        pending,
        asked: VecDeque::new(),
        unsure: 0,
        later: VecDeque::new(),
        set: VisibleSet::default(),
    };
    loop {
        while !walk.asked.is_empty() {
            let Some(samples) = device.ready() else { break };
            walk.take(s, samples, device);
        }
        if let Some(node) = walk.pending.pop() {
            walk.visit(s, node, device);
        } else if walk.unsure == 0 {
            break;
        } else if parameters.speculate {
            walk.guess(s, device);
        } else if let Some(leaf) = walk.later.pop_front() {
            walk.ask(leaf, true, device);
        } else {
            let samples = device.wait();
            walk.take(s, samples, device);
        }
    }
    // What is still asked about is drawn already: the answers are for the next frame, and there when the picture is.
    while let Some(leaf) = walk.later.pop_front() {
        walk.ask(leaf, true, device);
    }
    while !walk.asked.is_empty() {
        let samples = device.rest();
        walk.take(s, samples, device);
    }
    walk.set
}

impl Walk<'_, '_> {
    /// Visits a node: opens it, draws it, or asks about it.
    #[inline(always)]
    fn visit<S: Simd, D: QueryDevice>(&mut self, s: S, waiting: Waiting, device: &mut D) {
        let now = self.memory.now;
        let at = self.memory.index(&waiting);
        let leaf = waiting.group.is_none();
        let node = &mut self.memory.nodes[at];
        let was_visible = node.visible && node.visited == now.frame - 1;
        if !was_visible {
            node.seen = 0;
        }
        let assumed = leaf && was_visible && node.assumed.holds(now);
        node.visible = false;
        node.visited = now.frame;
        if assumed {
            self.memory.pull_up(at);
        } else if leaf && was_visible && self.parameters.idle {
            self.later.push_back(waiting);
        } else if leaf || !was_visible {
            self.ask(waiting, was_visible, device);
        }
        if was_visible {
            self.traverse(s, waiting, device);
        }
    }

    /// Asks about a node.
    #[inline(always)]
    fn ask<D: QueryDevice>(&mut self, node: Waiting, taken: bool, device: &mut D) {
        device.issue(Query::of(&node));
        self.asked.push_back(Asked { node, taken });
        self.unsure += usize::from(!taken);
        self.set.queries += 1;
    }

    /// Draws, or opens, the oldest node that is waited for.
    #[inline(always)]
    fn guess<S: Simd, D: QueryDevice>(&mut self, s: S, device: &mut D) {
        for i in 0..self.asked.len() {
            let Asked { node, taken } = &mut self.asked[i];
            if !*taken {
                *taken = true;
                let node = *node;
                self.unsure -= 1;
                return self.traverse(s, node, device);
            }
        }
    }

    /// Takes the answer to the oldest query.
    #[inline(always)]
    fn take<S: Simd, D: QueryDevice>(&mut self, s: S, samples: u32, device: &mut D) {
        let Some(Asked { node, taken }) = self.asked.pop_front() else { return };
        self.unsure -= usize::from(!taken);
        let visible = samples > self.frame.threshold;
        self.memory.answered(&node, visible, self.frame, self.parameters);
        if visible && !taken {
            self.traverse(s, node, device);
        }
    }

    /// Draws a leaf, or puts a group's children among what is to be visited.
    #[inline(always)]
    fn traverse<S: Simd, D: QueryDevice>(&mut self, s: S, waiting: Waiting, device: &mut D) {
        let now = self.memory.now.frame;
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
