//! Axis-aligned boxes in f32, about some origin that the owner of the box knows.

use glam::Vec3;

/// An axis-aligned box. `min <= max` in every component, or the box is [`Aabb::EMPTY`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The smallest corner.
    pub min: Vec3,
    /// The largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box of no points: joining it with anything gives the other.
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The tightest box around the points; [`Aabb::EMPTY`] for none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |b, p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The tightest box around both.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// True for the box of no points, and for one that a NaN has got into.
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// True when all six numbers are finite and the box holds a point.
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite() && !self.is_empty()
    }

    /// The middle of the box.
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The edge lengths.
    pub fn size(self) -> Vec3 {
        self.max - self.min
    }

    /// Squared distance from `p` to the nearest point of the box; 0 inside.
    pub fn distance_squared(self, p: Vec3) -> f32 {
        (self.min - p).max(p - self.max).max(Vec3::ZERO).length_squared()
    }

    /// The box with every face one f32 step further out: what a rounding may have cut off is inside again.
    pub fn outwards(self) -> Aabb {
        let down = |v: Vec3| Vec3::new(v.x.next_down(), v.y.next_down(), v.z.next_down());
        let up = |v: Vec3| Vec3::new(v.x.next_up(), v.y.next_up(), v.z.next_up());
        Aabb { min: down(self.min), max: up(self.max) }
    }
}
