//! Sections of version 2.2 in binary. Counts are text; after them, nodes are single records and elements form blocks of
//! one type.

use super::kind::kind_of;
use super::lists::{block_fits, note_partitions, row};
use super::repeats::{ElementSender, has_equal_neighbors};
use super::text2::columns;
use super::words::{Progress, Words};
use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{FieldRule, NodeIds, NodeRecords, Region, TriangleRecords};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Reads `$Nodes` or `$ParametricNodes` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    parametric: bool,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    const TAG: usize = 4;
    const NODE: usize = TAG + 24;
    row(cursor, 0, 1, "counts")?;
    let count = cursor.vertex_count()?;
    visitor.expect_nodes(cursor.capacity(count, NODE));
    let mut taken = 0;
    if let (false, Some((bytes, start))) = (parametric, cursor.peek(count, NODE)) {
        let field = |at: usize, width| NumberField::new(bytes.get(at..), NODE, width, order);
        let [x, y, z] = [0, 8, 16].map(|axis| field(TAG + axis, 8));
        let (tags, x_at) = (NodeIds::Field(field(0, 4)), start + TAG);
        let count = count as usize;
        if z.all_real(count, f64::is_finite) {
            taken = visitor.node_records(&NodeRecords { count, x, y, x_offset: x_at, ids: tags });
            z_values.push_records(z, taken, start + TAG + 16);
            cursor.take(taken * NODE);
        }
    }
    for done in taken as u64..count {
        let progress = Progress::new(done, count, "nodes");
        let words = &mut Words::take(cursor, order, NODE, progress)?;
        let tag = words.natural(cursor, "a node tag")?;
        let [x, y, z] = words.point(cursor, tag)?;
        visitor.node(cursor, tag, 2, cursor.last_taken() + TAG, [x, y]);
        z_values.push((cursor.last_taken() + TAG + 16, z));
        if parametric {
            // The dimension of the node's entity, the entity's tag, and a parameter for each dimension.
            let entity = &mut Words::take(cursor, order, 8, progress)?;
            let parameters = match entity.int() {
                1 => 8,
                2 => 16,
                _ => 0,
            };
            Words::take(cursor, order, parameters, progress)?;
        }
    }
    Ok(count)
}

/// Reads `$Elements` after its first line. Returns the number of elements.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    const HEADER: usize = 12;
    row(cursor, 0, 1, "counts")?;
    let count = cursor.integer("the number of elements")?;
    visitor.expect_elements(cursor.capacity(count, 16));
    visitor.region_attributes(columns());
    let mut done = 0;
    let mut elements = ElementSender::default();
    while done < count {
        let progress = Progress::new(done, count, "elements");
        let words = &mut Words::take(cursor, order, HEADER, progress)?;
        let kind = words.natural(cursor, "the type of elements")?;
        let kind = kind_of(cursor, kind)?;
        let size = words.natural(cursor, "a number of elements")?;
        block_fits(cursor, size, count - done, "elements")?;
        let groups = words.natural(cursor, "the number of an element's tags")? as usize;
        let bytes = groups.saturating_add(1 + kind.nodes()).saturating_mul(4);
        let mut taken = 0;
        let nodes_at = 4 * groups.saturating_add(1);
        if let (CellKind::Triangle, Some((block, _))) = (kind, cursor.peek(size, bytes))
            && !has_equal_neighbors(block, bytes, nodes_at, bytes)
        {
            let field = |at: usize| NumberField::new(block.get(4 * at..), bytes, 4, order);
            let region = |column: usize| match column < groups {
                true => Region::Field(field(1 + column)),
                false => Region::Same(0),
            };
            taken = visitor.triangle_records(&TriangleRecords {
                count: size as usize,
                nodes: field(1 + groups),
                min_node: 0,
                node_end: u64::MAX,
                regions: [region(0), region(1)],
                required_fields: &[(field(0), FieldRule::Natural)],
            });
            cursor.take(taken * bytes);
            if taken > 0 {
                elements.forget();
            }
        }
        for at in taken as u64..size {
            let progress = Progress::new(done + at, count, "elements");
            let words = &mut Words::take(cursor, order, bytes, progress)?;
            let tag = words.natural(cursor, "an element tag")?;
            let mut region = [0; 2];
            region[..groups.min(2)].fill_with(|| i64::from(words.int()));
            // Tags after the second list mesh partitions, or have zeros.
            let mut has_partitions = false;
            (2..groups).for_each(|_| has_partitions |= words.int() != 0);
            if has_partitions {
                note_partitions(visitor);
            }
            let mut nodes = [0; 4];
            for node in &mut nodes[..kind.nodes()] {
                *node = words.natural(cursor, format_args!("a node of element {tag}"))?;
            }
            elements.send(cursor, visitor, &Element { id: tag, kind, region, nodes })?;
        }
        done += size;
    }
    Ok(count)
}
