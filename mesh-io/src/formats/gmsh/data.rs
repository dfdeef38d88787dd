//! Data of nodes and elements: the sections `$NodeData` and `$ElementData`.

use super::encoding::form;
use crate::binary::byte_order::ByteOrder;
use crate::edit::numbers::Offsets;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::token::unquoted;
use crate::visit::items::PointNumbers;
use crate::visit::storage::ArrayLocation;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::TextNumbers;

/// Reciprocal of the smallest share of nodes with a value. Node data with a smaller share are skipped.
const MIN_NODE_SHARE: u64 = 16;

/// Announces the data of a section after its first line, and reads the data if the visitor wants them. The cursor does
/// not move. `nodes` is the number of nodes for node data, `None` for element data. Damaged data are skipped, as the
/// mesh does not depend on data. Data of very few nodes are skipped too, as an array with a value per node would need
/// many times the memory of the file.
pub(super) fn read(
    cursor: &Cursor<'_>,
    nodes: Option<u64>,
    order: Option<ByteOrder>,
    visitor: &mut dyn MeshVisitor,
) {
    let cursor = &mut cursor.clone();
    let Some(Head { name, time, components, count }) = head(cursor) else {
        visitor.unsupported("data without a name, or with damaged tags");
        return;
    };
    // Data without a time have the time zero.
    if time != 0.0 && visitor.asks_for_data() {
        visitor.unsupported("times of time steps");
    }
    if nodes.is_some_and(|nodes| count.saturating_mul(MIN_NODE_SHARE) < nodes) {
        visitor.unsupported("data of few nodes");
        return;
    }
    let is_wanted = match nodes {
        Some(_) => visitor.point_array(name, components, true),
        None => visitor.asks_for_cell_arrays() && visitor.cell_array(name, components, true),
    };
    if !is_wanted {
        return;
    }
    let numbers = match order {
        None => text(cursor, components, count),
        Some(order) => binary(cursor, order, components, count),
    };
    match (numbers, nodes) {
        (Some(numbers), Some(_)) => visitor.point_numbers(numbers),
        (Some(numbers), None) => visitor.cell_numbers(numbers.numbers, numbers.nodes),
        (None, _) => {}
    }
}

/// The tags of a section.
struct Head<'a> {
    name: &'a [u8],
    /// The first real tag, 0 without one.
    time: f64,
    /// Numbers per node or element.
    components: u64,
    /// Number of nodes or elements with data.
    count: u64,
}

/// Reads the tags of a section. `None` without a name, without components, or if a tag is damaged.
fn head<'a>(cursor: &mut Cursor<'a>) -> Option<Head<'a>> {
    let mut name = None;
    for place in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
        let text = cursor.rest();
        if place == 0 {
            name = Some(unquoted(text));
        }
    }
    let mut time = 0.0;
    for place in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
        if place == 0 {
            time = cursor.real("a time").unwrap_or(0.0);
        }
    }
    let mut integers = [0; 3];
    for place in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
        let integer = cursor.signed("a tag").ok()?;
        if let Some(known) = integers.get_mut(usize::try_from(place).ok()?) {
            *known = u64::try_from(integer).ok()?;
        }
    }
    let [_, components, count] = integers;
    let name = name?;
    (components > 0).then_some(Head { name, time, components, count })
}

fn count(cursor: &mut Cursor<'_>) -> Option<u64> {
    cursor.next_row().then_some(())?;
    cursor.integer("a count").ok()
}

fn text(cursor: &mut Cursor<'_>, components: u64, count: u64) -> Option<PointNumbers> {
    let mut numbers = TextNumbers::default();
    let mut nodes = Vec::with_capacity(cursor.capacity(count, "1 0\n".len()));
    for _ in 0..count {
        cursor.next_row().then_some(())?;
        nodes.push(cursor.integer("a node").ok()?);
        for _ in 0..components {
            numbers.read(cursor).ok()?;
        }
    }
    Some(numbers.finish(Precision::Double, Some(nodes)))
}

fn binary(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    components: u64,
    count: u64,
) -> Option<PointNumbers> {
    const TAG: usize = 4;
    let each = usize::try_from(components).ok()?;
    let row = each.checked_mul(8)?.checked_add(TAG)?;
    let bytes = cursor.take(row.checked_mul(usize::try_from(count).ok()?)?)?;
    let start = cursor.last_taken();
    let (mut nodes, mut numbers, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (index, row_bytes) in bytes.chunks_exact(row).enumerate() {
        nodes.push(order.whole(&row_bytes[..TAG]));
        for (component, number) in row_bytes[TAG..].chunks_exact(8).enumerate() {
            numbers.push(order.real(Precision::Double, number));
            places.push(start + index * row + TAG + 8 * component);
        }
    }
    let stored = ArrayLocation::in_place(Offsets::List(places), form(Some(order)));
    Some(PointNumbers { numbers, nodes: Some(nodes), location: stored })
}
