//! From arguments to what runs: SIMD level, threads, scene, views.

use homcull_simd::Level;

use super::arguments::{Options, Size};
use crate::error::{Error, Result};
use crate::scene::{self, Generated, Scene, Views};
use crate::view::{ClipSpace, View, Viewport};
use crate::workers::Workers;

/// The level asked for, which the CPU must have, or its best.
pub fn level(options: &Options) -> Result<Level> {
    let Some(name) = options.simd.map(|s| s.name()) else { return Ok(Level::best()) };
    let level = Level::from_name(name).filter(|l| l.is_available());
    level.ok_or_else(|| Error::SimdLevel(name.to_owned()))
}

/// The threads asked for, or as many as the machine has processors for us, for `walk`; `default` otherwise.
pub fn workers(options: &Options, default: usize) -> Result<Workers> {
    Workers::new(options.threads.map_or(default, |n| n as usize))
}

/// Processors that this process may use.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A scene and its views at a size.
pub struct Setting {
    pub scene: Scene,
    pub views: Vec<View>,
    pub viewport: Viewport,
}

/// Loads a scene with its views. `nominal`: at the views' own size unless one is asked for.
pub fn load(argument: &str, options: &Options, nominal: bool) -> Result<Setting> {
    let loaded = scene::load(argument, options.path.as_deref())?;
    let mut scene = loaded.scene;
    scene.name = argument.to_owned();
    let (width, height) = match (options.size, &loaded.views) {
        (Some(size), _) => (size.width(), size.height()),
        (None, Views::Matrices { width, height, .. }) => (*width, *height),
        (None, Views::Path(..)) if nominal => (1920, 1080),
        (None, Views::Path(..)) => (1280, 1024),
    };
    let viewport = Viewport::new(width, height)?;
    let views = views(&loaded.views, options.frames.map(|n| n as usize), viewport)?;
    Ok(Setting { scene, views, viewport })
}

/// A generated scene with its own walk, or the one asked for.
pub fn of_generated(name: &str, generated: Generated, options: &Options) -> Result<Setting> {
    let size = options.size.unwrap_or(Size::DEFAULT);
    let viewport = Viewport::new(size.width(), size.height())?;
    let own = Views::Path(generated.path, generated.frames);
    let given = options.path.as_deref().map(scene::path_views).transpose()?;
    let views = views(&given.unwrap_or(own), options.frames.map(|n| n as usize), viewport)?;
    let mut scene = generated.scene;
    scene.name = name.to_owned();
    Ok(Setting { scene, views, viewport })
}

/// The views of a path or a list of matrices: of these, every k-th if fewer are asked for.
fn views(views: &Views, frames: Option<usize>, viewport: Viewport) -> Result<Vec<View>> {
    match views {
        Views::Path(path, own) => {
            let cameras = path.sample(frames.unwrap_or(*own))?;
            cameras.iter().map(|camera| camera.view(viewport)).collect()
        }
        Views::Matrices { matrices, .. } => {
            let step = frames.map_or(1, |n| matrices.len().div_ceil(n.max(1)).max(1));
            let chosen = matrices.iter().step_by(step);
            chosen.map(|m| View::new(glam::Mat4::from_cols_array(m).as_dmat4(), ClipSpace::OPENGL, viewport)).collect()
        }
    }
}
