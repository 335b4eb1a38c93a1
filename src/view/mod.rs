//! What a viewer is: a view-projection matrix with an explicit convention, or a camera; and camera paths.

mod camera;
mod extent;
mod path;
#[cfg(feature = "cli")]
mod path_json;
mod projection;

pub use camera::Camera;
pub use extent::{lies_beyond_near, pixels_a_unit};
pub use path::{CameraPath, PathKey};
#[cfg(feature = "cli")]
pub use path_json::{PathFile, load_path, load_path_file};
#[cfg(feature = "cli")]
pub(crate) use path_json::{field, read_json, vector};
pub use projection::{ClipSpace, DepthRange, MAX_SIDE, View, Viewport};
