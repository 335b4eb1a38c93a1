//! The test of a projected box: one function for every caller, generic over what is asked and over the state that answers.
//!
//! A box is tested as it was projected; if it leaves the viewport and may be called visible only because of what lies outside,
//! it is clipped to the frustum and tested again. What is seen through a hole stays visible, however it is clipped. The part of a box in
//! a band is all that a band's state answers for; the whole screen is the band of all rows.

use std::ops::Range;

use glam::DVec3;
use homcull_simd::{Kernel, Simd};

use super::boxes::{BoxSet, CUT, NEAR, ProjectedBox, ProjectedBoxes};
use super::buffer::OcclusionBuffer;
use super::clip_box::{ClippedBox, clip_box};
use super::layers::Layers;
use super::map::MapView;
use super::overlap::{Overlap, OverlapTest};
use super::project::{BoxView, Project, ProjectOne};
use super::pyramid_build::Coverage;
use super::query::DepthReading;
use super::verdict::{Hidden, Verdict, Visible};
use crate::error::Result;
use crate::geometry::{Aabb, SampleRect};
use crate::raster::Band;

/// What a caller wants to know of a box.
pub(crate) trait Answer {
    /// Whether the reason for being visible is asked for: it costs a second look.
    const REASON: bool;

    fn hidden(why: Hidden) -> Self;

    /// Without `REASON`, what is not known to be uncovered is said to be in front.
    fn visible(why: Visible) -> Self;
}

impl Answer for Verdict {
    const REASON: bool = true;

    #[inline(always)]
    fn hidden(why: Hidden) -> Verdict {
        Verdict::Hidden(why)
    }

    #[inline(always)]
    fn visible(why: Visible) -> Verdict {
        Verdict::Visible(why)
    }
}

/// Merely whether it is hidden.
impl Answer for bool {
    const REASON: bool = false;

    #[inline(always)]
    fn hidden(_why: Hidden) -> bool {
        true
    }

    #[inline(always)]
    fn visible(_why: Visible) -> bool {
        false
    }
}

/// The occlusion representation of a band, as a test reads it. Rectangles are not empty, and inside the band.
pub(crate) trait Representation {
    fn band(&self) -> Band;

    /// True when both tests pass: the rectangle is covered, and all that covers it is nearer than `z`.
    fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool;

    /// True when the overlap test fails.
    fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool;
}

/// Thresholds at 1 over the no-background Z-buffer: both tests in one pass.
#[derive(Clone, Copy)]
pub(crate) struct AtOnce<'a> {
    pub map: MapView<'a>,
    pub reading: DepthReading,
}

impl Representation for AtOnce<'_> {
    #[inline(always)]
    fn band(&self) -> Band {
        self.map.band
    }

    #[inline(always)]
    fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool {
        self.map.hides(s, r, z, self.reading)
    }

    #[inline(always)]
    fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        self.map.is_open(s, r)
    }
}

/// The overlap test and the depth test apart (Zhang 1998, chapter 3).
#[derive(Clone, Copy)]
pub(crate) struct Apart<'a> {
    pub map: MapView<'a>,
    /// Through the pyramid, which is in step with the map; `None`: by samples.
    pub overlap: Option<OverlapTest<'a>>,
    /// `None`: the overlap test alone.
    pub depth: Option<DepthReading>,
    /// Where layers are fused.
    pub layers: Option<&'a Layers>,
}

impl Apart<'_> {
    /// The overlap test through the pyramid, for something of a luminance.
    #[inline(always)]
    pub fn overlap(&self, r: SampleRect, luminance: Option<u8>) -> Option<Overlap> {
        #[allow(clippy::manual_map)] // kernels hold no closures
        match &self.overlap {
            Some(test) => Some(test.run(r, luminance)),
            None => None,
        }
    }

    /// The depth test alone: nothing that covers a sample of the rectangle is at `z` or farther.
    #[inline(always)]
    pub fn is_behind<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool {
        match (self.depth, self.layers) {
            (None, _) => true,
            (Some(reading), None) => self.map.covered_is_nearer(s, r, z, reading),
            (Some(reading), Some(layers)) => {
                let coverage = Coverage { map: self.map, fused: layers.fused() };
                layers.covered_is_nearer(s, coverage, r, z, reading)
            }
        }
    }
}

impl Representation for Apart<'_> {
    #[inline(always)]
    fn band(&self) -> Band {
        self.map.band
    }

    #[inline(always)]
    fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32) -> bool {
        !self.is_open(s, r) && self.is_behind(s, r, z)
    }

    #[inline(always)]
    fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        match self.overlap(r, None) {
            Some(overlap) => !overlap.passed,
            None => self.map.is_open(s, r),
        }
    }
}

/// Tests a projected box against a band's state. `bounds` are the boxes by id, for those that have to be clipped. A box with no
/// sample in the band is hidden there; one with no sample at all only if `no_sample_is_hidden`.
#[inline(always)]
pub(crate) fn test_box<S: Simd, R: Representation, A: Answer>(
    s: S,
    state: &R,
    view: &BoxView,
    b: &ProjectedBox,
    bounds: &[Aabb],
    no_sample_is_hidden: bool,
) -> A {
    // At first as it was projected; then, if that may be too near, clipped to the frustum. One place asks the state, whichever it is.
    let (mut r, mut z) = (b.rect(), b.depth);
    let mut clip = b.tag & NEAR != 0;
    loop {
        if clip {
            match bounds.get(b.id() as usize).map(|&bounds| clip_box(view, bounds)) {
                None | Some(ClippedBox::Near) => return A::visible(Visible::NearPlane),
                Some(ClippedBox::Outside) => return A::hidden(Hidden::OutsideFrustum),
                Some(ClippedBox::Inside(rect, depth)) => (r, z) = (rect, depth),
            }
        }
        if r.is_empty() {
            return if no_sample_is_hidden { A::hidden(Hidden::NoSample) } else { A::visible(Visible::Uncovered) };
        }
        let band = state.band();
        let r = SampleRect { y0: r.y0.max(band.first_row()), y1: r.y1.min(band.last_row()), ..r };
        if r.is_empty() {
            return A::hidden(Hidden::NoSample);
        }
        if state.hides(s, r, z) {
            return A::hidden(Hidden::OverlapAndDepth);
        }
        let may_clip = !clip && b.tag & CUT != 0;
        if (A::REASON || may_clip) && state.is_open(s, r) {
            return A::visible(Visible::Uncovered);
        }
        if !may_clip {
            return A::visible(Visible::InFront);
        }
        clip = true;
    }
}

