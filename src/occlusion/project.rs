//! Boxes into the frustum and onto the screen, sixteen at a time, with derived bounds.
//!
//! Corners are transformed incrementally (Zhang 1998, appendix A): a base corner once, and a step along each axis, which the other
//! seven share.
//!
//! **The bound.** Let `D` be the largest distances from the eye along the axes, `u = 2^-24`, and for a row `r`
//! `S = |r.x| D.x + |r.y| D.y + |r.z| D.z + |r.w|`. A vertex in the box takes a subtraction, a product and three sums: at most
//! `5 u S` from exactness, to first order. The base corner takes the same. A step takes the two ends' subtractions and their
//! difference (`4 u D`, since it is at most `2 D`) and a product (`2 u D`): all three at most `6 u S`; adding them, `3 u S`. So corner and
//! vertex differ from exactness together by at most `19 u S`, and their quotients by w, with reciprocal, product and division, by
//! at most `23 u (S_x + |x| S_w) / w`, as `|x| w <= S_x`. We take `32 u`, at the box's greatest |x| and least w. Snapping
//! adds half a subpixel. Edges move by no more than their end points, so no sample outside the widened rectangle is
//! touched, and no drawn depth, clamped to that of the vertices, is nearer than the box's depth plus the same bound for its row.

use glam::{DVec3, Vec3};
use homcull_simd::{Kernel, Mask, Simd};

use super::boxes::{BoxGroup, BoxSet, CUT, NEAR, ProjectedBox, ProjectedBoxes};
use crate::raster::{Grid, ObjectRows, each};

/// 32 rounding steps of f32, relative.
pub(crate) const ROUNDING: f32 = 32.0 / 16_777_216.0;

/// All six planes of a frustum are still to be tested.
#[cfg(feature = "bvh")]
pub(crate) const ALL_PLANES: u8 = 0b11_1111;

/// Of the planes in `active`, those that the box in a lane may still cross, as [`Edges::against_planes`] found it.
#[cfg(feature = "bvh")]
#[inline(always)]
pub(crate) fn planes_left(active: u8, inside: &[u16; 6], lane: usize) -> u8 {
    let mut left = active;
    for (p, k) in inside.iter().enumerate() {
        left &= !(((k >> lane & 1) as u8) << p);
    }
    left
}

/// A view as boxes see it: its rows, and its frustum's planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxView {
    pub rows: ObjectRows,
    pub grid: Grid,
    /// Inside is at least 0: near, left, right, top, bottom, far.
    planes: [[f32; 4]; 6],
    /// The middle of the near rectangle, about the eye, where there is one.
    pub near_center: Option<DVec3>,
}

impl BoxView {
    pub fn new(rows: ObjectRows, grid: Grid, near_center: Option<DVec3>) -> BoxView {
        let [x, y, w, depth, near] = rows.rows;
        let (right, bottom) = (grid.width() as f32 * 256.0, grid.height() as f32 * 256.0);
        let less = |r: &[f32; 4], side: f32| std::array::from_fn(|i| w[i] * side - r[i]);
        BoxView { rows, grid, planes: [near, x, less(&x, right), y, less(&y, bottom), depth], near_center }
    }
}

/// Projects a set; see [`ProjectedBoxes`].
pub(crate) struct Project<'a> {
    pub view: &'a BoxView,
    pub set: &'a BoxSet,
    pub out: &'a mut ProjectedBoxes,
}

impl Kernel for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Project { view, set, out } = self;
        out.clear();
        for (p, parent) in set.parents.iter().enumerate() {
            let mut k = Edges::new(s, view, parent).in_frustum(s, view);
            while k != 0 {
                let g = 16 * p + k.trailing_zeros() as usize;
                k &= k - 1;
                if let Some(group) = set.groups.get(g) {
                    project_group(s, view, group, &set.ids[g], out);
                }
            }
        }
        for &id in &set.unbounded {
            out.push(ProjectedBox::everywhere(id | NEAR), 0);
        }
    }
}

/// Projects one box, in a lane of its own.
pub(crate) struct ProjectOne<'a> {
    pub view: &'a BoxView,
    pub min: Vec3,
    pub max: Vec3,
    pub out: &'a mut ProjectedBoxes,
}

impl Kernel for ProjectOne<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let mut group = BoxGroup { min: [[f32::NAN; 16]; 3], max: [[f32::NAN; 16]; 3] };
        for axis in 0..3 {
            (group.min[axis][0], group.max[axis][0]) = (self.min[axis], self.max[axis]);
        }
        self.out.clear();
        project_group(s, self.view, &group, &[0; 16], self.out);
    }
}

/// Sixteen boxes about the eye.
pub(crate) struct Edges<S: Simd> {
    low: [S::F; 3],
    high: [S::F; 3],
    /// The greater distance along each axis.
    reach: [S::F; 3],
}

