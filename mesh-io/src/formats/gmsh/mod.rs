//! gmsh's `.msh`, versions 2.2, 4.0 and 4.1, in ASCII and in binary.
//!
//! The formats: <https://gmsh.info/doc/texinfo/gmsh.html#Gmsh-file-formats>. To read a mesh, only `$MeshFormat`,
//! `$Nodes` and `$Elements` are needed. `$PhysicalNames` and `$Entities`, which from version 4 on lists the physical
//! groups of each entity, are read only for groups. Regions do not need them, as all triangles of an entity have the
//! same groups.

mod binary2;
mod binary4;
mod binary40;
mod data;
mod kind;
mod model;
mod periodic;
mod text2;
mod text4;
mod text40;
mod words;
pub(crate) mod write;

use crate::binary::order::Order;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::{Form, Numbers};
use crate::error::{Location, ReadError};
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::layout::of_rows_or_words;
use crate::text::syntax::Syntax;
use crate::text::token::quoted;
use crate::visit::heights::Heights;
use crate::visit::sink::{Layout, Sink, Walk, each_item};
use model::Model;

/// A remark for the user on parameters that cannot be updated.
const PARAMETRIC: &str =
    "nodes have parameters on surfaces of the model, which stay as they are where nodes move";

/// The version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    V2,
    V40,
    V4,
}

/// The version and byte order that `$MeshFormat` gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Encoding {
    version: Version,
    /// The byte order of binary numbers; `None` for text.
    order: Option<Order>,
}

/// The reader of gmsh's `.msh`.
pub(crate) struct Gmsh;

impl Walk for Gmsh {
    const VERTICES: &'static str = "$Nodes";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let Encoding { version, order } = walk(source, sink)?;
        let format = match (version, order) {
            (Version::V2, None) => Format::Gmsh22,
            (Version::V2, Some(_)) => Format::Gmsh22Binary,
            (Version::V40, None) => Format::Gmsh40,
            (Version::V40, Some(_)) => Format::Gmsh40Binary,
            (Version::V4, None) => Format::Gmsh41,
            (Version::V4, Some(_)) => Format::Gmsh41Binary,
        };
        let numbers = match order {
            None => Numbers::TEXT,
            Some(order) => Numbers::adjacent(order, Precision::Double),
        };
        Ok(Layout::in_place(format, numbers))
    }
}

