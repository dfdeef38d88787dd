//! Writer of MED 4.1: one mesh, with a family for each set of groups.

use crate::export::content::Content;
use crate::export::writer_input::WriterInput;
use crate::hdf5::write::{NewObject, Values};
use crate::visit::items::CellKind;
use std::collections::HashMap;

/// Name of the mesh.
const MESH: &str = "mesh";
/// Name of the only time step of the mesh: numbers of step and iteration, both -1.
const STEP: &str = "-0000000000000000001-0000000000000000001";
/// Length of a group name in bytes, padding included.
const NAME_LENGTH: usize = 80;

/// The types of elements, with their names and numbers in MED, in the order of the file.
const TYPES: [(CellKind, &str, i64); 4] = [
    (CellKind::Point, "PO1", 1),
    (CellKind::Line, "SE2", 102),
    (CellKind::Triangle, "TR3", 203),
    (CellKind::Quadrilateral, "QU4", 204),
];

/// The families of a mesh. A family lists the groups of its elements.
#[derive(Default)]
struct Families {
    places: HashMap<Vec<String>, usize>,
    /// The names of the groups of each family.
    names: Vec<Vec<String>>,
}

impl Families {
    /// Returns the number of the family of some groups, counted from 1; 0 for no groups.
    fn number(&mut self, mut names: Vec<String>) -> i64 {
        names.sort_unstable();
        names.dedup();
        if names.is_empty() {
            return 0;
        }
        let next = self.names.len();
        let place = *self.places.entry(names.clone()).or_insert(next);
        if place == next {
            self.names.push(names);
        }
        place as i64 + 1
    }

    /// Adds the families to a group of the file. `sign` is 1 for families of nodes, and -1 for families of elements.
    fn write(&self, sign: i64, out: &mut NewObject) {
        for (names, place) in self.names.iter().zip(1..) {
            let number = sign * place;
            let family = out.add(&format!("FAM_{number}"));
            family.attribute("NUM", Values::long(number));
            let groups = family.add("GRO");
            groups.attribute("NBR", Values::long(names.len() as i64));
            let names = names.iter().map(String::as_bytes);
            groups.dataset("NOM", Values::char_arrays(names, NAME_LENGTH));
        }
    }
}

/// Writes nodes, elements and groups.
pub(crate) fn write_med(input: &WriterInput<'_>) -> Vec<u8> {
    let content = input.content;
    let axes = if input.is_flat() { 2 } else { 3 };
    let mut file = NewObject::default();
    whole(file.group("INFOS_GENERALES"), &[("MAJ", 4), ("MIN", 1), ("REL", 0)]);
    let mesh = file.group("ENS_MAA").add(MESH);
    let numbers =
        [("DIM", 2), ("ESP", axes), ("REP", 0), ("SRT", 0), ("TYP", 0), ("NXI", -1), ("NXT", -1)];
    whole(mesh, &numbers);
    let title = format!("written by {}", input.creator);
    // Names and units of the axes have 16 bytes each, and all texts have a zero at the end.
    let width = 16 * axes as usize + 1;
    for (name, text, size) in
        [("DES", title.as_str(), 201), ("NOM", "", width), ("UNI", "", width), ("UNT", "", 17)]
    {
        mesh.attribute(name, Values::text(text.as_bytes(), size));
    }
    let step = mesh.add(STEP);
    let none = ["NDT", "NOR", "NXI", "NXT", "PVI", "PVT"].map(|name| (name, -1));
    whole(step, &[&[("CGT", 1)], &none[..]].concat());
    step.attribute("PDT", Values::reals([0.0]).scalar());

    let mut of_nodes = Families::default();
    let nodes = profiled(step.add("NOE"));
    let count = content.points.len();
    let coordinates = (0..axes as usize).flat_map(|axis| input.axis(axis));
    list(nodes, "COO", Values::reals(coordinates), count);
    list(nodes, "FAM", Values::longs(node_families(input, &mut of_nodes)), count);

    let mut of_elements = Families::default();
    let types = step.add("MAI");
    types.attribute("CGT", Values::long(1));
    for (kind, name, number) in TYPES {
        let cells: Vec<usize> = input.all(kind).collect();
        if cells.is_empty() {
            continue;
        }
        let elements = profiled(types.add(name));
        elements.attribute("GEO", Values::long(number));
        list(elements, "NOD", Values::longs(corners(content, kind, &cells)), cells.len());
        let families = cells.iter().map(|&cell| {
            let groups = input.stored_groups(cell).iter();
            of_elements.number(groups.map(|&group| input.name_or_number(group)).collect())
        });
        let families: Vec<i64> = families.map(|family| -family).collect();
        list(elements, "FAM", Values::longs(families), cells.len());
    }

    let families = file.group("FAS").add(MESH);
    families.add("FAMILLE_ZERO").attribute("NUM", Values::long(0));
    for (name, sign, own) in [("ELEME", -1, &of_elements), ("NOEUD", 1, &of_nodes)] {
        if !own.names.is_empty() {
            own.write(sign, families.add(name));
        }
    }
    file.file()
}

/// Adds attributes of whole numbers.
fn whole(object: &mut NewObject, numbers: &[(&str, i64)]) {
    for &(name, number) in numbers {
        object.attribute(name, Values::long(number));
    }
}

/// Adds the attributes of a list of all nodes or elements. A list of some nodes or elements would have a profile.
fn profiled(group: &mut NewObject) -> &mut NewObject {
    whole(group, &[("CGS", 1), ("CGT", 1)]);
    group.attribute("PFL", Values::text(b"MED_NO_PROFILE_INTERNAL", 65))
}

/// Adds a dataset with numbers of `count` nodes or elements.
fn list(group: &mut NewObject, name: &str, values: Values, count: usize) {
    whole(group.dataset(name, values), &[("CGT", 1), ("NBR", count as i64)]);
}

/// Returns the first corners of all cells, then the second corners, and so on.
fn corners(content: &Content, kind: CellKind, cells: &[usize]) -> Vec<i64> {
    let of = |corner: usize| {
        cells.iter().map(move |&cell| i64::from(content.cells.of(cell)[corner]) + 1)
    };
    (0..kind.nodes()).flat_map(of).collect()
}

fn node_families(input: &WriterInput<'_>, families: &mut Families) -> Vec<i64> {
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); input.content.points.len()];
    for (place, (_, vertices)) in input.content.vertex_groups.iter().enumerate() {
        vertices.iter().for_each(|&vertex| groups[vertex as usize].push(place));
    }
    let name = |place: usize| input.content.vertex_groups[place].0.name().unwrap_or_default();
    let number = |groups: Vec<usize>| {
        families.number(groups.into_iter().map(|place| name(place).to_owned()).collect())
    };
    groups.into_iter().map(number).collect()
}
