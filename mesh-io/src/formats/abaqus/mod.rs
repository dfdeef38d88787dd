//! Input files of Abaqus and CalculiX, `.inp`.
//!
//! The format: the Abaqus Keywords Reference Guide, and G. Dhondt, CalculiX CrunchiX User's Manual. Keywords start with
//! an asterisk, comments with two. Ids of nodes and elements are arbitrary. Vertices of lines, points, quadrilaterals
//! and of element sides in surfaces stay fixed. Regions are the sets that element lists and sections name. Other
//! keywords, such as materials, loads and steps, are not read.

mod blocks;
mod deck;
mod elements;
mod lists;
mod rows;
mod sets;
mod types;
pub(crate) mod write;

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::text::token::quoted;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use blocks::Block;
use deck::Deck;
use elements::ElementGroups;
use rows::LengthCounts;
use sets::{IdPositions, Sets, WorkBudget};

pub(crate) struct Abaqus;

impl FormatReader for Abaqus {
    const VERTICES: &'static str = "*NODE";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let deck = &mut Deck::read(source)?;
        if deck.of_mesh("NODE").next().is_none() {
            let problem = "the file has no *NODE card, so this is no mesh of Abaqus or CalculiX";
            return Err(source.error(problem, "Save the mesh with its nodes and elements"));
        }
        let numbers = CoordinateEncoding::Text { precision: Precision::Text20 };
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::KEYWORDS);
        let mut nodes = Nodes::default();
        nodes.send(cursor.clone(), deck, numbers, visitor)?;
        deck.notes.drain(..).for_each(|note| visitor.remark(Remark::Text(note)));
        let deck = &*deck;
        if visitor.asks_for_data() {
            report_unsupported(deck, visitor);
        }
        let mut sets = Sets::default();
        let lists = lists::lists(source, deck, &mut sets)?;
        let sections: Vec<(&Block<'_>, usize)> = deck.sections().collect();
        let found = ElementGroups::new(source, deck, cursor, &lists, sets, &sections, visitor)?;
        found.send(deck, cursor, &lists, visitor)?;
        if visitor.asks_for_groups() {
            nodes.send_sets(source, deck, visitor)?;
        }
        Ok(CoordinateStorage::in_place(Format::Abaqus, numbers))
    }
}

/// Reports keywords with information beyond the mesh as unsupported.
fn report_unsupported(deck: &Deck<'_>, visitor: &mut dyn MeshVisitor) {
    const MESH_KEYWORDS: [&str; 13] = [
        "HEADING",
        "NODE",
        "ELEMENT",
        "NSET",
        "ELSET",
        "SURFACE",
        "PART",
        "ENDPART",
        "ASSEMBLY",
        "ENDASSEMBLY",
        "INSTANCE",
        "ENDINSTANCE",
        "PREPRINT",
    ];
    let is_other = |block: &&Block<'_>| !MESH_KEYWORDS.iter().any(|keyword| block.is(keyword));
    let mut others = deck.blocks.iter().map(|(block, _)| block).filter(is_other);
    if let Some(first) = others.next() {
        let first = quoted(&first.keyword);
        visitor.unsupported(&match others.count() {
            0 => format!("what *{first} says"),
            more => format!("what *{first} and {more} more keywords say"),
        });
    }
}

/// The node sets of the mesh, with the node ids by which sets list their members.
#[derive(Default)]
struct Nodes {
    sets: Sets,
    /// The id of each node in file order; `None` if the visitor does not ask for groups.
    tags: Option<Vec<u64>>,
}

impl Nodes {
    fn send(
        &mut self,
        mut cursor: Cursor<'_>,
        deck: &Deck<'_>,
        numbers: CoordinateEncoding,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        self.tags = visitor.asks_for_groups().then(Vec::new);
        let mut z_values = ZValues::new(visitor);
        let mut counted = LengthCounts::default();
        for (block, scope) in deck.of_mesh("NODE") {
            let rows = &mut rows::data_rows(&mut cursor, block);
            let before = counted.all;
            let offset = deck.offset(scope);
            rows::send_nodes(rows, offset, visitor, &mut z_values, &mut self.tags, &mut counted)?;
            rows.check_vertex_count(counted.all)?;
            if let (Some(name), true) = (block.name("NSET"), visitor.asks_for_groups()) {
                self.sets.add(scope, name, before as u32..counted.all as u32);
            }
        }
        visitor.end_nodes(&cursor)?;
        if counted.long > 0 {
            let (s, have) = if counted.long == 1 { ("", "has") } else { ("s", "have") };
            let nodes =
                format!("{} node{s} {have} a coordinate of more than 20 characters", counted.long);
            visitor.remark(Remark::Text(format!(
                "{nodes}: CalculiX reads only the first 20 characters, which are another number"
            )));
        }
        z_values.send("z", numbers.into(), visitor);
        Ok(())
    }

    fn send_sets(
        mut self,
        source: &Source,
        deck: &Deck<'_>,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        self.sets.read(source, deck, "NSET");
        let all = IdPositions::new(&self.tags.unwrap_or_default());
        let effort = &mut WorkBudget::of(source);
        for (number, name) in self.sets.named(deck) {
            let nodes = self.sets.members(number, &all, source, effort)?;
            let tag = number as i64 + 1;
            if !nodes.is_empty() {
                visitor.group_name("nset", Some(0), tag, &name);
            }
            nodes
                .into_iter()
                .for_each(|node| visitor.node_group(node, "nset", &GroupLabel::Tag(tag)));
        }
        Ok(())
    }
}
