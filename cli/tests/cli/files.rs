//! Preservation of the input file in each format.

use super::{Folder, assert_holds, assert_smoothed, disturbed};
use gpu_smooth::Mesh;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;

/// The layout of coordinates in a text file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Layout {
    Node,
    Gmsh22,
    Gmsh41,
}

impl Layout {
    /// Returns, for each row, the indices of the words for x and y.
    fn coordinates(self, text: &str) -> Vec<[usize; 2]> {
        const NONE: [usize; 2] = [usize::MAX; 2];
        let (mut in_nodes, mut header_seen) = (false, false);
        let row = |row: &str| {
            let words = row.split_whitespace().count();
            let is_comment = row.trim_start().starts_with(['#', '$']) || words == 0;
            if row.starts_with('$') {
                in_nodes = row.trim_end() == "$Nodes";
            }
            match self {
                _ if is_comment => NONE,
                Layout::Node => {
                    if std::mem::replace(&mut header_seen, true) {
                        [1, 2]
                    } else {
                        NONE
                    }
                }
                Layout::Gmsh22 if in_nodes && words == 4 => [1, 2],
                // Rows of tags have one word, and headers of blocks four.
                Layout::Gmsh41 if in_nodes && words == 3 => [0, 1],
                _ => NONE,
            }
        };
        text.split('\n').map(row).collect()
    }
}

/// Splits a row into alternating words and blanks.
fn pieces(row: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = row;
    while !rest.is_empty() {
        let space = rest.starts_with(|c: char| c.is_ascii_whitespace());
        let end = rest.find(|c: char| c.is_ascii_whitespace() != space).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        pieces.push(piece);
        rest = after;
    }
    pieces
}

/// Checks that two texts differ only in coordinates. Returns the number of differing rows.
#[track_caller]
fn rows_moved(before: &str, after: &str, layout: Layout) -> usize {
    let columns = layout.coordinates(before);
    let rows: Vec<_> = before.split('\n').zip(after.split('\n')).collect();
    assert_eq!((rows.len(), columns.len()), (after.split('\n').count(), rows.len()));
    for ((old, new), columns) in rows.iter().zip(columns) {
        let [old_pieces, new_pieces] = [pieces(old), pieces(new)];
        assert_eq!(old_pieces.len(), new_pieces.len(), "{old} became {new}");
        let mut word = 0;
        for (old_piece, new_piece) in old_pieces.iter().zip(&new_pieces) {
            let is_space = old_piece.starts_with(|c: char| c.is_ascii_whitespace());
            let may_change = !is_space && columns.contains(&word);
            assert!(may_change || old_piece == new_piece, "{old} became {new}");
            word += usize::from(!is_space);
        }
    }
    rows.iter().filter(|(old, new)| old != new).count()
}

/// Smooths `input` on the CPU, and checks all files of the mesh. Each line on standard error must contain the
/// corresponding entry of `notes`.
#[track_caller]
fn assert_only_coordinates_change(
    folder: &Folder,
    names: [&str; 2],
    layout: Layout,
    notes: &[&str],
) {
    assert_change_by(&[], folder, names, layout, notes);
}

/// Runs with further options, and makes the checks of [`assert_only_coordinates_change`].
fn assert_change_by(
    options: &[&str],
    folder: &Folder,
    [input, output]: [&str; 2],
    layout: Layout,
    notes: &[&str],
) {
    let run = folder.run([&[input, output, "--engine", "cpu"], options].concat());
    assert_eq!(run.code, Some(0), "{}", run.err);
    let expected: String = notes.iter().map(|note| format!("gpu-smooth: {note}\n")).collect();
    assert_eq!(run.err, expected);
    let (before, after) = (folder.mesh(input), folder.mesh(output));
    assert_smoothed(&before, &after);
    assert!(support::f_imr(&after) < 0.9 * support::f_imr(&before));
    let moved = rows_moved(&folder.text(input), &folder.text(output), layout);
    let may_move = support::mover_count(&before);
    assert!(moved > may_move / 2 && moved <= may_move, "{moved} of {may_move} rows have changed");
}

/// A `.node` and `.ele` as various programs write them: numbered from `first`, with numbers in several styles, attributes,
/// tabs and comments.
pub(crate) fn triangle_files(mesh: &Mesh, first: usize) -> [String; 2] {
    let held = support::check::held(mesh);
    let mut node = format!("# by hand, \u{fc}ber\n\n  {} 2 2 1  # header\n", mesh.points.len());
    for (i, ([x, y], held)) in mesh.points.iter().zip(held).enumerate() {
        let (n, marker) = (first + i, u8::from(held));
        let row = match i % 4 {
            0 => writeln!(node, "{n} {x:e} {y:E} 7.50 -1e-3 {marker}"),
            1 => writeln!(node, "   {n}\t{x:.17}   {y:+}  0.0 1 {marker} # corner"),
            2 => writeln!(node, "{n} {x} {y} 1 2 {marker} "),
            _ => writeln!(node, "{n} {x} {y} nan .5 {marker}\n# in between"),
        };
        row.unwrap();
    }
    let mut ele = format!("{} 3 1\n", mesh.triangles.len());
    for (i, t) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|v| v as usize + first);
        writeln!(ele, " {}  {a} {b} {c} {}", first + i, ["7.5", "7.50", "+75e-1"][i % 3]).unwrap();
    }
    // The last row of both files has no line end.
    node.push_str("# end");
    ele.truncate(ele.trim_end().len());
    [node, ele]
}

