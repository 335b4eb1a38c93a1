//! Parameters of the overlap test, as they are written on the command line (Zhang 1998, chapters 4 and 5).
//!
//! `threshold=T`, or `hole=L` with `k=K`, sets the opacity threshold of the finest active level, `d=D` those of the others,
//! `transparency=T` conservative rejection, `levels=A-B` the active levels; `contrast=on` raises thresholds, `block=MxN` and
//! `minimal=WxH` form the pyramid, `fusion=OPACITY` lets translucent occluders count together.

use crate::error::{Error, Result};
use crate::occlusion::{
    ActiveLevels, DEFAULT_DISTRIBUTION, OcclusionSettings, PyramidShape, Thresholds, next_opacity_threshold,
    opacity_threshold,
};

/// The parameters with their defaults, as `homcull methods` prints them.
macro_rules! overlap_parameters {
    () => {
        "threshold=1 (0 to 1, of the finest active level) or hole=L with k=K, d=2 (1 to 4), transparency=0 (to the \
         threshold), levels=A-B (all), contrast=off|on, block=8x8, minimal=1x1, fusion=off|OPACITY"
    };
}
pub(super) use overlap_parameters;

/// The L-k-hole constraint: at most so many open samples in any window of the size of a level-k pixel are no hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hole {
    /// L, in samples; below the samples of the pixel.
    pub samples: u32,
    /// k, at most the finest active level, which it is when `None`.
    pub level: Option<usize>,
}

/// How rectangles are tested against the occlusion maps.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlapParameters {
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
}

impl Default for OverlapParameters {
    fn default() -> Self {
        OverlapParameters {
            threshold: 1.0,
            hole: None,
            distribution: DEFAULT_DISTRIBUTION,
            transparency: 0.0,
            levels: None,
            contrast: false,
            pyramid: PyramidShape::default(),
            fusion: None,
        }
    }
}

