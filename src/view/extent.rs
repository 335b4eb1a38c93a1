//! How near a box is to a viewer, and how large on the screen: what decides which form of an object stands in for it.

use glam::{DVec3, DVec4};

use super::View;
use crate::geometry::Aabb;

/// Whether a box about `origin` lies wholly beyond the near plane, by more than f64 rounds off. So the eye is outside it, and no
/// ray of the view begins within it.
///
/// False for an empty box, and where a number is none.
pub fn lies_beyond_near(view: &View, bounds: Aabb, origin: DVec3) -> bool {
    let Some((least, size)) = least(view.rows()[4], view, bounds, origin) else { return false };
    least > size * 1e-12
}

/// How many pixels a unit of length covers at the nearest point of a box about `origin`, seen straight on in the middle of the
/// screen; infinite for a box that is not wholly in front of the eye, or empty.
pub fn pixels_a_unit(view: &View, bounds: Aabb, origin: DVec3) -> f64 {
    let [x, y, w, ..] = *view.rows();
    let Some((nearest, _)) = least(w, view, bounds, origin).filter(|&(nearest, _)| nearest > 0.0) else {
        return f64::INFINITY;
    };
    // Rows are 256ths of a pixel times w, about the corner of the screen.
    let viewport = view.viewport();
    let about_middle =
        |row: DVec4, side: u32| (row.truncate() - w.truncate() * (f64::from(side) * 128.0)).length() / 256.0;
    about_middle(x, viewport.width()).max(about_middle(y, viewport.height())) / nearest
}

/// The least of an affine row over a box: at the corner that lies against its direction; and the size of what was summed.
fn least(row: DVec4, view: &View, bounds: Aabb, origin: DVec3) -> Option<(f64, f64)> {
    if bounds.is_empty() {
        return None;
    }
    let shift = origin - view.eye();
    let (min, max) = (bounds.min.as_dvec3() + shift, bounds.max.as_dvec3() + shift);
    let way = row.truncate();
    let corner = DVec3::select(way.cmplt(DVec3::ZERO), max, min);
    Some((way.dot(corner) + row.w, way.abs().dot(corner.abs()) + row.w.abs()))
}
