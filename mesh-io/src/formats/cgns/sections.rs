//! The element sections of a zone.

use super::boundaries::Boundaries;
use super::file::{File, labeled};
use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::binary::number_field::NumberField;
use crate::content::group_label::GroupLabel;
use crate::error::ReadError;
use crate::hdf5::{DatasetArray, Datatype, Object};
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::records::Region;
use crate::visit::rows::volume;
use crate::visit::send::ElementRecords;
use crate::visit::visitor::MeshVisitor;

/// Type number of a section with several element types, in which a type number precedes the nodes of each element.
const MIXED: i64 = 20;

/// An element section.
struct Section<'n, 'a> {
    name: &'n [u8],
    object: &'a Object,
    /// Position of the section, from 1, in the order of element numbers; also the tag of its group.
    number: i64,
    /// Number of the first element.
    first: u64,
    /// Number of elements, from the announced range.
    count: usize,
}

/// Connectivity of a section: integers of `size` bytes.
struct Nodes<'a> {
    array: DatasetArray<'a>,
    size: usize,
    order: ByteOrder,
}

impl Nodes<'_> {
    fn at(&self, index: usize) -> Option<u64> {
        let start = index.checked_mul(self.size)?;
        Some(self.order.whole(self.array.bytes.get(start..start + self.size)?))
    }
}

impl<'a> File<'a> {
    /// Visits the elements of all sections, in the order of element numbers.
    ///
    /// # Errors
    /// If a section does not hold the elements that its range announces, or has element types that cannot be read.
    pub(super) fn sections(
        &self,
        boundaries: &Boundaries,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let label = |section| Some(GroupLabel::Tag(section));
        visitor.region_attributes(vec![RegionAttribute {
            kind: "section".into(),
            from_dimension: 0,
            label,
        }]);
        let mut sections: Vec<_> = labeled(self.hdf5, self.zone, b"Elements_t")
            .into_iter()
            .map(|(name, section)| {
                let range =
                    self.hdf5.child(section, b"ElementRange").and_then(|own| self.integers(own));
                (range.unwrap_or_default(), name, section)
            })
            .collect();
        sections.sort_by_key(|(range, ..)| range.first().copied());
        for ((range, name, section), number) in sections.into_iter().zip(1..) {
            if visitor.asks_for_groups() {
                visitor.group_name("section", None, number, name);
            }
            let &[first, last] = &range[..] else {
                return Err(self.damaged(name, section));
            };
            let count = last.checked_sub(first).and_then(|more| usize::try_from(more).ok());
            let first = u64::try_from(first).ok();
            let (Some(first), Some(count)) = (first, count.map(|more| more.saturating_add(1)))
            else {
                return Err(self.damaged(name, section));
            };
            let section = Section { name, object: section, number, first, count };
            self.section(&section, boundaries, visitor)?;
        }
        visitor.group_scopes(&[]);
        Ok(())
    }

    #[cold]
    fn damaged(&self, name: &[u8], section: &'a Object) -> ReadError {
        let problem =
            format!("the section {} does not hold the elements that it announces", quoted(name));
        self.cursor(section).error(problem, CORRECT)
    }

    fn section(
        &self,
        of: &Section<'_, 'a>,
        boundaries: &Boundaries,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let &Section { name, object: section, number, first, count } = of;
        let damaged = || self.damaged(name, section);
        let own = self.hdf5.child(section, b"ElementConnectivity").and_then(|own| self.data(own));
        let dataset =
            own.map(|own| self.hdf5.dataset(own)).transpose()?.flatten().ok_or_else(damaged)?;
        let Datatype::Whole(IntegerType { bytes: size, .. }, order) = dataset.datatype else {
            return Err(damaged());
        };
        let array = self.hdf5.array(&dataset)?;
        let nodes = Nodes { array, size, order };
        let of_all = self.integers(section).and_then(|numbers| numbers.first().copied());
        let of_all = of_all.ok_or_else(damaged)?;
        let length = nodes.array.bytes.len() / size;
        let place = |at: usize| Cursor::at_byte_offset(self.source, nodes.array.byte_of(at * size));
        if of_all != MIXED {
            let kind = self.kind(of_all, section)?;
            if count.checked_mul(kind.nodes()) != Some(length) {
                return Err(damaged());
            }
            let elements = ElementRecords {
                kind,
                count,
                first_tag: first,
                nodes: NumberField::new(Some(&nodes.array.bytes), kind.nodes() * size, size, order),
                is_signed: false,
                regions: [Region::Same(number), Region::Same(0)],
            };
            return elements.send(visitor, |index, visitor| {
                boundaries.of_element(first.saturating_add(index as u64), visitor);
                place(index * kind.nodes())
            });
        }
        let mut at = 0;
        for element in 0..count {
            let start = at;
            at += 1;
            let own = nodes.at(start).ok_or_else(damaged)?;
            let kind = self.kind(i64::try_from(own).unwrap_or(0), section)?;
            let mut corners = [0; 4];
            for corner in &mut corners[..kind.nodes()] {
                *corner = nodes.at(at).ok_or_else(damaged)?;
                at += 1;
            }
            let id = first.saturating_add(element as u64);
            boundaries.of_element(id, visitor);
            let element = Element { id, kind, region: [number, 0], nodes: corners };
            visitor.element(&place(start), &element)?;
        }
        match at == length {
            true => Ok(()),
            false => Err(damaged()),
        }
    }

    fn kind(&self, number: i64, section: &'a Object) -> Result<CellKind, ReadError> {
        let cursor = self.cursor(section);
        match number {
            2 => Ok(CellKind::Point),
            3 => Ok(CellKind::Line),
            5 => Ok(CellKind::Triangle),
            7 => Ok(CellKind::Quadrilateral),
            10..=19 | 23 => Err(volume(&cursor, &format!("elements of the type {number}"))),
            _ => {
                let problem = format!("elements of the type {number} are not read");
                let remedy = "Save triangles of three nodes (TRI_3), beside BAR_2 and QUAD_4";
                Err(cursor.error(problem, remedy))
            }
        }
    }
}
