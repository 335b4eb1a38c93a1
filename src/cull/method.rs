//! Methods by name and parameters, as they are written on the command line: `hom:depth=nbz,threshold=0.85`, or composed of stages:
//! `detail:pixels=4+portals+hom`.

use super::coherent::QueryParameters;
use super::detail::DEFAULT_DETAIL_PIXELS;
use super::hom_parameters::{DEFAULT_UPDATE_TRIANGLES, HomParameters, Selection, Update};
use super::method_list::methods;
use super::plp_parameters::PlpParameters;
use super::portals::PortalParameters;
use super::pvs::PvsParameters;
use crate::error::{Error, Result};

/// A method and its parameters.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant)] // there are a few of them a walk
pub enum Method {
    /// View-frustum culling alone.
    Vfc,
    /// Detail culling: what covers fewer than so many samples is left out while the view moves.
    Detail(u32),
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
    /// Visible sets from a bake.
    Pvs(PvsParameters),
    /// The visible set alone, found beforehand.
    Ideal(IdealSet),
    /// Stages, each of which sees what the one before it left; the last one's set is drawn.
    Composed(Vec<Method>),
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

impl Method {
    /// Reads a method as written: `NAME[:key=value,...]`, or several of them with `+` between.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the method, key or value that is not known, or the stage that cannot be composed.
    pub fn parse(text: &str) -> Result<Method> {
        let mut stages = written_stages(text).into_iter().map(Method::parse_stage).collect::<Result<Vec<_>>>()?;
        if stages.len() == 1
            && let Some(method) = stages.pop()
        {
            return Ok(method);
        }
        for stage in &stages {
            let reason = match stage {
                Method::Ideal(_) => "an ideal draws a set found beforehand: nothing composes with it",
                Method::Hom(p) if p.pipeline => "with pipeline=on its frames overlap: nothing composes with it",
                _ => continue,
            };
            return Err(Error::parameter("method", stage.name(), reason));
        }
        Ok(Method::Composed(stages))
    }

    fn parse_stage(text: &str) -> Result<Method> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let name = name.trim();
        let mut method = match name {
            "vfc" | "frustum" => Method::Vfc,
            "detail" => Method::Detail(DEFAULT_DETAIL_PIXELS),
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
            "pvs" => Method::Pvs(PvsParameters::default()),
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
        if let Method::Pvs(p) = &method {
            p.check()?;
        }
        if let Method::Cplp(p) = &method {
            p.check_conservative()?;
        }
        Ok(method)
    }

    fn set(&mut self, name: &str, key: &str, value: &str) -> Result<()> {
        let unknown = || Error::parameter(format!("{name} parameter"), key, "not known; see `homcull methods`");
        match self {
            Method::Vfc | Method::Horizons | Method::Composed(_) => Err(unknown()),
            Method::Detail(pixels) if key == "pixels" => {
                *pixels = value.parse().map_err(|_| Error::parameter(key, value, "a number of samples"))?;
                Ok(())
            }
            Method::Detail(_) => Err(unknown()),
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
            Method::Pvs(p) => p.set(key, value, unknown),
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

    /// The name without parameters; of stages, theirs with `+` between.
    pub fn name(&self) -> String {
        let name = match self {
            Method::Vfc => "vfc",
            Method::Detail(_) => "detail",
            Method::Plp(_) => "plp",
            Method::Cplp(_) => "cplp",
            Method::Portals(_) => "portals",
            Method::Horizons => "horizons",
            Method::Pvs(_) => "pvs",
            Method::Hzb(_) => "hzb",
            Method::Queries(p) if p.coherent => "chc",
            Method::Queries(_) => "stop-and-wait",
            Method::Ideal(_) => "ideal",
            Method::Hom(p) => match p.update {
                Update::Once => "hom",
                Update::Batches(_) => "hom-multipass",
                Update::Always => "hom-progressive",
            },
            Method::Composed(stages) => return stages.iter().map(Method::name).collect::<Vec<_>>().join("+"),
        };
        name.to_owned()
    }

    /// The stages, in order: itself, unless it is composed.
    pub fn stages(&self) -> &[Method] {
        match self {
            Method::Composed(stages) => stages,
            one => std::slice::from_ref(one),
        }
    }

    /// All parameters with their values; of stages, `STAGE.key`.
    pub fn parameters(&self) -> Vec<(String, String)> {
        match self {
            Method::Vfc | Method::Horizons => Vec::new(),
            Method::Detail(pixels) => vec![("pixels".into(), pixels.to_string())],
            Method::Composed(stages) => {
                let of = |stage: &Method| {
                    let name = stage.name();
                    stage.parameters().into_iter().map(move |(key, value)| (format!("{name}.{key}"), value))
                };
                stages.iter().flat_map(of).collect()
            }
            Method::Hzb(p) => {
                vec![("first".into(), if p.previous_first { "previous" } else { "none" }.into())]
            }
            Method::Plp(p) | Method::Cplp(p) => p.list(),
            Method::Portals(p) => p.list(),
            Method::Pvs(p) => p.list(),
            Method::Queries(p) => p.list(),
            Method::Ideal(set) => {
                let set = if *set == IdealSet::Exact { "exact" } else { "stop-and-wait" };
                vec![("set".into(), set.into())]
            }
            Method::Hom(p) => p.list(),
        }
    }
}

/// The stages of a method as written: parted at every `+` that a method's name follows, as a file's name may hold one.
fn written_stages(text: &str) -> Vec<&str> {
    let names_a_method = |rest: &str| {
        let name = rest.trim_start().split([':', '+', ' ']).next().unwrap_or_default();
        name == "frustum" || methods().iter().any(|m| m.name == name)
    };
    // What follows a `+` outside of parameters is meant as a method, known or not.
    let begins_stage = |at: usize, from: usize| names_a_method(&text[at + 1..]) || !text[from..at].contains(':');
    let (mut stages, mut from) = (Vec::new(), 0);
    for (at, _) in text.match_indices('+') {
        if begins_stage(at, from) {
            stages.push(text[from..at].trim());
            from = at + 1;
        }
    }
    stages.push(text[from..].trim());
    stages
}
