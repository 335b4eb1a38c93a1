//! The depth representations (Zhang 1998, chapter 6), interchangeable beside one map of coverage.
//!
//! Each is a boundary that is nowhere nearer than the occluders drawn there; a box strictly beyond it, whose rectangle is covered, is
//! hidden. The no-background Z-buffer is the nearest such boundary and is rasterized with the coverage, into the map. The
//! others are far boundaries, made of far bounding rectangles: for them the rasterizer makes coverage alone. They are kept per
//! submission, a round: tests see all that was submitted before.

use super::buffer::{Occluder, OcclusionSettings};
use super::depth_estimation::{DepthEstimationBuffer, Partitions};
use super::depth_plane::DepthPlane;
use super::far_rectangle::FarRectangle;
use super::query::DepthReading;
use crate::geometry::SampleRect;
use crate::raster::{Grid, ObjectRows, PreparedMeshes};
use crate::view::View;

/// Which of them an occlusion buffer keeps. All are conservative; from the first to the last they cost less and hide less.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthRepresentation {
    /// The no-background Z-buffer (6.4): `depth=nbz`, `depth=nbz-block`, by its reading.
    NoBackground(DepthReading),
    /// The depth estimation buffer (6.3) of this many partitions: `depth=deb`.
    Estimation(Partitions),
    /// The single plane (6.2): `depth=plane`.
    Plane,
}

impl Default for DepthRepresentation {
    fn default() -> DepthRepresentation {
        DepthRepresentation::NoBackground(DepthReading::default())
    }
}

impl DepthRepresentation {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            DepthRepresentation::NoBackground(DepthReading::PerSample) => "nbz",
            DepthRepresentation::NoBackground(DepthReading::PerBlock) => "nbz-block",
            DepthRepresentation::Estimation(_) => "deb",
            DepthRepresentation::Plane => "plane",
        }
    }
}

/// The depth that is kept in one view.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Depth {
    /// None: the overlap test alone.
    Nothing,
    /// In the map, by block and sample.
    InMap,
    Estimation(DepthEstimationBuffer),
    Plane(DepthPlane),
}

impl Depth {
    /// Begins a view without occluders. Keeps its memory where the kind stays.
    pub fn begin(&mut self, settings: &OcclusionSettings, grid: Grid) {
        if !settings.keep_depth {
            *self = Depth::Nothing;
            return;
        }
        match (settings.depth, &mut *self) {
            (DepthRepresentation::NoBackground(_), _) => *self = Depth::InMap,
            (DepthRepresentation::Plane, _) => *self = Depth::Plane(DepthPlane::NEAREST),
            (DepthRepresentation::Estimation(size), Depth::Estimation(buffer)) if buffer.partitions() == size => {
                buffer.clear();
            }
            (DepthRepresentation::Estimation(size), _) => {
                *self = Depth::Estimation(DepthEstimationBuffer::new(size, grid));
            }
        }
    }

    /// True when the rasterizer keeps depth beside coverage.
    pub fn is_in_map(&self) -> bool {
        matches!(self, Depth::InMap)
    }

    /// Takes a round of occluders into a far boundary; translucent ones too where they are fused.
    pub fn push(&mut self, view: &View, grid: Grid, meshes: &PreparedMeshes, occluders: &[Occluder], fuses: bool) {
        if matches!(self, Depth::Nothing | Depth::InMap) {
            return;
        }
        for o in occluders.iter().filter(|o| o.covers(fuses)) {
            let rows = ObjectRows::new(view, o.position);
            let Some(far) = FarRectangle::new(&rows, o.rotation.as_ref(), meshes.bounds(o.mesh), grid) else {
                continue;
            };
            match self {
                Depth::Estimation(buffer) => buffer.push(far),
                Depth::Plane(plane) => plane.push(far),
                Depth::Nothing | Depth::InMap => {}
            }
        }
    }

    /// The depth test against a far boundary; true when there is none.
    pub fn boundary_is_nearer(&self, r: SampleRect, z: f32) -> bool {
        match self {
            Depth::Nothing | Depth::InMap => true,
            Depth::Estimation(buffer) => buffer.is_nearer(r, z),
            Depth::Plane(plane) => plane.is_nearer(z),
        }
    }
}
