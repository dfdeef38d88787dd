//! Point and cell data of a legacy VTK file. Region arrays and arrays that the visitor wants are read, all others are
//! skipped.

use crate::binary::byte_order::ByteOrder;
use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::edit::numbers::{NumberEncoding, Offsets};
use crate::formats::vtk::bits_and_texts::{bits, lost_text};
use crate::formats::vtk::legacy::skip::{array_name, size_at, skip_metadata, skip_section, take};
use crate::formats::vtk::regions::{MAX_ARRAYS, names_regions, unread_regions};
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::token::quoted;
use crate::visit::ghosts::vtk_ghosts;
use crate::visit::items::{PointNumbers, RegionAttribute};
use crate::visit::storage::ArrayLocation;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::TextNumbers;
use std::borrow::Cow;

/// Region arrays of a file, at most [`MAX_ARRAYS`].
#[derive(Default)]
pub(super) struct RegionArrays {
    /// Array names, with a function from region numbers to labels.
    pub(super) columns: Vec<RegionAttribute>,
    /// Region number of each cell, array by array. In text, and in binary arrays of real numbers, the number is the
    /// bits of a real number.
    pub(super) numbers: Vec<Vec<i64>>,
    /// Ids of cells and of points that belong to another piece of the mesh.
    pub(super) ghosts: [Vec<u64>; 2],
}

/// Region numbers of all cells, and a function that maps a number to its label.
type Regions = (Vec<i64>, fn(i64) -> Option<GroupLabel>);

/// Reads point and cell data to the end of the file. `keyword` is the POINT_DATA or CELL_DATA before the cursor.
/// Returns the first two region arrays; arrays that the visitor wants go to the visitor. A damaged or unknown attribute
/// ends the reading with a remark instead of an error, as the mesh itself does not depend on data.
pub(super) fn regions(
    cursor: &mut Cursor<'_>,
    binary: bool,
    keyword: &[u8],
    visitor: &mut dyn MeshVisitor,
) -> RegionArrays {
    let of_cells = keyword == b"CELL_DATA";
    let mut data = Data {
        binary,
        of_cells,
        count: 0,
        has_text_colors: false,
        found: RegionArrays::default(),
        visitor,
    };
    let Ok(count) = cursor.integer("a count") else {
        return data.found;
    };
    data.count = count;
    while cursor.next_word() {
        let mut behind = cursor.clone();
        let keyword = quoted(behind.token().unwrap_or_default());
        if data.attribute(cursor).is_none() {
            let rest =
                format!("data from the attribute `{keyword}` on, which is damaged or not known");
            data.visitor.remark(Remark::Text(format!("the file has {rest}: they are not read")));
            // A last word has no data.
            if behind.next_word() {
                data.visitor.unsupported(&rest);
            }
            break;
        }
    }
    data.found
}

struct Data<'s> {
    binary: bool,
    /// Whether the current attributes belong to cells, not to points.
    of_cells: bool,
    /// Number of points or cells that the current attributes belong to.
    count: u64,
    /// Whether the current array has colors in text, which VTK writes and reads as bytes divided by 255
    /// (`vtkDataReader::ReadCoScalars`).
    has_text_colors: bool,
    found: RegionArrays,
    visitor: &'s mut dyn MeshVisitor,
}

