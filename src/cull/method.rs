//! Methods by name and parameters, as they are written on the command line: `hom:depth=nbz,threshold=0.85`.

use crate::error::{Error, Result};
use crate::occlusion::{
    ActiveLevels, DEFAULT_DISTRIBUTION, DepthReading, OcclusionSettings, PyramidShape, Thresholds,
    next_opacity_threshold, opacity_threshold,
};
use crate::select::{DEFAULT_TRIANGLES, Measure};
use crate::view::Viewport;

/// A method and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// View-frustum culling alone.
    Vfc,
    /// Hierarchical occlusion maps.
    Hom(HomParameters),
    /// The exact visible set.
    Ideal,
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
}

/// The L-k-hole constraint: at most so many open samples in any window of the size of a level-k pixel are no hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hole {
    /// L, in samples; below the samples of the pixel.
    pub samples: u32,
    /// k, at most the finest active level, which it is when `None`.
    pub level: Option<usize>,
}

/// Parameters of the hom methods.
#[derive(Debug, Clone, PartialEq)]
pub struct HomParameters {
    /// When the representation is updated.
    pub update: Update,
    /// How depth is read.
    pub depth: DepthReading,
    /// How occluders are chosen.
    pub select: Selection,
    /// Triangles of the chosen occluders, at most.
    pub occluder_triangles: u64,
    /// Samples of the occlusion buffer; the display's when `None`. Others are not conservative.
    pub resolution: Option<Viewport>,
    /// Opacity threshold of the finest active level, above 0 and at most 1. Below 1 is not conservative.
    pub threshold: f64,
    /// The L-k-hole constraint, from which the threshold then follows (5.3.3.1).
    pub hole: Option<Hole>,
    /// The distribution factor D, 1 to 4: how thresholds follow from level to level.
    pub distribution: f64,
    /// Transparency threshold of the finest active level, 0 up to its opacity threshold: conservative rejection.
    pub transparency: f64,
    /// Levels that overlap tests use (8.2.4). When given, tests walk the pyramid even at thresholds of 1, and are counted by the
    /// level that decides them.
    pub levels: Option<ActiveLevels>,
    /// Whether opacity thresholds are raised by contrast (5.3.2).
    pub contrast: bool,
    /// Block of samples of a level-0 pixel, and minimal resolution of the pyramid (4.1, 4.2).
    pub pyramid: PyramidShape,
    /// The opacity from which translucent occluders count together as covering a sample (4.4); `None` leaves them out. Not
    /// conservative where the draw shows what shines through.
    pub fusion: Option<f64>,
    /// Consecutive tests without a hidden object after which testing ends for the frame.
    pub bypass_after: u32,
    /// Frames that culling rests after one that hid next to nothing; 0 never rests.
    pub rest: u32,
}

/// Update size of `hom-multipass`, in triangles.
pub const DEFAULT_UPDATE_TRIANGLES: u64 = 2_000;
/// Distance of the z-plane, in scene units.
pub const DEFAULT_Z_PLANE: f32 = 50.0;
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
            depth: DepthReading::PerSample,
            select: Selection::Distance(Measure::Center),
            occluder_triangles: DEFAULT_TRIANGLES,
            resolution: None,
            threshold: 1.0,
            hole: None,
            distribution: DEFAULT_DISTRIBUTION,
            transparency: 0.0,
            levels: None,
            contrast: false,
            pyramid: PyramidShape::default(),
            fusion: None,
            bypass_after: DEFAULT_BYPASS,
            rest: DEFAULT_REST,
        }
    }

    /// True when the picture is guaranteed to stay the same.
    pub fn is_conservative(&self) -> bool {
        self.threshold == 1.0 && self.hole.is_none() && self.fusion.is_none() && self.resolution.is_none()
    }

    /// Opacity and transparency thresholds of the active levels.
    ///
    /// # Errors
    /// [`Error::Parameter`] when L, k, D or a threshold does not go with the others.
    pub fn thresholds(&self) -> Result<Thresholds> {
        let finest = self.levels.map_or(0, |levels| levels.finest);
        let opacity = match self.hole {
            None => self.threshold,
            Some(hole) => {
                let k = hole.level.unwrap_or(finest);
                if k > finest {
                    let reason =
                        format!("at most {finest}, the finest active level: finer ones would have no threshold");
                    return Err(Error::parameter("k", k, reason));
                }
                let pixel = self.pyramid.block_samples().saturating_mul(1 << (2 * k.min(31)));
                let at_k = opacity_threshold(hole.samples, pixel, self.distribution)?;
                (k..finest).fold(at_k, |t, _| next_opacity_threshold(t, self.distribution))
            }
        };
        let thresholds = match opacity {
            1.0 => Thresholds::conservative(),
            t => Thresholds::from_finest(t, self.distribution)?,
        };
        thresholds.with_transparency(self.transparency, self.distribution)
    }

    /// The buffer's settings.
    ///
    /// # Errors
    /// Those of [`HomParameters::thresholds`].
    pub fn occlusion_settings(&self) -> Result<OcclusionSettings> {
        Ok(OcclusionSettings {
            thresholds: self.thresholds()?,
            depth: self.depth,
            levels: self.levels,
            contrast: self.contrast,
            pyramid: self.pyramid,
            fusion: self.fusion,
            ..OcclusionSettings::default()
        })
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

/// What all hom methods take, said once.
macro_rules! hom_parameters {
    () => {
        "depth=nbz|nbz-block, threshold=1 (0 to 1, of the finest active level) or hole=L with k=K, d=2 (1 to 4), \
         transparency=0 (to the threshold), levels=A-B (all), contrast=off|on, block=8x8, minimal=1x1, fusion=off|OPACITY, \
         resolution=WxH (the display's), bypass=384, rest=15"
    };
}

const HOM_PARAMETERS: &str = hom_parameters!();

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
                "select=distance|nearest|zplane, occluder-triangles=25000, z=50, update=once|batches|always, and: ",
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
            parameters: HOM_PARAMETERS,
            when: "the first choice where anything is hidden",
        },
        MethodDescription {
            name: "ideal",
            source: "Zhang 1998, 8.3.1: the objects of an exact item buffer",
            guarantee: "exact; its set is computed beforehand and not timed",
            parameters: "set=exact",
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
            "ideal" => Method::Ideal,
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
            p.check(parameters)?;
        }
        Ok(method)
    }

    fn set(&mut self, name: &str, key: &str, value: &str) -> Result<()> {
        let unknown = || Error::parameter(format!("{name} parameter"), key, "not known; see `homcull methods`");
        match self {
            Method::Vfc => Err(unknown()),
            Method::Ideal => match (key, value) {
                ("set", "exact") => Ok(()),
                ("set", _) => Err(Error::parameter("set", value, "exact")),
                _ => Err(unknown()),
            },
            Method::Hom(p) => p.set(key, value, unknown),
        }
    }

    /// The name without parameters.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Vfc => "vfc",
            Method::Ideal => "ideal",
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
            Method::Vfc => Vec::new(),
            Method::Ideal => vec![("set".into(), "exact".into())],
            Method::Hom(p) => p.list(),
        }
    }
}