impl<S: Simd> Edges<S> {
    #[inline(always)]
    pub fn new(s: S, view: &BoxView, group: &BoxGroup) -> Edges<S> {
        let low: [S::F; 3] = each!(3, i => s.sub_f(s.load_f(&group.min[i]), s.splat_f(view.rows.eye[i])));
        let high: [S::F; 3] = each!(3, i => s.sub_f(s.load_f(&group.max[i]), s.splat_f(view.rows.eye[i])));
        let reach = each!(3, i => s.max_f(s.abs_f(low[i]), s.abs_f(high[i])));
        Edges { low, high, reach }
    }

    /// `S` of the module's head for a row.
    #[inline(always)]
    fn size(&self, s: S, row: &[f32; 4]) -> S::F {
        let part: [S::F; 3] = each!(3, i => s.mul_f(self.reach[i], s.splat_f(row[i].abs())));
        s.add_f(s.add_f(part[0], part[1]), s.add_f(part[2], s.splat_f(row[3].abs())))
    }

    /// A row at the corner where it is greatest, or least.
    #[inline(always)]
    fn extreme(&self, s: S, row: &[f32; 4], greatest: bool) -> S::F {
        let part: [S::F; 3] = each!(3, i => {
            let corner = if (row[i] > 0.0) == greatest { self.high[i] } else { self.low[i] };
            s.mul_f(s.splat_f(row[i]), corner)
        });
        s.add_f(s.add_f(part[0], part[1]), s.add_f(part[2], s.splat_f(row[3])))
    }

    /// Squared distance from the eye to the nearest point of each box.
    #[inline(always)]
    pub fn distance_squared(&self, s: S) -> S::F {
        let zero = s.splat_f(0.0);
        let outside: [S::F; 3] = each!(3, i => s.max_f(zero, s.max_f(self.low[i], s.sub_f(zero, self.high[i]))));
        let square: [S::F; 3] = each!(3, i => s.mul_f(outside[i], outside[i]));
        s.add_f(s.add_f(square[0], square[1]), square[2])
    }

    /// Plane masking: of the planes in `active` (bits), tests each, and says which of the `used` lanes do not certainly lie outside,
    /// and for each plane which lie wholly inside it.
    #[cfg(feature = "bvh")]
    #[inline(always)]
    pub fn against_planes(&self, s: S, view: &BoxView, active: u8, used: Mask) -> (Mask, [Mask; 6]) {
        let (mut k, mut inside) = (used, [!0; 6]);
        for p in 0..6 {
            if active >> p & 1 == 0 {
                continue;
            }
            let plane = &view.planes[p];
            let slack = s.mul_f(self.size(s, plane), s.splat_f(ROUNDING));
            k &= s.ge_f(s.add_f(self.extreme(s, plane, true), slack), s.splat_f(0.0));
            inside[p] = s.ge_f(self.extreme(s, plane, false), slack);
            if k == 0 {
                break;
            }
        }
        (k, inside)
    }

    /// Lanes that do not certainly lie outside one of the planes. A lane with a NaN is not among them.
    #[inline(always)]
    fn in_frustum(&self, s: S, view: &BoxView) -> Mask {
        let mut k = !0;
        for plane in &view.planes {
            let slack = s.mul_f(self.size(s, plane), s.splat_f(ROUNDING));
            k &= s.ge_f(s.add_f(self.extreme(s, plane, true), slack), s.splat_f(0.0));
            if k == 0 {
                break;
            }
        }
        k
    }
}

#[inline(always)]
fn project_group<S: Simd>(s: S, view: &BoxView, group: &BoxGroup, ids: &[u32; 16], out: &mut ProjectedBoxes) {
    let edges = Edges::new(s, view, group);
    let k = edges.in_frustum(s, view);
    if k != 0 {
        project_lanes(s, view, &edges, k, ids, out);
    }
}

/// Projects the boxes of the mask, which meet the frustum, and appends them.
#[inline(always)]
pub(crate) fn project_lanes<S: Simd>(
    s: S,
    view: &BoxView,
    edges: &Edges<S>,
    k: Mask,
    ids: &[u32; 16],
    out: &mut ProjectedBoxes,
) {
    let mut k = k;
    let near = &view.rows.rows[4];
    let slack = s.mul_f(edges.size(s, near), s.splat_f(ROUNDING));
    let beyond_near = s.gt_f(edges.extreme(s, near, false), slack);
    let corners = Corners::new(s, view, edges);
    let (width, height) = (view.grid.width(), view.grid.height());
    let (x0, x1, cut_x) = sample_range(s, corners.x, corners.margin_x, width);
    let (y0, y1, cut_y) = sample_range(s, corners.y, corners.margin_y, height);
    let distance = edges.distance_squared(s);
    // A margin beyond any screen means that w is next to nothing: not bounded.
    let bounded = beyond_near & s.gt_f(s.splat_f(1e6), corners.margin_x) & s.gt_f(s.splat_f(1e6), corners.margin_y);
    let mut lanes = [[0i32; 16]; 5];
    let values = [x0, y0, x1, y1, s.bits_of_f(distance)];
    for i in 0..5 {
        s.store_i(values[i], &mut lanes[i]);
    }
    let mut depth = [0.0; 16];
    s.store_f(corners.depth, &mut depth);
    let cut = cut_x | cut_y;
    while k != 0 {
        let l = k.trailing_zeros() as usize;
        k &= k - 1;
        let flag = |mask: Mask, flag: u32| if mask >> l & 1 != 0 { flag } else { 0 };
        let tag = ids[l] | flag(!bounded, NEAR) | flag(cut, CUT);
        let side = |i: usize| lanes[i][l] as i16;
        let b = ProjectedBox { x0: side(0), y0: side(1), x1: side(2), y1: side(3), depth: depth[l], tag };
        out.push(b, lanes[4][l] as u32);
    }
}

