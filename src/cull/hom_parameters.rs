//! Parameters of the hom methods, as they are written on the command line.

use std::path::PathBuf;

use super::overlap_parameters::OverlapParameters;
use crate::error::{Error, Result};
use crate::occlusion::{DepthReading, DepthRepresentation, Partitions};
use crate::select::{
    Criterion, DEFAULT_OCCLUDER_LOD, DEFAULT_SHARE, DEFAULT_TRIANGLES, Measure, OccluderGeometry, StaticCriteria,
};
use crate::view::Viewport;

/// When the occlusion representation is updated (Zhang 1998, 2.1.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// From selected occluders, before anything is tested: one pass.
    Once,
    /// Whenever visible objects of more than this many triangles have gathered: multi-pass.
    Batches(u64),
    /// After every visible object: progressive.
    Always,
}

/// How occluders are chosen for one pass (7.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Selection {
    /// The nearest, under a triangle limit.
    Distance(Measure),
    /// All that reach nearer than this distance along the view direction.
    ZPlane(f32),
    /// Those seen from the nearest view point of a bake, the largest first, under a triangle limit (7.5); where none is near,
    /// by distance.
    Baked,
    /// By distance, among the candidates that temporal coherence leaves (7.4, equation 7.1).
    Temporal,
}

/// What may occlude (7.1): the occluder database.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Database {
    /// Every opaque object.
    All,
    /// Those that static selection leaves.
    Static(StaticCriteria),
}

/// Parameters of the hom methods.
#[derive(Debug, Clone, PartialEq)]
pub struct HomParameters {
    /// When the representation is updated.
    pub update: Update,
    /// What stands for the occluders' depth (chapter 6).
    pub depth: DepthRepresentation,
    /// How occluders are chosen.
    pub select: Selection,
    /// What they are chosen from.
    pub database: Database,
    /// What is drawn for an occluder.
    pub occluders: OccluderGeometry,
    /// The bake that [`Selection::Baked`] reads.
    pub bake: Option<PathBuf>,
    /// How far from the eye its view point may be, in diagonals of a cell.
    pub snap: f32,
    /// Whether, when the list of a view point ends within the limit, the nearest others follow.
    pub fill: bool,
    /// Triangles of the chosen occluders, at most.
    pub occluder_triangles: u64,
    /// Samples of the occlusion buffer; the display's when `None`. Others are not conservative.
    pub resolution: Option<Viewport>,
    /// How rectangles are tested against the occlusion maps: thresholds, levels, blocks, fusion.
    pub overlap: OverlapParameters,
    /// Consecutive tests without a hidden object after which testing ends for the frame.
    pub bypass_after: u32,
    /// Frames that culling rests after one that hid next to nothing; 0 never rests.
    pub rest: u32,
    /// Whether OccSel, Cull and Draw of consecutive frames overlap, on threads of their own (8.1).
    pub pipeline: bool,
    /// Frames until what a frame found is heard: 1 and more; see [`HomParameters::lag`].
    pub lag: Option<u32>,
}

/// The least lag of feedback in the pipeline: OccSel for frame N + 2 starts before Cull for frame N ends.
pub const PIPELINE_LAG: u32 = 3;
/// The greatest lag: a second of frames.
pub const MAX_LAG: u32 = 60;

/// Update size of `hom-multipass`, in triangles.
pub const DEFAULT_UPDATE_TRIANGLES: u64 = 2_000;
/// Distance of the z-plane, in scene units.
pub const DEFAULT_Z_PLANE: f32 = 50.0;
/// Diagonals of a cell to the nearest view point: in the grid and half a cell beyond it there is always one, unless points
/// around were skipped.
pub const DEFAULT_SNAP: f32 = 1.0;
/// Consecutive tests without a hidden object before the bypass. Well-occluded frames of the benchmark scenes show up to
/// 250 objects, so it lies above; open terrain has thousands.
pub const DEFAULT_BYPASS: u32 = 384;
/// Frames of rest, at most, after frames that hid next to nothing: one frame in sixteen looks again.
pub const DEFAULT_REST: u32 = 15;

impl HomParameters {
    /// The defaults, for an update mode.
    pub fn new(update: Update) -> HomParameters {
        HomParameters {
            update,
            depth: DepthRepresentation::default(),
            select: Selection::Distance(Measure::Center),
            database: Database::All,
            occluders: OccluderGeometry::Original,
            bake: None,
            snap: DEFAULT_SNAP,
            fill: true,
            occluder_triangles: DEFAULT_TRIANGLES,
            resolution: None,
            overlap: OverlapParameters::default(),
            bypass_after: DEFAULT_BYPASS,
            rest: DEFAULT_REST,
            pipeline: false,
            lag: None,
        }
    }

