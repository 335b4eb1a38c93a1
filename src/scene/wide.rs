//! The hierarchy with sixteen children a node: a whole sibling group of boxes is looked at in one call.
//!
//! Made from the binary [`Hierarchy`] by opening the child with the largest surface until sixteen are there.

use super::hierarchy::Hierarchy;
use crate::geometry::Aabb;
use crate::occlusion::BoxGroup;

/// What a place in a group leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Child {
    Group(u32),
    Object(u32),
}

/// Link of a place that leads nowhere.
const NOTHING: u32 = u32::MAX;
/// Set in links to objects.
const OBJECT: u32 = 1 << 31;

/// The wide tree over a scene's objects.
#[derive(Debug, Clone, Default)]
pub struct WideHierarchy {
    pub(crate) groups: Vec<BoxGroup>,
    /// The sixteen links of each group, and which of them lead somewhere.
    links: Vec<[u32; 16]>,
    used: Vec<u16>,
    /// The box around each group.
    pub(crate) bounds: Vec<Aabb>,
    /// Objects without a finite box that has a point: those that are not finite, not those that are empty.
    pub(crate) unbounded: Vec<u32>,
}

impl WideHierarchy {
    /// The tree over boxes, by object id.
    pub fn new(boxes: &[Aabb]) -> WideHierarchy {
        let binary = Hierarchy::build(boxes);
        let void = |b: &Aabb| b.is_empty() && !b.min.is_nan() && !b.max.is_nan();
        let unbounded = binary.unplaced.iter().copied().filter(|&i| !void(&boxes[i as usize])).collect();
        let mut out = WideHierarchy { unbounded, ..WideHierarchy::default() };
        if binary.nodes.is_empty() {
            return out;
        }
        let mut pending = vec![(0u32, out.push())];
        while let Some((node, group)) = pending.pop() {
            let entries = open(&binary, boxes, node);
            let mut bounds = Aabb::EMPTY;
            for (lane, entry) in entries.iter().enumerate() {
                let (b, link) = match *entry {
                    Child::Object(id) => (boxes[id as usize], id | OBJECT),
                    Child::Group(child) => {
                        let number = out.push();
                        pending.push((child, number));
                        (binary.nodes[child as usize].bounds, number)
                    }
                };
                bounds = bounds.union(b);
                out.groups[group as usize].set(lane, b);
                out.links[group as usize][lane] = link;
                out.used[group as usize] |= 1 << lane;
            }
            out.bounds[group as usize] = bounds;
        }
        out
    }

    /// True when no object has a box.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Groups.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    fn push(&mut self) -> u32 {
        self.groups.push(BoxGroup::NONE);
        self.links.push([NOTHING; 16]);
        self.used.push(0);
        self.bounds.push(Aabb::EMPTY);
        self.groups.len() as u32 - 1
    }

    /// Sums something over the objects below each group.
    pub(crate) fn sums(&self, of: impl Fn(u32) -> u64, sums: &mut Vec<u64>) {
        sums.clear();
        sums.resize(self.groups.len(), 0);
        // Children come after their parents.
        for group in (0..self.groups.len()).rev() {
            sums[group] = (self.children(group as u32))
                .map(|child| match child {
                    Child::Object(id) => of(id),
                    Child::Group(child) => sums[child as usize],
                })
                .sum();
        }
    }

    /// All children of a group, those included that take no part at present.
    pub(crate) fn children(&self, group: u32) -> impl Iterator<Item = Child> + '_ {
        let links = self.links[group as usize].iter().filter(|&&link| link != NOTHING);
        links.map(|&link| WideHierarchy::child(link))
    }

    /// Leaves those objects of `whole`, of which this is a copy, that take part; groups without any lead nowhere.
    pub(crate) fn restrict(&mut self, whole: &WideHierarchy, takes_part: &[bool]) {
        // Children come after their parents.
        for group in (0..self.used.len()).rev() {
            let mut used = whole.used[group];
            for lane in 0..16 {
                let part = match WideHierarchy::child(whole.links[group][lane]) {
                    _ if used >> lane & 1 == 0 => true,
                    Child::Object(id) => takes_part[id as usize],
                    Child::Group(child) => self.used[child as usize] != 0,
                };
                used &= !(u16::from(!part) << lane);
            }
            self.used[group] = used;
        }
        self.unbounded.clear();
        self.unbounded.extend(whole.unbounded.iter().filter(|&&id| takes_part[id as usize]));
    }

    /// The raw links of a group: what [`WideHierarchy::child`] reads.
    #[inline(always)]
    pub(crate) fn links(&self, group: u32) -> &[u32; 16] {
        &self.links[group as usize]
    }

    /// The places of a group that lead somewhere.
    #[inline(always)]
    pub(crate) fn used(&self, group: u32) -> u16 {
        self.used[group as usize]
    }

    /// What a link leads to.
    #[inline(always)]
    pub(crate) fn child(link: u32) -> Child {
        if link & OBJECT != 0 { Child::Object(link & !OBJECT) } else { Child::Group(link) }
    }
}

/// At most sixteen entries that together hold what is below a node of the binary tree.
fn open(binary: &Hierarchy, boxes: &[Aabb], node: u32) -> Vec<Child> {
    let mut entries = vec![Child::Group(node)];
    loop {
        let growth = |e: &Child| match *e {
            Child::Object(_) => None,
            Child::Group(n) => Some(binary.nodes[n as usize].count.max(2) as usize - 1),
        };
        let area = |e: &Child| match *e {
            Child::Object(id) => half_area(boxes[id as usize]),
            Child::Group(n) => half_area(binary.nodes[n as usize].bounds),
        };
        let candidates = entries.iter().enumerate().filter(|(_, e)| growth(e).is_some_and(|g| entries.len() + g <= 16));
        let Some((at, _)) = candidates.max_by(|a, b| area(a.1).total_cmp(&area(b.1)).then(b.0.cmp(&a.0))) else {
            return entries;
        };
        let Child::Group(n) = entries.swap_remove(at) else { return entries };
        let node = binary.nodes[n as usize];
        if node.is_leaf() {
            let ids = &binary.objects[node.first as usize..(node.first + node.count) as usize];
            entries.extend(ids.iter().map(|&id| Child::Object(id)));
        } else {
            entries.extend([Child::Group(node.first), Child::Group(node.first + 1)]);
        }
    }
}

fn half_area(b: Aabb) -> f32 {
    let s = b.size();
    s.x * s.y + s.y * s.z + s.z * s.x
}
