//! Input files of Abaqus and CalculiX, `.inp`.
//!
//! The format: the Abaqus Keywords Reference Guide, and G. Dhondt, CalculiX CrunchiX User's Manual. Keywords start with an
//! asterisk, comments with two. Numbers of nodes and elements are arbitrary. Lines, points and quadrilaterals stay fixed, and
//! so do sides of elements in surfaces. Regions are the sets that lists of elements name, and those of sections. Other
//! keywords, such as those of materials, loads and steps, are not read.

mod blocks;
mod deck;
mod elements;
mod rows;
mod sets;
mod types;
pub(crate) mod write;

use crate::content::label::Label;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::Numbers;
use crate::error::ReadError;
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::text::token::quoted;
use crate::visit::heights::Heights;
use crate::visit::sink::{Kind, Layout, Sink, Walk, volume};
use blocks::Block;
use deck::Deck;
use elements::Found;
use rows::Counted;
use sets::{Effort, Numbered, Sets};
use types::Class;

pub(crate) struct Abaqus;

/// A list of elements of one type.
struct List<'d, 'a> {
    block: &'d Block<'a>,
    /// The type, in capital letters.
    of: Vec<u8>,
    /// `None` for elements that only hold their nodes.
    kind: Option<Kind>,
    /// The number of the set that the list names, counted from 1; 0 if it names none.
    set: i64,
    of_assembly: bool,
}

impl Walk for Abaqus {
    const VERTICES: &'static str = "*NODE";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let deck = &mut Deck::read(source)?;
        if deck.of_mesh("NODE").next().is_none() {
            let problem = "it has no *NODE, so it is no mesh of Abaqus or CalculiX";
            return Err(source.error(problem, "Save the mesh with its nodes and elements"));
        }
        let numbers = Numbers::Text { precision: Precision::Text20 };
        let cursor = &mut Cursor::new(source).of(Syntax::KEYWORDS);
        let mut nodes = Nodes::default();
        nodes.send(cursor.clone(), deck, numbers, sink)?;
        deck.notes.drain(..).for_each(|note| sink.remark(Remark::Text(note)));
        let deck = &*deck;
        if sink.asks_for_data() {
            leave_out(deck, sink);
        }
        let mut sets = Sets::default();
        let lists = lists(source, deck, &mut sets)?;
        let sections: Vec<&Block<'_>> = sections(deck).collect();
        let found = Found::new((source, deck), cursor, (&lists, sets, &sections), sink)?;
        found.send(deck, cursor, &lists, sink)?;
        if sink.asks_for_groups() {
            nodes.send_sets(source, deck, sink)?;
        }
        Ok(Layout::in_place(Format::Abaqus, numbers))
    }
}

/// Lists the blocks that give elements of the mesh a material.
fn sections<'d, 'a>(deck: &'d Deck<'a>) -> impl Iterator<Item = &'d Block<'a>> {
    let own =
        deck.blocks.iter().filter(|(block, scope)| *scope == deck.mesh && deck::is_section(block));
    own.map(|(block, _)| block)
}

