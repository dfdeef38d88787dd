//! Tests of the measures of edges.

use super::*;
use crate::Mesh;
use crate::measure::{Measure, Measured};

fn edges_of(surface: Surface, points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<InnerEdge> {
    let mesh = Mesh { points: points.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    Measured::on(surface, points, &topology).unwrap().edges()
}

const HALF: f64 = 0.866_025_403_784_438_6;

#[test]
fn equilateral_triangles_are_orthogonal_and_their_link_is_long() {
    for shift in [0.0, 6e5] {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, HALF], [0.5, -HALF]];
        let points = points.map(|[x, y]| [x + shift, y + shift]);
        let [edge] = edges_of(Surface::Plane, &points, &[[0, 1, 2], [1, 0, 3]])[..] else {
            panic!()
        };
        assert_eq!((edge.vertices, edge.elements), ([0, 1], [0, 1]));
        assert!(edge.orthogonality < 1e-10, "{edge:?}");
        assert!((edge.flow_link - EQUILATERAL).abs() < 1e-9, "{edge:?}");
        assert!((edge.smoothness - 1.0).abs() < 1e-9, "{edge:?}");
    }
}

#[test]
fn an_obtuse_triangle_has_its_center_on_its_longest_edge() {
    // The obtuse triangle has the centroid (0.5, 0.1) and the circumcenter (0.5, -0.3041...), so its center is at
    // (0.5, 0) on the edge. The other center is at (1, -0.75), so the link has the direction (0.5, -0.75).
    let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.3], [2.0, -1.5]];
    let [edge] = edges_of(Surface::Plane, &points, &[[0, 1, 2], [1, 0, 3]])[..] else { panic!() };
    let center = circumcenter([[1.0, 0.0], [0.0, 0.0], [2.0, -1.5]]);
    // The second triangle is obtuse too: its center is where the segment from its centroid leaves it.
    let mean = [1.0, -0.5];
    assert!(center[1] < -1.4);
    // The edge from (0, 0) to (2, -1.5) is y = -0.75 x.
    let s = (-0.75 * mean[0] - mean[1]) / (center[1] - mean[1] + 0.75 * (center[0] - mean[0]));
    let two = [mean[0] + s * (center[0] - mean[0]), mean[1] + s * (center[1] - mean[1])];
    let link = [two[0] - 0.5, two[1]];
    let length = link[0].hypot(link[1]);
    assert!((edge.orthogonality - link[0].abs() / length).abs() < 1e-14, "{edge:?}");
    let roots = 0.5 * (0.15f64.sqrt() + 0.75f64.sqrt());
    assert!((edge.flow_link - length / roots).abs() < 1e-14, "{edge:?}");
    assert!((edge.smoothness - 5.0).abs() < 1e-13, "{edge:?}");
}

/// Returns the circumcenter by Cramer's rule.
fn circumcenter([p, q, r]: [[f64; 2]; 3]) -> [f64; 2] {
    let row = |s: [f64; 2]| {
        let [x, y] = minus(s, p);
        [x, y, 0.5 * (s[0] * s[0] + s[1] * s[1] - p[0] * p[0] - p[1] * p[1])]
    };
    let ([a, b, e], [c, d, f]) = (row(q), row(r));
    let by = a * d - b * c;
    [(e * d - b * f) / by, (a * f - e * c) / by]
}

#[test]
fn two_right_triangles_at_their_hypotenuse_have_no_link() {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let [edge] = edges_of(Surface::Plane, &points, &[[0, 1, 2], [0, 2, 3]])[..] else { panic!() };
    assert_eq!((edge.orthogonality, edge.flow_link, edge.smoothness), (0.0, 0.0, 1.0));
}

#[test]
fn a_degree_of_longitude_is_shorter_in_the_north() {
    // Equilateral on the sphere at 60 degrees, where a degree of longitude is half as long.
    let (width, height) = (2e-3, HALF * 1e-3);
    let points =
        [[0.0, 60.0], [width, 60.0], [0.5 * width, 60.0 + height], [0.5 * width, 60.0 - height]];
    let [edge] = edges_of(Surface::Sphere, &points, &[[0, 1, 2], [1, 0, 3]])[..] else { panic!() };
    assert!(edge.orthogonality < 1e-9, "{edge:?}");
    assert!((edge.flow_link - EQUILATERAL).abs() < 1e-4, "{edge:?}");
}

