//! Tests of the mesh generators and checks in `tests/support`.

use gpu_smooth::Mesh;
use support::{Outline, Recipe, SplitMix64};

const SQUARE: &str = "loop\n0 0\n1 0\n1 1\n0 1\n";

fn plate(vertices: usize) -> Mesh {
    let outline = Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    support::triangulate(&outline, vertices).unwrap()
}

fn filled(outline: &str, vertices: usize) -> Mesh {
    support::triangulate(&Outline::parse(outline).unwrap(), vertices).unwrap()
}

/// Returns vertices minus edges plus triangles: 1 for a disk, one less for each hole.
fn euler(mesh: &Mesh) -> i64 {
    let counts = [mesh.points.len(), support::edge_uses(mesh).len(), mesh.triangles.len()];
    let [vertices, edges, triangles] = counts.map(|n| n as i64);
    vertices - edges + triangles
}

fn assert_held_still(before: &Mesh, after: &Mesh) {
    assert_eq!((&before.triangles, &before.fixed), (&after.triangles, &after.fixed));
    for (v, held) in support::check::held(before).into_iter().enumerate() {
        assert!(!held || before.points[v] == after.points[v], "vertex {v} has moved");
    }
}

/// Returns the FNV-1a hash of a mesh's coordinates, triangles and fixed vertices.
fn hash(mesh: &Mesh) -> u64 {
    let floats = mesh.points.iter().flatten().map(|x| x.to_bits());
    let indices = mesh.triangles.iter().flatten().chain(&mesh.fixed).map(|&v| u64::from(v));
    let bytes = floats.chain(indices).flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[test]
fn random_numbers_are_those_of_splitmix64() {
    // The first numbers of the reference implementation with the seed 1234567.
    let mut rng = SplitMix64::new(1_234_567);
    let first = [0, 1, 2].map(|_| rng.next_u64());
    assert_eq!(first, [6457827717110365317, 3203168211198807973, 9817491932198370423]);
    assert!((0..1000).all(|_| (0.0..1.0).contains(&rng.unit()) && rng.below(7) < 7));
}

#[test]
fn circle_points_match_the_platform() {
    for i in -500..=500 {
        let turns = f64::from(i) / 173.0;
        let [cos, sin] = support::trig::on_circle(turns);
        let angle = turns * std::f64::consts::TAU;
        assert!((cos - angle.cos()).abs() < 4e-15 && (sin - angle.sin()).abs() < 4e-15, "{turns}");
    }
    assert_eq!(support::trig::on_circle(0.25), [0.0, 1.0]);
}

#[test]
fn lattice_is_ideal() {
    let mesh = support::lattice(12, 7);
    assert_eq!((mesh.points.len(), mesh.triangles.len()), (13 * 8, 2 * 12 * 7));
    assert!(support::is_ccw(&mesh) && support::is_valid(&mesh));
    assert!((support::f_imr(&mesh) - 1.0).abs() < 1e-14);
    assert!((support::worst_imr(&mesh) - 1.0).abs() < 1e-13);
    assert!((support::min_angle(&mesh) - 60.0).abs() < 1e-6);
    assert_eq!((euler(&mesh), support::mover_count(&mesh)), (1, 11 * 6));
}

#[test]
fn graded_elements_keep_their_shape_as_they_shrink() {
    for (around, worst) in [(8, 1.4), (16, 1.1), (48, 1.01)] {
        let mesh = support::graded(around, 1e-7);
        assert!(support::is_ccw(&mesh) && support::is_valid(&mesh));
        assert!(support::worst_imr(&mesh) < worst, "{around}: {}", support::worst_imr(&mesh));
        assert_eq!(euler(&mesh), 0);
        let innermost = mesh.points.last().unwrap();
        assert!(innermost[0].hypot(innermost[1]) <= 1e-7);
        // Also with few bits left in coordinates to resolve the smallest elements.
        let rough = support::perturb_random(&mesh, 1.0, 5);
        assert!(support::is_ccw(&support::transformed(&rough, 1.0, [0.3, 0.7])));
    }
}

#[test]
fn triangulated_plate_meets_its_bounds() {
    for target in [500, 2000, 20_000] {
        let mesh = plate(target);
        assert!(support::is_ccw(&mesh) && support::is_valid(&mesh));
        assert!((mesh.points.len() as f64 / target as f64 - 1.0).abs() < 0.01);
        assert!(support::min_angle(&mesh) > support::generate::ANGLE_LIMIT - 1e-6);
        assert_eq!(mesh.points[..4], [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]]);
        assert_eq!(mesh.points[4], [0.9 + 0.55, 1.1]);
        assert_eq!(euler(&mesh), -1, "two holes");
        assert!(mesh.fixed.is_empty());
        assert_eq!(mesh, plate(target), "the second time");
    }
}

