//! Static occluder selection (Zhang 1998, 7.1): flags objects that are unlikely to be good occluders, before any view is known.
//!
//! Heuristics, after how models are looked at: what is flagged never occludes, which costs or saves culling and never
//! correctness. Every criterion has a parameter. Size and complexity stand by default, and redundancy (`redundancy.rs`); locality
//! and aspect are about the depth estimation buffer, which takes its depths from boxes (7.1, 6.3), and stand only for it
//! ([`StaticCriteria::for_estimation_buffer`]): with depths a sample, a long wall or a floor is the best occluder there is.
//! Linear but for redundancy.

use super::DEFAULT_TRIANGLES;
use super::redundancy::find_redundant;
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::scene::PreparedScene;

/// What an object may be flagged for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Its box is very small.
    Size,
    /// Its box is not small compared with the scene's.
    Locality,
    /// Its box is long.
    Aspect,
    /// It has many triangles.
    Complexity,
    /// Larger objects that it is attached to occlude what it does.
    Redundancy,
}

impl Criterion {
    /// All of them, in the order of the thesis.
    pub const ALL: [Criterion; 5] =
        [Criterion::Size, Criterion::Locality, Criterion::Aspect, Criterion::Complexity, Criterion::Redundancy];

    /// As reports call it.
    pub fn name(self) -> &'static str {
        &self.parameter()["static-".len()..]
    }

    /// Its parameter's name.
    pub fn parameter(self) -> &'static str {
        match self {
            Criterion::Size => "static-size",
            Criterion::Locality => "static-locality",
            Criterion::Aspect => "static-aspect",
            Criterion::Complexity => "static-complexity",
            Criterion::Redundancy => "static-redundancy",
        }
    }
}

/// The criteria's parameters; `None` leaves a criterion out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticCriteria {
    /// Least extent of an object's box over the diagonal of the scene's, 0 to 1. The extent is the side of a square as large as
    /// the box's mean projection (a quarter of its surface, by Cauchy): a lamp post is small, however long.
    pub size: Option<f32>,
    /// Greatest diagonal of an object's box over that of the scene's, 0 to 1.
    pub locality: Option<f32>,
    /// Greatest ratio of a box's longest side to its middle one, at least 1. Thinness harms no depth that is taken from a box
    /// seen broadside; length along the view does.
    pub aspect: Option<f32>,
    /// Triangles, at most.
    pub complexity: Option<u32>,
    /// Least part of its projected area, over all directions, that attached larger occluders cover as well, 0 to 1.
    pub redundancy: Option<f32>,
}

impl StaticCriteria {
    /// Extent at most this part of the scene's diagonal: in a city of 2 km all below 2 m.
    pub const SIZE: f32 = 0.001;
    /// An eighth of the scene.
    pub const LOCALITY: f32 = 0.125;
    /// Eight times as long as broad.
    pub const ASPECT: f32 = 8.0;
    /// A quarter of the default limit: a frame has at least four occluders.
    pub const COMPLEXITY: u32 = DEFAULT_TRIANGLES as u32 / 4;
    /// A flat clock on a wall is covered to 96 percent: the wall misses its rim. Of 0.8, 0.9, 0.95 and 0.99 the one that leaves the
    /// city and sponza the fewest triangles under limits of 5,000 and 25,000.
    pub const REDUNDANCY: f32 = 0.95;

    /// All five, for the depth estimation buffer.
    pub fn for_estimation_buffer() -> StaticCriteria {
        StaticCriteria { locality: Some(Self::LOCALITY), aspect: Some(Self::ASPECT), ..StaticCriteria::default() }
    }

    /// Sets a criterion as it is written: `off`, or its value.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value out of its range.
    pub fn set(&mut self, criterion: Criterion, value: &str) -> Result<()> {
        let bad = |what: &str| Error::parameter(criterion.parameter(), value, format!("{what}, or off"));
        let number = |least: f32, most: f32, what: &str| match value {
            "off" => Ok(None),
            _ => match value.parse::<f32>().ok().filter(|v| *v >= least && *v <= most) {
                Some(v) => Ok(Some(v)),
                None => Err(bad(what)),
            },
        };
        match criterion {
            Criterion::Size => self.size = number(0.0, 1.0, "a part of the scene, 0 to 1")?,
            Criterion::Locality => self.locality = number(0.0, 1.0, "a part of the scene, 0 to 1")?,
            Criterion::Aspect => self.aspect = number(1.0, f32::MAX, "a ratio, at least 1")?,
            Criterion::Redundancy => self.redundancy = number(0.0, 1.0, "a part of its projection, 0 to 1")?,
            Criterion::Complexity if value == "off" => self.complexity = None,
            Criterion::Complexity => {
                self.complexity = Some(value.parse().map_err(|_| bad("a number of triangles"))?);
            }
        }
        Ok(())
    }

