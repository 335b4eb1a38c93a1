//! The hom methods with every depth representation: the picture stays the same, and far boundaries cost what they may cost.
#![cfg(feature = "bvh")]

mod oracle;

use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Method, VisibleSet};
use homcull::scene::PreparedScene;
use homcull::view::View;
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::state::{draw, draw_in, for_levels, same};
use oracle::verdicts::{behind_walls, world};

fn parameters(text: &str) -> HomParameters {
    match Method::parse(text).unwrap() {
        Method::Hom(p) => HomParameters { rest: 0, ..p },
        _ => panic!("{text} is no hom method"),
    }
}

fn cull(level: Level, threads: usize, view: &View, scene: &PreparedScene, method: &str) -> VisibleSet {
    let world = World::new(scene);
    let p = parameters(method);
    let workers = Workers::new(threads).unwrap();
    let frame = HomFrame::new(view, level, &p).unwrap();
    let frame = hom::select_occluders(&world, level, view, &p, frame).unwrap();
    let frame = hom::build_pyramid(hom::draw_occluders(&world, &workers, frame).unwrap());
    hom::cull(&world, &workers, &p, frame).unwrap().0
}

#[test]
fn the_picture_stays_the_same_with_every_depth_representation_and_update() {
    let mut r = Random::new(81);
    let mut hidden = std::collections::BTreeMap::new();
    for round in 0..10 {
        let (view, scene) = match round % 2 {
            0 => world(&mut r, round, 120),
            _ => {
                let (_, view, scene) = behind_walls(&mut r, round);
                (view, scene)
            }
        };
        let should = draw(Level::best(), &view, &scene);
        for depth in ["nbz", "nbz-block", "deb", "deb,deb-size=5x3", "deb,deb-size=300x300", "plane"] {
            for method in ["hom", "hom-multipass", "hom-progressive"] {
                let limit = match method {
                    "hom" => ",occluder-triangles=100",
                    "hom-multipass" => ",update-triangles=60",
                    _ => "",
                };
                let method = format!("{method}:depth={depth}{limit}");
                let what = format!("round {round}, {method}");
                let objects = for_levels(&what, |level| cull(level, 1, &view, &scene, &method).objects);
                same(&format!("{what}, 2 threads"), &cull(Level::best(), 2, &view, &scene, &method).objects, &objects);
                let is = draw_in(Level::best(), &view, &scene, &objects, 1);
                same(&what, &(is.items, is.image), &(should.items.clone(), should.image.clone()));
                // In one pass the occluders are the same whatever stands for their depth.
                if method.starts_with("hom:") {
                    let in_frustum = cull(Level::best(), 1, &view, &scene, &method).in_frustum;
                    *hidden.entry(depth).or_insert(0) += in_frustum as usize - objects.len();
                }
            }
        }
    }
    println!("{hidden:?}");
    let [nbz, finest, deb, coarsest, plane] =
        ["nbz", "deb,deb-size=300x300", "deb", "deb,deb-size=5x3", "plane"].map(|d| hidden[d]);
    assert!(nbz >= finest && finest >= deb && deb >= coarsest && coarsest >= plane && plane > 20, "{hidden:?}");
}

#[test]
fn one_object_a_pass_is_progressive_before_a_far_boundary() {
    let mut r = Random::new(82);
    for round in 0..6 {
        let (view, scene) = world(&mut r, round, 90);
        for depth in ["deb", "plane"] {
            let of = |method: String| cull(Level::best(), 1, &view, &scene, &method);
            let one = of(format!("hom-multipass:depth={depth},update-triangles=0"));
            assert_eq!(of(format!("hom-progressive:depth={depth}")), one, "round {round}, {depth}");
        }
    }
}

#[test]
fn parameters_are_read_and_printed() {
    let of = |text: &str| {
        let list = Method::parse(text).unwrap().parameters();
        list.into_iter().filter(|(k, _)| k.starts_with("de")).map(|(k, v)| format!("{k}={v}")).collect::<Vec<_>>()
    };
    assert_eq!(of("hom:depth=deb"), ["depth=deb", "deb-size=64x64"]);
    assert_eq!(of("hom-multipass:depth=deb,deb-size=7x300"), ["depth=deb", "deb-size=7x300"]);
    assert_eq!(of("hom-progressive:depth=plane"), ["depth=plane"]);
    for wrong in [
        "deb-size=8x8",
        "depth=plane,deb-size=8x8",
        "depth=deb,deb-size=0x8",
        "depth=deb,deb-size=8",
        "depth=deb,deb-size=99999999999x8",
    ] {
        let said = Method::parse(&format!("hom:{wrong}")).unwrap_err().to_string();
        assert!(said.contains("deb-size"), "{wrong}: {said}");
    }
}
