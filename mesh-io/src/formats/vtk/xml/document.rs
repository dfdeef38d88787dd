//! The elements of a VTK XML file, with their offsets.

use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::edit::numbers::AppendedOffset;
use crate::error::ReadError;
use crate::formats::vtk::xml::blocks::Compressor;
use crate::text::cursor::CUT_OFF;
use crate::text::token::quoted;
use crate::xml::{XmlTag, XmlTags};
use std::ops::Range;

/// The tags of a file: encoding, pieces and arrays.
pub(super) struct Document {
    pub(super) order: ByteOrder,
    /// Width of an integer in the header of a binary array, in bytes: 8 for `UInt64`, else 4.
    pub(super) header: usize,
    pub(super) compressor: Option<Compressor>,
    pub(super) content: Content,
    /// The pieces of the mesh in file order, also those without points.
    pub(super) pieces: Vec<Piece>,
    /// The arrays of all pieces in file order.
    pub(super) arrays: Vec<Array>,
    /// The appended data; `None` if the file has no `AppendedData`.
    pub(super) appended: Option<Appended>,
}

/// Dataset type of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    Grid,
    Polygons,
}

/// Announced sizes of a `Piece`.
pub(super) struct Piece {
    pub(super) points: u64,
    /// Announced cells: for an unstructured grid, the first number counts all cells. For polygonal data, the numbers
    /// count vertices, lines, strips and polygons.
    pub(super) cells: [u64; 4],
}

/// Tag and location of a `DataArray` or `Array`.
pub(super) struct Array {
    /// Index of the piece around the array, else of the preceding piece; 0 before the first piece.
    pub(super) piece: usize,
    /// Name of the element around the array: `Points`, `Cells`, `PointData` and so on.
    pub(super) section: String,
    pub(super) name: String,
    /// Number type of the array, such as `Float32`.
    pub(super) number: String,
    /// Numbers per point or cell.
    pub(super) components: u64,
    pub(super) format: ArrayFormat,
    /// Range of the array's text in the file; empty for an empty element.
    pub(super) content: Range<usize>,
    /// Offset of an appended array in the appended data, and the range of the attribute value with this offset. `None`
    /// for other arrays.
    pub(super) offset: Option<(usize, Range<usize>)>,
    /// Offset of the array's tag in the file.
    pub(super) at: usize,
}

/// Storage of an array: text, base64 in the element, or appended data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ArrayFormat {
    Ascii,
    Base64,
    Appended,
}

/// The appended data, the last element of the file.
#[derive(Clone, Copy)]
pub(super) struct Appended {
    /// Offset of the data in the file, after the underscore.
    pub(super) start: usize,
    /// Whether the data are base64 text, not raw bytes.
    pub(super) base64: bool,
}

impl Array {
    /// Returns whether the array holds texts instead of numbers.
    pub(super) fn is_text(&self) -> bool {
        self.number == "String"
    }
}

impl Document {
    pub(super) fn read(source: &Source) -> Result<Document, ReadError> {
        let mut document = Document {
            order: ByteOrder::Little,
            header: 4,
            compressor: None,
            content: Content::Grid,
            pieces: Vec::new(),
            arrays: Vec::new(),
            appended: None,
        };
        let mut tags = XmlTags::new(source);
        let mut seen = false;
        while let Some(tag) = tags.next()? {
            match &*tag.name() {
                "VTKFile" => {
                    seen = true;
                    document.header_of(&tag)?;
                }
                "Piece" => document.piece(&tag)?,
                "DataArray" | "Array" => {
                    let section = tags.parent().map(|parent| parent.name().into_owned());
                    let piece = document.pieces.len().saturating_sub(1);
                    document.arrays.push(array(&tag, section.unwrap_or_default(), piece)?);
                }
                "AppendedData" => {
                    document.appended = Some(appended(&tag, source)?);
                    // Appended raw bytes after the tag need not be XML.
                    break;
                }
                _ => {}
            }
        }
        if !seen {
            return Err(source.error("it has no VTKFile element", "Save the mesh again"));
        }
        Ok(document)
    }

