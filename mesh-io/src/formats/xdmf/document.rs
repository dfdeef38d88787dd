//! The items of an XDMF file: attributes of their tags, and the location of their numbers.

use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::formats::xdmf::companions::Reference;
use crate::hdf5::Datatype;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, CUT_OFF};
use crate::text::token::quoted;
use crate::xml::{XmlTag, XmlTags, plain_text};
use std::ops::Range;

/// Location of an item's numbers.
pub(super) enum Content {
    /// Range of the XML with the numbers as text.
    Text(Range<usize>),
    /// HDF5: file name, dataset path, and the range of the XML with the file name.
    Hdf5 { file: String, path: String, named_at: Range<usize> },
    /// A raw file: file name, offset of the numbers in bytes, number type, and the range of the XML with the file name.
    Raw { file: String, seek: u64, number: Datatype, named_at: Range<usize> },
}

/// A `DataItem` with coordinates, topology or data of a mesh.
pub(super) struct Item {
    /// Number of the grid around the item, from 1; 0 outside of grids.
    pub(super) grid: u64,
    /// Section around the item: `Geometry`, `Topology` or `Attribute`.
    pub(super) section: String,
    /// Type that the section names, such as `xyz` or `triangle`, in lower case.
    pub(super) kind: String,
    /// Name of an `Attribute`; empty if it has none.
    pub(super) name: String,
    /// Owners of the numbers of an `Attribute`, such as `node` or `cell`, in lower case.
    pub(super) center: String,
    /// `NumberOfElements` of a `Topology`.
    pub(super) elements: Option<u64>,
    /// `NodesPerElement` of a `Topology` of polyvertices, polylines or polygons.
    pub(super) corners: Option<u64>,
    /// `Dimensions` of the item; empty if the tag lacks the attribute.
    pub(super) dimensions: Vec<u64>,
    /// Precision of real numbers, single by default; `None` for whole numbers.
    pub(super) precision: Option<Precision>,
    pub(super) content: Content,
    /// Offset of the item's tag in the XML.
    pub(super) at: usize,
}

impl Item {
    /// Returns the number of numbers that `Dimensions` announces, at most `u64::MAX`; `None` without `Dimensions`.
    pub(super) fn announced(&self) -> Option<u64> {
        let product = || self.dimensions.iter().try_fold(1_u64, |n, &length| n.checked_mul(length));
        (!self.dimensions.is_empty()).then(|| product().unwrap_or(u64::MAX))
    }

    /// Returns the reference to the companion file with the numbers. `None` if the XML contains the numbers.
    pub(super) fn reference(self) -> Option<Reference> {
        match self.content {
            Content::Text(_) => None,
            Content::Hdf5 { file, named_at, .. } | Content::Raw { file, named_at, .. } => {
                Some(Reference { name: file, at: named_at })
            }
        }
    }
}

/// Name and attributes of an element.
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

    /// Returns the value of the element's first attribute whose name is among `names`.
    fn value(&self, names: &[&str]) -> Option<&str> {
        let found = self.attributes.iter().find(|(name, _)| names.contains(&name.as_str()));
        found.map(|(_, value)| value.as_str())
    }
}

/// Returns the items of geometries, topologies and attributes in file order. Items that refer to another item are left
/// out, as are empty ones.
///
/// # Errors
/// If the file is not XML or has no `Xdmf` element, or if a tag is damaged or describes numbers that cannot be read.
pub(super) fn items(source: &Source) -> Result<Vec<Item>, ReadError> {
    let mut tags = XmlTags::new(source);
    let mut items = Vec::new();
    let mut seen = false;
    let mut grids = 0;
    while let Some(tag) = tags.next()? {
        let own = Section::of(&tag)?;
        seen |= own.name == "Xdmf";
        // Items are in the innermost grids, so the last grid that began is the grid around an item.
        grids += u64::from(own.name == "Grid");
        if own.name == "DataItem"
            && let Some(parent) = tags.parent()
            && ["Geometry", "Topology", "Attribute"].contains(&&*parent.name())
            && own.value(&["Reference"]).is_none()
            && !tag.is_empty()
        {
            items.push(Item { grid: grids, ..item(source, &tag, &own, &Section::of(parent)?)? });
        }
    }
    match seen {
        true => Ok(items),
        false => Err(source.error("it has no Xdmf element", "Save the mesh again")),
    }
}

