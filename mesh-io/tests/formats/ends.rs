//! Ends of groups: vertices at which a group of lines, or a group of vertices, ends.

use super::Folder;
use mesh_io::{Conversion, MeshFile};
use std::fmt::Write;

/// x of the vertices at the bottom. The inlet ends and the wall begins at the vertex 4.
const X: [f64; 9] = [0.0, 0.15, 0.3, 0.45, 0.62, 0.7, 0.8, 0.9, 1.0];

/// Vertices of a unit square: three rows of nine.
fn points() -> Vec<[f64; 2]> {
    [0.0, 0.5, 1.0].iter().flat_map(|&y| X.map(|x| [x, y])).collect()
}

fn triangles() -> Vec<[usize; 3]> {
    let cell = |k: usize| {
        let a = k / 8 * 9 + k % 8;
        [[a, a + 1, a + 10], [a, a + 10, a + 9]]
    };
    (0..16).flat_map(cell).collect()
}

/// Edges of the bottom up to vertex 4, and all other edges of the boundary, in order.
fn parts() -> [Vec<[usize; 2]>; 2] {
    let ring: Vec<usize> = (0..9).chain([17]).chain((18..27).rev()).chain([9, 0]).collect();
    let edges: Vec<[usize; 2]> = ring.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    [edges[..4].to_vec(), edges[4..].to_vec()]
}

/// Formats rows, one per line.
fn rows<T>(items: impl IntoIterator<Item = T>, row: impl Fn(T) -> String) -> String {
    items.into_iter().fold(String::new(), |mut text, item| {
        writeln!(text, "{}", row(item)).unwrap();
        text
    })
}

/// The square as a file of gmsh 2.2 with two physical lines, or with the entities `of(k)` for the k-th edge alone. Its
/// two rows of triangles are two surfaces.
fn gmsh(of: Option<&dyn Fn(usize) -> usize>) -> String {
    let nodes =
        rows(points().iter().zip(1..), |([x, y], tag): (_, usize)| format!("{tag} {x} {y} 0"));
    let [inlet, wall] = parts();
    let all = inlet.iter().map(|edge| (1, edge)).chain(wall.iter().map(|edge| (2, edge)));
    let lines = rows(all.enumerate(), |(k, (group, [a, b]))| {
        let (physical, entity) = of.map_or((group, group), |of| (0, of(k)));
        format!("{} 1 2 {physical} {entity} {} {}", k + 1, a + 1, b + 1)
    });
    let elements = rows(triangles().iter().zip(21..), |([a, b, c], tag): (_, usize)| {
        format!("{tag} 2 2 3 {} {} {} {}", 1 + tag / 37, a + 1, b + 1, c + 1)
    });
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"inlet\"\n1 2 \"wall\"\n$EndPhysicalNames\n\
         $Nodes\n27\n{nodes}$EndNodes\n$Elements\n52\n{lines}{elements}$EndElements\n"
    )
}

/// The square with the two groups, and its ends: the corner 0, at which the inlet begins, and the vertex 4.
const ENDS: [u32; 2] = [0, 4];

#[track_caller]
fn assert_ends(name: &str, bytes: impl AsRef<[u8]>, expected: &[u32]) {
    let file = MeshFile::from_bytes(name.as_ref(), bytes.as_ref().to_vec()).unwrap();
    assert_eq!(file.group_ends().unwrap(), expected, "{name}");
}

/// Formats without groups of lines are listed; all others keep the two ends.
#[test]
fn ends_of_groups_of_lines_are_found_in_all_formats_that_are_written() {
    let folder = Folder::new(&[("in.msh", &gmsh(None))]);
    let file = folder.read("in.msh");
    assert_eq!(file.group_ends().unwrap(), ENDS);
    let mut without = Vec::new();
    for (name, format) in Conversion::targets() {
        let out = format!("{name}{}", format.extensions()[0]);
        Conversion::new(&file, format).unwrap().unwrap().write(&folder.path(&out)).unwrap();
        match folder.read(&out).group_ends().unwrap()[..] {
            [] => without.push(name),
            ref ends => assert_eq!(ends, ENDS, "{name}"),
        }
    }
    assert_eq!(without, ["ugrid", "off", "ply", "mike", "selafin"]);
}