/// The verdict on what has no finite box: visible, unless it is empty.
pub(crate) fn without_box(bounds: Aabb) -> Option<Verdict> {
    if bounds.is_finite() {
        return None;
    }
    let empty = bounds.is_empty() && !bounds.min.is_nan() && !bounds.max.is_nan();
    Some(if empty { Verdict::Hidden(Hidden::OutsideFrustum) } else { Verdict::Visible(Visible::NearPlane) })
}

struct TestOne<'a> {
    buffer: &'a OcclusionBuffer,
    view: &'a BoxView,
    b: &'a ProjectedBox,
    bounds: &'a [Aabb],
}

impl Kernel for TestOne<'_> {
    type Output = Verdict;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Verdict {
        let TestOne { buffer, view, b, bounds } = self;
        let no_sample_is_hidden = buffer.settings.no_sample_is_hidden;
        match buffer.at_once() {
            Some(state) => test_box(s, &state, view, b, bounds, no_sample_is_hidden),
            None => test_box(s, &buffer.apart(), view, b, bounds, no_sample_is_hidden),
        }
    }
}

struct TestMany<'a> {
    buffer: &'a OcclusionBuffer,
    view: &'a BoxView,
    boxes: &'a [ProjectedBox],
    bounds: &'a [Aabb],
    hidden: &'a mut Vec<bool>,
}

impl Kernel for TestMany<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let buffer = self.buffer;
        match buffer.at_once() {
            Some(state) => self.with(s, &state),
            None => self.with(s, &buffer.apart()),
        }
    }
}

impl TestMany<'_> {
    #[inline(always)]
    fn with<S: Simd, R: Representation>(self, s: S, state: &R) {
        let no_sample_is_hidden = self.buffer.settings.no_sample_is_hidden;
        for b in self.boxes {
            self.hidden.push(test_box(s, state, self.view, b, self.bounds, no_sample_is_hidden));
        }
    }
}

impl OcclusionBuffer {
    /// Tests one box, given about `origin`: may any of it be seen?
    ///
    /// A box that is not finite counts as visible, an empty one as outside.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn test(&self, bounds: Aabb, origin: DVec3) -> Result<Verdict> {
        let view = self.box_view(self.begun()?, origin);
        if let Some(verdict) = without_box(bounds) {
            return Ok(verdict);
        }
        let mut projected = ProjectedBoxes::new();
        self.level.run(ProjectOne { view: &view, min: bounds.min, max: bounds.max, out: &mut projected });
        Ok(match projected.boxes.first() {
            None => Verdict::Hidden(Hidden::OutsideFrustum),
            Some(b) => self.level.run(TestOne { buffer: self, view: &view, b, bounds: &[bounds] }),
        })
    }

    /// Projects a set of boxes about `origin` for this view: once, however often they are then tested.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn project(&self, boxes: &BoxSet, origin: DVec3, out: &mut ProjectedBoxes) -> Result<()> {
        let view = self.box_view(self.begun()?, origin);
        self.level.run(Project { view: &view, set: boxes, out });
        Ok(())
    }

    /// Tests projected boxes `range.start..range.end`; `hidden` gets a flag for each. `bounds` are the boxes as they were given to
    /// [`BoxSet::new`], for those that have to be clipped; `origin` is theirs.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn test_projected(
        &self,
        boxes: &ProjectedBoxes,
        range: Range<usize>,
        bounds: &[Aabb],
        origin: DVec3,
        hidden: &mut Vec<bool>,
    ) -> Result<()> {
        let view = self.box_view(self.begun()?, origin);
        hidden.clear();
        self.level.run(TestMany { buffer: self, view: &view, boxes: &boxes.boxes[range], bounds, hidden });
        Ok(())
    }

    /// The verdict on one projected box, with its reason.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn test_one_projected(&self, b: &ProjectedBox, bounds: &[Aabb], origin: DVec3) -> Result<Verdict> {
        let view = self.box_view(self.begun()?, origin);
        Ok(self.level.run(TestOne { buffer: self, view: &view, b, bounds }))
    }

    /// The whole screen's state, where both tests are one; `None` where they are not.
    #[inline(always)]
    fn at_once(&self) -> Option<AtOnce<'_>> {
        let one = self.settings.keep_depth && !self.walks_pyramid();
        one.then_some(AtOnce { map: self.map.view(), reading: self.settings.depth })
    }

    /// The whole screen's state, for the two tests one after the other.
    #[inline(always)]
    pub(super) fn apart(&self) -> Apart<'_> {
        Apart {
            map: self.map.view(),
            overlap: self.overlap_test(),
            depth: if self.settings.keep_depth { Some(self.settings.depth) } else { None },
            layers: self.layers.as_deref().filter(|layers| layers.fuses()),
        }
    }
}
