//! Makes files of binary formats, except VTK and PLY.

use super::{LINE, Made, POINT, PROBED, QUADRILATERAL, fixing, region, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use std::ops::Range;
use support::Binary;
use support::Mesh;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let mut all = Vec::new();
    for big in [false, true] {
        all.extend((1..=4).map(|version| meshb(mesh, version, big)));
        for precision in [Precision::Single, Precision::Double] {
            all.push(selafin(mesh, precision, big, 1));
        }
    }
    all
}

/// Returns the size of a coordinate in bytes.
pub(crate) fn size_of(precision: Precision) -> usize {
    if precision == Precision::Single { 4 } else { 8 }
}

/// Builder of a `.meshb` file.
struct Meshb {
    file: Binary,
    version: i32,
    lists: Vec<Range<usize>>,
    counts: Vec<Range<usize>>,
}

impl Meshb {
    /// Adds integers in the width of the file's version: 8 bytes in version 4, else 4.
    fn integers(&self, body: &mut Binary, numbers: impl IntoIterator<Item = i64>) {
        for n in numbers {
            match self.version {
                4 => body.sizes(&[n.cast_unsigned()]),
                _ => body.ints(&[n as i32]),
            }
        }
    }

    /// Adds a keyword, the offset of the next keyword, and `body`. Returns the offset of `body`.
    fn chain(&mut self, keyword: i32, body: &[u8]) -> usize {
        self.file.ints(&[keyword]);
        let start = self.file.bytes.len() + if self.version < 3 { 4 } else { 8 };
        let next = if keyword == 54 { 0 } else { start + body.len() };
        match self.version {
            1 | 2 => self.file.ints(&[next as i32]),
            _ => self.file.sizes(&[next as u64]),
        }
        self.file.bytes.extend_from_slice(body);
        start
    }

    /// Adds the length of a list and its items. Returns the offset of the first item.
    fn list(&mut self, keyword: i32, count: usize, items: &[u8]) -> usize {
        let mut body = Binary::empty(self.file.big);
        self.integers(&mut body, [count as i64]);
        let width = body.bytes.len();
        body.bytes.extend_from_slice(items);
        let start = self.chain(keyword, &body.bytes);
        self.counts.push(start..start + width);
        self.lists.push(start..self.file.bytes.len());
        start + width
    }

    /// Adds a list of elements, whose vertices are numbered from 1.
    fn elements(&mut self, keyword: i32, elements: &[(&[u32], Option<i32>)]) -> Range<usize> {
        let mut items = Binary::empty(self.file.big);
        for (vertices, reference) in elements {
            let vertices = vertices.iter().map(|v| i64::from(*v) + 1);
            self.integers(&mut items, vertices.chain(reference.map(i64::from)));
        }
        let start = self.list(keyword, elements.len(), &items.bytes);
        start..self.file.bytes.len()
    }
}

fn meshb(mesh: &Mesh, version: i32, big: bool) -> Made {
    let precision = if version == 1 { Precision::Single } else { Precision::Double };
    // Every other version has a third coordinate.
    let dimension = 3 - version % 2;
    let file = Binary::empty(big);
    let mut out = Meshb { file, version, lists: Vec::new(), counts: Vec::new() };
    out.file.ints(&[1, version]);
    let mut body = Binary::empty(big);
    body.ints(&[dimension]);
    out.chain(3, &body.bytes);
    out.elements(15, &[(&[POINT], None)]);
    let triangles: Vec<_> =
        mesh.triangles.iter().enumerate().map(|(t, c)| (&c[..], Some(region(t)))).collect();
    let listed = out.elements(6, &triangles);
    out.chain(60, b"\n# of no use \0\xFF");

    let mut items = Binary::empty(big);
    let mut places = Vec::new();
    for (i, &[x, y]) in mesh.points.iter().enumerate() {
        places.push(items.bytes.len());
        items.reals(precision, &[x, y]);
        if dimension == 3 {
            items.reals(precision, &[z(i)]);
        }
        out.integers(&mut items, [-(i as i64)]);
    }
    let first = out.list(4, mesh.points.len(), &items.bytes);
    let points = first..out.file.bytes.len();
    out.elements(5, &[(&LINE, Some(3)), (&[0, 1], Some(-3))]);
    out.elements(7, &[(&QUADRILATERAL, Some(1))]);
    let mut none = Binary::empty(big);
    out.integers(&mut none, [0]);
    out.chain(8, &none.bytes);
    out.chain(54, &[]);
    Made {
        what: format!("version {version} of Medit's binary format, big-endian: {big}"),
        name: "in.meshb",
        format: Format::MeditBinary,
        precision,
        bytes: out.file.bytes,
        mesh: fixing(mesh, [0, 1, POINT].into_iter().chain(LINE).chain(QUADRILATERAL)),
        regions: regions(mesh),
        vertex: (u64::from(PROBED.0) + 1, points),
        triangle: (PROBED.1 as u64 + 1, listed),
        lists: out.lists,
        counts: out.counts,
        coordinates: places
            .iter()
            .map(|at| first + at)
            .map(|x| [x, x + size_of(precision)])
            .collect(),
        big,
    }
}

