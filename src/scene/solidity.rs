//! Solidity: how much of its box an object covers, for prioritized-layered projection (Klosowski and Silva 2000 estimate it by the number
//! of primitives in a node; here it is measured).
//!
//! Kept an object as the area that it shows along each axis. Of a box that is all there is to say: looked at along v, it
//! shows `sum |v_i| area_i`. Of other closed convex things it is exact along the axes; what overlaps itself counts more than once,
//! so users cap it by the box. Cost: one pass over the triangles of each mesh and rotation that there is.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::{PlacedTriangles, PreparedScene};

/// The area that each object shows along the x, y and z axis, in square units, by id.
///
/// Half of the sum over its triangles, as a closed thing has two sides, and half of the sum with signs, which is nothing for closed
/// things, and for a sheet the other half.
pub fn shown_areas(scene: &PreparedScene) -> Vec<Vec3> {
    let mut triangles = PlacedTriangles::new(scene);
    let mut known: HashMap<(u32, Option<[u32; 9]>), Vec3> = HashMap::new();
    let mut areas = |object: u32| {
        let occluder = &scene.occluders[object as usize];
        let rotation = occluder.rotation.map(|r| r.to_cols_array().map(f32::to_bits));
        *known.entry((occluder.mesh.0, rotation)).or_insert_with(|| {
            triangles.load(object);
            let (mut both, mut signed) = (DVec3::ZERO, DVec3::ZERO);
            for t in 0..scene.triangles(object) {
                let [a, b, c] = triangles.get(object, t);
                let twice = (b - a).cross(c - a);
                (both, signed) = (both + twice.abs(), signed + twice);
            }
            ((both + signed.abs()) * 0.25).as_vec3()
        })
    };
    (0..scene.occluders.len() as u32).map(&mut areas).collect()
}
