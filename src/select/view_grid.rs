//! The view points of visibility preprocessing (Zhang 1998, 7.5): the middles of the cells of a regular grid in a box.
//!
//! The eye is snapped onto the nearest point; in its own cell that is the cell's own, elsewhere those within reach are looked
//! through, in no more than the cells of a cube around the eye.

use glam::{DVec3, UVec3};

use crate::error::{Error, Result};

/// Points along an axis, at most.
pub const MAX_CELLS: u32 = 1024;
/// Points of a grid, at most.
const MAX_POINTS: u64 = 1 << 22;

/// A regular grid of view points in a box, numbered x first, then y, then z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewGrid {
    cells: UVec3,
    min: DVec3,
    max: DVec3,
}

impl ViewGrid {
    /// A grid of so many cells along each axis, in a box in the world.
    ///
    /// # Errors
    /// [`Error::Parameter`] when there are no points, or more than 1024 along an axis or 2^22 in all; or when the box is not
    /// finite or turned inside out.
    pub fn new(cells: UVec3, min: DVec3, max: DVec3) -> Result<ViewGrid> {
        let grid = format!("{}x{}x{}", cells.x, cells.y, cells.z);
        let all = cells.to_array().iter().map(|&n| u64::from(n)).product::<u64>();
        if cells.min_element() == 0 || cells.max_element() > MAX_CELLS || all > MAX_POINTS {
            return Err(Error::parameter("grid", grid, "1 to 1024 points along an axis, and 4194304 at most"));
        }
        if !(min.is_finite() && max.is_finite() && min.cmple(max).all() && (max - min).is_finite()) {
            return Err(Error::parameter("box", format!("{min} to {max}"), "must be finite, its least corner first"));
        }
        Ok(ViewGrid { cells, min, max })
    }

    /// Cells along the axes.
    pub fn cells(&self) -> UVec3 {
        self.cells
    }

    /// The box's corners.
    pub fn corners(&self) -> (DVec3, DVec3) {
        (self.min, self.max)
    }

    /// How many points.
    pub fn points(&self) -> usize {
        (self.cells.x * self.cells.y * self.cells.z) as usize
    }

    /// Edges of a cell, in metres.
    pub fn cell_size(&self) -> DVec3 {
        (self.max - self.min) / self.cells.as_dvec3()
    }

    /// Where a point is.
    pub fn point(&self, number: usize) -> DVec3 {
        let (nx, ny) = (self.cells.x as usize, self.cells.y as usize);
        self.at(UVec3::new((number % nx) as u32, (number / nx % ny) as u32, (number / nx / ny) as u32))
    }

    fn at(&self, cell: UVec3) -> DVec3 {
        // Both ends have a part: a box of no thickness has all its points in it.
        let t = (cell.as_dvec3() + 0.5) / self.cells.as_dvec3();
        self.min * (1.0 - t) + self.max * t
    }

    fn number(&self, cell: UVec3) -> usize {
        ((cell.z * self.cells.y + cell.y) * self.cells.x + cell.x) as usize
    }

    /// The corners of the box between eight points in which an eye is, or, outside the points, of the part of their border that is
    /// nearest to it. Where the eye lies in a plane of points, and on the border, some are the same.
    pub fn around(&self, eye: DVec3) -> [usize; 8] {
        let last = (self.cells - 1).as_dvec3();
        // 0/0, of a flat box, casts to 0.
        let at = ((eye - self.min) / self.cell_size() - 0.5).clamp(DVec3::ZERO, last);
        let (low, high) = (at.floor().as_uvec3(), at.ceil().as_uvec3());
        std::array::from_fn(|corner| {
            let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            self.number(UVec3::new(side(0), side(1), side(2)).min(self.cells - 1))
        })
    }

    /// The nearest usable point within `reach` of an eye; ties by number.
    pub fn nearest(&self, eye: DVec3, reach: f64, usable: impl Fn(usize) -> bool) -> Option<usize> {
        if !eye.is_finite() {
            return None;
        }
        let size = self.cell_size();
        // A cell more on each side than needed, so that no rounding leaves one out; 0/0, of a flat box, casts to 0.
        let place = |at: DVec3, more: f64| ((at - self.min) / size + more).as_uvec3().min(self.cells - 1);
        let (low, high) = (place(eye - reach, -1.0), place(eye + reach, 1.0));
        let mut best: Option<(f64, usize)> = None;
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = UVec3::new(x, y, z);
                    let (distance, number) = (self.at(cell).distance(eye), self.number(cell));
                    if distance <= reach && best.is_none_or(|(least, _)| distance < least) && usable(number) {
                        best = Some((distance, number));
                    }
                }
            }
        }
        best.map(|(_, number)| number)
    }
}