    /// Returns the arrays of a piece; see [`Array::piece`].
    pub(super) fn arrays_of(&self, piece: usize) -> &[Array] {
        // Arrays are in the order of their pieces. A search through all arrays for each piece would take quadratic time.
        let [start, end] =
            [piece, piece + 1].map(|end| self.arrays.partition_point(|own| own.piece < end));
        &self.arrays[start..end]
    }

    /// Returns the offset of each appended array, with the range of the file that states the offset.
    pub(super) fn offsets(&self) -> Vec<AppendedOffset> {
        let Some(appended) = self.appended else { return Vec::new() };
        let offset = |array: &Array| {
            let (value, place) = array.offset.clone()?;
            Some(AppendedOffset {
                value,
                array_start: appended.start.saturating_add(value),
                range: place,
            })
        };
        self.arrays.iter().filter_map(offset).collect()
    }

    /// Returns the number of points or cells whose numbers an array has; `None` if the section of the array has no
    /// count.
    pub(super) fn owners(&self, array: &Array) -> Option<u64> {
        let Piece { points, cells } = self.pieces.get(array.piece)?;
        match array.section.as_str() {
            "Points" | "PointData" => Some(*points),
            "Cells" | "CellData" => Some(cells.iter().fold(0, |sum, own| sum.saturating_add(*own))),
            "Verts" => Some(cells[0]),
            "Lines" => Some(cells[1]),
            "Strips" => Some(cells[2]),
            "Polys" => Some(cells[3]),
            _ => None,
        }
    }

    fn header_of(&mut self, tag: &XmlTag<'_>) -> Result<(), ReadError> {
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
            self.order = ByteOrder::Big;
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

    fn piece(&mut self, tag: &XmlTag<'_>) -> Result<(), ReadError> {
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

fn array(tag: &XmlTag<'_>, section: String, piece: usize) -> Result<Array, ReadError> {
    let format = match tag.attribute("format")?.as_deref() {
        Some("binary") => ArrayFormat::Base64,
        Some("appended") => ArrayFormat::Appended,
        None | Some("ascii") => ArrayFormat::Ascii,
        Some(other) => {
            let problem =
                format!("an array of the format {} is not read", quoted(other.as_bytes()));
            return Err(tag.error(problem, "Save the mesh again"));
        }
    };
    let content = match tag.is_empty() {
        true => tag.end()..tag.end(),
        false => tag.text().ok_or_else(|| tag.error("the file ends within an array", CUT_OFF))?,
    };
    let offset = match format {
        ArrayFormat::Appended => {
            let value = tag.number("offset")?;
            let offset = usize::try_from(value).unwrap_or(usize::MAX);
            Some((offset, tag.value_range("offset")?))
        }
        _ => None,
    };
    // VTK treats an empty attribute as a missing one.
    let components = match tag.attribute("NumberOfComponents")?.as_deref().map(str::trim) {
        None | Some("") => 1,
        Some(_) => tag.number("NumberOfComponents")?,
    };
    Ok(Array {
        piece,
        section,
        name: tag.attribute("Name")?.unwrap_or_default(),
        number: tag.attribute("type")?.unwrap_or_default(),
        components,
        format,
        content,
        offset,
        at: tag.at(),
    })
}

fn appended(tag: &XmlTag<'_>, source: &Source) -> Result<Appended, ReadError> {
    let base64 = match tag.attribute("encoding")?.as_deref() {
        Some("raw") => false,
        None | Some("base64") => true,
        Some(other) => {
            let problem =
                format!("appended data encoded as {} are not read", quoted(other.as_bytes()));
            return Err(tag.error(problem, "Save as raw or base64"));
        }
    };
    let after = &source.bytes[tag.end()..];
    match after.iter().position(|&byte| byte > b' ') {
        Some(start) if after[start] == b'_' => {
            Ok(Appended { start: tag.end() + start + 1, base64 })
        }
        _ => Err(tag.error("no underscore stands before the appended data", CUT_OFF)),
    }
}
