//! Every SIMD level of the CPU gives the same bits: pictures, occlusion states, projected boxes, verdicts.

mod oracle;

use glam::Vec3;
use homcull::draw::Canvas;
use homcull::occlusion::{OcclusionBuffer, OcclusionSettings, ProjectedBoxes, Verdict};
use homcull::scene::PreparedScene;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{camera, city, viewport};
use oracle::state::{State, draw, for_levels, ids, levels, same, submitted};

#[test]
fn every_level_of_this_cpu_is_tested() {
    let here = levels();
    for level in Level::ALL {
        let buffer = OcclusionBuffer::with_level(viewport(8, 8), level, OcclusionSettings::default());
        assert_eq!(here.contains(&level), level.is_available());
        assert_eq!(buffer.is_ok(), level.is_available(), "a buffer at {}", level.name());
        assert_eq!(Canvas::new(viewport(8, 8), level).is_ok(), level.is_available(), "a canvas at {}", level.name());
    }
    assert_eq!(here.first(), Some(&Level::Scalar));
    assert_eq!(here.last(), Some(&Level::best()));
    let mut seen = Vec::new();
    for level in Level::ALL {
        if level.is_available() {
            seen.push(level);
        }
    }
    let tested = std::cell::RefCell::new(Vec::new());
    for_levels("which levels are run", |level| {
        tested.borrow_mut().push(level);
        vec![0]
    });
    assert_eq!(tested.into_inner(), seen);
}

#[test]
fn a_city_has_the_same_bits_at_every_level() {
    let mut r = Random::new(1);
    for round in 0..12 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
        let scene = PreparedScene::new(&city(&mut r, eye, 150)).unwrap();
        let (w, h) = [(320, 200), (257, 129), (96, 640)][round % 3];
        let view = camera(&mut r, eye.as_dvec3()).view(viewport(w, h)).unwrap();
        let what = format!("round {round}");
        for_levels(&what, |level| draw(level, &view, &scene));
        for_levels(&what, |level| State::of(&submitted(level, &view, &scene.meshes, &scene.occluders), &view));
        for_levels(&what, |level| {
            let buffer = submitted(level, &view, &scene.meshes, &scene.occluders);
            let mut projected = ProjectedBoxes::new();
            buffer.project(&scene.boxes, scene.origin, &mut projected).unwrap();
            projected.sort();
            projected.boxes().iter().map(|b| (b.id(), b.rect(), b.depth().to_bits())).collect::<Vec<_>>()
        });
        let verdicts: Vec<Verdict> = for_levels(&what, |level| {
            let buffer = submitted(level, &view, &scene.meshes, &scene.occluders);
            scene.bounds.iter().map(|&b| buffer.test(b, scene.origin).unwrap()).collect::<Vec<_>>()
        });
        assert_eq!(verdicts.len(), scene.occluders.len());
    }
}

#[test]
fn counts_of_the_rasterizer_are_the_same_at_every_level() {
    let mut r = Random::new(2);
    let eye = Vec3::new(0.0, 3.0, 0.0);
    let scene = PreparedScene::new(&city(&mut r, eye, 150)).unwrap();
    let view = camera(&mut r, eye.as_dvec3()).view(viewport(320, 200)).unwrap();
    for_levels("occluders", |level| vec![submitted(level, &view, &scene.meshes, &scene.occluders).counts()]);
    for_levels("draw", |level| vec![draw(level, &view, &scene).counts]);
}

#[test]
fn plain_triangles_leave_the_state_of_prepared_ones() {
    let mut r = Random::new(3);
    for round in 0..6 {
        let eye = Vec3::new(r.float(-9.0, 9.0), r.float(0.0, 9.0), r.float(-9.0, 9.0));
        let scene = city(&mut r, eye, 40);
        let prepared = PreparedScene::new(&scene).unwrap();
        let view = camera(&mut r, eye.as_dvec3()).view(viewport(130, 97)).unwrap();
        let placed: Vec<u32> =
            ids(&prepared).into_iter().filter(|&i| prepared.occluders[i as usize].rotation.is_none()).collect();
        let plain = for_levels("plain", |level| {
            let mut buffer = OcclusionBuffer::with_level(view.viewport(), level, OcclusionSettings::default()).unwrap();
            buffer.begin(&view).unwrap();
            for &id in &placed {
                let object = &scene.objects[id as usize];
                let mesh = &scene.meshes[object.mesh as usize];
                buffer.submit_triangles(mesh.positions(), mesh.triangles(), object.position, object.facing).unwrap();
            }
            State::of(&buffer, &view)
        });
        let occluders: Vec<_> = placed.iter().map(|&i| prepared.occluders[i as usize]).collect();
        let gold = State::of(&submitted(Level::Scalar, &view, &prepared.meshes, &occluders), &view);
        same(&format!("round {round}: plain triangles, against prepared"), &plain, &gold);
    }
}
