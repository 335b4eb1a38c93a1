//! What was right once stays so: hashes of generated scenes and of their pictures (`data/golden.json`), and exact counts of
//! what the culler does in them (`data/counts.json`).
//!
//! Both hold on every machine, at every SIMD level. A change that is meant to move them is blessed with
//!
//! ```sh
//! HOMCULL_BLESS=1 cargo test --test golden
//! ```
//!
//! and its difference read before it is kept: hashes move only when scenes or pixels do; counts also when an early-out, a
//! queue or the hierarchy changes, which may be no fault but is never an accident.
#![cfg(feature = "cli")]

use std::path::PathBuf;

use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Update};
use homcull::draw::Canvas;
use homcull::hash::Hash;
use homcull::occlusion::{Occluder, Occluders, OcclusionBuffer, OcclusionSettings, ProjectedBoxes};
use homcull::scene::{Generated, Generator, PreparedScene, generators, parse};
use homcull::view::{View, Viewport};
use homcull::workers::Workers;
use homcull_simd::Level;
use serde_json::{Map, Value, json};

/// Frames of each walk whose pictures are hashed, and their size.
const PICTURES: (usize, u32, u32) = (3, 320, 256);
/// Frames of each walk in which is counted, and their size.
const COUNTED: (usize, u32, u32) = (5, 640, 512);

#[test]
fn generated_scenes_and_their_pictures_are_golden() {
    holds("golden.json", |name| {
        let generated = parse(name).unwrap();
        let scene = PreparedScene::new(&generated.scene).unwrap();
        let pictures = views(&generated, PICTURES);
        let pictures: Vec<String> =
            pictures.iter().map(|view| hex(at_all_levels(|l| picture(&scene, view, l)))).collect();
        json!({"scene": hex(scene_hash(&generated)), "pictures": pictures})
    });
}

#[test]
fn counts_are_those_of_the_baseline() {
    holds("counts.json", |name| {
        let generated = parse(name).unwrap();
        let scene = PreparedScene::new(&generated.scene).unwrap();
        let views = views(&generated, COUNTED);
        let (frames, width, height) = COUNTED;
        json!({
            "frames": frames, "width": width, "height": height,
            "raster": at_all_levels(|level| raster(&scene, &views, level)),
            "progressive": at_all_levels(|level| progressive(&scene, &views, level)),
            "hom-progressive": at_all_levels(|level| through_the_hierarchy(&scene, &views, level)),
        })
    });
}

/// Computes a value for every generator, and compares with the file or, blessed, writes it.
#[track_caller]
fn holds(file: &str, compute: impl Fn(&str) -> Value) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data").join(file);
    let is: Map<String, Value> = generators().iter().map(scene_of).map(|text| (text.clone(), compute(&text))).collect();
    let is = Value::Object(is);
    if std::env::var_os("HOMCULL_BLESS").is_some_and(|v| v == "1") {
        let text = serde_json::to_string_pretty(&is).unwrap();
        std::fs::write(&path, text + "\n").unwrap();
        return;
    }
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let should: Value = serde_json::from_str(&text).unwrap();
    let mut differences = Vec::new();
    compare("", &is, &should, &mut differences);
    assert!(
        differences.is_empty(),
        "data/{file} (if this is meant: HOMCULL_BLESS=1 cargo test --test golden):\n{}",
        differences.join("\n")
    );
}

/// The scene that stands for a generator: its default, or a million triangles of what would take long, fewer where nearly all
/// are in view, and small.
fn scene_of(generator: &Generator) -> String {
    if generator.triangles > 2_000_000 {
        let triangles = if ["teapots", "forest"].contains(&generator.name) { 200_000 } else { 1_000_000 };
        format!("{}:triangles={triangles}", generator.name)
    } else {
        generator.name.into()
    }
}

/// Where two values differ.
fn compare(place: &str, is: &Value, should: &Value, out: &mut Vec<String>) {
    match (is, should) {
        (Value::Object(a), Value::Object(b)) => {
            let gone = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(gone) {
                let side = |map: &Map<String, Value>| map.get(key).cloned().unwrap_or(Value::Null);
                compare(&format!("{place}/{key}"), &side(a), &side(b), out);
            }
        }
        _ if is == should => {}
        _ => out.push(format!("  {place}: is {is}, should be {should}")),
    }
}

fn hex(hash: u64) -> String {
    format!("{hash:016x}")
}

/// What the scalar level gives, which every other level of this CPU must give too.
#[track_caller]
fn at_all_levels<T: PartialEq + std::fmt::Debug>(run: impl Fn(Level) -> T) -> T {
    let gold = run(Level::Scalar);
    for level in Level::ALL.into_iter().filter(|&l| l != Level::Scalar) {
        if level.is_available() {
            assert_eq!(run(level), gold, "{} differs from scalar", level.name());
        } else {
            println!("SIMD level {} absent: not tested", level.name());
        }
    }
    gold
}

/// Views of a walk, evenly spread, without its ends: a walk that goes around has the same view there.
fn views(generated: &Generated, (frames, width, height): (usize, u32, u32)) -> Vec<View> {
    let viewport = Viewport::new(width, height).unwrap();
    let cameras = generated.path.sample(frames + 2).unwrap();
    cameras[1..=frames].iter().map(|camera| camera.view(viewport).unwrap()).collect()
}

