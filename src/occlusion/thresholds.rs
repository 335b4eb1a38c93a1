//! Opacity and transparency thresholds, one a level (Zhang 1998, 5.3.1 to 5.3.3).
//!
//! A pixel counts as opaque when its opacity reaches the *opacity threshold* of its level (aggressive approximate culling), and
//! as transparent when it lies below the *transparency threshold* (conservative rejection). Both follow from one value at the
//! finest active level and the **distribution factor** D: a pixel of the next level may have D times as many holes, in four
//! times the area, so `T' = 1 - D (1 - T) / 4`, and `t' = D t / 4`. D is 1 where holes lie as badly as they can, 4 where they
//! are scattered evenly. The value itself may be given as the size of a negligible hole, the **L-k-hole constraint**: at most L
//! open samples in any window of the size of a level-k pixel, hence `T = 1 - D L / (4 m n)`.
//!
//! Invariant: opacity thresholds do not fall with the level and no transparency threshold lies above an opacity threshold,
//! so that predictive rejection foretells what descending would find. Thresholds are turned into whole numbers of holes once
//! ([`Limits`]); the test compares integers.

use crate::error::{Error, Result};

/// The distribution factor that the thesis usually sets (5.3.3.1).
pub const DEFAULT_DISTRIBUTION: f64 = 2.0;

/// Levels that thresholds are listed for. The last one holds for all beyond; no pyramid has more.
const LEVELS: usize = 16;

/// The opacity threshold of the L-k-hole constraint: `1 - D L / (4 m n)`, for level-k pixels of `pixel_samples` = m n samples.
///
/// # Errors
/// [`Error::Parameter`] when L is not below `pixel_samples`, or D is not 1 to 4.
pub fn opacity_threshold(hole: u32, pixel_samples: u64, distribution: f64) -> Result<f64> {
    check_distribution(distribution)?;
    if u64::from(hole) >= pixel_samples {
        return Err(Error::parameter("hole", hole, format!("below the {pixel_samples} samples of a pixel")));
    }
    Ok(1.0 - distribution * f64::from(hole) / (4.0 * pixel_samples as f64))
}

/// The transparency threshold that ignores clusters of at most L covered samples: `D L / (4 m n)`, 5.3.3.2.
///
/// # Errors
/// [`Error::Parameter`] when L is not below `pixel_samples`, or D is not 1 to 4.
pub fn transparency_threshold(cluster: u32, pixel_samples: u64, distribution: f64) -> Result<f64> {
    Ok(1.0 - opacity_threshold(cluster, pixel_samples, distribution)?)
}

/// The opacity threshold of the next coarser level: `1 - D (1 - T) / 4`.
pub fn next_opacity_threshold(threshold: f64, distribution: f64) -> f64 {
    1.0 - distribution * (1.0 - threshold) / 4.0
}

/// A threshold raised by contrast: `T' = T + (1 - T) c`, c from 0 to 1 (5.3.2).
pub fn raised_by_contrast(threshold: f64, contrast: f64) -> f64 {
    threshold + (1.0 - threshold) * contrast
}

fn check_distribution(distribution: f64) -> Result<()> {
    match (1.0..=4.0).contains(&distribution) {
        true => Ok(()),
        false => Err(Error::parameter("d", distribution, "a distribution factor from 1 to 4")),
    }
}

fn check_opacity(threshold: f64) -> Result<()> {
    match threshold > 0.0 && threshold <= 1.0 {
        true => Ok(()),
        false => Err(Error::parameter("threshold", threshold, "an opacity above 0 and at most 1")),
    }
}

/// What counts as opaque and as transparent at each active level, the finest active level first.
#[derive(Debug, Clone, PartialEq)]
pub struct Thresholds {
    /// Never falls; what is past the end is as the last, and 1 where there is none.
    opacity: Vec<f64>,
    /// Never rises; what is past the end is 0.
    transparency: Vec<f64>,
}

impl Default for Thresholds {
    fn default() -> Self {
        Thresholds::conservative()
    }
}

impl Thresholds {
    /// Every level opaque at 1 and transparent at 0 alone: conservative, and as precise as the map.
    pub fn conservative() -> Thresholds {
        Thresholds { opacity: Vec::new(), transparency: Vec::new() }
    }

    /// One opacity threshold for all levels, above 0 and at most 1: holes scattered evenly, D = 4.
    ///
    /// # Errors
    /// [`Error::Parameter`] when `t` is out of range.
    pub fn uniform(t: f64) -> Result<Thresholds> {
        Thresholds::from_finest(t, 4.0)
    }

    /// An opacity threshold of the finest active level, above 0 and at most 1; the coarser ones follow by D, 1 to 4.
    ///
    /// # Errors
    /// [`Error::Parameter`] when one of them is out of range.
    pub fn from_finest(t: f64, distribution: f64) -> Result<Thresholds> {
        check_opacity(t)?;
        check_distribution(distribution)?;
        let mut opacity = vec![t; LEVELS];
        for level in 1..LEVELS {
            // D of 4 leaves a threshold as it is, to the bit; rounding never lets one fall.
            if distribution < 4.0 {
                opacity[level] = next_opacity_threshold(opacity[level - 1], distribution).max(opacity[level - 1]);
            }
        }
        Ok(Thresholds { opacity, transparency: Vec::new() })
    }

