//! What is drawn in place of an object when it occludes (Zhang 1998, 7.2): its conservative simplification, or a level of
//! detail.
//!
//! Made once a scene, mesh by mesh; which form an occluder has is decided view by view, from its box. A *simplified* occluder
//! covers nothing that the object does not, seen from outside the object's box: it stands in only where that box lies beyond the
//! near plane. A *level of detail* is the coarsest whose estimated deviation projects to at most so many pixels; it may cover more
//! than the object: what such an occluder hides is an error, to be measured. What has no form with fewer triangles is drawn as it
//! is. A form is two pieces at most: what is drawn from both sides, and what is drawn as the object is. Cost: that of
//! [`scene::lod`](crate::scene::lod), once; a view's choice is a few products an occluder.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::occlusion::Occluder;
use crate::raster::{Facing, MeshId, PreparedMeshes};
use crate::scene::PreparedScene;
use crate::view::{View, lies_beyond_near, pixels_a_unit};
use glam::DVec3;

/// Share of the closed parts' triangles that simplified occluders have together, unless told otherwise.
pub const DEFAULT_SHARE: f64 = 0.1;
/// The LOD scale of occluders, in pixels: four times the draw's, which is one pixel (7.2).
pub const DEFAULT_OCCLUDER_LOD: f64 = 4.0;

/// What is drawn for an occluder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OccluderGeometry {
    /// The object's own triangles.
    Original,
    /// Triangles inside it, so many of its closed parts' triangles over the whole scene, 0 to 1: conservative.
    Simplified(f64),
    /// A level of detail that deviates by at most so many pixels, as its simplifier estimates: approximate.
    Detail(f64),
}

impl OccluderGeometry {
    /// True when nothing is covered that the object does not cover.
    pub fn is_conservative(self) -> bool {
        !matches!(self, OccluderGeometry::Detail(_))
    }
}

/// The forms of a scene's objects.
#[derive(Debug, Clone, Default)]
pub struct StandIns {
    meshes: PreparedMeshes,
    /// By object: its forms, from fine to coarse; none for what is always drawn as it is.
    of: Vec<Forms>,
    forms: Vec<Form>,
    /// `None` where all forms are conservative.
    lod_scale: Option<f64>,
}

/// An object's forms, and how many of its units a unit of its mesh is long.
#[derive(Debug, Clone, Default)]
struct Forms {
    range: Range<usize>,
    scale: f64,
}

/// A form of a mesh.
#[cfg_attr(not(feature = "lod"), allow(dead_code))]
#[derive(Debug, Clone, Copy)]
pub(crate) struct Form {
    pub triangles: u32,
    /// Estimated deviation, in units of the mesh.
    error: f64,
    /// Drawn from both sides.
    inside: Option<MeshId>,
    /// Drawn as the object is.
    surface: Option<MeshId>,
}

impl StandIns {
    /// The forms that `geometry` asks for; `None` for the original.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share out of 0 to 1, a LOD scale that is negative or no number, and without the feature `lod`;
    /// [`Error::Mesh`] when a mesh can't be simplified.
    pub fn new(scene: &PreparedScene, geometry: OccluderGeometry) -> Result<Option<StandIns>> {
        let bad = |name: &str, value: f64, reason: &str| Err(Error::parameter(name, value, reason));
        match geometry {
            OccluderGeometry::Original => Ok(None),
            OccluderGeometry::Simplified(share) if !(0.0..=1.0).contains(&share) => bad("share", share, "0 to 1"),
            OccluderGeometry::Detail(px) if !(0.0..f64::INFINITY).contains(&px) => bad("lod", px, "pixels, 0 or more"),
            OccluderGeometry::Simplified(share) => make::simplified(scene, share).map(Some),
            OccluderGeometry::Detail(px) => make::detail(scene, px).map(Some),
        }
    }

    /// Where the forms' meshes are.
    pub fn meshes(&self) -> &PreparedMeshes {
        &self.meshes
    }

    /// The form in which an object with this box occludes in a view; `None` for itself.
    pub(crate) fn form(&self, view: &View, id: u32, bounds: Aabb, origin: DVec3) -> Option<Form> {
        let Forms { range, scale } = self.of.get(id as usize).filter(|forms| !forms.range.is_empty())?;
        let forms = &self.forms[range.clone()];
        match self.lod_scale {
            None => forms.last().filter(|_| lies_beyond_near(view, bounds, origin)).copied(),
            Some(most) => {
                let pixels = pixels_a_unit(view, bounds, origin) * scale;
                forms.iter().rev().find(|form| form.error * pixels <= most).copied()
            }
        }
    }
}

impl Form {
    /// What is drawn for an object in this form, from [`StandIns::meshes`].
    pub fn occluders(self, object: &Occluder) -> impl Iterator<Item = Occluder> + use<> {
        let object = *object;
        let inside = self.inside.map(|mesh| Occluder { mesh, facing: Facing::Both, ..object });
        inside.into_iter().chain(self.surface.map(|mesh| Occluder { mesh, ..object }))
    }
}

#[cfg(feature = "lod")]
pub(super) use make::{mesh, own_facing};

