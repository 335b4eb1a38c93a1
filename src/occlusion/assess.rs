//! A test with all that is known of it: the verdict, the level of visibility (Zhang 1998, 5.4), and the deciding level (8.2.4).
//!
//! The level of visibility is the continuum between visible and occluded, for callers that order, simplify or fade by it. It
//! belongs to the overlap test: what is in front of occluders, or cut by the near plane, is wholly visible. The verdict is
//! that of the plain test, except for contrast: only here the luminance of what is tested is known.

use std::cell::Cell;
use std::ops::Range;

use glam::DVec3;
use homcull_simd::{Kernel, Simd};

use super::boxes::{ProjectedBox, ProjectedBoxes};
use super::buffer::{Occluder, OcclusionBuffer};
use super::overlap::{Overlap, OverlapStatistics};
use super::project::{BoxView, ProjectOne};
use super::query::rect_word;
use super::test::{Apart, Representation, test_box, without_box};
use super::verdict::{Hidden, Verdict, Visible};
use crate::error::Result;
use crate::geometry::{Aabb, SampleRect};
use crate::raster::Band;

/// A verdict, and how it came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assessment {
    /// Hidden or visible, and why.
    pub verdict: Verdict,
    /// From 0, nothing can be seen of it, to 1: 1 less the lowest opacity among the pixels of the deciding level that its
    /// rectangle touches. Level 0 where tests go by samples; a level-0 pixel counts as opaque where all its samples inside the
    /// rectangle are covered.
    pub level_of_visibility: f64,
    /// The level that decided the overlap test; `None` where there was none, or where it went by samples.
    pub decided_at: Option<usize>,
}

/// The two tests apart, remembering the last overlap test.
struct Recording<'a> {
    state: Apart<'a>,
    luminance: Option<u8>,
    last: Cell<Option<(SampleRect, Overlap)>>,
}

impl Recording<'_> {
    /// The overlap test of a rectangle: not again if it was the last one.
    #[inline(always)]
    fn passes<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        if let Some((last, overlap)) = self.last.get()
            && last == r
        {
            return overlap.passed;
        }
        let overlap = match self.state.overlap(r, self.luminance) {
            Some(overlap) => overlap,
            None => Overlap { passed: !self.state.map.is_open(s, r), level: 0 },
        };
        self.last.set(Some((r, overlap)));
        overlap.passed
    }
}

impl Representation for Recording<'_> {
    #[inline(always)]
    fn band(&self) -> Band {
        self.state.map.band
    }

    #[inline(always)]
    fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool {
        self.passes(s, r) && self.state.is_behind(s, r, z)
    }

    #[inline(always)]
    fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        !self.passes(s, r)
    }
}

/// Assesses projected boxes. One function for one and for many.
struct Assess<'a> {
    buffer: &'a OcclusionBuffer,
    view: &'a BoxView,
    boxes: &'a [ProjectedBox],
    bounds: &'a [Aabb],
    luminance: Luminances<'a>,
    out: Wanted<'a>,
}

/// What is wanted of every box.
enum Wanted<'a> {
    All(&'a mut Vec<Assessment>),
    /// Whether it is hidden; and of all together, which levels decided.
    Hidden(&'a mut Vec<bool>, &'a mut OverlapStatistics),
}

/// Luminances of what is tested.
#[derive(Clone, Copy)]
enum Luminances<'a> {
    Same(Option<u8>),
    ById(&'a [Occluder]),
}

impl Kernel for Assess<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Assess { buffer, view, boxes, bounds, luminance, mut out } = self;
        let no_sample_is_hidden = buffer.settings.no_sample_is_hidden;
        let mut state = Recording { state: buffer.apart(), luminance: None, last: Cell::new(None) };
        for b in boxes {
            state.last.set(None);
            state.luminance = match luminance {
                _ if !buffer.settings.contrast => None,
                Luminances::Same(luminance) => luminance,
                #[allow(clippy::manual_map)] // kernels hold no closures
                Luminances::ById(occluders) => match occluders.get(b.id() as usize) {
                    Some(occluder) => Some(occluder.luminance),
                    None => None,
                },
            };
            let verdict = test_box(s, &state, view, b, bounds, no_sample_is_hidden);
            match &mut out {
                Wanted::All(out) => out.push(buffer.assessment(verdict, state.last.get())),
                Wanted::Hidden(hidden, statistics) => {
                    hidden.push(verdict.is_hidden());
                    if let Some((_, overlap)) = state.last.get()
                        && state.state.overlap.is_some()
                    {
                        statistics.add_overlap(overlap);
                    }
                }
            }
        }
    }
}

