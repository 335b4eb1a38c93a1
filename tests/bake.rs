//! Visibility preprocessing (Zhang 1998, 7.5): what a bake holds, that nothing but the scene and the grid decides its bytes, and
//! that culling with it keeps the picture.
#![cfg(feature = "cli")]

mod oracle;

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DMat4, DVec3, DVec4, UVec3, Vec3};
use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{Method, OccluderSources};
use homcull::draw::{Canvas, DrawJob};
use homcull::measure::bake::{BakeOptions, BakeSummary, bake};
use homcull::measure::walk::{WalkOptions, walk};
use homcull::raster::Facing;
use homcull::scene::{self, PreparedScene, Scene, parse};
use homcull::select::{BakedVisibility, Sight, ViewGrid};
use homcull::view::{Camera, ClipSpace, View};
use homcull::workers::Workers;
use homcull::{Error, Level};
use oracle::scenes::{Builder, viewport};

/// A folder of this process and test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("homcull-bake-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn grid(x: u32, y: u32, z: u32, min: DVec3, max: DVec3) -> ViewGrid {
    ViewGrid::new(UVec3::new(x, y, z), min, max).unwrap()
}

fn baked(scene: &Scene, options: &BakeOptions, level: Level, threads: usize, out: &Path) -> BakeSummary {
    let workers = Workers::new(threads).unwrap();
    bake(scene, options, level, &workers, out, |_| ControlFlow::Continue(())).unwrap().unwrap()
}

/// Streets of a small city, at eye level and among the roofs.
fn small_city() -> (Scene, BakeOptions) {
    let generated = parse("city:triangles=5000").unwrap();
    let from = generated.path.keys[0].eye;
    let reach = DVec3::new(60.0, 0.0, 60.0);
    let grid = grid(3, 2, 2, from - reach - DVec3::Y, from + reach + DVec3::Y * 12.0);
    (generated.scene, BakeOptions { grid, side: 48, near: 0.1 })
}

/// A cube around an eye, of all objects, none culled; objects by samples, then by id.
fn brute_force(scene: &PreparedScene, eye: DVec3, options: &BakeOptions) -> Vec<(u32, u32)> {
    let everything: Vec<u32> = (0..scene.occluders.len() as u32).collect();
    let size = viewport(options.side, options.side);
    let mut canvas = Canvas::new(size, Level::best()).unwrap();
    let mut samples = vec![0u32; everything.len()];
    for (ahead, up) in [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Y, DVec3::Z),
        (DVec3::NEG_Y, DVec3::Z),
        (DVec3::Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::Y),
    ] {
        let depth = DVec4::new(0.0, 0.0, 0.0, options.near);
        let columns = [ahead.cross(up).extend(0.0), up.extend(0.0), depth, ahead.extend(0.0)];
        let rows = DMat4::from_cols(columns[0], columns[1], columns[2], columns[3]).transpose();
        let view = View::from_eye(eye, rows, ClipSpace::REVERSED, size).unwrap();
        canvas.draw(&view, scene, &everything, 1, |jobs| jobs.iter_mut().for_each(DrawJob::run)).unwrap();
        for y in 0..canvas.height() {
            for x in 0..canvas.width() {
                if let Some((_, triangle)) = canvas.item(x, y) {
                    samples[scene.first_triangle.iter().rposition(|&first| first <= triangle).unwrap()] += 1;
                }
            }
        }
    }
    let mut seen: Vec<(u32, u32)> = (0..).zip(samples).filter(|&(_, n)| n > 0).collect();
    seen.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    seen
}

/// Every point that was not skipped sees what drawing everything shows. Gives how many there are.
fn equals_brute_force(scene: &Scene, options: &BakeOptions, out: &Path) -> usize {
    baked(scene, options, Level::best(), 2, out);
    let prepared = PreparedScene::new(scene).unwrap();
    let bake = BakedVisibility::load(out, &prepared).unwrap();
    let mut compared = 0;
    for point in 0..options.grid.points() {
        if let Sight::Seen(seen) = bake.sight(point) {
            let eye = options.grid.point(point);
            assert_eq!(seen, brute_force(&prepared, eye, options), "point {point} at {eye}");
            assert_eq!(bake.objects(point), seen.iter().map(|s| s.0).collect::<Vec<_>>());
            compared += 1;
        }
    }
    compared
}