/// The domains of `examples/park_shontz_2011`: name, number of holes, and number of vertices in the
/// paper's mesh.
const DOMAINS: [(&str, i64, usize); 6] = [
    ("airplane", 0, 72205),
    ("duck", 1, 62372),
    ("fish", 1, 57575),
    ("hand", 0, 68807),
    ("mechanic", 7, 69904),
    ("twoholes", 2, 56088),
];

#[test]
fn domains_meet_their_bounds() {
    for (name, holes, paper) in DOMAINS {
        let path = format!("{}/../meshes/{name}.outline", env!("CARGO_MANIFEST_DIR"));
        let outline = Outline::parse(&std::fs::read_to_string(path).unwrap()).unwrap();
        for vertices in [1000, 1500, 3000, paper] {
            let mesh = support::triangulate(&outline, vertices).unwrap();
            assert!(support::is_ccw(&mesh) && support::is_valid(&mesh), "{name}");
            assert_eq!(euler(&mesh), 1 - holes, "{name}");
            let off = mesh.points.len() as f64 / vertices as f64 - 1.0;
            assert!(off.abs() < 0.01, "{name}: {} vertices", mesh.points.len());
            let angle = support::min_angle(&mesh);
            assert!(angle > support::generate::ANGLE_LIMIT - 1e-6, "{name} {vertices}: {angle}");
            if vertices == paper {
                continue;
            }
            assert_eq!(mesh, support::triangulate(&outline, vertices).unwrap(), "the second time");
            for worse in
                [support::perturb_random(&mesh, 1.0, 1), support::distort_smooth(&mesh, 0.9)]
            {
                assert!(support::is_ccw(&worse) && support::is_valid(&worse), "{name}");
                assert_held_still(&mesh, &worse);
                assert!(support::f_imr(&worse) > 1.1 * support::f_imr(&mesh), "{name}");
            }
        }
    }
}

#[test]
fn lines_and_lone_vertices_are_fixed() {
    let mesh = filled(
        &format!("{SQUARE}circle .75 .7 .1 16\nline\n0 0\n.3 .5\n.5 .5\nvertex .4 .2"),
        1500,
    );
    assert!(support::is_valid(&mesh));
    assert_eq!(euler(&mesh), 0, "one hole");
    let fixed: Vec<_> = mesh.fixed.iter().map(|&v| mesh.points[v as usize]).collect();
    // The end of a line on the boundary counts as a boundary vertex.
    assert!(
        !fixed.contains(&[0.0, 0.0]) && fixed.contains(&[0.3, 0.5]) && fixed.contains(&[0.4, 0.2])
    );
    let on_level_piece = fixed.iter().filter(|p| p[1] == 0.5).count();
    assert!(on_level_piece > 5, "refined with the rest: {on_level_piece}");
    assert!(fixed.len() * 20 < mesh.points.len());
    assert_held_still(&mesh, &support::perturb_random(&mesh, 1.0, 1));
}

