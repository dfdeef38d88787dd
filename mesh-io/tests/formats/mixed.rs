//! Regions, groups, ghosts and conversions of meshes with quadrilaterals.

use super::Folder;
use super::facts::remarks;
use mesh_io::{Conversion, Format, MeshFile, ReadOptions, Remark};
use std::fmt::Write;
use std::path::Path;

/// Number of squares of the grid in each direction.
const N: usize = 8;

/// Element of the grid: its corners, and the column and row of its square.
type Cell = (Vec<usize>, [usize; 2]);

/// Returns the elements of a grid of squares. A square for whose column and row `is_divided` returns true becomes two triangles,
/// another square a quadrilateral.
fn cells(is_divided: impl Fn(usize, usize) -> bool) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (row, column) in (0..N * N).map(|square| (square / N, square % N)) {
        let a = row * (N + 1) + column;
        let [b, c, d] = [a + 1, a + N + 2, a + N + 1];
        let corners = match is_divided(column, row) {
            true => vec![vec![a, b, c], vec![a, c, d]],
            false => vec![vec![a, b, c, d]],
        };
        cells.extend(corners.into_iter().map(|corners| (corners, [column, row])));
    }
    cells
}

/// Returns the elements of grids: quadrilaterals alone, some squares divided, the left half divided, and few squares divided.
fn grids() -> [Vec<Cell>; 4] {
    let few = |column, row| row == 0 && column % 2 == 1;
    [
        cells(|_, _| false),
        cells(|column, row| (column + 2 * row) % 5 < 2),
        cells(|column, _| column < N / 2),
        cells(few),
    ]
}

/// Returns 0 for an element in the left half of the grid, 1 for one in the right half.
fn half(&(_, [column, _]): &Cell) -> usize {
    2 * column / N
}

/// Vertices inside the mesh between the left and the right half.
fn middle() -> Vec<u32> {
    (1..N).map(|row| (row * (N + 1) + N / 2) as u32).collect()
}

/// Returns a row of text with numbers, the first of which is 0 or 1.
fn joined(numbers: &[usize], first: usize) -> String {
    numbers.iter().map(|number| (number + first).to_string()).collect::<Vec<_>>().join(" ")
}

/// Returns a file of gmsh, version 2.2. `tags` returns the physical group and the entity of an element.
fn msh(cells: &[Cell], tags: impl Fn(usize, &Cell) -> [usize; 2]) -> String {
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n81\n".to_owned();
    for vertex in 0..(N + 1) * (N + 1) {
        let [x, y] = [vertex % (N + 1), vertex / (N + 1)];
        writeln!(text, "{} {x} {y} 0", vertex + 1).unwrap();
    }
    write!(text, "$EndNodes\n$Elements\n{}\n", cells.len()).unwrap();
    for (k, cell) in cells.iter().enumerate() {
        let ([physical, entity], kind) = (tags(k, cell), cell.0.len() - 1);
        writeln!(text, "{} {kind} 2 {physical} {entity} {}", k + 1, joined(&cell.0, 1)).unwrap();
    }
    text + "$EndElements\n"
}

/// A named array of cell data, with the number of each element.
type Array<'a> = (&'a str, &'a dyn Fn(usize, &Cell) -> usize);

