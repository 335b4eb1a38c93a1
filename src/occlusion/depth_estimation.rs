//! The depth estimation buffer (Zhang 1998, 6.3): the screen in uniform partitions, each with the farthest depth of the
//! occluders that project into it.
//!
//! It is built from far bounding rectangles: where one touches a partition and lies *farther*, it overwrites it. So it is a least
//! depth over what was submitted: the order of submission does not matter, and an occluder is never skipped, hidden or not. Where no occluder
//! is, it stays at +infinity, nearest of all: there the depth test passes and the overlap test alone decides. What lies strictly
//! beyond every partition that it touches is behind all that is drawn there. A rectangle of samples touches a partition when one
//! of its samples lies there; occluder and occludee that share a sample share its partition, so any resolution is conservative, even
//! one finer than the samples.
//!
//! Cost: a write for each partition that a rectangle touches, and a read likewise.

use std::ops::Range;

use super::far_rectangle::FarRectangle;
use crate::error::{Error, Result};
use crate::geometry::SampleRect;
use crate::raster::Grid;
use crate::view::MAX_SIDE;

/// How many partitions the screen has along its width and height: 64x64 by default, which the thesis found enough (6.3.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Partitions {
    width: u32,
    height: u32,
}

impl Default for Partitions {
    fn default() -> Partitions {
        Partitions { width: 64, height: 64 }
    }
}

impl Partitions {
    /// # Errors
    /// [`Error::Parameter`] unless each side is 1 to [`MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> Result<Partitions> {
        let side = 1..=MAX_SIDE;
        if side.contains(&width) && side.contains(&height) {
            return Ok(Partitions { width, height });
        }
        Err(Error::parameter("deb-size", format!("{width}x{height}"), format!("each side must be 1 to {MAX_SIDE}")))
    }

    /// Partitions in a row.
    pub fn width(self) -> u32 {
        self.width
    }

    /// Rows of partitions.
    pub fn height(self) -> u32 {
        self.height
    }
}

/// The farthest depths of the occluders, by partition of the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthEstimationBuffer {
    grid: Grid,
    partitions: Partitions,
    /// Reversed depths, row by row from the top left; +infinity where no occluder is.
    depths: Vec<f32>,
}

impl DepthEstimationBuffer {
    pub(crate) fn new(partitions: Partitions, grid: Grid) -> DepthEstimationBuffer {
        let count = partitions.width as usize * partitions.height as usize;
        DepthEstimationBuffer { grid, partitions, depths: vec![f32::INFINITY; count] }
    }

    /// No occluder is anywhere.
    pub(crate) fn clear(&mut self) {
        self.depths.fill(f32::INFINITY);
    }

    /// Its resolution.
    pub fn partitions(&self) -> Partitions {
        self.partitions
    }

    /// The farthest reversed depths, row by row from the top left; +infinity where no occluder is.
    pub fn depths(&self) -> &[f32] {
        &self.depths
    }

    /// The farthest depth where a sample of the viewport lies.
    pub(crate) fn at(&self, x: i32, y: i32) -> f32 {
        let (px, py) = self.partition(x, y);
        self.depths[py * self.partitions.width as usize + px]
    }

    /// The partition that a sample of the viewport lies in: monotone in both.
    fn partition(&self, x: i32, y: i32) -> (usize, usize) {
        let of = |sample: i32, side: i32, partitions: u32| sample as usize * partitions as usize / side as usize;
        (of(x, self.grid.width(), self.partitions.width), of(y, self.grid.height(), self.partitions.height))
    }

    /// The partitions that a rectangle touches, as a range in each of its rows.
    fn rows(&self, r: SampleRect) -> impl Iterator<Item = Range<usize>> + use<> {
        let ((x0, y0), (x1, y1)) = (self.partition(r.x0, r.y0), self.partition(r.x1, r.y1));
        let width = self.partitions.width as usize;
        (y0..=y1).map(move |y| y * width + x0..y * width + x1 + 1)
    }

    /// An occluder pushes the boundary away from the viewer.
    pub(crate) fn push(&mut self, far: FarRectangle) {
        for row in self.rows(far.rect) {
            for depth in &mut self.depths[row] {
                *depth = depth.min(far.depth);
            }
        }
    }

    /// The depth test (6.3.2): true when all partitions that the rectangle (not empty, inside the viewport) touches are nearer than `z`.
    pub(crate) fn is_nearer(&self, r: SampleRect, z: f32) -> bool {
        self.rows(r).all(|row| self.depths[row].iter().all(|&depth| depth > z))
    }
}
