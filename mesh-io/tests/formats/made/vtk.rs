//! Makes legacy VTK files, in text and in binary, with cell lists in the old and the new layout.

use super::binary::size_of;
use super::{LINE, Made, POINT, PROBED, QUADRILATERAL, cells, fixing, number, region, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use std::ops::Range;
use support::Binary;
use support::Mesh;

/// A polyline of three vertices on the boundary.
const POLYLINE: [u32; 3] = [2, 3, 4];

/// Properties in which the sample files differ.
#[derive(Clone, Copy)]
struct Style {
    version: &'static str,
    binary: bool,
    precision: Precision,
    /// Whether the file has polygonal data instead of an unstructured grid.
    polygons: bool,
    /// Type of the integers in cell lists with separate offsets and points; `None` for the old layout.
    offsets: Option<&'static str>,
}

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let mut all = Vec::new();
    for binary in [false, true] {
        for (version, precision, polygons, offsets) in [
            ("2.0", Precision::Single, false, None),
            ("3.0", Precision::Double, false, None),
            ("4.2", Precision::Double, true, None),
            ("1.0", Precision::Single, true, None),
            ("5.1", Precision::Double, false, Some("vtktypeint64")),
            ("5.1", Precision::Single, true, Some("vtktypeint64")),
            ("5.0", Precision::Single, false, Some("vtktypeint32")),
        ] {
            all.push(made(mesh, Style { version, binary, precision, polygons, offsets }));
        }
    }
    all
}

/// Builder of a file in text or in binary.
struct Writer {
    file: Binary,
    style: Style,
    lists: Vec<Range<usize>>,
    counts: Vec<Range<usize>>,
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.file.text(text);
    }

    fn count(&mut self, before: &str, count: usize, after: &str) {
        self.text(before);
        let start = self.file.bytes.len();
        self.text(&count.to_string());
        self.counts.push(start..self.file.bytes.len());
        self.text(after);
    }

    /// Adds integers; in binary, each has `size` bytes.
    fn numbers(&mut self, numbers: &[i64], size: usize) {
        for &n in numbers {
            match (self.style.binary, size) {
                (false, _) => self.file.text(&format!("{n} ")),
                (true, 4) => self.file.ints(&[n as i32]),
                (true, _) => self.file.sizes(&[n.cast_unsigned()]),
            }
        }
    }

    fn reals(&mut self, precision: Precision, numbers: &[f64]) {
        match self.style.binary {
            false => numbers.iter().for_each(|x| self.file.text(&format!("{x} "))),
            true => self.file.reals(precision, numbers),
        }
    }

    /// Adds the regions of cells as an attribute or in a field.
    fn regions(&mut self, cells: &[Vec<u32>]) {
        let mut triangle = 0;
        let names: Vec<_> = cells
            .iter()
            .map(|cell| {
                let name = region(triangle);
                triangle += usize::from(cell.len() == 3 && *cell != POLYLINE);
                i64::from(name) - 4
            })
            .collect();
        let n = cells.len();
        let described = "METADATA\nCOMPONENT_NAMES\nseas\n\n";
        self.text(&format!("CELL_DATA {n}\nSCALARS quality double\nLOOKUP_TABLE default\n"));
        self.reals(Precision::Double, &vec![0.25; n]);
        if self.style.offsets.is_some() {
            self.text(&format!(
                "\n{described}FIELD FieldData 1\ngmsh:physical 1 {n} vtktypeint64\n"
            ));
            self.numbers(&names, 8);
            self.text(&format!("\n{described}"));
        } else {
            self.text("\nSCALARS MaterialIds int 1\nLOOKUP_TABLE default\n");
            self.numbers(&names, 4);
            self.text("\n");
        }
    }

    /// Adds rows of integers; in binary, each integer has `size` bytes. Returns the offset of each row.
    fn integers(&mut self, rows: &[Vec<usize>], size: usize) -> Vec<usize> {
        let mut starts = Vec::new();
        for row in rows {
            starts.push(self.file.bytes.len());
            let row: Vec<_> = row.iter().map(|&n| n as i64).collect();
            self.numbers(&row, size);
            if !self.style.binary {
                self.text("\n");
            }
        }
        self.end_list(starts[0], starts[starts.len() - 1]);
        starts
    }

    /// Ends a list. In text, the recorded range ends within the last row, as text that is cut off in this row may be
    /// readable.
    fn end_list(&mut self, start: usize, last_row: usize) {
        let end = if self.style.binary { self.file.bytes.len() } else { last_row + 1 };
        self.lists.push(start..end);
        self.text("\n");
    }

    /// Adds the points. Returns the offset of each point. Text of single precision has three points per line.
    fn points(&mut self, mesh: &Mesh) -> Vec<usize> {
        let precision = self.style.precision;
        let name = if precision == Precision::Single { "float" } else { "double" };
        self.count("POINTS ", mesh.points.len(), &format!(" {name}\n"));
        let mut starts = Vec::new();
        for (i, &[x, y]) in mesh.points.iter().enumerate() {
            starts.push(self.file.bytes.len());
            if self.style.binary {
                self.file.reals(precision, &[x, y, z(i)]);
                continue;
            }
            let last = precision == Precision::Double || i % 3 == 2;
            let end = if last { " \n" } else { "  " };
            let (x, y) = (number(i, x), number(i / 3, y));
            self.text(&format!("{x} {y}\t{}{end}", z(i)));
        }
        self.end_list(starts[0], starts[starts.len() - 1]);
        starts
    }

    /// Adds a list of cells. Returns the byte range of each cell; with separate offsets, the byte range of all points.
    fn cells(&mut self, keyword: &str, cells: &[Vec<u32>]) -> Vec<Range<usize>> {
        let points: Vec<Vec<usize>> =
            cells.iter().map(|cell| cell.iter().map(|&v| v as usize).collect()).collect();
        let all: usize = points.iter().map(Vec::len).sum();
        let Some(kind) = self.style.offsets else {
            self.count(&format!("{keyword} "), cells.len(), " ");
            self.count("", all + cells.len(), "\n");
            let with_count = |cell: &Vec<usize>| [vec![cell.len()], cell.clone()].concat();
            let rows: Vec<_> = points.iter().map(with_count).collect();
            let starts = self.integers(&rows, 4);
            return starts.into_iter().map(|start| start..start + 1).collect();
        };
        let size = if kind == "vtktypeint64" { 8 } else { 4 };
        self.count(&format!("{keyword} "), cells.len() + 1, " ");
        self.count("", all, "\n");
        self.text(&format!("OFFSETS {kind}\n"));
        let mut offsets = vec![0];
        points.iter().for_each(|cell| offsets.push(offsets[offsets.len() - 1] + cell.len()));
        let rows: Vec<_> = offsets.chunks(9).map(<[usize]>::to_vec).collect();
        self.integers(&rows, size);
        self.text(&format!("CONNECTIVITY {kind}\n"));
        let rows: Vec<_> = points.concat().chunks(9).map(<[usize]>::to_vec).collect();
        let start = self.integers(&rows, size)[0];
        vec![start..self.file.bytes.len(); cells.len()]
    }
}

