//! Upright boxes inside what is drawn: the occluders of occlusion horizons.
//!
//! A mesh is taken apart, and in each of its largest closed parts a box is looked for, upright in the mesh's own space: that
//! around the part, drawn in by a hair, or less of it. A box counts when all twelve triangles of its surface are proven, in
//! exact arithmetic, to lie strictly inside the part (`scene/lod/enclosure.rs`): then whatever the box covers, seen from
//! outside the part's own box, the part covers, and nearer. The hair is a 2^-13 of the part's diagonal, and more than an
//! object's rotation rounds. Made once a mesh and the side of it that is drawn; costs a proof a candidate, a few a part.

use std::ops::Range;

use glam::Mat3;

use crate::error::Result;
use crate::geometry::Aabb;
use crate::scene::PreparedScene;

/// The boxes of a scene's objects.
#[derive(Debug, Clone, Default)]
pub struct Prisms {
    /// In the space of their mesh.
    boxes: Vec<Aabb>,
    /// By object: empty for what is translucent, open, or does not stand upright.
    of: Vec<Range<usize>>,
}

impl Prisms {
    /// Looks for boxes in all meshes.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) without the feature `lod`.
    pub fn new(scene: &PreparedScene) -> Result<Prisms> {
        make::prisms(scene)
    }

    /// The boxes inside an object, in its mesh's space.
    pub fn of(&self, object: u32) -> &[Aabb] {
        self.of.get(object as usize).map_or(&[], |range| &self.boxes[range.clone()])
    }

    /// True when no object has any: nothing is an occluder then.
    pub fn is_empty(&self) -> bool {
        self.of.iter().all(Range::is_empty)
    }
}

/// Whether an upright box stays upright and is not pressed flat: turned about the vertical, scaled within measure.
#[cfg_attr(not(feature = "lod"), allow(dead_code))]
fn stands_upright(rotation: Option<Mat3>) -> bool {
    let Some(r) = rotation else { return true };
    let lengths = [r.x_axis, r.y_axis, r.z_axis].map(|axis| axis.length());
    let most = lengths.iter().fold(0.0f32, |a, &b| a.max(b));
    let level = r.x_axis.y == 0.0 && r.z_axis.y == 0.0 && r.y_axis.x == 0.0 && r.y_axis.z == 0.0;
    level && r.is_finite() && lengths.iter().all(|&l| l > most / 16.0) && r.determinant().abs() > most.powi(3) / 256.0
}

#[cfg(not(feature = "lod"))]
mod make {
    use super::{PreparedScene, Prisms, Result};
    use crate::error::Error;

    pub fn prisms(_: &PreparedScene) -> Result<Prisms> {
        Err(Error::parameter("method", "horizons", "needs the feature lod, which finds its occluders"))
    }
}

#[cfg(feature = "lod")]
mod make {
    use std::collections::BTreeMap;

    use glam::Vec3;

    use super::super::stand_ins::{mesh, own_facing};
    use super::{Aabb, PreparedScene, Prisms, Result, stands_upright};
    use crate::raster::Facing;
    use crate::scene::Mesh;
    use crate::scene::lod::{Enclosure, Part, Parts};

    /// Parts of a mesh that are looked into, and boxes of a mesh that are kept: the largest, seen from the side.
    const PARTS: usize = 8;
    const BOXES: usize = 4;
    /// Of the largest box of a mesh, the share that another must have of its side.
    const LEAST: f32 = 1.0 / 64.0;
    /// Depth below the part's own box, over its diagonal; and at least, in steps of the farthest coordinate.
    const HAIR: f32 = 1.0 / 8192.0;
    const STEPS: f32 = 8.0;
    /// Shares of the part's box that are tried: of its width and depth, and of its height from where to where.
    const WIDE: [f32; 5] = [1.0, 0.85, 0.7, 0.55, 0.4];
    const HIGH: [(f32, f32); 5] = [(0.0, 1.0), (0.0, 0.75), (0.0, 0.5), (0.25, 0.75), (0.5, 1.0)];