impl OcclusionBuffer {
    /// Tests one box, given about `origin`, as [`OcclusionBuffer::test`] does, and says how visible it is. `luminance`, 0 to 255,
    /// is that of what the box holds, for thresholds raised by contrast; without it none is raised.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn assess(&self, bounds: Aabb, origin: DVec3, luminance: Option<u8>) -> Result<Assessment> {
        let view = self.box_view(self.begun()?, origin);
        if let Some(verdict) = without_box(bounds) {
            return Ok(self.assessment(verdict, None));
        }
        let mut projected = ProjectedBoxes::new();
        self.level.run(ProjectOne { view: &view, min: bounds.min, max: bounds.max, out: &mut projected });
        Ok(match projected.boxes.first() {
            None => self.assessment(Verdict::Hidden(Hidden::OutsideFrustum), None),
            Some(b) => self.assess_one(&view, b, &[bounds], luminance),
        })
    }

    /// Assesses projected boxes `range.start..range.end` into `out`; see [`OcclusionBuffer::test_projected`]. `occluders`, by
    /// id, give the luminances of what is tested; those past their end have none.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn assess_projected(
        &self,
        boxes: &ProjectedBoxes,
        range: Range<usize>,
        bounds: &[Aabb],
        origin: DVec3,
        occluders: &[Occluder],
        out: &mut Vec<Assessment>,
    ) -> Result<()> {
        let view = &self.box_view(self.begun()?, origin);
        out.clear();
        let (luminance, out) = (Luminances::ById(occluders), Wanted::All(out));
        self.level.run(Assess { buffer: self, view, boxes: &boxes.boxes[range], bounds, luminance, out });
        Ok(())
    }

    /// Tests projected boxes as [`OcclusionBuffer::test_projected`] does, with the luminances of `occluders`, by id, and counts
    /// the tests by the level that decided them, where the pyramid is walked. Cheaper than to assess them.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    #[allow(clippy::too_many_arguments)] // as for `test_projected`, and two more
    pub fn test_projected_counted(
        &self,
        boxes: &ProjectedBoxes,
        range: Range<usize>,
        bounds: &[Aabb],
        origin: DVec3,
        occluders: &[Occluder],
        hidden: &mut Vec<bool>,
        statistics: &mut OverlapStatistics,
    ) -> Result<()> {
        let view = &self.box_view(self.begun()?, origin);
        hidden.clear();
        let (luminance, out) = (Luminances::ById(occluders), Wanted::Hidden(hidden, statistics));
        self.level.run(Assess { buffer: self, view, boxes: &boxes.boxes[range], bounds, luminance, out });
        Ok(())
    }

    fn assess_one(&self, view: &BoxView, b: &ProjectedBox, bounds: &[Aabb], luminance: Option<u8>) -> Assessment {
        let mut out = Vec::with_capacity(1);
        let (boxes, luminance) = (std::slice::from_ref(b), Luminances::Same(luminance));
        self.level.run(Assess { buffer: self, view, boxes, bounds, luminance, out: Wanted::All(&mut out) });
        out.swap_remove(0)
    }

    /// What a verdict and the last overlap test come to.
    fn assessment(&self, verdict: Verdict, last: Option<(SampleRect, Overlap)>) -> Assessment {
        let walks = self.overlap_test();
        let level_of_visibility = match (verdict, last) {
            (Verdict::Visible(Visible::Uncovered), Some((r, overlap)))
            | (Verdict::Hidden(Hidden::OverlapAndDepth), Some((r, overlap))) => match &walks {
                Some(test) => test.level_of_visibility(r, overlap.level),
                None => self.visibility_by_blocks(r),
            },
            (Verdict::Visible(_), _) => 1.0,
            (Verdict::Hidden(_), _) => 0.0,
        };
        let decided_at = walks.and(last).map(|(_, overlap)| overlap.level);
        Assessment { verdict, level_of_visibility, decided_at }
    }

    /// The level of visibility by 8x8 blocks, from the coverage words.
    fn visibility_by_blocks(&self, r: SampleRect) -> f64 {
        let (grid, coverage) = (self.map.grid, self.coverage());
        let mut most: f64 = 0.0;
        for by in r.y0 >> 3..=r.y1 >> 3 {
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let open = !coverage.word_at(bx, by);
                if open & rect_word(r, bx, by) != 0 {
                    let samples = (!grid.padding(bx as usize, by as usize)).count_ones();
                    most = most.max(f64::from(open.count_ones()) / f64::from(samples));
                }
            }
        }
        most
    }
}
