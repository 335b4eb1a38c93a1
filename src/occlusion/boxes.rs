//! Boxes to be tested: as structure of arrays in a two-level hierarchy, and as projected once a frame.

use crate::geometry::{Aabb, SampleRect};

/// Sixteen boxes, by component. Places past the end hold a box that is never in a frustum.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct BoxGroup {
    pub min: [[f32; 16]; 3],
    pub max: [[f32; 16]; 3],
}

impl BoxGroup {
    pub const NONE: BoxGroup = BoxGroup { min: [[f32::NAN; 16]; 3], max: [[f32::NAN; 16]; 3] };

    pub fn set(&mut self, lane: usize, b: Aabb) {
        for axis in 0..3 {
            (self.min[axis][lane], self.max[axis][lane]) = (b.min[axis], b.max[axis]);
        }
    }
}

/// Boxes about one origin, ready to be projected: sixteen at a time, near ones together, with a box around every sixteen. Made
/// once for what stands still.
#[derive(Debug, Clone, Default)]
pub struct BoxSet {
    pub(crate) groups: Vec<BoxGroup>,
    /// Boxes around sixteen groups each.
    pub(crate) parents: Vec<BoxGroup>,
    /// The caller's number of each place.
    pub(crate) ids: Vec<[u32; 16]>,
    pub(crate) len: usize,
    /// Boxes that no comparison can place: not finite, or empty. The first are always visible, the others never.
    pub(crate) unbounded: Vec<u32>,
}

impl BoxSet {
    /// Takes boxes about some origin, numbered in the order given. A box that is not finite will count as visible in every
    /// view, an empty one as outside.
    pub fn new(boxes: &[Aabb]) -> BoxSet {
        let placed = |b: &Aabb| b.is_finite();
        let unbounded = (0..boxes.len() as u32)
            .filter(|&i| !boxes[i as usize].is_finite() && !is_void(boxes[i as usize]))
            .collect();
        let all = boxes.iter().filter(|b| placed(b)).fold(Aabb::EMPTY, |a, &b| a.union(b));
        let mut order: Vec<(u64, u32)> = boxes
            .iter()
            .enumerate()
            .filter(|(_, b)| placed(b))
            .map(|(i, b)| (morton(b.center(), all), i as u32))
            .collect();
        order.sort_unstable();
        let mut set = BoxSet { len: boxes.len(), unbounded, ..BoxSet::default() };
        let mut bounds = Vec::new();
        for chunk in order.chunks(16) {
            let (mut group, mut ids) = (BoxGroup::NONE, [u32::MAX; 16]);
            for (lane, &(_, i)) in chunk.iter().enumerate() {
                group.set(lane, boxes[i as usize]);
                ids[lane] = i;
            }
            bounds.push(chunk.iter().fold(Aabb::EMPTY, |a, &(_, i)| a.union(boxes[i as usize])));
            set.groups.push(group);
            set.ids.push(ids);
        }
        for chunk in bounds.chunks(16) {
            let mut parent = BoxGroup::NONE;
            for (lane, &b) in chunk.iter().enumerate() {
                parent.set(lane, b);
            }
            set.parents.push(parent);
        }
        set
    }

    /// How many boxes were given.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True when no box was given.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// The box of no points, as opposed to one with a NaN or an infinity in it.
fn is_void(b: Aabb) -> bool {
    !b.min.is_nan() && !b.max.is_nan() && b.is_empty()
}

/// The place of a point on a curve that keeps neighbours together: 21 bits an axis, interleaved.
fn morton(p: glam::Vec3, all: Aabb) -> u64 {
    let scale = |axis: usize| {
        let (low, size) = (f64::from(all.min[axis]), f64::from(all.max[axis]) - f64::from(all.min[axis]));
        let t = if size > 0.0 { (f64::from(p[axis]) - low) / size } else { 0.0 };
        (t.clamp(0.0, 1.0) * f64::from(0x1F_FFFF)) as u64
    };
    let spread = |mut v: u64| {
        v = (v | v << 32) & 0x001F_0000_0000_FFFF;
        v = (v | v << 16) & 0x001F_0000_FF00_00FF;
        v = (v | v << 8) & 0x100F_00F0_0F00_F00F;
        v = (v | v << 4) & 0x10C3_0C30_C30C_30C3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(scale(0)) | spread(scale(1)) << 1 | spread(scale(2)) << 2
}

/// A box on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedBox {
    pub(crate) x0: i16,
    pub(crate) y0: i16,
    pub(crate) x1: i16,
    pub(crate) y1: i16,
    /// Its nearest reversed depth, raised by its bound.
    pub(crate) depth: f32,
    /// The caller's number, and [`NEAR`] and [`CUT`].
    pub(crate) tag: u32,
}

/// Flag: touches the near plane, or is too close to be bounded: visible.
pub(crate) const NEAR: u32 = 1 << 31;
/// Flag: part of it lies outside the viewport, so that clipping it to the frustum may move its nearest depth back.
pub(crate) const CUT: u32 = 1 << 30;

impl ProjectedBox {
    /// A box that cannot be bounded, by its tag.
    pub(crate) fn everywhere(tag: u32) -> ProjectedBox {
        ProjectedBox { x0: 0, y0: 0, x1: -1, y1: -1, depth: 1.0, tag }
    }

