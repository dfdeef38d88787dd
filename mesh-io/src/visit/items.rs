//! The items that readers hand on: elements, groups, periodic pairs, and numbers of points.

use crate::content::constraints::Affine;
use crate::content::group_label::GroupLabel;
use crate::visit::storage::ArrayLocation;

/// The kinds of cells. A line of several segments becomes several cells.
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
    /// Returns the number of nodes of an [`Element`] of the kind: 1 for a polygon, whose corners are elements.
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

    /// Returns the kind of a polygon by its number of corners.
    pub(crate) fn of_polygon(corners: u64) -> Option<CellKind> {
        [CellKind::Point, CellKind::Line, CellKind::Triangle, CellKind::Quadrilateral]
            .into_iter()
            .find(|kind| kind.nodes() as u64 == corners)
    }
}

/// An element of a file.
pub(crate) struct Element {
    /// The file's number of the element. If it has none, its position in the list, counted as the file counts.
    pub(crate) id: u64,
    pub(crate) kind: CellKind,
    /// Numbers that name the element's region; 0 where the format has none.
    pub(crate) region: [i64; 2],
    /// The tags of the nodes. Elements of fewer than four nodes leave the rest unused.
    pub(crate) nodes: [u64; 4],
}

/// Maps one of the two integers of [`Element::region`] to a group.
pub(crate) struct RegionAttribute {
    /// The kind of group that the number stands for: `physical`, `reference`, or the name of an array.
    pub(crate) kind: String,
    /// The least dimension of elements that have this number.
    pub(crate) from_dimension: u8,
    /// Returns the label that a number stands for; `None` if it stands for no group.
    pub(crate) label: fn(i64) -> Option<GroupLabel>,
}

impl RegionAttribute {
    /// Makes a column of tags that all stand for groups.
    pub(crate) fn tags(kind: &str, from_dimension: u8) -> RegionAttribute {
        RegionAttribute {
            kind: kind.into(),
            from_dimension,
            label: |tag| Some(GroupLabel::Tag(tag)),
        }
    }

    /// Makes a column of tags in which 0 stands for no group.
    pub(crate) fn tags_from_one(kind: &str) -> RegionAttribute {
        let label = |tag| (tag != 0).then_some(GroupLabel::Tag(tag));
        RegionAttribute { kind: kind.into(), from_dimension: 0, label }
    }
}

/// A group of all elements visited until the next call of `group_scopes`, such as the marker of an SU2 list or the
/// entity of a gmsh block.
#[derive(Clone, Debug)]
pub(crate) struct GroupScope<'w> {
    /// The format's word for the kind of group.
    pub(crate) kind: &'w str,
    pub(crate) label: GroupLabel,
    /// The dimension of the group, if it differs from that of its elements.
    pub(crate) dimension: Option<u8>,
}

/// Pairs of nodes that a periodic model identifies, with the motion that maps the first node of each pair to the
/// second.
#[derive(Debug, PartialEq)]
pub(crate) struct PeriodicNodes {
    /// The motion that takes the first node of each pair to the second, if the file gives it.
    pub(crate) motion: Option<Affine>,
    /// The tags of the two nodes of each pair; empty if the file gives only the motion.
    pub(crate) nodes: Vec<[u64; 2]>,
}

/// The numbers of an array of point data.
pub(crate) struct PointNumbers {
    /// The numbers, tuple by tuple in the order of the file.
    pub(crate) numbers: Vec<f64>,
    /// The tag of each tuple's node; `None` if there is a tuple for each node in order.
    pub(crate) nodes: Option<Vec<u64>>,
    /// The bytes of the numbers in the file; `None` if the numbers cannot be replaced.
    pub(crate) location: Option<ArrayLocation>,
}

/// One coordinate of the centers of some elements: faces, edges, or single nodes.
pub(crate) struct Centers {
    /// The tags of the nodes of all elements, one element after another, and where those of each end. An element without nodes has
    /// no center.
    pub(crate) nodes: Vec<u64>,
    pub(crate) ends: Vec<usize>,
    /// A number for each element.
    pub(crate) numbers: PointNumbers,
}
