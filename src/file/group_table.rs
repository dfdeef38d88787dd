//! Gathers the groups of a file while it is walked through.

use crate::file::group::{Group, Groups};
use crate::file::label::Label;
use crate::file::sink::Kind;
use std::collections::HashMap;

/// The groups found so far, by number.
#[derive(Default)]
pub(crate) struct GroupTable {
    groups: Vec<Gathered>,
    numbers: HashMap<(String, u8, Label), usize>,
    /// The names of the groups of a tag, of one dimension or of all.
    names: HashMap<(String, Option<u8>, i64), String>,
}

struct Gathered {
    group: Group,
    /// Vertices of elements that are no triangles, in any order, with repeats.
    others: Vec<u32>,
}

impl GroupTable {
    /// The number of the group of this label.
    pub(crate) fn number(&mut self, what: &str, dimension: u8, label: &Label) -> usize {
        let next = self.groups.len();
        let key = (what.to_owned(), dimension, label.clone());
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            let (name, tag) = match label {
                Label::Tag(tag) => (None, Some(*tag)),
                Label::Name(name) => (Some(name.clone()), None),
            };
            let group = Group {
                what: what.to_owned(),
                dimension,
                name,
                tag,
                points: 0,
                lines: 0,
                quadrilaterals: 0,
                triangles: Vec::new(),
                vertices: Vec::new(),
            };
            self.groups.push(Gathered { group, others: Vec::new() });
        }
        number
    }

    /// Adds the next triangle of a group, by its index.
    pub(crate) fn add_triangle(&mut self, group: usize, triangle: u32) {
        self.groups[group].group.triangles.push(triangle);
    }

    /// Adds an element that is no triangle.
    pub(crate) fn add(&mut self, group: usize, kind: Kind, vertices: &[u32]) {
        let Gathered { group, others } = &mut self.groups[group];
        match kind {
            Kind::Point => group.points += 1,
            Kind::Line => group.lines += 1,
            Kind::Triangle | Kind::Corner => {}
            Kind::Quadrilateral => group.quadrilaterals += 1,
        }
        others.extend_from_slice(vertices);
    }

    /// Adds a vertex that is marked by itself.
    pub(crate) fn add_vertex(&mut self, group: usize, vertex: u32) {
        self.groups[group].others.push(vertex);
    }

    /// Gives groups a name, be they known or to come. A group of a name that no element has exists too.
    pub(crate) fn name(&mut self, what: &str, dimension: Option<u8>, tag: i64, name: &[u8]) {
        let Label::Name(name) = Label::name(name) else { return };
        if let Some(dimension) = dimension {
            self.number(what, dimension, &Label::Tag(tag));
        }
        self.names.insert((what.to_owned(), dimension, tag), name);
    }

    /// The groups of a mesh of these triangles.
    pub(crate) fn finish(mut self, triangles: &[[u32; 3]], vertices: usize) -> Groups {
        // What is called the same stands together, in the order in which the file first has it.
        let mut order: HashMap<String, usize> = HashMap::new();
        for Gathered { group, .. } in &self.groups {
            let next = order.len();
            order.entry(group.what.clone()).or_insert(next);
        }
        // For each vertex the last group that it was counted in.
        let mut last = vec![0; vertices];
        for (number, Gathered { group, others }) in (1_u32..).zip(&mut self.groups) {
            let of_triangles = group.triangles.iter().flat_map(|&t| triangles[t as usize]);
            for vertex in of_triangles.chain(others.drain(..)) {
                if std::mem::replace(&mut last[vertex as usize], number) != number {
                    group.vertices.push(vertex);
                }
            }
            group.vertices.sort_unstable();
        }
        for Gathered { group, .. } in &mut self.groups {
            let Some(tag) = group.tag else { continue };
            let of = |dimension| self.names.get(&(group.what.clone(), dimension, tag)).cloned();
            group.name = of(Some(group.dimension)).or_else(|| of(None));
        }
        let mut groups: Vec<Group> =
            self.groups.into_iter().map(|gathered| gathered.group).collect();
        groups.sort_by_key(|group| (order[&group.what], group.dimension, group.tag));
        Groups { groups }
    }
}
