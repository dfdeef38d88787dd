//! The items of an XDMF file: what its tags say of them, and where their text stands.

use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::formats::xdmf::companions::Reference;
use crate::hdf5::Datatype;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, CUT_OFF};
use crate::text::token::quoted;
use crate::xml::{XmlTag, XmlTags, plain_text};
use std::ops::Range;

/// Where the numbers of an item stand.
pub(super) enum Content {
    /// In the XML, in this range.
    Text(Range<usize>),
    /// In HDF5: the name of the file and the path in it.
    Hdf5 { file: String, path: String, named_at: Range<usize> },
    /// In a file of the name, from a byte on.
    Raw { file: String, seek: u64, number: Datatype, named_at: Range<usize> },
}

/// A `DataItem` with numbers.
pub(super) struct Item {
    /// `Geometry`, `Topology` or `Attribute`.
    pub(super) section: String,
    /// The type that the section names, such as `XYZ` or `Triangle`, in small letters.
    pub(super) kind: String,
    /// Of an attribute what it is called, and what it belongs to, in small letters.
    pub(super) name: String,
    pub(super) center: String,
    /// How many elements a topology announces, and how many nodes each has where its kind does not tell.
    pub(super) elements: Option<u64>,
    pub(super) corners: Option<u64>,
    pub(super) dimensions: Vec<u64>,
    /// How many digits the numbers have, if they are real.
    pub(super) precision: Option<Precision>,
    pub(super) content: Content,
    /// Where its tag starts.
    pub(super) at: usize,
}

impl Item {
    /// How many numbers it announces, if it does.
    pub(super) fn announced(&self) -> Option<u64> {
        let product = || self.dimensions.iter().try_fold(1_u64, |n, &length| n.checked_mul(length));
        (!self.dimensions.is_empty()).then(|| product().unwrap_or(u64::MAX))
    }

    /// Returns the reference to the file that holds the numbers. `None` if the XML itself holds them.
    pub(super) fn reference(self) -> Option<Reference> {
        match self.content {
            Content::Text(_) => None,
            Content::Hdf5 { file, named_at, .. } | Content::Raw { file, named_at, .. } => {
                Some(Reference { name: file, at: named_at })
            }
        }
    }
}

/// An element with its attributes.
struct Section {
    name: String,
    attributes: Vec<(String, String)>,
}

impl Section {
    fn of(tag: &XmlTag<'_>) -> Result<Section, ReadError> {
        let attributes = tag.attributes().map(|attribute| {
            let (name, value) = attribute?;
            Ok((name.into_owned(), value))
        });
        Ok(Section {
            name: tag.name().into_owned(),
            attributes: attributes.collect::<Result<_, _>>()?,
        })
    }

    /// Returns the value of the first attribute that has one of these names.
    fn value(&self, names: &[&str]) -> Option<&str> {
        let found = self.attributes.iter().find(|(name, _)| names.contains(&name.as_str()));
        found.map(|(_, value)| value.as_str())
    }
}

/// Returns the items of a file in order, without those that refer to others.
pub(super) fn items(source: &Source) -> Result<Vec<Item>, ReadError> {
    let mut tags = XmlTags::new(source);
    let mut items = Vec::new();
    let mut seen = false;
    while let Some(tag) = tags.next()? {
        let own = Section::of(&tag)?;
        seen |= own.name == "Xdmf";
        if own.name == "DataItem"
            && let Some(parent) = tags.parent()
            && ["Geometry", "Topology", "Attribute"].contains(&&*parent.name())
            && own.value(&["Reference"]).is_none()
            && !tag.is_empty()
        {
            items.push(item(source, &tag, &own, &Section::of(parent)?)?);
        }
    }
    match seen {
        true => Ok(items),
        false => Err(source.error("it has no Xdmf element", "Save the mesh again")),
    }
}