    /// Opacity thresholds level by level, the finest active one first; the last holds for all beyond.
    ///
    /// # Errors
    /// [`Error::Parameter`] when one is out of range or below that of a finer level: predictive rejection would then
    /// reject what descending accepts.
    pub fn by_level(opacity: &[f64]) -> Result<Thresholds> {
        opacity.iter().try_for_each(|&t| check_opacity(t))?;
        if let Some(level) = (1..opacity.len()).find(|&l| opacity[l] < opacity[l - 1]) {
            let reason = format!("at level {level}, below the {} of level {}", opacity[level - 1], level - 1);
            return Err(Error::parameter("threshold", opacity[level], reason));
        }
        Ok(Thresholds { opacity: opacity.to_vec(), transparency: Vec::new() })
    }

    /// The same with conservative rejection: a transparency threshold of the finest active level, 0 (none) up to its opacity
    /// threshold; the coarser ones follow by D.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it is out of range, or D is.
    pub fn with_transparency(self, t: f64, distribution: f64) -> Result<Thresholds> {
        check_distribution(distribution)?;
        let most = self.opacity(0);
        if !(0.0..=most).contains(&t) {
            return Err(Error::parameter("transparency", t, format!("0 to the opacity threshold, {most}")));
        }
        let transparency = match t {
            0.0 => Vec::new(),
            t => (0..LEVELS).map(|level| t * (distribution / 4.0).powi(level as i32)).collect(),
        };
        Ok(Thresholds { transparency, ..self })
    }

    /// The opacity threshold of the active level that is `above` levels coarser than the finest active one.
    pub fn opacity(&self, above: usize) -> f64 {
        self.opacity.get(above).or(self.opacity.last()).copied().unwrap_or(1.0)
    }

    /// The transparency threshold of that level.
    pub fn transparency(&self, above: usize) -> f64 {
        self.transparency.get(above).copied().unwrap_or(0.0)
    }

    /// True when no level allows a hole: nothing visible is culled.
    pub fn is_conservative(&self) -> bool {
        self.opacity.iter().all(|&t| t == 1.0)
    }

    /// True when moreover nothing is rejected that descending would accept: the test is then exact by samples.
    pub fn is_exact(&self) -> bool {
        self.is_conservative() && self.transparency.is_empty()
    }
}

/// The most holes with which a pixel of so many samples still reaches an opacity: `floor((1 - t) samples + 1e-9)`.
#[inline(always)]
fn most_holes(t: f64, samples: f64) -> u32 {
    ((1.0 - t) * samples + 1e-9).floor() as u32
}

/// The thresholds of one level as hole counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limit {
    /// With at most so many holes a pixel counts as opaque.
    pub opaque: u32,
    /// With more it counts as transparent: the test fails (5.3.1, and 5.2.1 for a pixel without any coverage).
    pub transparent: u32,
    /// With more, a pixel inside the rectangle has a descendant at the finest active level that will fail (5.3.4).
    pub foretold: u32,
    /// The opacity threshold, and the samples of a pixel: for thresholds raised by contrast.
    threshold: f64,
    samples: f64,
}

impl Limit {
    /// As [`Limit::opaque`] with the threshold raised by a contrast from 0 to 1.
    #[inline(always)]
    pub fn opaque_at(&self, contrast: f64) -> u32 {
        most_holes(raised_by_contrast(self.threshold, contrast), self.samples)
    }
}

/// The thresholds of the active levels as hole counts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Limits {
    /// The finest and the coarsest active level.
    pub finest: usize,
    pub coarsest: usize,
    /// By level above the finest active one.
    limits: Vec<Limit>,
}

impl Limits {
    /// For a pyramid whose level-0 pixels are blocks of so many samples, and its active levels.
    pub fn new(thresholds: &Thresholds, block_samples: u64, finest: usize, coarsest: usize) -> Limits {
        let mut limits: Vec<Limit> = Vec::with_capacity(coarsest - finest + 1);
        for level in finest..=coarsest {
            let (samples, threshold) =
                (block_samples as f64 * 4f64.powi(level as i32), thresholds.opacity(level - finest));
            let opaque = most_holes(threshold, samples);
            // Where nothing is covered, descending finds nothing: a pixel is transparent whatever the threshold.
            let whole = (samples - 1.0) as u32;
            let transparent = most_holes(thresholds.transparency(level - finest), samples).min(whole);
            // One of a pixel's four children has more than a quarter of its holes. That it fails in turn follows from
            // thresholds that do not fall; the maximum sees to it where rounding could say otherwise.
            let below = limits.last().map_or(opaque, |l| l.opaque.max(l.foretold).saturating_mul(4));
            let foretold = most_holes(thresholds.opacity(0), samples).max(below);
            limits.push(Limit { opaque, transparent, foretold, threshold, samples });
        }
        Limits { finest, coarsest, limits }
    }

