//! The elements of a VTK XML file, and their offsets.

use crate::binary::order::Order;
use crate::disk::source::Source;
use crate::edit::numbers::Offset;
use crate::error::{Location, ReadError};
use crate::formats::vtk::xml::blocks::Compressor;
use crate::text::cursor::{CORRECT, CUT_OFF};
use crate::text::token::{ill_formed_xml, quoted, xml_text};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::ops::Range;

/// The content of a file's tags.
pub(super) struct Document {
    pub(super) order: Order,
    /// The bytes of a number that gives the length of a block.
    pub(super) header: usize,
    pub(super) compressor: Option<Compressor>,
    pub(super) content: Content,
    /// The pieces of the mesh, including those without points.
    pub(super) pieces: Vec<Piece>,
    pub(super) arrays: Vec<Array>,
    pub(super) appended: Option<Appended>,
}

/// The kind of dataset that a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    Grid,
    Polygons,
}

/// The sizes of a `Piece`.
pub(super) struct Piece {
    pub(super) points: u64,
    /// The number of cells. For polygonal data: points, lines, strips and polygons.
    pub(super) cells: [u64; 4],
}

/// A `DataArray`.
pub(super) struct Array {
    /// The index of the array's piece, or of the last piece before it.
    pub(super) piece: usize,
    /// The element around the array: `Points`, `Cells`, `PointData` and so on.
    pub(super) section: String,
    pub(super) name: String,
    pub(super) number: String,
    pub(super) components: u64,
    pub(super) format: Coding,
    /// The range of the array's text; empty if it is appended.
    pub(super) content: Range<usize>,
    /// For an appended array, its offset in the appended data, and the range of the file that gives the offset.
    pub(super) offset: Option<(usize, Range<usize>)>,
    /// The offset of the array's tag.
    pub(super) at: usize,
}

/// How an array is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coding {
    Ascii,
    Base64,
    Appended,
}

/// The appended data at the end of the file.
#[derive(Clone, Copy)]
pub(super) struct Appended {
    /// The offset of the data, after the underscore.
    pub(super) start: usize,
    pub(super) base64: bool,
}

/// The most elements that may be nested. VTK nests no more than seven, and each takes memory until it ends.
const DEEPEST: usize = 100;

impl Document {
    pub(super) fn read(source: &Source) -> Result<Document, ReadError> {
        let begin = source.begin();
        let mut reader = Reader::from_reader(&source.bytes[begin..]);
        reader.config_mut().check_end_names = false;
        let mut document = Document {
            order: Order::Little,
            header: 4,
            compressor: None,
            content: Content::Grid,
            pieces: Vec::new(),
            arrays: Vec::new(),
            appended: None,
        };
        let mut open: Vec<String> = Vec::new();
        let mut seen = false;
        loop {
            let at = begin + reader.buffer_position() as usize;
            let event = reader.read_event().map_err(|error| {
                let place = Location::Line(source.line_of(at.min(source.bytes.len())));
                source.error_at(place, ill_formed_xml(&error), CORRECT)
            })?;
            let after = begin + reader.buffer_position() as usize;
            match event {
                Event::Eof => break,
                Event::End(_) => {
                    open.pop();
                }
                Event::Start(tag) | Event::Empty(tag) => {
                    let tag = Tag { source, at, tag };
                    let name = String::from_utf8_lossy(tag.tag.name().as_ref()).into_owned();
                    let is_empty = source.bytes[at..after].ends_with(b"/>");
                    match name.as_str() {
                        "VTKFile" => {
                            seen = true;
                            document.header_of(&tag)?;
                        }
                        "Piece" => document.piece(&tag)?,
                        "DataArray" | "Array" => {
                            let section = open.last().cloned().unwrap_or_default();
                            let piece = document.pieces.len().saturating_sub(1);
                            let array = tag.array((section, piece), after, is_empty)?;
                            document.arrays.push(array);
                        }
                        "AppendedData" => {
                            document.appended = Some(tag.appended(after)?);
                            // The data after this tag need not be XML.
                            break;
                        }
                        _ => {}
                    }
                    if !is_empty {
                        open.push(name);
                    }
                    if open.len() > DEEPEST {
                        let place = Location::Line(source.line_of(at));
                        let problem = format!("elements are nested more than {DEEPEST} deep");
                        return Err(source.error_at(place, problem, CORRECT));
                    }
                }
                _ => {}
            }
        }
        if !seen {
            return Err(source.error("it has no VTKFile element", "Save the mesh again"));
        }
        Ok(document)
    }

    /// Returns the offsets of appended arrays, as the file gives them.
    pub(super) fn offsets(&self) -> Vec<Offset> {
        let Some(appended) = self.appended else { return Vec::new() };
        let offset = |array: &Array| {
            let (value, place) = array.offset.clone()?;
            Some(Offset { value, array_at: appended.start.saturating_add(value), place })
        };
        self.arrays.iter().filter_map(offset).collect()
    }

    fn header_of(&mut self, tag: &Tag<'_>) -> Result<(), ReadError> {
        let kind = tag.attribute("type")?.unwrap_or_default();
        self.content = match kind.as_str() {
            "UnstructuredGrid" => Content::Grid,
            "PolyData" => Content::Polygons,
            _ => {
                let problem =
                    format!("a VTK file of the type {} is not read", quoted(kind.as_bytes()));
                let remedy = "Save as an unstructured grid in one file (.vtu)";
                return Err(tag.error(problem, remedy));
            }
        };
        if tag.attribute("byte_order")?.as_deref() == Some("BigEndian") {
            self.order = Order::Big;
        }
        if tag.attribute("header_type")?.as_deref() == Some("UInt64") {
            self.header = 8;
        }
        self.compressor = match tag.attribute("compressor")?.as_deref() {
            None | Some("") => None,
            Some("vtkZLibDataCompressor") => Some(Compressor::Zlib),
            Some("vtkLZ4DataCompressor") => Some(Compressor::Lz4),
            Some(other) => {
                let problem = format!("it is compressed by {}", quoted(other.as_bytes()));
                return Err(tag.error(problem, "Save with zlib, LZ4 or no compression"));
            }
        };
        Ok(())
    }

