//! Rectangles of samples on the screen.

/// A rectangle of samples, in samples, both ends inclusive; empty when `x0 > x1` or `y0 > y1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleRect {
    /// Leftmost column.
    pub x0: i32,
    /// Topmost row.
    pub y0: i32,
    /// Rightmost column.
    pub x1: i32,
    /// Bottom row.
    pub y1: i32,
}

impl SampleRect {
    /// True when no sample lies in the rectangle.
    pub fn is_empty(self) -> bool {
        self.x0 > self.x1 || self.y0 > self.y1
    }
}
