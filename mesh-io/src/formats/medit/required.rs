//! Required triangles, whose vertices stay fixed. Both of Medit's formats list required triangles by number.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::visitor::MeshVisitor;

/// Visits the corners of the required triangles as points. `required` are the numbers of the triangles, counted from 1
/// through all lists. `counts` are the lengths of the lists of triangles. `triangle` reads the triangle with a 0-based
/// index in a list, and returns location, nodes and reference of the triangle. Calls of `triangle` are in ascending
/// order.
pub(super) fn send_required_corners<'a>(
    mut required: Vec<u64>,
    counts: &[u64],
    visitor: &mut dyn MeshVisitor,
    mut triangle: impl FnMut(usize, u64) -> Result<(Cursor<'a>, [u64; 4], i64), ReadError>,
) -> Result<(), ReadError> {
    if required.is_empty() {
        return Ok(());
    }
    required.sort_unstable();
    required.dedup();
    visitor.remark(Remark::elements(required.len() as u64, "required triangle", ""));
    let label = GroupLabel::name(b"RequiredTriangles");
    visitor.group_scopes(&[GroupScope { kind: "list", label, dimension: None }]);
    let mut before = 0;
    for (list, &count) in counts.iter().enumerate() {
        for &tag in required.iter().filter(|&&tag| tag > before && tag - before <= count) {
            let (place, nodes, reference) = triangle(list, tag - before - 1)?;
            for &corner in &nodes[..3] {
                let (kind, nodes, region) = (CellKind::Polygon, [corner, 0, 0, 0], [reference, 0]);
                visitor.element(&place, &Element { id: tag, kind, region, nodes })?;
            }
        }
        before += count;
    }
    Ok(())
}