/// Lists content of the file that a conversion loses and that [`items`] leaves out.
///
/// # Errors
/// If the file is not XML.
pub(super) fn left_out(source: &Source) -> Result<Vec<&'static str>, ReadError> {
    let mut tags = XmlTags::new(source);
    let (mut lost, mut times) = (Vec::new(), 0);
    while let Some(tag) = tags.next()? {
        let own = Section::of(&tag)?;
        let is_in = |name: &str| tags.parent().is_some_and(|parent| parent.name() == name);
        match own.name.as_str() {
            // Data without a time have a single time step at the time zero.
            "Time" => {
                times += 1;
                let time = own.value(&["Value"]).and_then(|time| time.trim().parse::<f64>().ok());
                if times > 1 || time != Some(0.0) {
                    lost.push("times of time steps");
                }
            }
            "Set" => lost.push("sets of nodes or cells (Set)"),
            "DataItem" if is_in("Attribute") && own.value(&["Reference"]).is_some() => {
                lost.push("attributes that refer to other items");
            }
            "Attribute" if own.value(&["Reference"]).is_some() => {
                lost.push("attributes that refer to other items");
            }
            _ => {}
        }
    }
    Ok(lost)
}

/// Separates the items of the mesh from those of mesh tags: items in grids that have a Topology, where the Geometry is
/// in another grid with a Topology.
pub(super) fn split(items: Vec<Item>) -> (Vec<Item>, Vec<Item>) {
    let grids = |section: &str| -> Vec<u64> {
        items.iter().filter(|item| item.section == section).map(|item| item.grid).collect()
    };
    let (geometries, topologies) = (grids("Geometry"), grids("Topology"));
    match geometries[..] {
        [mesh] if topologies.contains(&mesh) => items
            .into_iter()
            .partition(|item| item.grid == mesh || !topologies.contains(&item.grid)),
        _ => (items, Vec::new()),
    }
}

/// Reads an item: `tag` has its attributes, `of` those of the section around it.
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
            let is_signed = !is_real.starts_with('u');
            let integer = |bytes| Datatype::Whole(IntegerType { bytes, is_signed }, order);
            let number = match (is_real.as_str(), precision) {
                ("" | "float", 4) => Datatype::Real(Precision::Single, order),
                ("" | "float", 8) => Datatype::Real(Precision::Double, order),
                ("char" | "uchar", _) => integer(1),
                ("short" | "ushort", _) => integer(2),
                ("int" | "uint", 1 | 2 | 4 | 8) => integer(precision as usize),
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
    let item_type = small(tag, &["ItemType"]);
    if of.name != "Attribute" && !matches!(item_type.as_str(), "" | "uniform") {
        let item_type = quoted(tag.value(&["ItemType"]).unwrap_or_default().as_bytes());
        let problem = format!("a {} of a DataItem of the type {item_type} is not read", of.name);
        return Err(xml.error(problem, SAVE));
    }
    if of.name == "Topology" && optional(of, &["BaseOffset"])?.is_some_and(|base: u64| base != 0) {
        return Err(xml.error("a Topology with another BaseOffset than 0 is not read", SAVE));
    }
    let dimensions = tag.value(&["Dimensions"]).unwrap_or_default();
    let dimensions = dimensions.split_whitespace().map(number).collect::<Result<_, _>>()?;
    Ok(Item {
        grid: 0,
        section: of.name.clone(),
        kind: small(of, &["TopologyType", "GeometryType", "Type"]),
        name: of.value(&["Name"]).unwrap_or_default().to_owned(),
        // Node is the default.
        center: Some(small(of, &["Center"]))
            .filter(|center| !center.is_empty())
            .unwrap_or("node".into()),
        elements: optional(of, &["NumberOfElements"])?,
        corners: optional(of, &["NodesPerElement"])?,
        dimensions,
        precision: (is_real.is_empty() || is_real == "float").then_some(precision),
        content,
        at: xml.at(),
    })
}

/// Remedy for numbers that cannot be read.
const SAVE: &str = "Save with the numbers in the XML, as meshio does by data_format=\"XML\"";

/// Returns the file name that a text contains, with XML entities decoded, and the range of the name without blanks
/// around it.
fn name(source: &Source, text: Range<usize>) -> (String, Range<usize>) {
    let own = &source.bytes[text.clone()];
    let start = text.start + (own.len() - own.trim_ascii_start().len());
    let name = own.trim_ascii();
    (plain_text(name), start..start + name.len())
}

/// Splits a text such as `mesh.h5:/path` into file name and dataset path.
///
/// # Errors
/// If the text has no colon, or an empty file name before the colon.
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
