//! Precomputed visibility: what is drawn is what the nearest view point's list names of the frustum; away from all view points,
//! everything in it; and what is wrong with that picture, in numbers.
#![cfg(feature = "cli")]

mod oracle;

use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;

use glam::{DVec3, UVec3};
use homcull::cull::pvs::{Pvs, PvsParameters};
use homcull::cull::vfc::{self, VfcMemory, World};
use homcull::cull::{Method, VisibleSet};
use homcull::measure::bake::{BakeOptions, bake};
use homcull::measure::report::MethodRun;
use homcull::measure::walk::{WalkOptions, walk};
use homcull::scene::{PreparedScene, Scene, parse};
use homcull::select::{BakedVisibility, ViewGrid};
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull::{Error, Level};
use oracle::random::Random;
use oracle::scenes::viewport;

/// A bake in a folder of this process and test, of a small city about the first eye of its path.
struct Baked {
    folder: PathBuf,
    file: PathBuf,
    scene: Scene,
    grid: ViewGrid,
}

impl Baked {
    fn new(name: &str, cells: UVec3, side: u32) -> Baked {
        let folder = std::env::temp_dir().join(format!("homcull-pvs-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let generated = parse("city:triangles=5000").unwrap();
        let (from, reach) = (generated.path.keys[0].eye, DVec3::new(20.0, 1.0, 20.0));
        let grid = ViewGrid::new(cells, from - reach, from + reach).unwrap();
        let (file, scene) = (folder.join("city.bake"), generated.scene);
        let (options, workers) = (BakeOptions { grid, side, near: 0.1 }, Workers::new(2).unwrap());
        bake(&scene, &options, Level::best(), &workers, &file, |_| ControlFlow::Continue(())).unwrap().unwrap();
        Baked { folder, file, scene, grid }
    }

    fn parameters(&self, snap: f32, eight: bool) -> PvsParameters {
        PvsParameters { bake: Some(self.file.clone()), snap, eight }
    }

    /// A walk past these eyes by `vfc` and `pvs`: the latter's.
    fn walk(&self, views: &[View], snap: f32, eight: bool) -> MethodRun {
        let methods = [Method::Vfc, Method::Pvs(self.parameters(snap, eight))];
        let workers = Workers::new(1).unwrap();
        let options = WalkOptions { level: Level::best(), workers: &workers, repetitions: 1, exact: true };
        let scene = PreparedScene::new(&self.scene).unwrap();
        walk("a city", &scene, views, &methods, &options, |_| Ok(())).unwrap().runs.swap_remove(1)
    }
}

impl Drop for Baked {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Looks from an eye along a direction in the ground's plane.
fn look(eye: DVec3, turn: f64) -> View {
    let ahead = DVec3::new(libm::cos(turn), 0.0, libm::sin(turn));
    let camera = Camera { eye, target: eye + ahead, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    camera.view(viewport(64, 48)).unwrap()
}

/// Eyes in the box of the grid, whose sides are stretched by a factor.
fn eyes(grid: &ViewGrid, n: usize, stretch: f64) -> Vec<DVec3> {
    let mut r = Random::new(5);
    let (min, max) = grid.corners();
    let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5 * stretch);
    (0..n).map(|_| middle + half * DVec3::new(r.range(-1.0, 1.0), r.range(-1.0, 1.0), r.range(-1.0, 1.0))).collect()
}

fn in_frustum(world: &World<'_>, view: &View) -> VisibleSet {
    vfc::cull(world, Level::best(), view, &mut VfcMemory::default())
}

#[test]
fn drawn_is_what_the_nearest_list_names_of_the_frustum() {
    let baked = Baked::new("lists", UVec3::new(4, 1, 4), 48);
    let scene = PreparedScene::new(&baked.scene).unwrap();
    let world = World::new(&scene);
    let (bake, grid) = (BakedVisibility::load(&baked.file, &scene).unwrap(), &baked.grid);
    for snap in [0.4f32, 1.0] {
        let mut pvs = Pvs::new(&scene, &baked.parameters(snap, false)).unwrap();
        let (mut near, mut away, mut fewer) = (0, 0, 0);
        for (i, eye) in eyes(grid, 100, 1.6).into_iter().enumerate() {
            let view = look(eye, i as f64);
            let all = in_frustum(&world, &view);
            let set = pvs.cull(&world, Level::best(), &view);
            // The nearest by brute force; of a skipped point, the list is empty and it is no choice.
            let distance = |p: &usize| grid.point(*p).distance(eye);
            let usable = (0..grid.points()).filter(|&p| !bake.objects(p).is_empty());
            let nearest = usable.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            if distance(&nearest) > grid.cell_size().length() * f64::from(snap) {
                assert_eq!(set, VisibleSet { bypassed: true, ..all }, "eye {i}: as vfc, and it says so");
                away += 1;
                continue;
            }
            let named = bake.objects(nearest);
            let should: Vec<u32> = all.objects.iter().copied().filter(|o| named.contains(o)).collect();
            assert_eq!(set.objects, should, "eye {i}");
            assert_eq!(set.triangles_hidden, all.triangles_in_frustum - world.triangles(&should));
            assert!(!set.bypassed && set.queries == 0 && set.in_frustum == all.in_frustum);
            near += 1;
            fewer += usize::from(set.objects.len() < all.objects.len());
        }
        assert!(near > 5 && away > 5 && fewer > 4, "{near} near, {away} away, {fewer} with fewer objects");
    }
}

#[test]
fn of_eight_points_drawn_is_what_any_of_their_lists_names() {
    let baked = Baked::new("eight", UVec3::new(4, 2, 5), 48);
    let scene = PreparedScene::new(&baked.scene).unwrap();
    let world = World::new(&scene);
    let (bake, grid) = (BakedVisibility::load(&baked.file, &scene).unwrap(), &baked.grid);
    let (size, (min, max)) = (grid.cell_size(), grid.corners());
    let mut pvs = Pvs::new(&scene, &baked.parameters(1.0, true)).unwrap();
    let (mut several, mut away) = (0, 0);
    for (i, eye) in eyes(grid, 100, 1.4).into_iter().enumerate() {
        let view = look(eye, i as f64);
        let all = in_frustum(&world, &view);
        // Points less than a cell away along every axis from the eye, taken into the box between the points.
        let inside = eye.clamp(min + size * 0.5, max - size * 0.5);
        let around = |p: &usize| {
            let point = grid.point(*p);
            (point - inside).abs().cmplt(size * 0.999_999).all() && point.distance(eye) <= size.length()
        };
        let usable = (0..grid.points()).filter(|&p| !bake.objects(p).is_empty());
        let points: Vec<usize> = usable.filter(around).collect();
        let set = pvs.cull(&world, Level::best(), &view);
        if points.is_empty() {
            assert_eq!(set, VisibleSet { bypassed: true, ..all }, "eye {i}");
            away += 1;
            continue;
        }
        let names = |o: &u32| points.iter().any(|&p| bake.objects(p).contains(o));
        assert_eq!(set.objects, all.objects.iter().copied().filter(names).collect::<Vec<_>>(), "eye {i}");
        several += usize::from(points.len() > 3);
    }
    assert!(several > 20 && away > 0, "{several} with several points, {away} away");
}

#[test]
fn out_of_reach_the_picture_is_everything_and_the_frames_are_counted() {
    let baked = Baked::new("away", UVec3::new(2, 1, 2), 48);
    let middle = baked.grid.point(0);
    let views = [look(middle, 0.3), look(middle + DVec3::X * 900.0, 0.3), look(middle - DVec3::Z * 700.0, 1.0)];
    let run = baked.walk(&views, 1.0, false);
    let bypassed: Vec<bool> = run.frames.iter().map(|f| f.bypassed).collect();
    assert_eq!(bypassed, [false, true, true]);
    assert!(run.frames[1..].iter().all(|f| f.wrong_pixels == Some(0) && f.wrongly_culled == Some(0)));
    assert_eq!(run.bypassed_frames(), 2);
}

#[test]
fn a_finer_grid_misses_less_and_from_a_view_point_next_to_nothing_is_missing() {
    let wrong = |baked: &Baked, eight: bool, eyes: &[DVec3]| {
        let views: Vec<View> = eyes.iter().enumerate().map(|(i, &eye)| look(eye, i as f64)).collect();
        let run = baked.walk(&views, 4.0, eight);
        assert_eq!(run.bypassed_frames(), 0);
        let pixels: u64 = run.frames.iter().map(|f| f.wrong_pixels.unwrap()).sum();
        (run.wrongly_culled_objects().unwrap(), pixels)
    };
    let coarse = Baked::new("coarse", UVec3::new(1, 1, 1), 128);
    let fine = Baked::new("fine", UVec3::new(8, 1, 8), 128);
    let eyes = eyes(&coarse.grid, 40, 1.0);
    let (few, many) = (wrong(&fine, false, &eyes), wrong(&coarse, false, &eyes));
    let eight = wrong(&fine, true, &eyes);
    assert!(eight.0 < few.0 && eight.1 < few.1, "objects and pixels: of eight points {eight:?}, of one {few:?}");
    assert!(few.0 * 3 < many.0 * 2 && few.1 * 3 < many.1 * 2, "objects and pixels: fine {few:?}, coarse {many:?}");

    // The cube's samples are closer together than the view's.
    let scene = PreparedScene::new(&fine.scene).unwrap();
    let bake = BakedVisibility::load(&fine.file, &scene).unwrap();
    let usable = (0..fine.grid.points()).filter(|&p| !bake.objects(p).is_empty());
    let points: Vec<DVec3> = usable.map(|p| fine.grid.point(p)).collect();
    let (objects, pixels) = wrong(&fine, false, &points);
    let all = points.len() as u64 * 64 * 48;
    assert!(pixels * 1000 < all && pixels <= 3 * objects, "{objects} objects, {pixels} of {all} pixels");
}

#[test]
fn without_its_bake_it_is_an_error() {
    let baked = Baked::new("errors", UVec3::new(1, 1, 1), 16);
    let scene = PreparedScene::new(&baked.scene).unwrap();
    let other = PreparedScene::new(&parse("city:triangles=6000").unwrap().scene).unwrap();
    let missing = PvsParameters { bake: Some(baked.folder.join("none")), ..baked.parameters(1.0, true) };
    assert!(
        matches!(Pvs::new(&scene, &missing), Err(Error::File { path, .. }) if Some(&path) == missing.bake.as_ref())
    );
    let foreign = Pvs::new(&other, &baked.parameters(1.0, false));
    assert!(matches!(foreign, Err(Error::Format { path, .. }) if path == baked.file));
    assert!(matches!(Pvs::new(&scene, &PvsParameters::default()), Err(Error::Parameter { .. })));

    for wrong in [
        "pvs",
        "pvs:snap=1",
        "pvs:bake=",
        "pvs:bake=a,snap=-1",
        "pvs:bake=a,snap=far",
        "pvs:bake=a,points=2",
        "pvs:bake=a,fill=on",
    ] {
        assert!(matches!(Method::parse(wrong), Err(Error::Parameter { .. })), "{wrong}");
    }
    let method = Method::parse("pvs:bake=a b.bake,snap=2,points=8").unwrap();
    assert_eq!(method, Method::Pvs(PvsParameters { bake: Some("a b.bake".into()), snap: 2.0, eight: true }));
    assert_eq!(
        method.parameters(),
        [("bake".into(), "a b.bake".into()), ("snap".into(), "2".into()), ("points".into(), "8".into())]
    );
}
