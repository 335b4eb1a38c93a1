//! Simplified occluders in the hom methods (thesis 7.2): the picture stays the same; levels of detail say that it may not.
#![cfg(feature = "cli")]

mod oracle;

use std::path::PathBuf;
use std::process::Command;

use glam::{DVec3, Mat3, Vec3};
use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Method, VisibleSet};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::select::{OccluderDatabase, OccluderGeometry, StandIns};
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, direction, viewport};
use oracle::state::{draw, draw_in, same};
use serde_json::Value;

fn json(args: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_homcull")).args(args).args(["--json", "-"]).output().unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// With simplified occluders every method draws what is drawn without culling.
fn pictures_are_the_same(scene: &str, frames: &str, size: &str) {
    let methods = [
        "vfc",
        "hom:occluders=simplified,rest=0",
        "hom:occluders=simplified,share=0.5,depth=deb,rest=0",
        "hom-multipass:occluders=simplified,share=0.3,rest=0",
        "hom-progressive:occluders=simplified,rest=0",
    ];
    let mut args = vec!["walk", scene, "--frames", frames, "--size", size];
    methods.iter().for_each(|m| args.extend(["--method", m]));
    let report = json(&args);
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), methods.len());
    for (run, method) in runs.iter().zip(methods) {
        assert_eq!(run["wrongly_culled_objects"], 0, "{method} of {scene}");
        assert_eq!(run["image_hash"], runs[0]["image_hash"], "{method} of {scene}");
        println!("{method} of {scene}: {} objects drawn", run["mean"]["objects_drawn"]);
    }
    let drawn = |k: usize| runs[k]["mean"]["objects_drawn"].as_f64().unwrap();
    assert!(drawn(4) < drawn(0), "simplified occluders hide something in {scene}");
}

#[test]
fn the_city_looks_the_same_with_simplified_occluders() {
    pictures_are_the_same("city:triangles=5000", "6", "320x256");
}

#[test]
fn the_machine_room_looks_the_same_with_simplified_occluders() {
    pictures_are_the_same("machine-room:triangles=20000", "6", "320x256");
}

#[test]
fn a_shared_model_looks_the_same_with_simplified_occluders() {
    let folder = std::env::var_os("HOMCULL_MODELS")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = folder.join("data/oa_thor.obj");
    if !path.exists() {
        println!("NOT TESTED: {} is not there (HOMCULL_MODELS names the folder)", path.display());
        return;
    }
    pictures_are_the_same(path.to_str().unwrap(), "6", "320x256");
}

/// A ball of 2n(m - 1) triangles, radius 1.
fn ball(builder: &mut Builder, n: usize, m: usize, facing: Facing) -> &mut homcull::scene::Object {
    let at = |i: usize, j: usize| {
        let (s, c) = ((i % n) as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
        let (t, d) = (j as f64 / m as f64 * std::f64::consts::PI).sin_cos();
        match j {
            0 => Vec3::Y,
            _ if j == m => Vec3::NEG_Y,
            _ => DVec3::new(t * c, d, t * s).as_vec3(),
        }
    };
    let mut out = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            out.extend((j > 0).then_some([a, b, c]));
            out.extend((j + 1 < m).then_some([a, c, d]));
        }
    }
    builder.triangles(&out, facing)
}

fn parameters(text: &str) -> HomParameters {
    match Method::parse(text).unwrap() {
        Method::Hom(p) => HomParameters { rest: 0, ..p },
        _ => panic!("{text} is no hom method"),
    }
}

fn cull(view: &View, scene: &PreparedScene, method: &str) -> (VisibleSet, HomFrame) {
    let (world, p, workers) = (World::new(scene), parameters(method), Workers::new(1).unwrap());
    let frame = HomFrame::new(view, Level::best(), &p).unwrap();
    let frame = hom::select_occluders(&world, Level::best(), view, &p, frame).unwrap();
    let frame = hom::build_pyramid(hom::draw_occluders(&world, &workers, frame).unwrap());
    hom::cull(&world, &workers, &p, frame).unwrap()
}

fn looking(eye: DVec3, way: DVec3, near: f64) -> View {
    let up = if way.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    Camera { eye, target: eye + way, up, fov_y_deg: 70.0, near, far: None }.view(viewport(160, 128)).unwrap()
}

/// Balls turned, stretched, mirrored, pressed flat, drawn from the front, the back and both sides, among small ones.
fn balls(r: &mut Random) -> PreparedScene {
    let mut b = Builder::new();
    for k in 0..30 {
        let facing = [Facing::Both, Facing::Front, Facing::Back][k % 3];
        let way = direction(r) * r.range(3.0, 9.0);
        let stretch = DVec3::new(r.range(0.5, 2.0), r.range(0.5, 2.0), r.range(0.5, 2.0)) * r.range(0.1, 1.5);
        let mirror = match k % 5 {
            3 => DVec3::new(-1.0, 1.0, 1.0),
            4 if k % 4 == 0 => DVec3::new(1.0, 0.0, 1.0),
            _ => DVec3::ONE,
        };
        let turn = Mat3::from_axis_angle(direction(r).as_vec3().normalize(), r.range(0.0, 6.0) as f32);
        let object = ball(&mut b, 12, 7, facing);
        // One mesh is enough: it is simplified once for each side that is drawn.
        object.mesh = 0;
        (object.position, object.rotation) = (way, turn * Mat3::from_diagonal((stretch * mirror).as_vec3()));
    }
    b.prepared()
}

