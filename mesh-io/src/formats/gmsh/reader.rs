//! Reads the sections of a file in order, each by its version and encoding.

use super::encoding::{FileEncoding, Version, form};
use super::lists::{note_parameters, note_partitions, row};
use super::model::Model;
use super::{
    binary2, binary4, binary40, data, ghosts, model, periodic, text2, text4, text40, words,
};
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::{Location, ReadError};
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{float, quoted};
use crate::visit::ghosts::GhostNodes;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Reader of gmsh's `.msh`.
pub(crate) struct Gmsh;

impl FormatReader for Gmsh {
    const VERTICES: &'static str = "$Nodes";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let FileEncoding { version, order } = visit_sections(source, visitor)?;
        let format = match (version, order) {
            (Version::V1, _) => Format::Gmsh1,
            (Version::V2, None) => Format::Gmsh22,
            (Version::V2, Some(_)) => Format::Gmsh22Binary,
            (Version::V40, None) => Format::Gmsh40,
            (Version::V40, Some(_)) => Format::Gmsh40Binary,
            (Version::V41, None) => Format::Gmsh41,
            (Version::V41, Some(_)) => Format::Gmsh41Binary,
        };
        let numbers = match order {
            None => CoordinateEncoding::TEXT,
            Some(order) => CoordinateEncoding::adjacent(order, Precision::Double),
        };
        Ok(CoordinateStorage::in_place(format, numbers))
    }
}

