//! The triangles of a prepared scene's objects, where they stand: in f64 about the scene's origin.
//!
//! Corners of a mesh are fetched once and kept: 36 bytes for each triangle that is stored, however often it is placed.

use glam::{DVec3, Vec3};

use super::PreparedScene;
use super::model::rotate;

/// Reads triangles of objects.
pub(crate) struct PlacedTriangles<'s> {
    scene: &'s PreparedScene,
    /// By mesh; empty until loaded.
    corners: Vec<Vec<[Vec3; 3]>>,
}

impl<'s> PlacedTriangles<'s> {
    pub fn new(scene: &'s PreparedScene) -> PlacedTriangles<'s> {
        PlacedTriangles { scene, corners: vec![Vec::new(); scene.meshes.meshes.len()] }
    }

    /// Fetches the mesh of an object; before [`PlacedTriangles::get`].
    pub fn load(&mut self, object: u32) {
        let mesh = self.scene.occluders[object as usize].mesh;
        let corners = &mut self.corners[mesh.0 as usize];
        if corners.is_empty() {
            *corners = self.scene.meshes.corners(mesh);
        }
    }

    /// A triangle by its number in the object, whose mesh is loaded.
    pub fn get(&self, object: u32, triangle: u32) -> [DVec3; 3] {
        let o = &self.scene.occluders[object as usize];
        let shift = o.position - self.scene.origin;
        let corners = self.corners[o.mesh.0 as usize][triangle as usize];
        corners.map(|v| o.rotation.map_or(v, |r| rotate(r, v)).as_dvec3() + shift)
    }
}