impl HomParameters {
    fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        let bad = |reason: &str| Error::parameter(key, value, reason);
        let number = |what: &str| value.parse::<u64>().map_err(|_| bad(what));
        match (key, value) {
            ("depth", "nbz") => self.depth = DepthReading::PerSample,
            ("depth", "nbz-block") => self.depth = DepthReading::PerBlock,
            ("depth", _) => return Err(bad("nbz or nbz-block")),
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
            ("select", _) => return Err(bad("distance, nearest or zplane")),
            ("z", _) => {
                let z = value
                    .parse::<f32>()
                    .ok()
                    .filter(|z| z.is_finite() && *z > 0.0)
                    .ok_or_else(|| bad("a distance above 0"))?;
                self.select = Selection::ZPlane(z);
            }
            ("occluder-triangles", _) => self.occluder_triangles = number("a number of triangles")?,
            ("threshold", _) => {
                let t = value.parse::<f64>().ok().filter(|t| *t > 0.0 && *t <= 1.0);
                self.threshold = t.ok_or_else(|| bad("an opacity above 0 and at most 1"))?;
            }
            ("hole", _) => {
                let samples = number("a number of samples")?;
                let samples = u32::try_from(samples).map_err(|_| bad("a number of samples"))?;
                self.hole = Some(Hole { samples, level: self.hole.and_then(|h| h.level) });
            }
            ("k", _) => {
                let level = Some(level_number(value).ok_or_else(|| bad("a level, 0 to 15"))?);
                self.hole = Some(Hole { samples: self.hole.map_or(0, |h| h.samples), level });
            }
            ("d", _) => {
                let d = value.parse::<f64>().ok().filter(|d| (1.0..=4.0).contains(d));
                self.distribution = d.ok_or_else(|| bad("a distribution factor from 1 to 4"))?;
            }
            ("transparency", _) => {
                let t = value.parse::<f64>().ok().filter(|t| (0.0..=1.0).contains(t));
                self.transparency = t.ok_or_else(|| bad("an opacity from 0 to the opacity threshold"))?;
            }
            ("levels", _) => {
                self.levels = Some(parse_levels(value).ok_or_else(|| bad("A-B or A-, A at most B, to 15"))?)
            }
            ("contrast", "on") => self.contrast = true,
            ("contrast", "off") => self.contrast = false,
            ("contrast", _) => return Err(bad("on or off")),
            ("block", _) => self.pyramid.block = parse_pair(value).ok_or_else(|| bad("MxN, in samples"))?,
            ("minimal", _) => self.pyramid.minimal = parse_pair(value).ok_or_else(|| bad("WxH, in pixels"))?,
            ("fusion", "off") => self.fusion = None,
            ("fusion", _) => {
                let t = value.parse::<f64>().ok().filter(|t| *t > 0.0 && *t < 1.0);
                self.fusion = Some(t.ok_or_else(|| bad("off, or an opacity above 0 and below 1"))?);
            }
            ("resolution", _) => self.resolution = Some(parse_resolution(value)?),
            ("bypass", _) => {
                let n = number("a number of tests")?;
                self.bypass_after = u32::try_from(n).ok().filter(|&n| n > 0).ok_or_else(|| bad("1 to 4294967295"))?;
            }
            ("rest", _) => {
                let n = number("a number of frames")?;
                self.rest = u32::try_from(n).map_err(|_| bad("0 to 4294967295"))?;
            }
            _ => return Err(unknown()),
        }
        Ok(())
    }

    /// What goes with what, of the parameters as written.
    fn check(&self, written: &str) -> Result<()> {
        let given = |key: &str| written.split(',').any(|part| part.split_once('=').is_some_and(|(k, _)| k == key));
        let value = |key: &str| {
            let of = |part: &str| part.split_once('=').filter(|(k, _)| *k == key).map(|(_, v)| v.to_owned());
            written.split(',').find_map(of).unwrap_or_default()
        };
        let bad = |key: &str, reason: &str| Err(Error::parameter(key, value(key), reason));
        if given("threshold") && given("hole") {
            return bad("threshold", "goes without hole=, from which it would follow");
        }
        if given("k") && !given("hole") {
            return bad("k", "goes with hole=");
        }
        let below_1 = self.threshold < 1.0 || self.hole.is_some();
        if given("d") && !below_1 && self.transparency == 0.0 {
            return bad("d", "goes with a threshold below 1, hole= or transparency=");
        }
        if self.contrast && !below_1 {
            return bad("contrast", "raises thresholds below 1: goes with threshold= or hole=");
        }
        self.pyramid.check()?;
        self.thresholds().map(|_| ())
    }

    /// What differs from the plain threshold of 1 is listed where it does.
    fn list_thresholds(&self, out: &mut Vec<(&'static str, String)>) {
        match self.hole {
            None => out.push(("threshold", self.threshold.to_string())),
            Some(hole) => {
                out.push(("hole", hole.samples.to_string()));
                out.extend(hole.level.map(|k| ("k", k.to_string())));
            }
        }
        if self.threshold < 1.0 || self.hole.is_some() || self.transparency > 0.0 {
            out.push(("d", self.distribution.to_string()));
        }
        if self.transparency > 0.0 {
            out.push(("transparency", self.transparency.to_string()));
        }
        if let Some(levels) = self.levels {
            let to = levels.coarsest.map(|b| b.to_string()).unwrap_or_default();
            out.push(("levels", format!("{}-{to}", levels.finest)));
        }
        if self.contrast {
            out.push(("contrast", "on".into()));
        }
        let plain = PyramidShape::default();
        for (name, pair, default) in
            [("block", self.pyramid.block, plain.block), ("minimal", self.pyramid.minimal, plain.minimal)]
        {
            if pair != default {
                out.push((name, format!("{}x{}", pair[0], pair[1])));
            }
        }
        out.extend(self.fusion.map(|t| ("fusion", t.to_string())));
    }

    fn list(&self) -> Vec<(String, String)> {
        let mut out: Vec<(&str, String)> = Vec::new();
        out.push(("depth", if self.depth == DepthReading::PerSample { "nbz" } else { "nbz-block" }.into()));
        match self.update {
            Update::Once => {
                let select = match self.select {
                    Selection::Distance(Measure::Center) => "distance",
                    Selection::Distance(Measure::Nearest) => "nearest",
                    Selection::ZPlane(_) => "zplane",
                };
                out.push(("select", select.into()));
                match self.select {
                    Selection::ZPlane(z) => out.push(("z", z.to_string())),
                    Selection::Distance(_) => out.push(("occluder-triangles", self.occluder_triangles.to_string())),
                }
            }
            Update::Batches(n) => out.push(("update-triangles", n.to_string())),
            Update::Always => {}
        }
        if let Some(v) = self.resolution {
            out.push(("resolution", format!("{}x{}", v.width(), v.height())));
        }
        self.list_thresholds(&mut out);
        out.push(("bypass", self.bypass_after.to_string()));
        out.push(("rest", self.rest.to_string()));
        out.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
    }
}

fn level_number(text: &str) -> Option<usize> {
    text.parse::<usize>().ok().filter(|&level| level <= 15)
}

fn parse_levels(text: &str) -> Option<ActiveLevels> {
    let (finest, coarsest) = text.split_once('-')?;
    let finest = level_number(finest)?;
    let coarsest = if coarsest.is_empty() { None } else { Some(level_number(coarsest)?) };
    coarsest.is_none_or(|c| c >= finest).then_some(ActiveLevels { finest, coarsest })
}

fn parse_pair(text: &str) -> Option<[u32; 2]> {
    let (a, b) = text.split_once('x')?;
    Some([a.parse().ok()?, b.parse().ok()?])
}

fn parse_resolution(value: &str) -> Result<Viewport> {
    let sides = value.split_once('x').and_then(|(w, h)| Some((w.parse::<u64>().ok()?, h.parse::<u64>().ok()?)));
    let (width, height) = sides.ok_or_else(|| Error::parameter("resolution", value, "WxH, in samples"))?;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) => Viewport::new(w, h),
        _ => Err(Error::Size { width, height }),
    }
}