fn made(mesh: &Mesh, style: Style) -> Made {
    let Style { version, binary, precision, polygons, offsets } = style;
    let file = Binary::empty(true);
    let mut out = Writer { file, style, lists: Vec::new(), counts: Vec::new() };
    let encoding = if binary { "BINARY" } else { "ASCII" };
    let kind = if polygons { "POLYDATA" } else { "UNSTRUCTURED_GRID" };
    out.text(&format!("# vtk DataFile Version {version}\n# POINTS of 2 bays\n{encoding}\n"));
    out.text(&format!("DATASET {kind}\n"));
    if offsets.is_some() {
        out.text("FIELD FieldData 2\nTIME 1 1 double\n");
        out.reals(Precision::Double, &[0.5]);
        out.text("\nCYCLE 2 1 int\n");
        out.numbers(&[7, 8], 4);
        out.text("\n");
    }
    let vertices = out.points(mesh);
    let listed = out.lists[0].clone();
    if offsets.is_some() {
        out.text(
            "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 9\n\n",
        );
    }
    let mut all = cells(mesh);
    let (index, places) = if polygons {
        out.cells("VERTICES", &[vec![POINT]]);
        out.cells("LINES", &[LINE.to_vec(), POLYLINE.to_vec()]);
        (3 + PROBED.1 + 1, [Vec::from([0..0, 0..0, 0..0]), out.cells("POLYGONS", &all)].concat())
    } else {
        all.insert(2, LINE.to_vec());
        all.extend([vec![POINT], POLYLINE.to_vec()]);
        let places = out.cells("CELLS", &all);
        out.count("CELL_TYPES ", all.len(), "\n");
        let type_of = |cell: &Vec<u32>| match cell.len() {
            1 => 1,
            2 => 3,
            3 if *cell == POLYLINE => 4,
            3 => 5,
            _ => 9,
        };
        let types: Vec<usize> = all.iter().map(type_of).collect();
        let rows: Vec<_> = types.chunks(if version == "2.0" { 7 } else { 1 }).collect();
        out.integers(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>(), 4);
        (PROBED.1 + 2, places)
    };
    let is_double_grid = !polygons && precision == Precision::Double;
    if is_double_grid {
        out.regions(&all);
    }
    out.text(&format!("\nPOINT_DATA {}\nSCALARS region float\n", vertices.len()));
    out.text("LOOKUP_TABLE default\n");
    let depths: Vec<_> = (0..vertices.len()).map(z).collect();
    out.reals(Precision::Single, &depths);
    out.text("\n");

    let [first, second] = [vertices[PROBED.0 as usize], vertices[PROBED.0 as usize + 1]];
    let size = size_of(precision);
    Made {
        what: format!("{encoding} {kind} {version} {precision:?} {offsets:?}"),
        name: "in.vtk",
        format: if binary { Format::VtkBinary } else { Format::Vtk },
        precision,
        mesh: fixing(mesh, [POINT].into_iter().chain(LINE).chain(POLYLINE).chain(QUADRILATERAL)),
        regions: if is_double_grid { regions(mesh) } else { None },
        vertex: (u64::from(PROBED.0), if binary { listed } else { first..second }),
        triangle: (index as u64, places[index].clone()),
        coordinates: match binary {
            true => vertices.iter().map(|&x| [x, x + size]).collect(),
            false => Vec::new(),
        },
        bytes: out.file.bytes,
        lists: out.lists,
        counts: out.counts,
        big: true,
    }
}
