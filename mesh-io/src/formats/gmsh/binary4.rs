//! Sections of version 4.1 in binary, and the elements of 4.0. Nodes and elements form blocks, a block for each entity
//! of the model.

use super::encoding::{Version, form};
use super::kind::kind_of;
use super::lists::{all_in_blocks, block_fits, has_parameters};
use super::model::Model;
use super::words::{Progress, Words};
use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::edit::numbers::Offsets;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, PointNumbers};
use crate::visit::records::{FieldRule, NodeIds, NodeRecords, Region, TriangleRecords};
use crate::visit::storage::ArrayLocation;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Size of a block header in bytes: three `int`, and a `size_t` (in 4.0 an `unsigned long`).
pub(super) const BLOCK_HEADER: usize = 20;

/// Reads `$Nodes` after its first line. Returns the number of nodes.
pub(super) fn nodes(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let [blocks, count] = counts(cursor, Version::V41, order)?;
    cursor.check_vertex_count(count)?;
    visitor.expect_nodes(cursor.capacity(count, 32));
    let mut done = 0;
    for block in 0..blocks {
        let progress = Progress::new(block, blocks, "node blocks");
        let words = &mut Words::take(cursor, order, BLOCK_HEADER, progress)?;
        let dimension = words.natural(cursor, "the dimension of a node block")?;
        let entity = i64::from(words.int());
        let parametric = words.int() != 0;
        let wanted = parametric && dimension == 2 && has_parameters(visitor, entity);
        let size = words.size();
        block_fits(cursor, size, count - done, "nodes")?;
        let progress = Progress::new(done, count, "nodes");
        let tags = &mut Words::take(cursor, order, (size as usize).saturating_mul(8), progress)?;
        let parameters = if parametric { dimension.min(3) as usize } else { 0 };
        let (mut own, mut places, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
        let record = 8 * (3 + parameters);
        let mut taken = 0;
        if let (2.., false, Some((bytes, x_at))) = (dimension, wanted, cursor.peek(size, record)) {
            let [x, y, z] =
                [0, 8, 16].map(|at| NumberField::new(bytes.get(at..), record, 8, order));
            let count = size as usize;
            if z.all_real(count, f64::is_finite) {
                let tags = NodeIds::Field(NumberField::new(Some(tags.left()), 8, 8, order));
                taken =
                    visitor.node_records(&NodeRecords { count, x, y, x_offset: x_at, ids: tags });
                z_values.push_records(z, taken, x_at + 16);
            }
            tags.skip(8 * taken);
            cursor.take(taken * record);
        }
        for at in taken as u64..size {
            let progress = Progress::new(done + at, count, "nodes");
            let words = &mut Words::take(cursor, order, record, progress)?;
            let tag = tags.size();
            let [x, y, z] = words.point(cursor, tag)?;
            visitor.node(cursor, tag, dimension, cursor.last_taken(), [x, y]);
            z_values.push((cursor.last_taken() + 16, z));
            if wanted {
                own.push(tag);
                places.extend([24, 32].map(|after| cursor.last_taken() + after));
                numbers.extend([words.double(), words.double()]);
            }
        }
        if wanted {
            let stored = ArrayLocation::in_place(Offsets::List(places), form(Some(order)));
            visitor.parameter_numbers(PointNumbers { numbers, nodes: Some(own), location: stored });
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "nodes")?;
    Ok(count)
}

/// Reads `$Elements` of version 4.0 or 4.1 after its first line. Returns the number of elements.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    version: Version,
    order: ByteOrder,
    model: &Model,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let [blocks, count] = counts(cursor, version, order)?;
    let tag_bytes = if version == Version::V40 { 4 } else { 8 };
    visitor.expect_elements(cursor.capacity(count, 4 * tag_bytes));
    let mut done = 0;
    for block in 0..blocks {
        let progress = Progress::new(block, blocks, "element blocks");
        let words = &mut Words::take(cursor, order, BLOCK_HEADER, progress)?;
        // The entity's tag comes first in 4.0, the entity's dimension in 4.1.
        let [first, second] = [words.int(), words.int()];
        let entity = if version == Version::V40 { first } else { second };
        let region = [i64::from(entity), 0];
        let kind = words.natural(cursor, "the type of an element block")?;
        let kind = kind_of(cursor, kind)?;
        visitor.group_scopes(&model.groups_of(kind, region[0]));
        let size = words.size();
        block_fits(cursor, size, count - done, "elements")?;
        let row = tag_bytes * (1 + kind.nodes());
        let mut taken = 0;
        if let (CellKind::Triangle, Some((bytes, _))) = (kind, cursor.peek(size, row)) {
            let field = |at: usize| NumberField::new(bytes.get(at..), row, tag_bytes, order);
            let natural = [(field(0), FieldRule::Natural)];
            taken = visitor.triangle_records(&TriangleRecords {
                count: size as usize,
                nodes: field(tag_bytes),
                min_node: 0,
                node_end: u64::MAX,
                regions: region.map(Region::Same),
                required_fields: if version == Version::V40 { &natural } else { &[] },
            });
            cursor.take(taken * row);
        }
        for at in taken as u64..size {
            let progress = Progress::new(done + at, count, "elements");
            let words = &mut Words::take(cursor, order, row, progress)?;
            let mut nodes = [0; 4];
            let tag = if version == Version::V40 {
                let tag = words.natural(cursor, "an element tag")?;
                for node in &mut nodes[..kind.nodes()] {
                    *node = words.natural(cursor, format_args!("a node of element {tag}"))?;
                }
                tag
            } else {
                let tag = words.size();
                nodes[..kind.nodes()].fill_with(|| words.size());
                tag
            };
            visitor.element(cursor, &Element { id: tag, kind, region, nodes })?;
        }
        done += size;
    }
    all_in_blocks(cursor, done, count, "elements")?;
    Ok(count)
}

/// Reads the counts at the start of a section: blocks, and nodes or elements in all blocks together.
pub(super) fn counts(
    cursor: &mut Cursor<'_>,
    version: Version,
    order: ByteOrder,
) -> Result<[u64; 2], ReadError> {
    // In 4.1, the smallest and largest tag follow.
    let bytes = if version == Version::V40 { 16 } else { 32 };
    let progress = Progress::new(0, 1, "counts");
    let words = &mut Words::take(cursor, order, bytes, progress)?;
    Ok([words.size(), words.size()])
}