/// Returns a legacy VTK file with cell data.
fn vtk(cells: &[Cell], arrays: &[Array<'_>]) -> String {
    let mut text =
        "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 81 double\n"
            .to_owned();
    for vertex in 0..(N + 1) * (N + 1) {
        writeln!(text, "{} {} 0", vertex % (N + 1), vertex / (N + 1)).unwrap();
    }
    let size: usize = cells.iter().map(|(corners, _)| corners.len() + 1).sum();
    writeln!(text, "CELLS {} {size}", cells.len()).unwrap();
    for (corners, _) in cells {
        writeln!(text, "{} {}", corners.len(), joined(corners, 0)).unwrap();
    }
    writeln!(text, "CELL_TYPES {}", cells.len()).unwrap();
    cells.iter().for_each(|(own, _)| text += if own.len() == 3 { "5\n" } else { "9\n" });
    writeln!(text, "CELL_DATA {}", cells.len()).unwrap();
    for (name, number) in arrays {
        writeln!(text, "SCALARS {name} int 1\nLOOKUP_TABLE default").unwrap();
        cells
            .iter()
            .enumerate()
            .for_each(|(k, cell)| writeln!(text, "{}", number(k, cell)).unwrap());
    }
    text
}

fn options() -> ReadOptions {
    ReadOptions::new().allow_quadrilaterals_alone(true)
}

fn read(name: &str, text: &str) -> MeshFile {
    options().from_bytes(Path::new(name), text.as_bytes().to_vec()).unwrap()
}

fn converted(file: &MeshFile, to: Format) -> Conversion {
    Conversion::new(file, to).unwrap().unwrap()
}

/// Returns the remarks on a file except the one on its quadrilaterals.
fn other_remarks(file: &MeshFile) -> Vec<Remark> {
    let is_count = |remark: &Remark| matches!(remark, Remark::OtherElements { .. });
    file.remarks().iter().filter(|remark| !is_count(remark)).cloned().collect()
}

/// A former defect: if entities counted triangles, all quadrilaterals became one region. Vertices between real regions then
/// moved, and vertices inside of regions stayed.
#[test]
fn regions_of_both_kinds_remain_if_another_number_counts_elements() {
    for cells in grids() {
        let text = msh(&cells, |k, cell| [10 + half(cell), k + 1]);
        let file = read("in.msh", &text);
        assert_eq!(file.interfaces_of_elements().0, middle());
        assert_eq!(other_remarks(&file), [Remark::CountedElements]);
    }
}

/// A former defect: numbers of quadrilaterals that count elements were regions, so that no vertex could move, and groups.
#[test]
fn numbers_that_count_triangles_and_quadrilaterals_are_neither_regions_nor_groups() {
    for cells in grids() {
        // Programs number all elements, or each kind of elements from 1.
        let is_triangle = |(corners, _): &Cell| corners.len() == 3;
        let of_kind = |k: usize, cell: &Cell| {
            let before = cells[..k].iter();
            1 + before.filter(|other| is_triangle(other) == is_triangle(cell)).count()
        };
        for count in [&|k: usize, _: &Cell| k + 1, &of_kind as &dyn Fn(usize, &Cell) -> usize] {
            let file = read("in.msh", &msh(&cells, |k, cell| [count(k, cell), 1]));
            assert_eq!(file.interfaces_of_elements().0, [0; 0]);
            assert_eq!(other_remarks(&file), [Remark::CountedElements]);
            let groups = file.groups().unwrap();
            assert!(groups.iter().all(|group| group.kind == "entity"));
            let conversion = converted(&file, Format::Vtu);
            let lost = "numbers that differ for nearly every element: physical";
            assert_eq!(conversion.losses(), [lost]);
        }
    }
}

/// A former defect: eight materials, which triangles and quadrilaterals had, counted twice, as many as there were elements.
#[test]
fn materials_of_a_small_mesh_count_no_elements() {
    let cells: Vec<Cell> = cells(|column, _| column < 5).into_iter().step_by(6).collect();
    let is_triangle = |(corners, _): &&Cell| corners.len() == 3;
    let triangles = cells.iter().filter(is_triangle).count();
    assert!(cells.len() >= 16 && triangles >= 8 && cells.len() - triangles >= 4);
    let file = read("in.msh", &msh(&cells, |k, _| [1 + k % 9, 1]));
    let groups = file.groups().unwrap();
    assert_eq!(groups.iter().filter(|group| group.kind == "physical").count(), 9);
    assert_eq!(converted(&file, Format::Vtu).losses(), [""; 0]);
}

/// A former defect: with triangles and quadrilaterals in two physical groups each, vertices between the kinds stayed.
#[test]
fn elements_of_equal_groups_are_one_region_whatever_their_kind() {
    let cells = cells(|column, _| column < N / 2);
    let once = msh(&cells, |_, _| [10, 1]);
    let twice = once.lines().enumerate().map(|(row, line)| {
        let parts: Vec<&str> = line.split(' ').collect();
        match parts[..] {
            [_, "2" | "3", "2", "10", ..] => {
                format!("{line}\n9{row} {} 2 11 {}\n", parts[1], parts[4..].join(" "))
            }
            _ => format!("{line}\n"),
        }
    });
    let count = cells.len();
    let twice =
        twice.collect::<String>().replace(&format!("\n{count}\n"), &format!("\n{}\n", 2 * count));
    let file = read("in.msh", &twice);
    assert_eq!((file.triangles().len(), file.quadrilaterals().len()), (64, 32));
    assert_eq!(file.interfaces_of_elements().0, [0; 0]);
    assert_eq!(file.groups().unwrap().find("11").unwrap().quadrilaterals().len(), 32);
}

/// A former defect: cell data were judged at the triangles alone, so that regions of meshes with quadrilaterals were missed.
#[test]
fn cell_data_that_look_like_regions_are_judged_at_all_elements() {
    for cells in grids() {
        let file = read("in.vtk", &vtk(&cells, &[("prop", &|_, cell| 1 + half(cell))]));
        assert_eq!(file.interfaces_of_elements().0, middle());
        let array = Remark::RegionArray { array: "prop".into(), others: Vec::new() };
        assert_eq!(other_remarks(&file), [array]);
        assert_eq!(file.groups().unwrap().iter().count(), 2);
        let flags = read("in.vtk", &vtk(&cells, &[("flag", &|_, (_, [i, j])| (i + j) % 2)]));
        assert_eq!(other_remarks(&flags), []);
        assert_eq!(flags.interfaces_of_elements().0, [0; 0]);
    }
}

/// A former defect: the note on dividing cell data was missing if quadrilaterals alone have the regions.
#[test]
fn cell_data_that_divide_regions_of_quadrilaterals_are_named() {
    for cells in grids() {
        let rows = |_: usize, (_, [_, row]): &Cell| 2 * row / N;
        let arrays: [Array<'_>; 2] = [("MaterialIDs", &|_, cell| 5 + half(cell)), ("prop", &rows)];
        let file = read("in.vtk", &vtk(&cells, &arrays));
        assert_eq!(file.interfaces_of_elements().0, middle());
        assert_eq!(other_remarks(&file), [Remark::FurtherRegionArrays(vec!["prop".into()])]);
    }
}

/// A former defect: a region array of a usual name, given by name, numbered triangles and quadrilaterals apart.
#[test]
fn a_named_region_array_has_equal_numbers_for_both_kinds() {
    for cells in grids() {
        let text = vtk(&cells, &[("MaterialIDs", &|_, cell| 5 + half(cell))]);
        let options = options().regions(Some("MaterialIDs".into()));
        let file = options.from_bytes(Path::new("in.vtk"), text.into_bytes()).unwrap();
        assert_eq!(file.interfaces_of_elements().0, middle());
    }
}

/// meshio writes a block for each kind of elements, whatever their regions.
#[test]
fn cell_data_are_regions_in_an_exodus_with_one_block_for_each_kind() {
    for cells in grids() {
        let arrays: [Array<'_>; 2] = [("one", &|_, _| 1), ("prop", &|_, cell| 1 + half(cell))];
        let options_of_one = options().regions(Some("one".into()));
        let text = vtk(&cells, &arrays);
        let file = options_of_one.from_bytes(Path::new("in.vtk"), text.into_bytes()).unwrap();
        let bytes = converted(&file, Format::Exodus).bytes().unwrap();
        let back = options().from_bytes(Path::new("in.exo"), bytes).unwrap();
        let blocks = [file.triangles().len(), file.quadrilaterals().len()];
        let blocks = blocks.iter().filter(|count| **count > 0).count();
        let groups = back.groups().unwrap();
        assert_eq!(groups.iter().filter(|group| group.kind == "block").count(), blocks);
        assert_eq!(back.interfaces_of_elements().0, middle());
    }
}

/// gmsh and Exodus may have data at elements of one kind alone.
#[test]
fn regions_of_triangles_are_found_if_quadrilaterals_lack_data() {
    let cells = cells(|_, row| row < N / 2);
    let triangles = cells.iter().enumerate().filter(|(_, (corners, _))| corners.len() == 3);
    let rows = triangles.map(|(k, cell)| format!("{} {}\n", k + 1, half(cell)));
    let rows: Vec<String> = rows.collect();
    let data = format!(
        "$ElementData\n1\n\"prop\"\n1\n0\n3\n0\n1\n{}\n{}$EndElementData\n",
        rows.len(),
        rows.concat()
    );
    let file = read("in.msh", &(msh(&cells, |_, _| [0, 1]) + &data));
    assert_eq!(file.interface_vertices(), middle()[..N / 2 - 1]);
    let options = options().regions(Some("prop".into()));
    let text = msh(&cells, |_, _| [0, 1]) + &data;
    let error = options.from_bytes(Path::new("in.msh"), text.into_bytes()).unwrap_err();
    assert!(error.to_string().contains("not a whole number for each element"), "{error}");
}

/// A former defect: conversions to formats of blocks changed the order of quadrilaterals without a word.
#[test]
fn the_order_of_quadrilaterals_in_blocks_is_listed() {
    let lost = |cells: &[Cell], group: &dyn Fn(usize, &Cell) -> usize, to| {
        let file = read("in.msh", &msh(cells, |k, cell| [group(k, cell), 1]));
        converted(&file, to).losses().join("; ")
    };
    let alternating = |k: usize, _: &Cell| 10 + k % 2;
    let halves = |_: usize, cell: &Cell| 10 + half(cell);
    let [quadrilaterals, mixed, apart, _] = grids();
    let order = |kind: &str| format!("the order of {kind}s, which stand group by group");
    let both = "that groups have triangles and quadrilaterals, which become blocks each";
    for to in [Format::Exodus, Format::Cgns] {
        assert_eq!(lost(&quadrilaterals, &alternating, to), order("quadrilateral"), "{to}");
        assert_eq!(lost(&quadrilaterals, &|k, _| 10 + k / 32, to), "", "{to}");
        let all = [order("triangle"), order("quadrilateral"), both.to_owned()].join("; ");
        assert_eq!(lost(&mixed, &halves, to), all, "{to}");
        assert_eq!(lost(&apart, &halves, to), "", "{to}");
    }
}

/// A former defect: the remark on ghosts by cell data counted triangles alone.
#[test]
fn ghosts_among_quadrilaterals_are_counted() {
    let points = "0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n3 0 0\n";
    for (cells, ghosts, count, held) in [
        ("4 0 1 4 3\n4 1 2 5 4\n3 2 6 5\n", "0 1 0", "1 ghost element", &[1, 2, 4, 5][..]),
        ("4 0 1 4 3\n4 1 2 5 4\n3 2 6 5\n", "0 1 1", "2 ghost elements", &[1, 2, 4, 5, 6]),
    ] {
        let flags: Vec<&str> = ghosts.split(' ').collect();
        let faces: String =
            cells.lines().zip(&flags).map(|(own, flag)| format!("{flag} {own}\n")).collect();
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\nelement face 3\n\
             property uchar vtkGhostType\nproperty list uchar int vertex_indices\nend_header\n{points}{faces}"
        );
        let item = |size: &str, kind: &str, numbers: &str| {
            format!(
                "<DataItem Format=\"XML\" NumberType=\"{kind}\" Dimensions=\"{size}\">{numbers}</DataItem>"
            )
        };
        // Types of cells in a mixed topology: 5 for quadrilaterals, 4 for triangles.
        let mixed = cells.replace("4 0", "5 0").replace("4 1 2", "5 1 2").replace("3 2", "4 2");
        let xdmf = format!(
            "<Xdmf Version=\"3.0\"><Domain><Grid><Geometry GeometryType=\"XYZ\">{}</Geometry><Topology \
             TopologyType=\"Mixed\" NumberOfElements=\"3\">{}</Topology><Attribute Name=\"vtkGhostType\" \
             AttributeType=\"Scalar\" Center=\"Cell\">{}</Attribute></Grid></Domain></Xdmf>\n",
            item("7 3", "Float", points),
            item("14", "Int", &mixed),
            item("3", "Int", ghosts)
        );
        for (name, text) in [("a.ply", &ply), ("a.xdmf", &xdmf)] {
            let file = read(name, text);
            assert_eq!(remarks(&file)[1..], [count.to_owned()], "{name}");
            let mut vertices = file.constraints_beside_quadrilaterals().vertices;
            vertices.sort_unstable();
            vertices.dedup();
            assert_eq!(vertices, held, "{name}");
        }
    }
}

/// A former defect: groups of vertices did not end at interfaces between quadrilaterals.
#[test]
fn groups_of_vertices_end_where_an_interface_of_quadrilaterals_leads_out() {
    let cells = cells(|_, _| false);
    let mut text = msh(&cells, |_, cell| [10 + half(cell), 1]);
    // Points on the interface, up to the third row.
    let points: String = (1..4)
        .map(|row| format!("{} 15 2 20 5 {}\n", 100 + row, row * (N + 1) + N / 2 + 1))
        .collect();
    text =
        text.replace("$EndElements", &format!("{points}$EndElements")).replace("\n64\n", "\n67\n");
    let ends = read("in.msh", &text).group_ends().unwrap();
    let [first, last] = [1, 3].map(|row| (row * (N + 1) + N / 2) as u32);
    assert_eq!(ends, [first, last]);
}

/// A former defect: conversions lost points inside of quadrilaterals without a word.
#[test]
fn points_between_quadrilaterals_are_listed_as_losses() {
    for cells in &grids()[..2] {
        let text = msh(cells, |_, _| [0, 1]);
        let count = cells.len();
        let point = format!("999 15 2 0 1 {}\n$EndElements", 3 * (N + 1) + 4);
        let text = text.replace("$EndElements", &point);
        let text = text.replace(&format!("\n{count}\n"), &format!("\n{}\n", count + 1));
        let file = read("in.msh", &text);
        assert_eq!(converted(&file, Format::Off).losses(), ["1 point"]);
    }
}

/// A former defect: vertices of required quadrilaterals moved, and the list was lost without its name.
#[test]
fn vertices_of_required_quadrilaterals_stay() {
    let text = "MeshVersionFormatted 2\nDimension 2\nVertices\n6\n0 0 1\n1 0 1\n2 0 1\n0 1 1\n1 1 1\n2 1 1\n\
        Triangles\n2\n2 3 6 7\n2 6 5 7\nQuadrilaterals\n1\n1 2 5 4 7\nRequiredQuadrilaterals\n1\n1\nEnd\n";
    let folder = Folder::new(&[("in.mesh", text)]);
    let file = folder.read("in.mesh");
    assert_eq!(file.constraints_beside_quadrilaterals().vertices, [0, 1, 4, 3]);
    assert_eq!(remarks(&file), ["1 quadrilateral", "1 required quadrilateral"]);
    let group = file.groups().unwrap().find("RequiredQuadrilaterals").unwrap().vertices().to_vec();
    assert_eq!(group, [0, 1, 3, 4]);
    let losses = converted(&file, Format::Vtu).losses().join("; ");
    assert!(losses.contains("the list RequiredQuadrilaterals"), "{losses}");
}
