//! Cells found in scenes that bring none: in worlds of walls on a lattice, with whatever holes, the picture is that of
//! everything in the frustum; walls with holes are open there and nowhere else.
#![cfg(feature = "cli")]

mod oracle;

use glam::{DVec3, Vec3};
use homcull::cull::CellsFrom;
use homcull::scene::{Cells, Facing, FoundCells, Portal, PreparedScene, find_cells, parse};
use oracle::portal_stage::Stage;
use oracle::random::Random;
use oracle::scenes::{self, Builder};

/// Places along each axis. Walls are made of the rectangles between them, two triangles each, that share all their corners: so
/// there are no T-junctions, and nothing is seen through an edge.
struct Lattice([Vec<f32>; 3]);

impl Lattice {
    fn even(sizes: [usize; 3]) -> Lattice {
        Lattice(sizes.map(|n| (0..=n).map(|i| i as f32).collect()))
    }

    fn random(r: &mut Random) -> Lattice {
        let steps = [6, 3, 6].map(|n| n + r.below(4));
        // Thick walls have their two faces near each other.
        let step = |r: &mut Random| if r.chance(0.25) { r.range(0.05, 0.3) } else { r.range(0.8, 3.0) };
        Lattice(steps.map(|n| {
            let mut at = r.range(-30.0, 10.0);
            let mut next = |_| {
                at += step(r);
                at as f32
            };
            (0..=n).map(&mut next).collect()
        }))
    }

    fn steps(&self, axis: usize) -> usize {
        self.0[axis].len() - 1
    }

    fn point(&self, p: [usize; 3]) -> Vec3 {
        Vec3::new(self.0[0][p[0]], self.0[1][p[1]], self.0[2][p[2]])
    }

    /// The two triangles of the rectangle (u, v) across an axis, in the axes after it.
    fn face(&self, axis: usize, plane: usize, [u, v]: [usize; 2]) -> [[Vec3; 3]; 2] {
        let corner = |du: usize, dv: usize| {
            let mut p = [plane; 3];
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u + du, v + dv);
            self.point(p)
        };
        let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        [[a, b, c], [a, c, d]]
    }

    /// All rectangles across an axis.
    fn faces(&self, axis: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [us, vs] = [1, 2].map(|k| self.steps((axis + k) % 3));
        (0..us).flat_map(move |u| (0..vs).map(move |v| [u, v]))
    }

    /// The triangles of a wall but for the rectangles that a door takes.
    fn wall(&self, axis: usize, plane: usize, is_door: impl Fn([usize; 2]) -> bool) -> Vec<[Vec3; 3]> {
        self.faces(axis).filter(|&f| !is_door(f)).flat_map(|f| self.face(axis, plane, f)).collect()
    }

    /// A shell around it all.
    fn shell(&self, world: &mut Builder) {
        for axis in 0..3 {
            for plane in [0, self.steps(axis)] {
                world.triangles(&self.wall(axis, plane, |_| false), Facing::Both);
            }
        }
    }
}

/// Two rooms in a shell of 8 x 3 x 4, parted at x = 4 by what `wall` makes of a lattice.
fn two_rooms(wall: impl Fn(&Lattice, &mut Builder)) -> PreparedScene {
    let lattice = Lattice::even([8, 3, 4]);
    let mut world = Builder::new();
    lattice.shell(&mut world);
    wall(&lattice, &mut world);
    world.cuboid(Vec3::new(1.2, 0.2, 1.4), Vec3::new(1.9, 0.9, 2.1), Facing::Both);
    world.cuboid(Vec3::new(6.2, 0.2, 1.4), Vec3::new(6.9, 0.9, 2.1), Facing::Both);
    world.prepared()
}

/// The portals in a plane across x.
fn at_x(cells: &Cells, x: f64) -> Vec<Portal> {
    cells.portals().iter().filter(|p| p.axis() == 0 && p.min.x == x).copied().collect()
}

#[track_caller]
fn opens(scene: &PreparedScene, min: [f64; 3], max: [f64; 3]) {
    let FoundCells { cells, .. } = find_cells(scene);
    let portals = at_x(&cells, 4.0);
    let around = portals.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p.min), b.max(p.max)));
    assert_eq!(around, (DVec3::from_array(min), DVec3::from_array(max)), "{portals:?}");
}

#[test]
fn a_wall_is_open_at_its_door_and_nowhere_else() {
    let scene = two_rooms(|l, world| {
        world.triangles(&l.wall(0, 4, |[y, z]| y < 2 && z == 2), Facing::Both);
    });
    opens(&scene, [4.0, 0.0, 2.0], [4.0, 2.0, 3.0]);
}

