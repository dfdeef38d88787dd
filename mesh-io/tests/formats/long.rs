//! Lists that are long enough for several threads: reads and writes give the results of short lists.

use super::Folder;
use mesh_io::{Location, MeshFile};
use std::fmt::Write;

/// Number of vertices along a side of the mesh.
const SIDE: usize = 180;

/// The text of a mesh with comments and blank lines, and the line numbers of its vertices and triangles, counted from
/// 1.
struct Text {
    name: &'static str,
    text: String,
    end: &'static str,
    lines: usize,
    vertex_lines: Vec<usize>,
    triangle_lines: Vec<usize>,
}

impl Text {
    fn new(name: &'static str, end: &'static str) -> Text {
        let (vertex_lines, triangle_lines) = (Vec::new(), Vec::new());
        Text { name, text: String::new(), end, lines: 0, vertex_lines, triangle_lines }
    }

    /// Adds a row, sometimes after a blank or comment line. Returns the line number of the row.
    fn row(&mut self, row: &str) -> usize {
        if self.lines % 97 == 5 {
            self.line("");
        }
        if self.lines % 61 == 7 {
            self.line("  # 1 2 3 4 5 6");
        }
        self.line(row)
    }

    fn line(&mut self, line: &str) -> usize {
        self.text.push_str(line);
        self.text.push_str(self.end);
        self.lines += 1;
        self.lines
    }

    /// Returns the text with one line replaced, or removed if `by` is `None`.
    fn with(&self, line: usize, by: Option<&str>) -> String {
        let mut text: Vec<&str> = self.text.split_inclusive(self.end).collect();
        let replaced = by.map(|by| format!("{by}{}", self.end)).unwrap_or_default();
        text[line - 1] = &replaced;
        text.concat()
    }
}

pub(crate) fn points() -> Vec<[f64; 2]> {
    points_of(SIDE)
}

pub(crate) fn triangles() -> Vec<[u32; 3]> {
    triangles_of(SIDE)
}

/// Returns the points of a lattice with `side` vertices along each side.
pub(crate) fn points_of(side: usize) -> Vec<[f64; 2]> {
    let at = |i: usize| [(i % side) as f64 + 0.3 / (i + 1) as f64, (i / side) as f64 * 1.1];
    (0..side * side).map(at).collect()
}

/// Returns the triangles of a lattice with `side` vertices along each side.
pub(crate) fn triangles_of(side: usize) -> Vec<[u32; 3]> {
    let cells = (0..side * (side - 1)).filter(|i| i % side != side - 1);
    let halves = cells.flat_map(|i| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]]);
    halves.map(|triangle| triangle.map(|v| v as u32)).collect()
}