#[test]
fn a_bake_of_a_city_is_what_drawing_everything_shows() {
    let folder = Folder::new("city");
    let (scene, options) = small_city();
    assert!(equals_brute_force(&scene, &options, &folder.file("city.bake")) >= 6);
}

#[test]
fn a_bake_of_rooms_is_what_drawing_everything_shows() {
    let folder = Folder::new("rooms");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/corridor.obj");
    let scene = scene::load(model.to_str().unwrap(), None).unwrap().scene;
    let (min, max) = homcull::measure::bake::scene_box(&scene).unwrap();
    let options = BakeOptions { grid: grid(4, 1, 4, min, max), side: 64, near: 0.01 };
    assert!(equals_brute_force(&scene, &options, &folder.file("rooms.bake")) >= 8);
}

#[test]
fn threads_and_levels_bake_the_same_bytes() {
    let folder = Folder::new("threads");
    let (scene, options) = small_city();
    let mut all = Vec::new();
    for threads in [1, 2, 3] {
        let file = folder.file(&format!("{threads}.bake"));
        baked(&scene, &options, Level::best(), threads, &file);
        all.push(fs::read(&file).unwrap());
    }
    for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
        let file = folder.file(level.name());
        baked(&scene, &options, level, 1, &file);
        all.push(fs::read(&file).unwrap());
    }
    assert!(all.iter().all(|bytes| *bytes == all[0]));
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), all.len(), "no journal is left");
}

#[test]
fn a_bake_that_was_interrupted_goes_on_and_ends_with_the_same_bytes() {
    let folder = Folder::new("interrupted");
    let (scene, options) = small_city();
    let (whole, file, part) = (folder.file("whole"), folder.file("city.bake"), folder.file("city.bake.part"));
    baked(&scene, &options, Level::best(), 1, &whole);
    let whole = fs::read(whole).unwrap();

    let workers = Workers::new(1).unwrap();
    let stop_after = |most: usize| {
        let stop = |steps| if steps >= most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        assert_eq!(bake(&scene, &options, Level::best(), &workers, &file, stop).unwrap(), None);
        assert!(!file.exists(), "a bake is never there in part");
    };
    // Stopped in both passes, and each time a little further.
    [1, 5, 9, 13, 17].into_iter().for_each(&stop_after);
    let journal = fs::read(&part).unwrap();
    let summary = baked(&scene, &options, Level::best(), 2, &file);
    assert!(summary.resumed >= 17 && !part.exists(), "{summary:?}");
    assert_eq!(fs::read(&file).unwrap(), whole);

    // Killed at any byte, in the header and in records; and with rubbish where the last record was.
    let n = journal.len();
    for cut in [0, 1, 50, 95, 96, 97, 104, 120, n / 2, n / 2 + 3, n - 1] {
        fs::write(&part, &journal[..cut]).unwrap();
        let summary = baked(&scene, &options, Level::best(), 2, &file);
        assert_eq!(summary.resumed > 0, cut >= 96 + 16, "cut at {cut}: {summary:?}");
        assert_eq!(fs::read(&file).unwrap(), whole, "cut at {cut}");
    }
    for at in [96, 100, 130, n / 2, n - 3] {
        let mut damaged = journal.clone();
        damaged[at] ^= 0x10;
        fs::write(&part, &damaged).unwrap();
        baked(&scene, &options, Level::best(), 2, &file);
        assert_eq!(fs::read(&file).unwrap(), whole, "damaged at {at}");
    }
}

