//! What the tests compare the library with: slow, plain, and without a line of its code.
//!
//! `exact` repeats the documented transform and evaluates edges in integers of 128 bits; `float` is a rasterizer in f64 that
//! knows nothing of snapping; `maps` is the overlap test of the thesis's figure 5.3; `portal_stage` draws what portals leave beside everything; `scenes` makes cameras and objects from seeds; `state` reads what the library drew and
//! shows where two such states differ; `verdicts` holds what is called hidden against the exact item buffer.
#![allow(dead_code)] // every test file uses a part of it

pub mod exact;
pub mod float;
pub mod maps;
#[cfg(feature = "bvh")]
pub mod portal_stage;
pub mod random;
pub mod scenes;
pub mod state;
pub mod verdicts;
