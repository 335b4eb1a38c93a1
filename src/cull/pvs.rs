//! Precomputed visibility: what is drawn is read from a bake (Bittner et al. 2004, section 5, *comparison to PVS-based rendering*; the
//! bake is Zhang's, 1998, 7.5).
//!
//! The eye is snapped onto the nearest view point of the bake, and the objects in the frustum that its list names are drawn; nothing is
//! tested. A potentially visible set proper holds whatever shows from anywhere in a cell. A bake has looked from single points, by the
//! samples of a cube, so this is *approximate*: what shows only from elsewhere, or between two samples, is missing. A
//! finer grid misses less, and so do the lists of all *eight* points at the corners of the box in which the eye is.
//!
//! Where no view point is in reach, everything in the frustum is drawn, as `vfc` does, and the frame counts as bypassed.
//!
//! Invariant: the set is vfc's, in its order, less what no list names. Cost: vfc's walk and a look-up an object in the frustum;
//! marking lists when the eye gets near other points.

use std::path::PathBuf;

use homcull_simd::Level;

use super::VisibleSet;
use super::hom_parameters::DEFAULT_SNAP;
use super::vfc::{self, VfcMemory, World};
use crate::error::{Error, Result};
use crate::scene::PreparedScene;
use crate::select::BakedVisibility;
use crate::view::View;

/// Parameters of `pvs`.
#[derive(Debug, Clone, PartialEq)]
pub struct PvsParameters {
    /// The bake to read.
    pub bake: Option<PathBuf>,
    /// How far from the eye its view point may be, in diagonals of a cell.
    pub snap: f32,
    /// Whether the lists of the eight view points around the eye count, or that of the nearest alone.
    pub eight: bool,
}

impl Default for PvsParameters {
    fn default() -> Self {
        PvsParameters { bake: None, snap: DEFAULT_SNAP, eight: false }
    }
}

impl PvsParameters {
    /// Sets one by name. `unknown` makes the error for a key that is none of them.
    pub(super) fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        match key {
            "bake" if value.is_empty() => return Err(Error::parameter(key, value, "a file that `homcull bake` wrote")),
            "bake" => self.bake = Some(value.into()),
            "snap" => {
                let snap = value.parse().ok().filter(|s: &f32| s.is_finite() && *s >= 0.0);
                self.snap = snap.ok_or_else(|| Error::parameter(key, value, "diagonals of a cell, 0 or more"))?;
            }
            "points" => {
                self.eight = match value {
                    "1" | "8" => value == "8",
                    _ => return Err(Error::parameter(key, value, "1 or 8")),
                }
            }
            _ => return Err(unknown()),
        }
        Ok(())
    }

    /// All with their values.
    pub(super) fn list(&self) -> Vec<(String, String)> {
        let bake = self.bake.iter().map(|path| ("bake".to_owned(), path.display().to_string()));
        let points = if self.eight { "8" } else { "1" };
        bake.chain([("snap".into(), self.snap.to_string()), ("points".into(), points.into())]).collect()
    }

    /// Whether there is something to read.
    ///
    /// # Errors
    /// [`Error::Parameter`] when no bake is named.
    pub fn check(&self) -> Result<()> {
        self.bake().map(drop)
    }

    fn bake(&self) -> Result<&PathBuf> {
        self.bake.as_ref().ok_or_else(|| Error::parameter("method", "pvs", "needs bake=FILE, from `homcull bake`"))
    }
}

/// Precomputed visibility of a scene, and what is kept from frame to frame.
pub struct Pvs {
    baked: BakedVisibility,
    snap: f32,
    eight: bool,
    /// The view points whose lists are marked, and the marks, an object each.
    points: Vec<usize>,
    named: Vec<bool>,
    memory: VfcMemory,
}

impl Pvs {
    /// Reads the bake.
    ///
    /// # Errors
    /// [`Error::Parameter`] when none is named; those of [`BakedVisibility::load`].
    pub fn new(scene: &PreparedScene, parameters: &PvsParameters) -> Result<Pvs> {
        let baked = BakedVisibility::load(parameters.bake()?, scene)?;
        let (named, memory) = (vec![false; scene.occluders.len()], VfcMemory::default());
        Ok(Pvs { baked, snap: parameters.snap, eight: parameters.eight, points: Vec::new(), named, memory })
    }

    /// What to draw, nearest first.
    pub fn cull(&mut self, world: &World<'_>, level: Level, view: &View) -> VisibleSet {
        let mut set = vfc::cull(world, level, view, &mut self.memory);
        let points = match self.eight {
            true => self.baked.around(view.eye(), self.snap),
            false => self.baked.snap(view.eye(), self.snap).into_iter().collect(),
        };
        if points.is_empty() {
            return VisibleSet { bypassed: true, ..set };
        }
        if self.points != points {
            self.named.fill(false);
            for object in points.iter().flat_map(|&point| self.baked.objects(point)) {
                self.named[*object as usize] = true;
            }
            self.points = points;
        }
        set.objects.retain(|&object| self.named[object as usize]);
        set.triangles_hidden = set.triangles_in_frustum - world.triangles(&set.objects);
        set
    }
}
