//! The order in which occluders are taken: by distance, under a limit (Zhang 1998, 7.3.2), or up to a plane at a distance (7.3.1).
//!
//! The plane is inexpensive, but it does not bound the triangles selected; the thesis says so, and so do we.
//! Keys are bits that sort as the order does, so that the walk of the database (`database.rs`) compares integers.

use glam::Vec3;

use crate::geometry::Aabb;

/// Triangles of the selected occluders, at most.
pub const DEFAULT_TRIANGLES: u64 = 25_000;

/// How far away a box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// Distance to the centre of the box, the thesis's own.
    #[default]
    Center,
    /// Distance to its nearest point: mends the thesis's failure with large polygons, whose boxes have their centres far away.
    Nearest,
}

/// In which order occluders are taken, and how far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// By distance from the eye (7.3.2); ties by id.
    Distance(Measure),
    /// By how near they reach along `forward`, a unit vector; what reaches no nearer than `distance` is not taken (7.3.1).
    ZPlane {
        /// The view direction.
        forward: Vec3,
        /// Of the plane, from the eye.
        distance: f32,
    },
}

impl Order {
    /// Bits that sort as the order does: of the object with this box. Not below [`Order::group`] of any box around it.
    #[inline(always)]
    pub(super) fn object(self, b: Aabb, eye: Vec3) -> u32 {
        match self {
            // Squared distances are not negative: their bits sort as they do.
            Order::Distance(Measure::Center) => (b.center() - eye).length_squared().to_bits(),
            Order::Distance(Measure::Nearest) | Order::ZPlane { .. } => self.group(b, eye),
        }
    }

    /// The same for a group: of its nearest point.
    #[inline(always)]
    pub(super) fn group(self, b: Aabb, eye: Vec3) -> u32 {
        match self {
            Order::Distance(_) => b.distance_squared(eye).to_bits(),
            Order::ZPlane { forward, .. } => {
                let nearest = Vec3::select(forward.cmpge(Vec3::ZERO), b.min, b.max);
                // What reaches behind the eye is nearest of all. A maximum with a NaN is the other number.
                (nearest - eye).dot(forward).max(0.0).to_bits()
            }
        }
    }

    /// Keys from which on nothing is taken.
    pub(super) fn end(self) -> u32 {
        match self {
            Order::Distance(_) => u32::MAX,
            Order::ZPlane { distance, .. } => distance.max(0.0).to_bits(),
        }
    }
}
