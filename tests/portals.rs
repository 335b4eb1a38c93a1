//! Cells and portals: the picture of what portals leave is the picture of everything in the frustum, wherever the eye is; cells
//! are what rays say; files are read and refused.
#![cfg(feature = "cli")]

mod oracle;

use std::path::{Path, PathBuf};

use glam::DVec3;
use homcull::cull::portals::{self, PortalScene};
use homcull::cull::{CellsFrom, Method, PortalClip, PortalParameters};
use homcull::scene::{Cell, Cells, Portal, PreparedScene, Scene, load, load_cells, parse};
use homcull::view::{Camera, ClipSpace, View};
use homcull_simd::Level;
use oracle::portal_stage::{CLIPS, Stage};
use oracle::random::Random;
use oracle::scenes;

fn prepared(text: &str) -> PreparedScene {
    PreparedScene::new(&parse(text).unwrap().scene).unwrap()
}

fn camera(r: &mut Random, eye: DVec3) -> Camera {
    let mut camera = scenes::camera(r, eye);
    camera.near = r.range(0.01, 0.2);
    camera
}

/// A random point of a box.
fn within(r: &mut Random, min: DVec3, max: DVec3) -> DVec3 {
    DVec3::new(r.range(min.x, max.x), r.range(min.y, max.y), r.range(min.z, max.z))
}

#[test]
fn from_anywhere_in_the_rooms_the_picture_is_that_of_everything() {
    let scene = prepared("rooms:triangles=70000");
    let mut stage = Stage::new(&scene, CellsFrom::Given);
    let mut r = Random::new(1);
    let (mut drawn, mut all) = (0, 0);
    for round in 0..250 {
        let cells = stage.cells().cells();
        let cell = &cells[5 + r.below(cells.len() - 5)];
        let eye = within(&mut r, cell.min, cell.max);
        let view = camera(&mut r, eye).view(stage.viewport).unwrap();
        let [few, many] = stage.keeps_the_picture(&format!("round {round}"), &view);
        (drawn, all) = (drawn + few, all + many);
    }
    println!("portals draw {drawn} of {all} objects in the frustum");
    assert!(drawn * 3 < all, "{drawn} of {all}");
}

#[test]
fn on_a_portal_the_picture_is_that_of_everything() {
    let scene = prepared("rooms:triangles=60000,seed=3");
    let mut stage = Stage::new(&scene, CellsFrom::Given);
    let mut r = Random::new(2);
    for round in 0..200 {
        let portals = stage.cells().portals();
        let portal = portals[r.below(portals.len())];
        let mut eye = within(&mut r, portal.min, portal.max);
        let axis = portal.axis();
        // On its plane, next to it, on its edge; seen straight on, edge-on, or anyhow.
        eye[axis] += [0.0, 0.0, 1e-9, -1e-9, 1e-6, -1e-6, 1e-3, -1e-3][r.below(8)];
        let other = (axis + 1) % 3;
        if r.chance(0.2) {
            eye[other] = portal.min[other];
        }
        let mut camera = camera(&mut r, eye);
        let mut ahead = camera.target - eye;
        match r.below(4) {
            0 => ahead[axis] = 0.0,
            1 => {
                ahead = DVec3::ZERO.with_x(if axis == 0 { 1.0 } else { 0.0 }).with_z(if axis == 2 { -1.0 } else { 0.0 })
            }
            _ => {}
        }
        if ahead.length() < 0.1 {
            continue;
        }
        (camera.target, camera.up) = (eye + ahead, if ahead.normalize().y.abs() > 0.9 { DVec3::X } else { DVec3::Y });
        stage.keeps_the_picture(&format!("round {round}"), &camera.view(stage.viewport).unwrap());
    }
}

