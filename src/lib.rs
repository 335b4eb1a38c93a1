//! homcull answers *what can this viewer see?* on the CPU alone, in the frame that asks.
//!
//! Occluders are rasterized into an [`OcclusionBuffer`](occlusion::OcclusionBuffer): one bit of coverage a sample, and
//! depth beside it, kept apart (Zhang 1998). Boxes are asked about, by the thousand and from any thread. What is called
//! hidden has no visible sample: with the display's own samples and the defaults, the picture drawn from what is left is the
//! picture drawn from everything, bit for bit.
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use homcull::geometry::Aabb;
//! use homcull::occlusion::{Hidden, OcclusionBuffer, Verdict, Visible};
//! use homcull::raster::Facing;
//! use homcull::view::{Camera, Viewport};
//!
//! # fn main() -> homcull::Result<()> {
//! // A viewer at the origin looks along -z.
//! let camera = Camera {
//!     eye: DVec3::ZERO,
//!     target: DVec3::new(0.0, 0.0, -1.0),
//!     up: DVec3::Y,
//!     fov_y_deg: 90.0,
//!     near: 0.1,
//!     far: None,
//! };
//! let viewport = Viewport::new(192, 96)?;
//! let mut buffer = OcclusionBuffer::new(viewport);
//! buffer.begin(&camera.view(viewport)?)?;
//!
//! // Ten metres ahead stands a gabled wall.
//! let wall = [(-7.5, -5.0), (7.5, -5.0), (7.5, 2.5), (0.0, 8.0), (-7.5, 2.5)].map(|(x, y)| Vec3::new(x, y, -10.0));
//! buffer.submit_triangles(&wall, &[[0, 1, 2], [0, 2, 4], [4, 2, 3]], DVec3::ZERO, Facing::Both)?;
//!
//! // Boxes two metres large: behind it, beside it, in front of it, around the viewer, and at his back.
//! let ask = |x: f32, z: f32| {
//!     let middle = Vec3::new(x, 0.0, z);
//!     buffer.test(Aabb { min: middle - Vec3::ONE, max: middle + Vec3::ONE }, DVec3::ZERO)
//! };
//! assert_eq!(ask(0.0, -20.0)?, Verdict::Hidden(Hidden::OverlapAndDepth));
//! assert_eq!(ask(20.0, -20.0)?, Verdict::Visible(Visible::Uncovered));
//! assert_eq!(ask(0.0, -5.0)?, Verdict::Visible(Visible::InFront));
//! assert_eq!(ask(0.0, 0.0)?, Verdict::Visible(Visible::NearPlane));
//! assert_eq!(ask(0.0, 20.0)?, Verdict::Hidden(Hidden::OutsideFrustum));
//!
//! // What covers the screen, a character a block of 8x8 samples: `#` whole, `+` more than half, `.` less.
//! let picture = [
//!     "                        ",
//!     "           ..           ",
//!     "         .+##+.         ",
//!     "        .+####+.        ",
//!     "       .+######+.       ",
//!     "       .########.       ",
//!     "       .########.       ",
//!     "       .########.       ",
//!     "       .########.       ",
//!     "                        ",
//!     "                        ",
//!     "                        ",
//! ];
//! assert_eq!(buffer.to_ascii().lines().collect::<Vec<_>>(), picture);
//! # Ok(())
//! # }
//! ```
//!
//! A real scene prepares its meshes once ([`raster::PreparedMeshes`]), draws occluders as lists
//! ([`submit`](occlusion::OcclusionBuffer::submit), or in bands on threads of its own:
//! [`submit_in_bands`](occlusion::OcclusionBuffer::submit_in_bands)), and tests boxes as lists
//! ([`project`](occlusion::OcclusionBuffer::project), then
//! [`test_projected`](occlusion::OcclusionBuffer::test_projected)); or leaves it all to
//! [`progressive`](occlusion::OcclusionBuffer::progressive), where whatever is seen occludes what is behind it and nothing has to be
//! chosen. The program `examples/embed.rs` does all of this.
//!
//! # Rooms
//!
//! | module | holds |
//! | --- | --- |
//! | [`geometry`], [`view`] | boxes, screen rectangles; cameras, matrices and their depth conventions, paths |
//! | [`raster`] | the one rasterizer, and meshes prepared for it |
//! | [`occlusion`] | occlusion maps, overlap test, depth test, and [`OcclusionBuffer`](occlusion::OcclusionBuffer), their face |
//! | [`scene`] | meshes, objects, loaders, generators; the hierarchy over them (feature `bvh`) |
//! | `select`, `cull` | occluder selection; the culling methods, one file each (feature `bvh`) |
//! | `pipeline` | the stages OccSel, Cull and Draw on threads or in turn (feature `bvh`) |
//! | [`draw`] | the final draw on the CPU, and the exact item buffer that errors are measured against |
//! | [`measure`], `cli` | walks, kernels, reports, plots; the program (feature `cli`) |
//!
//! With `default-features = false` the crate depends on `glam`, `libm` and `homcull-simd` alone.
//!
//! # What holds
//!
//! - **Conservative.** With opacity thresholds at 1, original geometry as occluders and the display's samples, nothing with a
//!   visible sample is called hidden. Modes that give this up say so in their name or docs.
//! - **Deterministic.** The same input gives the same verdicts, counts and bits at any SIMD level and on any number of threads.
//! - **Total.** NaN, infinities, empty meshes, boxes around the eye: each has a typed [`Error`] or a conservative answer. A
//!   panic is a bug.
//! - **Quiet.** No global state, no threads of its own. Beginning a view, submitting a list, projecting and testing lists allocate
//!   nothing once the first frame of a size has passed.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "bvh")]
pub mod cull;
pub mod draw;
pub mod error;
pub mod geometry;
pub mod hash;
pub mod measure;
pub mod occlusion;
#[cfg(feature = "bvh")]
pub mod pipeline;
pub mod raster;
pub mod scene;
#[cfg(feature = "bvh")]
pub mod select;
pub mod view;
pub mod workers;

pub use error::{Error, Result};
pub use homcull_simd::Level;
