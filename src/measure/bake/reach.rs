//! Where no viewer can be (Zhang 1998, 7.5: "areas in the model where the viewer cannot reach"), found by looking around.
//!
//! A small cube is drawn with everything two-sided. A view point is out of reach when every sample shows one and the same
//! object (*enclosed*: inside a wall, a beam, a pipe, whatever the winding), or when more than half of the samples that show
//! anything show sides that are never drawn (*back sides*: inside a building without a floor, below the ground, in one-sided
//! models). To be wrong costs culling near by and nothing else; a room that is one object with all its furniture would be
//! skipped, and culling has nothing to do in it.

use glam::{DVec3, Mat3, Vec3};

use super::cube::Cube;
use crate::cull::vfc::World;
use crate::error::Result;
use crate::raster::Facing;
use crate::scene::Scene;
use crate::select::Sight;

/// Samples along the side of a face.
pub(super) const SIDE: u32 = 32;

/// Why a view point is out of reach; `None` when it is not. `world` is `scene` with every object two-sided, `cube` is small.
pub(super) fn out_of_reach(scene: &Scene, world: &World<'_>, cube: &mut Cube, eye: DVec3) -> Result<Option<Sight>> {
    let mut look = Look { scene, world, eye, drawn: 0, back: 0, first: None, single: true, last: None };
    cube.draw(world, eye, |cube| look.take(cube))?;
    let all = u64::from(6 * SIDE * SIDE);
    Ok(if look.single && look.drawn == all {
        Some(Sight::Enclosed)
    } else if 2 * look.back > look.drawn {
        Some(Sight::BackSides)
    } else {
        None
    })
}

struct Look<'a> {
    scene: &'a Scene,
    world: &'a World<'a>,
    eye: DVec3,
    /// Samples that show anything, and those that show a side that is never drawn.
    drawn: u64,
    back: u64,
    /// The object seen first, and whether no other was.
    first: Option<u32>,
    single: bool,
    /// The triangle looked at last, and whether its back is seen: neighbours mostly share it.
    last: Option<(u32, bool)>,
}

impl Look<'_> {
    fn take(&mut self, cube: &Cube) {
        let canvas = cube.canvas();
        for y in 0..canvas.height() {
            for x in 0..canvas.width() {
                let Some((_, triangle)) = canvas.item(x, y) else { continue };
                let back = match self.last {
                    Some((last, back)) if last == triangle => back,
                    _ => self.is_back(triangle),
                };
                self.last = Some((triangle, back));
                self.drawn += 1;
                self.back += u64::from(back);
            }
        }
    }

    /// Whether the eye sees the side of a triangle that the scene never draws.
    fn is_back(&mut self, triangle: u32) -> bool {
        let prepared = self.world.scene;
        let id = prepared.object_of(triangle);
        self.single &= *self.first.get_or_insert(id) == id;
        let object = &self.scene.objects[id as usize];
        let mesh = &self.scene.meshes[object.mesh as usize];
        let corners = mesh.triangles()[(triangle - prepared.first_triangle[id as usize]) as usize];
        let at = |i: u32| about(object.rotation, mesh.positions()[i as usize]) + (object.position - self.eye);
        let [a, b, c] = corners.map(at);
        let toward = -(b - a).cross(c - a).dot(a);
        match object.facing {
            Facing::Both => false,
            Facing::Front => toward < 0.0,
            Facing::Back => toward > 0.0,
        }
    }
}

fn about(rotation: Mat3, v: Vec3) -> DVec3 {
    rotation.as_dmat3() * v.as_dvec3()
}