impl Data<'_> {
    /// Reads the attribute at the cursor. `None` if the attribute is damaged or its keyword unknown.
    fn attribute(&mut self, cursor: &mut Cursor<'_>) -> Option<()> {
        let keyword = cursor.token()?.to_ascii_uppercase();
        match keyword.as_slice() {
            b"POINT_DATA" | b"CELL_DATA" => {
                self.of_cells = keyword == b"CELL_DATA";
                self.count = cursor.integer("a count").ok()?;
            }
            b"SCALARS" => {
                let (name, kind) = (cursor.name()?, cursor.token()?);
                let components = cursor.integer_or(1, "the number of components").ok()?;
                let mut ahead = cursor.clone();
                if ahead.next_row() && ahead.token()?.eq_ignore_ascii_case(b"LOOKUP_TABLE") {
                    *cursor = ahead;
                    cursor.rest();
                }
                self.array(cursor, name, kind, components, self.count)?;
            }
            b"VECTORS" | b"NORMALS" | b"TENSORS" | b"TENSORS6" | b"GLOBAL_IDS"
            | b"PEDIGREE_IDS" | b"EDGE_FLAGS" => {
                let components = match keyword.as_slice() {
                    b"TENSORS" => 9,
                    b"TENSORS6" => 6,
                    b"VECTORS" | b"NORMALS" => 3,
                    _ => 1,
                };
                let (name, kind) = (cursor.name()?, cursor.token()?);
                self.array(cursor, name, kind, components, self.count)?;
            }
            b"TEXTURE_COORDINATES" => {
                let name = cursor.name()?;
                let components = cursor.integer("the dimension").ok()?;
                let kind = cursor.token()?;
                self.array(cursor, name, kind, components, self.count)?;
            }
            b"COLOR_SCALARS" => {
                let name = cursor.name()?;
                let components = cursor.integer("the number of colors").ok()?;
                self.has_text_colors = !self.binary;
                let is_sound = self.array(cursor, name, b"unsigned_char", components, self.count);
                self.has_text_colors = false;
                is_sound?;
            }
            b"LOOKUP_TABLE" => {
                cursor.name()?;
                let size = cursor.integer("the size of a table").ok()?.checked_mul(4)?;
                skip_section(cursor, self.binary, b"unsigned_char", size).ok()?;
            }
            // Behind no array.
            b"METADATA" => while cursor.line().is_some_and(|line| !line.is_empty()) {},
            b"FIELD" => {
                cursor.name()?;
                for _ in 0..cursor.integer("the number of arrays").ok()? {
                    let name = array_name(cursor)?;
                    let components = cursor.integer("the number of components").ok()?;
                    let tuples = cursor.integer("the number of tuples").ok()?;
                    let kind = cursor.token()?;
                    self.array(cursor, name, kind, components, tuples)?;
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// Reads an array with its METADATA. `None` if the array is damaged.
    fn array(
        &mut self,
        cursor: &mut Cursor<'_>,
        name: &[u8],
        kind: &[u8],
        components: u64,
        tuples: u64,
    ) -> Option<()> {
        self.array_numbers(cursor, name, kind, components, tuples)?;
        skip_metadata(cursor, components);
        Some(())
    }

    /// Reads an array of regions, or an array that the visitor wants; skips any other array. `None` if the array is
    /// damaged.
    fn array_numbers(
        &mut self,
        cursor: &mut Cursor<'_>,
        name: &[u8],
        kind: &[u8],
        components: u64,
        tuples: u64,
    ) -> Option<()> {
        let name = &decoded(name)[..];
        let count = components.checked_mul(tuples)?;
        let of_all = tuples == self.count;
        let precision = precision_of(kind);
        if is_text(kind) {
            if self.visitor.asks_for_data() {
                let owners = if self.of_cells { "elements" } else { "vertices" };
                self.visitor.unsupported(&lost_text(owners, name));
            }
            return skip_section(cursor, self.binary, kind, count).ok();
        }
        if of_all
            && components == 1
            && self.visitor.asks_for_ghosts()
            && let Some(is_ghost) = vtk_ghosts(name)
        {
            let numbers = self.numbers(cursor, kind, count)?.numbers;
            let ids = (0..).zip(numbers).filter(|&(_, number)| is_ghost(number));
            self.found.ghosts[usize::from(!self.of_cells)].extend(ids.map(|(id, _)| id));
            return Some(());
        }
        if !self.of_cells
            && of_all
            && self.visitor.point_array(name, components, precision.is_some())
        {
            let Some(numbers) = self.numbers_or_skip(cursor, kind, count)? else { return Some(()) };
            self.visitor.point_numbers(numbers);
            return Some(());
        }
        let is_region = components == 1
            && names_regions(name)
            && self.found.columns.len() < MAX_ARRAYS
            && !(self.binary && kind.eq_ignore_ascii_case(b"bit"));
        if self.of_cells && of_all && is_region {
            let start = cursor.clone();
            if let Some((numbers, label)) = self.region_numbers(cursor, kind, tuples) {
                let kind = String::from_utf8_lossy(name).into_owned();
                self.found.columns.push(RegionAttribute { kind, from_dimension: 0, label });
                self.found.numbers.push(numbers);
                return Some(());
            }
            // Numbers such as NaN are no regions, but must hide no later array.
            *cursor = start;
            self.visitor.remark(unread_regions(name));
        }
        if self.of_cells
            && of_all
            && self.visitor.asks_for_cell_arrays()
            && self.visitor.cell_array(name, components, precision.is_some())
        {
            let Some(found) = self.numbers_or_skip(cursor, kind, count)? else { return Some(()) };
            self.visitor.cell_numbers(found.numbers, None);
            return Some(());
        }
        skip_section(cursor, self.binary, kind, count).ok()
    }

    /// Reads the region number of each cell, an integer or the bits of a real number. Returns the numbers and a function
    /// that maps them to labels. `None` if a number is missing or not finite.
    fn region_numbers(&self, cursor: &mut Cursor<'_>, kind: &[u8], tuples: u64) -> Option<Regions> {
        if self.binary {
            let size = size_at(cursor, kind, tuples)?;
            // Bits identify real numbers. Negative zero differs from zero in its bits but names the same region.
            let negative_zero = precision_of(kind).map(|_| i64::MIN >> (64 - 8 * size));
            let positive = |bits: i64| if Some(bits) == negative_zero { 0 } else { bits };
            let numbers = take(cursor, tuples, size).ok()?.chunks_exact(size);
            let numbers = numbers.map(|number| positive(ByteOrder::Big.signed(number))).collect();
            return Some((numbers, label_of(kind)));
        }
        let mut numbers = Vec::new();
        for _ in 0..tuples {
            cursor.next_word().then_some(())?;
            let mut number = cursor.coordinate('r', "a region").ok()?;
            if self.has_text_colors {
                number = color_byte(number);
            }
            // Adding zero makes a negative zero positive.
            numbers.push((number + 0.0).to_bits().cast_signed());
        }
        Some((numbers, number_of_bits))
    }

    /// Reads numbers as [`numbers`](Self::numbers) does. Numbers that cannot be read are skipped, so that they hide no
    /// later array. Returns `Some(None)` for skipped numbers, and `None` if the array cannot be skipped either.
    fn numbers_or_skip(
        &self,
        cursor: &mut Cursor<'_>,
        kind: &[u8],
        count: u64,
    ) -> Option<Option<PointNumbers>> {
        let start = cursor.clone();
        let numbers = self.numbers(cursor, kind, count);
        if numbers.is_none() {
            *cursor = start;
            skip_section(cursor, self.binary, kind, count).ok()?;
        }
        Some(numbers)
    }

    /// Reads `count` numbers of any type as real numbers. Only `float` and `double` arrays can be rewritten, so other
    /// types get no location.
    fn numbers(&self, cursor: &mut Cursor<'_>, kind: &[u8], count: u64) -> Option<PointNumbers> {
        let precision = precision_of(kind);
        if self.binary && kind.eq_ignore_ascii_case(b"bit") {
            let numbers = bits(take(cursor, count.div_ceil(8), 1).ok()?, count)?;
            return Some(PointNumbers { numbers, nodes: None, location: None });
        }
        if self.binary {
            let (size, value) = (size_at(cursor, kind, count)?, value_of(kind));
            let bytes = take(cursor, count, size).ok()?.chunks_exact(size);
            let numbers = bytes.map(|number| value(ByteOrder::Big.signed(number))).collect();
            let places = Offsets::Regular { start: cursor.last_taken(), stride: size };
            let stored = precision.and_then(|precision| {
                ArrayLocation::in_place(places, NumberEncoding::Binary(ByteOrder::Big, precision))
            });
            return Some(PointNumbers { numbers, nodes: None, location: stored });
        }
        let mut numbers = TextNumbers::default();
        for _ in 0..count {
            cursor.next_word().then_some(())?;
            numbers.read(cursor).ok()?;
        }
        let mut numbers = numbers.finish(precision.unwrap_or_default(), None);
        if self.has_text_colors {
            numbers.numbers.iter_mut().for_each(|number| *number = color_byte(*number));
        }
        Some(PointNumbers { location: numbers.location.filter(|_| precision.is_some()), ..numbers })
    }
}

/// Returns the byte that a color from 0 to 1 stands for.
fn color_byte(color: f64) -> f64 {
    (255.0 * color).round().clamp(0.0, 255.0)
}

/// Returns whether an array of this type holds texts instead of numbers.
fn is_text(kind: &[u8]) -> bool {
    kind.eq_ignore_ascii_case(b"string") || kind.eq_ignore_ascii_case(b"utf8_string")
}

/// Returns the precision of a number type; `None` for types of whole numbers.
fn precision_of(kind: &[u8]) -> Option<Precision> {
    match kind.to_ascii_lowercase().as_slice() {
        b"float" => Some(Precision::Single),
        b"double" => Some(Precision::Double),
        _ => None,
    }
}

/// Decodes a name: VTK writes some bytes as a percent sign and two hexadecimal digits.
fn decoded(name: &[u8]) -> Cow<'_, [u8]> {
    if !name.contains(&b'%') {
        return Cow::Borrowed(name);
    }
    let mut decoded = Vec::with_capacity(name.len());
    let mut left = name;
    while let Some((&first, rest)) = left.split_first() {
        let digits = rest.get(..2).and_then(|digits| str::from_utf8(digits).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match byte.filter(|_| first == b'%') {
            Some(byte) => {
                decoded.push(byte);
                left = &rest[2..];
            }
            None => {
                decoded.push(first);
                left = rest;
            }
        }
    }
    Cow::Owned(decoded)
}

fn number_of_bits(bits: i64) -> Option<GroupLabel> {
    Some(GroupLabel::number(f64::from_bits(bits.cast_unsigned())))
}

/// Returns a function that maps a region number to its label. The argument holds the bits of a number of this type,
/// sign-extended to 64 bits.
fn label_of(kind: &[u8]) -> fn(i64) -> Option<GroupLabel> {
    match kind.to_ascii_lowercase().as_slice() {
        b"float" => |bits| Some(GroupLabel::number(f64::from(f32::from_bits(bits as u32)))),
        b"double" => number_of_bits,
        b"unsigned_char" | b"vtktypeuint8" => |number| Some(GroupLabel::Tag(number & 0xff)),
        b"unsigned_short" | b"vtktypeuint16" => |number| Some(GroupLabel::Tag(number & 0xffff)),
        b"unsigned_int" | b"vtktypeuint32" => |number| Some(GroupLabel::Tag(number & 0xffff_ffff)),
        _ => |number| Some(GroupLabel::Tag(number)),
    }
}

/// Returns a function that maps the bits of a number of this type, sign-extended to 64 bits, to its value.
fn value_of(kind: &[u8]) -> fn(i64) -> f64 {
    match kind.to_ascii_lowercase().as_slice() {
        b"float" => |bits| f64::from(f32::from_bits(bits as u32)),
        b"double" => |bits| f64::from_bits(bits.cast_unsigned()),
        b"unsigned_char" | b"vtktypeuint8" => |number| (number & 0xff) as f64,
        b"unsigned_short" | b"vtktypeuint16" => |number| (number & 0xffff) as f64,
        b"unsigned_int" | b"vtktypeuint32" => |number| (number & 0xffff_ffff) as f64,
        b"vtktypeuint64" | b"unsigned_long" => |number| number.cast_unsigned() as f64,
        _ => |number| number as f64,
    }
}