#[test]
fn perturbing_is_strong_but_never_inverts() {
    let mesh = plate(5000);
    for seed in 0..4 {
        let mild = support::perturb_random(&mesh, 0.5, seed);
        let strong = support::perturb_random(&mesh, 1.0, seed);
        for after in [&mild, &strong] {
            assert!(support::same_orientations(&mesh, after) && support::is_valid(after));
            assert_held_still(&mesh, after);
        }
        let [mild, strong] = [mild, strong].map(|mesh| support::f_imr(&mesh));
        assert!((1.25..1.4).contains(&mild), "{mild}");
        assert!((20.0..500.0).contains(&strong), "{strong}");
    }
    assert_eq!(support::perturb_random(&mesh, 0.0, 1), mesh);
}

#[test]
fn distorting_is_smooth_and_never_inverts() {
    let mesh = plate(5000);
    let mut worst = support::worst_imr(&mesh);
    for amplitude in [0.3, 0.7, 0.95, 1.0] {
        let after = support::distort_smooth(&mesh, amplitude);
        assert!(support::same_orientations(&mesh, &after) && support::is_valid(&after));
        assert_held_still(&mesh, &after);
        assert!(support::worst_imr(&after) > worst, "{amplitude}");
        worst = support::worst_imr(&after);
        // A smooth distortion: neighbors stay together, and few elements are bad.
        assert!(support::f_imr(&after) < 5.0 || amplitude == 1.0);
    }
}

#[test]
fn rearranged_meshes_are_the_same_mesh() {
    let mesh = support::perturb_random(&filled(&format!("{SQUARE}vertex .4 .2"), 400), 1.0, 1);
    let mixed = support::shuffled_windings(&mesh, 3);
    assert!(support::is_valid(&mixed) && !support::is_ccw(&mixed));
    assert_eq!(support::f_imr(&mesh), support::f_imr(&mixed));
    let (renumbered, new_index) = support::renumbered(&mesh, 3);
    assert!(support::is_ccw(&renumbered) && support::is_valid(&renumbered));
    assert!((support::f_imr(&mesh) / support::f_imr(&renumbered) - 1.0).abs() < 1e-12);
    for (old, &new) in new_index.iter().enumerate() {
        assert_eq!(mesh.points[old], renumbered.points[new as usize]);
    }
    assert_eq!(renumbered.fixed, [new_index[mesh.fixed[0] as usize]]);
    let moved = support::transformed(&mesh, 8.0, [0.0, 0.0]);
    assert_eq!(support::f_imr(&mesh), support::f_imr(&moved));
}

#[test]
fn the_checks_of_the_tests_can_fail() {
    let good = support::lattice(3, 3);
    assert!(support::is_valid(&good));
    let with = |change: fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        mesh
    };
    // Vertex 5 is an inner vertex.
    assert!(!support::boundary(&good)[5] && support::boundary(&good)[4]);
    let folded = with(|mesh| mesh.points[5] = [3.0, 3.0]);
    assert!(!support::is_valid(&folded) && !support::is_ccw(&folded));
    assert!(!support::is_valid(&support::shuffled_windings(&folded, 1)));
    assert!(!support::same_orientations(&good, &folded));
    let flat = with(|mesh| mesh.points[0] = mesh.points[1]);
    assert!(!support::is_valid(&flat) && support::f_imr(&flat) == f64::INFINITY);
    assert!(!support::is_valid(&with(|mesh| mesh.points[5][0] = f64::NAN)));
    assert!(!support::is_valid(&with(|mesh| mesh.triangles[0][0] = 16)));
    assert!(!support::is_valid(&with(|mesh| mesh.fixed.push(16))));
    assert!(!support::is_valid(&with(|mesh| mesh.triangles.push(mesh.triangles[0]))));
}

