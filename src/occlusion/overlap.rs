//! The hierarchical overlap test (Zhang 1998, 5.2, 5.3 and figure 5.3).
//!
//! Is a rectangle of samples inside the cumulative projection of the occluders? The test starts at the finest active level whose
//! pixels exceed the rectangle's smaller side (5.2.1) and descends where a pixel is neither opaque nor rejected:
//!
//! - *aggressive approximate culling*: a pixel whose opacity reaches the threshold of its level is not looked into (5.3.2);
//! - *conservative rejection*: one below the transparency threshold ends the test (5.3.1);
//! - *predictive rejection*: so does one inside the rectangle whose opacity lies below the opacity threshold of the finest active
//!   level, since a pixel below it will fail there (5.3.4, as figure 5.3 has it). A transparency threshold of a finer level
//!   foretells nothing more: it lies below that opacity threshold.
//!
//! Where figure 5.3 fails at level 0, a pixel that the rectangle touches in part passes if all its samples *inside* are covered:
//! at thresholds of 1 the test is thereby exact by samples. With a coarser finest active level there is no such look (8.2.4).
//! Cost: a few reads, most often one.

use super::assess::Assessment;
use super::pyramid::Pyramid;
use super::pyramid_build::Coverage;
use super::query::rect_word;
use super::thresholds::Limits;
use super::verdict::{Verdict, Visible};
use crate::error::{Error, Result};
use crate::geometry::SampleRect;

/// The levels that overlap tests use (8.2.4): the finest of them is treated as if it were level 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActiveLevels {
    /// Where descending ends.
    pub finest: usize,
    /// Where no test starts above; `None` for the pyramid's coarsest.
    pub coarsest: Option<usize>,
}

impl ActiveLevels {
    /// The range in a pyramid of so many levels.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the pyramid has not got them, or the finest is coarser than the coarsest.
    pub(crate) fn in_pyramid(self, levels: usize) -> Result<(usize, usize)> {
        let coarsest = self.coarsest.unwrap_or(levels - 1);
        if self.finest > coarsest || coarsest >= levels {
            let value = match self.coarsest {
                Some(coarsest) => format!("{}-{coarsest}", self.finest),
                None => format!("{}-", self.finest),
            };
            return Err(Error::parameter(
                "levels",
                value,
                format!("A-B, A at most B, of the levels 0 to {}", levels - 1),
            ));
        }
        Ok((self.finest, coarsest))
    }
}

/// What an overlap test found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Overlap {
    /// True when the rectangle overlaps opaque pixels alone.
    pub passed: bool,
    /// The deciding level: where the test failed, or the finest that it had to look at.
    pub level: usize,
}

/// Overlap tests by the level that decided them, summed over tests (8.2.4).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OverlapStatistics {
    /// Tests that passed, by deciding level.
    pub passed: Vec<u64>,
    /// Tests that failed, by deciding level.
    pub failed: Vec<u64>,
}

impl OverlapStatistics {
    /// Counts a test, if the pyramid decided it.
    pub fn add(&mut self, assessment: &Assessment) {
        if let Some(level) = assessment.decided_at {
            let passed = assessment.verdict != Verdict::Visible(Visible::Uncovered);
            self.add_overlap(Overlap { passed, level });
        }
    }

    pub(crate) fn add_overlap(&mut self, overlap: Overlap) {
        let counts = if overlap.passed { &mut self.passed } else { &mut self.failed };
        if counts.len() <= overlap.level {
            counts.resize(overlap.level + 1, 0);
        }
        counts[overlap.level] += 1;
    }

    /// True when nothing was counted.
    pub fn is_empty(&self) -> bool {
        self.passed.is_empty() && self.failed.is_empty()
    }
}

impl std::ops::AddAssign<&OverlapStatistics> for OverlapStatistics {
    fn add_assign(&mut self, o: &OverlapStatistics) {
        for (to, from) in [(&mut self.passed, &o.passed), (&mut self.failed, &o.failed)] {
            if to.len() < from.len() {
                to.resize(from.len(), 0);
            }
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }
}

/// What overlap tests of one buffer have in common.
#[derive(Clone, Copy)]
pub(crate) struct OverlapTest<'a> {
    pub coverage: Coverage<'a>,
    pub pyramid: &'a Pyramid,
    pub limits: &'a Limits,
}

/// A rectangle in the pyramid.
#[derive(Clone, Copy)]
struct Asked {
    r: SampleRect,
    /// Level-0 pixels that it touches.
    pixels: [usize; 4],
    /// Of the tested object, where thresholds are raised by contrast.
    luminance: Option<u8>,
}

