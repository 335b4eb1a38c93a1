//! Scenes and their objects.

use glam::{DVec3, Mat3};

use super::{Cells, Mesh};
use crate::geometry::Aabb;
use crate::hash::Hash;
use crate::raster::Facing;

/// An instance of a mesh: the unit of culling.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Unique within the scene where the source's names are; parts of a subdivided object are `name#k`.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// World = rotation * vertex + position. May scale and mirror.
    pub rotation: Mat3,
    /// World position, in metres.
    pub position: DVec3,
    /// Which side is drawn.
    pub facing: Facing,
    /// Base colour, sRGB.
    pub color: [u8; 3],
    /// What its material lets through is 1 less this: 1 is opaque. Anything less (glass, leaf cards, what is not a number) is
    /// drawn but never taken as an opaque occluder; 0 also where the material does not say how much comes through.
    pub opacity: f32,
}

impl Object {
    /// True when nothing comes through.
    pub fn is_opaque(&self) -> bool {
        self.opacity >= 1.0
    }
}

/// Objects, and the meshes they are instances of.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// What the user called it.
    pub name: String,
    /// Shared by objects.
    pub meshes: Vec<Mesh>,
    /// In order of id.
    pub objects: Vec<Object>,
    /// Its cells and portals, if it brings them.
    pub cells: Option<Cells>,
}

impl Scene {
    /// Triangles of all objects.
    pub fn triangles(&self) -> u64 {
        self.objects.iter().map(|o| self.meshes[o.mesh as usize].triangles().len() as u64).sum()
    }

    /// A hash of everything that can be seen or can hide: meshes, placements, facing, opacity; not of names and colours. Equal for
    /// equal scenes on every machine. One pass over the geometry.
    pub fn hash(&self) -> u64 {
        let mut hash = Hash::default();
        let pair = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        for mesh in &self.meshes {
            hash.add((mesh.positions().len() as u64) << 32 | mesh.triangles().len() as u64);
            for p in mesh.positions() {
                hash.add(pair(p.x, p.y));
                hash.add(pair(p.z, 0.0));
            }
            for [a, b, c] in mesh.triangles() {
                hash.add(u64::from(*a) << 32 | u64::from(*b));
                hash.add(u64::from(*c));
            }
        }
        for object in &self.objects {
            let facing = object.facing as u64;
            hash.add(u64::from(object.mesh) << 32 | facing << 1 | u64::from(object.is_opaque()));
            if !object.is_opaque() {
                hash.add(object.opacity.to_bits().into());
            }
            object.position.to_array().iter().for_each(|v| hash.add(v.to_bits()));
            object.rotation.to_cols_array().iter().for_each(|v| hash.add(v.to_bits().into()));
        }
        hash.value()
    }

    /// The object's box about `origin`, rounded outwards to f32; empty when its mesh draws nothing.
    pub fn object_bounds(&self, object: &Object, origin: DVec3) -> Aabb {
        let mesh = &self.meshes[object.mesh as usize];
        if mesh.bounds().is_empty() {
            return Aabb::EMPTY;
        }
        let local = if object.rotation == Mat3::IDENTITY {
            mesh.bounds()
        } else {
            Aabb::around(
                mesh.triangles().iter().flatten().map(|&i| rotate(object.rotation, mesh.positions()[i as usize])),
            )
        };
        let shift = object.position - origin;
        if shift == DVec3::ZERO {
            return local;
        }
        Aabb { min: (local.min.as_dvec3() + shift).as_vec3(), max: (local.max.as_dvec3() + shift).as_vec3() }.outwards()
    }
}

/// `v' = f32(R v)`: one operation order, the rasterizer's own (SEMANTICS, *Samples, facing, transform*).
pub(crate) fn rotate(r: Mat3, v: glam::Vec3) -> glam::Vec3 {
    let row = |x: f32, y: f32, z: f32| (x * v.x + y * v.y) + z * v.z;
    glam::Vec3::new(
        row(r.x_axis.x, r.y_axis.x, r.z_axis.x),
        row(r.x_axis.y, r.y_axis.y, r.z_axis.y),
        row(r.x_axis.z, r.y_axis.z, r.z_axis.z),
    )
}

/// A calm colour for the `id`-th of many things that bring none: hues a golden ratio apart, so neighbours differ.
pub(crate) fn palette(id: u64) -> [u8; 3] {
    let bits = super::random::mix(id);
    let hue = (id.wrapping_mul(0x9e37_79b9) >> 8 & 0xff_ffff) as f64 / f64::from(1 << 24) * 6.0;
    let value = 150.0 + (bits & 63) as f64;
    let saturation = 0.25 + ((bits >> 8) & 63) as f64 / 256.0;
    let channel = |shift: f64| {
        let k = (shift + hue) % 6.0;
        let dip = k.min(4.0 - k).clamp(0.0, 1.0);
        (value * (1.0 - saturation * dip)) as u8
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}
