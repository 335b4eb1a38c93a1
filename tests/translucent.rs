//! Translucent occluders: alone they hide nothing, fused they do, and nothing between them is lost (thesis 4.4).

mod oracle;

use glam::{DVec3, Vec3};
use homcull::cull::hom::{self, HomFrame};
use homcull::cull::vfc::World;
use homcull::cull::{HomParameters, Method};
use homcull::geometry::Aabb;
use homcull::occlusion::{
    BandJob, DepthReading, DepthRepresentation, Occluder, OcclusionBuffer, OcclusionSettings, Partitions, Verdict,
    Visible, optical_depth,
};
use homcull::raster::Facing;
use homcull::scene::PreparedScene;
use homcull::view::{Camera, View};
use homcull::workers::Workers;
use homcull_simd::Level;
use oracle::random::Random;
use oracle::scenes::{Builder, camera, flat_view, viewport};
use oracle::state::{begun, for_levels};

/// A rectangle of samples at one depth.
#[derive(Clone, Copy)]
struct Pane {
    x: [u32; 2],
    y: [u32; 2],
    z: f32,
    opacity: f32,
}

fn scene(panes: &[Pane]) -> PreparedScene {
    let mut b = Builder::new();
    for p in panes {
        let corner = |i: usize, j: usize| Vec3::new(p.x[i] as f32, p.y[j] as f32, p.z);
        let quad = [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]];
        b.triangles(&quad, Facing::Both).opacity = p.opacity;
    }
    b.prepared()
}

fn random_panes(r: &mut Random, width: u32, height: u32) -> Vec<Pane> {
    let mut range = |size: u32| {
        let (a, b) = (r.below(size as usize + 1) as u32, r.below(size as usize + 1) as u32);
        [a.min(b), a.max(b)]
    };
    let sides: Vec<([u32; 2], [u32; 2])> = (0..14).map(|_| (range(width), range(height))).collect();
    let opacity = |r: &mut Random| [1.0, 1.0, 0.0, 0.3, 0.5, 0.9, 0.99, f32::NAN][r.below(8)];
    sides.into_iter().map(|(x, y)| Pane { x, y, z: r.float(0.1, 0.9), opacity: opacity(r) }).collect()
}

/// What a sample comes to: covered, and its effective depth.
fn sample(panes: &[Pane], fusion: Option<f64>, x: u32, y: u32) -> (bool, f32) {
    let over = || panes.iter().filter(|p| (p.x[0]..p.x[1]).contains(&x) && (p.y[0]..p.y[1]).contains(&y));
    let opaque = over().filter(|p| p.opacity == 1.0).map(|p| p.z).fold(0.0, f32::max);
    let depth = |p: &Pane| {
        if p.opacity > 0.0 && p.opacity < 1.0 { (-256.0 * (1.0 - f64::from(p.opacity)).log2()) as u32 } else { 0 }
    };
    let layers: Vec<(u32, f32)> = over().map(|p| (depth(p), p.z)).filter(|&(d, _)| d > 0).collect();
    let sum = f64::from(layers.iter().map(|&(d, _)| d).sum::<u32>());
    let fuses = fusion.is_some_and(|f| !layers.is_empty() && sum >= (-256.0 * (1.0 - f).log2()).ceil());
    let fused = if fuses { layers.iter().map(|&(_, z)| z).fold(1.0, f32::min) } else { 0.0 };
    (opaque > 0.0 || fuses, opaque.max(fused))
}

fn settings(fusion: Option<f64>, reading: DepthReading) -> OcclusionSettings {
    let depth = DepthRepresentation::NoBackground(reading);
    OcclusionSettings { fusion, depth, ..OcclusionSettings::default() }
}

