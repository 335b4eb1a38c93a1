//! The hierarchical occlusion maps: exact hole counts, 2x2 above level 0 (Zhang 1998, 4.1 and 4.2).
//!
//! A level-0 pixel is a block of m x n samples, 8x8 unless asked otherwise. What is stored is the number of samples that nothing
//! covers, exact at every level; opacity is one minus their share. Samples outside the viewport count as covered, odd
//! sizes round up, and levels end before one would be smaller than the minimal resolution. How it is filled:
//! `pyramid_build.rs`.

use super::contrast::Luminance;
use crate::error::{Error, Result};
use crate::geometry::SampleRect;
use crate::raster::{BLOCK, Grid};

/// The form of a pyramid: what a pixel of level 0 stands for, and where levels end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PyramidShape {
    /// Samples of a level-0 pixel: m across, n down, each 1 to 16384. At 8x8, the default, a pixel is one coverage word.
    pub block: [u32; 2],
    /// Pixels across and down that every level above level 0 has at least; 1x1 by default.
    pub minimal: [u32; 2],
}

impl Default for PyramidShape {
    fn default() -> Self {
        PyramidShape { block: [BLOCK as u32; 2], minimal: [1; 2] }
    }
}

impl PyramidShape {
    /// # Errors
    /// [`Error::Parameter`] when a number is not 1 to 16384.
    pub fn check(&self) -> Result<()> {
        for (name, pair) in [("block", self.block), ("minimal", self.minimal)] {
            if pair.iter().any(|side| !(1..=16384).contains(side)) {
                return Err(Error::parameter(name, format!("{}x{}", pair[0], pair[1]), "MxN, each 1 to 16384"));
            }
        }
        Ok(())
    }

    /// Samples of a level-0 pixel.
    pub fn block_samples(&self) -> u64 {
        u64::from(self.block[0]) * u64::from(self.block[1])
    }
}

/// One map of the pyramid, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Map {
    pub width: usize,
    pub height: usize,
    /// Empty at level 0 where counts fit bytes.
    pub holes: Vec<u32>,
    /// Empty unless contrast is asked for.
    pub luminance: Vec<Luminance>,
}

/// The pyramid, level 0 first: the finest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pyramid {
    pub(super) grid: Grid,
    pub(super) shape: PyramidShape,
    /// Level 0 where a pixel has at most 255 samples.
    pub(super) finest: Vec<u8>,
    pub(super) maps: Vec<Map>,
    /// Working memory of updates.
    pub(super) lists: Lists,
}

/// Pixels that changed, as `y << 16 | x`; those over them, a level up; and which of these are listed already.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Lists {
    pub changed: Vec<u32>,
    pub over: Vec<u32>,
    pub listed: Vec<bool>,
}

impl Pyramid {
    pub(crate) fn new(grid: Grid, shape: PyramidShape, with_luminance: bool) -> Pyramid {
        let [m, n] = shape.block.map(|side| side as usize);
        let [least_width, least_height] = shape.minimal.map(|side| side as usize);
        let (mut width, mut height) = ((grid.width() as usize).div_ceil(m), (grid.height() as usize).div_ceil(n));
        let bytes = shape.block_samples() <= 255;
        let mut maps: Vec<Map> = Vec::new();
        loop {
            let pixels = width * height;
            maps.push(Map {
                width,
                height,
                holes: vec![0; if bytes && maps.is_empty() { 0 } else { pixels }],
                luminance: vec![Luminance::default(); if with_luminance { pixels } else { 0 }],
            });
            let (w, h) = (width.div_ceil(2), height.div_ceil(2));
            if (width, height) == (1, 1) || w < least_width || h < least_height {
                break;
            }
            (width, height) = (w, h);
        }
        let pixels = maps[0].width * maps[0].height;
        Pyramid {
            grid,
            shape,
            finest: vec![0; if bytes { pixels } else { 0 }],
            maps,
            lists: Lists { listed: vec![false; pixels], ..Lists::default() },
        }
    }

    /// What it was built as.
    pub fn shape(&self) -> PyramidShape {
        self.shape
    }

    /// Levels, at least one.
    pub fn levels(&self) -> usize {
        self.maps.len()
    }

    /// Width and height of a level, in pixels.
    pub fn size(&self, level: usize) -> (usize, usize) {
        (self.maps[level].width, self.maps[level].height)
    }

    /// Samples of pixel (x, y) of a level that nothing covers.
    #[inline(always)]
    pub fn holes(&self, level: usize, x: usize, y: usize) -> u32 {
        let map = &self.maps[level];
        let at = y * map.width + x;
        if level == 0 && !self.finest.is_empty() { self.finest[at].into() } else { map.holes[at] }
    }

    /// Samples across and down that a pixel of a level stands for.
    pub fn pixel(&self, level: usize) -> (usize, usize) {
        ((self.shape.block[0] as usize) << level, (self.shape.block[1] as usize) << level)
    }

    /// The samples of pixel (x, y) of a level that lie inside the viewport.
    pub(crate) fn rect(&self, level: usize, x: usize, y: usize) -> SampleRect {
        let (m, n) = self.pixel(level);
        let last = |at: usize, side: usize, size: i32| ((at + 1) * side).min(size as usize) as i32 - 1;
        SampleRect {
            x0: (x * m) as i32,
            y0: (y * n) as i32,
            x1: last(x, m, self.grid.width()),
            y1: last(y, n, self.grid.height()),
        }
    }

    /// The share of a pixel's samples inside the viewport that are covered, 0 to 1.
    pub fn opacity(&self, level: usize, x: usize, y: usize) -> f64 {
        let r = self.rect(level, x, y);
        let samples = f64::from(r.x1 - r.x0 + 1) * f64::from(r.y1 - r.y0 + 1);
        1.0 - f64::from(self.holes(level, x, y)) / samples
    }

    /// The contrast of something of this luminance to what covers a pixel; 0 where luminances are not kept.
    #[inline(always)]
    pub(crate) fn contrast(&self, level: usize, x: usize, y: usize, luminance: u8) -> f64 {
        let map = &self.maps[level];
        map.luminance.get(y * map.width + x).map_or(0.0, |l| l.contrast(luminance))
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> usize {
        let map = |m: &Map| m.holes.len() * 4 + m.luminance.len() * size_of::<Luminance>();
        self.finest.len() + self.maps.iter().map(map).sum::<usize>()
    }
}
