//! Levels of detail, and occlusion-preserving simplification (thesis 7.2).
//!
//! | what | guarantee | where |
//! | --- | --- | --- |
//! | [`LodChain`]: static levels, chosen by projected error in pixels | none: its error is measured | `chain` |
//! | [`OccluderLevels`], [`simplify_occluder`]: closed parts replaced by triangles inside | never covers more | `occluder` |
//! | [`merge_coplanar`]: coplanar neighbours merged | the same set of points | `flat` |
//!
//! # Why the conservative levels are conservative
//!
//! A closed part S winds about the points that it encloses. Let t be a triangle without a point in common with S, and
//! let S wind at least once about one of its points. The winding number is constant on whatever is connected off S, so
//! it is at least 1 on all of t. Take a viewpoint about which S does not wind (any point outside its box will do) and a
//! ray from it to a point of t: along the ray the winding number begins at 0, goes up by 1 at every front face and down
//! by 1 at every back face that it passes, and ends at 1 or more. So it passes a front face on its way: the part is
//! seen there, and nearer. Rays that meet edges of S are limits of others, and S is a closed set. Hence, as sets of
//! points, what t covers S covers, from every viewpoint outside; and the same holds for any heap of such triangles, in
//! any order and with any holes. Both conditions are decided in exact arithmetic on the positions that are drawn; in
//! doubt the triangle is refused.
//!
//! Nothing else has to hold: not that the part is convex, or free of self-intersections, nor that the simplification
//! kept its topology. How triangles are found is a matter of quality alone.
//!
//! Drawn by samples, corners snap to 1/256 pixel and an object's rotation rounds: within that of an edge of the
//! original single samples may differ (SEMANTICS, *What "conservative" covers*). A viewpoint inside the part's box is
//! no viewpoint outside: there the original is the occluder.
//!
//! # What is left out
//!
//! View-dependent simplification (figure 7.2: a silhouette found anew each frame). The bench `silhouettes` sets what
//! finding a silhouette costs, at least, beside drawing the whole and a stand-in.

mod chain;
mod collapse;
mod enclosure;
mod flat;
mod inset;
mod levels;
mod occluder;
mod parts;
mod predicates;
mod sheets;
mod silhouettes;
mod unfold;
mod walls;

pub use chain::{LodChain, LodLevel};
pub use enclosure::Enclosure;
pub use flat::{Merge, Merged, merge_coplanar};
pub use levels::{Level, PartLevels};
pub use occluder::{OccluderLevels, SimplifiedOccluder, most_within, price_within, simplify_occluder};
pub use parts::{Open, Part, Parts};
