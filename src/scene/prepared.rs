//! A scene made ready for frames: meshes in clusters, objects as occluders, boxes, triangle numbers and their colours.

use glam::{DVec3, Mat3, Vec3};

use super::model::rotate;
use super::{Cells, Object, Scene};
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::occlusion::{BoxSet, Occluder, optical_depth, relative_luminance};
use crate::raster::{MeshId, PreparedMeshes};

/// Everything that does not change from frame to frame.
#[derive(Debug, Clone, Default)]
pub struct PreparedScene {
    /// [`Scene::hash`] of what was prepared.
    pub hash: u64,
    /// Meshes of the scene, in its order.
    pub meshes: PreparedMeshes,
    /// One an object, in order of id.
    pub occluders: Vec<Occluder>,
    /// Boxes about `origin`, by id; empty for an object without triangles.
    pub bounds: Vec<Aabb>,
    /// The same boxes, ready to be projected.
    pub boxes: BoxSet,
    /// The scene's own origin in the world.
    pub origin: DVec3,
    /// Number of each object's first triangle; one more at the end, the number of all.
    pub first_triangle: Vec<u32>,
    /// Flat-shaded colour of each triangle, 0x00BBGGRR.
    pub colors: Vec<i32>,
    /// The scene's cells and portals, if it brings them.
    pub cells: Option<Cells>,
    /// Those found in it, once somebody asked.
    #[cfg(feature = "bvh")]
    found: std::sync::OnceLock<super::FoundCells>,
}

impl PreparedScene {
    /// Prepares a scene.
    ///
    /// # Errors
    /// [`Error::Mesh`] when a mesh cannot be prepared, or when there are more than 2^31 - 1 triangles or 2^30 objects.
    pub fn new(scene: &Scene) -> Result<PreparedScene> {
        let most = |what: &str| Error::Mesh {
            object: scene.name.clone(),
            reason: format!("more {what} than can be numbered"),
        };
        if scene.triangles() > i32::MAX as u64 {
            return Err(most("triangles"));
        }
        if scene.objects.len() >= 1 << 30 {
            return Err(most("objects"));
        }
        let mut out = PreparedScene { hash: scene.hash(), origin: origin_of(scene), ..PreparedScene::default() };
        out.cells = scene.cells.clone();
        for mesh in &scene.meshes {
            out.meshes.add(mesh.positions(), mesh.triangles())?;
        }
        for object in &scene.objects {
            out.first_triangle.push(out.colors.len() as u32);
            let rotation = (object.rotation != Mat3::IDENTITY).then_some(object.rotation);
            out.occluders.push(Occluder {
                mesh: MeshId::from_index(object.mesh),
                position: object.position,
                rotation,
                facing: object.facing,
                opaque: object.is_opaque(),
                optical_depth: if object.is_opaque() { 0 } else { optical_depth(object.opacity.into()) },
                luminance: relative_luminance(object.color),
            });
            out.bounds.push(scene.object_bounds(object, out.origin));
            shade(scene, object, &mut out.colors);
        }
        out.first_triangle.push(out.colors.len() as u32);
        out.boxes = BoxSet::new(&out.bounds);
        Ok(out)
    }

    /// The cells found in the scene ([`find_cells`](super::find_cells)), whatever cells it brings: found once, on demand.
    #[cfg(feature = "bvh")]
    pub fn found_cells(&self) -> &super::FoundCells {
        self.found.get_or_init(|| super::find_cells(self))
    }

    /// Triangles of an object.
    pub fn triangles(&self, object: u32) -> u32 {
        self.first_triangle[object as usize + 1] - self.first_triangle[object as usize]
    }

    /// The object that a triangle number belongs to.
    pub fn object_of(&self, triangle: u32) -> u32 {
        self.first_triangle.partition_point(|&first| first <= triangle) as u32 - 1
    }
}

/// The world's own origin unless objects are placed: then the middle of their positions.
fn origin_of(scene: &Scene) -> DVec3 {
    let low = scene.objects.iter().fold(DVec3::INFINITY, |a, o| a.min(o.position));
    let high = scene.objects.iter().fold(DVec3::NEG_INFINITY, |a, o| a.max(o.position));
    let middle = low * 0.5 + high * 0.5;
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

/// One light, flat normals, and the same brightness on both sides, so that it does not depend on the view.
fn shade(scene: &Scene, object: &Object, colors: &mut Vec<i32>) {
    let light = Vec3::new(0.36, 0.80, 0.48);
    let mesh = &scene.meshes[object.mesh as usize];
    let at = |i: u32| {
        let v = mesh.positions()[i as usize];
        if object.rotation == Mat3::IDENTITY { v } else { rotate(object.rotation, v) }
    };
    for &[a, b, c] in mesh.triangles() {
        let (a, b, c) = (at(a), at(b), at(c));
        let n = cross(b - a, c - a);
        let length = dot(n, n).sqrt();
        let toward = if length > 0.0 { dot(n, light).abs() / length } else { 0.0 };
        // 0 to 256 in whole steps: integer rounding from here on.
        let brightness = ((0.30 + 0.70 * toward.min(1.0)) * 256.0) as i32;
        let channel = |v: u8| (i32::from(v) * brightness + 128) >> 8;
        let [r, g, b] = object.color.map(channel);
        colors.push(r.min(255) | g.min(255) << 8 | b.min(255) << 16);
    }
}

fn dot(a: Vec3, b: Vec3) -> f32 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
