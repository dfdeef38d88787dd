//! Boundary conditions of a zone and their families, as groups of elements or vertices.

use super::file::{File, labeled};
use crate::content::decoded::decoded;
use crate::content::group_label::GroupLabel;
use crate::hdf5::Object;
use crate::text::token::join_first;
use crate::visit::items::GroupScope;
use crate::visit::visitor::MeshVisitor;
use std::cell::RefCell;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// Boundary conditions of elements, found by element number.
#[derive(Default)]
pub(super) struct Boundaries {
    all: Vec<Boundary>,
    /// Indices in `all` of the last visited element's boundary conditions.
    last: RefCell<Vec<usize>>,
}

struct Boundary {
    /// Kind and name of each group: the boundary condition itself, and its families.
    names: Vec<(&'static str, String)>,
    elements: Elements,
}

/// Numbers of the elements or vertices of a boundary condition.
enum Elements {
    Range(RangeInclusive<i64>),
    List(HashSet<i64>),
}

impl Elements {
    fn has(&self, element: i64) -> bool {
        match self {
            Elements::Range(range) => range.contains(&element),
            Elements::List(list) => list.contains(&element),
        }
    }
}

impl Boundaries {
    /// Visits the boundary conditions of the element `tag` as groups, unless they equal those of the last visited
    /// element.
    pub(super) fn of_element(&self, tag: u64, visitor: &mut dyn MeshVisitor) {
        if self.all.is_empty() {
            return;
        }
        let element = i64::try_from(tag).unwrap_or(-1);
        let each = self.all.iter().enumerate();
        let own: Vec<usize> =
            each.filter(|(_, own)| own.elements.has(element)).map(|(number, _)| number).collect();
        if *self.last.borrow() != own {
            let names = own.iter().flat_map(|&number| &self.all[number].names);
            let within = |(what, name): &'_ (&'static str, String)| GroupScope {
                kind: what,
                label: GroupLabel::Name(name.clone()),
                dimension: None,
            };
            let groups: Vec<GroupScope<'_>> = names.map(within).collect();
            visitor.group_scopes(&groups);
            self.last.replace(own);
        }
    }
}

impl<'a> File<'a> {
    /// Reads all boundary conditions. Boundary conditions on vertices are visited as groups, those on elements are
    /// returned. Boundary conditions without a readable list or range are left out.
    pub(super) fn boundaries(&self, vertices: usize, visitor: &mut dyn MeshVisitor) -> Boundaries {
        let mut boundaries = Boundaries::default();
        let mut tag = 0;
        self.lost_of_boundaries(visitor);
        for (_, all) in labeled(self.hdf5, self.zone, b"ZoneBC_t") {
            for (name, node) in labeled(self.hdf5, all, b"BC_t") {
                let names = self.names(name, node);
                let child =
                    |name: &[u8]| self.hdf5.child(node, name).and_then(|own| self.integers(own));
                let location =
                    self.hdf5.child(node, b"GridLocation").and_then(|own| self.text(own));
                let is_of_vertices = location.is_none_or(|location| location == b"Vertex");
                let range = |numbers: Option<Vec<i64>>| match numbers.as_deref() {
                    Some(&[first, last]) => Some(Elements::Range(first..=last)),
                    _ => None,
                };
                let list = |numbers: Option<Vec<i64>>| {
                    Some(Elements::List(numbers?.into_iter().collect()))
                };
                let points = range(child(b"PointRange")).or_else(|| list(child(b"PointList")));
                let elements =
                    range(child(b"ElementRange")).or_else(|| list(child(b"ElementList")));
                match (elements, points) {
                    (Some(elements), _) => boundaries.all.push(Boundary { names, elements }),
                    (None, Some(elements)) if !is_of_vertices => {
                        boundaries.all.push(Boundary { names, elements });
                    }
                    (None, Some(points)) => {
                        for (what, name) in &names {
                            tag += 1;
                            visitor.group_name(what, Some(0), tag, name.as_bytes());
                            for vertex in (1..=vertices).filter(|&v| points.has(v as i64)) {
                                visitor.node_group(vertex as u32 - 1, what, &GroupLabel::Tag(tag));
                            }
                        }
                    }
                    (None, None) => {
                        let name = decoded(name);
                        visitor.unsupported(&format!("the elements of the boundary {name}"));
                    }
                }
            }
        }
        boundaries
    }

    /// Reports the parts of boundary conditions that are no groups: types, such as `BCWall`, of boundary conditions and of
    /// families, and data.
    fn lost_of_boundaries(&self, visitor: &mut dyn MeshVisitor) {
        let all = labeled(self.hdf5, self.zone, b"ZoneBC_t").into_iter();
        let all: Vec<_> = all.flat_map(|(_, all)| labeled(self.hdf5, all, b"BC_t")).collect();
        let families =
            labeled(self.hdf5, self.base, b"Family_t").into_iter().filter_map(|(name, family)| {
                let kinds = labeled(self.hdf5, family, b"FamilyBC_t");
                kinds.first().map(|&(_, kind)| (name, kind))
            });
        // These types say nothing about the solution.
        const NEUTRAL: [&[u8]; 3] = [b"Null", b"UserDefined", b"FamilySpecified"];
        let kinds = all.iter().copied().chain(families).filter_map(|(name, node)| {
            let kind = self.text(node).filter(|kind| !NEUTRAL.contains(&kind.as_slice()))?;
            Some(format!("{} ({})", decoded(name), decoded(&kind)))
        });
        let kinds: Vec<String> = kinds.collect();
        if !kinds.is_empty() {
            let kinds: Vec<&str> = kinds.iter().map(String::as_str).collect();
            visitor.unsupported(&format!("types of boundaries: {}", join_first(&kinds)));
        }
        if all.iter().any(|(_, node)| !labeled(self.hdf5, node, b"BCDataSet_t").is_empty()) {
            visitor.unsupported("data of boundaries");
        }
    }

    /// Returns the kinds and names of a boundary condition's groups: the boundary condition, the names of its family,
    /// and the family.
    fn names(&self, name: &[u8], node: &'a Object) -> Vec<(&'static str, String)> {
        let text = |name: &[u8]| decoded(name);
        let mut names = vec![("boundary", text(name))];
        let family = self.hdf5.child(node, b"FamilyName").and_then(|own| self.text(own));
        let Some(family) = family else { return names };
        let own = self.hdf5.child(self.base, &family);
        let inner = own.map(|own| labeled(self.hdf5, own, b"FamilyName_t")).unwrap_or_default();
        let inner = inner.into_iter().filter_map(|(_, own)| self.text(own));
        names.extend(inner.map(|name| ("family", text(&name))));
        names.push(("family", text(&family)));
        names
    }
}