/// Adds a Fortran record. Returns the offset of its content.
fn record(file: &mut Binary, content: &[u8]) -> usize {
    file.ints(&[content.len() as i32]);
    let start = file.bytes.len();
    file.bytes.extend_from_slice(content);
    file.ints(&[content.len() as i32]);
    start
}

/// Makes a SELAFIN file with two variables, one time step, and `planes` planes. Files of double precision have a date.
pub(crate) fn selafin(mesh: &Mesh, precision: Precision, big: bool, planes: i32) -> Made {
    let double = precision == Precision::Double;
    let (points, triangles) = (mesh.points.len(), mesh.triangles.len());
    let ints = |numbers: &[i32]| {
        let mut content = Binary::empty(big);
        content.ints(numbers);
        content.bytes
    };
    let reals = |numbers: &[f64]| {
        let mut content = Binary::empty(big);
        content.reals(precision, numbers);
        content.bytes
    };
    let mut file = Binary::empty(big);
    let title =
        format!("{:<72}{}", "Bay of 2 islands", if double { "SERAFIND" } else { "SERAFIN " });
    record(&mut file, title.as_bytes());
    record(&mut file, &ints(&[2, 0]));
    record(&mut file, format!("{:<16}{:<16}", "BOTTOM", "M").as_bytes());
    record(&mut file, format!("{:<16}{:<16}", "FREE SURFACE", "M").as_bytes());
    record(&mut file, &ints(&[1, 0, 0, 0, 0, 0, planes, 18, 0, i32::from(double)]));
    if double {
        record(&mut file, &ints(&[2024, 2, 29, 12, 0, 0]));
    }
    let sizes = record(&mut file, &ints(&[triangles as i32, points as i32, 3, 1]));
    let corners: Vec<_> = mesh.triangles.iter().flatten().map(|&v| v as i32 + 1).collect();
    let listed = record(&mut file, &ints(&corners));
    let listed = listed..listed + 4 * corners.len();
    let numbered: Vec<_> = (0..points as i32).map(|i| i % 7).collect();
    record(&mut file, &ints(&numbered));
    let axis = |axis: usize| mesh.points.iter().map(|p| p[axis]).collect::<Vec<_>>();
    let x_at = record(&mut file, &reals(&axis(0)));
    let y_at = record(&mut file, &reals(&axis(1)));
    let size = size_of(precision);
    let ends = [x_at, y_at].map(|start| start..start + size * points);
    record(&mut file, &reals(&[3600.0]));
    for variable in 0..2 {
        let values: Vec<_> = (0..points).map(|i| (i * variable) as f64 * 0.25).collect();
        record(&mut file, &reals(&values));
    }
    Made {
        what: format!("SELAFIN, {precision:?}, big-endian: {big}"),
        name: "in.slf",
        format: Format::Selafin,
        precision,
        bytes: file.bytes,
        mesh: mesh.clone(),
        regions: None,
        vertex: (u64::from(PROBED.0) + 1, ends[0].start..ends[1].end),
        triangle: (PROBED.1 as u64 + 1, listed.clone()),
        lists: [vec![listed], ends.to_vec()].concat(),
        counts: vec![sizes..sizes + 4, sizes + 4..sizes + 8],
        coordinates: (0..points).map(|i| [x_at + i * size, y_at + i * size]).collect(),
        big,
    }
}
