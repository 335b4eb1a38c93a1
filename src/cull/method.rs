//! Methods by name and parameters, as they are written on the command line: `hom:depth=nbz,threshold=0.85`.

use std::path::PathBuf;

use super::coherent::QueryParameters;
use super::overlap_parameters::{OverlapParameters, overlap_parameters};
use super::plp_parameters::PlpParameters;
use super::portals::PortalParameters;
use crate::error::{Error, Result};
use crate::occlusion::{DepthReading, DepthRepresentation, Partitions};
use crate::select::{
    Criterion, DEFAULT_OCCLUDER_LOD, DEFAULT_SHARE, DEFAULT_TRIANGLES, Measure, OccluderGeometry, StaticCriteria,
};
use crate::view::Viewport;

/// A method and its parameters.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant)] // there are a few of them a walk
pub enum Method {
    /// View-frustum culling alone.
    Vfc,
    /// Hierarchical occlusion maps.
    Hom(HomParameters),
    /// Prioritized-layered projection.
    Plp(PlpParameters),
    /// Its conservative version.
    Cplp(PlpParameters),
    /// Cells and portals.
    Portals(PortalParameters),
    /// Occlusion horizons.
    Horizons,
    /// The hierarchical Z-buffer.
    Hzb(HzbParameters),
    /// Occlusion queries: stop-and-wait, or coherent hierarchical culling.
    Queries(QueryParameters),
    /// The visible set alone, found beforehand.
    Ideal(IdealSet),
}

/// Whose visible set an ideal draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdealSet {
    /// That of the exact item buffer (Zhang 1998, 8.3.1).
    Exact,
    /// That of stop-and-wait (Bittner et al. 2004, section 5): the best on the same hierarchy.
    StopAndWait,
}

/// Parameters of `hzb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HzbParameters {
    /// Whether what was visible in the previous frame is drawn first.
    pub previous_first: bool,
}

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

/// What `homcull methods` says of one.
#[derive(Debug, Clone, Copy)]
pub struct MethodDescription {
    /// Its name.
    pub name: &'static str,
    /// Where it is from.
    pub source: &'static str,
    /// What it promises.
    pub guarantee: &'static str,
    /// Parameters with their values, the default first.
    pub parameters: &'static str,
    /// When to use it.
    pub when: &'static str,
}

/// What all hom methods take.
macro_rules! hom_parameters {
    () => {
        concat!(
            "depth=nbz|nbz-block|deb|plane, deb-size=64x64 (with deb), resolution=WxH (the display's), \
             occluders=original|simplified|lod, share=0.1 (with simplified), lod=4 (pixels; approximate), bypass=384, rest=15, pipeline=off|on, \
             lag=1 (3 with pipeline=on), ",
            overlap_parameters!()
        )
    };
}

/// All methods.
pub fn methods() -> &'static [MethodDescription] {
    &[
        MethodDescription {
            name: "vfc",
            source: "view-frustum culling, hierarchical with plane masking",
            guarantee: "conservative",
            parameters: "none",
            when: "the baseline; open scenes need no more",
        },
        MethodDescription {
            name: "hom",
            source: "Zhang 1998, chapters 3 to 7: one pass (2.1.4)",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: concat!(
                "select=distance|nearest|zplane|temporal|baked, bake=FILE, snap=1, fill=on|off, occluder-triangles=25000, z=50, \
                 database=all|static, with static: static-size=0.001, static-locality=off, static-aspect=off, \
                 static-complexity=6250, static-redundancy=0.95; update=once|batches|always, and: ",
                hom_parameters!()
            ),
            when: "near objects hide most of the rest; occluders can be drawn on other threads",
        },
        MethodDescription {
            name: "hom-multipass",
            source: "Zhang 1998, 2.1.4 and figure 2.4",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: "update-triangles=2000, and those of hom-progressive",
            when: "updates are dear",
        },
        MethodDescription {
            name: "hom-progressive",
            source: "Zhang 1998, 2.1.4 and figure 2.3, through the hierarchy",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: hom_parameters!(),
            when: "the first choice where anything is hidden",
        },
        MethodDescription {
            name: "plp",
            source: "Correa, Klosowski and Silva 2002; Klosowski and Silva 2000",
            guarantee: "approximate: what the budget does not reach is missing",
            parameters: "budget=140000 (triangles), heuristic=layer|solidity, cells=octree|bvh, leaf=1000 (triangles of an octree's leaf)",
            when: "a frame may take so long and no longer, and some pixels may be wrong",
        },
        MethodDescription {
            name: "cplp",
            source: "Correa, Klosowski and Silva 2002, with a query for each node",
            guarantee: "conservative",
            parameters: "budget=140000 (triangles of the first guess), heuristic=layer|solidity, leaf=1000",
            when: "now and then, the view that plp has without its wrong pixels; slower than vfc on the plant",
        },
        MethodDescription {
            name: "portals",
            source: "Luebke and Georges 1995; Russin's lecture, portal culling",
            guarantee: "conservative for cells whose walls have no cracks",
            parameters: "clip=polygon|rectangle",
            when: "indoors, where the scene has cells: nothing is drawn for it",
        },
        MethodDescription {
            name: "horizons",
            source: "Downs et al. 2001, in Russin's lecture: occlusion horizons; intervals of azimuth and slope, upright boxes inside what is drawn",
            guarantee: "conservative as sets of points; of closed opaque objects, y up",
            parameters: "none",
            when: "cities of closed buildings, from the street; nothing is drawn to decide",
        },
        MethodDescription {
            name: "hzb",
            source: "Greene, Kass and Miller 1993, in Zhang 1998, 2.2.3.5: the Z-buffer of the final draw, through the hierarchy",
            guarantee: "conservative",
            parameters: "first=none|previous",
            when: "the CPU draws the picture: occluders cost nothing extra",
        },
        MethodDescription {
            name: "stop-and-wait",
            source: "Bittner et al. 2004, 2.3, with occlusion queries in software",
            guarantee: "conservative with pixels=0",
            parameters: "latency=0 (steps) or thread, pixels=0, order=priority|depth",
            when: "to measure chc by",
        },
        MethodDescription {
            name: "chc",
            source: "Bittner et al. 2004: coherent hierarchical culling",
            guarantee: "conservative with pixels=0",
            parameters: "latency=0 (steps) or thread, pixels=0, assume-visible=0 (frames), order=priority|depth, speculate=off|on",
            when: "answers come late, as from a GPU or another thread, and views change little",
        },
        MethodDescription {
            name: "ideal",
            source: "Zhang 1998, 8.3.1: the objects of an exact item buffer; Bittner et al. 2004: those of stop-and-wait",
            guarantee: "exact; its set is computed beforehand and not timed",
            parameters: "set=exact|stop-and-wait",
            when: "to see what any method could gain at most",
        },
    ]
}