#[test]
fn outside_and_in_walls_the_picture_is_that_of_everything() {
    let scene = prepared("rooms:triangles=60000,seed=4");
    let mut stage = Stage::new(&scene, CellsFrom::Given);
    let mut r = Random::new(3);
    let (low, high) = (DVec3::new(-9.0, 0.1, -9.0), DVec3::new(40.0, 12.0, 40.0));
    let mut outside = 0;
    for round in 0..150 {
        let far = round % 10 == 0;
        let eye = within(&mut r, low, high) + if far { DVec3::new(300.0, 20.0, 0.0) } else { DVec3::ZERO };
        let mut camera = camera(&mut r, eye);
        if far {
            camera.target = DVec3::new(10.0, 1.0, 10.0);
        }
        // A long lens cuts away what is near: also walls between the eye and the near plane.
        camera.near = r.range(0.01, 3.0);
        stage.keeps_the_picture(&format!("round {round}"), &camera.view(stage.viewport).unwrap());
        outside += u32::from(stage.memory.seen().is_none());
    }
    println!("{outside} views began in no cell");
    assert!(outside > 20);
}

#[test]
fn orthographic_views_see_through_portals_too() {
    let scene = prepared("rooms:triangles=60000,seed=5");
    let mut stage = Stage::new(&scene, CellsFrom::Given);
    let mut r = Random::new(4);
    let mut inside = 0;
    for round in 0..150 {
        // In a room, or outside looking anywhere.
        let cells = stage.cells().cells();
        let cell = &cells[r.below(cells.len())];
        let eye = within(&mut r, cell.min, cell.max);
        let mut matrix = scenes::orthographic(&mut r, eye);
        if round % 2 == 0 {
            // A narrow view.
            let scale = 64.0;
            for axis in [0, 1] {
                let row = matrix.row(axis) * scale;
                for column in 0..4 {
                    matrix.col_mut(column)[axis] = row[column];
                }
            }
        }
        let view = View::new(matrix, ClipSpace::REVERSED, stage.viewport).unwrap();
        stage.keeps_the_picture(&format!("round {round}"), &view);
        inside += u32::from(stage.memory.seen().is_some());
    }
    assert!(inside > 20, "{inside}");
}

/// The cells that a ray passes, found by stepping from face to face.
fn passed(cells: &Cells, start: DVec3, ray: DVec3) -> Vec<u32> {
    let holds = |c: &Cell| c.min.cmplt(start).all() && start.cmplt(c.max).all();
    let Some(first) = cells.cells().iter().position(holds) else { return Vec::new() };
    let (mut cell, mut out) = (first as u32, vec![first as u32]);
    loop {
        let c = &cells.cells()[cell as usize];
        let leaves = |k: usize| ((if ray[k] > 0.0 { c.max[k] } else { c.min[k] }) - start[k]) / ray[k];
        let axis = (0..3).filter(|&k| ray[k] != 0.0).min_by(|&a, &b| leaves(a).total_cmp(&leaves(b))).unwrap();
        let mut at = start + ray * leaves(axis);
        at[axis] = if ray[axis] > 0.0 { c.max[axis] } else { c.min[axis] };
        let hit = |p: &Portal| {
            (0..3).all(|k| {
                if k == axis { p.min[k] == at[k] && p.max[k] == at[k] } else { p.min[k] <= at[k] && at[k] <= p.max[k] }
            })
        };
        match cells.portals_of(cell).find(|(p, _)| hit(p)) {
            Some((_, beyond)) => cell = beyond,
            None => return out,
        }
        out.push(cell);
    }
}