/// Visits the nodes, elements and data of a file, and on request groups and periodic pairs. Returns version and byte
/// order.
///
/// # Errors
/// If a section that the mesh needs is missing, repeated or damaged, or out of order.
fn visit_sections(
    source: &Source,
    visitor: &mut dyn MeshVisitor,
) -> Result<FileEncoding, ReadError> {
    let cursor = &mut Cursor::new(source);
    let mut encoding = None;
    let (mut nodes, mut elements) = (false, false);
    let mut node_count = 0;
    let mut model = Model::default();
    // The place of the elements, for a second reading.
    let mut elements_at = None;
    while cursor.next_row() {
        // gmsh ignores text between sections.
        let Some(name) = cursor.token().and_then(|token| token.strip_prefix(b"$")) else {
            continue;
        };
        let opened = cursor.location();
        match name {
            b"MeshFormat" => {
                encoding = Some(mesh_format(cursor)?);
                end_of_section(cursor, "MeshFormat", opened, "one line")?;
            }
            b"Nodes" | b"ParametricNodes" | b"NOD" => {
                once(cursor, &mut nodes, name)?;
                if name == b"NOD" {
                    encoding = Some(FileEncoding { version: Version::V1, order: None });
                }
                let FileEncoding { version, order } = known(cursor, encoding)?;
                let parametric = name == b"ParametricNodes";
                if parametric {
                    note_parameters(visitor);
                }
                let mut seen = ZValues::new(visitor);
                let z_values = &mut seen;
                let count = match (version, order) {
                    (Version::V1, _) | (Version::V2, None) => {
                        text2::nodes(cursor, z_values, visitor)?
                    }
                    (Version::V40, None) => text40::nodes(cursor, z_values, visitor)?,
                    (Version::V40, Some(order)) => {
                        binary40::nodes(cursor, order, z_values, visitor)?
                    }
                    (Version::V41, None) => text4::nodes(cursor, z_values, visitor)?,
                    (Version::V2, Some(order)) => {
                        binary2::nodes(cursor, order, parametric, z_values, visitor)?
                    }
                    (Version::V41, Some(order)) => {
                        binary4::nodes(cursor, order, z_values, visitor)?
                    }
                };
                node_count = count;
                let name = str::from_utf8(name).unwrap_or_default();
                end_of_section(cursor, name, opened, &format!("{count} nodes"))?;
                cursor.syntax = Syntax::PLAIN;
                visitor.end_nodes(cursor)?;
                seen.send("z", form(order), visitor);
            }
            b"Elements" | b"ELM" => {
                once(cursor, &mut elements, name)?;
                let name = str::from_utf8(name).unwrap_or_default();
                if !nodes {
                    let problem = format!("${name} stands before the nodes");
                    return Err(cursor.error(problem, "Put the nodes first, as gmsh does"));
                }
                elements_at = Some(cursor.clone());
                let count = read_elements(cursor, known(cursor, encoding)?, &model, visitor)?;
                end_of_section(cursor, name, opened, &format!("{count} elements"))?;
                cursor.syntax = Syntax::PLAIN;
            }
            b"PhysicalNames" if visitor.asks_for_groups() => {
                let count = model::physical_names(cursor, visitor)?;
                end_of_section(cursor, "PhysicalNames", opened, &format!("{count} names"))?;
            }
            b"Entities" | b"PartitionedEntities" if visitor.asks_for_groups() => {
                let partitioned = name == b"PartitionedEntities";
                if partitioned {
                    note_partitions(visitor);
                }
                model.read(cursor, known(cursor, encoding)?, partitioned)?;
                let name = str::from_utf8(name).unwrap_or_default();
                end_of_section(cursor, name, opened, "entities")?;
            }
            b"GhostElements" if visitor.asks_for_ghosts() => {
                let encoding = known(cursor, encoding)?;
                match (ghosts::read(cursor, encoding), &elements_at) {
                    (Some(ids), Some(at)) => GhostNodes::of(ids).send(visitor, |visitor| {
                        read_elements(&mut at.clone(), encoding, &model, visitor).map(drop)
                    })?,
                    _ => visitor.remark(Remark::Text(
                        "the list of ghost elements cannot be read, so their vertices are not held"
                            .into(),
                    )),
                }
                skip_section(cursor, name, opened)?;
            }
            b"NodeData" | b"ElementData" => {
                let order = known(cursor, encoding)?.order;
                let nodes = (name == b"NodeData").then_some(node_count);
                data::read(cursor, nodes, order, visitor);
                skip_section(cursor, name, opened)?;
            }
            name if name.starts_with(b"End") || name.starts_with(b"END") => {
                let problem = format!("${} ends a section that never began", quoted(name));
                return Err(cursor.error(problem, "Remove the line, or save the mesh again"));
            }
            name => {
                let is_periodic = name == b"Periodic" && visitor.asks_for_periodic_pairs();
                if is_periodic {
                    visitor.periodic_pairs(
                        encoding.and_then(|encoding| periodic::read(cursor, encoding)),
                    );
                }
                let is_told =
                    is_periodic || matches!(name, b"Comments" | b"PhysicalNames" | b"Entities");
                if visitor.asks_for_data() && !is_told {
                    visitor.unsupported(&format!("the section ${}", quoted(name)));
                }
                skip_section(cursor, name, opened)?;
            }
        }
    }
    let missing = if !nodes { "$Nodes" } else { "$Elements" };
    match encoding {
        Some(encoding) if nodes && elements => Ok(encoding),
        _ => Err(source.error(
            format!("it has no {missing} section"),
            "The file is incomplete, or was saved without a mesh: save it again",
        )),
    }
}

/// Visits all elements of `$Elements`, after its first line. Returns their number.
fn read_elements<'a>(
    cursor: &mut Cursor<'a>,
    FileEncoding { version, order }: FileEncoding,
    model: &Model,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    match (version, order) {
        (Version::V1, _) | (Version::V2, None) => text2::elements(cursor, version, visitor),
        (Version::V40 | Version::V41, None) => text4::elements(cursor, version, model, visitor),
        (Version::V2, Some(order)) => binary2::elements(cursor, order, visitor),
        (Version::V40 | Version::V41, Some(order)) => {
            binary4::elements(cursor, version, order, model, visitor)
        }
    }
}

