//! What a test says, and why.

/// The answer to *is this box hidden?*, with its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Some of it may be seen.
    Visible(Visible),
    /// None of it can be seen.
    Hidden(Hidden),
}

/// Why something counts as visible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Visible {
    /// It touches the near plane inside the view, or is too close to it for its rectangle to be bounded.
    NearPlane,
    /// The overlap test failed: not all of its rectangle is covered.
    Uncovered,
    /// Its rectangle is covered, but not all of that lies nearer.
    InFront,
    /// It was not tested: a budget or the bypass ended testing.
    Budget,
}

/// Why something counts as hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Hidden {
    /// Covered, and behind what covers it.
    OverlapAndDepth,
    /// Outside the view frustum.
    OutsideFrustum,
    /// Its widened rectangle holds no sample.
    NoSample,
    /// Smaller on the screen than the caller cares for.
    TooSmall,
}

impl Verdict {
    /// True when none of it can be seen.
    pub fn is_hidden(self) -> bool {
        matches!(self, Verdict::Hidden(_))
    }

    /// The reason, as tables and files write it.
    pub fn reason(self) -> &'static str {
        match self {
            Verdict::Visible(Visible::NearPlane) => "near_plane",
            Verdict::Visible(Visible::Uncovered) => "uncovered",
            Verdict::Visible(Visible::InFront) => "in_front",
            Verdict::Visible(Visible::Budget) => "budget",
            Verdict::Hidden(Hidden::OverlapAndDepth) => "overlap_and_depth",
            Verdict::Hidden(Hidden::OutsideFrustum) => "outside_frustum",
            Verdict::Hidden(Hidden::NoSample) => "no_sample",
            Verdict::Hidden(Hidden::TooSmall) => "too_small",
        }
    }
}
