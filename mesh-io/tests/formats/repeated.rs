//! Elements of several physical groups, which gmsh lists once for each group in files of version 2.2.

use super::{Folder, long};
use mesh_io::{Content, MeshFile};
use std::fs;
use support::Binary;

/// Groups of a triangle in the left and the right half of the mesh. All triangles are in group 1.
const GROUPS: [[i32; 2]; 2] = [[1, 2], [1, 3]];

/// A row of `$Elements`: type, physical group, entity and nodes.
type Row = (i32, i32, i32, Vec<i32>);

fn middle(points: &[[f64; 2]]) -> f64 {
    points.iter().map(|p| p[0]).fold(0.0, f64::max) / 2.0
}

/// Returns the rows of a mesh whose lines and triangles are in two groups each. With `has_entities`, the halves are two
/// entities; otherwise only the groups distinguish them.
fn rows(points: &[[f64; 2]], triangles: &[[u32; 3]], has_entities: bool) -> Vec<Row> {
    let middle = middle(points);
    let node = |v: u32| v as i32 + 1;
    let mut rows: Vec<Row> =
        [4, 5].map(|group| (1, group, i32::from(has_entities), vec![1, 2])).into();
    for corners in triangles {
        let half = usize::from(corners.iter().all(|&v| points[v as usize][0] >= middle));
        let entity = if has_entities { half as i32 + 1 } else { 0 };
        let nodes = corners.map(node).to_vec();
        rows.extend(GROUPS[half].map(|group| (2, group, entity, nodes.clone())));
    }
    rows
}

fn text(points: &[[f64; 2]], rows: &[Row]) -> Vec<u8> {
    let nodes = points.iter().enumerate().map(|(i, [x, y])| format!("{} {x:?} {y:?} 0\n", i + 1));
    let elements = rows.iter().enumerate().map(|(i, (kind, group, entity, nodes))| {
        let nodes: Vec<String> = nodes.iter().map(i32::to_string).collect();
        format!("{} {kind} 2 {group} {entity} {}\n", i + 1, nodes.join(" "))
    });
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"all\"\n2 3 \"right\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
        points.len(),
        nodes.collect::<String>(),
        rows.len(),
        elements.collect::<String>()
    )
    .into_bytes()
}

/// Returns the mesh in binary. `header_each` gives each element a header, as old versions of gmsh do.
fn binary(points: &[[f64; 2]], rows: &[Row], big: bool, header_each: bool) -> Vec<u8> {
    let mut file = Binary::new("2.2", big);
    file.text(&format!(
        "$PhysicalNames\n2\n2 1 \"all\"\n2 3 \"right\"\n$EndPhysicalNames\n$Nodes\n{}\n",
        points.len()
    ));
    for (i, [x, y]) in points.iter().enumerate() {
        file.ints(&[i as i32 + 1]);
        file.doubles(&[*x, *y, 0.0]);
    }
    file.text(&format!("\n$EndNodes\n$Elements\n{}\n", rows.len()));
    let mut element = 0;
    for block in rows.chunk_by(|a, b| a.0 == b.0 && !header_each) {
        file.ints(&[block[0].0, block.len() as i32, 2]);
        for (_, group, entity, nodes) in block {
            element += 1;
            file.ints(&[element, *group, *entity]);
            file.ints(nodes);
        }
    }
    file.text("\n$EndElements\n");
    file.bytes
}

/// Returns the labels and the numbers of triangles and lines of all physical groups.
fn physical(file: &MeshFile) -> Vec<(String, usize, usize)> {
    let groups = file.groups().unwrap();
    let own = groups.iter().filter(|group| group.kind == "physical");
    own.map(|group| {
        let name = group.name.clone().or(group.tag.map(|tag| tag.to_string()));
        (name.unwrap(), group.triangles().len(), group.lines)
    })
    .collect()
}

/// Returns the physical groups of each cell of the content.
fn groups_of(content: &Content) -> Vec<Vec<i64>> {
    let tags = |cell: mesh_io::Cell<'_>| {
        let mut tags: Vec<i64> = cell
            .groups()
            .filter(|group| group.kind() == "physical")
            .filter_map(|g| g.tag())
            .collect();
        tags.sort_unstable();
        tags
    };
    content.cells().map(tags).collect()
}

#[test]
fn a_triangle_of_several_physical_groups_is_read_once() {
    // 39,204 rows, as each triangle is in two groups. Several threads read lists of 16,384 rows or more.
    let long = (long::points_of(100), long::triangles_of(100));
    let short =
        vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.5]];
    let corners = vec![[0, 1, 6], [0, 6, 5], [5, 6, 4], [1, 2, 6], [2, 3, 6], [6, 3, 4]];
    for (points, triangles) in [(short, corners), long] {
        let middle = middle(&points);
        let is_right = |t: &&[u32; 3]| t.iter().all(|&v| points[v as usize][0] >= middle);
        let right = triangles.iter().filter(is_right).count();
        for has_entities in [true, false] {
            let rows = rows(&points, &triangles, has_entities);
            let files = [
                text(&points, &rows),
                binary(&points, &rows, false, false),
                binary(&points, &rows, true, false),
                binary(&points, &rows, false, true),
            ];
            for bytes in files {
                let folder = Folder::new(&[]);
                fs::write(folder.path("in.msh"), &bytes).unwrap();
                let file = folder.read("in.msh");
                assert_eq!(file.triangles(), triangles);
                let all = triangles.len();
                let expected = [
                    ("4", 0, 1),
                    ("5", 0, 1),
                    ("all", all, 0),
                    ("2", all - right, 0),
                    ("right", right, 0),
                ];
                assert_eq!(physical(&file), expected.map(|(name, t, l)| (name.to_owned(), t, l)));
                // Vertices between the halves stay fixed.
                let regions = file.regions().unwrap();
                assert_eq!(
                    regions.iter().filter(|&&region| region == regions[0]).count(),
                    all - right
                );
                assert!(!file.interface_vertices().is_empty());
                let groups = groups_of(&file.content().unwrap());
                assert_eq!(groups.len(), 1 + all);
                assert_eq!((&groups[0], &groups[1]), (&vec![4, 5], &vec![1, 2]));
            }
        }
    }
}

#[test]
fn a_triangle_that_is_listed_twice_in_a_group_is_kept_twice() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let rows = vec![(2, 1, 1, vec![1, 2, 3]); 2];
    for bytes in [text(&points, &rows), binary(&points, &rows, false, false)] {
        let folder = Folder::new(&[]);
        fs::write(folder.path("in.msh"), &bytes).unwrap();
        assert_eq!(folder.read("in.msh").triangles().len(), 2);
    }
}