/// Reads an item, given its attributes and the section that it is in.
fn item(source: &Source, xml: &XmlTag<'_>, tag: &Section, of: &Section) -> Result<Item, ReadError> {
    let text = xml.text().ok_or_else(|| xml.error("the file ends within a DataItem", CUT_OFF))?;
    let number = |text: &str| {
        text.trim().parse::<u64>().map_err(|_| {
            let problem = format!("`{}` is not a whole number", quoted(text.as_bytes()));
            xml.error(problem, CORRECT)
        })
    };
    let optional = |section: &Section, names: &[&str]| section.value(names).map(number).transpose();
    let small = |section: &Section, names: &[&str]| {
        section.value(names).unwrap_or_default().trim().to_ascii_lowercase()
    };
    let is_real = small(tag, &["NumberType", "DataType"]);
    let precision = match optional(tag, &["Precision"])? {
        Some(8) => Precision::Double,
        _ => Precision::Single,
    };
    let format = tag.value(&["Format"]).unwrap_or("XML").to_ascii_uppercase();
    let content = match format.as_str() {
        "XML" => Content::Text(text),
        "HDF" | "HDF5" => in_hdf5(source, text)?,
        "BINARY" => {
            if tag.value(&["Compression"]).is_some_and(|c| !c.eq_ignore_ascii_case("raw")) {
                let problem = "numbers in a compressed raw file beside it are not read";
                return Err(xml.error(problem, SAVE));
            }
            let precision = optional(tag, &["Precision"])?.unwrap_or(4);
            let order = match small(tag, &["Endian"]).as_str() {
                "big" => ByteOrder::Big,
                _ => ByteOrder::Little,
            };
            let number = match (is_real.as_str(), precision) {
                ("" | "float", 4) => Datatype::Real(Precision::Single, order),
                ("" | "float", 8) => Datatype::Real(Precision::Double, order),
                ("char" | "uchar", _) => Datatype::Whole(1, order),
                ("short" | "ushort", _) => Datatype::Whole(2, order),
                ("int" | "uint", 1 | 2 | 4 | 8) => Datatype::Whole(precision as usize, order),
                _ => {
                    let problem = format!("numbers of {precision} bytes are not read");
                    return Err(xml.error(problem, SAVE));
                }
            };
            let seek = optional(tag, &["Seek"])?.unwrap_or(0);
            let (file, named_at) = name(source, text);
            Content::Raw { file, seek, number, named_at }
        }
        other => {
            let problem =
                format!("numbers of the format {} are not read", quoted(other.as_bytes()));
            return Err(xml.error(problem, SAVE));
        }
    };
    let dimensions = tag.value(&["Dimensions"]).unwrap_or_default();
    let dimensions = dimensions.split_whitespace().map(number).collect::<Result<_, _>>()?;
    Ok(Item {
        section: of.name.clone(),
        kind: small(of, &["TopologyType", "GeometryType", "Type"]),
        name: of.value(&["Name"]).unwrap_or_default().to_owned(),
        center: small(of, &["Center"]),
        elements: optional(of, &["NumberOfElements"])?,
        corners: optional(of, &["NodesPerElement"])?,
        dimensions,
        precision: (is_real.is_empty() || is_real == "float").then_some(precision),
        content,
        at: xml.at(),
    })
}

/// What to do about numbers that are not read.
const SAVE: &str = "Save with the numbers in the XML, as meshio does by data_format=\"XML\"";

/// The name of a file that a text is, and where that stands without blanks.
fn name(source: &Source, text: Range<usize>) -> (String, Range<usize>) {
    let own = &source.bytes[text.clone()];
    let start = text.start + (own.len() - own.trim_ascii_start().len());
    let name = own.trim_ascii();
    (plain_text(name), start..start + name.len())
}

/// A file and the path of a dataset in it, with a colon between.
fn in_hdf5(source: &Source, text: Range<usize>) -> Result<Content, ReadError> {
    let (_, all) = name(source, text);
    let own = &source.bytes[all.clone()];
    let slash = memchr::memmem::rfind(own, b":/");
    let Some(colon) = slash.or_else(|| memchr::memrchr(b':', own)).filter(|&colon| colon > 0)
    else {
        let problem = format!("`{}` names no dataset of an HDF5 file", quoted(own));
        let place = Location::Line(source.line_of(all.start));
        return Err(source.error_at(place, problem, SAVE));
    };
    let named_at = all.start..all.start + colon;
    let (file, path) = (plain_text(&own[..colon]), plain_text(&own[colon + 1..]));
    Ok(Content::Hdf5 { file, path, named_at })
}