impl OverlapParameters {
    /// True when nothing is taken for covered that is not.
    pub fn is_conservative(&self) -> bool {
        self.threshold == 1.0 && self.hole.is_none_or(|hole| hole.samples == 0) && self.fusion.is_none()
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

    /// The settings of a buffer, as far as they are of the overlap test.
    ///
    /// # Errors
    /// Those of [`OverlapParameters::thresholds`].
    pub fn settings(&self) -> Result<OcclusionSettings> {
        Ok(OcclusionSettings {
            thresholds: self.thresholds()?,
            levels: self.levels,
            contrast: self.contrast,
            pyramid: self.pyramid,
            fusion: self.fusion,
            ..OcclusionSettings::default()
        })
    }

    /// Sets a parameter as written; false when it is none of these.
    pub(super) fn set(&mut self, key: &str, value: &str) -> Result<bool> {
        let bad = |reason: &str| Error::parameter(key, value, reason);
        let number = || value.parse::<f64>().ok();
        match key {
            "threshold" => {
                let t = number().filter(|t| *t > 0.0 && *t <= 1.0);
                self.threshold = t.ok_or_else(|| bad("an opacity above 0 and at most 1"))?;
            }
            "hole" => {
                let samples = value.parse().map_err(|_| bad("a number of samples"))?;
                self.hole = Some(Hole { samples, level: self.hole.and_then(|h| h.level) });
            }
            "k" => {
                let level = Some(level_number(value).ok_or_else(|| bad("a level, 0 to 15"))?);
                self.hole = Some(Hole { samples: self.hole.map_or(0, |h| h.samples), level });
            }
            "d" => {
                let d = number().filter(|d| (1.0..=4.0).contains(d));
                self.distribution = d.ok_or_else(|| bad("a distribution factor from 1 to 4"))?;
            }
            "transparency" => {
                let t = number().filter(|t| (0.0..=1.0).contains(t));
                self.transparency = t.ok_or_else(|| bad("an opacity from 0 to the opacity threshold"))?;
            }
            "levels" => {
                self.levels = Some(levels(value).ok_or_else(|| bad("A-B or A-, A at most B, B at most 15"))?);
            }
            "contrast" => {
                self.contrast = match value {
                    "on" => true,
                    "off" => false,
                    _ => return Err(bad("on or off")),
                }
            }
            "block" => self.pyramid.block = pair(value).ok_or_else(|| bad("MxN, in samples"))?,
            "minimal" => self.pyramid.minimal = pair(value).ok_or_else(|| bad("WxH, in pixels"))?,
            "fusion" => {
                let opacity = number().filter(|t| *t > 0.0 && *t < 1.0);
                self.fusion = match value {
                    "off" => None,
                    _ => Some(opacity.ok_or_else(|| bad("off, or an opacity above 0 and below 1"))?),
                };
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// What goes with what, of all parameters of a method as written.
    pub(super) fn check(&self, written: &str) -> Result<()> {
        let given = |key: &str| {
            let mut pairs = written.split(',').filter_map(|part| part.split_once('='));
            pairs.find(|(k, _)| *k == key).map(|(_, value)| value)
        };
        let below_1 = self.threshold < 1.0 || self.hole.is_some();
        if let (Some(value), Some(_)) = (given("threshold"), given("hole")) {
            return Err(Error::parameter("threshold", value, "goes without hole=, from which it would follow"));
        }
        if let (Some(value), None) = (given("k"), given("hole")) {
            return Err(Error::parameter("k", value, "goes with hole="));
        }
        if let Some(value) = given("d").filter(|_| !below_1 && self.transparency == 0.0) {
            return Err(Error::parameter("d", value, "goes with a threshold below 1, hole= or transparency="));
        }
        if self.contrast && !below_1 {
            return Err(Error::parameter("contrast", "on", "raises thresholds: goes with one below 1, or hole="));
        }
        self.pyramid.check()?;
        self.thresholds().map(|_| ())
    }

    /// The threshold, and what else differs from the defaults.
    pub(super) fn list(&self, out: &mut Vec<(&'static str, String)>) {
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
        let shape = [("block", self.pyramid.block, plain.block), ("minimal", self.pyramid.minimal, plain.minimal)];
        for (name, [a, b], default) in shape {
            if [a, b] != default {
                out.push((name, format!("{a}x{b}")));
            }
        }
        out.extend(self.fusion.map(|t| ("fusion", t.to_string())));
    }
}

fn level_number(text: &str) -> Option<usize> {
    text.parse().ok().filter(|&level| level <= 15)
}

fn levels(text: &str) -> Option<ActiveLevels> {
    let (finest, coarsest) = text.split_once('-')?;
    let finest = level_number(finest)?;
    let coarsest = if coarsest.is_empty() { None } else { Some(level_number(coarsest)?) };
    coarsest.is_none_or(|c| c >= finest).then_some(ActiveLevels { finest, coarsest })
}

fn pair(text: &str) -> Option<[u32; 2]> {
    let (a, b) = text.split_once('x')?;
    Some([a.parse().ok()?, b.parse().ok()?])
}

#[cfg(test)]
mod tests {
    use crate::cull::{HomParameters, Method};

    fn parse(text: &str) -> Result<HomParameters, String> {
        match Method::parse(text) {
            Ok(Method::Hom(p)) => Ok(p),
            Ok(_) => Err("no hom method".into()),
            Err(e) => Err(e.to_string()),
        }
    }

    #[test]
    fn the_machine_room_of_8_4_2_by_its_two_pyramids() {
        // Level-0 pixels of 20x16 samples; or the 256x256 map, whose level 2 is the finest active one.
        for text in ["hom:block=20x16,hole=96,minimal=4x4", "hom:block=5x4,hole=96,levels=2-6,minimal=4x4"] {
            let thresholds = parse(text).unwrap().overlap.thresholds().unwrap();
            for (level, should) in [0.85, 0.925, 0.9625, 0.98125, 0.990625].into_iter().enumerate() {
                assert!((thresholds.opacity(level) - should).abs() < 1e-12, "{text}: {thresholds:?}");
            }
        }
        // The same threshold by k: a constraint on level-0 pixels, two steps below the finest active level.
        let by_k = parse("hom:block=5x4,hole=8,k=0,d=2,levels=2-").unwrap().overlap.thresholds().unwrap();
        assert!((by_k.opacity(0) - (1.0 - 0.2 / 4.0)).abs() < 1e-12, "{by_k:?}");
    }

    #[test]
    fn what_was_written_is_listed() {
        let listed = |text: &str| {
            let mut out = Vec::new();
            parse(text).unwrap().overlap.list(&mut out);
            out.into_iter().map(|(k, v)| format!("{k}={v}")).collect::<Vec<_>>().join(",")
        };
        assert_eq!(listed("hom"), "threshold=1");
        assert_eq!(listed("hom:threshold=0.85"), "threshold=0.85,d=2");
        let all = "hole=9,k=1,d=1.5,transparency=0.1,levels=1-4,contrast=on,block=20x16,minimal=4x4,fusion=0.98";
        assert_eq!(listed(&format!("hom-progressive:{all}")), all);
        assert_eq!(listed("hom:transparency=0.25,levels=2-"), "threshold=1,d=2,transparency=0.25,levels=2-");
    }

    #[test]
    fn what_does_not_go_together_is_refused() {
        for (parameters, name) in [
            ("threshold=0.9,hole=9", "threshold"),
            ("k=1", "k"),
            ("hole=9,k=1", "k"),
            ("d=2", "d"),
            ("threshold=0.9,d=5", "d"),
            ("hole=64", "hole"),
            ("hole=9x", "hole"),
            ("contrast=on", "contrast"),
            ("contrast=yes,threshold=0.9", "contrast"),
            ("threshold=0.5,transparency=0.6", "transparency"),
            ("transparency=-1", "transparency"),
            ("levels=3-2", "levels"),
            ("levels=3", "levels"),
            ("levels=0-16", "levels"),
            ("block=0x8", "block"),
            ("block=8", "block"),
            ("minimal=4x99999", "minimal"),
            ("fusion=1", "fusion"),
            ("fusion=on", "fusion"),
        ] {
            let error = parse(&format!("hom:{parameters}")).unwrap_err();
            assert!(error.starts_with(&format!("{name} '")), "{parameters}: {error}");
        }
    }

    #[test]
    fn conservative_is_what_takes_nothing_for_covered() {
        for (text, conservative) in [
            ("hom", true),
            ("hom:levels=2-4", true),
            ("hom:transparency=0.5,block=20x16", true),
            ("hom:hole=0", true),
            ("hom:hole=1", false),
            ("hom:threshold=0.999", false),
            ("hom:fusion=0.99", false),
            ("hom:resolution=64x64", false),
        ] {
            assert_eq!(parse(text).unwrap().is_conservative(), conservative, "{text}");
        }
    }
}
