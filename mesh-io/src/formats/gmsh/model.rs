//! Names of physical groups, and entities of the model with their physical groups.

use super::encoding::{FileEncoding, Version};
use super::lists::row;
use super::words::{Progress, Words};
use crate::binary::byte_order::ByteOrder;
use crate::content::group_label::GroupLabel;
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::in_quotes;
use crate::visit::items::{CellKind, GroupScope};
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;

/// Reads `$PhysicalNames` after its first line and visits the names. Returns the number of names.
pub(super) fn physical_names(
    cursor: &mut Cursor<'_>,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let count = cursor.integer("the number of physical names")?;
    for done in 0..count {
        row(cursor, done, count, "physical names")?;
        // Version 2.0 has no dimension before the tag.
        let first = cursor.signed("the dimension of a physical group")?;
        let (dimension, tag) = match cursor.is_at(b'"') {
            true => (None, first),
            false => {
                // Volumes have no elements in the mesh, so names of dimension 3 are skipped below.
                let dimension = u8::try_from(first).unwrap_or(u8::MAX);
                (Some(dimension), cursor.signed("the tag of a physical group")?)
            }
        };
        let name = in_quotes(cursor.rest());
        let name = name.ok_or_else(|| cursor.error("a name without quotes", CORRECT))?;
        if dimension.is_none_or(|dimension| dimension <= 2) && !name.is_empty() {
            visitor.group_name("physical", dimension, tag, name);
        }
    }
    Ok(count)
}

/// Entities of the model by dimension and tag. Files have entities from version 4 on.
#[derive(Default)]
pub(super) struct Model {
    entities: HashMap<(u8, i64), Entity>,
}

#[derive(Default)]
struct Entity {
    /// Tag of the entity; for a part of an entity in a partitioned mesh, the tag of the whole entity.
    tag: i64,
    /// Tags of the entity's physical groups.
    physical: Vec<i64>,
}

impl Model {
    /// Returns the groups of the elements of `kind` in an entity block: the entity's physical groups, known only after
    /// `$Entities`, and the entity itself.
    pub(super) fn groups_of(&self, kind: CellKind, entity: i64) -> Vec<GroupScope<'static>> {
        let known = self.entities.get(&(kind.dimension(), entity));
        let within = |what, tag: i64| GroupScope {
            kind: what,
            label: GroupLabel::Tag(tag),
            dimension: None,
        };
        let physical = known.into_iter().flat_map(|entity| &entity.physical);
        let mut groups: Vec<_> = physical.map(|&tag| within("physical", tag)).collect();
        let entity = known.map_or(entity, |entity| entity.tag);
        if entity != 0 {
            groups.push(within("entity", entity));
        }
        groups
    }

    /// Reads `$Entities` or `$PartitionedEntities` after its first line.
    pub(super) fn read(
        &mut self,
        cursor: &mut Cursor<'_>,
        FileEncoding { version, order }: FileEncoding,
        partitioned: bool,
    ) -> Result<(), ReadError> {
        // Points have three coordinates in 4.1. Points in 4.0, and entities of higher dimension, have a bounding box.
        let numbers = |dimension| match (version, dimension) {
            (Version::V41, 0) => 3,
            _ => 6,
        };
        let counts = match order {
            None => text_counts(cursor, partitioned)?,
            Some(order) => binary_counts(cursor, order, partitioned)?,
        };
        for (dimension, count) in (0..).zip(counts) {
            for done in 0..count {
                let progress = Progress::new(done, count, "entities");
                let (tag, entity) = match order {
                    None => {
                        text_entity(cursor, partitioned, dimension, numbers(dimension), progress)?
                    }
                    Some(order) => binary_entity(
                        cursor,
                        order,
                        partitioned,
                        dimension,
                        numbers(dimension),
                        progress,
                    )?,
                };
                self.entities.insert((dimension, tag), entity);
            }
        }
        Ok(())
    }
}

