//! Visitors of a second reading, which collect the groups of a file and the ids of its vertices.

use crate::content::group_label::GroupLabel;
use crate::content::id_index::IdIndexBuilder;
use crate::content::regions::Interner;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::group_table::GroupTable;
use crate::visit::items::{CellKind, Element, GroupScope, RegionAttribute};
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;

/// Reads a file again, and returns its groups.
pub(crate) fn groups(reader: &ReaderFunctions, source: &Source) -> Result<GroupTable, ReadError> {
    let mut gatherer = GroupVisitor::default();
    (reader.visit)(source, &mut gatherer)?;
    Ok(gatherer.table)
}

/// Reads a file again, and returns the id of each vertex in file order.
pub(crate) fn vertex_ids(reader: &ReaderFunctions, source: &Source) -> Result<Vec<u64>, ReadError> {
    let mut labels = VertexIdVisitor::default();
    (reader.visit)(source, &mut labels)?;
    Ok(labels.ids)
}

/// Visitor that collects the groups of a file in a [`GroupTable`].
#[derive(Default)]
struct GroupVisitor {
    table: GroupTable,
    ids: IdIndexBuilder,
    /// Numbers of triangles and of quadrilaterals that have been visited.
    triangles: u32,
    quadrilaterals: u32,
    /// Vertices of the last element other than a triangle.
    vertices: Vec<u32>,
    columns: Vec<RegionAttribute>,
    /// Distinct pairs of dimension and region integer among the visited elements, for each region attribute.
    met: Vec<Interner<(u8, i64)>>,
    /// The group of each pair in `met`, for each region attribute; `None` for integers without a group.
    groups: Vec<Vec<Option<usize>>>,
    /// Current group scopes: kind, label, and dimension; `None` means that each element sets the dimension.
    within: Vec<(String, GroupLabel, Option<u8>)>,
    /// The groups of `within` by dimension of elements; `None` until an element of the dimension is visited.
    within_groups: [Option<Vec<usize>>; 3],
    /// The groups of the current element.
    of_element: Vec<usize>,
}

impl GroupVisitor {
    /// Sets `of_element` to the groups of an element, ascending and without repeats.
    fn find(&mut self, dimension: u8, region: [i64; 2]) {
        let Self { table, columns, met, groups, within, within_groups, of_element, .. } = self;
        of_element.clear();
        let columns = columns.iter().zip(met).zip(groups).zip(region);
        for (((column, met), groups), number) in columns {
            if dimension < column.from_dimension {
                continue;
            }
            let name = met.intern((dimension, number)) as usize;
            if name == groups.len() {
                let label = (column.label)(number);
                let group = label.map(|label| table.number(&column.kind, dimension, &label));
                groups.push(group);
            }
            of_element.extend(groups[name]);
        }
        let within = within_groups[usize::from(dimension)].get_or_insert_with(|| {
            let number = |(kind, label, own): &(String, GroupLabel, Option<u8>)| {
                table.number(kind, own.unwrap_or(dimension), label)
            };
            within.iter().map(number).collect()
        });
        of_element.extend_from_slice(within);
        // Two arrays with equal names put an element into a group twice. The group must count the element once.
        of_element.sort_unstable();
        of_element.dedup();
    }
}

impl MeshVisitor for GroupVisitor {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        self.ids.push(id);
    }

    fn visit_element(&mut self, _: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        let &Element { kind, region, nodes, .. } = element;
        if kind == CellKind::Triangle {
            self.triangles += 1;
        } else {
            self.vertices.clear();
            let index = |&node: &u64| self.ids.index(node);
            self.vertices.extend(nodes[..kind.nodes()].iter().filter_map(index));
            self.quadrilaterals += u32::from(kind == CellKind::Quadrilateral);
        }
        self.further_region(kind, region);
        Ok(())
    }

    fn further_region(&mut self, kind: CellKind, region: [i64; 2]) {
        self.find(kind.dimension(), region);
        for &group in &self.of_element {
            match kind {
                CellKind::Triangle => self.table.add_triangle(group, self.triangles - 1),
                CellKind::Quadrilateral => {
                    let index = self.quadrilaterals - 1;
                    self.table.add_quadrilateral(group, index, &self.vertices);
                }
                _ => self.table.add(group, kind, &self.vertices),
            }
        }
    }

    fn polyline(
        &mut self,
        _: &Cursor<'_>,
        _: u64,
        region: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        self.vertices.clear();
        self.vertices.extend(nodes.iter().filter_map(|&node| self.ids.index(node)));
        // A polyline without a scope of its own belongs to the groups of points.
        self.find(CellKind::Point.dimension(), region);
        for &group in &self.of_element {
            self.table.add_polyline(group, &self.vertices);
        }
        Ok(())
    }

    fn held_line(&mut self, _: &Cursor<'_>, _: u64, nodes: [u64; 2]) -> Result<(), ReadError> {
        self.vertices.clear();
        self.vertices.extend(nodes.iter().filter_map(|&node| self.ids.index(node)));
        // The region is that of the line, which has been visited before.
        self.columns.clear();
        self.further_region(CellKind::Line, [0; 2]);
        Ok(())
    }

    fn asks_for_groups(&self) -> bool {
        true
    }

    fn region_attributes(&mut self, columns: Vec<RegionAttribute>) {
        self.met = columns.iter().map(|_| Interner::default()).collect();
        self.groups = columns.iter().map(|_| Vec::new()).collect();
        self.columns = columns;
    }

    fn group_scopes(&mut self, groups: &[GroupScope<'_>]) {
        let owned =
            |group: &GroupScope<'_>| (group.kind.to_owned(), group.label.clone(), group.dimension);
        self.within = groups.iter().map(owned).collect();
        self.within_groups = [None, None, None];
    }

    fn node_group(&mut self, node: u32, kind: &str, label: &GroupLabel) {
        let group = self.table.number(kind, 0, label);
        self.table.add_vertex(group, node);
    }

    fn group_name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: &[u8]) {
        self.table.name(kind, dimension, tag, name);
    }
}

/// Visitor that collects the ids of the vertices.
#[derive(Default)]
struct VertexIdVisitor {
    ids: Vec<u64>,
}

impl MeshVisitor for VertexIdVisitor {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        self.ids.push(id);
    }

    fn visit_element(&mut self, _: &Cursor<'_>, _: &Element) -> Result<(), ReadError> {
        Ok(())
    }
}
