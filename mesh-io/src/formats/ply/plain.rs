//! Reads lists of a PLY on all threads, as long as they are plain.

use super::header::{Items, List, Number, Property};
use crate::binary::number_field::NumberField;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::parallel_rows::take_rows;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{FieldRule, NodeIds, NodeRecords, Region, TriangleRecords};
use crate::visit::rows::nodes;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

impl Items {
    /// Hands on the first vertices as long as they are plain, if all have the same number of bytes. `x` and `z` are
    /// indices of properties. Returns how many vertices were taken.
    pub(super) fn plain_vertices(
        self,
        cursor: &mut Cursor<'_>,
        list: &List<'_>,
        x: usize,
        z: Option<usize>,
        z_values: &mut ZValues,
        visitor: &mut dyn MeshVisitor,
    ) -> u64 {
        let properties = &list.properties;
        let before = |index| properties[..index].iter().map(|p| p.number.size()).sum::<usize>();
        let stride = before(properties.len());
        if properties.iter().any(|property| property.length.is_some()) {
            return 0;
        }
        let Some(order) = self.order else {
            let is_first = x == 0;
            return if is_first { vertices_of_text(cursor, list, z, z_values, visitor) } else { 0 };
        };
        let Some((bytes, start)) = cursor.peek(list.count, stride) else { return 0 };
        let field = |index: usize| {
            NumberField::new(
                bytes.get(before(index)..),
                stride,
                properties[index].number.size(),
                order,
            )
        };
        let (count, x_at, ids) = (list.count as usize, start + before(x), NodeIds::Consecutive(0));
        let z_of = z.map(|z| (field(z), start + before(z)));
        if z_of.is_some_and(|(z, _)| !z.all_real(count, f64::is_finite)) {
            return 0;
        }
        let records = NodeRecords { count, x: field(x), y: field(x + 1), x_offset: x_at, ids };
        let taken = visitor.node_records(&records);
        if let Some((z, at)) = z_of {
            z_values.push_records(z, taken, at);
        }
        cursor.take(taken * stride);
        taken as u64
    }

    /// Hands on the first elements as long as they are triangles. Returns how many were taken.
    pub(super) fn plain_triangles(
        self,
        cursor: &mut Cursor<'_>,
        list: &List<'_>,
        names: &[&[u8]],
        visitor: &mut dyn MeshVisitor,
    ) -> u64 {
        let properties = &list.properties;
        let size = |property: &Property<'_>| match property.length {
            None => property.number.size(),
            // The bytes of a list of three numbers.
            Some(length) => length.size() + 3 * property.number.size(),
        };
        let is_list = |property: &Property<'_>| property.length.is_some();
        let whole = |number| matches!(number, Number::Integer { .. });
        let Some(corners) = properties.iter().position(is_list) else { return 0 };
        let Property { name, length: Some(length), number } = properties[corners] else { return 0 };
        let is_named = |property: &Property<'_>| names.contains(&property.name);
        if !names.contains(&name)
            || properties.iter().filter(|property| is_list(property) || is_named(property)).count()
                > 1
            || !whole(length)
            || !whole(number)
        {
            return 0;
        }
        let Some(order) = self.order else {
            let is_alone = properties.len() == 1;
            return if is_alone { triangles_of_text(cursor, list.count, visitor) } else { 0 };
        };
        let stride = properties.iter().map(size).sum::<usize>();
        let at = properties[..corners].iter().map(size).sum::<usize>();
        // If elements have other lengths, there may be too few bytes for this many triangles. Then none is taken here.
        let Some((bytes, _)) = cursor.peek(list.count, stride) else { return 0 };
        let field = |at: usize, number: Number| {
            NumberField::new(bytes.get(at..), stride, number.size(), order)
        };
        let taken = visitor.triangle_records(&TriangleRecords {
            count: list.count as usize,
            nodes: field(at + length.size(), number),
            min_node: 0,
            node_end: u64::MAX,
            regions: [Region::Same(0); 2],
            required_fields: &[(field(at, length), FieldRule::Is(3))],
        });
        cursor.take(taken * stride);
        taken as u64
    }
}

/// Reads vertices of text whose first properties are x and y, on all threads, as long as they are plain. Returns how
/// many were taken.
fn vertices_of_text(
    cursor: &mut Cursor<'_>,
    list: &List<'_>,
    z: Option<usize>,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> u64 {
    if !visitor.allows_parallel() || visitor.asks_for_data() {
        return 0;
    }
    let count = list.properties.len();
    let nowhere = &Cursor::new(cursor.source);
    let mut id = 0;
    let read = |cursor: &mut Cursor<'_>| {
        let point = cursor.point("a vertex")?;
        let mut height = (0, 0.0);
        for index in 2..count {
            let number = cursor.z("a vertex")?;
            if Some(index) == z {
                height = number;
            }
        }
        Ok((point, height))
    };
    let taken = take_rows(cursor, list.count, read, |((x_at, at), height)| {
        visitor.node(nowhere, id, 2, x_at, at);
        if z.is_some() {
            z_values.push(height);
        }
        id += 1;
        true
    });
    if taken > 0 && taken == list.count {
        cursor.rest();
    }
    taken
}

/// Reads elements of text on all threads, as long as they are triangles. Returns how many were taken.
fn triangles_of_text(cursor: &mut Cursor<'_>, count: u64, visitor: &mut dyn MeshVisitor) -> u64 {
    if !visitor.allows_parallel() || visitor.asks_for_data() {
        return 0;
    }
    let nowhere = &Cursor::new(cursor.source);
    let mut id = 0;
    let read = |cursor: &mut Cursor<'_>| match cursor.integer("the number of corners")? {
        3 => nodes(cursor, CellKind::Triangle),
        _ => Err(cursor.error("no triangle", CORRECT)),
    };
    let taken = take_rows(cursor, count, read, |nodes| {
        let element = Element { id, kind: CellKind::Triangle, region: [0; 2], nodes };
        id += 1;
        visitor.element(nowhere, &element).is_ok()
    });
    if taken > 0 && taken == count {
        cursor.rest();
    }
    taken
}
