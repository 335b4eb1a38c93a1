//! Worlds to be judged, and what judges them: a city with a view of it, the verdicts on its boxes, and the exact item buffer.

use glam::{DMat3, DVec3, Vec3};
use homcull::geometry::SampleRect;
use homcull::occlusion::{Hidden, OcclusionBuffer, Verdict};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::{ClipSpace, DepthRange, View};
use homcull_simd::Level;

use super::random::Random;
use super::scenes::{Builder, camera, city, orthographic, perspective, viewport};
use super::state::{State, draw};

const REVERSED: ClipSpace = ClipSpace { depth: DepthRange::Reversed, y_down: false };

/// A city and a view of it: perspective or orthographic, by camera or by matrix.
pub fn world(r: &mut Random, round: usize, objects: usize) -> (View, PreparedScene) {
    let (w, h) = [(120, 80), (64, 64), (33, 31), (257, 129), (100, 1), (7, 5)][round % 6];
    let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
    let scene = PreparedScene::new(&city(r, eye, objects)).unwrap();
    let eye = eye.as_dvec3();
    let view = match round % 4 {
        0 | 1 => camera(r, eye).view(viewport(w, h)).unwrap(),
        2 => View::new(perspective(r, eye), REVERSED, viewport(w, h)).unwrap(),
        _ => View::new(orthographic(r, eye), REVERSED, viewport(w, h)).unwrap(),
    };
    (view, scene)
}

/// Any view: perspective or orthographic, by camera or by matrix.
pub fn any_view(r: &mut Random, round: usize, eye: DVec3, (w, h): (u32, u32)) -> View {
    match round % 3 {
        0 => camera(r, eye).view(viewport(w, h)).unwrap(),
        1 => View::new(perspective(r, eye), REVERSED, viewport(w, h)).unwrap(),
        _ => View::new(orthographic(r, eye), REVERSED, viewport(w, h)).unwrap(),
    }
}

/// A view, thin walls before it, the occluders, and boxes among and behind them: the number of walls comes first.
pub fn behind_walls(r: &mut Random, round: usize) -> (usize, View, PreparedScene) {
    let eye = DVec3::new(r.range(-50.0, 50.0), r.range(-5.0, 5.0), r.range(-50.0, 50.0));
    let view = any_view(r, round, eye, [(120, 80), (64, 64), (77, 50)][round % 3]);
    // Of a view from the eye: across, up, ahead.
    let axis = |row: usize| view.rows()[row].truncate();
    let ahead = (if axis(2).length() > 0.0 { axis(2) } else { -axis(3) }).normalize();
    let across = (axis(0) - ahead * axis(0).dot(ahead)).normalize();
    let frame = DMat3::from_cols(across, ahead.cross(across), ahead);
    let mut b = Builder::new();
    let walls = 3 + r.below(8);
    for n in 0..walls + 80 {
        let is_wall = n < walls;
        let z = if is_wall { r.range(3.0, 12.0) } else { r.range(3.0, 60.0) };
        let [x, y] = [0, 1].map(|_| r.range(-0.9, 0.9) * z.min(30.0));
        let size = if is_wall {
            Vec3::new(r.float(2.0, 12.0), r.float(2.0, 12.0), r.float(0.0, 0.2))
        } else {
            Vec3::new(r.float(0.05, 2.0), r.float(0.05, 2.0), r.float(0.05, 2.0))
        };
        let object = b.cuboid(-size * 0.5, size * 0.5, Facing::Both);
        object.rotation = (frame * DMat3::from_rotation_y(r.range(-0.3, 0.3))).as_mat3();
        object.position = eye + frame * DVec3::new(x, y, z);
    }
    (walls, view, b.prepared())
}

pub fn verdicts(buffer: &OcclusionBuffer, scene: &PreparedScene) -> Vec<Verdict> {
    scene.bounds.iter().map(|&b| buffer.test(b, scene.origin).unwrap()).collect()
}

/// Samples of each object in the exact item buffer, and samples that it covers, hidden or not.
pub fn samples(view: &View, scene: &PreparedScene) -> (Vec<u32>, Vec<u64>) {
    let drawn = draw(Level::best(), view, scene);
    let mut shown = vec![0; scene.occluders.len()];
    for (_, number) in drawn.items.into_iter().flatten() {
        shown[scene.object_of(number) as usize] += 1;
    }
    (shown, drawn.fragments)
}

/// Panics with all that is needed to see why when an object is called hidden and shows.
#[track_caller]
pub fn conservative(what: &str, view: &View, scene: &PreparedScene, verdicts: &[Verdict]) {
    let (shown, fragments) = samples(view, scene);
    for (id, verdict) in verdicts.iter().enumerate() {
        let about = || format!("{what}, object {id} {:?}, {view:?}", scene.bounds[id]);
        if verdict.is_hidden() && shown[id] > 0 {
            let drawn = draw(Level::best(), view, scene);
            let at =
                drawn.items.iter().position(|i| i.is_some_and(|(_, t)| scene.object_of(t) as usize == id)).unwrap();
            let (x, y) = (at as u32 % drawn.width, at as u32 / drawn.width);
            panic!(
                "{}: {verdict:?}, but shows {} samples, first ({x}, {y}) at {:e}",
                about(),
                shown[id],
                drawn.depth(at)
            );
        }
        if matches!(verdict, Verdict::Hidden(Hidden::OutsideFrustum | Hidden::NoSample)) {
            assert_eq!(fragments[id], 0, "{}: {verdict:?}, but covers samples", about());
        }
    }
}

/// True when every sample of the rectangle is covered.
pub fn all_covered(state: &State, r: SampleRect) -> bool {
    (r.y0..=r.y1).all(|y| (r.x0..=r.x1).all(|x| state.covered[y as usize * state.width as usize + x as usize]))
}

/// True when the rectangle reaches the viewport's edge: the box may then have been clipped for its verdict.
pub fn at_the_edge(view: &View, r: SampleRect) -> bool {
    let (w, h) = (view.viewport().width() as i32, view.viewport().height() as i32);
    r.x0 <= 0 || r.y0 <= 0 || r.x1 >= w - 1 || r.y1 >= h - 1
}