    fn piece(&mut self, tag: &Tag<'_>) -> Result<(), ReadError> {
        let points = tag.number("NumberOfPoints")?;
        let optional = |name: &str| match tag.attribute(name)? {
            None => Ok(0),
            Some(_) => tag.number(name),
        };
        let cells = match self.content {
            Content::Grid => [tag.number("NumberOfCells")?, 0, 0, 0],
            Content::Polygons => [
                optional("NumberOfVerts")?,
                optional("NumberOfLines")?,
                optional("NumberOfStrips")?,
                optional("NumberOfPolys")?,
            ],
        };
        self.pieces.push(Piece { points, cells });
        Ok(())
    }
}

/// A tag and its offset.
struct Tag<'a> {
    source: &'a Source,
    at: usize,
    tag: BytesStart<'a>,
}

impl Tag<'_> {
    fn attribute(&self, name: &str) -> Result<Option<String>, ReadError> {
        for attribute in self.tag.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|error| self.error(format!("an attribute: {error}"), CORRECT))?;
            if attribute.key.as_ref() == name.as_bytes() {
                return Ok(Some(xml_text(&attribute.value)));
            }
        }
        Ok(None)
    }

    fn number(&self, name: &str) -> Result<u64, ReadError> {
        let text = self.attribute(name)?.unwrap_or_default();
        text.trim().parse().map_err(|_| {
            let problem = format!("{name} is `{}`, not a whole number", quoted(text.as_bytes()));
            self.error(problem, CORRECT)
        })
    }

    fn array(
        &self,
        (section, piece): (String, usize),
        after: usize,
        is_empty: bool,
    ) -> Result<Array, ReadError> {
        let bytes = &self.source.bytes;
        let format = match self.attribute("format")?.as_deref() {
            Some("binary") => Coding::Base64,
            Some("appended") => Coding::Appended,
            None | Some("ascii") => Coding::Ascii,
            Some(other) => {
                let problem =
                    format!("an array of the format {} is not read", quoted(other.as_bytes()));
                return Err(self.error(problem, "Save the mesh again"));
            }
        };
        let end = match is_empty {
            true => after,
            false => match memchr::memchr(b'<', &bytes[after..]) {
                Some(length) => after + length,
                None => return Err(self.error("the file ends within an array", CUT_OFF)),
            },
        };
        let offset = match format {
            Coding::Appended => {
                let value = self.number("offset")?;
                let offset = usize::try_from(value).unwrap_or(usize::MAX);
                Some((offset, self.place_of_value("offset", after)?))
            }
            _ => None,
        };
        // VTK takes an empty number for one that is not there.
        let components = match self.attribute("NumberOfComponents")?.as_deref().map(str::trim) {
            None | Some("") => 1,
            Some(_) => self.number("NumberOfComponents")?,
        };
        Ok(Array {
            piece,
            section,
            name: self.attribute("Name")?.unwrap_or_default(),
            number: self.attribute("type")?.unwrap_or_default(),
            components,
            format,
            content: after..end,
            offset,
            at: self.at,
        })
    }

    /// Returns the range of an attribute's value. The tag must have the attribute.
    fn place_of_value(&self, name: &str, after: usize) -> Result<Range<usize>, ReadError> {
        let tag = &self.source.bytes[self.at..after];
        let found = memchr::memmem::find_iter(tag, name).find_map(|at| {
            let blank_before = at > 0 && tag[at - 1] <= b' ';
            let rest = &tag[at + name.len()..];
            let equals = rest.iter().position(|&byte| byte > b' ')?;
            let quote_at = equals + 1 + rest[equals + 1..].iter().position(|&byte| byte > b' ')?;
            let quote = rest[quote_at];
            let is_value = blank_before && rest[equals] == b'=' && matches!(quote, b'"' | b'\'');
            let start = at + name.len() + quote_at + 1;
            let length = memchr::memchr(quote, &tag[start..])?;
            is_value.then_some(self.at + start..self.at + start + length)
        });
        found.ok_or_else(|| {
            self.error(format!("the attribute {name} is not written as name=\"value\""), CORRECT)
        })
    }

    fn appended(&self, after: usize) -> Result<Appended, ReadError> {
        let bytes = &self.source.bytes;
        let base64 = match self.attribute("encoding")?.as_deref() {
            Some("raw") => false,
            None | Some("base64") => true,
            Some(other) => {
                let problem =
                    format!("appended data encoded as {} are not read", quoted(other.as_bytes()));
                return Err(self.error(problem, "Save as raw or base64"));
            }
        };
        let start = bytes[after..].iter().position(|&byte| byte > b' ');
        match start {
            Some(start) if bytes[after + start] == b'_' => {
                Ok(Appended { start: after + start + 1, base64 })
            }
            _ => Err(self.error("no underscore stands before the appended data", CUT_OFF)),
        }
    }

    #[cold]
    fn error(&self, problem: impl Into<String>, remedy: &str) -> ReadError {
        let place = Location::Line(self.source.line_of(self.at));
        self.source.error_at(place, problem, remedy)
    }
}