    /// Those of a level, which must be active.
    #[inline(always)]
    pub fn at(&self, level: usize) -> &Limit {
        &self.limits[level - self.finest]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    fn up_to(thresholds: &Thresholds, levels: usize) -> Vec<f64> {
        (0..levels).map(|l| thresholds.opacity(l)).collect()
    }

    #[test]
    fn example_of_5_3_3_as_the_formulas_have_it() {
        let t0 = opacity_threshold(9, 64, 2.0).unwrap();
        assert!(near(t0, 1.0 - 18.0 / 256.0) && (t0 - 0.9297).abs() < 5e-5, "{t0}");
        let t1 = next_opacity_threshold(t0, 2.0);
        assert!((t1 - 0.9648).abs() < 5e-5, "{t1}");
        // What is printed: 0.86 leaves D/4 out, and 0.93 is one step from that.
        let printed = 1.0 - 9.0 / 64.0;
        assert!((printed - 0.86_f64).abs() < 5e-3 && (next_opacity_threshold(printed, 2.0) - 0.93).abs() < 5e-4);
    }

    #[test]
    fn example_of_8_4_2_the_machine_room() {
        let t0 = opacity_threshold(96, 20 * 16, 2.0).unwrap();
        let thresholds = Thresholds::from_finest(t0, 2.0).unwrap();
        let should = [0.85, 0.925, 0.9625, 0.98125, 0.990625];
        let is = up_to(&thresholds, 5);
        assert!(is.iter().zip(should).all(|(&a, b)| near(a, b)), "{is:?}");
    }

    #[test]
    fn example_of_8_4_3_the_power_plant_fits_a_factor_of_1_59() {
        let coarsest = |d: f64| Thresholds::from_finest(0.6, d).unwrap().opacity(4);
        assert!((coarsest(1.59) - 0.99).abs() < 5e-4, "{}", coarsest(1.59));
        assert!(coarsest(2.0) < 0.98, "{}", coarsest(2.0));
    }

    #[test]
    fn thresholds_never_fall_and_transparency_never_rises() {
        for d in [1.0, 1.59, 2.0, 3.999, 4.0] {
            for t in [1e-6, 0.3, 0.85, 1.0 - 1e-12, 1.0] {
                let thresholds = Thresholds::from_finest(t, d).unwrap().with_transparency(t / 2.0, d).unwrap();
                for level in 1..20 {
                    assert!(thresholds.opacity(level) >= thresholds.opacity(level - 1));
                    assert!(thresholds.transparency(level) <= thresholds.transparency(level - 1));
                }
                assert_eq!(thresholds.is_conservative(), t == 1.0);
            }
        }
        assert_eq!(up_to(&Thresholds::uniform(0.7).unwrap(), 20), [0.7; 20]);
    }

    #[test]
    fn bad_values_are_refused_by_name() {
        let named = |r: Result<Thresholds>, name: &str| match r {
            Err(Error::Parameter { name: n, .. }) => assert_eq!(n, name),
            other => panic!("{other:?}"),
        };
        for t in [0.0, -1.0, 1.0 + 1e-9, f64::NAN, f64::INFINITY] {
            named(Thresholds::uniform(t), "threshold");
            named(Thresholds::by_level(&[0.5, t]), "threshold");
        }
        for d in [0.0, 0.999, 4.001, f64::NAN] {
            named(Thresholds::from_finest(0.9, d), "d");
            named(Thresholds::conservative().with_transparency(0.1, d), "d");
        }
        named(Thresholds::by_level(&[0.9, 0.95, 0.94]), "threshold");
        named(Thresholds::uniform(0.5).unwrap().with_transparency(0.6, 2.0), "transparency");
        named(Thresholds::conservative().with_transparency(f64::NAN, 2.0), "transparency");
        assert!(opacity_threshold(64, 64, 1.0).is_err() && opacity_threshold(63, 64, 4.0).unwrap() > 0.0);
    }

    #[test]
    fn transparency_follows_the_formula_of_5_3_3_2() {
        let t = transparency_threshold(9, 64, 2.0).unwrap();
        assert!(near(t, 18.0 / 256.0), "{t}");
        let thresholds = Thresholds::conservative().with_transparency(t, 2.0).unwrap();
        assert!(near(thresholds.transparency(1), t / 2.0) && near(thresholds.transparency(2), t / 4.0));
        assert!(thresholds.is_conservative() && !thresholds.is_exact());
    }

    #[test]
    fn full_contrast_allows_no_hole_and_none_changes_nothing() {
        let limits = Limits::new(&Thresholds::uniform(0.75).unwrap(), 64, 0, 3);
        for level in 0..=3 {
            let limit = limits.at(level);
            assert_eq!((limit.opaque_at(0.0), limit.opaque_at(1.0)), (limit.opaque, 0));
            assert_eq!(limit.opaque, 16 << (2 * level));
        }
        assert!(near(raised_by_contrast(0.8, 0.5), 0.9));
    }
}
