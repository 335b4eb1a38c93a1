//! The single plane (Zhang 1998, 6.2): the farthest depth of all occluders.
//!
//! Every occluder counts as relevant to every box, wherever the two stand on the screen: it is the depth estimation buffer of one
//! partition, for the price of one comparison.

use super::far_rectangle::FarRectangle;

/// The plane behind all occluders on the screen, perpendicular to the viewing direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthPlane {
    depth: f32,
}

impl DepthPlane {
    /// Without occluders: nearer than everything.
    pub(crate) const NEAREST: DepthPlane = DepthPlane { depth: f32::INFINITY };

    /// Its reversed depth; +infinity when there is no occluder.
    pub fn depth(self) -> f32 {
        self.depth
    }

    /// An occluder pushes the plane away from the viewer.
    pub(crate) fn push(&mut self, far: FarRectangle) {
        self.depth = self.depth.min(far.depth);
    }

    /// The depth test: true when the plane is nearer than `z`.
    #[inline(always)]
    pub(crate) fn is_nearer(self, z: f32) -> bool {
        self.depth > z
    }
}
