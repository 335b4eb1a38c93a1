//! The item-buffer cube around a view point (Zhang 1998, 7.5): six pictures of 90 degrees, which show all that can be seen.
//!
//! Each face is culled by progressive hierarchical occlusion maps first and then drawn exactly; image identity makes the items
//! those of drawing everything. The bits do not depend on the SIMD level.

use glam::{DMat4, DVec3, DVec4};
use homcull_simd::Level;

use crate::cull::hom::{self, HomFrame};
use crate::cull::vfc::World;
use crate::cull::{HomParameters, Update};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::view::{ClipSpace, View, Viewport};
use crate::workers::Workers;

/// Pictures of one size, for one thread.
pub(super) struct Cube {
    level: Level,
    /// One thread: cubes are drawn side by side.
    workers: Workers,
    parameters: HomParameters,
    viewport: Viewport,
    near: f64,
    /// Between pictures it is always there.
    frame: Option<HomFrame>,
    canvas: Canvas,
    /// Samples of each object, in one face and in all; only those of `seen` are ever above 0.
    face_samples: Vec<u32>,
    samples: Vec<u32>,
    seen: Vec<u32>,
}

impl Cube {
    /// Faces of `side` by `side` samples, for scenes of so many objects.
    pub fn new(side: u32, near: f64, objects: usize, level: Level) -> Result<Cube> {
        let viewport = Viewport::new(side, side)?;
        Ok(Cube {
            level,
            workers: Workers::new(1)?,
            // Every picture is of another view: nothing may rest.
            parameters: HomParameters { rest: 0, ..HomParameters::new(Update::Always) },
            viewport,
            near,
            frame: None,
            canvas: Canvas::new(viewport, level)?,
            face_samples: vec![0; objects],
            samples: vec![0; objects],
            seen: Vec::new(),
        })
    }

    /// Draws the six faces, and shows each to `look`.
    pub fn draw(&mut self, world: &World<'_>, eye: DVec3, mut look: impl FnMut(&mut Cube)) -> Result<()> {
        for view in faces(eye, self.near, self.viewport)? {
            let frame = match self.frame.take() {
                Some(frame) => frame,
                None => HomFrame::new(&view, self.level, &self.parameters)?,
            };
            let frame = hom::select_occluders(world, self.level, &view, &self.parameters, frame)?;
            let (set, frame) = hom::cull(world, &self.workers, &self.parameters, hom::build_pyramid(frame))?;
            self.frame = Some(frame);
            self.canvas.draw(&view, world.scene, &set.objects, 1, |jobs| jobs.iter_mut().for_each(DrawJob::run))?;
            look(self);
        }
        Ok(())
    }

    /// The face just drawn.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// The objects that the six faces show, with the samples that show them: most samples first, ties by id.
    pub fn sight(&mut self, world: &World<'_>, eye: DVec3) -> Result<Vec<(u32, u32)>> {
        self.draw(world, eye, |cube| {
            cube.canvas.count_items(world.scene, &mut cube.face_samples);
            for (object, &samples) in (0..).zip(&cube.face_samples) {
                if samples > 0 {
                    let all = &mut cube.samples[object as usize];
                    if *all == 0 {
                        cube.seen.push(object);
                    }
                    *all += samples;
                }
            }
        })?;
        let samples = &mut self.samples;
        let mut sight: Vec<(u32, u32)> =
            self.seen.drain(..).map(|object| (object, std::mem::take(&mut samples[object as usize]))).collect();
        sight.sort_unstable_by_key(|&(object, samples)| (std::cmp::Reverse(samples), object));
        Ok(sight)
    }
}

/// Views along the axes, to both sides: 90 degrees wide and high, without a far plane.
fn faces(eye: DVec3, near: f64, viewport: Viewport) -> Result<[View; 6]> {
    let face = |ahead: DVec3, up: DVec3| {
        let right = ahead.cross(up);
        // A focal length of 1, depth near / w, and w the distance along the axis.
        let rows = [right.extend(0.0), up.extend(0.0), DVec4::new(0.0, 0.0, 0.0, near), ahead.extend(0.0)];
        let matrix = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
        View::from_eye(eye, matrix, ClipSpace::REVERSED, viewport)
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    Ok([face(x, y)?, face(-x, y)?, face(y, z)?, face(-y, z)?, face(z, y)?, face(-z, y)?])
}
