//! Data of nodes and elements: `$NodeData` and `$ElementData`.

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

/// Data of nodes are skipped if fewer than one in this number of nodes has them.
const MIN_NODE_SHARE: u64 = 16;

/// Announces the data of a section after its first line, and reads them if the visitor wants them. The cursor does not
/// move. `nodes` is the number of nodes, for data of nodes. Damaged data are skipped, as the mesh does not depend on
/// them. So are data of very few nodes, as a number for each node would take many times the memory of the file.
pub(super) fn read(
    cursor: &Cursor<'_>,
    nodes: Option<u64>,
    order: Option<ByteOrder>,
    visitor: &mut dyn MeshVisitor,
) {
    let cursor = &mut cursor.clone();
    let Some((name, components, count)) = head(cursor) else { return };
    if nodes.is_some_and(|nodes| count.saturating_mul(MIN_NODE_SHARE) < nodes) {
        visitor.unsupported("data of few nodes");
        return;
    }
    let is_wanted = match nodes {
        Some(_) => visitor.point_array(name, components, true),
        None => visitor.asks_for_data() && visitor.cell_array(name, components, true),
    };
    if is_wanted
        && let Some(numbers) = match order {
            None => text(cursor, components, count),
            Some(order) => binary(cursor, order, components, count),
        }
    {
        match nodes {
            Some(_) => visitor.point_numbers(numbers),
            None => visitor.cell_numbers(numbers.numbers, numbers.nodes),
        }
    }
}

/// Reads the name, how many numbers each node or element has, and how many of these have data.
fn head<'a>(cursor: &mut Cursor<'a>) -> Option<(&'a [u8], u64, u64)> {
    let mut name = None;
    for place in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
        let text = cursor.rest();
        if place == 0 {
            name = Some(unquoted(text));
        }
    }
    // Real tags, of which the first is a time.
    for _ in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
    }
    let mut integers = [0; 3];
    for place in 0..count(cursor)? {
        cursor.next_row().then_some(())?;
        let integer = cursor.signed("a tag").ok()?;
        if let Some(known) = integers.get_mut(usize::try_from(place).ok()?) {
            *known = u64::try_from(integer).ok()?;
        }
    }
    let [_, components, nodes] = integers;
    // Scalars, vectors and tensors, padded or not.
    (1..=9).contains(&components).then_some((name?, components, nodes))
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