    /// Frames until what a frame found is heard: unless chosen, 1 in turn and [`PIPELINE_LAG`] in the pipeline.
    pub fn lag(&self) -> u32 {
        self.lag.unwrap_or(if self.pipeline { PIPELINE_LAG } else { 1 })
    }

    /// Whether the parameters can be had together.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a lag out of range.
    pub fn check(&self) -> Result<()> {
        let least = if self.pipeline { PIPELINE_LAG } else { 1 };
        if (least..=MAX_LAG).contains(&self.lag()) {
            return Ok(());
        }
        Err(Error::parameter(
            "lag",
            self.lag(),
            format!("{least} to {MAX_LAG} with pipeline={}", on_off(self.pipeline)),
        ))
    }

    /// True when the picture is guaranteed to stay the same; with simplified occluders, but for samples within 1/256 pixel of their edges.
    pub fn is_conservative(&self) -> bool {
        self.overlap.is_conservative() && self.resolution.is_none() && self.occluders.is_conservative()
    }

    /// Whether frames need [`OccluderSources`](super::OccluderSources): to choose from, or for what stands in for occluders.
    pub fn needs_sources(&self) -> bool {
        self.update == Update::Once || self.occluders != OccluderGeometry::Original
    }
}

impl HomParameters {
    pub(super) fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        let bad = |reason: &str| Error::parameter(key, value, reason);
        let number = |what: &str| value.parse::<u64>().map_err(|_| bad(what));
        match (key, value) {
            ("depth", "nbz") => self.depth = DepthRepresentation::NoBackground(DepthReading::PerSample),
            ("depth", "nbz-block") => self.depth = DepthRepresentation::NoBackground(DepthReading::PerBlock),
            ("depth", "deb") => self.depth = DepthRepresentation::Estimation(Partitions::default()),
            ("depth", "plane") => self.depth = DepthRepresentation::Plane,
            ("depth", _) => return Err(bad("nbz, nbz-block, deb or plane")),
            ("deb-size", _) if matches!(self.depth, DepthRepresentation::Estimation(_)) => {
                let size = parse_sides(value)
                    .and_then(|[w, h]| Partitions::new(u32::try_from(w).ok()?, u32::try_from(h).ok()?).ok());
                let size = size.ok_or_else(|| bad("WxH, 1 to 16384 partitions of the screen a side"))?;
                self.depth = DepthRepresentation::Estimation(size);
            }
            ("deb-size", _) => return Err(bad("it must follow depth=deb")),
            ("update", "once") => self.update = Update::Once,
            ("update", "batches") => self.update = Update::Batches(DEFAULT_UPDATE_TRIANGLES),
            ("update", "always") => self.update = Update::Always,
            ("update", _) => return Err(bad("once, batches or always")),
            ("update-triangles", _) if matches!(self.update, Update::Batches(_)) => {
                self.update = Update::Batches(number("a number of triangles")?);
            }
            ("select", "distance") => self.select = Selection::Distance(Measure::Center),
            ("select", "nearest") => self.select = Selection::Distance(Measure::Nearest),
            ("select", "zplane") => self.select = Selection::ZPlane(DEFAULT_Z_PLANE),
            ("select", "baked") => self.select = Selection::Baked,
            ("select", "temporal") => self.select = Selection::Temporal,
            ("select", _) => return Err(bad("distance, nearest, zplane, temporal or baked")),
            ("bake", "") => return Err(bad("a file that `homcull bake` wrote")),
            ("bake", _) => self.bake = Some(value.into()),
            ("fill", "on") => self.fill = true,
            ("fill", "off") => self.fill = false,
            ("fill", _) => return Err(bad("on or off")),
            ("snap", _) => {
                let snap = value.parse::<f32>().ok().filter(|s| s.is_finite() && *s >= 0.0);
                self.snap = snap.ok_or_else(|| bad("diagonals of a cell, 0 or more"))?;
            }
            ("z", _) => {
                let z = value
                    .parse::<f32>()
                    .ok()
                    .filter(|z| z.is_finite() && *z > 0.0)
                    .ok_or_else(|| bad("a distance above 0"))?;
                self.select = Selection::ZPlane(z);
            }
            ("database", "all") => self.database = Database::All,
            ("database", "static") => self.database = Database::Static(StaticCriteria::default()),
            ("database", _) => return Err(bad("all or static")),
            (_, _) if key.starts_with("static-") => {
                let criterion = Criterion::ALL.into_iter().find(|c| key == c.parameter()).ok_or_else(&unknown)?;
                match &mut self.database {
                    Database::Static(criteria) => criteria.set(criterion, value)?,
                    Database::All => return Err(Error::parameter(key, value, "must follow database=static")),
                }
            }
            ("occluders", "original") => self.occluders = OccluderGeometry::Original,
            ("occluders", "simplified") => self.occluders = OccluderGeometry::Simplified(DEFAULT_SHARE),
            ("occluders", "lod") => self.occluders = OccluderGeometry::Detail(DEFAULT_OCCLUDER_LOD),
            ("occluders", _) => return Err(bad("original, simplified or lod")),
            ("share", _) if matches!(self.occluders, OccluderGeometry::Simplified(_)) => {
                let share = value.parse::<f64>().ok().filter(|s| (0.0..=1.0).contains(s));
                self.occluders = OccluderGeometry::Simplified(share.ok_or_else(|| bad("0 to 1"))?);
            }
            ("share", _) => return Err(bad("it must follow occluders=simplified")),
            ("lod", _) => {
                let pixels = value.parse::<f64>().ok().filter(|px| (0.0..f64::INFINITY).contains(px));
                self.occluders = OccluderGeometry::Detail(pixels.ok_or_else(|| bad("pixels, 0 or more"))?);
            }
            ("occluder-triangles", _) => self.occluder_triangles = number("a number of triangles")?,
            ("resolution", _) => self.resolution = Some(parse_resolution(value)?),
            ("bypass", _) => {
                let n = number("a number of tests")?;
                self.bypass_after = u32::try_from(n).ok().filter(|&n| n > 0).ok_or_else(|| bad("1 to 4294967295"))?;
            }
            ("rest", _) => {
                let n = number("a number of frames")?;
                self.rest = u32::try_from(n).map_err(|_| bad("0 to 4294967295"))?;
            }
            ("pipeline", "on") => self.pipeline = true,
            ("pipeline", "off") => self.pipeline = false,
            ("pipeline", _) => return Err(bad("off or on")),
            ("lag", _) => {
                let n = number("a number of frames")?;
                let n = u32::try_from(n).ok().filter(|n| (1..=MAX_LAG).contains(n));
                self.lag = Some(n.ok_or_else(|| bad(&format!("1 to {MAX_LAG}")))?);
            }
            _ if self.overlap.set(key, value)? => {}
            _ => return Err(unknown()),
        }
        Ok(())
    }

    pub(super) fn list(&self) -> Vec<(String, String)> {
        let mut out: Vec<(&str, String)> = Vec::new();
        out.push(("depth", self.depth.name().into()));
        if let DepthRepresentation::Estimation(p) = self.depth {
            out.push(("deb-size", format!("{}x{}", p.width(), p.height())));
        }
        match self.update {
            Update::Once => {
                let select = match self.select {
                    Selection::Distance(Measure::Center) => "distance",
                    Selection::Distance(Measure::Nearest) => "nearest",
                    Selection::ZPlane(_) => "zplane",
                    Selection::Baked => "baked",
                    Selection::Temporal => "temporal",
                };
                out.push(("select", select.into()));
                match self.select {
                    Selection::ZPlane(z) => out.push(("z", z.to_string())),
                    Selection::Distance(_) | Selection::Temporal | Selection::Baked => {
                        out.push(("occluder-triangles", self.occluder_triangles.to_string()));
                    }
                }
                if let (Selection::Baked, Some(bake)) = (self.select, &self.bake) {
                    out.push(("bake", bake.display().to_string()));
                    out.push(("snap", self.snap.to_string()));
                    out.push(("fill", if self.fill { "on" } else { "off" }.into()));
                }
                match self.database {
                    Database::All => out.push(("database", "all".into())),
                    Database::Static(criteria) => {
                        out.push(("database", "static".into()));
                        out.extend(Criterion::ALL.map(|c| (c.parameter(), criteria.value(c))));
                    }
                }
            }
            Update::Batches(n) => out.push(("update-triangles", n.to_string())),
            Update::Always => {}
        }
        match self.occluders {
            OccluderGeometry::Original => out.push(("occluders", "original".into())),
            OccluderGeometry::Simplified(share) => {
                out.push(("occluders", "simplified".into()));
                out.push(("share", share.to_string()));
            }
            OccluderGeometry::Detail(pixels) => {
                out.push(("occluders", "lod".into()));
                out.push(("lod", pixels.to_string()));
            }
        }
        if let Some(v) = self.resolution {
            out.push(("resolution", format!("{}x{}", v.width(), v.height())));
        }
        self.overlap.list(&mut out);
        out.push(("bypass", self.bypass_after.to_string()));
        out.push(("rest", self.rest.to_string()));
        out.push(("pipeline", on_off(self.pipeline).into()));
        out.push(("lag", self.lag().to_string()));
        out.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
    }
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

fn parse_resolution(value: &str) -> Result<Viewport> {
    let [width, height] = parse_sides(value).ok_or_else(|| Error::parameter("resolution", value, "WxH, in samples"))?;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) => Viewport::new(w, h),
        _ => Err(Error::Size { width, height }),
    }
}

/// Two numbers with an x between.
fn parse_sides(value: &str) -> Option<[u64; 2]> {
    let (width, height) = value.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}