    /// The same box under another number.
    #[cfg(feature = "bvh")]
    pub(crate) fn renumbered(&self, id: u32) -> ProjectedBox {
        ProjectedBox { tag: id | self.tag & (NEAR | CUT), ..*self }
    }

    /// The caller's number of the box.
    pub fn id(&self) -> u32 {
        self.tag & !(NEAR | CUT)
    }

    /// The samples that it may touch, inside the viewport; empty when it touches none.
    pub fn rect(&self) -> SampleRect {
        SampleRect { x0: self.x0.into(), y0: self.y0.into(), x1: self.x1.into(), y1: self.y1.into() }
    }

    /// The nearest reversed depth that it may have.
    pub fn depth(&self) -> f32 {
        self.depth
    }

    /// True when it touches the near plane inside the view, or is too close to it for its rectangle to be bounded.
    pub fn touches_near_plane(&self) -> bool {
        self.tag & NEAR != 0
    }
}

/// The boxes of a set that meet the frustum of a view, as they stand on its screen. Keeps its memory from view to view.
#[derive(Debug, Clone, Default)]
pub struct ProjectedBoxes {
    pub(crate) boxes: Vec<ProjectedBox>,
    /// Bits of the squared distance from the eye to the nearest point of each box: they sort as the distances do.
    pub(crate) distances: Vec<u32>,
    keys: Vec<(u32, u32)>,
    swap: Vec<(u32, u32)>,
    unsorted: Vec<ProjectedBox>,
}

impl ProjectedBoxes {
    /// Nothing projected yet.
    pub fn new() -> ProjectedBoxes {
        ProjectedBoxes::default()
    }

    /// Those in the frustum: in an order of their own until sorted, then nearest first.
    pub fn boxes(&self) -> &[ProjectedBox] {
        &self.boxes
    }

    /// The boxes with the bits of their squared distances.
    #[cfg(feature = "bvh")]
    pub(crate) fn with_distances(&self) -> impl Iterator<Item = (&ProjectedBox, u32)> {
        self.boxes.iter().zip(self.distances.iter().copied())
    }

    /// How many are in the frustum.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// True when none is in the frustum.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Forgets all, but keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.boxes.clear();
        self.distances.clear();
    }

    pub(crate) fn push(&mut self, b: ProjectedBox, distance: u32) {
        self.boxes.push(b);
        self.distances.push(distance);
    }

    /// A box of which only the distance is known: it must not be tested.
    #[cfg(feature = "bvh")]
    pub(crate) fn push_unprojected(&mut self, id: u32, distance: u32) {
        self.push(ProjectedBox::everywhere(id | NEAR), distance);
    }

    /// Sorts by the distance from the eye to the nearest point of the box, to a part in 16384; ties keep the set's order. A radix
    /// sort of two passes.
    pub fn sort(&mut self) {
        let n = self.boxes.len();
        self.keys.clear();
        self.keys.extend(self.distances.iter().enumerate().map(|(i, &d)| (d, i as u32)));
        self.swap.clear();
        self.swap.resize(n, (0, 0));
        radix_pass(&self.keys, &mut self.swap, 9);
        radix_pass(&self.swap, &mut self.keys, 20);
        self.unsorted.clear();
        self.unsorted.extend_from_slice(&self.boxes);
        for (b, &(_, i)) in self.boxes.iter_mut().zip(&self.keys) {
            *b = self.unsorted[i as usize];
        }
        for (d, &(key, _)) in self.distances.iter_mut().zip(&self.keys) {
            *d = key;
        }
    }
}

/// One stable pass over eleven bits of the key.
fn radix_pass(from: &[(u32, u32)], to: &mut [(u32, u32)], shift: u32) {
    let mut begins = [0u32; 2048];
    for &(key, _) in from {
        begins[(key >> shift & 2047) as usize] += 1;
    }
    let mut sum = 0;
    for b in &mut begins {
        sum += std::mem::replace(b, sum);
    }
    for &item in from {
        let at = &mut begins[(item.0 >> shift & 2047) as usize];
        to[*at as usize] = item;
        *at += 1;
    }
}
