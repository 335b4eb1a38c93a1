//! The culling methods, one file each.
//!
//! A method is a *filter*, which looks at a node of the hierarchy and a view ([`frustum`]), and a *driver* at the end,
//! which owns the walk ([`vfc`], [`hom`], [`horizons`], [`portals`], [`plp`], [`pvs`], [`ideal`]; [`hzb`], [`coherent`] and cPLP draw meanwhile). Methods are composed by restricting the [world](vfc::World::restrict_to) to what one left. Stages are plain functions with owned inputs and outputs:
//! [`hom::select_occluders`] (OccSel), [`hom::cull`] (Cull), and the draw, which takes the visible set.

mod accumulated_solidity;
mod assumption;
pub mod chc;
pub mod coherent;
mod cplp;
pub mod detail;
mod fade;
mod feedback;
mod front;
pub mod frustum;
pub mod hom;
mod hom_parameters;
pub mod horizons;
pub mod hzb;
pub mod ideal;
mod method;
mod method_list;
mod nearest_first;
mod overlap_parameters;
pub mod plp;
mod plp_cells;
mod plp_parameters;
pub mod portals;
mod progressive;
pub mod pvs;
mod query_device;
mod query_parameters;
mod query_thread;
mod sources;
mod stop_and_wait;
mod test_batch;
pub mod vfc;

use crate::occlusion::OverlapStatistics;

pub use fade::FadeIn;
pub(crate) use feedback::Feedback;
pub use feedback::FeedbackLine;
pub use hom_parameters::{Database, HomParameters, PIPELINE_LAG, Selection, Update};
pub use method::{HzbParameters, IdealSet, Method};
pub use method_list::{MethodDescription, methods};
pub use overlap_parameters::{Hole, OverlapParameters};
pub use plp_cells::{PlpCells, SharedCells};
pub use plp_parameters::{CellKind, DEFAULT_BUDGET, Heuristic, PlpParameters};
pub use portals::{CellsFrom, PortalClip, PortalParameters};
pub use pvs::PvsParameters;
pub use query_device::Waited;
pub use sources::{OccluderSources, SharedSources};

/// What a frame's culling found, and what it cost in counts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct VisibleSet {
    /// Objects to draw, nearest first; of what draws while it culls, those drawn, in its own order.
    pub objects: Vec<u32>,
    /// Objects whose box meets the frustum; 0 where they were not all looked at, as when a walk drops hidden nodes.
    pub in_frustum: u32,
    /// Their triangles, or 0 likewise.
    pub triangles_in_frustum: u64,
    /// Triangles of what was found hidden; where a whole node was, of all below it, in the frustum or not.
    pub triangles_hidden: u64,
    /// Triangles drawn as occluders, into another buffer than the picture; 0 where the picture itself occludes.
    pub occluder_triangles: u64,
    /// Occlusion tests of objects and nodes.
    pub queries: u64,
    /// Of the tests that walked the pyramid, by the level that decided them (thesis 8.2.4).
    pub overlap: OverlapStatistics,
    /// What was waited for answers to occlusion queries.
    pub waited: Waited,
    /// True when testing was given up for the frame because nothing was hidden; in `pvs`, when no view point was in reach.
    pub bypassed: bool,
}

impl VisibleSet {
    /// What two stages did together: the objects of the second, which saw what the first left.
    pub fn then(self, second: VisibleSet) -> VisibleSet {
        let first_looked = self.in_frustum > 0;
        let mut overlap = self.overlap;
        overlap += &second.overlap;
        VisibleSet {
            objects: second.objects,
            in_frustum: if first_looked { self.in_frustum } else { second.in_frustum },
            triangles_in_frustum: if first_looked { self.triangles_in_frustum } else { second.triangles_in_frustum },
            triangles_hidden: self.triangles_hidden + second.triangles_hidden,
            occluder_triangles: self.occluder_triangles + second.occluder_triangles,
            queries: self.queries + second.queries,
            overlap,
            waited: Waited {
                steps: self.waited.steps + second.waited.steps,
                nanoseconds: self.waited.nanoseconds + second.waited.nanoseconds,
            },
            bypassed: self.bypassed || second.bypassed,
        }
    }
}
