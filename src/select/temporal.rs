//! Temporal coherence (Zhang 1998, 7.4): what was occluded a moment ago is no candidate occluder now.
//!
//! F is the set of objects in the frustum, V of those that are not occluded. Equation 7.1 gives the candidates:
//!
//! ```text
//! C(N+1) = [F(N+1) - (F(N+1) and F(N))]  or  (F(N+1) and F(N) and V(N))
//! ```
//!
//! (its second printed line needs brackets to say the same). Since V is part of F this is F(N+1) - (F(N) - V(N)): what a
//! frame has to remember is one bit an object, *in the frustum and occluded*. Objects that have just entered the frustum stay
//! candidates (the text's refinement, figure 7.4a): view-frustum culling has no coherence. An object that has just come out
//! from behind another is no candidate for one frame (figure 7.4b); it is tested and drawn like any other, so the picture is
//! right, and a candidate again as soon as it was seen. Among candidates distance and the triangle limit decide, as ever.
//!
//! N+1 is N+lag where culling overlaps with later frames. Cost: a bit an object to clear, a bit a candidate to read.

/// Objects that were in the frustum of a frame and occluded there: F - V.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Occluded {
    words: Vec<u64>,
}

impl Occluded {
    /// None of `objects` objects is occluded. Allocates only when there are more than ever before.
    pub fn clear(&mut self, objects: usize) {
        self.words.clear();
        self.words.resize(objects.div_ceil(64), 0);
    }

    /// Forgets everything, as before the first frame: then no object is held back.
    pub fn forget(&mut self) {
        self.words.clear();
    }

    /// Takes down an object that was in the frustum and occluded. An id beyond those of [`Occluded::clear`] is not kept.
    pub fn insert(&mut self, object: u32) {
        if let Some(word) = self.words.get_mut(object as usize / 64) {
            *word |= 1 << (object % 64);
        }
    }

    /// Whether the object was in the frustum and occluded.
    pub fn contains(&self, object: u32) -> bool {
        self.words.get(object as usize / 64).is_some_and(|word| word >> (object % 64) & 1 != 0)
    }
}

/// The candidates of equation 7.1: of the objects in the frustum now, those that were not in it and occluded `before`.
pub fn temporal_candidates<'a>(
    in_frustum: impl Iterator<Item = u32> + 'a,
    before: &'a Occluded,
) -> impl Iterator<Item = u32> + 'a {
    in_frustum.filter(|&id| !before.contains(id))
}