#[test]
fn a_door_in_the_very_corner_opens_there() {
    let scene = two_rooms(|l, world| {
        world.triangles(&l.wall(0, 4, |[y, z]| y == 0 && z == 0), Facing::Both);
    });
    opens(&scene, [4.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
}

#[test]
fn one_missing_triangle_opens_its_rectangle() {
    let scene = two_rooms(|l, world| {
        let mut wall = l.wall(0, 4, |f| f == [1, 2]);
        wall.push(l.face(0, 4, [1, 2])[0]);
        world.triangles(&wall, Facing::Both);
    });
    opens(&scene, [4.0, 1.0, 2.0], [4.0, 2.0, 3.0]);
}

#[test]
fn a_wall_without_holes_parts_the_rooms_for_good() {
    let scene = two_rooms(|l, world| {
        world.triangles(&l.wall(0, 4, |_| false), Facing::Both);
    });
    let found = find_cells(&scene);
    assert_eq!((at_x(&found.cells, 4.0).len(), found.covered > 0.5), (0, true));
}

#[test]
fn what_is_translucent_or_has_a_back_that_is_not_drawn_is_no_wall() {
    let glass = two_rooms(|l, world| {
        world.triangles(&l.wall(0, 4, |_| false), Facing::Both).opacity = 0.9;
    });
    assert_eq!(at_x(&find_cells(&glass).cells, 4.0), [], "nothing parts the room there");
    for facing in [Facing::Front, Facing::Back] {
        let half = two_rooms(|l, world| {
            world.triangles(&l.wall(0, 4, |_| false), facing);
        });
        // Its plane may part cells, which are then open to each other: it hides from one side alone.
        let cells = find_cells(&half).cells;
        let area = |p: &Portal| (p.max - p.min).y * (p.max - p.min).z;
        let open: f64 = at_x(&cells, 4.0).iter().map(area).sum();
        assert!(at_x(&cells, 4.0).is_empty() || open >= 12.0, "{facing:?}: {open}");
    }
}

#[test]
fn an_object_in_a_wall_is_seen_from_both_sides() {
    let scene = two_rooms(|l, world| {
        world.triangles(&l.wall(0, 4, |_| false), Facing::Both);
        world.cuboid(Vec3::new(3.5, 1.0, 1.2), Vec3::new(4.5, 1.6, 2.8), Facing::Both);
    });
    let mut stage = Stage::new(&scene, CellsFrom::Found);
    let mut r = Random::new(3);
    let in_wall = scene.bounds.len() as u32 - 3;
    for room in [0, 1] {
        let holds = |x: f64| if room == 0 { x < 4.0 } else { x > 4.0 };
        let in_room = |&c: &u32| {
            let cell = &stage.cells().cells()[c as usize];
            holds((cell.min.x + cell.max.x) * 0.5)
        };
        assert!(stage.portals.objects().of(in_wall).iter().any(in_room));
        for round in 0..20 {
            let eye = DVec3::new(r.range(0.1, 3.4) + 4.5 * f64::from(room), r.range(0.1, 2.9), r.range(0.1, 3.9));
            let view = scenes::camera(&mut r, eye).view(stage.viewport).unwrap();
            stage.keeps_the_picture(&format!("room {room}, round {round}"), &view);
        }
    }
}

/// Walls with doors, bare holes and single triangles, of either side or both, some of glass; and things anywhere.
fn random_world(r: &mut Random) -> (Lattice, PreparedScene) {
    let lattice = Lattice::random(r);
    let mut world = Builder::new();
    for axis in 0..3 {
        for plane in 0..=lattice.steps(axis) {
            let holes = [0.0, 0.05, 0.2, 1.0][r.below(4)];
            let mut wall = Vec::new();
            for face in lattice.faces(axis).filter(|_| !r.chance(holes)).collect::<Vec<_>>() {
                let both = lattice.face(axis, plane, face);
                wall.extend_from_slice(if r.chance(0.01) { &both[..1] } else { &both });
            }
            if !wall.is_empty() {
                let facing = if r.chance(0.85) { Facing::Both } else { [Facing::Front, Facing::Back][r.below(2)] };
                world.triangles(&wall, facing).opacity = if r.chance(0.1) { 0.5 } else { 1.0 };
            }
        }
    }
    let (low, high) = (lattice.point([0; 3]), lattice.point([0, 1, 2].map(|k| lattice.steps(k))));
    for i in 0..60 {
        let at = |r: &mut Random| {
            let p = [0, 1, 2].map(|k| r.float(f64::from(low[k]) - 1.0, f64::from(high[k]) + 1.0));
            Vec3::from_array(p)
        };
        let from = at(r);
        let size = Vec3::new(r.float(0.05, 0.6), r.float(0.05, 0.6), r.float(0.05, 0.6));
        if i < 6 {
            world.cuboid(from, from + size, Facing::Both);
        } else {
            world.triangles(&[[from, from.lerp(at(r), 0.2), from.lerp(at(r), 0.2)]], Facing::Both);
        }
    }
    (lattice, world.prepared())
}

#[test]
fn in_worlds_of_walls_the_picture_is_that_of_everything() {
    let mut r = Random::new(1);
    let (mut drawn, mut all, mut refused) = (0, 0, 0);
    for world in 0..12 {
        let (lattice, scene) = random_world(&mut r);
        if find_cells(&scene).covered < 0.1 {
            refused += 1;
            continue;
        }
        let mut stage = Stage::new(&scene, CellsFrom::Found);
        for round in 0..15 {
            let mut eye = [0.0; 3];
            for (k, place) in eye.iter_mut().enumerate() {
                let lines = &lattice.0[k];
                // Anywhere, or in a plane of walls.
                let (first, last) = (f64::from(lines[0]), f64::from(lines[lines.len() - 1]));
                let any = r.range(first - 0.2, last + 0.2);
                *place = if r.chance(0.15) { f64::from(lines[r.below(lines.len())]) } else { any };
            }
            let mut camera = scenes::camera(&mut r, DVec3::from_array(eye));
            camera.near = r.range(0.01, 0.2);
            let view = camera.view(stage.viewport).unwrap();
            let [few, many] = stage.keeps_the_picture(&format!("world {world}, round {round}"), &view);
            (drawn, all) = (drawn + few, all + many);
        }
    }
    println!("portals found draw {drawn} of {all} objects in the frustum; {refused} worlds are not worth it");
    assert!(refused < 5 && drawn * 4 < all * 3, "{drawn} of {all}, {refused} refused");
}

/// The rooms, drawn from both sides as models are, without the cells that they bring.
fn bare_rooms(triangles: u64) -> PreparedScene {
    let mut scene = parse(&format!("rooms:triangles={triangles}")).unwrap().scene;
    scene.objects.iter_mut().for_each(|o| o.facing = Facing::Both);
    scene.cells = None;
    PreparedScene::new(&scene).unwrap()
}

#[test]
fn cells_found_tile_the_box_of_the_scene() {
    let scene = bare_rooms(40_000);
    let found = find_cells(&scene);
    let cells = &found.cells;
    let again = Cells::new(cells.cells().to_vec(), cells.portals().to_vec()).unwrap();
    assert_eq!(&again, cells, "they do not overlap, and portals are where they belong");
    let (min, max) = cells.bounds();
    let volume = |min: DVec3, max: DVec3| (max - min).element_product();
    let sum: f64 = cells.cells().iter().map(|c| volume(c.min, c.max)).sum();
    assert!((sum / volume(min, max) - 1.0).abs() < 1e-9);
    println!("{} cells, {} portals, {} covered", cells.cells().len(), cells.portals().len(), found.covered);
    assert!(cells.cells().len() > 30 && found.covered > 0.3);
    assert_eq!(find_cells(&scene), found);
}

#[test]
fn from_anywhere_in_rooms_the_picture_of_cells_found_is_that_of_everything() {
    let scene = bare_rooms(40_000);
    let mut stage = Stage::new(&scene, CellsFrom::Found);
    let given = parse("rooms:triangles=40000").unwrap().scene.cells.unwrap();
    let mut r = Random::new(6);
    let (mut drawn, mut all) = (0, 0);
    for round in 0..120 {
        // On a portal that was found, in a cell, or in a room.
        let found = stage.cells();
        let (portal, cell) = (r.below(found.portals().len()), r.below(found.cells().len()));
        let room = 5 + r.below(given.cells().len() - 5);
        let (min, max) = match r.below(4) {
            0 => (found.portals()[portal].min, found.portals()[portal].max),
            1 => (found.cells()[cell].min, found.cells()[cell].max),
            _ => (given.cells()[room].min, given.cells()[room].max),
        };
        let eye = DVec3::new(r.range(min.x, max.x), r.range(min.y, max.y), r.range(min.z, max.z));
        let mut camera = scenes::camera(&mut r, eye);
        camera.near = r.range(0.01, 0.2);
        let view = camera.view(stage.viewport).unwrap();
        let [few, many] = stage.keeps_the_picture(&format!("round {round}"), &view);
        (drawn, all) = (drawn + few, all + many);
    }
    println!("portals found draw {drawn} of {all} objects in the frustum");
    assert!(drawn * 2 < all, "{drawn} of {all}");
}

#[test]
fn a_scene_without_walls_is_one_cell_and_one_without_triangles_has_none() {
    let mut scene = parse("forest:triangles=5000").unwrap().scene;
    let found = find_cells(&PreparedScene::new(&scene).unwrap());
    assert_eq!((found.cells.cells().len(), found.cells.portals().len()), (1, 0));
    scene.objects.clear();
    assert_eq!(find_cells(&PreparedScene::new(&scene).unwrap()), FoundCells::default());
}