/// Reads `$MeshFormat` after its first line: version, and the byte order of a binary file.
fn mesh_format(cursor: &mut Cursor<'_>) -> Result<FileEncoding, ReadError> {
    row(cursor, 0, 1, "format lines")?;
    let name = cursor.token().unwrap_or_default();
    // gmsh reads the version as a number, and some programs write `2.200000`.
    let version = match float(name) {
        Some(number) if (2.0..=2.2).contains(&number) => Version::V2,
        Some(4.0) => Version::V40,
        Some(4.1) => Version::V41,
        _ => {
            let problem = format!("gmsh's format version {} is not read", quoted(name));
            let remedy = "Save as version 4.1 or 2.2 (gmsh old.msh -save -format msh41 -o new.msh)";
            return Err(cursor.error(problem, remedy));
        }
    };
    match cursor.integer("the file type")? {
        0 => Ok(FileEncoding { version, order: None }),
        1 => match cursor.integer("the size of a number")? {
            8 => Ok(FileEncoding { version, order: Some(words::byte_order(cursor)?) }),
            size => {
                let problem =
                    format!("its numbers have {size} bytes, and only those of 8 are read");
                Err(cursor.error(problem, "Save as ASCII (Mesh.Binary=0)"))
            }
        },
        other => {
            let problem = format!("the file type is {other}, neither 0 nor 1");
            Err(cursor.error(problem, "Save the mesh again with gmsh"))
        }
    }
}

/// Returns the encoding that `$MeshFormat` gave, or an error if the section is missing so far.
fn known(cursor: &Cursor<'_>, encoding: Option<FileEncoding>) -> Result<FileEncoding, ReadError> {
    let problem = "no $MeshFormat section stands before this one";
    encoding.ok_or_else(|| cursor.error(problem, "Save the mesh again with gmsh"))
}

/// Returns an error if a section named `name` was read before; else records it in `seen`.
fn once(cursor: &Cursor<'_>, seen: &mut bool, name: &[u8]) -> Result<(), ReadError> {
    if std::mem::replace(seen, true) {
        let problem = format!("this is the second ${} section", quoted(name));
        return Err(cursor.error(problem, "Save each mesh to a separate file"));
    }
    Ok(())
}

/// Moves past the last line of a section, after all announced items were read.
///
/// # Errors
/// If further items follow, or if the last line is not that of the section.
fn end_of_section(
    cursor: &mut Cursor<'_>,
    name: &str,
    opened: Location,
    announced: &str,
) -> Result<(), ReadError> {
    let is_more = if cursor.syntax.is_of_words() { cursor.next_word() } else { cursor.next_row() };
    if is_more && !cursor.is_at(b'$') {
        let problem = format!("${name} goes on after the {announced} it announces");
        return Err(cursor.error(problem, "Correct the count, or save the mesh again"));
    }
    match is_end(cursor, name.as_bytes()) {
        true => Ok(()),
        false => Err(no_end(cursor, name, opened)),
    }
}

/// Moves past the last line of a section without reading the section.
fn skip_section(cursor: &mut Cursor<'_>, name: &[u8], opened: Location) -> Result<(), ReadError> {
    while cursor.next_row() {
        if cursor.is_at(b'$') && is_end(cursor, name) {
            return Ok(());
        }
    }
    Err(no_end(cursor, &quoted(name), opened))
}

/// Returns whether the next word ends the section: `$End` and the name, or `$END` and a name of version 1.
fn is_end(cursor: &mut Cursor<'_>, name: &[u8]) -> bool {
    let end = cursor.token().and_then(|word| word.strip_prefix(end_of(name).as_bytes()));
    end == Some(name)
}

/// Returns the beginning of the last line of a section. Names of version 1 have capital letters alone.
fn end_of(name: &[u8]) -> &'static str {
    if name.iter().all(u8::is_ascii_uppercase) { "$END" } else { "$End" }
}

fn no_end(cursor: &Cursor<'_>, name: &str, opened: Location) -> ReadError {
    let problem = format!("${name} has no {}{name}", end_of(name.as_bytes()));
    cursor.source.error_at(opened, problem, CUT_OFF)
}
