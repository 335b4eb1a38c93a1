//! Walks and kernels, measured; error metrics; tables, plots and pictures.

#[cfg(feature = "bvh")]
pub mod bake;
pub mod clock;
#[cfg(feature = "cli")]
pub mod comparison;
#[cfg(feature = "cli")]
pub mod csv;
#[cfg(feature = "cli")]
pub mod experiments;
#[cfg(feature = "cli")]
pub mod json;
pub mod kernels;
pub mod memory;
#[cfg(feature = "image")]
pub mod picture;
#[cfg(feature = "cli")]
pub mod plot;
#[cfg(feature = "cli")]
mod plot_canvas;
#[cfg(feature = "cli")]
mod plot_chart;
#[cfg(feature = "cli")]
mod plot_labels;
#[cfg(feature = "bvh")]
pub mod preset;
pub mod report;
pub mod report_number;
pub mod report_target;
#[cfg(feature = "bvh")]
mod runner;
#[cfg(feature = "bvh")]
pub mod stability;
#[cfg(feature = "bvh")]
mod stage;
pub mod statistics;
pub mod table;
#[cfg(feature = "cli")]
pub mod table_walk;
#[cfg(feature = "bvh")]
pub mod walk;
#[cfg(feature = "bvh")]
mod walk_pipeline;
