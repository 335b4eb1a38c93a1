//! Pictures of a walk: frames, what was culled seen from above (Zhang 1998, figure 1.1), and the pyramid's levels side by
//! side (figure 8.4).

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, DVec4};
use homcull_simd::Level;

use super::setting::Setting;
use crate::cull::Method;
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::geometry::Aabb;
use crate::measure::picture::{GreyImage, Rgb, RgbImage, side_by_side};
use crate::measure::walk::FrameLook;
use crate::occlusion::Pyramid;
use crate::scene::PreparedScene;
use crate::view::{ClipSpace, View, Viewport};

/// Width and height of the view from above.
const OVERVIEW: u32 = 1024;

/// Takes pictures of some frames of a walk.
pub struct Pictures<'a> {
    out: PathBuf,
    scene: &'a PreparedScene,
    methods: &'a [Method],
    frames: Vec<usize>,
    overview: Canvas,
    overview_view: View,
    extent: Aabb,
}

impl<'a> Pictures<'a> {
    pub fn new(
        out: &Path,
        setting: &Setting,
        scene: &'a PreparedScene,
        methods: &'a [Method],
        level: Level,
        images: usize,
    ) -> Result<Pictures<'a>> {
        let n = setting.views.len();
        let images = images.min(n);
        let frames = (0..images).map(|i| (2 * i + 1) * n / (2 * images)).collect();
        let viewport = Viewport::new(OVERVIEW, OVERVIEW)?;
        let extent = bulk_of(scene);
        let overview_view = from_above(extent, scene.origin, viewport)?;
        let overview = Canvas::new(viewport, level)?;
        Ok(Pictures { out: out.to_owned(), scene, methods, frames, overview, overview_view, extent })
    }

    /// Takes the pictures of one frame and method.
    pub fn take(&mut self, look: FrameLook<'_>) -> Result<()> {
        if !self.frames.contains(&look.frame) {
            return Ok(());
        }
        let name = self.name(look.method);
        let file = |what: &str| self.out.join(format!("{what}-{:04}-{name}.png", look.frame));
        if look.method == 0 {
            let path = self.out.join(format!("frame-{:04}.png", look.frame));
            canvas_picture(look.canvas)?.write_png(&path)?;
        }
        let Some(hom) = look.hom else { return Ok(()) };
        let (culled, pyramid) = (file("culled"), file("pyramid"));
        pyramid_picture(hom.buffer.pyramid())?.write_png(&pyramid)?;
        self.seen_from_above(look.drawn, look.in_frustum, look.view)?.write_png(&culled)
    }

    /// What a method's files are called: numbered where there are several of a name.
    fn name(&self, method: usize) -> String {
        let name = self.methods[method].name();
        match self.methods.iter().filter(|m| m.name() == name).count() {
            1 => name,
            _ => format!("{}-{name}", method + 1),
        }
    }

    /// The scene from above: drawn objects in their colours, culled ones in red, those outside the frustum faint.
    fn seen_from_above(&mut self, drawn: &[u32], in_frustum: &[u32], view: &View) -> Result<RgbImage> {
        let objects: Vec<u32> = (0..self.scene.occluders.len() as u32).collect();
        let canvas = &mut self.overview;
        canvas.draw(&self.overview_view, self.scene, &objects, 1, |jobs| jobs.iter_mut().for_each(DrawJob::run))?;
        let mut image = canvas_picture(canvas)?;
        let mut state = vec![0u8; objects.len()];
        in_frustum.iter().for_each(|&o| state[o as usize] = 1);
        drawn.iter().for_each(|&o| state[o as usize] = 2);
        for y in 0..OVERVIEW {
            for x in 0..OVERVIEW {
                let object = canvas.item(x as usize, y as usize).map(|(_, t)| self.scene.object_of(t));
                match object.map(|o| state[o as usize]) {
                    Some(0) => image.tint(x, y, Rgb([255, 255, 255]), 190),
                    Some(1) => image.tint(x, y, Rgb::CULLED, 200),
                    _ => {}
                }
            }
        }
        self.mark_eye(&mut image, view);
        Ok(image)
    }

    /// A square where the viewer stands, and a line along its view.
    fn mark_eye(&self, image: &mut RgbImage, view: &View) {
        let place = |p: DVec3| {
            let c = (p - self.scene.origin).as_vec3();
            let side = side_of(self.extent);
            let center = self.extent.center();
            let to = |v: f32, middle: f32| ((v - middle) / side + 0.5) * OVERVIEW as f32;
            (to(c.x, center.x), to(c.z, center.z))
        };
        let ahead = view.rows()[2].truncate().normalize_or_zero() * f64::from(side_of(self.extent)) * 0.12;
        let ((x, y), (ax, ay)) = (place(view.eye()), place(view.eye() + ahead));
        let mut dot = |cx: f32, cy: f32, half: i32, colour: Rgb| {
            for dy in -half..=half {
                for dx in -half..=half {
                    let (px, py) = (cx as i32 + dx, cy as i32 + dy);
                    if let (Ok(px), Ok(py)) = (u32::try_from(px), u32::try_from(py)) {
                        image.set(px, py, colour);
                    }
                }
            }
        };
        for step in 0..=100 {
            let t = step as f32 / 100.0;
            dot(x + (ax - x) * t, y + (ay - y) * t, 1, Rgb([20, 20, 20]));
        }
        dot(x, y, 6, Rgb([20, 20, 20]));
        dot(x, y, 4, Rgb([255, 214, 0]));
    }
}