pub(crate) fn triangle_folder([node, ele]: &[String; 2]) -> Folder {
    Folder::new(&[("in.node", node), ("in.ele", ele)])
}

/// The note about vertex data that are not interpolated.
const ATTRIBUTES: &str = "`attribute1`, `attribute2` stay as they are and no longer fit where vertices have moved (--interpolate all takes \
                          them to the new places)";

#[test]
fn triangle_files_keep_all_but_coordinates() {
    let clockwise = |mut mesh: Mesh| {
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 2));
        mesh
    };
    let windings = [
        disturbed(),
        clockwise(disturbed()),
        support::shuffled_windings(&disturbed(), 3),
        support::renumbered(&disturbed(), 4).0,
    ];
    for (mesh, first) in windings.iter().flat_map(|mesh| [(mesh, 0), (mesh, 1)]) {
        for end in ["\n", "\r\n"] {
            let files = triangle_files(mesh, first).map(|text| text.replace('\n', end));
            let folder = triangle_folder(&files);
            assert_only_coordinates_change(
                &folder,
                ["in.node", "out.node"],
                Layout::Node,
                &[ATTRIBUTES],
            );
            assert_eq!(folder.text("out.ele"), files[1]);
            assert_eq!(folder.content().len(), 4);
        }
    }
}

/// Returns the mesh as gmsh text, with `lines` as elements before the triangles, and with sections that the program
/// ignores.
pub(crate) fn gmsh_text(mesh: &Mesh, lines: &[[u32; 2]], layout: Layout) -> String {
    let (n, k) = (mesh.triangles.len(), lines.len());
    let rows = |start: &str| -> String {
        let numbered = lines.iter().enumerate();
        let row =
            |(i, [a, b]): (usize, &[u32; 2])| format!("{} {start}{} {}\n", n + 1 + i, a + 1, b + 1);
        numbered.map(row).collect()
    };
    let (text, old, new) = match layout {
        Layout::Gmsh22 => {
            let new = format!("$Elements\n{}\n{}", n + k, rows("1 2 7 3 "));
            (support::write_msh22(mesh), format!("$Elements\n{n}\n"), new)
        }
        _ => {
            let all = n + k;
            let lines = format!("1 3 1 {k}\n{}", rows(""));
            let new = format!("$Elements\n2 {all} 1 {all}\n{lines}2 1 2 {n}\n");
            (support::write_msh41(mesh), format!("$Elements\n1 {n} 1 {n}\n2 1 2 {n}\n"), new)
        }
    };
    assert!(text.contains(&old));
    let names = "$EndMeshFormat\n$PhysicalNames\n2\n1 7 \"shore, 0.5 0.5\"\n2 1 \"sea\"\n\
                 $EndPhysicalNames\n$Mine\n0.5 0.5 0\n1 0.5 0.5 0\n$EndMine\n";
    let data = "$NodeData\n1\n\"depth\"\n1\n0.0\n3\n0\n1\n2\n1 0.25\n2 1e3\n$EndNodeData\n\n";
    text.replacen(&old, &new, 1).replacen("$EndMeshFormat\n", names, 1) + data
}

fn boundary_lines(mesh: &Mesh) -> Vec<[u32; 2]> {
    let uses = support::edge_uses(mesh);
    uses.into_iter().filter(|(_, uses)| *uses == 1).map(|(edge, _)| edge).collect()
}

#[test]
fn gmsh_files_keep_all_but_coordinates() {
    for mesh in [disturbed(), support::shuffled_windings(&disturbed(), 8)] {
        let lines = boundary_lines(&mesh);
        for (layout, end) in [
            (Layout::Gmsh22, "\n"),
            (Layout::Gmsh22, "\r\n"),
            (Layout::Gmsh41, "\n"),
            (Layout::Gmsh41, "\r\n"),
        ] {
            let text = gmsh_text(&mesh, &lines, layout).replace('\n', end);
            let folder = Folder::new(&[("in.msh", &text)]);
            assert_only_coordinates_change(&folder, ["in.msh", "out.msh"], layout, &[]);
            assert_eq!(folder.content().len(), 2);
        }
    }
}