impl Method {
    /// Reads a method as written: `NAME[:key=value,...]`.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the method, key or value that is not known.
    pub fn parse(text: &str) -> Result<Method> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let mut method = match name {
            "vfc" => Method::Vfc,
            "hom" => Method::Hom(HomParameters::new(Update::Once)),
            "hom-multipass" => Method::Hom(HomParameters::new(Update::Batches(DEFAULT_UPDATE_TRIANGLES))),
            "hom-progressive" => Method::Hom(HomParameters::new(Update::Always)),
            "plp" => Method::Plp(PlpParameters::default()),
            "cplp" => Method::Cplp(PlpParameters::default()),
            "portals" => Method::Portals(PortalParameters::default()),
            "horizons" => Method::Horizons,
            "hzb" => Method::Hzb(HzbParameters::default()),
            "stop-and-wait" => Method::Queries(QueryParameters::new(false)),
            "chc" => Method::Queries(QueryParameters::new(true)),
            "ideal" => Method::Ideal(IdealSet::Exact),
            _ => {
                let known: Vec<_> = methods().iter().map(|m| m.name).collect();
                return Err(Error::parameter("method", name, format!("known are {}", known.join(", "))));
            }
        };
        for part in parameters.split(',').filter(|p| !p.is_empty()) {
            let (key, value) =
                part.split_once('=').ok_or_else(|| Error::parameter("method parameter", part, "must be key=value"))?;
            method.set(name, key, value)?;
        }
        if let Method::Hom(p) = &method {
            if p.select == Selection::Baked && p.bake.is_none() {
                return Err(Error::parameter("select", "baked", "needs bake=FILE, from `homcull bake`"));
            }
            p.check()?;
            p.overlap.check(parameters)?;
        }
        if let Method::Cplp(p) = &method {
            p.check_conservative()?;
        }
        Ok(method)
    }

    fn set(&mut self, name: &str, key: &str, value: &str) -> Result<()> {
        let unknown = || Error::parameter(format!("{name} parameter"), key, "not known; see `homcull methods`");
        match self {
            Method::Vfc | Method::Horizons => Err(unknown()),
            Method::Ideal(set) => {
                *set = match (key, value) {
                    ("set", "exact") => IdealSet::Exact,
                    ("set", "stop-and-wait") => IdealSet::StopAndWait,
                    ("set", _) => return Err(Error::parameter("set", value, "exact or stop-and-wait")),
                    _ => return Err(unknown()),
                };
                Ok(())
            }
            Method::Plp(p) | Method::Cplp(p) => p.set(key, value, unknown),
            Method::Portals(p) => p.set(key, value, unknown),
            Method::Queries(p) => p.set(key, value, unknown),
            Method::Hzb(p) => match (key, value) {
                ("first", "none" | "previous") => {
                    p.previous_first = value == "previous";
                    Ok(())
                }
                ("first", _) => Err(Error::parameter("first", value, "none or previous")),
                _ => Err(unknown()),
            },
            Method::Hom(p) => p.set(key, value, unknown),
        }
    }

    /// The name without parameters.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Vfc => "vfc",
            Method::Plp(_) => "plp",
            Method::Cplp(_) => "cplp",
            Method::Portals(_) => "portals",
            Method::Horizons => "horizons",
            Method::Hzb(_) => "hzb",
            Method::Queries(p) if p.coherent => "chc",
            Method::Queries(_) => "stop-and-wait",
            Method::Ideal(_) => "ideal",
            Method::Hom(p) => match p.update {
                Update::Once => "hom",
                Update::Batches(_) => "hom-multipass",
                Update::Always => "hom-progressive",
            },
        }
    }

    /// All parameters with their values.
    pub fn parameters(&self) -> Vec<(String, String)> {
        match self {
            Method::Vfc | Method::Horizons => Vec::new(),
            Method::Hzb(p) => {
                vec![("first".into(), if p.previous_first { "previous" } else { "none" }.into())]
            }
            Method::Plp(p) | Method::Cplp(p) => p.list(),
            Method::Portals(p) => p.list(),
            Method::Queries(p) => p.list(),
            Method::Ideal(set) => {
                let set = if *set == IdealSet::Exact { "exact" } else { "stop-and-wait" };
                vec![("set".into(), set.into())]
            }
            Method::Hom(p) => p.list(),
        }
    }
}

impl HomParameters {
    fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
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

    fn list(&self) -> Vec<(String, String)> {
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