/// The box around all objects but the outermost few: one far-away thing must not shrink the rest to a dot.
fn bulk_of(scene: &PreparedScene) -> Aabb {
    let mut centers: Vec<_> = scene.bounds.iter().filter(|b| b.is_finite()).map(|b| b.center()).collect();
    let mut keep = |axis: usize| {
        centers.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
        let cut = centers.len() / 200;
        match (centers.get(cut), centers.get(centers.len().saturating_sub(cut + 1))) {
            (Some(a), Some(b)) => (a[axis], b[axis]),
            _ => (-1.0, 1.0),
        }
    };
    let ((x0, x1), (y0, y1), (z0, z1)) = (keep(0), keep(1), keep(2));
    Aabb { min: glam::Vec3::new(x0, y0, z0), max: glam::Vec3::new(x1, y1, z1) }
}

/// Side of the square seen from above, in scene units.
fn side_of(extent: Aabb) -> f32 {
    let size = extent.size();
    (size.x.max(size.z) * 1.06).max(1e-3)
}

/// An orthographic view down the y axis, x to the right, z towards the viewer's feet.
fn from_above(extent: Aabb, origin: DVec3, viewport: Viewport) -> Result<View> {
    let (side, center) = (f64::from(side_of(extent)), extent.center().as_dvec3() + origin);
    let reach = f64::from(extent.size().length()).max(1.0) * 10.0;
    let scale = 2.0 / side;
    let rows = [
        DVec4::new(scale, 0.0, 0.0, -center.x * scale),
        DVec4::new(0.0, 0.0, -scale, center.z * scale),
        DVec4::new(0.0, 0.5 / reach, 0.0, 0.5 - center.y * 0.5 / reach),
        DVec4::W,
    ];
    View::new(DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose(), ClipSpace::REVERSED, viewport)
}

/// The canvas as a picture.
pub fn canvas_picture(canvas: &Canvas) -> Result<RgbImage> {
    let bytes = canvas.image().iter().flat_map(|&c| [c as u8, (c >> 8) as u8, (c >> 16) as u8]).collect();
    RgbImage::from_pixels(canvas.width() as u32, canvas.height() as u32, bytes)
}

/// Opacities of all levels of at least four pixels a side, side by side: white is covered.
fn pyramid_picture(pyramid: &Pyramid) -> Result<RgbImage> {
    let mut levels = Vec::new();
    for level in 0..pyramid.levels() {
        let (width, height) = pyramid.size(level);
        if level > 0 && width.min(height) < 4 {
            break;
        }
        let opacities: Vec<f32> =
            (0..width * height).map(|i| pyramid.opacity(level, i % width, i / width) as f32).collect();
        levels.push(GreyImage::from_opacity(width as u32, height as u32, &opacities)?);
    }
    side_by_side(&levels)
}
