//! The test of a projected box: one function for every caller, generic over what is asked and over the state that answers.
//!
//! A box is tested as it was projected; if it leaves the viewport and may be called visible only because of what lies outside,
//! it is clipped to the frustum and tested again. What is seen through a hole stays visible, however it is clipped. The part of a box in
//! a band is all that a band's state answers for; the whole screen is the band of all rows.

use std::marker::PhantomData;
use std::ops::Range;

use glam::DVec3;
use homcull_simd::{Kernel, Simd};

use super::boxes::{BoxSet, CUT, NEAR, ProjectedBox, ProjectedBoxes};
use super::buffer::OcclusionBuffer;
use super::clip_box::{ClippedBox, clip_box};
use super::depth::Depth;
use super::layers::Layers;
use super::map::{MapView, SampleDepths, TileSamples};
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
    /// Whether the reason for being visible is asked for: it costs a second look. Without it, what is not hidden is said to be in front.
    const REASON: bool;

    fn of(verdict: Verdict) -> Self;
}

impl Answer for Verdict {
    const REASON: bool = true;

    #[inline(always)]
    fn of(verdict: Verdict) -> Verdict {
        verdict
    }
}

/// Merely whether it is hidden.
impl Answer for bool {
    const REASON: bool = false;

    #[inline(always)]
    fn of(verdict: Verdict) -> bool {
        verdict.is_hidden()
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
pub(crate) struct AtOnce<'a, T = TileSamples> {
    pub map: MapView<'a, T>,
    pub reading: DepthReading,
}

impl<T: SampleDepths> Representation for AtOnce<'_, T> {
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
    pub depth: &'a Depth,
    /// How depth in the map is read.
    pub reading: DepthReading,
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
            (Depth::InMap, None) => self.map.covered_is_nearer(s, r, z, self.reading),
            (Depth::InMap, Some(layers)) => {
                let coverage = Coverage { map: self.map, fused: layers.fused() };
                layers.covered_is_nearer(s, coverage, r, z, self.reading)
            }
            (far, _) => far.boundary_is_nearer(r, z),
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
    if b.tag & (NEAR | CUT) == 0 {
        A::of(test_rect::<S, R, A>(s, state, b.rect(), b.depth, no_sample_is_hidden))
    } else {
        s.vectorize(TestCut { state, view, b, bounds, no_sample_is_hidden, answer: PhantomData })
    }
}

#[inline(always)]
fn test_rect<S: Simd, R: Representation, A: Answer>(
    s: S,
    state: &R,
    r: SampleRect,
    z: f32,
    no_sample_is_hidden: bool,
) -> Verdict {
    if r.is_empty() {
        return if no_sample_is_hidden {
            Verdict::Hidden(Hidden::NoSample)
        } else {
            Verdict::Visible(Visible::Uncovered)
        };
    }
    let band = state.band();
    let r = SampleRect { y0: r.y0.max(band.first_row()), y1: r.y1.min(band.last_row()), ..r };
    if r.is_empty() {
        Verdict::Hidden(Hidden::NoSample)
    } else if state.hides(s, r, z) {
        Verdict::Hidden(Hidden::OverlapAndDepth)
    } else if A::REASON && state.is_open(s, r) {
        Verdict::Visible(Visible::Uncovered)
    } else {
        Verdict::Visible(Visible::InFront)
    }
}

/// The test of a box that touches the near plane or leaves the viewport, as a function of its own: such boxes are few.
struct TestCut<'a, R, A> {
    state: &'a R,
    view: &'a BoxView,
    b: &'a ProjectedBox,
    bounds: &'a [Aabb],
    no_sample_is_hidden: bool,
    answer: PhantomData<A>,
}

impl<R: Representation, A: Answer> Kernel for TestCut<'_, R, A> {
    type Output = A;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> A {
        let TestCut { state, view, b, bounds, no_sample_is_hidden, .. } = self;
        if b.tag & NEAR == 0 {
            let verdict = test_rect::<S, R, Verdict>(s, state, b.rect(), b.depth, no_sample_is_hidden);
            if verdict != Verdict::Visible(Visible::InFront) {
                return A::of(verdict);
            }
        }
        A::of(match bounds.get(b.id() as usize).map(|&bounds| clip_box(view, bounds)) {
            None | Some(ClippedBox::Near) => Verdict::Visible(Visible::NearPlane),
            Some(ClippedBox::Outside) => Verdict::Hidden(Hidden::OutsideFrustum),
            Some(ClippedBox::Inside(r, z)) => test_rect::<S, R, A>(s, state, r, z, no_sample_is_hidden),
        })
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

struct TestDepth<'a> {
    buffer: &'a OcclusionBuffer,
    r: SampleRect,
    z: f32,
}

impl Kernel for TestDepth<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> bool {
        self.buffer.apart().is_behind(s, self.r, self.z)
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

    /// The depth test alone (6.1) of one projected box that is not cut by the near plane: does it stay clear of all that is visible of
    /// the occluders? One without a sample does.
    ///
    /// # Errors
    /// [`Error::View`](crate::Error::View) when no view has begun.
    pub fn passes_depth_test(&self, b: &ProjectedBox) -> Result<bool> {
        self.begun()?;
        Ok(b.rect().is_empty() || self.level.run(TestDepth { buffer: self, r: b.rect(), z: b.depth }))
    }

    /// The whole screen's state, where both tests are one; `None` where they are not.
    #[inline(always)]
    fn at_once(&self) -> Option<AtOnce<'_>> {
        if self.tests_at_once() { Some(AtOnce { map: self.map.view(), reading: self.reading() }) } else { None }
    }

    /// The whole screen's state, for the two tests one after the other.
    #[inline(always)]
    pub(super) fn apart(&self) -> Apart<'_> {
        Apart {
            map: self.map.view(),
            overlap: self.overlap_test(),
            depth: &self.depth,
            reading: self.reading(),
            layers: self.layers.as_deref().filter(|layers| layers.fuses()),
        }
    }
}
