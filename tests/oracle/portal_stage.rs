//! A scene with portals and two canvases: what portals leave is drawn beside everything in the frustum.

use homcull::cull::portals::{self, PortalMemory, PortalScene};
use homcull::cull::vfc::{self, VfcMemory, World};
use homcull::cull::{CellsFrom, PortalClip, PortalParameters};
use homcull::draw::Canvas;
use homcull::scene::{Cells, PreparedScene};
use homcull::view::{View, Viewport};
use homcull_simd::Level;

/// Both kinds of clipping.
pub const CLIPS: [PortalClip; 2] = [PortalClip::Polygon, PortalClip::Rectangle];

/// A scene with all that its pictures need.
pub struct Stage<'s> {
    pub world: World<'s>,
    pub portals: PortalScene,
    pub memory: PortalMemory,
    canvases: [Canvas; 2],
    pub viewport: Viewport,
}

/// Objects drawn, objects in the frustum.
pub type Counts = [usize; 2];

impl<'s> Stage<'s> {
    pub fn new(scene: &'s PreparedScene, from: CellsFrom) -> Stage<'s> {
        let viewport = Viewport::new(192, 144).unwrap();
        Stage {
            world: World::new(scene),
            portals: PortalScene::new(scene, from).unwrap(),
            memory: PortalMemory::default(),
            canvases: [0, 1].map(|_| Canvas::new(viewport, Level::best()).unwrap()),
            viewport,
        }
    }

    /// Draws what portals leave and everything in the frustum, and demands the same picture.
    #[track_caller]
    pub fn keeps_the_picture(&mut self, what: &str, view: &View) -> Counts {
        let scene = self.world.scene;
        let all = vfc::cull(&self.world, Level::best(), view, &mut VfcMemory::default());
        let mut drawn = all.objects.len();
        let draw = |canvas: &mut Canvas, objects: &[u32]| {
            canvas.draw(view, scene, objects, 1, |jobs| jobs.iter_mut().for_each(|j| j.run())).unwrap();
        };
        let [ours, theirs] = &mut self.canvases;
        draw(theirs, &all.objects);
        for clip in CLIPS.into_iter().rev() {
            let parameters = PortalParameters { clip, ..PortalParameters::default() };
            let set = portals::cull(&self.world, Level::best(), view, &self.portals, &parameters, &mut self.memory);
            assert!(set.objects.iter().all(|o| all.objects.contains(o)), "{what}: outside the frustum");
            draw(ours, &set.objects);
            let differing = ours.differing_samples(theirs, scene);
            assert_eq!(differing, 0, "{what}, {clip:?}: samples differ from {:?}", view.eye());
            drawn = set.objects.len();
        }
        [drawn, all.objects.len()]
    }

    pub fn cells(&self) -> &Cells {
        self.portals.cells()
    }
}
