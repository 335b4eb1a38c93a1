//! Scenes: meshes, objects with f64 positions, loaders, generators, subdivision, and the hierarchy over them.

mod benchmark;
mod cells;
#[cfg(feature = "cli")]
mod cells_json;
#[cfg(feature = "bvh")]
mod cover;
#[cfg(feature = "bvh")]
mod find_cells;
mod generate;
#[cfg(feature = "bvh")]
mod hierarchy;
#[cfg(feature = "lod")]
pub mod lod;
mod mesh;
mod model;
#[cfg(feature = "obj")]
mod mtl;
#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "obj")]
mod obj_scan;
#[cfg(feature = "bvh")]
mod object_cells;
#[cfg(feature = "bvh")]
mod octree;
#[cfg(feature = "bvh")]
mod placed_triangles;
#[cfg(feature = "bvh")]
mod plane_grid;
#[cfg(any(feature = "obj", feature = "lod"))]
mod polygon;
mod prepared;
mod random;
#[cfg(feature = "bvh")]
mod solidity;
#[cfg(feature = "cli")]
mod source;
mod subdivide;
#[cfg(feature = "bvh")]
mod wide;

pub use crate::raster::Facing;
pub use benchmark::{Benchmark, Reference, ReferenceAnswer, load_benchmark, load_reference};
pub use cells::{Cell, Cells, Portal};
#[cfg(feature = "cli")]
pub use cells_json::load_cells;
#[cfg(feature = "bvh")]
pub use find_cells::{FoundCells, find_cells};
pub use generate::{Generated, Generator, generators, parse};
#[cfg(feature = "bvh")]
pub use hierarchy::{Hierarchy, MAX_DEPTH, Node};
pub use mesh::Mesh;
pub use model::{Object, Scene};
#[cfg(feature = "obj")]
pub use obj::load_obj;
#[cfg(feature = "bvh")]
pub use object_cells::ObjectCells;
#[cfg(feature = "bvh")]
pub use octree::{DEFAULT_LEAF_TRIANGLES, MAX_OCTREE_DEPTH, Octree, OctreeLimits};
#[cfg(feature = "bvh")]
pub(crate) use placed_triangles::PlacedTriangles;
pub use prepared::PreparedScene;
#[cfg(feature = "bvh")]
pub use solidity::shown_areas;
#[cfg(feature = "cli")]
pub(crate) use source::path_views;
#[cfg(feature = "cli")]
pub use source::{Loaded, SceneSource, Views, load};
pub use subdivide::{Subdivision, subdivide};
#[cfg(feature = "bvh")]
pub(crate) use wide::Child;
#[cfg(feature = "bvh")]
pub use wide::WideHierarchy;