#[test]
fn placed_occluders_simplify_without_a_sample_changing() {
    let mut r = Random::new(7);
    let (mut hidden, mut fewer) = (0, 0);
    for _ in 0..3 {
        let scene = balls(&mut r);
        for _ in 0..6 {
            // Within the heap, with a near plane that cuts some: those occlude as they are.
            let view = looking(direction(&mut r) * r.range(0.0, 12.0), direction(&mut r), r.range(0.05, 2.0));
            let should = draw(Level::best(), &view, &scene);
            for method in ["hom", "hom-multipass", "hom-progressive"] {
                let (plain, before) = cull(&view, &scene, method);
                let (set, after) = cull(&view, &scene, &format!("{method}:occluders=simplified,share=0.4"));
                let is = draw_in(Level::best(), &view, &scene, &set.objects, 1);
                same(method, &(is.items, is.image), &(should.items.clone(), should.image.clone()));
                assert!(set.objects.len() >= plain.objects.len(), "{method} hides no more");
                hidden += set.triangles_hidden;
                fewer += u64::from(after.buffer.counts().triangles < before.buffer.counts().triangles);
            }
        }
    }
    println!("{hidden} triangles hidden, fewer occluder triangles in {fewer} frames");
    assert!(hidden > 1000 && fewer > 20);
}

#[test]
fn an_occluder_across_the_near_plane_occludes_as_it_is() {
    let mut b = Builder::new();
    ball(&mut b, 24, 12, Facing::Both).position = DVec3::new(0.0, 0.0, -3.0);
    let scene = b.prepared();
    let stand_ins = |geometry| StandIns::new(&scene, geometry).unwrap();
    assert!(stand_ins(OccluderGeometry::Original).is_none());
    let own = OccluderDatabase::of_scene(&scene, |_| true);
    let simplified = own.clone().with_stand_ins(stand_ins(OccluderGeometry::Simplified(0.1)));
    let detail = own.clone().with_stand_ins(stand_ins(OccluderGeometry::Detail(4.0)));
    let at = |near: f64| looking(DVec3::ZERO, DVec3::NEG_Z, near);
    let triangles = 2 * 24 * 11;
    assert_eq!(own.triangles(&at(1.0), &[0]), triangles);
    assert!(simplified.triangles(&at(1.0), &[0]) <= triangles / 10);
    assert_eq!(simplified.triangles(&at(2.5), &[0]), triangles);
    assert!(detail.triangles(&at(1.0), &[0]) < triangles);
    // Nearer, the same deviation is more pixels; around the eye it is any number.
    let nearer = looking(DVec3::new(0.0, 0.0, -1.9), DVec3::NEG_Z, 0.01);
    assert!(detail.triangles(&nearer, &[0]) > detail.triangles(&at(1.0), &[0]));
    assert_eq!(detail.triangles(&looking(DVec3::new(0.0, 0.0, -3.0), DVec3::X, 0.01), &[0]), triangles);
    for id in [1, u32::MAX] {
        assert_eq!(simplified.triangles(&at(1.0), &[id]), 0, "there is no such occluder");
    }
}

#[test]
fn what_stands_in_is_a_parameter_that_says_whether_it_is_conservative() {
    assert!(parameters("hom").is_conservative() && parameters("hom:occluders=simplified").is_conservative());
    assert!(!parameters("hom:occluders=lod").is_conservative() && !parameters("hom:lod=0").is_conservative());
    assert_eq!(parameters("hom:occluders=lod").occluders, OccluderGeometry::Detail(4.0));
    assert_eq!(parameters("hom-progressive:lod=2.5").occluders, OccluderGeometry::Detail(2.5));
    assert_eq!(parameters("hom:occluders=simplified,share=0.25").occluders, OccluderGeometry::Simplified(0.25));
    for wrong in ["occluders=thin", "share=0.5", "occluders=simplified,share=2", "lod=-1", "lod=inf", "lod=NaN"] {
        assert!(Method::parse(&format!("hom:{wrong}")).is_err(), "{wrong}");
    }
    let scene = Builder::new().prepared();
    for wrong in [OccluderGeometry::Simplified(f64::NAN), OccluderGeometry::Detail(f64::NAN)] {
        assert!(StandIns::new(&scene, wrong).is_err(), "{wrong:?}");
    }
}
