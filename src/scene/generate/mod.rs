//! Generated scenes: a name, a seed and a number of triangles give the same scene and walk on every machine.
//!
//! Integer hashes draw the numbers, `libm` does the trigonometry, and the number of triangles is met by whole objects.

mod city;
mod forest;
mod machine_room;
mod piping;
mod plant;
mod rooms;
mod solid;
mod stock;
mod teapots;
mod terrain;

use super::{Scene, Subdivision, subdivide};
use crate::error::{Error, Result};
use crate::view::CameraPath;

/// A generated scene with its own walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Generated {
    /// The scene, named as the generator.
    pub scene: Scene,
    /// The walk through it.
    pub path: CameraPath,
    /// How many frames the walk is meant to have.
    pub frames: usize,
}

/// What a generator is called and does when nothing is said.
#[derive(Debug, Clone, Copy)]
pub struct Generator {
    /// The name before the colon.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Seed by default.
    pub seed: u64,
    /// Triangles by default, met exactly.
    pub triangles: u64,
    build: fn(u64, u64) -> Generated,
}

/// Most triangles that a generator makes: some 4 GB of scene.
const MOST_TRIANGLES: u64 = 100_000_000;

static GENERATORS: [Generator; 8] = [
    Generator {
        name: "city",
        about: "twelve districts of streets, blocks and high-rises; a walk in the streets, above the roofs, and looking outward",
        seed: 1,
        triangles: 312_524,
        build: city::build,
    },
    Generator {
        name: "chc-city",
        about: "the city at the size of Bittner et al. 2004",
        seed: 1,
        triangles: 1_036_146,
        build: city::build,
    },
    Generator {
        name: "plant",
        about: "a coal-fired power plant: floors, walkways and pipe runs around a boiler; a walk in from a bridge, along the boiler, and out",
        seed: 1,
        triangles: 12_748_510,
        build: plant::build,
    },
    Generator {
        name: "machine-room",
        about: "engines, pipes, valves and gratings in a submarine's hull; a walk between the engines, along a catwalk, and back over all",
        seed: 1,
        triangles: 632_252,
        build: machine_room::build,
    },
    Generator {
        name: "teapots",
        about: "teapots of 2,304 triangles, whole ones only, at random in a long thin box; a walk from one end past the long side to the other",
        seed: 1,
        triangles: 11_520_000,
        build: teapots::build,
    },
    Generator {
        name: "forest",
        about: "oaks, firs, saplings, bushes and ferns, leaf by leaf: small scattered occluders alone; a winding walk through the wood",
        seed: 1,
        triangles: 3_000_000,
        build: forest::build,
    },
    Generator {
        name: "rooms",
        about: "a building of rooms, corridors and stairs with furniture, and its cells and portals; a walk through doorways and up",
        seed: 1,
        triangles: 400_000,
        build: rooms::build,
    },
    Generator {
        name: "terrain",
        about: "rolling open ground with sparse trees, rocks and huts: nothing to cull",
        seed: 1,
        triangles: 200_000,
        build: terrain::build,
    },
];

/// All generators.
pub fn generators() -> &'static [Generator] {
    &GENERATORS
}

/// Generates `NAME[:key=value,...]`, such as `city:seed=7,triangles=1000000`. Keys are `seed` (any u64), `triangles` (2
/// to 100,000,000; an even number is met exactly, an odd one by one less, but `teapots` by whole teapots, at least one), and `split`
/// (1 to 100,000,000): objects of more triangles are subdivided as those of OBJ files are.
///
/// # Errors
/// [`Error::Parameter`] naming the generator, key or value that is not known, with those that are.
pub fn parse(text: &str) -> Result<Generated> {
    let (name, settings) = text.split_once(':').unwrap_or((text, ""));
    let Some(generator) = GENERATORS.iter().find(|g| g.name == name) else {
        let names: Vec<&str> = GENERATORS.iter().map(|g| g.name).collect();
        return Err(Error::parameter("generator", name, format!("is unknown; known are {}", names.join(", "))));
    };
    let (mut seed, mut triangles, mut split) = (generator.seed, generator.triangles, None);
    for setting in settings.split(',').filter(|s| !s.is_empty()) {
        let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
        let number = value.parse::<u64>();
        match (key, number) {
            ("seed", Ok(n)) => seed = n,
            ("triangles", Ok(n)) if (2..=MOST_TRIANGLES).contains(&n) => triangles = n,
            ("split", Ok(n)) if (1..=MOST_TRIANGLES).contains(&n) => split = Some(n as usize),
            ("split", _) => {
                let reason = format!("must be a whole number from 1 to {MOST_TRIANGLES}");
                return Err(Error::parameter("split", value, reason));
            }
            ("seed", _) => return Err(Error::parameter("seed", value, "must be a whole number from 0 to 2^64 - 1")),
            ("triangles", _) => {
                let reason = format!("must be a whole number from 2 to {MOST_TRIANGLES}");
                return Err(Error::parameter("triangles", value, reason));
            }
            _ => {
                let reason = format!("is not known to the generator '{name}'; known are seed, triangles, split");
                return Err(Error::parameter("key", key, reason));
            }
        }
    }
    let mut generated = (generator.build)(seed, triangles);
    if let Some(max_triangles) = split {
        generated.scene = subdivide(generated.scene, &Subdivision { max_triangles, ..Subdivision::default() });
    }
    Ok(generated)
}