/// The eight corners on the screen, as ranges, with margins.
struct Corners<S: Simd> {
    x: [S::F; 2],
    y: [S::F; 2],
    margin_x: S::F,
    margin_y: S::F,
    /// Nearest, raised by its bound.
    depth: S::F,
}

impl<S: Simd> Corners<S> {
    #[inline(always)]
    fn new(s: S, view: &BoxView, edges: &Edges<S>) -> Corners<S> {
        let size: [S::F; 3] = each!(3, i => s.sub_f(edges.high[i], edges.low[i]));
        let corner_rows: [[S::F; 8]; 4] = each!(4, r => corners_of_row(s, &view.rows.rows[r], &edges.low, &size));
        let far = s.splat_f(f32::MAX);
        let none = s.splat_f(f32::MIN);
        let (mut x, mut y, mut depth, mut w) = ([far, none], [far, none], none, far);
        for i in 0..8 {
            let inverse = s.div_f(s.splat_f(1.0), corner_rows[2][i]);
            let (px, py) = (s.mul_f(corner_rows[0][i], inverse), s.mul_f(corner_rows[1][i], inverse));
            x = [s.min_f(x[0], px), s.max_f(x[1], px)];
            y = [s.min_f(y[0], py), s.max_f(y[1], py)];
            depth = s.max_f(depth, s.mul_f(corner_rows[3][i], inverse));
            w = s.min_f(w, corner_rows[2][i]);
        }
        let scale = s.div_f(s.splat_f(ROUNDING), w);
        let sizes: [S::F; 4] = each!(4, r => edges.size(s, &view.rows.rows[r]));
        let most = [s.max_f(s.abs_f(x[0]), s.abs_f(x[1])), s.max_f(s.abs_f(y[0]), s.abs_f(y[1])), s.abs_f(depth)];
        let row = [0, 1, 3];
        let bound: [S::F; 3] = each!(3, i => s.mul_f(s.add_f(sizes[row[i]], s.mul_f(most[i], sizes[2])), scale));
        let half = s.splat_f(0.5);
        Corners {
            margin_x: s.add_f(bound[0], half),
            margin_y: s.add_f(bound[1], half),
            depth: s.add_f(depth, bound[2]),
            x,
            y,
        }
    }
}

/// A row at the eight corners, by increments (appendix A): bit `axis` of a corner's number chooses the greater side.
#[inline(always)]
fn corners_of_row<S: Simd>(s: S, row: &[f32; 4], low: &[S::F; 3], size: &[S::F; 3]) -> [S::F; 8] {
    let at: [S::F; 3] = each!(3, i => s.mul_f(low[i], s.splat_f(row[i])));
    let step: [S::F; 3] = each!(3, i => s.mul_f(size[i], s.splat_f(row[i])));
    let mut c = [s.add_f(s.add_f(at[0], at[1]), s.add_f(at[2], s.splat_f(row[3]))); 8];
    c[1] = s.add_f(c[0], step[0]);
    c[2] = s.add_f(c[0], step[1]);
    c[3] = s.add_f(c[1], step[1]);
    for i in 0..4 {
        c[4 + i] = s.add_f(c[i], step[2]);
    }
    c
}

/// The samples whose centres lie in a widened range, cut to the viewport (an empty range stays empty), and the lanes that were cut.
#[inline(always)]
fn sample_range<S: Simd>(s: S, range: [S::F; 2], margin: S::F, side: i32) -> (S::I, S::I, Mask) {
    let pixel = s.splat_f(1.0 / 256.0);
    let (least, most) = (s.splat_f(-1e7), s.splat_f(1e7));
    let low = s.add_f(s.sub_f(range[0], margin), s.splat_f(127.0));
    let high = s.sub_f(s.add_f(range[1], margin), s.splat_f(128.0));
    let low = s.floor_i(s.mul_f(s.max_f(s.min_f(low, most), least), pixel));
    let high = s.floor_i(s.mul_f(s.max_f(s.min_f(high, most), least), pixel));
    let cut = s.gt_i(s.splat_i(0), low) | s.gt_i(high, s.splat_i(side - 1));
    let low = s.min_i(s.max_i(low, s.splat_i(0)), s.splat_i(side));
    let high = s.max_i(s.min_i(high, s.splat_i(side - 1)), s.splat_i(-1));
    (low, high, cut)
}
