//! Which side of a triangle is drawn.

use homcull_simd::Mask;

/// Which side of an object's triangles is drawn, by the sign of the snapped area on the screen: a mirroring transform
/// therefore swaps the sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Facing {
    /// Triangles that are counter-clockwise on the screen.
    Front,
    /// Triangles that are clockwise on the screen.
    Back,
    /// All of them.
    #[default]
    Both,
}

impl Facing {
    /// All lanes or none, for triangles in front and for those turned away.
    #[inline(always)]
    pub(crate) fn masks(self) -> (Mask, Mask) {
        match self {
            Facing::Front => (!0, 0),
            Facing::Back => (0, !0),
            Facing::Both => (!0, !0),
        }
    }
}