    pub fn prisms(scene: &PreparedScene) -> Result<Prisms> {
        let mut out = Prisms::default();
        let mut known = BTreeMap::new();
        for object in &scene.occluders {
            let facing = own_facing(object).filter(|_| object.opaque && stands_upright(object.rotation));
            let range = match facing.filter(|&facing| facing != Facing::Back) {
                None => 0..0,
                Some(facing) => {
                    let find = || {
                        let first = out.boxes.len();
                        out.boxes.extend(of_mesh(&mesh(scene, object.mesh), facing));
                        first..out.boxes.len()
                    };
                    known.entry((object.mesh.0, facing as u8)).or_insert_with(find).clone()
                }
            };
            out.of.push(range);
        }
        Ok(out)
    }

    fn of_mesh(mesh: &Mesh, facing: Facing) -> Vec<Aabb> {
        let Parts { positions, parts } = Parts::new(mesh, facing == Facing::Both);
        let around = |part: &Part| Aabb::around(part.triangles.iter().flatten().map(|&i| positions[i as usize]));
        let closed = parts.iter().filter(|part| part.open.is_none());
        let mut closed: Vec<(Aabb, &Part)> = closed.map(|part| (around(part), part)).collect();
        closed.sort_by(|a, b| side(b.0).total_cmp(&side(a.0)));
        let corners = |part: &Part| part.triangles.iter().map(|t| t.map(|i| positions[i as usize])).collect();
        let found = closed.iter().take(PARTS).filter_map(|(bounds, part)| {
            let enclosure = Enclosure::of(&separate(corners(part)), Facing::Front).ok()?;
            inside(&enclosure, *bounds)
        });
        let mut found: Vec<Aabb> = found.collect();
        found.sort_by(|a, b| side(*b).total_cmp(&side(*a)));
        let least = found.first().map_or(0.0, |&b| side(b) * LEAST);
        found.retain(|&b| side(b) >= least);
        found.truncate(BOXES);
        found
    }

    /// The larger upright side of a box: what it hides from the street.
    fn side(b: Aabb) -> f32 {
        let size = b.size();
        size.x.max(size.z) * size.y
    }

    /// A mesh of triangles of their own.
    fn separate(corners: Vec<[Vec3; 3]>) -> Mesh {
        let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::from_checked(corners.into_flattened(), triangles)
    }

    /// The largest of the candidates that is proven to lie inside.
    fn inside(part: &Enclosure, bounds: Aabb) -> Option<Aabb> {
        let (size, middle) = (bounds.size(), bounds.center());
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let hair = (size.length() * HAIR).max(farthest * STEPS * f32::EPSILON);
        let shares = WIDE.iter().flat_map(|&wide| HIGH.iter().map(move |&high| (wide, high)));
        let mut shares: Vec<(f32, (f32, f32))> = shares.collect();
        shares.sort_by(|a, b| (b.0 * (b.1.1 - b.1.0)).total_cmp(&(a.0 * (a.1.1 - a.1.0))));
        let candidate = |(wide, (from, to)): (f32, (f32, f32))| {
            let half = Vec3::new(size.x * wide * 0.5 - hair, 0.0, size.z * wide * 0.5 - hair);
            let (low, high) = (bounds.min.y + size.y * from + hair, bounds.min.y + size.y * to - hair);
            let (min, max) = (middle - half, middle + half);
            Aabb { min: Vec3::new(min.x, low, min.z), max: Vec3::new(max.x, high, max.z) }
        };
        let some = |b: &Aabb| b.is_finite() && b.size().min_element() > hair;
        shares.into_iter().map(candidate).filter(some).find(|&b| surface(b).into_iter().all(|t| part.contains(t)))
    }

    /// The twelve triangles of a box, whichever way they face.
    fn surface(b: Aabb) -> [[Vec3; 3]; 12] {
        let sides = [b.min, b.max];
        let corner = |k: usize| Vec3::new(sides[k & 1].x, sides[k >> 1 & 1].y, sides[k >> 2].z);
        const FACES: [[usize; 4]; 6] =
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        std::array::from_fn(|t| {
            let [a, b, c, d] = FACES[t / 2].map(corner);
            if t % 2 == 0 { [a, b, c] } else { [a, c, d] }
        })
    }
}
