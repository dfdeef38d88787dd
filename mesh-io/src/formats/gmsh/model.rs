//! The names of physical groups, and the entities of the model with their physical groups.

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

/// Reads `$PhysicalNames` after its first line and hands on the names. Returns how many there are.
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
                // Groups of volumes belong to no element of the mesh.
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

/// The entities of the model, which the format has from version 4 on.
#[derive(Default)]
pub(super) struct Model {
    entities: HashMap<(u8, i64), Entity>,
}

#[derive(Default)]
struct Entity {
    /// The entity's tag. In a partitioned mesh it is the tag of the whole entity that this one is part of.
    tag: i64,
    physical: Vec<i64>,
}

impl Model {
    /// Returns the groups of an entity's elements. Physical groups are known only after `$Entities` was read.
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

    /// Reads `$Entities` after its first line, or `$PartitionedEntities`.
    pub(super) fn read(
        &mut self,
        cursor: &mut Cursor<'_>,
        FileEncoding { version, order }: FileEncoding,
        partitioned: bool,
    ) -> Result<(), ReadError> {
        // A point has three coordinates in 4.1. All other entities, and points in 4.0, have a bounding box.
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

/// Reads the number of entities of each dimension.
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

/// Reads the row of an entity up to its physical groups. The bounding entities that follow are left.
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
        // The sign gives the direction of a curve.
        physical.push(cursor.signed("a physical group")?.saturating_abs());
    }
    Ok((tag, Entity { tag: whole, physical }))
}

/// Returns the entity that a part belongs to. This is its parent, unless the part is a new boundary between partitions.
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
    // Reads a count, and as many numbers of four bytes.
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
        // The bounding entities.
        ints(cursor)?;
    }
    Ok((tag, Entity { tag: whole, physical }))
}