impl OverlapTest<'_> {
    /// Tests a rectangle (not empty, inside the viewport). With a luminance, thresholds are raised by its contrast to what
    /// covers a pixel.
    #[inline(always)]
    pub fn run(&self, r: SampleRect, luminance: Option<u8>) -> Overlap {
        let asked = self.ask(r, luminance);
        let level = self.start_level(r);
        let mut decided = level;
        let passed = self.all_pass(&asked, level, self.touched(&asked, level), &mut decided);
        Overlap { passed, level: decided }
    }

    #[inline(always)]
    fn ask(&self, r: SampleRect, luminance: Option<u8>) -> Asked {
        let (m, n) = self.pyramid.pixel(0);
        let pixels = if (m, n) == (8, 8) {
            [r.x0 as usize >> 3, r.y0 as usize >> 3, r.x1 as usize >> 3, r.y1 as usize >> 3]
        } else {
            [r.x0 as usize / m, r.y0 as usize / n, r.x1 as usize / m, r.y1 as usize / n]
        };
        Asked { r, pixels, luminance }
    }

    /// The finest active level whose pixels exceed the rectangle's smaller side, along that side; else the coarsest.
    #[inline(always)]
    fn start_level(&self, r: SampleRect) -> usize {
        let (width, height) = ((r.x1 - r.x0 + 1) as usize, (r.y1 - r.y0 + 1) as usize);
        let (m, n) = self.pyramid.pixel(self.limits.finest);
        let (smaller, mut side) = if width <= height { (width, m) } else { (height, n) };
        let mut level = self.limits.finest;
        while side <= smaller && level < self.limits.coarsest {
            (level, side) = (level + 1, side * 2);
        }
        level
    }

    /// The pixels of a level that the rectangle touches: x0, y0, x1, y1.
    #[inline(always)]
    fn touched(&self, asked: &Asked, level: usize) -> [usize; 4] {
        let [x0, y0, x1, y1] = asked.pixels;
        [x0 >> level, y0 >> level, x1 >> level, y1 >> level]
    }

    fn all_pass(&self, asked: &Asked, level: usize, [x0, y0, x1, y1]: [usize; 4], decided: &mut usize) -> bool {
        for y in y0..=y1 {
            for x in x0..=x1 {
                if !self.passes(asked, level, x, y, decided) {
                    return false;
                }
            }
        }
        true
    }

    /// `CheckPixel` of figure 5.3. `decided` is the finest level looked at so far; where the test fails, the level of that pixel.
    fn passes(&self, asked: &Asked, level: usize, x: usize, y: usize, decided: &mut usize) -> bool {
        let (holes, limit) = (self.pyramid.holes(level, x, y), self.limits.at(level));
        *decided = level.min(*decided);
        let opaque = match asked.luminance {
            None => limit.opaque,
            Some(luminance) => limit.opaque_at(self.pyramid.contrast(level, x, y, luminance)),
        };
        if holes <= opaque {
            return true;
        }
        if level == self.limits.finest {
            return level == 0 && self.samples_pass(asked.r, x, y);
        }
        if holes > limit.transparent || holes > limit.foretold && within(asked.r, self.pyramid.rect(level, x, y)) {
            *decided = level;
            return false;
        }
        let [x0, y0, x1, y1] = self.touched(asked, level - 1);
        let below = [x0.max(2 * x), y0.max(2 * y), x1.min(2 * x + 1), y1.min(2 * y + 1)];
        self.all_pass(asked, level - 1, below, decided)
    }

    /// True when all samples of a level-0 pixel that lie in the rectangle are covered.
    fn samples_pass(&self, r: SampleRect, x: usize, y: usize) -> bool {
        let pixel = self.pyramid.rect(0, x, y);
        let part = SampleRect {
            x0: r.x0.max(pixel.x0),
            y0: r.y0.max(pixel.y0),
            x1: r.x1.min(pixel.x1),
            y1: r.y1.min(pixel.y1),
        };
        for by in part.y0 >> 3..=part.y1 >> 3 {
            for bx in part.x0 >> 3..=part.x1 >> 3 {
                if rect_word(part, bx, by) & !self.coverage.word_at(bx, by) != 0 {
                    return false;
                }
            }
        }
        true
    }

    /// The level of visibility of a rectangle (5.4): 1 less the lowest opacity among the pixels of the deciding level that it
    /// touches. A level-0 pixel counts as opaque where all its samples in the rectangle are covered.
    pub fn level_of_visibility(&self, r: SampleRect, level: usize) -> f64 {
        let asked = self.ask(r, None);
        let [x0, y0, x1, y1] = self.touched(&asked, level);
        let mut lowest = 1.0;
        for y in y0..=y1 {
            for x in x0..=x1 {
                let opacity = self.pyramid.opacity(level, x, y);
                if opacity < lowest && !(level == 0 && self.samples_pass(r, x, y)) {
                    lowest = opacity;
                }
            }
        }
        1.0 - lowest
    }
}

/// True when all samples of `inner` lie in `outer`.
#[inline(always)]
fn within(outer: SampleRect, inner: SampleRect) -> bool {
    outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && outer.x1 >= inner.x1 && outer.y1 >= inner.y1
}