#[test]
fn a_program_that_is_killed_goes_on() {
    let folder = Folder::new("killed");
    let (whole, file) = (folder.file("whole.bake"), folder.file("killed.bake"));
    let part = folder.file("killed.bake.part");
    let program = |out: &Path, threads: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_homcull"));
        command.args(["bake", "city:triangles=20000", "--grid", "8x2x8", "--face", "64", "--threads", threads]);
        command.arg("--quiet").arg("--out").arg(out);
        command
    };
    let done = program(&whole, "2").output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let mut kills = 0;
    for least in [200, 2_000, 20_000] {
        let mut child = program(&file, "1").spawn().unwrap();
        while child.try_wait().unwrap().is_none() {
            if fs::metadata(&part).is_ok_and(|m| m.len() >= least) {
                child.kill().unwrap();
                kills += 1;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }
    assert!(kills > 0, "it was too fast to be killed");
    let done = program(&file, "3").output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(fs::read(&file).unwrap(), fs::read(&whole).unwrap());
    assert!(!part.exists());
}

#[track_caller]
fn refused(path: &Path, scene: &PreparedScene, why: &str) {
    match BakedVisibility::load(path, scene) {
        Err(Error::Format { path: named, reason, .. }) => {
            assert!(named == path && reason.contains(why), "{reason}, not {why}");
        }
        other => panic!("{why}: {:?}", other.map(|_| "read")),
    }
}

#[test]
fn a_damaged_short_long_or_foreign_file_is_refused_by_name() {
    let folder = Folder::new("refused");
    let (scene, options) = small_city();
    let file = folder.file("city.bake");
    baked(&scene, &options, Level::best(), 2, &file);
    let whole = fs::read(&file).unwrap();
    let prepared = PreparedScene::new(&scene).unwrap();
    assert!(BakedVisibility::load(&file, &prepared).is_ok());
    for at in (0..whole.len()).step_by(whole.len() / 97).chain(0..100).chain([whole.len() - 1]) {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        fs::write(&file, &damaged).unwrap();
        refused(&file, &prepared, "");
    }
    for length in [8, 95, 96, 100, 140, whole.len() - 9, whole.len() - 8, whole.len() - 1] {
        fs::write(&file, &whole[..length]).unwrap();
        refused(&file, &prepared, "is cut short");
    }
    fs::write(&file, [&whole[..], b"more"].concat()).unwrap();
    refused(&file, &prepared, "4 bytes longer");
    fs::write(&file, b"# an OBJ\nv 0 0 0\n").unwrap();
    refused(&file, &prepared, "is no bake");
    fs::write(&file, b"").unwrap();
    refused(&file, &prepared, "is no bake");
    assert!(matches!(BakedVisibility::load(&folder.file("none"), &prepared), Err(Error::File { .. })));

    // A vertex moved by a millimetre, and it is another scene.
    fs::write(&file, &whole).unwrap();
    let mut other = scene.clone();
    other.objects[3].position.x += 0.001;
    refused(&file, &PreparedScene::new(&other).unwrap(), "another scene");
}

#[test]
fn a_journal_of_another_bake_is_left_alone() {
    let folder = Folder::new("journal");
    let (scene, options) = small_city();
    let (file, part) = (folder.file("city.bake"), folder.file("city.bake.part"));
    let workers = Workers::new(1).unwrap();
    let begin =
        |options: &BakeOptions| bake(&scene, options, Level::best(), &workers, &file, |_| ControlFlow::Break(()));
    assert_eq!(begin(&options).unwrap(), None);
    let finer = BakeOptions { side: 49, ..options };
    assert!(
        matches!(begin(&finer), Err(Error::Format { path, reason, .. }) if path == part && reason.contains("another scene or grid"))
    );
    // While a bake is at work, another of the same file is an error.
    let mut second = None;
    let busy = |_| {
        second.get_or_insert_with(|| begin(&options));
        ControlFlow::Break(())
    };
    bake(&scene, &options, Level::best(), &workers, &file, busy).unwrap();
    assert!(
        matches!(second, Some(Err(Error::File { path, reason })) if path == part && reason.contains("another bake"))
    );
    fs::write(&part, "my notes").unwrap();
    assert!(
        matches!(begin(&options), Err(Error::Format { path, reason, .. }) if path == part && reason.contains("no journal"))
    );
    assert_eq!(fs::read(&part).unwrap(), b"my notes");
    for near in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(begin(&BakeOptions { near, ..options }), Err(Error::Parameter { name, .. }) if name == "near")
        );
    }
}