/// Returns a mesh in each format; the first vertex has the number `first`.
fn texts(points: &[[f64; 2]], end: &'static str, first: usize) -> [Text; 4] {
    let mut texts = ["m.node", "m.ele", "2.msh", "4.msh"].map(|name| Text::new(name, end));
    let [node, ele, v2, v4] = &mut texts;
    let triangles = triangles();
    let (n, m) = (points.len(), triangles.len());
    // Tags are three apart in version 2.2 of gmsh's format, and consecutive in version 4.1.
    let (apart, tag) = (|v: usize| 3 * (v + first), |v: usize| v + first);
    node.row(&format!("{n} 2"));
    ele.row(&format!("{m} 3"));
    for (text, version) in [(&mut *v2, "2.2"), (&mut *v4, "4.1")] {
        for line in ["$MeshFormat", &format!("{version} 0 8"), "$EndMeshFormat", "$Nodes"] {
            text.row(line);
        }
    }
    v2.row(&n.to_string());
    v4.row(&format!("1 {n} 1 {n}"));
    v4.row(&format!("2 1 0 {n}"));
    for v in 0..n {
        v4.row(&tag(v).to_string());
    }
    for (v, [x, y]) in points.iter().enumerate() {
        let rows = [
            (&mut *node, format!("{} {x:?}\t{y:?} 9 # {v}", v + first)),
            (&mut *v2, format!("{} {x:?} {y:?} 0", apart(v))),
            (&mut *v4, format!("{x:?} {y:?} 0")),
        ];
        for (text, row) in rows {
            let line = text.row(&row);
            text.vertex_lines.push(line);
        }
    }
    for text in [&mut *v2, &mut *v4] {
        text.row("$EndNodes");
        text.row("$Elements");
    }
    v2.row(&m.to_string());
    v4.row(&format!("1 {m} 1 {m}"));
    v4.row(&format!("2 1 2 {m}"));
    for (t, corners) in triangles.iter().enumerate() {
        let of = |name: &dyn Fn(usize) -> usize| {
            corners.iter().fold(String::new(), |mut text, &v| {
                write!(text, " {}", name(v as usize)).unwrap();
                text
            })
        };
        let rows = [
            (&mut *ele, format!("  {}{} # {}", t + 1, of(&tag), t / 10_000)),
            (&mut *v2, format!("{} 2 2 1 1{}", t + 1, of(&apart))),
            (&mut *v4, format!("{}{} ", t + 1, of(&tag))),
        ];
        for (text, row) in rows {
            let line = text.row(&row);
            text.triangle_lines.push(line);
        }
    }
    v2.row("$EndElements");
    v4.row("$EndElements");
    texts
}

fn folder(texts: &[Text]) -> Folder {
    let files: Vec<_> = texts.iter().map(|text| (text.name, text.text.as_str())).collect();
    Folder::new(&files)
}

#[test]
fn long_lists_are_read_as_they_stand() {
    for (end, first, final_end) in [("\n", 1, true), ("\r\n", 0, false)] {
        let mut texts = texts(&points(), end, first);
        if !final_end {
            texts.iter_mut().for_each(|text| text.text.truncate(text.text.len() - end.len()));
        }
        let folder = folder(&texts);
        let [node, ele, v2, v4] = &texts;
        for (vertices, elements) in [(node, ele), (v2, v2), (v4, v4)] {
            let name = vertices.name;
            let file = folder.read(name);
            assert!(file.points() == points(), "{name}");
            assert!(file.triangles() == triangles(), "{name}");
            for v in [0, 17, 20_000, SIDE * SIDE - 1] {
                let line = Location::Line(vertices.vertex_lines[v]);
                assert_eq!(file.vertex_location(v as u32).location, line, "{name}");
            }
            for t in [0, 33, 50_000] {
                let line = Location::Line(elements.triangle_lines[t]);
                assert_eq!(file.triangle_location(t).location, line, "{name}");
            }
        }
    }
}

#[test]
fn long_lists_come_back_but_for_what_moved() {
    let mut moved = points();
    for (v, [x, y]) in moved.iter_mut().enumerate() {
        match v % 5 {
            0 => *x += 0.123_456_789,
            1 => *y = -*y / 3.0,
            _ => {}
        }
    }
    let before = texts(&points(), "\r\n", 1);
    let after = texts(&moved, "\r\n", 1);
    let folder = folder(&before);
    for name in ["m.node", "2.msh", "4.msh"] {
        let file = folder.read(name);
        file.write(&folder.path(name), &moved).unwrap();
    }
    for text in &after {
        assert!(folder.text(text.name) == text.text, "{}", text.name);
    }
}