/// The first triangle has nearly a right angle. The segment to its circumcenter crosses the edge by the factors of
/// longitudes, though the circumcenter is inside by coordinates.
#[test]
fn a_center_barely_inside_in_degrees_is_that_of_meshkernel() {
    let points = [
        [4.633859261520806, 53.49769251852584],
        [4.652386520499213, 53.56459745224698],
        [4.5832930242949566, 53.57135158163246],
        [4.54977944551005, 53.49415868373533],
    ];
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let [edge] = edges_of(Surface::Sphere, &points, &triangles)[..] else { panic!() };
    assert!((edge.orthogonality - 0.00032632689853730434).abs() < 1e-9, "{edge:?}");
    assert!((edge.flow_link - 0.328984341100778).abs() < 1e-9, "{edge:?}");
}

#[test]
fn the_worst_edges_of_triangles_are_those_of_the_list() {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.1, 1.0], [0.45, 0.6], [3.0, 0.2]];
    let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 5, 2]];
    let mesh = Mesh { points: points.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(&points, &topology).unwrap();
    let edges = measured.edges();
    assert_eq!(edges.len(), 5);
    let worst = worst_edges(Surface::Plane, &points, &topology);
    for (t, worst) in worst.iter().enumerate() {
        let own = edges.iter().filter(|edge| edge.elements.contains(&(t as u32)));
        let expected = own.fold((0.0f64, f64::INFINITY, 1.0f64), |(most, least, ratio), edge| {
            let (link, smoothness) = (edge.flow_link, edge.smoothness);
            (most.max(edge.orthogonality), least.min(link), ratio.max(smoothness))
        });
        assert_eq!((worst.orthogonality, worst.flow_link, worst.smoothness), expected, "{t}");
        // In the plane, the areas are those of `size-ratio`.
        let ratio = measured.value(Measure::SizeRatio, t);
        assert!((worst.smoothness / ratio - 1.0).abs() < 1e-14, "{t}");
    }
}

#[test]
fn a_triangle_alone_and_a_flat_triangle_have_finite_measures() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0]];
    let mesh = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    let alone = worst_edges(Surface::Plane, &points, &topology);
    assert_eq!(alone, [WorstEdges { orthogonality: 0.0, flow_link: EQUILATERAL, smoothness: 1.0 }]);
    let [edge] = edges_of(Surface::Plane, &points, &[[0, 1, 2], [1, 0, 3]])[..] else { panic!() };
    assert!(edge.orthogonality <= 1.0 && edge.flow_link >= 0.0, "{edge:?}");
    assert_eq!(edge.smoothness, f64::INFINITY);
}

/// A mesh with the numbers that MeshKernel 8.3.0 gives.
struct Known {
    points: [[f64; 2]; 10],
    /// The ends, the orthogonality and the smoothness of each edge.
    edges: [([u32; 2], f64, f64); 15],
    /// The thresholds at which `mesh2d_get_small_flow_edge_centers` counts one edge more, ascending.
    flow_links: [f64; 15],
}

const TRIANGLES: [[u32; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 6],
    [1, 2, 4],
    [1, 4, 3],
    [2, 9, 5],
    [2, 5, 4],
    [3, 4, 7],
    [3, 7, 6],
    [4, 5, 7],
    [5, 9, 8],
    [5, 8, 7],
    [6, 7, 8],
];

/// In the plane, with obtuse triangles.
const PLANE: Known = Known {
    points: [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.1],
        [0.1, 1.0],
        [1.5, 0.35],
        [2.1, 1.1],
        [0.0, 2.0],
        [0.9, 1.7],
        [2.0, 2.05],
        [3.1, 0.9],
    ],
    edges: [
        ([0, 3], 0.6659489287388927, 5.0),
        ([1, 3], 0.2171982076632786, 1.226993865030675),
        ([1, 4], 0.21781723386526602, 2.716666666666667),
        ([2, 4], 0.19618108698567824, 1.7500000000000004),
        ([2, 5], 4.8387837993820237e-17, 1.9428571428571426),
        ([3, 4], 0.22132429530727177, 1.8404907975460132),
        ([3, 6], 0.7808422745226345, 4.35),
        ([3, 7], 1.2333058891695454e-16, 1.7241379310344833),
        ([4, 5], 2.263286835784811e-16, 2.4000000000000004),
        ([4, 7], 0.0, 1.1904761904761907),
        ([5, 7], 8.520670083920804e-17, 1.166666666666667),
        ([5, 8], 0.14825180790093234, 1.1612903225806452),
        ([5, 9], 0.1599751834722672, 1.0967741935483872),
        ([6, 7], 0.5464919974452302, 1.3488372093023258),
        ([7, 8], 0.5341606868265212, 1.6744186046511629),
    ],
    flow_links: [
        0.32615648344414344,
        0.5853405673057316,
        0.5961430219800399,
        0.6353517601964106,
        0.9307202921102049,
        1.1101914001659583,
        1.173116844950565,
        1.193957848887198,
        1.2928923464234097,
        1.2970210723595659,
        1.3281874710613295,
        1.3890505986325041,
        1.445492847799977,
        1.577210398024898,
        1.738277074713708,
    ],
};