#[test]
fn inside_walls_and_behind_back_sides_nobody_stands() {
    let folder = Folder::new("reach");
    let file = folder.file("reach.bake");
    let sights = |scene: &Scene| {
        let grid = grid(3, 1, 1, DVec3::new(0.0, -1.0, -1.0), DVec3::new(30.0, 1.0, 1.0));
        baked(scene, &BakeOptions { grid, side: 32, near: 0.01 }, Level::best(), 1, &file);
        let bake = BakedVisibility::load(&file, &PreparedScene::new(scene).unwrap()).unwrap();
        [0, 1, 2].map(|point| bake.sight(point))
    };
    let boxes = |facing: Facing, inner: bool| {
        let mut b = Builder::new();
        // The points are at x = 5, 15 and 25; around the second stands a box.
        b.cuboid(Vec3::new(11.0, -4.0, -4.0), Vec3::new(19.0, 4.0, 4.0), facing);
        b.cuboid(Vec3::new(-9.0, -4.0, -4.0), Vec3::new(-5.0, 4.0, 4.0), facing);
        if inner {
            b.cuboid(Vec3::new(17.0, -1.0, -1.0), Vec3::new(18.0, 1.0, 1.0), facing);
        }
        b.0
    };
    let seen = |sight: &Sight| matches!(sight, Sight::Seen(seen) if !seen.is_empty());
    let [left, middle, right] = sights(&boxes(Facing::Both, false));
    assert!(seen(&left) && middle == Sight::Enclosed && seen(&right));
    // A room with something in it is a place to be, if its walls are drawn from inside.
    let [_, middle, _] = sights(&boxes(Facing::Both, true));
    assert!(seen(&middle), "{middle:?}");
    let [left, middle, right] = sights(&boxes(Facing::Front, true));
    assert!(seen(&left) && middle == Sight::BackSides && seen(&right), "{middle:?}");
}

#[test]
fn the_eye_snaps_onto_the_nearest_point_that_was_not_skipped() {
    let grid = grid(4, 2, 3, DVec3::new(-8.0, 0.0, 10.0), DVec3::new(8.0, 2.0, 40.0));
    assert_eq!(grid.points(), 24);
    assert_eq!(grid.point(0), DVec3::new(-6.0, 0.5, 15.0));
    assert_eq!(grid.point(23), DVec3::new(6.0, 1.5, 35.0));
    let mut r = oracle::random::Random::new(5);
    for _ in 0..2000 {
        let eye = DVec3::new(r.range(-16.0, 16.0), r.range(-3.0, 5.0), r.range(-5.0, 55.0));
        let (reach, skipped) = (r.range(0.0, 30.0), r.below(25));
        let best = (0..24)
            .filter(|&p| p != skipped && grid.point(p).distance(eye) <= reach)
            .min_by(|&a, &b| grid.point(a).distance(eye).total_cmp(&grid.point(b).distance(eye)));
        assert_eq!(grid.nearest(eye, reach, |p| p != skipped), best, "{eye} {reach}");
    }
    assert_eq!(grid.nearest(DVec3::NAN, 1e9, |_| true), None);
    let flat = ViewGrid::new(UVec3::new(2, 1, 1), DVec3::ZERO, DVec3::X).unwrap();
    assert_eq!(flat.nearest(DVec3::new(0.9, 0.0, 0.0), 0.5, |_| true), Some(1));
    for (cells, max) in
        [((0, 1, 1), 1.0), ((1025, 1, 1), 1.0), ((1024, 1024, 8), 1.0), ((1, 1, 1), -1.0), ((1, 1, 1), f64::NAN)]
    {
        let cells = UVec3::new(cells.0, cells.1, cells.2);
        assert!(matches!(ViewGrid::new(cells, DVec3::ZERO, DVec3::splat(max)), Err(Error::Parameter { .. })));
    }
}