#[test]
fn errors_in_long_lists_name_their_line() {
    let texts = texts(&points(), "\n", 1);
    let folder = folder(&texts);
    let [node, ele, v2, v4] = &texts;
    let check = |text: &Text, line: usize, by: Option<&str>, told: usize, problem: &str| {
        std::fs::write(folder.path(text.name), text.with(line, by)).unwrap();
        let error = MeshFile::read(&folder.path(text.name)).unwrap_err().to_string();
        let wanted = format!("{}:{told}: {problem}", text.name);
        assert!(error.contains(&wanted), "no {wanted:?} in {error:?}");
        std::fs::write(folder.path(text.name), &text.text).unwrap();
    };
    for at in [3, 18_000, SIDE * SIDE - 1] {
        let line = node.vertex_lines[at];
        let number = at + 1;
        check(
            node,
            line,
            Some(&format!("{number} 1 y")),
            line,
            &format!("y of vertex {number} is `y`"),
        );
        check(node, line, Some("7777777 1 1"), line, "vertex 7777777 stands where");
        check(
            node,
            line,
            Some(&format!("{number} 1")),
            line,
            &format!("y of vertex {number} is missing"),
        );
        let line = ele.triangle_lines[at];
        check(ele, line, Some("5 1 2 2"), line, "triangle 5 lists vertex 2 twice");
        check(
            ele,
            line,
            Some("5 1 2 99999"),
            line,
            "triangle 5 has vertex 99999, but m.node has vertices 1 to 32400",
        );
        for text in [v2, v4] {
            let line = text.vertex_lines[at];
            check(
                text,
                line,
                Some("$EndNodes"),
                line,
                &format!("the section ends after {at} of 32400 nodes"),
            );
            let line = text.triangle_lines[at];
            check(
                text,
                line,
                Some("$EndElements"),
                line,
                &format!("the section ends after {at} of 64082 elements"),
            );
        }
        let line = v2.vertex_lines[at];
        check(v2, line, Some("9 1 nan 0"), line, "y of node 9 is `nan`");
        check(v2, line, Some("6 1 1"), line, "z of node 6 is missing");
        let line = v2.triangle_lines[at];
        check(
            v2,
            line,
            Some("5 2 2 1 1 3 6 7"),
            line,
            "triangle 5 has node 7, which $Nodes does not list",
        );
        check(v2, line, Some("5 9 2 1 1 3 6 9"), line, "element type 9 is of higher order");
        let line = v4.vertex_lines[at];
        check(v4, line, Some("1 1"), line, &format!("z of node {} is missing", at + 1));
        let line = v4.triangle_lines[at];
        check(v4, line, Some("5 3 6 6"), line, "triangle 5 lists node 6 twice");
    }
    // One row is removed, so the header announces one row too many.
    let line = node.vertex_lines[20_000];
    // The next row moves up by one line.
    let next = node.vertex_lines[20_001] - 1;
    check(node, line, None, next, "vertex 20002 stands where vertex 20001 should");
    let last_row = node.vertex_lines[SIDE * SIDE - 1];
    check(node, last_row, None, node.lines - 1, "the file ends after 32399 of 32400 vertices");
    let last_row = ele.triangle_lines[64_081];
    check(ele, last_row, None, ele.lines - 1, "the file ends after 64081 of 64082 triangles");
}