#[test]
fn outlines_have_arcs_curves_and_corners() {
    // A straight bottom, a half circle on the right, and a curve with a corner back to the left.
    let text = "loop\n0 0\n1 0\narc 2 1 1 -90 90 8\ncurve 4\n1 2.2\ncurve 4 # a corner\n.5 1.8\n";
    let outline = Outline::parse(text).unwrap();
    let [ring] = &outline.loops[..] else { panic!("one loop") };
    // The edges: bottom, bottom to arc, the arc's 8, arc to curve, and two curves of 4 chords each.
    assert_eq!(ring.len(), 1 + 1 + 8 + 1 + 4 + 4);
    assert!((ring[2][1] - 0.0).abs() < 1e-15 && (ring[10][1] - 2.0).abs() < 1e-15);
    assert!(ring.contains(&[1.0, 2.2]) && ring.contains(&[0.5, 1.8]));
    assert!(support::is_valid(&support::triangulate(&outline, 800).unwrap()));

    // A closed smooth curve through points of the unit circle stays close to the circle.
    let curve = "loop\ncurve 8\n1 0\n.7071 .7071\n0 1\n-.7071 .7071\n-1 0\n-.7071 -.7071\n0 -1\n.7071 -.7071";
    let outline = Outline::parse(curve).unwrap();
    assert_eq!(outline.loops[0].len(), 64);
    assert!(outline.loops[0].iter().all(|p| (p[0].hypot(p[1]) - 1.0).abs() < 0.01));
}

#[test]
fn nested_loops_alternate_between_boundary_and_hole() {
    let outline =
        Outline::parse(&format!("circle .5 .5 .2 24\n{SQUARE}circle .5 .5 .4 24")).unwrap();
    let circle = |r: f64| 12.0 * r * r * (std::f64::consts::TAU / 24.0).sin();
    assert!((outline.area() - (1.0 - circle(0.4) + circle(0.2))).abs() < 1e-12);
    let mesh = support::triangulate(&outline, 900).unwrap();
    assert!((support::area(&mesh) - outline.area()).abs() < 1e-12);
    assert_eq!(euler(&mesh), 1, "a ring and an island");
}

#[test]
fn bad_outlines_are_refused() {
    let cases = [
        ("", "no loop"),
        ("1 2", "line 1: no 'loop' or 'line' is open"),
        ("loop\n0 0\n1 x", "line 3: 'x' is not a number"),
        ("loop\n0 0\n1 0\n\nloop", "line 5: the loop or line before has fewer than 3 points"),
        ("loop\n0 0\n1 0", "last line: the loop or line before has fewer than 3 points"),
        ("loop\n0 0 0", "line 2: a point is two numbers"),
        ("circle 0 0 1 2.5", "line 1: 2.5 is no number of chords"),
        ("loop\nspline", "line 2: cannot make sense of 'spline'"),
        ("loop\ncurve", "line 2: 'curve' has the wrong number of numbers"),
    ];
    for (text, expected) in cases {
        let problem = Outline::parse(text).unwrap_err();
        assert!(problem.contains(expected), "{text:?}: {problem}");
    }
    let crossed = Outline::parse("loop\n0 0\n1 1\n1 0\n0 1").unwrap();
    assert!(support::triangulate(&crossed, 500).unwrap_err().contains("crosses"));
    for (circle, expected) in [("circle .95 .5 .2 24", "crosses"), ("circle 1 .5 .2 24", "do its")]
    {
        let overlapping = Outline::parse(&format!("{SQUARE}{circle}")).unwrap();
        let problem = support::triangulate(&overlapping, 500).unwrap_err();
        assert!(problem.contains(expected), "{circle}: {problem}");
    }
    let problem =
        support::triangulate(&Outline::parse("circle 0 0 1 100").unwrap(), 20).unwrap_err();
    assert!(problem.contains("vertices"), "{problem}");
}