/// In degrees.
const DEGREES: Known = Known {
    points: [
        [4.0, 52.0],
        [4.01, 52.0],
        [4.02, 52.0006],
        [4.001, 52.006],
        [4.015, 52.0021],
        [4.021, 52.0066],
        [4.0, 52.012],
        [4.009, 52.0102],
        [4.02, 52.0123],
        [4.031, 52.0054],
    ],
    edges: [
        ([0, 3], 0.6560247561251444, 5.000670332729893),
        ([1, 3], 0.24698293457918571, 1.22705770170729),
        ([1, 4], 0.23979977195625576, 2.716485886836433),
        ([2, 4], 0.20747571525912994, 1.7499029587879342),
        ([2, 5], 1.3268392237027231e-06, 1.942756402812271),
        ([3, 4], 0.2638915349025364, 1.840380782824026),
        ([3, 6], 0.7678958283793028, 4.349686772806647),
        ([3, 7], 2.9274503618984743e-05, 1.7243004635457468),
        ([4, 5], 2.188919864962344e-05, 2.3997420396306173),
        ([4, 7], 5.2344169893896815e-05, 1.1905197859571945),
        ([5, 7], 8.290484944460013e-05, 1.16673246766292),
        ([5, 8], 0.14461688948816573, 1.1612042770035025),
        ([5, 9], 0.1607459653543902, 1.096815803912521),
        ([6, 7], 0.5609708238941988, 1.3488802960266812),
        ([7, 8], 0.5450137380645971, 1.6744741773706942),
    ],
    flow_links: [
        0.30648314410721594,
        0.6065449884751356,
        0.6073070239804307,
        0.6253671833487354,
        0.9644393445747356,
        1.1079100465438647,
        1.158254146270294,
        1.1943379458883638,
        1.2909781394199351,
        1.296973142644945,
        1.3178859055577683,
        1.4104766601165508,
        1.447489346852289,
        1.5629171563885451,
        1.728917869617244,
    ],
};

#[test]
fn measures_are_those_of_meshkernel() {
    for (surface, known) in [(Surface::Plane, PLANE), (Surface::Sphere, DEGREES)] {
        let edges = edges_of(surface, &known.points, &TRIANGLES);
        assert_eq!(edges.len(), known.edges.len());
        for (ends, orthogonality, smoothness) in known.edges {
            let is_it = |edge: &&InnerEdge| ends.iter().all(|end| edge.vertices.contains(end));
            let edge = edges.iter().find(is_it).unwrap();
            assert!((edge.orthogonality - orthogonality).abs() < 1e-9, "{edge:?}");
            assert!((edge.smoothness - smoothness).abs() < 1e-9, "{edge:?}");
        }
        let mut links: Vec<f64> = edges.iter().map(|edge| edge.flow_link).collect();
        links.sort_by(f64::total_cmp);
        for (link, expected) in links.iter().zip(known.flow_links) {
            assert!((link - expected).abs() < 1e-9, "{link} for {expected}");
        }
    }
}

/// A mesh of seven quadrilaterals and four triangles.
fn mixed() -> Mesh {
    let points = vec![
        [0.0, 0.0],
        [1.0, 0.0],
        [1.2, 1.1],
        [0.1, 0.9],
        [2.1, 0.1],
        [2.2, 1.3],
        [0.0, 2.0],
        [1.1, 2.2],
        [2.3, 2.4],
        [-1.0, 0.1],
        [-1.1, 1.0],
        [-0.9, 2.1],
        [0.1, -1.0],
        [1.05, -1.1],
        [2.0, -0.9],
        [-1.0, -1.1],
    ];
    let triangles = vec![[2, 5, 8], [2, 8, 7], [13, 14, 4], [13, 4, 1]];
    let quadrilaterals = vec![
        [0, 1, 2, 3],
        [1, 4, 5, 2],
        [3, 2, 7, 6],
        [9, 0, 3, 10],
        [10, 3, 6, 11],
        [12, 13, 1, 0],
        [15, 12, 0, 9],
    ];
    Mesh { points, triangles, quadrilaterals, ..Mesh::default() }
}

