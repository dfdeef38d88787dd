//! Reads the leading items of PLY lists on all threads. A damaged item, or an item of unusual shape, ends this reading:
//! later items are read one by one.

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
    /// Visits the leading plain vertices. Returns the number of visited vertices: 0 if a property is a list, since
    /// binary vertices then differ in size. `x` and `z` are indices of properties.
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

    /// Visits the leading triangles of a list of elements. Returns the number of visited triangles: 0 unless a single
    /// list property of whole numbers holds all corners.
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
        // If some elements have fewer corners, the list may have fewer bytes than `count` triangles. No triangle is
        // then visited here.
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

/// Visits the leading plain vertices of a text file on all threads. The first two properties must be x and y. Returns
/// the number of visited vertices.
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

/// Visits the leading triangles of a text file on all threads. Returns the number of visited triangles.
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
