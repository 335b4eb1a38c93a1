//! From a mesh's own space to snapped screen positions: the one transform routine, with one operation order.
//!
//! `v' = f32(R v)`; `e' = f32(eye - T)`; a vertex is `v' - e'`, and what `e'` rounds off goes into the constant column in
//! f64 (SEMANTICS, *Samples, facing, transform*). Nothing is subtracted per vertex but the eye.

use glam::{DVec3, Mat3};
use homcull_simd::Simd;

use super::each::each;
use super::mesh::{Cluster, PreparedMeshes};
use crate::view::View;

/// Positions beyond this many subpixels from the top left corner are clipped: 32768 samples. With it, edge functions of a
/// tile stay exact in 32 bits.
pub(crate) const GUARD: f32 = 8_388_608.0;

/// A view's rows for objects at one position: screen x and y (subpixels times w), w, depth, near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectRows {
    /// The eye, about the object's position.
    pub(crate) eye: [f32; 3],
    /// Coefficients of x, y, z and 1.
    pub(crate) rows: [[f32; 4]; 5],
}

impl ObjectRows {
    /// The rows of a view for objects placed at `position`.
    pub fn new(view: &View, position: DVec3) -> ObjectRows {
        let exact = view.eye() - position;
        let eye = exact.as_vec3();
        let residual = exact - eye.as_dvec3();
        let rows = view.rows().map(|r| {
            let constant = r.w - r.truncate().dot(residual);
            [r.x as f32, r.y as f32, r.z as f32, constant as f32]
        });
        ObjectRows { eye: eye.to_array(), rows }
    }
}

/// A cluster's vertices on the screen, and in clip space for the planes of its triangles.
#[repr(C, align(64))]
pub(crate) struct ScreenVertices {
    /// Subpixels, snapped.
    pub x: [i32; 32],
    pub y: [i32; 32],
    /// Reversed depth.
    pub depth: [f32; 32],
    /// Screen x, y, w and depth before the division, and the distance from the near plane: subpixels times w, w, depth
    /// times w, w minus that.
    pub clip: [[f32; 32]; 5],
    /// What is outside, as bits: near plane 1, left 2, right 4, top 8, bottom 16 of the guard band.
    pub outside: [i32; 32],
    /// True when some vertex is outside.
    pub any_outside: bool,
}

impl ScreenVertices {
    pub fn new() -> ScreenVertices {
        ScreenVertices {
            x: [0; 32],
            y: [0; 32],
            depth: [0.0; 32],
            clip: [[0.0; 32]; 5],
            outside: [0; 32],
            any_outside: false,
        }
    }

    /// Transforms the cluster's vertices.
    #[inline(always)]
    pub fn transform<S: Simd>(
        &mut self,
        s: S,
        meshes: &PreparedMeshes,
        cluster: &Cluster,
        rows: &ObjectRows,
        rotation: Option<&Mat3>,
    ) {
        self.any_outside = false;
        for g in 0..usize::from(cluster.groups) {
            let group = &meshes.groups[cluster.first_group as usize + g];
            let local = [s.load_f(&group.x), s.load_f(&group.y), s.load_f(&group.z)];
            let v = match rotation {
                None => local,
                Some(r) => rotate(s, r, local),
            };
            let p: [S::F; 3] = each!(3, i => s.sub_f(v[i], s.splat_f(rows.eye[i])));
            let [x, y, w, depth, near] = each!(5, i => row(s, &rows.rows[i], &p));
            let inverse = s.div_f(s.splat_f(1.0), w);
            let (px, py) = (s.mul_f(x, inverse), s.mul_f(y, inverse));
            let guard = s.splat_f(GUARD);
            let reach = s.mul_f(w, guard);
            let inside = s.ge_f(near, s.splat_f(0.0)) & s.gt_f(reach, s.abs_f(x)) & s.gt_f(reach, s.abs_f(y));
            let at = 16 * g..16 * g + 16;
            if inside != 0xFFFF {
                self.outcodes(s, g, x, y, w, near);
            } else {
                s.store_i(s.splat_i(0), lanes_mut(&mut self.outside[at.clone()]));
            }
            s.store_i(s.round_i(px), lanes_mut(&mut self.x[at.clone()]));
            s.store_i(s.round_i(py), lanes_mut(&mut self.y[at.clone()]));
            s.store_f(s.mul_f(depth, inverse), lanes_mut(&mut self.depth[at.clone()]));
            let clip = [x, y, w, depth, near];
            for c in 0..5 {
                s.store_f(clip[c], lanes_mut(&mut self.clip[c][at.clone()]));
            }
        }
    }

    /// Which planes each vertex is outside of. A vertex that no comparison can place (NaN) is outside the near plane.
    #[inline(always)]
    fn outcodes<S: Simd>(&mut self, s: S, group: usize, x: S::F, y: S::F, w: S::F, near: S::F) {
        let reach = s.mul_f(w, s.splat_f(GUARD));
        let back = s.sub_f(s.splat_f(0.0), reach);
        let inside =
            [s.ge_f(near, s.splat_f(0.0)), s.gt_f(x, back), s.gt_f(reach, x), s.gt_f(y, back), s.gt_f(reach, y)];
        let mut code = s.splat_i(0);
        for plane in 0..5 {
            code = s.or_i(code, s.blend_i(!inside[plane], s.splat_i(0), s.splat_i(1 << plane)));
        }
        s.store_i(code, lanes_mut(&mut self.outside[16 * group..16 * group + 16]));
        self.any_outside |= s.eq_i(code, s.splat_i(0)) != 0xFFFF;
    }
}

/// `f32(R v)`, by rows: `(x + y) + z`, each a product.
#[inline(always)]
fn rotate<S: Simd>(s: S, r: &Mat3, v: [S::F; 3]) -> [S::F; 3] {
    each!(3, i => s.add_f(
        s.add_f(s.mul_f(s.splat_f(r.x_axis[i]), v[0]), s.mul_f(s.splat_f(r.y_axis[i]), v[1])),
        s.mul_f(s.splat_f(r.z_axis[i]), v[2])
    ))
}

/// A row over points: `(x + y) + (z + 1)`, each a product.
#[inline(always)]
fn row<S: Simd>(s: S, r: &[f32; 4], p: &[S::F; 3]) -> S::F {
    let xy = s.add_f(s.mul_f(p[0], s.splat_f(r[0])), s.mul_f(p[1], s.splat_f(r[1])));
    s.add_f(xy, s.add_f(s.mul_f(p[2], s.splat_f(r[2])), s.splat_f(r[3])))
}

/// Sixteen elements as an array.
#[inline(always)]
pub(crate) fn lanes_mut<T>(slice: &mut [T]) -> &mut [T; 16] {
    match slice.try_into() {
        Ok(array) => array,
        Err(_) => unreachable!("a slice of sixteen elements"),
    }
}

/// Sixteen elements as an array.
#[inline(always)]
pub(crate) fn lanes<T>(slice: &[T]) -> &[T; 16] {
    match slice.try_into() {
        Ok(array) => array,
        Err(_) => unreachable!("a slice of sixteen elements"),
    }
}
