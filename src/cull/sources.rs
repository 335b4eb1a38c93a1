//! What a hom method chooses its occluders from (Zhang 1998, chapter 7): the database of a scene and the bake, made and read once
//! a method; and the choice of a view.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;
use homcull_simd::Level;

use super::hom_parameters::{Database, HomParameters, Selection};
use crate::error::{Error, Result};
use crate::scene::PreparedScene;
use crate::select::{
    BakedVisibility, Measure, Occluded, OccluderDatabase, OccluderGeometry, Order, StandIns, StaticSelection,
    WalkMemory,
};
use crate::view::View;

/// The sources of one method in one scene. Read by any number of frames.
#[derive(Debug, Clone)]
pub struct OccluderSources {
    /// What may occlude.
    pub database: OccluderDatabase,
    /// What is seen from where, when selection asks for it.
    baked: Option<BakedVisibility>,
    scene: u64,
    /// The parameters that it was made by.
    made_by: MadeBy,
}

/// Sources that several methods have in common: what takes long, redundancy and stand-ins, is made once.
#[derive(Default)]
pub struct SharedSources(Vec<Arc<OccluderSources>>);

impl SharedSources {
    /// The sources of a scene under these parameters, made if none agrees; `None` when frames need none.
    ///
    /// # Errors
    /// Those of [`OccluderSources::new`].
    pub fn of(&mut self, scene: &PreparedScene, parameters: &HomParameters) -> Result<Option<Arc<OccluderSources>>> {
        if !parameters.needs_sources() {
            return Ok(None);
        }
        if let Some(sources) = self.0.iter().find(|s| s.are_of(scene, parameters)) {
            return Ok(Some(sources.clone()));
        }
        let sources = Arc::new(OccluderSources::new(scene, parameters)?);
        self.0.push(sources.clone());
        Ok(Some(sources))
    }
}

/// The parameters that decide on sources.
#[derive(Debug, Clone, PartialEq)]
struct MadeBy {
    database: Database,
    bake: Option<PathBuf>,
    fused: bool,
    occluders: OccluderGeometry,
}

impl MadeBy {
    fn of(parameters: &HomParameters) -> MadeBy {
        let HomParameters { database, occluders, overlap, .. } = parameters;
        let (database, occluders) = (*database, *occluders);
        MadeBy { database, bake: bake_of(parameters).cloned(), fused: overlap.fusion.is_some(), occluders }
    }

    /// Asked every frame: allocates nothing.
    fn agrees(&self, parameters: &HomParameters) -> bool {
        let MadeBy { database, bake, fused, occluders } = self;
        *database == parameters.database
            && bake.as_ref() == bake_of(parameters)
            && *fused == parameters.overlap.fusion.is_some()
            && *occluders == parameters.occluders
    }
}

impl OccluderSources {
    /// Builds the database that the parameters ask for, and reads their bake.
    ///
    /// # Errors
    /// Those of [`StaticSelection::new`], [`StandIns::new`] and [`BakedVisibility::load`]; [`Error::Parameter`] when a bake is to be used and none
    /// is named.
    pub fn new(scene: &PreparedScene, parameters: &HomParameters) -> Result<OccluderSources> {
        let selection = match &parameters.database {
            Database::All => None,
            Database::Static(criteria) => Some(StaticSelection::new(scene, criteria)?),
        };
        let may_occlude = |id| selection.as_ref().is_none_or(|s| s.admits(id));
        let database = match parameters.overlap.fusion {
            None => OccluderDatabase::of_scene(scene, may_occlude),
            Some(_) => OccluderDatabase::of_fused_scene(scene, may_occlude),
        };
        let database = database.with_stand_ins(StandIns::new(scene, parameters.occluders)?);
        let mut sources = OccluderSources::with_database(database, scene, parameters);
        if let Some(path) = sources.made_by.bake.as_ref() {
            sources.baked = Some(BakedVisibility::load(path, scene)?);
        } else if parameters.select == Selection::Baked {
            return Err(Error::parameter("select", "baked", "needs a bake"));
        }
        Ok(sources)
    }

    /// A database of the caller's own, e.g. of meshes given as occluders, in place of the one that the parameters name. It has
    /// ids of its own, so no bake goes with it: [`Selection::Baked`] chooses by distance.
    pub fn with_database(
        database: OccluderDatabase,
        scene: &PreparedScene,
        parameters: &HomParameters,
    ) -> OccluderSources {
        OccluderSources { database, baked: None, scene: scene.hash, made_by: MadeBy::of(parameters) }
    }

    /// Whether these are the sources of that scene under those parameters.
    pub fn are_of(&self, scene: &PreparedScene, parameters: &HomParameters) -> bool {
        self.scene == scene.hash && self.made_by.agrees(parameters)
    }

    /// Chooses the occluders of a view, appended to `chosen`: ids in the database. `before` is what was in the frustum and occluded,
    /// for temporal coherence. With a bake, gives the view point that the eye snapped onto.
    pub(super) fn choose(
        &self,
        level: Level,
        view: &View,
        parameters: &HomParameters,
        before: &Occluded,
        memory: &mut WalkMemory,
        chosen: &mut Vec<u32>,
    ) -> Option<usize> {
        let limit = parameters.occluder_triangles;
        let (order, limit) = match parameters.select {
            Selection::Distance(measure) => (Order::Distance(measure), limit),
            Selection::Temporal => (Order::Distance(Measure::Center), limit),
            Selection::Baked => {
                let baked = self.baked.as_ref();
                let at = baked.and_then(|baked| Some((baked, baked.snap(view.eye(), parameters.snap)?)));
                if let Some((baked, point)) = at {
                    let ended = self.database.choose_in_order(level, view, baked.objects(point), limit, chosen);
                    if ended && parameters.fill {
                        self.database.choose(level, view, NEAREST, limit, &|_| true, memory, chosen);
                    }
                    return Some(point);
                }
                (NEAREST, limit)
            }
            Selection::ZPlane(distance) => (Order::ZPlane { forward: forward(view), distance }, u64::MAX),
        };
        let temporal = parameters.select == Selection::Temporal;
        let candidate = |id| !(temporal && before.contains(id));
        self.database.choose(level, view, order, limit, &candidate, memory, chosen);
        None
    }
}

/// What a bake is filled up with, and replaced by where there is none near: the thesis's standard order.
const NEAREST: Order = Order::Distance(Measure::Center);

/// The bake that the parameters read, if they do.
fn bake_of(parameters: &HomParameters) -> Option<&PathBuf> {
    parameters.bake.as_ref().filter(|_| parameters.select == Selection::Baked)
}

/// The view direction, a unit vector.
fn forward(view: &View) -> Vec3 {
    let w = view.rows()[2].truncate().as_vec3();
    let forward = if w == Vec3::ZERO { -view.rows()[3].truncate().as_vec3() } else { w };
    forward.normalize_or_zero()
}