#[test]
fn binary_files_are_smoothed_like_text() {
    let mesh = disturbed();
    let folder = Folder::new(&[
        ("2.msh", &support::write_msh22(&mesh)),
        ("4.msh", &support::write_msh41(&mesh)),
    ]);
    folder.line("2.msh 2-out.msh --engine cpu").clean();
    let smoothed = folder.mesh("2-out.msh");
    for big in [false, true] {
        for (name, before, after) in [
            (
                "2",
                support::write_msh22_binary(&mesh, big, true),
                support::write_msh22_binary(&smoothed, big, true),
            ),
            (
                "4",
                support::write_msh41_binary(&mesh, big),
                support::write_msh41_binary(&smoothed, big),
            ),
        ] {
            fs::write(folder.path("in.msh"), before).unwrap();
            folder.line("in.msh out.msh --engine cpu").clean();
            assert!(fs::read(folder.path("out.msh")).unwrap() == after, "{name} {big}");
            let told = folder.line("quality out.msh").clean().out;
            assert!(told.contains("out.msh"), "{told}");
        }
    }
}

/// Returns each edge between neighboring vertices in the middle row of the small mesh.
pub(crate) fn middle_row() -> Vec<[u32; 2]> {
    let first = 4 * 11;
    (first..first + 10).map(|v| [v, v + 1]).collect()
}

/// Checks that the vertices of the middle row stayed, and the vertices of adjacent rows moved.
#[track_caller]
pub(crate) fn assert_middle_row_held(before: &Mesh, after: &Mesh) {
    let row: BTreeSet<_> = middle_row().into_iter().flatten().collect();
    let moved = |v: &u32| before.points[*v as usize] != after.points[*v as usize];
    assert!(!row.iter().any(moved));
    assert!([3 * 11 + 5, 5 * 11 + 5].iter().all(moved));
}

#[test]
fn vertices_on_gmsh_lines_stay() {
    for layout in [Layout::Gmsh22, Layout::Gmsh41] {
        let text = gmsh_text(&disturbed(), &middle_row(), layout);
        let folder = Folder::new(&[("in.msh", &text)]);
        assert_only_coordinates_change(&folder, ["in.msh", "out.msh"], layout, &[]);
        assert_middle_row_held(&folder.mesh("in.msh"), &folder.mesh("out.msh"));
    }
}

#[test]
fn vertices_on_poly_segments_stay_and_the_poly_is_written_along() {
    for first in [0, 1] {
        let files = triangle_files(&disturbed(), first);
        let folder = triangle_folder(&files);
        let mut poly = "# outline\n0 2 0 1\n10 1\n".to_owned();
        for (i, [a, b]) in middle_row().into_iter().enumerate() {
            writeln!(poly, "{}  {} {} 5", first + i, a as usize + first, b as usize + first)
                .unwrap();
        }
        poly.push_str("0\n# no holes");
        fs::write(folder.path("in.poly"), &poly).unwrap();
        let note = "10 segments of in.poly: their vertices stay fixed";
        assert_only_coordinates_change(
            &folder,
            ["in.node", "out.node"],
            Layout::Node,
            &[note, ATTRIBUTES],
        );
        assert_middle_row_held(&folder.mesh("in"), &folder.mesh("out"));
        assert_eq!((folder.text("out.ele"), folder.text("out.poly")), (files[1].clone(), poly));
        let slides = folder.line("in out --slide --force --engine cpu").err;
        assert_holds(&slides, &[&format!("{note}, or slide along lines\n")]);
    }
}

#[test]
fn vertices_of_quadrilaterals_stay_on_request() {
    // Two triangles in the middle of the mesh that form a rhombus become one quadrilateral.
    let mut mesh = disturbed();
    let kept: Vec<_> = mesh.triangles.drain(..).collect();
    let mut quads = Vec::new();
    for (i, pair) in kept.chunks_exact(2).enumerate() {
        match pair {
            &[[a, b, c], [_, d, _]] if i == 42 || i == 44 => quads.push([a, b, d, c]),
            pair => mesh.triangles.extend_from_slice(pair),
        }
    }
    assert_eq!(quads.len(), 2);
    let n = mesh.triangles.len();
    let rows: String = quads
        .iter()
        .map(|[a, b, c, d]| format!("9{a} 3 2 1 1 {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1))
        .collect();
    let text = support::write_msh22(&mesh).replacen(
        &format!("$Elements\n{n}\n"),
        &format!("$Elements\n{}\n{rows}", n + 2),
        1,
    );
    let folder = Folder::new(&[("in.msh", &text)]);
    let note = "2 quadrilaterals: their vertices stay fixed";
    let keep = ["--quadrilaterals", "keep"];
    assert_change_by(&keep, &folder, ["in.msh", "out.msh"], Layout::Gmsh22, &[note]);
    let [before, after] = ["in.msh", "out.msh"].map(|name| folder.mesh(name));
    for v in quads.into_iter().flatten() {
        assert_eq!(before.points[v as usize], after.points[v as usize]);
    }
}