#[test]
fn culling_with_a_bake_keeps_the_picture() {
    let folder = Folder::new("picture");
    let generated = parse("city:triangles=20000").unwrap();
    let cameras = generated.path.sample(5).unwrap();
    let eyes = cameras.iter().map(|c| c.eye);
    let (min, max) = eyes.fold((DVec3::MAX, DVec3::MIN), |(a, b), eye| (a.min(eye), b.max(eye)));
    let file = folder.file("city.bake");
    let options = BakeOptions { grid: grid(5, 2, 5, min, max), side: 64, near: 0.1 };
    baked(&generated.scene, &options, Level::best(), 2, &file);

    let scene = PreparedScene::new(&generated.scene).unwrap();
    let views: Vec<View> = cameras.iter().map(|c| c.view(viewport(320, 256)).unwrap()).collect();
    let bake = file.display();
    let methods = [
        "vfc".to_owned(),
        format!("hom:rest=0,select=baked,bake={bake}"),
        format!("hom:rest=0,select=baked,bake={bake},occluder-triangles=300,database=static"),
        format!("hom:rest=0,select=baked,bake={bake},snap=0"),
    ];
    let methods: Vec<Method> = methods.iter().map(|m| Method::parse(m).unwrap()).collect();
    let workers = Workers::new(1).unwrap();
    let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
    let report = walk("city", &scene, &views, &methods, &options, |_| Ok(())).unwrap();
    for run in &report.runs {
        assert_eq!(run.image_hash, report.runs[0].image_hash, "{:?}", run.parameters);
        assert!(run.frames.iter().all(|f| f.wrongly_culled == Some(0) && f.wrong_pixels == Some(0)));
    }
    let drawn = |run: usize| report.runs[run].frames.iter().map(|f| f.triangles_drawn).sum::<u64>();
    assert!(drawn(1) < drawn(0), "nothing was culled");
}

#[test]
fn far_from_every_view_point_the_distance_decides() {
    let folder = Folder::new("far");
    let (scene, options) = small_city();
    let file = folder.file("city.bake");
    baked(&scene, &options, Level::best(), 2, &file);
    let prepared = PreparedScene::new(&scene).unwrap();
    let world = World::new(&prepared);
    let bake = BakedVisibility::load(&file, &prepared).unwrap();
    let point = (0..options.grid.points()).find(|&p| bake.objects(p).len() > 3).unwrap();
    let parameters = |text: &str| match Method::parse(text).unwrap() {
        Method::Hom(parameters) => parameters,
        other => panic!("{other:?}"),
    };
    let chosen = |text: &str, eye: DVec3| {
        let parameters = parameters(text);
        let target = eye + DVec3::new(0.3, 0.0, 1.0);
        let camera = Camera { eye, target, up: DVec3::Y, fov_y_deg: 70.0, near: 0.1, far: None };
        let view = camera.view(viewport(64, 64)).unwrap();
        let frame = HomFrame::new(&view, Level::best(), &parameters).unwrap();
        let frame = hom::select_occluders(&world, Level::best(), &view, &parameters, frame).unwrap();
        (frame.snapped(), frame.chosen().to_vec())
    };
    let baked = format!("hom:select=baked,bake={},occluder-triangles=600", file.display());
    let near = options.grid.point(point);
    let near_by = near + options.grid.cell_size() * 0.1;
    let (snapped, objects) = chosen(&format!("{baked},fill=off"), near_by);
    assert_eq!(snapped, Some(point));
    // What it sees first, in that order: those in the frustum.
    let mut list = bake.objects(point).iter();
    assert!(!objects.is_empty() && objects.iter().all(|o| list.any(|l| l == o)), "{objects:?}");
    // When all of them are taken, the nearest others follow.
    let (_, listed) = chosen(&format!("{baked},fill=off,occluder-triangles=3000"), near_by);
    let (_, filled) = chosen(&format!("{baked},occluder-triangles=3000"), near_by);
    assert!(filled.starts_with(&listed) && filled.len() > listed.len(), "{listed:?} {filled:?}");
    let (_, nearest) = chosen("hom:occluder-triangles=100000", near_by);
    let mut others = nearest.iter().filter(|o| !listed.contains(o));
    assert!(filled[listed.len()..].iter().all(|o| others.next() == Some(o)), "{filled:?} {nearest:?}");
    let far = near + DVec3::Y * 1000.0 + DVec3::X;
    assert_eq!(chosen(&baked, far), chosen("hom:occluder-triangles=600", far));
    assert_eq!(chosen(&format!("{baked},snap=0"), near + DVec3::X).0, None);

    assert!(matches!(Method::parse("hom:select=baked"), Err(Error::Parameter { name, .. }) if name == "select"));
    let lacking = parameters(&format!("hom:select=baked,bake={}", folder.file("none").display()));
    assert!(
        matches!(OccluderSources::new(&prepared, &lacking), Err(Error::File { path, .. }) if path == folder.file("none"))
    );
}
