//! The visitor that readers call for each item of a file.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{
    CellKind, Centers, Element, GroupScope, PeriodicNodes, PointNumbers, RegionAttribute,
};
use crate::visit::records::{NodeRecords, TriangleRecords};

/// Visitor of the items of a mesh file. A reader calls the methods for all nodes first, then for all elements, each
/// in file order.
pub(crate) trait MeshVisitor {
    /// Returns whether a list may be parsed on several threads. Items then arrive in file order, but the cursor
    /// passed with an item has no valid location. If a call returns an error, the call must have no effect: the item
    /// is parsed again, alone, to make the final error.
    fn allows_parallel(&self) -> bool {
        false
    }
    /// Returns whether the visitor uses nodes. If not, readers may leave out calls of [`node`](Self::node).
    fn asks_for_nodes(&self) -> bool {
        true
    }
    /// Announces about how many nodes follow.
    fn expect_nodes(&mut self, _count: usize) {}
    /// Takes a node that was just read. `x_at` is the offset of x, and `at` are x and y. `dimension` is that of the
    /// model entity it lies on if the file tells it, else 2.
    fn node(&mut self, cursor: &Cursor<'_>, id: u64, dimension: u64, x_at: usize, at: [f64; 2]);
    /// Takes nodes of a binary list from the first one on. Returns how many it took; the caller hands the others to
    /// [`node`](Self::node).
    fn node_records(&mut self, _records: &NodeRecords<'_>) -> usize {
        0
    }
    /// Ends the list of nodes.
    fn end_nodes(&mut self, _cursor: &Cursor<'_>) -> Result<(), ReadError> {
        Ok(())
    }
    /// Announces about how many elements follow.
    fn expect_elements(&mut self, _count: usize) {}
    /// Takes an element that was just read. Visitors that need no elements ignore the call.
    fn element(&mut self, _cursor: &Cursor<'_>, _element: &Element) -> Result<(), ReadError> {
        Ok(())
    }
    /// Takes triangles of a binary list from the first one on. Returns how many it took; the caller hands the others to
    /// [`element`](Self::element).
    fn triangle_records(&mut self, _records: &TriangleRecords<'_>) -> usize {
        0
    }
    /// Takes a polygon of more than four corners. Its vertices are constraints.
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
    /// Takes a line through any number of nodes, which are constraints.
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
    /// Returns whether the visitor uses pairs of periodic nodes. If not, readers may leave out calls of
    /// [`periodic_pairs`](Self::periodic_pairs).
    fn asks_for_periodic_pairs(&self) -> bool {
        false
    }
    /// Visits the pairs of periodic nodes of the file; `None` if the pairs could not be read.
    fn periodic_pairs(&mut self, _pairs: Option<Vec<PeriodicNodes>>) {}
    /// Takes a remark for the user.
    fn remark(&mut self, _remark: Remark) {}

    /// Returns whether the visitor uses groups. If not, readers may leave out calls of
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
    /// Visits the name of the group with a kind and a tag. `dimension` is 0, 1 or 2; `None` if the name holds for all
    /// dimensions.
    fn group_name(&mut self, _kind: &str, _dimension: Option<u8>, _tag: i64, _name: &[u8]) {}

    /// Whether the visitor asks for data that a plain reading may leave out: third coordinates that are all the same, and
    /// lists after the elements.
    fn asks_for_data(&self) -> bool {
        false
    }
    /// Takes the name of an array of point data, its numbers per point, and whether these are real, not whole. Third
    /// coordinates are such an array too. Returns whether the visitor wants the numbers.
    fn point_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes notice that nodes have parameters on a surface of the model. Returns whether the visitor wants them, two
    /// numbers for each node.
    fn parameters(&mut self, _surface: i64) -> bool {
        false
    }
    /// Takes the parameters that were announced last, if the visitor wants them.
    fn parameter_numbers(&mut self, _numbers: PointNumbers) {}
    /// Takes the name of an array that has a coordinate of the center of each of some elements: x for the axis 0, y for 1.
    /// Returns whether the visitor wants the numbers.
    fn center_array(&mut self, _name: &[u8], _axis: usize) -> bool {
        false
    }
    /// Takes the centers that were announced last, if the visitor wants them.
    fn center_numbers(&mut self, _centers: Centers) {}
    /// Announces third coordinates or depths as an array of point data. Returns whether the visitor uses the numbers.
    fn z_array(&mut self, name: &[u8]) -> bool {
        self.point_array(name, 1, true)
    }
    /// Takes the name of an array of cell data, with the same arguments and result as
    /// [`point_array`](Self::point_array). Called only if the visitor asks for data.
    fn cell_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes the numbers of the cell data that were announced last, if the visitor wants them. `tags` are those of the
    /// elements that the numbers belong to; `None` if they belong to all.
    fn cell_numbers(&mut self, _numbers: Vec<f64>, _tags: Option<Vec<u64>>) {}
    /// Visits a short description of a part of the file that the reader leaves out.
    fn unsupported(&mut self, _what: &str) {}
    /// Takes the numbers of the point data that were announced last, if the visitor wants them.
    fn point_numbers(&mut self, _numbers: PointNumbers) {}
}
