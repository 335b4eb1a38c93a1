//! The hierarchical overlap test, with an opacity threshold a level (Zhang 1998, 5.2 and 5.3.2).

use super::map::MapView;
use super::pyramid::Pyramid;
use super::query::rect_word;
use crate::error::{Error, Result};
use crate::geometry::SampleRect;

/// How many holes a pixel of each level may have and still count as opaque.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thresholds {
    /// By level; levels past the end allow what the last one does, scaled to their size.
    allowed: Vec<u32>,
}

impl Thresholds {
    /// Every level at opacity 1: no holes, conservative.
    pub fn conservative() -> Thresholds {
        Thresholds { allowed: Vec::new() }
    }

    /// One opacity threshold for all levels, above 0 and at most 1: `floor((1 - t) samples + 1e-9)` holes.
    ///
    /// # Errors
    /// [`Error::Parameter`] when `t` is out of range.
    pub fn uniform(t: f64) -> Result<Thresholds> {
        let ok = t > 0.0 && t <= 1.0;
        if !ok {
            return Err(Error::parameter("threshold", t, "an opacity above 0 and at most 1"));
        }
        let samples = |level: u32| 64.0 * 4f64.powi(level as i32);
        let allowed = (0..12).map(|level| ((1.0 - t) * samples(level) + 1e-9).floor() as u32).collect();
        Ok(Thresholds { allowed })
    }

    /// True when no level allows a hole.
    pub fn is_conservative(&self) -> bool {
        self.allowed.iter().all(|&holes| holes == 0)
    }

    fn allowed(&self, level: usize) -> u32 {
        self.allowed.get(level).or(self.allowed.last()).copied().unwrap_or(0)
    }
}

/// True when the rectangle (not empty, inside the viewport) overlaps opaque pixels alone. The test starts at the finest
/// level whose pixels are wider than the rectangle's smaller side (5.2.1) and descends where a pixel is not opaque; at level 0 a
/// pixel that the rectangle touches in part also passes when the samples inside are all covered.
pub(crate) fn overlap_test(map: MapView<'_>, pyramid: &Pyramid, thresholds: &Thresholds, r: SampleRect) -> bool {
    let smaller = (r.x1 - r.x0 + 1).min(r.y1 - r.y0 + 1) as usize;
    let level = (0..pyramid.levels()).find(|&l| pyramid.side(l) > smaller).unwrap_or(pyramid.levels() - 1);
    let shift = 3 + level;
    (r.y0 as usize >> shift..=r.y1 as usize >> shift).all(|y| {
        (r.x0 as usize >> shift..=r.x1 as usize >> shift)
            .all(|x| pixel_passes(map, pyramid, thresholds, r, level, x, y))
    })
}

fn pixel_passes(
    map: MapView<'_>,
    pyramid: &Pyramid,
    thresholds: &Thresholds,
    r: SampleRect,
    level: usize,
    x: usize,
    y: usize,
) -> bool {
    if pyramid.holes(level, x, y) <= thresholds.allowed(level) {
        return true;
    }
    if level == 0 {
        let (bx, by) = (x as i32, y as i32);
        let (tile, block) = (map.tile(bx >> 2, by >> 2), ((by & 3) * 4 + (bx & 3)) as usize);
        return rect_word(r, bx, by) & !map.word(tile, block) == 0;
    }
    let (width, height) = pyramid.size(level - 1);
    let shift = 2 + level;
    let (x0, x1) = ((2 * x).max(r.x0 as usize >> shift), (2 * x + 1).min(r.x1 as usize >> shift).min(width - 1));
    let (y0, y1) = ((2 * y).max(r.y0 as usize >> shift), (2 * y + 1).min(r.y1 as usize >> shift).min(height - 1));
    (y0..=y1).all(|y| (x0..=x1).all(|x| pixel_passes(map, pyramid, thresholds, r, level - 1, x, y)))
}
