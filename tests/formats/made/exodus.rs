//! Makes Exodus II files in the three classic forms of netCDF.

use super::super::support::Binary;
use super::binary::size_of;
use super::{LINE, Made, PROBED, QUADRILATERAL, SECOND_REGION, fixing, regions, z};
use gpu_smooth::{Format, Mesh, Precision};
use std::ops::Range;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let of = |version: u8, precision, axes| exodus(mesh, version, precision, axes);
    vec![
        of(1, Precision::Double, Axes::Apart),
        of(1, Precision::Single, Axes::Together),
        of(2, Precision::Double, Axes::Apart),
        of(5, Precision::Double, Axes::Together),
    ]
}

/// Whether x, y and z are separate variables, or one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axes {
    Apart,
    Together,
}

const DIMENSIONS: [&str; 14] = [
    "len_name",
    "time_step",
    "num_dim",
    "num_nodes",
    "num_elem",
    "num_el_in_blk1",
    "num_el_in_blk3",
    "three",
    "four",
    "two",
    "num_side_ss1",
    "num_nod_ns1",
    "one",
    "num_el_blk",
];

/// A variable: its name, type, dimensions and content. The content is that of one record if it depends on time.
struct Variable {
    name: String,
    number: i32,
    dimensions: Vec<&'static str>,
    content: Vec<u8>,
    element_type: &'static str,
}

/// A file under construction. `version` tells whether counts and offsets have 64 bits.
struct NetCdf {
    out: Binary,
    version: u8,
    variables: Vec<Variable>,
}

impl NetCdf {
    fn count(&mut self, number: u64) {
        match self.version {
            5 => self.out.sizes(&[number]),
            _ => self.out.ints(&[number as i32]),
        }
    }

    fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.out.text(text);
        pad(&mut self.out.bytes);
    }

    fn add(&mut self, name: &str, number: i32, dimensions: &[&'static str], content: Vec<u8>) {
        let (name, dimensions) = (name.to_owned(), dimensions.to_vec());
        self.variables.push(Variable { name, number, dimensions, content, element_type: "" });
    }

    fn ints(&mut self, name: &str, dimensions: &[&'static str], numbers: &[i32]) {
        let mut content = Binary::empty(true);
        content.ints(numbers);
        self.add(name, 4, dimensions, content.bytes);
    }

    fn reals(&mut self, name: &str, precision: Precision, dims: &[&'static str], x: &[f64]) {
        let mut content = Binary::empty(true);
        content.reals(precision, x);
        self.add(name, if precision == Precision::Single { 5 } else { 6 }, dims, content.bytes);
    }

    fn names(&mut self, name: &str, dimensions: &[&'static str], texts: &[&str]) {
        let content = texts.iter().flat_map(|text| {
            let mut row = text.as_bytes().to_vec();
            row.resize(16, 0);
            row
        });
        self.add(name, 2, dimensions, content.collect());
    }

    fn connect(&mut self, block: usize, of: &[&'static str; 3], elements: &[Vec<u32>]) {
        let numbers: Vec<i32> = elements.iter().flatten().map(|&v| v as i32 + 1).collect();
        self.ints(&format!("connect{block}"), &of[1..], &numbers);
        self.variables.last_mut().unwrap().element_type = of[0];
    }
}

fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

fn exodus(mesh: &Mesh, version: u8, precision: Precision, axes: Axes) -> Made {
    let (n, m) = (mesh.points.len(), mesh.triangles.len());
    let variables = Vec::new();
    let mut file = NetCdf { out: Binary::empty(true), version, variables };
    let lengths = [16, 0, 3, n, m + 2, SECOND_REGION, m - SECOND_REGION, 3, 4, 2, 2, 3, 1, 4];
    file.ints("eb_prop1", &["num_el_blk"], &[5, 7, 2, 9]);
    file.names("eb_names", &["num_el_blk", "len_name"], &["steel", "", "", "wire"]);
    let axis = |axis: usize| mesh.points.iter().map(|p| p[axis]).collect::<Vec<_>>();
    let heights: Vec<f64> = (0..n).map(z).collect();
    let coordinates = [axis(0), axis(1), heights];
    match axes {
        Axes::Apart => {
            for (name, numbers) in ["coordx", "coordy", "coordz"].iter().zip(&coordinates) {
                file.reals(name, precision, &["num_nodes"], numbers);
            }
        }
        Axes::Together => {
            file.reals("coord", precision, &["num_dim", "num_nodes"], &coordinates.concat());
        }
    }
    let corners: Vec<Vec<u32>> = mesh.triangles.iter().map(|t| t.to_vec()).collect();
    let [first, second] = [&corners[..SECOND_REGION], &corners[SECOND_REGION..]];
    file.connect(1, &["TRI3", "num_el_in_blk1", "three"], first);
    // Elements are numbered in the order of the blocks, whatever the order of the variables.
    file.connect(3, &["tri", "num_el_in_blk3", "three"], second);
    file.connect(2, &["SHELL4\0", "one", "four"], &[QUADRILATERAL.to_vec()]);
    file.connect(4, &["BAR2", "one", "two"], &[LINE.to_vec()]);
    // The side of the first triangle between its first two vertices; of the shell its first edge and a face.
    let shell = SECOND_REGION as i32 + 1;
    file.ints("ss_prop1", &["one"], &[40]);
    file.names("ss_names", &["one", "len_name"], &["shore"]);
    file.ints("elem_ss1", &["num_side_ss1"], &[1, shell]);
    file.ints("side_ss1", &["num_side_ss1"], &[1, 3]);
    file.ints("node_ns1", &["num_nod_ns1"], &[1, 13, 15]);
    file.names("name_nod_var", &["two", "len_name"], &["T", "p"]);
    file.ints("elem_num_map", &["one"], &[1]);
    for variable in 1..=2 {
        let numbers: Vec<f64> = (0..n).map(|i| (i * variable) as f64 * 0.5).collect();
        let name = format!("vals_nod_var{variable}");
        file.reals(&name, precision, &["time_step", "num_nodes"], &numbers);
    }
    build(file, &lengths, mesh, precision)
}

/// The file of these variables, in two time steps.
fn build(mut file: NetCdf, lengths: &[usize; 14], mesh: &Mesh, precision: Precision) -> Made {
    const STEPS: usize = 2;
    let variables = std::mem::take(&mut file.variables);
    file.out.text("CDF");
    file.out.bytes.push(file.version);
    file.count(STEPS as u64);
    file.out.ints(&[10]);
    file.count(DIMENSIONS.len() as u64);
    let mut counts = Vec::new();
    for (name, &length) in DIMENSIONS.iter().zip(lengths) {
        file.text(name);
        let start = file.out.bytes.len();
        file.count(length as u64);
        if ["num_nodes", "num_el_in_blk1", "num_side_ss1"].contains(name) {
            counts.push(start..file.out.bytes.len());
        }
    }
    file.out.ints(&[12]);
    file.count(1);
    file.text("title");
    file.out.ints(&[2]);
    file.text("a bay of 3 islands");
    file.out.ints(&[11]);
    file.count(variables.len() as u64);
    let mut begins = Vec::new();
    for variable in &variables {
        file.text(&variable.name);
        file.count(variable.dimensions.len() as u64);
        for dimension in &variable.dimensions {
            file.count(DIMENSIONS.iter().position(|own| own == dimension).unwrap() as u64);
        }
        match variable.element_type {
            "" => {
                file.out.ints(&[0]);
                file.count(0);
            }
            name => {
                file.out.ints(&[12]);
                file.count(1);
                file.text("elem_type");
                file.out.ints(&[2]);
                file.text(name);
            }
        }
        file.out.ints(&[variable.number]);
        file.count(variable.content.len() as u64);
        begins.push(file.out.bytes.len());
        file.out.bytes.resize(file.out.bytes.len() + if file.version == 1 { 4 } else { 8 }, 0);
    }
    let is_record = |variable: &Variable| variable.dimensions.first() == Some(&"time_step");
    let mut places = Vec::new();
    for step in 0..=STEPS {
        for (variable, &begin) in variables.iter().zip(&begins) {
            if is_record(variable) != (step > 0) {
                continue;
            }
            let start = file.out.bytes.len();
            if step < 2 {
                let bytes = &mut file.out.bytes;
                match file.version {
                    1 => bytes[begin..begin + 4].copy_from_slice(&(start as u32).to_be_bytes()),
                    _ => bytes[begin..begin + 8].copy_from_slice(&(start as u64).to_be_bytes()),
                }
            }
            file.out.bytes.extend_from_slice(&variable.content);
            places.push((variable.name.as_str(), start..file.out.bytes.len()));
            pad(&mut file.out.bytes);
        }
    }
    let at =
        |name: &str| places.iter().find(|(own, _)| *own == name).map(|(_, range)| range.clone());
    let (size, n) = (size_of(precision), mesh.points.len());
    let x = at("coordx").or(at("coord")).unwrap().start;
    let y = at("coordy").map_or(x + n * size, |y| y.start);
    let block = at("connect1").unwrap();
    let lists: Vec<Range<usize>> = places.iter().map(|(_, range)| range.clone()).collect();
    let [a, b, _] = mesh.triangles[0];
    let shell = [QUADRILATERAL[0], QUADRILATERAL[1]];
    let fixed = QUADRILATERAL.into_iter().chain(LINE).chain([a, b]).chain(shell);
    Made {
        what: format!("Exodus II, version {} of netCDF, {precision:?}", file.version),
        name: "in.exo",
        format: Format::Exodus,
        precision,
        mesh: fixing(mesh, fixed),
        regions: regions(mesh),
        vertex: (u64::from(PROBED.0) + 1, x..y + n * size),
        triangle: (PROBED.1 as u64 + 1, block),
        lists,
        counts,
        coordinates: (0..n).map(|i| [x + i * size, y + i * size]).collect(),
        big: true,
        bytes: file.out.bytes,
    }
}
