//! The element lists of the mesh (`*ELEMENT`), each with one element type.

use super::blocks::Block;
use super::deck::{ASSEMBLY, Deck};
use super::sets::Sets;
use super::types::{self, Class};
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::token::quoted;
use crate::visit::items::CellKind;
use crate::visit::rows::volume;

/// An `*ELEMENT` block, whose elements have the same type.
pub(super) struct List<'d, 'a> {
    pub(super) block: &'d Block<'a>,
    /// The scope of the block.
    pub(super) scope: usize,
    /// The type, in capital letters.
    pub(super) of: Vec<u8>,
    /// The kind of cell; `None` if the elements only constrain their nodes, as masses, springs and all elements of an
    /// assembly do.
    pub(super) kind: Option<CellKind>,
    /// The number of the set that the list names by `ELSET`, counted from 1; 0 if the list names no set.
    pub(super) set: i64,
}

/// Returns the element lists of the mesh, then of the assembly.
///
/// # Errors
/// If an element type is unknown, of second order or of a volume, or if the assembly has its own triangles or
/// quadrilaterals.
pub(super) fn lists<'d, 'a>(
    source: &Source,
    deck: &'d Deck<'a>,
    sets: &mut Sets,
) -> Result<Vec<List<'d, 'a>>, ReadError> {
    let mut lists = Vec::new();
    for (block, scope) in deck.of_mesh("ELEMENT") {
        let of = block.parameter("TYPE").unwrap_or_default().to_ascii_uppercase();
        let kind = class(source, block, &of)?;
        let set = block.name("ELSET").map_or(0, |name| sets.number(scope, name) as i64 + 1);
        lists.push(List { block, scope, of, kind, set });
    }
    for block in deck.of_assembly("ELEMENT") {
        let of = block.parameter("TYPE").unwrap_or_default().to_ascii_uppercase();
        if matches!(class(source, block, &of)?, Some(CellKind::Triangle | CellKind::Quadrilateral))
        {
            let problem = "an assembly has elements in addition to the elements of a part";
            let remedy = "Write the input file without parts and assemblies";
            return Err(block.error(source, problem, remedy));
        }
        lists.push(List { block, scope: ASSEMBLY, of, kind: None, set: 0 });
    }
    Ok(lists)
}

/// Returns the kind of cell of the element type `of`; `None` if the elements only constrain their nodes.
///
/// # Errors
/// If the type is missing, unknown, of second order or of a volume.
fn class(source: &Source, block: &Block<'_>, of: &[u8]) -> Result<Option<CellKind>, ReadError> {
    let shown = quoted(of);
    match types::class(of) {
        Some(Class::Of(kind)) => Ok(Some(kind)),
        Some(Class::Constraining) => Ok(None),
        Some(Class::Volume) => {
            let cursor = Cursor::on_line_of(source, block.at);
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