/// Returns the mesh in formats that consist of plain lists, with two regions, and with references of vertices where a
/// format has them.
fn plain_texts() -> Vec<(&'static str, String)> {
    let (points, triangles) = (points(), triangles());
    let (n, m) = (points.len(), triangles.len());
    let rows = |row: &dyn Fn(usize, [f64; 2]) -> String| {
        points.iter().enumerate().map(|(v, &at)| row(v, at)).collect::<String>()
    };
    let cells = |first: u32, row: &dyn Fn(usize, [u32; 3]) -> String| {
        let numbered = triangles.iter().map(|t| t.map(|v| v + first));
        numbered.enumerate().map(|(t, corners)| row(t, corners)).collect::<String>()
    };
    let xyz = rows(&|_, [x, y]| format!("{x:?} {y:?} 0\n"));
    let numbered = rows(&|v, [x, y]| format!("{} {x:?} {y:?} 0\n", v + 1));
    let of = |t: usize| 1 + 2 * usize::from(t >= 20_000);
    let referred = cells(1, &|t, [a, b, c]| format!("{a} {b} {c} {}\n", of(t)));
    let regions: String = (0..m).map(|t| format!("{}\n", of(t))).collect();
    vec![
        (
            "in.vtk",
            format!(
                "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS {n} double\n{xyz}"
            ) + &format!("POLYGONS {m} {}\n", 4 * m)
                + &cells(0, &|_, [a, b, c]| format!("3 {a} {b} {c}\n"))
                + &format!("CELL_DATA {m}\nSCALARS region int\nLOOKUP_TABLE default\n{regions}"),
        ),
        (
            "in.mesh",
            format!("MeshVersionFormatted 2\nDimension 3\nVertices\n{n}\n")
                + &rows(&|_, [x, y]| format!("{x:?} {y:?} 0 0\n"))
                + &format!("Triangles\n{m}\n{referred}End\n"),
        ),
        ("in.msh", format!("{n} {m} 0\n{}{referred}", xyz)),
        (
            "in.2dm",
            "MESH2D\n".to_owned()
                + &cells(1, &|t, [a, b, c]| format!("E3T {} {a} {b} {c} {}\n", t + 1, of(t)))
                + &rows(&|v, [x, y]| format!("ND {} {x:?} {y:?} 0\n", v + 1)),
        ),
        (
            "in.obj",
            rows(&|_, [x, y]| format!("v {x:?} {y:?} 0\n"))
                + &cells(1, &|t, [a, b, c]| match t {
                    0 | 20_000 => format!("usemtl {}\nf {a} {b} {c}\n", of(t)),
                    _ => format!("f {a} {b} {c}\n"),
                }),
        ),
        (
            "in.inp",
            "*NODE\n".to_owned()
                + &rows(&|v, [x, y]| format!("{}, {x:?}, {y:?}\n", v + 1))
                + &cells(1, &|t, [a, b, c]| match t {
                    0 | 20_000 => {
                        format!("*ELEMENT, TYPE=CPS3, ELSET={}\n{}, {a}, {b}, {c}\n", of(t), t + 1)
                    }
                    _ => format!("{}, {a}, {b}, {c}\n", t + 1),
                }),
        ),
        (
            "in.bdf",
            cells(1, &|t, [a, b, c]| format!("CTRIA3,{},{},{a},{b},{c}\n", t + 1, of(t)))
                + &rows(&|v, [x, y]| format!("GRID,{},,{x:?},{y:?},0.\n", v + 1)),
        ),
        (
            "in.su2",
            format!("NDIME= 2\nNELEM= {m}\n")
                + &cells(0, &|_, [a, b, c]| format!("5 {a} {b} {c}\n"))
                + &format!("NPOIN= {n}\n{}NMARK= 0\n", rows(&|_, [x, y]| format!("{x:?} {y:?}\n"))),
        ),
        (
            "in.off",
            format!("OFF\n{n} {m} 0\n{xyz}")
                + &cells(0, &|_, [a, b, c]| format!("3 {a} {b} {c}\n")),
        ),
        (
            "fort.14",
            format!("t\n{m} {n}\n{numbered}")
                + &cells(1, &|t, [a, b, c]| format!("{} 3 {a} {b} {c}\n", t + 1)),
        ),
    ]
}

#[test]
fn a_vtk_file_of_many_points_is_read_to_the_last_one() {
    let regions: Vec<u32> = (0..triangles().len()).map(|t| u32::from(t >= 20_000)).collect();
    for (name, text) in plain_texts() {
        let folder = Folder::new(&[(name, &text)]);
        let file = folder.read(name);
        let stored = |at: [f64; 2]| at.map(|x| file.precision().rounded(x));
        let points: Vec<_> = points().into_iter().map(stored).collect();
        assert!(file.points() == points && file.triangles() == triangles(), "{name}");
        let groups = file.groups().unwrap();
        if ["in.su2", "in.off", "fort.14"].contains(&name) {
            assert!(file.regions().is_none() && groups.is_empty(), "{name}");
            continue;
        }
        assert!(file.regions() == Some(&regions), "{name}");
        let second = groups.find("3").unwrap().triangles();
        assert!(second.iter().copied().eq(20_000..regions.len() as u32), "{name}");
        assert!(groups.find("1").unwrap().triangles().iter().copied().eq(0..20_000), "{name}");
    }
}