#[test]
fn written_meshes_look_as_their_formats_say() {
    let mesh = Mesh {
        points: vec![[0.0, 0.0], [0.1, 0.0], [0.0, 1e-7], [0.025, 2.5e-8]],
        triangles: vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
        fixed: vec![3],
        ..Mesh::default()
    };
    let [node, ele] = support::triangle_text(&mesh, "made up");
    assert_eq!(
        node,
        "# made up\n4 2 0 1\n1 0 0 1\n2 0.1 0 1\n3 0 0.0000001 1\n4 0.025 0.000000025 2\n"
    );
    assert_eq!(ele, "# made up\n3 3 0\n1 1 2 4\n2 2 3 4\n3 3 1 4\n");
    let nodes = "1 0 0 0\n2 0.1 0 0\n3 0 0.0000001 0\n4 0.025 0.000000025 0\n";
    let elements = "1 2 2 1 1 1 2 4\n2 2 2 1 1 2 3 4\n3 2 2 1 1 3 1 4\n";
    assert_eq!(
        support::write_msh22(&mesh),
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{nodes}$EndNodes\n$Elements\n3\n{elements}$EndElements\n"
        )
    );
    let text = support::write_msh41(&mesh);
    assert!(text.contains("$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n0.1 0 0\n"), "{text}");
    assert!(text.contains("$Elements\n1 3 1 3\n2 1 2 3\n1 1 2 4\n2 2 3 4\n3 3 1 4\n"), "{text}");

    let folder = tempfile::tempdir().unwrap();
    support::write_triangle(&mesh, &folder.path().join("mesh.1"), "made up").unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("mesh.1.node")).unwrap(), node);
    assert_eq!(std::fs::read_to_string(folder.path().join("mesh.1.ele")).unwrap(), ele);
}

/// Measurements on these meshes are compared over years, so the meshes must not change.
#[test]
fn meshes_keep_their_bytes() {
    let lattice = support::lattice(20, 20);
    let meshes = [
        ("lattice", lattice.clone(), 0xdfde_74f4_d8fe_5ae8),
        ("graded", support::graded(24, 1e-3), 0x702b_8b29_dc25_6763),
        ("perturbed", support::perturb_random(&lattice, 1.0, 7), 0xab96_03f9_0df9_4fdc),
        ("distorted", support::distort_smooth(&lattice, 0.9), 0x3868_1ced_54ee_3aa8),
        (
            "renumbered",
            support::renumbered(&support::shuffled_windings(&lattice, 7), 7).0,
            0xdfed_a422_b970_4f6c,
        ),
    ];
    for (name, mesh, expected) in meshes {
        assert_eq!(hash(&mesh), expected, "{name}: {:#018x}", hash(&mesh));
    }
}

/// If this test fails after an update of spade, see `meshes/README.md`.
#[test]
fn committed_meshes_are_what_their_commands_make() {
    // The commands name files from the top of the repository. The other tests here name files by absolute paths.
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).unwrap();
    for name in DOMAINS.map(|(name, ..)| name).into_iter().chain(["plate"]) {
        let [node, ele] = ["node", "ele"].map(|ending| {
            let path = format!("{}/../meshes/{name}.{ending}", env!("CARGO_MANIFEST_DIR"));
            std::fs::read_to_string(path).unwrap()
        });
        let command = node.lines().next().unwrap().to_owned();
        let args = command.strip_prefix("# cargo run --release --example make_mesh -- ").unwrap();
        let args: Vec<_> = args.split_whitespace().map(String::from).collect();
        let made = Recipe::parse(&args).unwrap().texts().unwrap();
        assert!(made == [node, ele], "`{command}` makes another mesh");
    }
}

#[test]
fn make_mesh_explains_what_it_refuses() {
    let cases = [
        ("a", "expected two paths, got 1"),
        ("a b --vertices", "--vertices needs a value"),
        ("a b --perturb 2", "--perturb takes a number from 0 to 1, not '2'"),
        ("a b --color red", "unknown option --color"),
        ("a b --perturb 1 --distort 1", "exclude each other"),
        ("a b --perturb 1 --tangle fold", "exclude each other"),
        (
            "a b --tangle knot",
            "--tangle takes one of scatter, noise, collapse, fold, turn, not 'knot'",
        ),
    ];
    for (args, expected) in cases {
        let args: Vec<_> = args.split_whitespace().map(String::from).collect();
        let problem = Recipe::parse(&args).unwrap_err();
        assert!(problem.contains(expected), "{args:?}: {problem}");
    }
    let args = ["no-such.outline", "b"].map(String::from);
    let problem = Recipe::parse(&args).unwrap().texts().unwrap_err();
    assert!(problem.starts_with("no-such.outline: "), "{problem}");
}
