//! Items that readers pass to visitors: elements, groups, periodic pairs, and numbers of points.

use crate::content::constraints::Affine;
use crate::content::group_label::GroupLabel;
use crate::visit::storage::ArrayLocation;

/// Shape of a cell. A line of several segments becomes several cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CellKind {
    /// One vertex.
    Point,
    /// Two vertices.
    Line,
    /// Three vertices.
    Triangle,
    /// Four vertices.
    Quadrilateral,
    /// Five or more vertices.
    Polygon,
}

impl CellKind {
    /// Returns the number of nodes in [`Element::nodes`]: 1 to 4 by shape. Polygons return 1, as each corner is visited
    /// as a separate element.
    pub(crate) fn nodes(self) -> usize {
        match self {
            CellKind::Point | CellKind::Polygon => 1,
            CellKind::Line => 2,
            CellKind::Triangle => 3,
            CellKind::Quadrilateral => 4,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            CellKind::Point => "point",
            CellKind::Polygon => "polygon",
            CellKind::Line => "line",
            CellKind::Triangle => "triangle",
            CellKind::Quadrilateral => "quadrilateral",
        }
    }

    /// Returns the dimension of the elements: 0 for points, 1 for lines, 2 for surfaces.
    pub(crate) fn dimension(self) -> u8 {
        match self {
            CellKind::Point => 0,
            CellKind::Line => 1,
            CellKind::Triangle | CellKind::Quadrilateral | CellKind::Polygon => 2,
        }
    }

    /// Returns the kind of cell with 1 to 4 corners; `None` for 0 corners, and for polygons of five or more.
    pub(crate) fn of_polygon(corners: u64) -> Option<CellKind> {
        [CellKind::Point, CellKind::Line, CellKind::Triangle, CellKind::Quadrilateral]
            .into_iter()
            .find(|kind| kind.nodes() as u64 == corners)
    }
}

/// An element of a file.
pub(crate) struct Element {
    /// Id of the element in the file. In formats without element ids, the position in the list, from 0 or 1 as the
    /// format counts.
    pub(crate) id: u64,
    pub(crate) kind: CellKind,
    /// Integers that identify the element's region; 0 where the format has fewer than two.
    pub(crate) region: [i64; 2],
    /// Node ids. Entries beyond [`CellKind::nodes`] are unused.
    pub(crate) nodes: [u64; 4],
}

impl Element {
    /// Returns the triangle that a quadrilateral stands for; `None` for any other element. Lists of four nodes in each
    /// row, as programs for mixed meshes write them, repeat the third or the first node of a triangle as the fourth.
    #[inline]
    pub(crate) fn triangle_of_four(&self) -> Option<Element> {
        let &Element { id, kind: CellKind::Quadrilateral, region, nodes } = self else {
            return None;
        };
        let [a, b, c, d] = nodes;
        let is_triangle = (d == c || d == a) && a != b && b != c && c != a;
        let nodes = [a, b, c, 0];
        is_triangle.then_some(Element { id, kind: CellKind::Triangle, region, nodes })
    }
}

/// Maps one of the two integers of [`Element::region`] to a group.
pub(crate) struct RegionAttribute {
    /// Kind of the groups: `physical`, `reference`, or the name of an array.
    pub(crate) kind: String,
    /// Least dimension of elements with the attribute; other elements have an unused integer.
    pub(crate) from_dimension: u8,
    /// Maps an integer to the label of its group; `None` for integers without a group.
    pub(crate) label: fn(i64) -> Option<GroupLabel>,
}

impl RegionAttribute {
    /// Makes an attribute whose integers are all tags of groups, 0 included.
    pub(crate) fn tags(kind: &str, from_dimension: u8) -> RegionAttribute {
        RegionAttribute {
            kind: kind.into(),
            from_dimension,
            label: |tag| Some(GroupLabel::Tag(tag)),
        }
    }

    /// Makes an attribute whose integers are tags of groups, except 0 for elements without a group.
    pub(crate) fn tags_from_one(kind: &str) -> RegionAttribute {
        let label = |tag| (tag != 0).then_some(GroupLabel::Tag(tag));
        RegionAttribute { kind: kind.into(), from_dimension: 0, label }
    }
}

/// A group of all elements visited until the next call of `group_scopes`, such as the marker of an SU2 list or the
/// entity of a gmsh block.
#[derive(Clone, Debug)]
pub(crate) struct GroupScope<'w> {
    /// Kind of the group: `physical`, `marker` and similar words of the format.
    pub(crate) kind: &'w str,
    pub(crate) label: GroupLabel,
    /// Dimension of the group; `None` for the dimension of each element.
    pub(crate) dimension: Option<u8>,
}

/// Pairs of nodes that a periodic model identifies, with the motion that maps the first node of each pair to the
/// second.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PeriodicNodes {
    /// Dimension of the two entities of the model (gmsh), and the tags of the second and the first entity.
    pub(crate) entities: Option<(u8, [i64; 2])>,
    /// Motion from first to second nodes; `None` if the file lists pairs alone.
    pub(crate) motion: Option<Affine>,
    /// Ids of the two nodes of each pair; empty in formats that store a motion alone.
    pub(crate) nodes: Vec<[u64; 2]>,
}

/// The numbers of an array of point data.
pub(crate) struct PointNumbers {
    /// The numbers, tuple by tuple in the order of the file.
    pub(crate) numbers: Vec<f64>,
    /// Node id of each tuple; `None` if tuple `i` belongs to node `i` in file order.
    pub(crate) nodes: Option<Vec<u64>>,
    /// Location of the numbers in the file; `None` if the numbers cannot be replaced.
    pub(crate) location: Option<ArrayLocation>,
}

/// One coordinate of the centers of faces or edges, or of the corners of faces (UGRID). A corner counts as an element
/// of one node.
pub(crate) struct Centers {
    /// Node ids of all elements, element by element. `ends` holds the exclusive end of each element's ids. An element
    /// without nodes has no center.
    pub(crate) nodes: Vec<u64>,
    pub(crate) ends: Vec<usize>,
    /// A number for each element.
    pub(crate) numbers: PointNumbers,
}
