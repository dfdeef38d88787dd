//! Interface of the visitors that readers call for each item of a file.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{
    CellKind, Centers, Element, GroupScope, PeriodicNodes, PointNumbers, RegionAttribute,
};
use crate::visit::records::{NodeRecords, TriangleRecords};

/// Loss of polylines in conversions, for users.
pub(crate) const POLYLINES: &str = "lines of more than two points, which become several lines";

/// Visitor of the items of a mesh file. A reader visits all nodes, then all elements, both in file order.
pub(crate) trait MeshVisitor {
    /// Returns whether a list may be parsed on several threads. Items then arrive in file order, but the cursor passed
    /// with an item has no valid location. Calls with an error must leave the visitor unchanged: the reader parses the
    /// item again, alone, for the final error.
    fn allows_parallel(&self) -> bool {
        false
    }
    /// Returns whether the visitor uses nodes. For `false`, readers may skip calls of [`node`](Self::node).
    fn asks_for_nodes(&self) -> bool {
        true
    }
    /// Announces the approximate number of nodes, for reserving memory.
    fn expect_nodes(&mut self, _count: usize) {}
    /// Visits a node. `x_at` is the byte offset of x; `at` holds x and y. `dimension` is the dimension of the node's
    /// model entity (gmsh 4), or 2 in files without a model.
    fn node(&mut self, cursor: &Cursor<'_>, id: u64, dimension: u64, x_at: usize, at: [f64; 2]);
    /// Visits a binary list of nodes in bulk. Returns how many leading nodes the visitor has processed; the caller
    /// passes the remaining nodes to [`node`](Self::node).
    fn node_records(&mut self, _records: &NodeRecords<'_>) -> usize {
        0
    }
    /// Ends the list of nodes.
    fn end_nodes(&mut self, _cursor: &Cursor<'_>) -> Result<(), ReadError> {
        Ok(())
    }
    /// Announces the approximate number of elements, for reserving memory.
    fn expect_elements(&mut self, _count: usize) {}
    /// Visits an element of a file. A quadrilateral that repeats a corner in place of the fourth becomes a triangle (see
    /// [`Element::triangle_of_four`]). Readers call this method, and visitors implement
    /// [`visit_element`](Self::visit_element).
    #[inline]
    fn element(&mut self, cursor: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        match element.triangle_of_four() {
            None => self.visit_element(cursor, element),
            Some(triangle) => self.visit_element(cursor, &triangle),
        }
    }
    /// Visits an element after [`element`](Self::element) has found its shape. By default, elements are ignored.
    fn visit_element(&mut self, _cursor: &Cursor<'_>, _element: &Element) -> Result<(), ReadError> {
        Ok(())
    }
    /// Visits a further region of the last element, for files that list an element once for each of its groups. By
    /// default, further regions are ignored.
    fn further_region(&mut self, _kind: CellKind, _region: [i64; 2]) {}
    /// Visits a binary list of triangles in bulk. Returns how many leading triangles the visitor has processed; the
    /// caller passes the remaining triangles to [`element`](Self::element).
    fn triangle_records(&mut self, _records: &TriangleRecords<'_>) -> usize {
        0
    }
    /// Visits a polygon of five or more corners. By default, each corner is visited as an element of kind
    /// [`CellKind::Polygon`].
    fn polygon(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        corners: &[u64],
    ) -> Result<(), ReadError> {
        corners.iter().try_for_each(|&corner| {
            let nodes = [corner, 0, 0, 0];
            self.element(cursor, &Element { id, kind: CellKind::Polygon, region, nodes })
        })
    }
    /// Visits a polyline, a line through any number of nodes. By default, each node is visited as an element of kind
    /// [`CellKind::Point`].
    fn polyline(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        nodes.iter().try_for_each(|&node| {
            let nodes = [node, 0, 0, 0];
            self.element(cursor, &Element { id, kind: CellKind::Point, region, nodes })
        })
    }
    /// Visits an edge whose vertices neither move nor slide, and which is one of the visited lines too. The edge belongs
    /// to the current group scopes alone. By default, such edges are ignored.
    fn held_line(&mut self, _: &Cursor<'_>, _id: u64, _nodes: [u64; 2]) -> Result<(), ReadError> {
        Ok(())
    }
    /// Returns whether the visitor uses pairs of periodic nodes and of weirs. For `false`, readers may skip calls of
    /// [`periodic_pairs`](Self::periodic_pairs) and [`weir`](Self::weir).
    fn asks_for_periodic_pairs(&self) -> bool {
        false
    }
    /// Visits the pairs of periodic nodes in the file; `None` if a reader could not parse the pairs.
    fn periodic_pairs(&mut self, _pairs: Option<Vec<PeriodicNodes>>) {}
    /// Visits the pairs of nodes that face each other on the two banks of a weir, in order along the weir. The list is
    /// empty for other boundaries.
    fn weir(&mut self, _pairs: &[[u64; 2]]) {}
    /// Returns whether the visitor uses ghosts. For `false`, readers may skip calls of [`ghosts`](Self::ghosts) and
    /// [`pieces`](Self::pieces).
    fn asks_for_ghosts(&self) -> bool {
        false
    }
    /// Visits the ids of nodes that other pieces of a partitioned mesh have too, after the elements. `count` is the
    /// number of ghosts, which `name` names in the singular. Ids may repeat, and may be unknown.
    fn ghosts(&mut self, _name: &'static str, _count: u64, _nodes: &[u64]) {}
    /// Visits the id of the first node of each piece of the mesh in one file, after the nodes. Nodes of different pieces
    /// at one position are copies of each other.
    fn pieces(&mut self, _first_nodes: &[u64]) {}
    /// Visits a remark for the user.
    fn remark(&mut self, _remark: Remark) {}

    /// Returns whether the visitor uses groups. For `false`, readers may skip calls of
    /// [`region_attributes`](Self::region_attributes), [`group_scopes`](Self::group_scopes),
    /// [`node_group`](Self::node_group) and [`group_name`](Self::group_name).
    fn asks_for_groups(&self) -> bool {
        false
    }
    /// Visits the meaning of the two integers of [`Element::region`], before the first element.
    fn region_attributes(&mut self, _columns: Vec<RegionAttribute>) {}
    /// Visits the groups of all elements until the next call of `group_scopes`, in addition to the groups of
    /// [`Element::region`].
    fn group_scopes(&mut self, _groups: &[GroupScope<'_>]) {}
    /// Visits a group of one node. `node` is the 0-based index of the node in file order, `kind` and `label` identify
    /// the group.
    fn node_group(&mut self, _node: u32, _kind: &str, _label: &GroupLabel) {}
    /// Visits the name of groups, identified by kind and tag. `dimension` is 0, 1 or 2; `None` names the groups of all
    /// dimensions.
    fn group_name(&mut self, _kind: &str, _dimension: Option<u8>, _tag: i64, _name: &[u8]) {}

    /// Returns whether the visitor uses data. For `false`, readers may skip constant third coordinates, cell data,
    /// lists after the elements, and calls of [`unsupported`](Self::unsupported).
    fn asks_for_data(&self) -> bool {
        false
    }
    /// Returns whether the visitor wants announcements of cell data. For `false`, readers may skip calls of
    /// [`cell_array`](Self::cell_array).
    fn asks_for_cell_arrays(&self) -> bool {
        self.asks_for_data()
    }
    /// Announces an array of point data: its name, components per point, and whether its numbers are real (else whole).
    /// Returns whether the visitor wants the numbers, in a call of [`point_numbers`](Self::point_numbers).
    fn point_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Announces the parameters of nodes on a surface of the model, two numbers for each node. Returns whether the
    /// visitor wants the numbers, in a call of [`parameter_numbers`](Self::parameter_numbers).
    fn parameters(&mut self, _surface: i64) -> bool {
        false
    }
    /// Visits the parameters announced last, unless the visitor declined the numbers.
    fn parameter_numbers(&mut self, _numbers: PointNumbers) {}
    /// Announces an array with one coordinate of the centers of elements: x for `axis` 0, y for 1. Returns whether the
    /// visitor wants the numbers, in a call of [`center_numbers`](Self::center_numbers).
    fn center_array(&mut self, _name: &[u8], _axis: usize) -> bool {
        false
    }
    /// Visits the centers announced last, unless the visitor declined the numbers.
    fn center_numbers(&mut self, _centers: Centers) {}
    /// Announces third coordinates or depths as an array of point data. Returns whether the visitor uses the numbers.
    fn z_array(&mut self, name: &[u8]) -> bool {
        self.point_array(name, 1, true)
    }
    /// Announces an array of cell data, with arguments and result as in [`point_array`](Self::point_array). Readers
    /// call this method only if [`asks_for_cell_arrays`](Self::asks_for_cell_arrays) returns `true`.
    fn cell_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Visits the name of the projection of the coordinates, or its definition as text. By default, the projection is ignored.
    fn projection(&mut self, _projection: &[u8]) {}
    /// Visits the factor and the offset of the array announced last, before its numbers, which are packed: programs
    /// multiply the stored numbers by the factor and add the offset. By default, numbers stay as they are stored.
    fn packing(&mut self, _packing: [f64; 2]) {}
    /// Visits the point whose coordinates programs add to those of all nodes, in the units of the file. By default, the
    /// origin is ignored, and nodes keep the coordinates of the file.
    fn origin(&mut self, _at: [i32; 2]) {}
    /// Visits the numbers of the cell data announced last, unless the visitor declined. `tags` holds the element id of
    /// each tuple; `None` if tuple `i` belongs to the element with id `i`.
    fn cell_numbers(&mut self, _numbers: Vec<f64>, _tags: Option<Vec<u64>>) {}
    /// Visits a short description of content that the reader skips, such as a list of the file.
    fn unsupported(&mut self, _what: &str) {}
    /// Visits the numbers of the point data announced last, unless the visitor declined the numbers.
    fn point_numbers(&mut self, _numbers: PointNumbers) {}
}
