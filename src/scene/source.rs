//! What a SCENE argument means: an OBJ file, a generator with its parameters, or a benchmark folder; and its views.
//!
//! An OBJ that is one object is soup and subdivided finely; oversized objects are subdivided in any OBJ (thesis 8.2.1).
//! Benchmark scenes and generated ones stay as they are: exact answers and counts are about their own objects.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{Scene, Subdivision, generators, load_benchmark, load_cells, load_obj, parse, subdivide};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::view::{CameraPath, load_path_file};

/// Frames of a walk that does not say how many.
const FRAMES: usize = 120;

/// Where a scene comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneSource {
    /// A Wavefront OBJ file.
    Obj(PathBuf),
    /// A folder with `scene.bin` and `views.bin`.
    Benchmark(PathBuf),
    /// `NAME[:key=value,...]`.
    Generator(String),
}

/// The views of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Views {
    /// A walk, and how many frames it has by default.
    Path(CameraPath, usize),
    /// Column-major view-projections over world positions, OpenGL clip space.
    Matrices {
        /// One a view.
        matrices: Vec<[f32; 16]>,
        /// Nominal width, in samples.
        width: u32,
        /// Nominal height, in samples.
        height: u32,
    },
}

/// A scene with its views.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// How it is looked at.
    pub views: Views,
}

impl SceneSource {
    /// Decides what an argument is, without reading it: a folder is a benchmark, a name that ends in `.obj` is an OBJ, a
    /// name before a colon that a generator has is that generator.
    ///
    /// # Errors
    /// [`Error::File`] when a folder lacks `scene.bin` or `views.bin`; [`Error::Parameter`] when the argument is none of
    /// the three.
    pub fn resolve(argument: &str) -> Result<SceneSource> {
        let path = Path::new(argument);
        let name = argument.split(':').next().unwrap_or_default();
        // A folder that happens to be called as a generator is not meant.
        let is_generator = generators().iter().any(|g| g.name == name);
        if path.is_dir() && (!is_generator || path.join("scene.bin").is_file()) {
            let lacking = ["scene.bin", "views.bin"].into_iter().find(|file| !path.join(file).is_file());
            return match lacking {
                None => Ok(SceneSource::Benchmark(path.into())),
                Some(file) => Err(Error::file(path, format!("is a folder without {file}"))),
            };
        }
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            return Ok(SceneSource::Obj(path.into()));
        }
        if is_generator {
            return Ok(SceneSource::Generator(argument.into()));
        }
        let names: Vec<&str> = generators().iter().map(|g| g.name).collect();
        let reason = format!(
            "is no .obj file, no folder with scene.bin and views.bin, and no generator; generators are {}",
            names.join(", ")
        );
        Err(Error::parameter("scene", argument, reason))
    }

    /// Loads or generates the scene, and its views: those of `path_override` if given, else its own. An OBJ's own are
    /// `X.path.json` beside `X.obj` if there, else an orbit. Its cells are those of `X.cells.json`, if there.
    ///
    /// # Errors
    /// Those of [`load_obj`], [`load_benchmark`], [`parse`], [`load_path_file`] and [`load_cells`].
    pub fn load(&self, path_override: Option<&Path>) -> Result<Loaded> {
        let given = path_override.map(path_views).transpose()?;
        let Loaded { scene, views } = match self {
            SceneSource::Obj(path) => load_model(path, given.is_none())?,
            SceneSource::Benchmark(folder) => {
                let loaded = load_benchmark(folder)?;
                let (matrices, width, height) = (loaded.views, loaded.width, loaded.height);
                Loaded { scene: loaded.scene, views: Views::Matrices { matrices, width, height } }
            }
            SceneSource::Generator(text) => {
                let generated = parse(text)?;
                Loaded { scene: generated.scene, views: Views::Path(generated.path, generated.frames) }
            }
        };
        Ok(Loaded { scene, views: given.unwrap_or(views) })
    }
}

/// Resolves and loads a SCENE argument; see [`SceneSource::resolve`] and [`SceneSource::load`].
///
/// # Errors
/// Theirs.
pub fn load(argument: &str, path_override: Option<&Path>) -> Result<Loaded> {
    SceneSource::resolve(argument)?.load(path_override)
}

/// The views of a camera path's file.
///
/// # Errors
/// Those of [`load_path_file`].
pub(crate) fn path_views(path: &Path) -> Result<Views> {
    let file = load_path_file(path)?;
    Ok(Views::Path(file.path, file.frames.unwrap_or(FRAMES)))
}

/// An OBJ, subdivided where it must be, with the cells of `X.cells.json` beside `X.obj`; `own_views` is whether a path beside it is wanted.
fn load_model(path: &Path, own_views: bool) -> Result<Loaded> {
    let scene = load_obj(path)?;
    let limits = if scene.objects.len() == 1 { Subdivision::SOUP } else { Subdivision::default() };
    let mut scene = subdivide(scene, &limits);
    let cells = path.with_extension("cells.json");
    if cells.is_file() {
        scene.cells = Some(load_cells(&cells)?);
    }
    let beside = path.with_extension("path.json");
    if own_views && beside.is_file() {
        return Ok(Loaded { scene, views: path_views(&beside)? });
    }
    let boxes = scene.objects.iter().map(|object| scene.object_bounds(object, DVec3::ZERO));
    let bounds = boxes.fold(Aabb::EMPTY, Aabb::union);
    Ok(Loaded { scene, views: Views::Path(CameraPath::orbit(bounds), FRAMES) })
}