    /// A criterion's value as it is written.
    pub fn value(&self, criterion: Criterion) -> String {
        let number = match criterion {
            Criterion::Size => self.size,
            Criterion::Locality => self.locality,
            Criterion::Aspect => self.aspect,
            Criterion::Redundancy => self.redundancy,
            Criterion::Complexity => return self.complexity.map_or("off".into(), |n| n.to_string()),
        };
        number.map_or("off".into(), |v| v.to_string())
    }
}

impl Default for StaticCriteria {
    fn default() -> Self {
        StaticCriteria {
            size: Some(Self::SIZE),
            locality: None,
            aspect: None,
            complexity: Some(Self::COMPLEXITY),
            redundancy: Some(Self::REDUNDANCY),
        }
    }
}

/// What static selection found: for each object the criteria that flag it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StaticSelection {
    /// A bit a criterion, in the order of [`Criterion::ALL`]; those that can never occlude have none.
    flags: Vec<u8>,
    /// Objects that can occlude at all: opaque, with triangles and a finite box.
    candidates: usize,
}

impl StaticSelection {
    /// Looks at every object of a scene. Redundancy is asked only of what the others leave.
    ///
    /// # Errors
    /// [`Error::View`] when a scene lies so far out that no view of its objects can be made.
    pub fn new(scene: &PreparedScene, criteria: &StaticCriteria) -> Result<StaticSelection> {
        let candidate =
            |id: usize| scene.occluders[id].opaque && scene.triangles(id as u32) > 0 && scene.bounds[id].is_finite();
        let all = scene.bounds.iter().filter(|b| b.is_finite()).fold(Aabb::EMPTY, |a, &b| a.union(b));
        let whole = if all.is_finite() { all.size().length() } else { 0.0 };
        let mut flags = vec![0u8; scene.bounds.len()];
        let mut left = Vec::new();
        for id in (0..flags.len()).filter(|&id| candidate(id)) {
            flags[id] = flags_of_box(scene.bounds[id], scene.triangles(id as u32), whole, criteria);
            if flags[id] == 0 {
                left.push(id as u32);
            }
        }
        if let Some(part) = criteria.redundancy {
            for id in find_redundant(scene, &left, part)? {
                flags[id as usize] |= bit(Criterion::Redundancy);
            }
        }
        Ok(StaticSelection { candidates: (0..flags.len()).filter(|&id| candidate(id)).count(), flags })
    }

    /// True when no criterion flags the object.
    pub fn admits(&self, object: u32) -> bool {
        self.flags[object as usize] == 0
    }

    /// Whether this criterion flags the object.
    pub fn flags(&self, object: u32, criterion: Criterion) -> bool {
        self.flags[object as usize] & bit(criterion) != 0
    }

    /// Objects that this criterion flags, whether or not others do too.
    pub fn rejected_by(&self, criterion: Criterion) -> usize {
        self.flags.iter().filter(|&&f| f & bit(criterion) != 0).count()
    }

    /// Objects that could occlude, before any criterion is asked.
    pub fn candidates(&self) -> usize {
        self.candidates
    }

    /// Objects that no criterion flags.
    pub fn kept(&self) -> usize {
        self.candidates - self.flags.iter().filter(|&&f| f != 0).count()
    }
}

fn bit(criterion: Criterion) -> u8 {
    1 << criterion as u8
}

/// Half of a box's surface.
pub(super) fn half_area(b: Aabb) -> f32 {
    let s = b.size();
    s.x * s.y + s.y * s.z + s.z * s.x
}

/// The side of a square as large as the box's mean projection.
pub(super) fn extent(b: Aabb) -> f32 {
    (half_area(b) * 0.5).sqrt()
}

fn flags_of_box(b: Aabb, triangles: u32, whole: f32, criteria: &StaticCriteria) -> u8 {
    let mut sides = b.size().to_array();
    sides.sort_by(f32::total_cmp);
    let [_, middle, longest] = sides;
    let flagged = [
        (Criterion::Size, criteria.size.is_some_and(|part| extent(b) < part * whole)),
        (Criterion::Locality, criteria.locality.is_some_and(|part| b.size().length() > part * whole)),
        (Criterion::Aspect, criteria.aspect.is_some_and(|ratio| longest > ratio * middle)),
        (Criterion::Complexity, criteria.complexity.is_some_and(|most| triangles > most)),
    ];
    flagged.iter().filter(|(_, f)| *f).fold(0, |all, (c, _)| all | bit(*c))
}