/// Hands a file's nodes and elements to the sink.
fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Encoding, ReadError> {
    let cursor = &mut Cursor::new(source);
    let mut encoding = None;
    let (mut nodes, mut elements) = (false, false);
    let mut node_count = 0;
    let mut model = Model::default();
    while cursor.next_row() {
        // Like gmsh, ignore all text between sections.
        let Some(name) = cursor.token().and_then(|token| token.strip_prefix(b"$")) else {
            continue;
        };
        let opened = cursor.location();
        match name {
            b"MeshFormat" => {
                encoding = Some(mesh_format(cursor)?);
                end_of_section(cursor, "MeshFormat", opened, "one line")?;
            }
            b"Nodes" | b"ParametricNodes" => {
                once(cursor, &mut nodes, "Nodes")?;
                let Encoding { version, order } = known(cursor, encoding)?;
                let parametric = name == b"ParametricNodes";
                if parametric {
                    note_parameters(sink);
                }
                let mut seen = Heights::new(sink);
                let heights = &mut seen;
                let count = match (version, order) {
                    (Version::V2, None) => text2::nodes(cursor, heights, sink)?,
                    (Version::V40, None) => text40::nodes(cursor, heights, sink)?,
                    (Version::V40, Some(order)) => binary40::nodes(cursor, order, heights, sink)?,
                    (Version::V4, None) => text4::nodes(cursor, heights, sink)?,
                    (Version::V2, Some(order)) => {
                        binary2::nodes(cursor, (order, parametric), heights, sink)?
                    }
                    (Version::V4, Some(order)) => binary4::nodes(cursor, order, heights, sink)?,
                };
                node_count = count;
                let name = str::from_utf8(name).unwrap_or_default();
                end_of_section(cursor, name, opened, &format!("{count} nodes"))?;
                cursor.syntax = Syntax::PLAIN;
                sink.end_nodes(cursor)?;
                seen.send("z", form(order), sink);
            }
            b"Elements" => {
                once(cursor, &mut elements, "Elements")?;
                if !nodes {
                    let problem = "$Elements stands before $Nodes";
                    return Err(cursor.error(problem, "Put $Nodes first, as gmsh does"));
                }
                let Encoding { version, order } = known(cursor, encoding)?;
                let count = match (version, order) {
                    (Version::V2, None) => text2::elements(cursor, sink)?,
                    (Version::V40 | Version::V4, None) => {
                        text4::elements(cursor, version, &model, sink)?
                    }
                    (Version::V2, Some(order)) => binary2::elements(cursor, order, sink)?,
                    (Version::V40 | Version::V4, Some(order)) => {
                        binary4::elements(cursor, (version, order), &model, sink)?
                    }
                };
                end_of_section(cursor, "Elements", opened, &format!("{count} elements"))?;
                cursor.syntax = Syntax::PLAIN;
            }
            b"PhysicalNames" if sink.asks_for_groups() => {
                let count = model::physical_names(cursor, sink)?;
                end_of_section(cursor, "PhysicalNames", opened, &format!("{count} names"))?;
            }
            b"Entities" | b"PartitionedEntities" if sink.asks_for_groups() => {
                let partitioned = name == b"PartitionedEntities";
                model.read(cursor, known(cursor, encoding)?, partitioned)?;
                let name = str::from_utf8(name).unwrap_or_default();
                end_of_section(cursor, name, opened, "entities")?;
            }
            b"NodeData" | b"ElementData" => {
                let order = known(cursor, encoding)?.order;
                let nodes = (name == b"NodeData").then_some(node_count);
                data::read(cursor, nodes, order, sink);
                skip_section(cursor, name, opened)?;
            }
            name if name.starts_with(b"End") => {
                let problem = format!("${} ends a section that never began", quoted(name));
                return Err(cursor.error(problem, "Remove the line, or save the mesh again"));
            }
            name => {
                if name == b"Periodic" && sink.asks_for_pairs() {
                    sink.pairs(encoding.and_then(|encoding| periodic::read(cursor, encoding)));
                }
                let is_told = matches!(name, b"Comments" | b"PhysicalNames" | b"Entities");
                if sink.asks_for_data() && !is_told {
                    sink.leaves_out(&format!("the section ${}", quoted(name)));
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
            "The file is cut off or was saved without its mesh: save it again",
        )),
    }
}

/// Chooses how the rest of a section is read: by rows if it has this many rows, else by words as gmsh does.
fn lay_out(cursor: &mut Cursor<'_>, rows: u64) {
    let (bytes, at) = (&cursor.source.bytes, cursor.at());
    let end = memchr::memmem::find(&bytes[at..], b"$End").map_or(bytes.len(), |end| at + end);
    cursor.syntax = of_rows_or_words(cursor, end, rows);
}

/// Reads a list by rows if `is_so`: each item then has a row of its own, with parameters at its end.
fn by_rows<'a, T>(
    cursor: &mut Cursor<'a>,
    is_so: bool,
    read: impl FnOnce(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let syntax = cursor.syntax;
    if is_so {
        cursor.syntax = Syntax::PLAIN;
    }
    let list = read(cursor)?;
    if is_so {
        cursor.rest();
        cursor.syntax = syntax;
    }
    Ok(list)
}

/// Returns how a number is stored in the file.
fn form(order: Option<Order>) -> Form {
    match order {
        None => Form::Text(Precision::Double),
        Some(order) => Form::Binary(order, Precision::Double),
    }
}

fn mesh_format(cursor: &mut Cursor<'_>) -> Result<Encoding, ReadError> {
    row(cursor, 0, 1, "format lines")?;
    let name = cursor.token().unwrap_or_default();
    let version = match name {
        b"2" | b"2.0" | b"2.1" | b"2.2" => Version::V2,
        b"4" | b"4.0" => Version::V40,
        b"4.1" => Version::V4,
        _ => {
            let problem = format!("gmsh's format version {} is not read", quoted(name));
            let remedy = "Save as version 4.1 or 2.2 (gmsh old.msh -save -format msh41 -o new.msh)";
            return Err(cursor.error(problem, remedy));
        }
    };
    match cursor.integer("the file type")? {
        0 => Ok(Encoding { version, order: None }),
        1 => match cursor.integer("the size of a number")? {
            8 => Ok(Encoding { version, order: Some(words::byte_order(cursor)?) }),
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

/// Tells the sink that nodes have parameters, which stay as they are.
fn note_parameters(sink: &mut dyn Sink) {
    sink.remark(Remark::Text(PARAMETRIC.into()));
    sink.leaves_out("parameters of nodes on surfaces");
}

/// Announces that nodes have parameters on a surface. Returns whether the sink wants them.
fn has_parameters(sink: &mut dyn Sink, surface: i64) -> bool {
    sink.leaves_out("parameters of nodes on surfaces");
    sink.parameters(surface)
}

fn known(cursor: &Cursor<'_>, encoding: Option<Encoding>) -> Result<Encoding, ReadError> {
    let problem = "no $MeshFormat section stands before this one";
    encoding.ok_or_else(|| cursor.error(problem, "Save the mesh again with gmsh"))
}

fn once(cursor: &Cursor<'_>, seen: &mut bool, name: &str) -> Result<(), ReadError> {
    if std::mem::replace(seen, true) {
        let problem = format!("this is the second ${name} section");
        return Err(cursor.error(problem, "Save each mesh to a file of its own"));
    }
    Ok(())
}

/// Moves to the next of `count` items of a section, after `done` were read. Returns an error if the section ends before
/// it.
#[inline]
fn row(cursor: &mut Cursor<'_>, done: u64, count: u64, what: &str) -> Result<(), ReadError> {
    cursor.row(done, count, what)?;
    if cursor.is_at(b'$') {
        let problem = format!("the section ends after {done} of {count} {what}");
        return Err(cursor.error(problem, "Correct the count, or save the mesh again"));
    }
    Ok(())
}

/// Hands on the `count` items of a list. `before` items of the section's `all` were read earlier. As in gmsh, items may
/// stand anywhere on lines.
fn each<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    (count, before, all, what): (u64, u64, u64, &str),
    sink: &mut dyn Sink,
    read: impl Fn(&mut Cursor<'a>, Option<u64>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(&Cursor<'a>, &mut dyn Sink, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let next = |cursor: &mut Cursor<'a>, done: u64| row(cursor, before + done, all, what);
    each_item(cursor, count, sink, next, read, take)
}

/// Reads the counts at the start of a section, and chooses how the rest is read. `rows` returns how many rows it should
/// have.
fn counts<'a, T: Copy>(
    cursor: &mut Cursor<'a>,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError>,
    rows: impl Fn(T) -> u64,
) -> Result<T, ReadError> {
    cursor.syntax = Syntax::WORDS;
    let counts = head(cursor, (0, 1, "counts"), read)?;
    lay_out(cursor, rows(counts));
    Ok(counts)
}

/// Reads the header of a list or block, the next of `count` called `what`.
fn head<'a, T>(
    cursor: &mut Cursor<'a>,
    (done, count, what): (u64, u64, &str),
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    row(cursor, done, count, what)?;
    cursor.item(read, &mut None)
}

/// Checks that a block of `size` items is not larger than what the section's count leaves for it.
fn block_fits(cursor: &Cursor<'_>, size: u64, left: u64, what: &str) -> Result<(), ReadError> {
    if size <= left {
        return Ok(());
    }
    let problem = format!("a block of {size} {what} where the section's count leaves {left}");
    Err(cursor.error(problem, "Correct the counts, or save the mesh again"))
}

fn all_in_blocks(cursor: &Cursor<'_>, done: u64, count: u64, what: &str) -> Result<(), ReadError> {
    if done == count {
        return Ok(());
    }
    let problem = format!("the blocks hold {done} of the {count} {what} the section announces");
    Err(cursor.error(problem, "Correct the counts, or save the mesh again"))
}

/// Moves past the line that ends a section, after all announced rows were read.
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
    match cursor.token().and_then(|token| token.strip_prefix(b"$End")) {
        Some(end) if end == name.as_bytes() => Ok(()),
        _ => Err(no_end(cursor, name, opened)),
    }
}

fn skip_section(cursor: &mut Cursor<'_>, name: &[u8], opened: Location) -> Result<(), ReadError> {
    while cursor.next_row() {
        if cursor.is_at(b'$') && cursor.token().and_then(|t| t.strip_prefix(b"$End")) == Some(name)
        {
            return Ok(());
        }
    }
    Err(no_end(cursor, &quoted(name), opened))
}

fn no_end(cursor: &Cursor<'_>, name: &str, opened: Location) -> ReadError {
    let problem = format!("${name} has no $End{name}");
    cursor.source.error_at(opened, problem, CUT_OFF)
}
