//! Conversions to MED and CGNS: the groups, vertices and data that come back from the written files.

use super::Folder;
use mesh_io::{CellKind, Content, Conversion, Format};
use std::collections::{BTreeMap, BTreeSet};

/// Two regions of triangles and a quadrilateral, curves with and without groups, a point, and data of vertices. The
/// third triangle is in two groups, and one curve and one surface have the same name.
const MESH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n0 4 \"gauge\"\n1 1 \"in let\"\n1 2 \"steel\"\n\
2 1 \"steel\"\n2 2 \"upper/part\"\n$EndPhysicalNames\n$Nodes\n7\n1 0 0 .5\n2 1 0 1\n3 1 1 1\n4 0 1 1\n5 .5 .5 1\n\
6 2 0 1\n7 2 1 -3\n$EndNodes\n$Elements\n10\n1 15 2 4 1 1\n2 1 2 1 7 1 2\n3 1 2 2 8 3 4\n4 1 2 0 9 4 1\n\
5 2 2 1 4 1 2 5\n6 2 2 2 4 2 3 5\n7 2 2 1 4 3 4 5\n7 2 2 2 4 3 4 5\n8 2 2 2 4 4 1 5\n9 3 2 1 4 2 6 7 3\n$EndElements\n\
$NodeData\n1\n\"T (K)\"\n1\n0\n3\n0\n1\n7\n1 280.5\n2 281\n3 282\n4 283\n5 284\n6 1e-300\n7 -0.1\n$EndNodeData\n";

/// Converts the mesh. Returns losses, changed names, and the content of the result.
fn converted(name: &str, text: &str, format: Format, out: &str) -> (String, String, Content) {
    let folder = Folder::new(&[(name, text)]);
    let conversion = Conversion::new(&folder.read(name), format).unwrap().unwrap();
    conversion.write(&folder.path(out)).unwrap();
    let back = folder.read(out);
    assert_eq!(back.format(), format);
    let told = [conversion.losses(), conversion.renamings()].map(|lines| lines.join("; "));
    let [lost, renamed] = told;
    (lost, renamed, back.content().unwrap())
}

/// Returns the corners of the cells of each shape and group of a kind, by group name, in the order of the file.
fn members(content: &Content, kind: &str) -> BTreeMap<(String, String), Vec<Vec<u32>>> {
    let mut members: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for cell in content.cells() {
        let shape = match cell.kind {
            CellKind::Point => "point",
            CellKind::Line => "line",
            CellKind::Triangle => "triangle",
            _ => "quadrilateral",
        };
        for group in cell.groups().filter(|group| group.kind() == kind) {
            let key = (group.name().unwrap().to_owned(), shape.to_owned());
            members.entry(key).or_default().push(cell.vertices.to_vec());
        }
    }
    members
}

fn expected(rows: &[(&str, &str, &[&[u32]])]) -> BTreeMap<(String, String), Vec<Vec<u32>>> {
    let own = |&(name, shape, cells): &(&str, &str, &[&[u32]])| {
        let cells = cells.iter().map(|cell| cell.to_vec()).collect();
        ((name.to_owned(), shape.to_owned()), cells)
    };
    rows.iter().map(own).collect()
}

fn heights(content: &Content) -> Vec<f64> {
    (0..7).map(|vertex| content.z(vertex)).collect()
}