#[cfg(not(feature = "lod"))]
mod make {
    use super::{Error, PreparedScene, Result, StandIns};

    pub fn simplified(_: &PreparedScene, share: f64) -> Result<StandIns> {
        Err(Error::parameter("share", share, "simplified occluders need the feature lod"))
    }

    pub fn detail(_: &PreparedScene, px: f64) -> Result<StandIns> {
        Err(Error::parameter("lod", px, "levels of detail need the feature lod"))
    }
}

#[cfg(feature = "lod")]
mod make {
    use std::collections::BTreeMap;

    use super::{Form, Forms, StandIns};
    use crate::error::Result;
    use crate::occlusion::Occluder;
    use crate::raster::{Facing, MeshId, PreparedMeshes};
    use crate::scene::lod::{LodChain, Merge, OccluderLevels, price_within};
    use crate::scene::{Mesh, PreparedScene};

    /// A mesh, and the side of it that is drawn, in its own space.
    type Key = (u32, u8);

    pub fn simplified(scene: &PreparedScene, share: f64) -> Result<StandIns> {
        let mut levels: BTreeMap<Key, OccluderLevels> = BTreeMap::new();
        for object in &scene.occluders {
            if let Some(facing) = own_facing(object).filter(|_| object.opaque) {
                let key = (object.mesh.0, facing as u8);
                levels
                    .entry(key)
                    .or_insert_with(|| OccluderLevels::new(&mesh(scene, object.mesh), facing, Merge::Inner));
            }
        }
        let closed: usize = levels.values().map(OccluderLevels::closed_triangles).sum();
        let price = price_within(levels.values(), (closed as f64 * share) as usize);
        let mut out = StandIns::default();
        let mut ranges = BTreeMap::new();
        for (key, levels) in &levels {
            let simplified = levels.at(price);
            let triangles = simplified.triangles() as u32;
            if triangles < scene.meshes.triangles(MeshId(key.0)) {
                let inside = add(&mut out.meshes, &simplified.inside)?;
                let surface = add(&mut out.meshes, &simplified.open)?;
                ranges.insert(*key, out.forms.len()..out.forms.len() + 1);
                out.forms.push(Form { triangles, error: 0.0, inside, surface });
            }
        }
        let forms = |object: &Occluder| ranges.get(&(object.mesh.0, own_facing(object)? as u8)).cloned();
        out.of = of_objects(scene, forms);
        Ok(out)
    }

    pub fn detail(scene: &PreparedScene, lod_scale: f64) -> Result<StandIns> {
        let mut out = StandIns { lod_scale: Some(lod_scale), ..StandIns::default() };
        let mut ranges = BTreeMap::new();
        for object in scene.occluders.iter().filter(|o| o.opaque) {
            if ranges.contains_key(&object.mesh.0) {
                continue;
            }
            let first = out.forms.len();
            let chain = LodChain::new(&format!("mesh {}", object.mesh.0), &mesh(scene, object.mesh))?;
            for level in &chain.levels()[1..] {
                let surface = add(&mut out.meshes, &level.mesh)?;
                let triangles = level.mesh.triangles().len() as u32;
                out.forms.push(Form { triangles, error: level.error, inside: None, surface });
            }
            ranges.insert(object.mesh.0, first..out.forms.len());
        }
        out.of = of_objects(scene, |object| ranges.get(&object.mesh.0).cloned());
        Ok(out)
    }

    fn of_objects(scene: &PreparedScene, range: impl Fn(&Occluder) -> Option<std::ops::Range<usize>>) -> Vec<Forms> {
        let forms = |object: &Occluder| Forms {
            range: range(object).filter(|_| object.opaque).unwrap_or_default(),
            scale: object
                .rotation
                .map_or(1.0, |r| f64::from(r.x_axis.length().max(r.y_axis.length()).max(r.z_axis.length()))),
        };
        scene.occluders.iter().map(forms).collect()
    }

    /// The side of its mesh's triangles that an object shows: a mirror turns them over; `None` where it is pressed flat.
    pub fn own_facing(object: &Occluder) -> Option<Facing> {
        let turned = object.rotation.map_or(1.0, |r| r.as_dmat3().determinant());
        match (object.facing, turned) {
            (facing, t) if t > 0.0 => Some(facing),
            (Facing::Both, t) if t < 0.0 => Some(Facing::Both),
            (Facing::Front, t) if t < 0.0 => Some(Facing::Back),
            (Facing::Back, t) if t < 0.0 => Some(Facing::Front),
            _ => None,
        }
    }

    /// A mesh as it was given, each triangle with corners of its own.
    pub fn mesh(scene: &PreparedScene, mesh: MeshId) -> Mesh {
        let corners = scene.meshes.corners(mesh);
        let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::from_checked(corners.into_flattened(), triangles)
    }

    fn add(meshes: &mut PreparedMeshes, mesh: &Mesh) -> Result<Option<MeshId>> {
        let some = !mesh.triangles().is_empty();
        some.then(|| meshes.add(mesh.positions(), mesh.triangles())).transpose()
    }
}