/// Reads the number of entities in each dimension. A partitioned mesh lists its ghost entities before the counts.
fn text_counts(cursor: &mut Cursor<'_>, partitioned: bool) -> Result<[u64; 4], ReadError> {
    if partitioned {
        row(cursor, 0, 1, "numbers of partitions")?;
        row(cursor, 0, 1, "numbers of ghost entities")?;
        let ghosts = cursor.integer("the number of ghost entities")?;
        for done in 0..ghosts {
            row(cursor, done, ghosts, "ghost entities")?;
        }
    }
    row(cursor, 0, 1, "counts")?;
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.integer("a number of entities")?;
    }
    Ok(counts)
}

/// Reads the row of an entity up to its physical groups, without the bounding entities after them. Returns the tag in
/// the file and the entity.
fn text_entity(
    cursor: &mut Cursor<'_>,
    partitioned: bool,
    dimension: u8,
    numbers: usize,
    Progress { done, count, what }: Progress<'_>,
) -> Result<(i64, Entity), ReadError> {
    row(cursor, done, count, what)?;
    let tag = cursor.signed("the tag of an entity")?;
    let mut whole = tag;
    if partitioned {
        let parent_dimension = cursor.signed("the dimension of an entity's parent")?;
        let parent = cursor.signed("the tag of an entity's parent")?;
        whole = whole_of(tag, dimension, parent, parent_dimension);
        for _ in 0..cursor.integer("the number of an entity's partitions")? {
            cursor.signed("a partition")?;
        }
    }
    for _ in 0..numbers {
        cursor.coordinate('x', "an entity")?;
    }
    let mut physical = Vec::new();
    for _ in 0..cursor.integer("the number of an entity's physical groups")? {
        // The sign is the orientation of a curve.
        physical.push(cursor.signed("a physical group")?.saturating_abs());
    }
    Ok((tag, Entity { tag: whole, physical }))
}

/// Returns the tag of the whole entity to which a part belongs: the parent. A new boundary between partitions, whose
/// parent has another dimension, is whole by itself.
fn whole_of(tag: i64, dimension: u8, parent: i64, parent_dimension: i64) -> i64 {
    if parent_dimension == i64::from(dimension) { parent } else { tag }
}

fn binary_counts(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    partitioned: bool,
) -> Result<[u64; 4], ReadError> {
    let progress = Progress::new(0, 1, "counts of entities");
    if partitioned {
        let words = &mut Words::take(cursor, order, 16, progress)?;
        words.size();
        let ghosts = usize::try_from(words.size()).unwrap_or(usize::MAX);
        Words::take(cursor, order, ghosts.saturating_mul(8), progress)?;
    }
    let words = &mut Words::take(cursor, order, 32, progress)?;
    Ok(std::array::from_fn(|_| words.size()))
}

fn binary_entity(
    cursor: &mut Cursor<'_>,
    order: ByteOrder,
    partitioned: bool,
    dimension: u8,
    numbers: usize,
    progress: Progress<'_>,
) -> Result<(i64, Entity), ReadError> {
    let is_point = dimension == 0;
    let int = |cursor: &mut Cursor<'_>| {
        Words::take(cursor, order, 4, progress).map(|mut words| i64::from(words.int()))
    };
    // Reads a count, then as many integers of four bytes.
    let ints = |cursor: &mut Cursor<'_>| {
        let count = Words::take(cursor, order, 8, progress)?.size();
        let bytes = usize::try_from(count).unwrap_or(usize::MAX).saturating_mul(4);
        let mut words = Words::take(cursor, order, bytes, progress)?;
        Ok((0..count).map(|_| i64::from(words.int())).collect::<Vec<_>>())
    };
    let tag = int(cursor)?;
    let mut whole = tag;
    if partitioned {
        let parent_dimension = int(cursor)?;
        let parent = int(cursor)?;
        whole = whole_of(tag, dimension, parent, parent_dimension);
        ints(cursor)?;
    }
    Words::take(cursor, order, 8 * numbers, progress)?;
    let physical = ints(cursor)?.into_iter().map(i64::abs).collect();
    if !is_point {
        // Bounding entities.
        ints(cursor)?;
    }
    Ok((tag, Entity { tag: whole, physical }))
}
