//! Lists of required triangles, quadrilaterals and edges, and of ridges, whose vertices stay fixed. Both of Medit's formats
//! list these elements by number.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::visitor::MeshVisitor;

/// Elements that a file lists by number, and that stay.
pub(super) struct NumberList {
    /// The keyword of the list in text files.
    pub(super) name: &'static str,
    /// The keyword of the list in binary files.
    pub(super) keyword: i32,
    pub(super) kind: CellKind,
    /// The word for one of the elements.
    pub(super) word: &'static str,
    /// Numbers of the elements, counted from 1 through all lists of their kind.
    pub(super) numbers: Vec<u64>,
}

impl NumberList {
    /// Returns the lists, all of them empty.
    pub(super) fn all() -> [NumberList; 4] {
        let list = |name, keyword, kind, word| NumberList {
            name,
            keyword,
            kind,
            word,
            numbers: Vec::new(),
        };
        [
            list("RequiredTriangles", 17, CellKind::Triangle, "required triangle"),
            list("RequiredQuadrilaterals", 18, CellKind::Quadrilateral, "required quadrilateral"),
            list("RequiredEdges", 16, CellKind::Line, "required edge"),
            list("Ridges", 14, CellKind::Line, "ridge"),
        ]
    }

    /// Visits the corners of triangles and quadrilaterals as points, and edges as held lines. `counts` are the lengths of
    /// the lists of elements of the kind. `element` reads the element with a 0-based index in a list, and returns location,
    /// nodes and reference of the element. Calls of `element` are in ascending order.
    pub(super) fn send<'a>(
        self,
        counts: &[u64],
        visitor: &mut dyn MeshVisitor,
        mut element: impl FnMut(usize, u64) -> Result<(Cursor<'a>, [u64; 4], i64), ReadError>,
    ) -> Result<(), ReadError> {
        let NumberList { name, kind, word, mut numbers, .. } = self;
        if numbers.is_empty() {
            return Ok(());
        }
        numbers.sort_unstable();
        numbers.dedup();
        visitor.remark(Remark::elements(numbers.len() as u64, word, ""));
        let label = GroupLabel::name(name.as_bytes());
        visitor.group_scopes(&[GroupScope { kind: "list", label, dimension: None }]);
        let mut before = 0;
        for (list, &count) in counts.iter().enumerate() {
            for &id in numbers.iter().filter(|&&id| id > before && id - before <= count) {
                let (place, nodes, reference) = element(list, id - before - 1)?;
                if kind == CellKind::Line {
                    visitor.held_line(&place, id, [nodes[0], nodes[1]])?;
                    continue;
                }
                for &corner in &nodes[..kind.nodes()] {
                    let (kind, nodes, region) =
                        (CellKind::Polygon, [corner, 0, 0, 0], [reference, 0]);
                    visitor.element(&place, &Element { id, kind, region, nodes })?;
                }
            }
            before += count;
        }
        if visitor.asks_for_data() {
            visitor.unsupported(&format!("the list {name}"));
        }
        Ok(())
    }
}