/// Everything that a generator decides: names, colours, places, vertices, triangles, and the walk.
fn scene_hash(generated: &Generated) -> u64 {
    let mut hash = Hash::default();
    for object in &generated.scene.objects {
        let mesh = &generated.scene.meshes[object.mesh as usize];
        object.name.bytes().chain(object.color).for_each(|b| hash.add(b.into()));
        object.position.to_array().iter().for_each(|c| hash.add(c.to_bits()));
        object.rotation.to_cols_array().iter().for_each(|c| hash.add(c.to_bits().into()));
        mesh.positions().iter().flat_map(|p| p.to_array()).for_each(|c| hash.add(c.to_bits().into()));
        mesh.triangles().iter().flatten().for_each(|&i| hash.add(i.into()));
    }
    for key in &generated.path.keys {
        [key.eye, key.target].iter().flat_map(|p| p.to_array()).for_each(|c| hash.add(c.to_bits()));
    }
    hash.value()
}

/// A buffer that has begun a view, and the boxes in its frustum, nearest first.
fn begun(scene: &PreparedScene, view: &View, level: Level) -> (OcclusionBuffer, ProjectedBoxes) {
    let mut buffer = OcclusionBuffer::with_level(view.viewport(), level, OcclusionSettings::default()).unwrap();
    let mut boxes = ProjectedBoxes::new();
    buffer.begin(view).unwrap();
    buffer.project(&scene.boxes, scene.origin, &mut boxes).unwrap();
    boxes.sort();
    (buffer, boxes)
}

/// The picture of everything in the frustum, by its hash.
fn picture(scene: &PreparedScene, view: &View, level: Level) -> u64 {
    let (_, boxes) = begun(scene, view, level);
    let objects: Vec<u32> = boxes.boxes().iter().map(|b| b.id()).collect();
    let mut canvas = Canvas::new(view.viewport(), level).unwrap();
    canvas.draw(view, scene, &objects, 1, |jobs| jobs.iter_mut().for_each(|job| job.run())).unwrap();
    canvas.hash(scene)
}

/// Everything in the frustum into a cleared buffer, and all boxes tested against it.
fn raster(scene: &PreparedScene, views: &[View], level: Level) -> Value {
    let (mut counts, mut tested, mut hidden) = (homcull::raster::RasterCounts::default(), 0, 0);
    let mut state = Hash::default();
    for view in views {
        let (mut buffer, boxes) = begun(scene, view, level);
        let occluders: Vec<Occluder> = boxes.boxes().iter().map(|b| scene.occluders[b.id() as usize]).collect();
        buffer.submit(&scene.meshes, &occluders).unwrap();
        counts += buffer.counts();
        state.add(buffer.state_hash());
        let mut flags = Vec::new();
        buffer.test_projected(&boxes, 0..boxes.len(), &scene.bounds, scene.origin, &mut flags).unwrap();
        tested += flags.len();
        hidden += flags.iter().filter(|&&h| h).count();
    }
    json!({
        "triangles_in_frustum": counts.triangles, "dropped_in_clusters": counts.dropped_in_clusters,
        "small": counts.small, "large": counts.large, "clipped": counts.clipped,
        "boxes_tested": tested, "hidden": hidden, "visible": tested - hidden, "state_hash": hex(state.value()),
    })
}

/// Nearest first over the list of boxes.
fn progressive(scene: &PreparedScene, views: &[View], level: Level) -> Value {
    let (mut visible, mut hidden, mut triangles) = (0, 0, 0);
    let world =
        Occluders { meshes: &scene.meshes, occluders: &scene.occluders, bounds: &scene.bounds, origin: scene.origin };
    for view in views {
        let (mut buffer, boxes) = begun(scene, view, level);
        let mut flags = Vec::new();
        let run = |jobs: &mut [homcull::occlusion::ProgressiveJob<'_>]| jobs.iter_mut().for_each(|job| job.run());
        let seen = buffer.progressive(&boxes, &world, &mut flags, 1, run).unwrap();
        visible += seen.visible;
        hidden += seen.hidden;
        triangles += buffer.counts().triangles;
    }
    json!({"visible": visible, "hidden": hidden, "triangles_drawn": triangles})
}

/// The same through the hierarchy, as the method does it; without rests, so that every frame counts.
fn through_the_hierarchy(scene: &PreparedScene, views: &[View], level: Level) -> Value {
    let (world, workers) = (World::new(scene), Workers::new(1).unwrap());
    let parameters = HomParameters { rest: 0, ..HomParameters::new(Update::Always) };
    let mut frame = HomFrame::new(&views[0], level, &parameters).unwrap();
    let (mut queries, mut drawn, mut bypassed) = (0, 0, 0);
    for view in views {
        frame = hom::select_occluders(&world, level, view, &parameters, frame).unwrap();
        let set;
        (set, frame) = hom::cull(&world, &workers, &parameters, frame).unwrap();
        queries += set.queries;
        drawn += set.objects.len();
        bypassed += u32::from(set.bypassed);
    }
    json!({"queries": queries, "objects_drawn": drawn, "frames_bypassed": bypassed})
}