#[test]
fn families_of_med_are_all_groups_of_elements() {
    let (lost, renamed, back) = converted("in.msh", MESH, Format::Med, "out.med");
    assert_eq!(lost, "data of vertices: T (K)");
    assert_eq!(renamed, "groups: `steel` (1) to `steel_2`");
    assert_eq!(heights(&back), [0.5, 1.0, 1.0, 1.0, 1.0, 1.0, -3.0]);
    let rows: [(&str, &str, &[&[u32]]); 6] = [
        ("gauge", "point", &[&[0]]),
        ("in let", "line", &[&[0, 1]]),
        ("steel", "line", &[&[2, 3]]),
        ("steel_2", "triangle", &[&[0, 1, 4], &[2, 3, 4]]),
        ("steel_2", "quadrilateral", &[&[1, 5, 6, 2]]),
        ("upper/part", "triangle", &[&[1, 2, 4], &[2, 3, 4], &[3, 0, 4]]),
    ];
    assert_eq!(members(&back, "group"), expected(&rows));
    let lines = back.cells().filter(|cell| cell.kind == CellKind::Line).count();
    assert_eq!((back.cells().count(), lines), (9, 3));

    // The numbers of families add nothing to the groups in gmsh's format, which has no negative numbers.
    let folder = Folder::new(&[("in.msh", MESH)]);
    let to = |from: &str, format| Conversion::new(&folder.read(from), format).unwrap().unwrap();
    to("in.msh", Format::Med).write(&folder.path("out.med")).unwrap();
    let gmsh = to("out.med", Format::Gmsh41);
    assert_eq!(gmsh.losses(), [""; 0]);
    let names = gmsh.text().unwrap();
    assert!(names.contains("$PhysicalNames\n5\n0 1 \"gauge\"\n"), "{names}");
}

#[test]
fn sections_of_cgns_are_groups_and_lines_have_boundary_conditions() {
    let (lost, renamed, back) = converted("in.msh", MESH, Format::Cgns, "out.cgns");
    let expected_losses = "further groups of a kind of an element: the first group is kept; \
        the order of triangles, which stand group by group; \
        that groups have triangles and quadrilaterals, which become blocks each";
    assert_eq!(lost, expected_losses);
    let changes = "groups: `steel` (1) to `steel_2`, `upper/part` (2) to `upper_part`";
    assert_eq!(renamed, changes);
    assert_eq!(heights(&back), [0.5, 1.0, 1.0, 1.0, 1.0, 1.0, -3.0]);
    let rows: [(&str, &str, &[&[u32]]); 7] = [
        ("gauge", "point", &[&[0]]),
        ("in let", "line", &[&[0, 1]]),
        ("lines", "line", &[&[3, 0]]),
        ("steel", "line", &[&[2, 3]]),
        ("steel_2", "triangle", &[&[0, 1, 4], &[2, 3, 4]]),
        ("steel_2_2", "quadrilateral", &[&[1, 5, 6, 2]]),
        ("upper_part", "triangle", &[&[1, 2, 4], &[3, 0, 4]]),
    ];
    assert_eq!(members(&back, "section"), expected(&rows));
    assert_eq!(members(&back, "boundary"), expected(&rows[1..4]));
    assert_eq!(members(&back, "family"), expected(&rows[1..4]));
    let [data] = back.point_data() else { panic!("one array") };
    assert_eq!(data.name(), "T (K)");
    assert_eq!(data.values(), [280.5, 281.0, 282.0, 283.0, 284.0, 1e-300, -0.1]);
}

const SETS: &str = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 0., 1e-7\n4, 3., 3.\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n2, 2, 4, 3\n\
*ELEMENT, TYPE=T2D2, ELSET=wall\n3, 1, 2\n*NSET, NSET=wall\n3, 1\n*NSET, NSET=pin\n3\n*NSET, NSET=far\n4\n";

#[test]
fn sets_of_vertices_keep_names_and_overlap() {
    for (format, out, wall) in
        [(Format::Med, "out.med", "wall"), (Format::Cgns, "out.cgns", "wall_2")]
    {
        let (lost, renamed, back) = converted("in.inp", SETS, format, out);
        assert_eq!(lost, "", "{out}");
        let change = format!("groups of vertices: `wall` to `{wall}`");
        assert_eq!(renamed, if wall == "wall" { "" } else { &change }, "{out}");
        let own = back.vertex_groups();
        let sets: BTreeSet<_> =
            own.map(|(group, vertices)| (group.name().unwrap(), vertices)).collect();
        let expected: [(&str, &[u32]); 3] = [("far", &[3]), ("pin", &[2]), (wall, &[0, 2])];
        assert_eq!(sets, BTreeSet::from(expected), "{out}");
        // All z are 0, so the file has two axes.
        assert_eq!(back.z(0), 0.0);
    }
}