#[test]
fn fused_samples_are_those_whose_layers_add_up_and_lie_at_the_farthest() {
    let mut r = Random::new(1);
    let mut fused = 0;
    for round in 0..24 {
        let (w, h) = [(64, 40), (33, 17), (100, 9)][round % 3];
        let view = flat_view(viewport(w, h));
        let panes = random_panes(&mut r, w, h);
        let world = scene(&panes);
        let fusion = [None, Some(0.5), Some(0.95), Some(0.999)][round % 4];
        let should: Vec<(bool, u32)> = (0..h)
            .flat_map(|y| (0..w).map(move |x| (x, y)))
            .map(|(x, y)| sample(&panes, fusion, x, y))
            .map(|(covered, z)| (covered, z.to_bits()))
            .collect();
        let opaque = (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).map(|(x, y)| sample(&panes, None, x, y).0);
        fused += should.iter().zip(opaque).filter(|((covered, _), opaque)| *covered && !opaque).count();
        let mut hashes = Vec::new();
        for order in 0..3 {
            let occluders = if order == 0 { world.occluders.clone() } else { r.shuffled(&world.occluders) };
            for_levels("fused", |level| {
                let mut buffer = begun(level, &view, settings(fusion, DepthReading::PerSample));
                match order {
                    0 => buffer.submit(&world.meshes, &occluders).unwrap(),
                    1 => occluders.chunks(3).for_each(|piece| buffer.submit(&world.meshes, piece).unwrap()),
                    _ => {
                        let run = |jobs: &mut [BandJob<'_>]| jobs.iter_mut().rev().for_each(|j| j.run());
                        buffer.submit_in_bands(&world.meshes, &occluders, 2, run).unwrap();
                    }
                }
                let is: Vec<(bool, u32)> = (0..h)
                    .flat_map(|y| (0..w).map(move |x| (x, y)))
                    .map(|(x, y)| (buffer.covered(x, y).unwrap(), buffer.depth_at(x, y).unwrap().to_bits()))
                    .collect();
                let wrong = (0..is.len()).find(|&i| is[i] != should[i]);
                let at = wrong.map(|i| (i as u32 % w, i as u32 / w, is[i], should[i]));
                assert_eq!(at, None, "round {round}, order {order}, {}: is, should be", level.name());
                vec![buffer.state_hash()]
            })
            .iter()
            .for_each(|&hash| hashes.push(hash));
        }
        assert!(hashes.iter().all(|h| *h == hashes[0]), "round {round}: the order tells");
    }
    assert!(fused > 1000, "{fused} samples were fused");
}

#[test]
fn a_box_is_hidden_where_every_sample_is_covered_and_nearer() {
    let mut r = Random::new(2);
    let (mut hidden, mut all) = (0, 0);
    for round in 0..24 {
        let (w, h) = [(64, 40), (50, 24)][round % 2];
        let view = flat_view(viewport(w, h));
        let mut panes = random_panes(&mut r, w, h);
        panes.push(Pane { x: [0, w], y: [0, h], z: 0.2, opacity: 0.9 });
        panes.push(Pane { x: [0, w], y: [0, h], z: 0.4, opacity: 0.9 });
        let world = scene(&panes);
        let fusion = Some([0.95, 0.98, 0.999][round % 3]);
        let at = |x: u32, y: u32| sample(&panes, fusion, x, y);
        let boxes: Vec<(u32, u32, u32, u32, f32)> = (0..80)
            .map(|_| {
                let (x, y) = (r.below(w as usize) as u32, r.below(h as usize) as u32);
                (x, y, x + r.below((w - x) as usize) as u32, y + r.below((h - y) as usize) as u32, r.float(0.05, 0.6))
            })
            .collect();
        for reading in [DepthReading::PerSample, DepthReading::PerBlock] {
            let is = for_levels("boxes", |level| {
                let mut buffer = begun(level, &view, settings(fusion, reading));
                buffer.submit(&world.meshes, &world.occluders).unwrap();
                boxes.iter().map(|&(x0, y0, x1, y1, z)| is_hidden(&buffer, [x0, y0, x1, y1], z)).collect::<Vec<_>>()
            });
            for (&(x0, y0, x1, y1, z), is) in boxes.iter().zip(is) {
                let nearer = |x: u32, y: u32| {
                    let own = at(x, y).1;
                    let (bx, by) = (x / 8 * 8, y / 8 * 8);
                    let block = || (by..(by + 8).min(h)).flat_map(|y| (bx..(bx + 8).min(w)).map(move |x| (x, y)));
                    let farthest = block().map(|(x, y)| at(x, y)).filter(|s| s.0).map(|s| s.1).fold(1.0, f32::min);
                    z < if reading == DepthReading::PerSample { own } else { farthest }
                };
                let should = (y0..=y1).all(|y| (x0..=x1).all(|x| at(x, y).0 && nearer(x, y)));
                assert_eq!(is, should, "round {round}, {reading:?}, box {:?}", (x0, y0, x1, y1, z));
                hidden += u32::from(is);
                all += 1;
            }
        }
    }
    assert!(hidden > 300 && all - hidden > 300, "{hidden} of {all} are hidden");
}

fn is_hidden(buffer: &OcclusionBuffer, [x0, y0, x1, y1]: [u32; 4], z: f32) -> bool {
    let min = Vec3::new(x0 as f32 + 0.4, y0 as f32 + 0.4, z - 0.01);
    let max = Vec3::new(x1 as f32 + 0.6, y1 as f32 + 0.6, z);
    buffer.test(Aabb { min, max }, DVec3::ZERO).unwrap().is_hidden()
}

#[test]
fn a_surface_counts_once_however_it_is_clipped_and_cut_into_blocks() {
    // Half lets half through: two layers reach 0.6, one never does.
    let mut r = Random::new(3);
    let (mut covered, mut clipped) = (0, 0);
    for round in 0..60 {
        let view = camera(&mut r, DVec3::ZERO).view(viewport(97, 66)).unwrap();
        let size = [2.0, 20.0, 200.0][round % 3];
        let mut b = Builder::new();
        let mut corner = || Vec3::new(r.float(-size, size), r.float(-size, size), r.float(-size, size));
        b.triangles(&[[corner(), corner(), corner()]], Facing::Both).opacity = 0.5;
        let world = b.prepared();
        for_levels("one triangle", |level| {
            let count = |occluders: &[Occluder], fusion| {
                let mut buffer = begun(level, &view, settings(Some(fusion), DepthReading::PerSample));
                buffer.submit(&world.meshes, occluders).unwrap();
                let all = (0..66).flat_map(|y| (0..97).map(move |x| (x, y)));
                (all.filter(|&(x, y)| buffer.covered(x, y).unwrap()).count(), buffer.counts().clipped)
            };
            let opaque = Occluder { opaque: true, ..world.occluders[0] };
            let (once, twice) = (count(&world.occluders, 0.5), count(&world.occluders, 0.6));
            assert_eq!((once.0, twice.0), (count(&[opaque], 0.5).0, 0), "round {round}");
            vec![once]
        })
        .iter()
        .for_each(|&(samples, cut)| (covered, clipped) = (covered + samples, clipped + cut));
    }
    assert!(covered > 5000 && clipped > 5, "{covered} samples, {clipped} clipped");
}

/// Two panes, one behind the other; a box in front of them, one between, and one behind, none before another.
fn panes(opacity: f32) -> (View, PreparedScene) {
    let lens = Camera { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y_deg: 60.0, near: 0.1, far: None };
    let mut b = Builder::new();
    let mut slab = |x: f32, half: f32, z: f32, opacity: f32| {
        let (min, max) = (Vec3::new(x - half, -half, z - 0.2), Vec3::new(x + half, half, z));
        b.cuboid(min, max, Facing::Front).opacity = opacity;
    };
    slab(-1.0, 0.3, -3.0, 1.0);
    slab(0.0, 20.0, -5.0, opacity);
    slab(0.0, 0.8, -7.0, 1.0);
    slab(0.0, 20.0, -9.0, opacity);
    slab(4.0, 1.0, -12.0, 1.0);
    (lens.view(viewport(96, 80)).unwrap(), b.prepared())
}

const IN_FRONT: usize = 0;
const BETWEEN: usize = 2;
const BEHIND: usize = 4;

#[test]
fn an_object_between_two_panes_is_visible() {
    let (view, world) = panes(0.9);
    let nbz = DepthRepresentation::default();
    let verdicts = |fusion, depth| {
        for_levels("panes", |level| {
            let settings = OcclusionSettings { fusion, depth, ..OcclusionSettings::default() };
            let mut buffer = begun(level, &view, settings);
            let glass: Vec<Occluder> = world.occluders.iter().filter(|o| !o.opaque).copied().collect();
            buffer.submit(&world.meshes, &glass).unwrap();
            world.bounds.iter().map(|&b| buffer.test(b, world.origin).unwrap()).collect::<Vec<_>>()
        })
    };
    assert!(verdicts(None, nbz).iter().all(|v| !v.is_hidden()), "glass that is not fused hides nothing");
    // A far boundary lies behind the farther pane too.
    for depth in [nbz, DepthRepresentation::Estimation(Partitions::default()), DepthRepresentation::Plane] {
        let fused = verdicts(Some(0.98), depth);
        assert_eq!(fused[BETWEEN], Verdict::Visible(Visible::InFront), "{depth:?}");
        assert!(!fused[IN_FRONT].is_hidden() && fused[BEHIND].is_hidden(), "{depth:?}: {fused:?}");
    }
    assert!(verdicts(Some(0.995), nbz).iter().all(|v| !v.is_hidden()), "two panes let a hundredth through");
}

#[test]
fn every_method_draws_what_lies_between_two_panes() {
    let (view, world) = panes(0.9);
    let world = World::new(&world);
    let workers = Workers::new(1).unwrap();
    for method in ["hom", "hom-multipass:update-triangles=0", "hom-multipass", "hom-progressive"] {
        for (fusion, hides) in [("off", false), ("0.98", true), ("0.999", false)] {
            let name = format!("{method}{}fusion={fusion}", if method.contains(':') { "," } else { ":" });
            let Method::Hom(parameters) = Method::parse(&name).unwrap() else { panic!("{name}") };
            let drawn = drawn(&world, &view, &workers, &parameters);
            let batches = method == "hom-multipass";
            assert!(drawn.contains(&(IN_FRONT as u32)) && drawn.contains(&(BETWEEN as u32)), "{name}: {drawn:?}");
            // Twelve triangles are fewer than a batch: nothing is ever submitted.
            assert_eq!(!drawn.contains(&(BEHIND as u32)), hides && !batches, "{name}: {drawn:?}");
        }
    }
}

fn drawn(world: &World<'_>, view: &View, workers: &Workers, parameters: &HomParameters) -> Vec<u32> {
    let level = Level::best();
    let frame = HomFrame::new(view, level, parameters).unwrap();
    let frame = hom::select_occluders(world, level, view, parameters, frame).unwrap();
    let frame = hom::draw_occluders(world, workers, frame).unwrap();
    hom::cull(world, workers, parameters, hom::build_pyramid(frame)).unwrap().0.objects
}

#[test]
fn however_many_panes_are_no_opaque_occluder_by_accident() {
    let (view, _) = panes(0.9);
    let mut b = Builder::new();
    for i in 0..40 {
        let z = -5.0 - 0.1 * i as f32;
        b.cuboid(Vec3::new(-20.0, -20.0, z), Vec3::new(20.0, 20.0, z + 0.05), Facing::Both).opacity = 1.0 - 1e-7;
    }
    let glass = b.prepared();
    assert!(glass.occluders.iter().all(|o| !o.opaque && o.optical_depth == optical_depth((1.0_f32 - 1e-7).into())));
    let mut buffer = begun(Level::best(), &view, OcclusionSettings::default());
    let empty = buffer.state_hash();
    buffer.submit(&glass.meshes, &glass.occluders).unwrap();
    assert_eq!(buffer.state_hash(), empty);
    // Fused, what is cut out entirely (opacity 0) still is none.
    let mut none = glass.occluders.clone();
    none.iter_mut().for_each(|o| o.optical_depth = 0);
    let mut buffer = begun(Level::best(), &view, settings(Some(0.5), DepthReading::PerSample));
    buffer.submit(&glass.meshes, &none).unwrap();
    assert_eq!(buffer.state_hash(), empty);
}

#[test]
fn a_new_view_begins_without_layers() {
    let (view, world) = panes(0.9);
    let behind = world.bounds[BEHIND];
    let hidden = for_levels("views", |level| {
        let mut buffer = begun(level, &view, settings(Some(0.98), DepthReading::PerSample));
        let mut hidden = Vec::new();
        for occluders in [&world.occluders[..], &world.occluders[..2], &world.occluders[..]] {
            buffer.begin(&view).unwrap();
            buffer.submit(&world.meshes, occluders).unwrap();
            hidden.push(buffer.test(behind, world.origin).unwrap().is_hidden());
        }
        hidden
    });
    assert_eq!(hidden, [true, false, true]);
}