#[test]
fn every_cell_that_a_ray_passes_is_seen_and_few_others() {
    let scene = prepared("rooms:triangles=70000");
    let mut stage = Stage::new(&scene, CellsFrom::Given);
    let mut r = Random::new(5);
    let (mut hit, mut seen_by_polygons) = (0, 0);
    for round in 0..60 {
        let cell = stage.cells().cells()[5 + r.below(stage.cells().cells().len() - 5)].clone();
        let eye = within(&mut r, cell.min + 0.05, cell.max - 0.05);
        let mut camera = camera(&mut r, eye);
        camera.near = 0.01;
        let view = camera.view(stage.viewport).unwrap();
        let mut wider = Vec::new();
        for clip in CLIPS.into_iter().rev() {
            let parameters = PortalParameters { clip, ..PortalParameters::default() };
            portals::cull(&stage.world, Level::best(), &view, &stage.portals, &parameters, &mut stage.memory);
            let seen = stage.memory.seen().unwrap().to_vec();
            let mut met = vec![false; stage.cells().cells().len()];
            for _ in 0..if clip == PortalClip::Polygon { 4000 } else { 0 } {
                let (x, y) = (r.range(0.0, 192.0 * 256.0), r.range(0.0, 144.0 * 256.0));
                let [rx, ry, rw, ..] = *view.rows();
                // A direction that is seen at (x, y), by Cramer's rule.
                let (a, b) = ((rx - rw * x).truncate(), (ry - rw * y).truncate());
                let ray = a.cross(b).normalize();
                let ray = if ray.dot(rw.truncate()) > 0.0 { ray } else { -ray };
                for c in passed(stage.cells(), eye, ray) {
                    assert!(seen.contains(&c), "round {round}: cell {c} is not seen");
                    met[c as usize] = true;
                }
            }
            if clip == PortalClip::Rectangle {
                wider = seen;
            } else {
                assert!(seen.iter().all(|c| wider.contains(c)), "round {round}: polygons are within rectangles");
                hit += met.iter().filter(|&&m| m).count();
                seen_by_polygons += seen.len();
            }
        }
    }
    println!("{hit} cells met by rays, {seen_by_polygons} seen by polygons");
    assert!(seen_by_polygons < hit * 3 / 2);
}

// ---- the generator

#[test]
fn rooms_have_no_crack() {
    for text in ["rooms", "rooms:seed=9,triangles=30000", "rooms:seed=2,triangles=1500000"] {
        let generated = parse(text).unwrap();
        let scene = &generated.scene;
        let bits = |p: glam::Vec3| p.to_array().map(f32::to_bits);
        let mut edges = std::collections::HashMap::new();
        for object in scene.objects.iter().filter(|o| o.position == DVec3::ZERO) {
            let mesh = &scene.meshes[object.mesh as usize];
            for t in mesh.triangles() {
                let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
                assert!((b - a).cross(c - a).length() > 0.0, "{}: a triangle without area", object.name);
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((bits(p), bits(q))).or_insert(0) += 1;
                    *edges.entry((bits(q), bits(p))).or_insert(0) -= 1;
                }
            }
        }
        let point = |b: [u32; 3]| glam::Vec3::from_array(b.map(f32::from_bits));
        let (min, max) = scene.cells.as_ref().unwrap().bounds();
        let on_rim = |p: glam::Vec3| {
            [p.x - min.x as f32, p.x - max.x as f32, p.z - min.z as f32, p.z - max.z as f32].contains(&0.0)
        };
        for ((a, b), count) in edges {
            let (a, b) = (point(a), point(b));
            assert!(count == 0 || (on_rim(a) && on_rim(b)), "{text}: the edge from {a} to {b} is open");
        }
    }
}

#[test]
fn rooms_bring_cells_that_the_checks_accept() {
    for text in ["rooms", "rooms:seed=8,triangles=20000", "rooms:triangles=3000000"] {
        let cells = parse(text).unwrap().scene.cells.unwrap();
        let again = Cells::new(cells.cells().to_vec(), cells.portals().to_vec()).unwrap();
        assert_eq!(again, cells, "{text}");
        assert!(cells.cells().len() > 20 && cells.portals().len() >= cells.cells().len() - 1, "{text}");
    }
    assert_eq!(parse("rooms:triangles=500").unwrap().scene.cells, None, "walls with gaps");
}

