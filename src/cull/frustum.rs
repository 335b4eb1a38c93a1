//! The frustum filter: hierarchical view-frustum culling with plane masking.
//!
//! A child is tested only against planes that its parent crosses. Planes are widened by the rounding bound of
//! `occlusion/project`, so nothing that could touch a sample is dropped.

use homcull_simd::{Kernel, Simd};

pub(crate) use crate::occlusion::{ALL_PLANES, planes_left};
use crate::occlusion::{BoxView, Edges, NEAR, ProjectedBox, ProjectedBoxes, project_lanes};
use crate::scene::{Child, WideHierarchy};

/// Walks the hierarchy and collects the objects in the frustum, in the tree's order.
pub(crate) struct CollectInFrustum<'a> {
    pub view: &'a BoxView,
    pub tree: &'a WideHierarchy,
    /// Whether boxes are projected for occlusion tests; without, only their distances are computed.
    pub project: bool,
    /// Where to begin: groups, and the planes that they may cross.
    pub stack: &'a mut Vec<(u32, u8)>,
    /// Appended to.
    pub out: &'a mut ProjectedBoxes,
}

impl Kernel for CollectInFrustum<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let CollectInFrustum { view, tree, project, stack, out } = self;
        while let Some((group, active)) = stack.pop() {
            let boxes = Edges::new(s, view, &tree.groups[group as usize]);
            let (mut k, inside) = boxes.against_planes(s, view, active, tree.used(group));
            let links = tree.links(group);
            let (mut objects, mut ids) = (0, [0; 16]);
            while k != 0 {
                let lane = k.trailing_zeros() as usize;
                k &= k - 1;
                match WideHierarchy::child(links[lane]) {
                    Child::Group(child) => stack.push((child, planes_left(active, &inside, lane))),
                    Child::Object(id) => {
                        objects |= 1 << lane;
                        ids[lane] = id;
                    }
                }
            }
            if objects != 0 && project {
                project_lanes(s, view, &boxes, objects, &ids, out);
            } else if objects != 0 {
                let mut distances = [0; 16];
                s.store_i(s.bits_of_f(boxes.distance_squared(s)), &mut distances);
                while objects != 0 {
                    let lane = objects.trailing_zeros() as usize;
                    objects &= objects - 1;
                    out.push_unprojected(ids[lane], distances[lane] as u32);
                }
            }
        }
    }
}

/// Objects without a finite box: in every frustum.
pub(crate) fn push_unbounded(tree: &WideHierarchy, out: &mut ProjectedBoxes) {
    for &id in &tree.unbounded {
        out.push(ProjectedBox::everywhere(id | NEAR), 0);
    }
}
