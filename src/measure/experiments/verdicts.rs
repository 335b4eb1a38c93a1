//! Verdicts on everything in the frustum, given any set of occluders: for claims about which occluders are chosen, where no
//! method of selection stands between.

use super::{Bench, Place};
use crate::cull::vfc::{VfcMemory, World};
use crate::draw::{Canvas, DrawJob};
use crate::error::Result;
use crate::occlusion::{DepthReading, DepthRepresentation, OcclusionBuffer, OcclusionSettings, Partitions, Verdict};
use crate::view::View;

/// The depth representations, by name: all that chapter 6 has, and both readings of the no-background Z-buffer.
pub(super) fn representations() -> [(&'static str, DepthRepresentation); 4] {
    [
        ("nbz", DepthRepresentation::NoBackground(DepthReading::PerSample)),
        ("nbz-block", DepthRepresentation::NoBackground(DepthReading::PerBlock)),
        ("deb", DepthRepresentation::Estimation(Partitions::default())),
        ("plane", DepthRepresentation::Plane),
    ]
}

/// A place with what judging takes.
pub(super) struct Judge<'a> {
    bench: &'a Bench<'a>,
    pub world: World<'a>,
    canvas: Canvas,
    memory: VfcMemory,
    /// Samples of the picture that show each object.
    pub samples: Vec<u32>,
}

/// What is said of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judged {
    pub object: u32,
    pub verdict: Verdict,
    /// Whether it passes the depth test alone.
    pub behind: bool,
}

impl<'a> Judge<'a> {
    /// # Errors
    /// Those of [`Canvas::new`].
    pub fn new(bench: &'a Bench<'a>, place: &'a Place) -> Result<Judge<'a>> {
        Ok(Judge {
            bench,
            world: World::new(&place.prepared),
            canvas: Canvas::new(place.views[0].viewport(), bench.level)?,
            memory: VfcMemory::default(),
            samples: vec![0; place.prepared.occluders.len()],
        })
    }

    /// A buffer for the place's views.
    ///
    /// # Errors
    /// Those of [`OcclusionBuffer::with_level`].
    pub fn buffer(&self, view: &View, settings: OcclusionSettings) -> Result<OcclusionBuffer> {
        OcclusionBuffer::with_level(view.viewport(), self.bench.level, settings)
    }

    /// Looks at a view: what is in the frustum, nearest first, and how many samples show it.
    ///
    /// # Errors
    /// Those of [`Canvas::draw`].
    pub fn look(&mut self, view: &View) -> Result<Vec<u32>> {
        let Judge { bench, world, canvas, memory, samples } = self;
        world.collect(bench.level, view, true, &mut memory.stack, &mut memory.boxes);
        let objects: Vec<u32> = memory.boxes.boxes().iter().map(|b| b.id()).collect();
        let workers = bench.workers;
        canvas.draw(view, world.scene, &objects, workers.bands(), |jobs| workers.run(jobs, DrawJob::run))?;
        canvas.count_items(world.scene, samples);
        Ok(objects)
    }

    /// Draws occluders into the buffer and judges what [`Judge::look`] found in the same view, nearest first.
    ///
    /// # Errors
    /// Those of [`OcclusionBuffer::submit`].
    pub fn judge(&self, buffer: &mut OcclusionBuffer, view: &View, occluders: &[u32]) -> Result<Vec<Judged>> {
        let scene = self.world.scene;
        let occluders: Vec<_> = occluders.iter().map(|&id| scene.occluders[id as usize]).collect();
        buffer.begin(view)?;
        buffer.submit(&scene.meshes, &occluders)?;
        let boxes = self.memory.boxes.boxes().iter();
        boxes
            .map(|b| {
                let verdict = buffer.test_one_projected(b, &scene.bounds, scene.origin)?;
                Ok(Judged { object: b.id(), verdict, behind: buffer.passes_depth_test(b)? })
            })
            .collect()
    }

    /// Triangles of an object.
    pub fn triangles(&self, object: u32) -> u64 {
        u64::from(self.world.scene.triangles(object))
    }
}