/// Node sets of Exodus, boundary conditions of CGNS on points, groups of nodes in MED and others.
#[test]
fn ends_of_groups_of_vertices_are_found_in_all_formats_that_are_written() {
    let folder = Folder::new(&[]);
    folder.put("in.mesh", with_codes("medit", &code));
    let file = folder.read("in.mesh");
    let mut with = Vec::new();
    for (name, format) in Conversion::targets() {
        let out = format!("{name}{}", format.extensions()[0]);
        Conversion::new(&file, format).unwrap().unwrap().write(&folder.path(&out)).unwrap();
        let ends = folder.read(&out).group_ends().unwrap();
        if !ends.is_empty() {
            assert_eq!(ends, [0, 4, 5, 9], "{name}");
            with.push(name);
        }
    }
    let all = ["exodus", "med", "cgns", "medit", "meshb", "triangle", "freefem", "abaqus"];
    assert!(all.iter().all(|name| with.contains(name)), "{with:?}");
}

#[test]
fn an_entity_of_gmsh_ends_and_a_number_for_each_edge_is_no_group() {
    assert_ends("in.msh", gmsh(Some(&|k| if k < 4 { 7 } else { 3 })), &ENDS);
    assert_ends("in.msh", gmsh(Some(&|k| k + 1)), &[]);
    // Two of twenty edges share a number with a neighbor.
    assert_ends("in.msh", gmsh(Some(&|k| k.max(1))), &[]);
    // Two groups of one edge, and an edge between others that has no group.
    assert_ends("in.msh", gmsh(Some(&|k| [1, 2, 0, 0, 0].get(k).map_or(9, |&n| n))), &[0, 1, 2, 5]);
}

/// The square as a MIKE mesh, a Medit mesh, and so on, whose vertices have the numbers `of`.
fn with_codes(format: &str, of: &dyn Fn(usize) -> i64) -> Vec<u8> {
    let at = points();
    let code = |vertex: usize| of(vertex);
    let nodes = |sep: &str| rows(0..27, |v| format!("{} {}{sep} {}", at[v][0], at[v][1], code(v)));
    let corners = |suffix: &str| {
        rows(triangles(), |[a, b, c]| format!("{} {} {}{suffix}", a + 1, b + 1, c + 1))
    };
    let numbered =
        |text: &str| rows(text.lines().zip(1..), |(row, k): (_, u32)| format!("{k} {row}"));
    let text = match format {
        "mike" => {
            format!("27 LONG/LAT\n{}32 3 21\n{}", numbered(&nodes(" -5")), numbered(&corners("")))
        }
        "medit" => format!(
            "MeshVersionFormatted 2\nDimension 2\nVertices\n27\n{}Triangles\n32\n{}End\n",
            nodes(""),
            corners(" 1")
        ),
        "freefem" => format!("27 32 0\n{}{}", nodes(""), corners(" 1")),
        "jigsaw" => format!(
            "MSHID=3;EUCLIDEAN-MESH\nNDIMS=2\nPOINT=27\n{}TRIA3=32\n{}",
            rows(0..27, |v| format!("{};{};{}", at[v][0], at[v][1], code(v))),
            rows(triangles(), |[a, b, c]| format!("{a};{b};{c};0"))
        ),
        _ => unreachable!(),
    };
    text.into_bytes()
}

/// Codes along the bottom: two for the first vertices, one for the rest of the boundary, none inside.
fn code(vertex: usize) -> i64 {
    match vertex {
        0..=4 => 2,
        10..=16 => 0,
        _ => 1,
    }
}

/// The edges between vertices of the two codes belong to none of them, and both ends of such an edge stay.
#[test]
fn groups_of_vertices_end_where_their_codes_change_along_the_boundary() {
    for (name, format) in
        [("in.mesh", "mike"), ("in.mesh", "medit"), ("in.msh", "freefem"), ("in.msh", "jigsaw")]
    {
        assert_ends(name, with_codes(format, &code), &[0, 4, 5, 9]);
        assert_ends(name, with_codes(format, &|v| i64::from(code(v) != 0)), &[]);
        assert_ends(name, with_codes(format, &|v| v as i64 + 1), &[]);
        // A single vertex of a code of its own.
        assert_ends(name, with_codes(format, &|v| 3 * i64::from(v == 6)), &[6]);
    }
    let [node, ele] = [
        format!(
            "27 2 0 1\n{}",
            rows(points().iter().zip(0..), |([x, y], v)| format!("{v} {x} {y} {}", code(v)))
        ),
        format!(
            "32 3 0\n{}",
            rows(triangles().iter().zip(0..), |([a, b, c], t): (_, u32)| format!(
                "{t} {a} {b} {c}"
            ))
        ),
    ];
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    assert_eq!(folder.read("in.node").group_ends().unwrap(), [0, 4, 5, 9]);
}

