//! The groups of a file, collected while its items are visited.

use crate::content::group::{Group, Groups};
use crate::content::group_keys::GroupKeys;
use crate::content::group_label::GroupLabel;
use crate::content::numbering::{Different, counts_elements};
use crate::visit::items::CellKind;
use std::collections::HashMap;

/// Groups of a file, collected during a visit. Indices in `groups` number the groups from 0.
#[derive(Default)]
pub(crate) struct GroupTable {
    groups: Vec<GroupMembers>,
    keys: GroupKeys,
}

/// Group under construction: `group` holds its triangles, `others` the vertices of its other elements.
struct GroupMembers {
    group: Group,
    /// Vertices of elements other than triangles, unordered and with repeats.
    others: Vec<u32>,
}

impl GroupTable {
    /// Returns the 0-based number of a group; the first use adds the group.
    pub(crate) fn number(&mut self, kind: &str, dimension: u8, label: &GroupLabel) -> usize {
        let (number, is_new) = self.keys.number(kind, dimension, label);
        if is_new {
            let (name, tag) = match label {
                GroupLabel::Tag(tag) => (None, Some(*tag)),
                GroupLabel::Name(name) => (Some(name.clone()), None),
            };
            let group = Group {
                kind: kind.to_owned(),
                dimension,
                name,
                tag,
                points: 0,
                lines: 0,
                quadrilaterals: Vec::new(),
                triangles: Vec::new(),
                vertices: Vec::new(),
                edges: Vec::new(),
            };
            self.groups.push(GroupMembers { group, others: Vec::new() });
        }
        number
    }

    /// Adds a triangle to a group. Triangles must come in ascending order.
    pub(crate) fn add_triangle(&mut self, group: usize, triangle: u32) {
        self.groups[group].group.triangles.push(triangle);
    }

    /// Adds a quadrilateral to a group. Quadrilaterals must come in ascending order.
    pub(crate) fn add_quadrilateral(&mut self, group: usize, index: u32, vertices: &[u32]) {
        let GroupMembers { group, others } = &mut self.groups[group];
        group.quadrilaterals.push(index);
        others.extend_from_slice(vertices);
    }

    /// Adds the vertices of an element other than a triangle or quadrilateral to a group, and counts the element.
    pub(crate) fn add(&mut self, group: usize, kind: CellKind, vertices: &[u32]) {
        let GroupMembers { group, others } = &mut self.groups[group];
        match kind {
            CellKind::Point => group.points += 1,
            CellKind::Line => {
                group.lines += 1;
                group.edges.extend(vertices.windows(2).map(|ends| [ends[0], ends[1]]));
            }
            CellKind::Triangle | CellKind::Quadrilateral | CellKind::Polygon => {}
        }
        others.extend_from_slice(vertices);
    }

    /// Adds a polyline to a group, and counts its vertices as points. A polyline may go on at the last vertex of the
    /// preceding polyline, and may end at its first vertex.
    pub(crate) fn add_polyline(&mut self, group: usize, vertices: &[u32]) {
        let GroupMembers { group, others } = &mut self.groups[group];
        let goes_on = group.edges.last().is_some_and(|[_, end]| vertices.first() == Some(end));
        let is_closed = vertices.len() > 2 && vertices.first() == vertices.last();
        group.points += vertices.len() - usize::from(goes_on) - usize::from(is_closed);
        group.edges.extend(vertices.windows(2).map(|ends| [ends[0], ends[1]]));
        others.extend_from_slice(vertices);
    }

    /// Adds a vertex that the file itself assigns to a group.
    pub(crate) fn add_vertex(&mut self, group: usize, vertex: u32) {
        self.groups[group].others.push(vertex);
    }

    /// Returns whether the table has groups of a kind.
    pub(crate) fn has_kind(&self, kind: &str) -> bool {
        self.groups.iter().any(|members| members.group.kind == kind)
    }

    /// Sets the name of the groups with a tag in one dimension; `None` sets the name in all dimensions. Groups may be
    /// added later. With a dimension, the named group exists even without elements.
    pub(crate) fn name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: &[u8]) {
        let GroupLabel::Name(name) = GroupLabel::name(name) else { return };
        if let Some(dimension) = dimension {
            self.number(kind, dimension, &GroupLabel::Tag(tag));
        }
        self.keys.set_name(kind, dimension, tag, name);
    }

    /// Removes the unnamed groups of surfaces of each kind whose numbers count elements. `elements` is the number of triangles
    /// and quadrilaterals.
    fn remove_counters(&mut self, elements: usize) {
        let Self { groups, keys } = self;
        let is_numbered = |Group { kind, dimension, name, tag, .. }: &Group| {
            let is_unnamed = |tag| keys.name_of(kind, 2, &GroupLabel::Tag(tag)).is_none();
            *dimension == 2
                && match name {
                    Some(name) => name.parse::<f64>().is_ok(),
                    None => tag.is_some_and(is_unnamed),
                }
        };
        let mut numbers: HashMap<String, Different> = HashMap::new();
        for GroupMembers { group, .. } in &*groups {
            if is_numbered(group) {
                let has_members = [&group.triangles, &group.quadrilaterals].map(|m| !m.is_empty());
                numbers.entry(group.kind.clone()).or_default().add(has_members);
            }
        }
        numbers.retain(|_, different| counts_elements(different.count(), elements));
        groups.retain(|GroupMembers { group, .. }| {
            !(numbers.contains_key(&group.kind) && is_numbered(group))
        });
    }

    /// Completes the groups of a mesh with the given triangles, number of quadrilaterals and number of vertices. Groups whose
    /// numbers count elements are left out.
    pub(crate) fn finish(
        mut self,
        triangles: &[[u32; 3]],
        quadrilaterals: usize,
        vertices: usize,
    ) -> Groups {
        self.remove_counters(triangles.len() + quadrilaterals);
        // Maps each kind to its position in the order of first use, by which groups are sorted.
        let mut order: HashMap<String, usize> = HashMap::new();
        for GroupMembers { group, .. } in &self.groups {
            let next = order.len();
            order.entry(group.kind.clone()).or_insert(next);
        }
        // For each vertex, the 1-based number of the last group that lists the vertex: a group lists each vertex once.
        let mut last = vec![0; vertices];
        for (number, GroupMembers { group, others }) in (1_u32..).zip(&mut self.groups) {
            let of_triangles = group.triangles.iter().flat_map(|&t| triangles[t as usize]);
            for vertex in of_triangles.chain(others.drain(..)) {
                if std::mem::replace(&mut last[vertex as usize], number) != number {
                    group.vertices.push(vertex);
                }
            }
            group.vertices.sort_unstable();
            group.edges.iter_mut().for_each(|edge| edge.sort_unstable());
            group.edges.retain(|[a, b]| a != b);
            group.edges.sort_unstable();
            group.edges.dedup();
        }
        for GroupMembers { group, .. } in &mut self.groups {
            let Some(tag) = group.tag else { continue };
            group.name = self.keys.name_of(&group.kind, group.dimension, &GroupLabel::Tag(tag));
        }
        let mut groups: Vec<Group> =
            self.groups.into_iter().map(|gathered| gathered.group).collect();
        groups.sort_by_key(|group| (order[&group.kind], group.dimension, group.tag));
        Groups { groups }
    }
}