#[test]
fn the_walk_through_the_rooms_stays_in_cells_and_meets_nothing() {
    for text in ["rooms", "rooms:seed=6,triangles=50000"] {
        let generated = parse(text).unwrap();
        let scene = &generated.scene;
        let cells = scene.cells.as_ref().unwrap();
        let mut visited = std::collections::BTreeSet::new();
        let mut triangles = Vec::new();
        for object in &scene.objects {
            let mesh = &scene.meshes[object.mesh as usize];
            let place = |i: u32| object.rotation.as_dmat3() * mesh.positions()[i as usize].as_dvec3() + object.position;
            triangles.extend(mesh.triangles().iter().map(|t| t.map(place)));
        }
        for (frame, camera) in generated.path.sample(generated.frames).unwrap().iter().enumerate() {
            let eye = camera.eye;
            let holds = |c: &Cell| c.min.cmple(eye).all() && eye.cmple(c.max).all();
            let cell = cells.cells().iter().position(holds);
            visited.insert(cell.unwrap_or_else(|| panic!("{text}: frame {frame} at {eye} is in no cell")));
            for t in &triangles {
                let (low, high) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
                let gap = (low - eye).max(eye - high).max(DVec3::ZERO);
                assert!(gap.length() > 0.2, "{text}: frame {frame} at {eye} meets {low} to {high}");
            }
        }
        assert!(visited.len() > 8, "{text}: {} cells", visited.len());
    }
}

// ---- cells and their files

fn cell(min: [f64; 3], max: [f64; 3]) -> Cell {
    Cell { name: "room".into(), min: DVec3::from_array(min), max: DVec3::from_array(max) }
}

fn portal(cells: [u32; 2], min: [f64; 3], max: [f64; 3]) -> Portal {
    Portal { cells, min: DVec3::from_array(min), max: DVec3::from_array(max) }
}

#[track_caller]
fn refused(cells: &[Cell], portals: &[Portal], words: &[&str]) {
    let text = Cells::new(cells.to_vec(), portals.to_vec()).unwrap_err().to_string();
    assert!(words.iter().all(|w| text.contains(w)), "'{text}' does not say all of {words:?}");
}

#[test]
fn cells_and_portals_that_cannot_be_are_refused() {
    let two = [cell([0.0; 3], [1.0; 3]), cell([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])];
    let good = portal([1, 0], [1.0, 0.0, 0.2], [1.0, 0.5, 0.4]);
    let cells = Cells::new(two.to_vec(), vec![good]).unwrap();
    assert_eq!(cells.portals()[0].cells, [0, 1], "the lesser first");
    assert_eq!(cells.portals_of(1).map(|(_, c)| c).collect::<Vec<_>>(), [0]);
    refused(&[cell([0.0; 3], [1.0, 0.0, 1.0])], &[], &["cells[0]", "room", "min"]);
    refused(&[cell([f64::NAN, 0.0, 0.0], [1.0; 3])], &[], &["cells[0]"]);
    refused(&[two[0].clone(), cell([0.9; 3], [3.0; 3])], &[], &["cells[1]", "overlaps cells[0]"]);
    refused(&two, &[portal([0, 2], [1.0, 0.0, 0.0], [1.0; 3])], &["portals[0]", "no cells[2]"]);
    refused(&two, &[portal([1, 1], [1.0, 0.0, 0.0], [1.0; 3])], &["portals[0]", "itself"]);
    refused(&two, &[good, portal([0, 1], [1.0, 0.0, 0.0], [1.5, 1.0, 1.0])], &["portals[1]", "rectangle"]);
    refused(&two, &[portal([0, 1], [1.0, 0.5, 0.0], [1.0, 0.5, 1.0])], &["portals[0]", "rectangle"]);
    refused(&two, &[portal([0, 1], [1.0, 0.0, 0.0], [1.0, 1.5, 1.0])], &["portals[0]", "does not lie"]);
    refused(&two, &[portal([0, 1], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0])], &["portals[0]", "does not lie"]);
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("portals").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

const GOOD: &str = r#"{"cells": [{"name": "hall", "min": [0, 0, 0], "max": [5, 3, 4]}, {"min": [5, 0, 0], "max": [9, 3, 4]}],
 "portals": [{"cells": [0, 1], "min": [5, 0, 1], "max": [5, 2, 2]}]}"#;

