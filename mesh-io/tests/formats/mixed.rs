//! Regions, groups, ghosts and conversions of meshes with quadrilaterals.

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
