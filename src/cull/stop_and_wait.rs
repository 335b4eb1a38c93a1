//! Hierarchical stop-and-wait (Bittner et al. 2004, section 2.3): front to back, a query for every node, and nothing is done until it is answered.
//!
//! Invariant: conservative with a threshold of 0. Cost: a latency a node; with a latency of 0 it is the hierarchical Z-buffer.

use homcull_simd::Simd;

use super::VisibleSet;
use super::coherent::{Frame, Pending, Traversal};
use super::query_device::{Query, QueryDevice};

/// Walks one frame; what was drawn is in the set, in the order in which it was.
#[inline(always)]
pub(super) fn walk<S: Simd, D: QueryDevice>(s: S, frame: &Frame<'_>, order: Traversal, device: &mut D) -> VisibleSet {
    let mut set = VisibleSet::default();
    let mut pending = Pending::new(&frame.world.tree, order);
    while let Some(node) = pending.pop() {
        device.issue(Query::of(&node));
        set.queries += 1;
        if device.wait() <= frame.threshold {
            continue;
        }
        match node.group {
            Some(group) => pending.open(s, frame, group),
            None => {
                device.draw(node.b.id());
                set.objects.push(node.b.id());
            }
        }
    }
    set
}