#[test]
fn a_cells_file_beside_an_obj_is_read() {
    let folder = folder("read");
    std::fs::write(folder.join("two.obj"), "o t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.join("two.cells.json"), GOOD).unwrap();
    let scene: Scene = load(folder.join("two.obj").to_str().unwrap(), None).unwrap().scene;
    let cells = scene.cells.clone().unwrap();
    assert_eq!((cells.cells()[0].name.as_str(), cells.cells()[1].name.as_str()), ("hall", "1"));
    assert_eq!(cells.portals(), [portal([0, 1], [5.0, 0.0, 1.0], [5.0, 2.0, 2.0])]);
    let prepared = PreparedScene::new(&scene).unwrap();
    assert_eq!(PortalScene::new(&prepared, CellsFrom::Any).unwrap().objects().of(0), [0]);
}

#[test]
fn a_damaged_cells_file_is_refused_with_file_and_key() {
    let file = folder("damaged").join("x.cells.json");
    let refused = |text: String, words: &[&str]| {
        std::fs::write(&file, text).unwrap();
        let said = load_cells(&file).unwrap_err().to_string();
        assert!(said.contains("x.cells.json") && words.iter().all(|w| said.contains(w)), "'{said}' lacks {words:?}");
    };
    for end in 0..GOOD.len() {
        refused(GOOD[..end].into(), &["JSON"]);
    }
    refused("[]".into(), &["cells"]);
    for (from, to, words) in [
        (r#""min": [5, 0, 0]"#, r#""min": [5, 0]"#, &["cells[1].min", "three numbers"][..]),
        (r#""max": [9, 3, 4]"#, r#""most": 4"#, &["cells[1].max", "missing"]),
        (r#""hall""#, "7", &["cells[0].name"]),
        ("[0, 1]", "[0, -1]", &["portals[0].cells"]),
        ("[0, 1]", "[0, 1, 2]", &["portals[0].cells"]),
        ("[0, 1]", "[0, 5]", &["portals[0]", "no cells[5]"]),
        (r#""min": [5, 0, 1]"#, r#""min": [4, 0, 1]"#, &["portals[0]", "rectangle"]),
        (r#""min": [5, 0, 0]"#, r#""min": [4, 0, 0]"#, &["cells[1]", "overlaps"]),
        (r#""portals": [{"#, r#""portals": {"a": [{"#, &["JSON"]),
    ] {
        refused(GOOD.replacen(from, to, 1), words);
    }
    let gone = load_cells(&folder("damaged").join("none.cells.json")).unwrap_err().to_string();
    assert!(gone.contains("none.cells.json"), "{gone}");
}

#[test]
fn the_method_reads_its_parameters_and_names_those_it_does_not_know() {
    let method = Method::parse("portals:clip=rectangle,cells=found").unwrap();
    assert_eq!(method, Method::Portals(PortalParameters { clip: PortalClip::Rectangle, cells: CellsFrom::Found }));
    let list = [("clip", "polygon"), ("cells", "any")].map(|(k, v)| (k.to_owned(), v.to_owned()));
    assert_eq!(Method::parse("portals").unwrap().parameters(), list);
    for (text, word) in [("portals:clip=oval", "oval"), ("portals:cells=none", "none"), ("portals:depth=nbz", "depth")]
    {
        let said = Method::parse(text).unwrap_err().to_string();
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn a_scene_without_cells_is_refused_in_one_line() {
    let scene = prepared("terrain:triangles=2000");
    let said = PortalScene::new(&scene, CellsFrom::Given).unwrap_err().to_string();
    assert!(said.contains("portals") && said.contains("no cells") && said.lines().count() == 1, "{said}");
    let scene = prepared("forest:triangles=5000");
    for from in [CellsFrom::Any, CellsFrom::Found] {
        let said = PortalScene::new(&scene, from).unwrap_err().to_string();
        assert!(said.contains("nothing to gain") && said.lines().count() == 1, "{said}");
    }
}