/// The ends of each edge inside of [`mixed`], with orthogonality and smoothness by MeshKernel 8.3: in the plane, and with
/// coordinates of 0.05 degrees for a unit, from 4 degrees east and 52 degrees north on.
type OfMixed = ([u32; 2], [f64; 2], [f64; 2]);
const MIXED: [OfMixed; 14] = [
    ([0, 1], [0.1175552257148316, 1.0147058823529411], [0.10917446407560347, 1.0135560973488085]),
    ([0, 3], [0.12063285144348729, 1.0454545454545452], [0.13138833690292345, 1.0454683536038893]),
    ([0, 9], [0.03836604567538738, 1.1666666666666667], [0.06586340976658402, 1.1680025964252303]),
    ([0, 12], [0.05600014091528692, 1.1323529411764708], [0.05370743357816793, 1.1323500603774066]),
    ([1, 2], [0.12555566327480555, 1.1449275362318845], [0.14583094387167383, 1.144777345872967]),
    ([1, 4], [0.1932664523858868, 1.9506172839506173], [0.22276388886343793, 1.9491170629493386]),
    ([1, 13], [0.03166730356373981, 1.679012345679012], [0.03931911616193748, 1.6798445946647003]),
    ([2, 3], [0.1126958412232287, 1.1884057971014494], [0.11256066483969925, 1.1869846012662095]),
    ([2, 5], [0.2482114366148058, 2.1944444444444446], [0.2992966395406458, 2.1961696021160844]),
    ([2, 7], [0.07551759623547445, 1.8358208955223883], [0.21311596806713498, 1.8371132162879789]),
    ([2, 8], [0.9999999999999998, 1.2407407407407405], [0.9999999860271306, 1.2395213535920913]),
    ([3, 6], [0.04867111493068423, 1.0603448275862064], [0.16436335760879142, 1.0602014722209057]),
    ([3, 10], [0.04603114380303537, 1.171717171717172], [0.0681705821862861, 1.1704896374454243]),
    ([4, 13], [1.0, 1.3064516129032264], [0.9999999705396528, 1.3052338616592023]),
];

#[test]
fn measures_of_quadrilaterals_are_those_of_meshkernel() {
    for (surface, by) in [(Surface::Plane, 1e-12), (Surface::Sphere, 2e-2)] {
        let mut mesh = mixed();
        if surface == Surface::Sphere {
            mesh.points.iter_mut().for_each(|p| *p = [0.05 * p[0] + 4.0, 0.05 * p[1] + 52.0]);
        }
        let topology = Topology::new(&mesh).unwrap();
        let measured = Measured::on(surface, &mesh.points, &topology).unwrap();
        let edges = measured.edges();
        assert_eq!(edges.len(), MIXED.len());
        for (ends, in_plane, in_degrees) in MIXED {
            let is_it = |edge: &&InnerEdge| ends.iter().all(|end| edge.vertices.contains(end));
            let edge = edges.iter().find(is_it).unwrap();
            let [orthogonality, smoothness] =
                if surface == Surface::Plane { in_plane } else { in_degrees };
            assert!((edge.orthogonality - orthogonality).abs() < by, "{edge:?}: {orthogonality}");
            assert!((edge.smoothness - smoothness).abs() < by, "{edge:?}: {smoothness}");
        }
        // The measures of an element are those of its worst edges.
        let values = measured.values(Measure::Orthogonality);
        for (element, value) in (0..).zip(values) {
            let own = edges.iter().filter(|edge| edge.elements.contains(&element));
            assert_eq!(value, own.map(|edge| edge.orthogonality).fold(0.0, f64::max));
        }
        let ratios = measured.values(Measure::SizeRatio);
        assert!(ratios.iter().all(|ratio| (1.0..2.5).contains(ratio)), "{ratios:?}");
    }
}

#[test]
fn squares_are_orthogonal_and_their_links_are_as_long_as_their_sides() {
    let at = |k: u32| [f64::from(k % 4) * 2.0, f64::from(k / 4) * 2.0];
    let cells = (0..12).filter(|k| k % 4 < 3).take(6);
    let mesh = Mesh {
        points: (0..12).map(at).collect(),
        quadrilaterals: cells.map(|k| [k, k + 1, k + 5, k + 4]).collect(),
        ..Mesh::default()
    };
    let topology = Topology::new(&mesh).unwrap();
    let edges = Measured::new(&mesh.points, &topology).unwrap().edges();
    assert_eq!(edges.len(), 7);
    for edge in edges {
        assert!(edge.orthogonality < 1e-14 && (edge.flow_link - 1.0).abs() < 1e-14, "{edge:?}");
    }
}