/// Tells of keywords that say more than what a mesh is.
fn leave_out(deck: &Deck<'_>, sink: &mut dyn Sink) {
    const OF_MESHES: [&str; 13] = [
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
    let is_other = |block: &&Block<'_>| !OF_MESHES.iter().any(|keyword| block.is(keyword));
    let mut others = deck.blocks.iter().map(|(block, _)| block).filter(is_other);
    if let Some(first) = others.next() {
        let first = quoted(&first.keyword);
        sink.leaves_out(&match others.count() {
            0 => format!("what *{first} says"),
            more => format!("what *{first} and {more} more keywords say"),
        });
    }
}

/// Lists the elements of the mesh, and checks their types.
fn lists<'d, 'a>(
    source: &Source,
    deck: &'d Deck<'a>,
    sets: &mut Sets,
) -> Result<Vec<List<'d, 'a>>, ReadError> {
    let mut lists = Vec::new();
    for block in deck.of_mesh("ELEMENT") {
        let of = block.parameter("TYPE").unwrap_or_default().to_ascii_uppercase();
        let kind = class(source, block, &of)?;
        let set = block.name("ELSET").map_or(0, |name| sets.number(false, name) as i64 + 1);
        lists.push(List { block, of, kind, set, of_assembly: false });
    }
    for block in deck.of_assembly("ELEMENT") {
        let of = block.parameter("TYPE").unwrap_or_default().to_ascii_uppercase();
        if matches!(class(source, block, &of)?, Some(Kind::Triangle | Kind::Quadrilateral)) {
            let problem = "an assembly has elements of its own beside those of a part";
            let remedy = "Write the input file without parts and assemblies";
            return Err(block.error(source, problem, remedy));
        }
        lists.push(List { block, of, kind: None, set: 0, of_assembly: true });
    }
    Ok(lists)
}

/// Returns the kind of the elements of a type; `None` if they only hold their nodes.
fn class(source: &Source, block: &Block<'_>, of: &[u8]) -> Result<Option<Kind>, ReadError> {
    let shown = quoted(of);
    match types::class(of) {
        Some(Class::Is(kind)) => Ok(Some(kind)),
        Some(Class::Held) => Ok(None),
        Some(Class::Volume) => {
            let cursor = Cursor::standing_at(source, block.at);
            Err(volume(&cursor, &format!("elements of the type {shown}")))
        }
        Some(Class::SecondOrder) => {
            let problem = format!(
                "elements of the type {shown} have nodes on their sides, which are not read"
            );
            Err(block.error(source, problem, "Save linear elements (CPS3, CPE3, CAX3, S3)"))
        }
        None if of.is_empty() => {
            Err(block.error(source, "*ELEMENT has no TYPE", "Name the type of the elements"))
        }
        None => {
            let problem = format!("the type of elements {shown} is not known");
            let remedy =
                "Triangles such as CPS3, CPE3, CAX3 and S3 are read, beside CPS4, B21 and T2D2";
            Err(block.error(source, problem, remedy))
        }
    }
}

/// The nodes of the mesh, and their sets.
#[derive(Default)]
struct Nodes {
    sets: Sets,
    /// The number of each node, if sets are asked for.
    tags: Option<Vec<u64>>,
}

impl Nodes {
    fn send(
        &mut self,
        mut cursor: Cursor<'_>,
        deck: &Deck<'_>,
        numbers: Numbers,
        sink: &mut dyn Sink,
    ) -> Result<(), ReadError> {
        self.tags = sink.asks_for_groups().then(Vec::new);
        let mut heights = Heights::new(sink);
        let mut counted = Counted::default();
        for block in deck.of_mesh("NODE") {
            let rows = &mut rows::of(&mut cursor, block);
            let before = counted.all;
            rows::send_nodes(rows, sink, &mut heights, &mut self.tags, &mut counted)?;
            rows.check_vertex_count(counted.all)?;
            if let (Some(name), true) = (block.name("NSET"), sink.asks_for_groups()) {
                self.sets.add(name, before as u32..counted.all as u32);
            }
        }
        sink.end_nodes(&cursor)?;
        if counted.long > 0 {
            let (s, have) = if counted.long == 1 { ("", "has") } else { ("s", "have") };
            let nodes =
                format!("{} node{s} {have} a coordinate of more than 20 characters", counted.long);
            sink.remark(Remark::Text(format!(
                "{nodes}: CalculiX reads the first 20 only, and so another number"
            )));
        }
        heights.send("z", numbers.into(), sink);
        Ok(())
    }

    fn send_sets(
        mut self,
        source: &Source,
        deck: &Deck<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), ReadError> {
        self.sets.read(source, deck, "NSET");
        let all = Numbered::new(&self.tags.unwrap_or_default());
        let effort = &mut Effort::of(source);
        for (number, name) in self.sets.named() {
            let nodes = self.sets.members(number, &all, (source, effort))?;
            let tag = number as i64 + 1;
            if !nodes.is_empty() {
                sink.name("nset", Some(0), tag, &name);
            }
            nodes.into_iter().for_each(|node| sink.node_within(node, "nset", &Label::Tag(tag)));
        }
        Ok(())
    }
}