/// The number of a corner of the square is that of one of its two sides.
#[test]
fn numbers_of_vertices_that_repeat_those_of_lines_add_no_ends() {
    let [inlet, wall] = parts();
    let edges =
        rows(inlet.iter().map(|e| (2, e)).chain(wall.iter().map(|e| (1, e))), |(n, [a, b])| {
            format!("{} {} {n}", a + 1, b + 1)
        });
    let codes = |own: &dyn Fn(usize) -> i64| {
        let text = String::from_utf8(with_codes("medit", own)).unwrap();
        text.replace("Triangles", &format!("Edges\n20\n{edges}Triangles"))
    };
    assert_ends("in.mesh", codes(&code), &ENDS);
    assert_ends("in.mesh", codes(&|v| if v == 4 || v == 0 { 1 } else { code(v) }), &ENDS);
    assert_ends("in.mesh", codes(&|_| 0), &ENDS);
}

#[test]
fn strings_of_nodes_end_in_adcirc_and_in_rows_that_go_on() {
    let nodes = rows(points().iter().zip(1..), |([x, y], v): (_, u32)| format!("{v} {x} {y} 1"));
    let corners = |row: &dyn Fn(usize, [usize; 3]) -> String| {
        rows(triangles().into_iter().enumerate(), |(k, t)| row(k + 1, t.map(|v| v + 1)))
    };
    let mesh =
        format!("grid\n32 27\n{nodes}{}", corners(&|k, [a, b, c]| format!("{k} 3 {a} {b} {c}")));
    let ring: Vec<usize> =
        (4..9).chain([17]).chain((18..27).rev()).chain([9, 0]).map(|v| v + 1).collect();
    let list = |nodes: &[usize]| rows(nodes, |v| v.to_string());
    let text = format!(
        "{mesh}1 = open\n5\n5\n{}1\n18\n{} 20\n{}",
        list(&[1, 2, 3, 4, 5]),
        ring.len(),
        list(&ring)
    );
    assert_ends("fort.14", text, &ENDS);
    // An island is closed, whether its first node is listed twice or once. An open coast of the type of islands ends.
    let mut around: Vec<usize> = (1..6).chain(ring[1..].iter().copied()).collect();
    let island =
        |nodes: &[usize]| format!("{mesh}0\n0\n1\n{0}\n{0} 21\n{1}", nodes.len(), list(nodes));
    assert_ends("fort.14", island(&around), &[]);
    around.pop();
    assert_ends("fort.14", island(&around), &[]);
    assert_ends("fort.14", island(&ring), &ENDS);
    let nodes = rows(points().iter().zip(1..), |([x, y], v): (_, u32)| format!("ND {v} {x} {y} 1"));
    let elements = corners(&|k, [a, b, c]| format!("E3T {k} {a} {b} {c} 1"));
    let strings =
        "NS 1 2 3\nNS 4 -5 \"inlet\"\nNS 5 6 7 8 9 18\nNS 27 26 25 24 23 22 21 20\nNS 19 10 -1\n";
    assert_ends("in.2dm", format!("MESH2D\n{elements}{nodes}{strings}"), &ENDS);
    // A string of every second node: all of its nodes stay.
    let coarse = "NS 2 4 6 -8\n";
    assert_ends("in.2dm", format!("MESH2D\n{elements}{nodes}{coarse}"), &[1, 3, 5, 7]);
}

/// Two edges between the two surfaces have a group.
#[test]
fn groups_on_lines_inside_of_the_mesh_end() {
    let text = gmsh(None)
        .replace("$Elements\n52\n", "$Elements\n54\n")
        .replace("$EndElements", "60 1 2 5 5 12 13\n61 1 2 5 5 13 14\n$EndElements");
    assert_ends("in.msh", text, &[0, 4, 11, 13]);
}

#[test]
fn surfaces_and_node_sets_of_abaqus_end() {
    let nodes = rows(points().iter().zip(1..), |([x, y], v): (_, u32)| format!("{v}, {x}, {y}"));
    let elements = rows(triangles().iter().zip(1..), |([a, b, c], t): (_, u32)| {
        format!("{t}, {}, {}, {}", a + 1, b + 1, c + 1)
    });
    let deck = |sets: &str| format!("*NODE\n{nodes}*ELEMENT, TYPE=CPS3\n{elements}{sets}");
    assert_ends("in.inp", deck("*SURFACE, NAME=inlet\n1, S1\n3, S1\n5, S1\n7, S1\n"), &ENDS);
    assert_ends("in.inp", deck("*NSET, NSET=inlet\n1, 2, 3, 4, 5\n"), &ENDS);
    assert_ends("in.inp", deck("*NSET, NSET=inside\n12, 13\n"), &[]);
}
