//! VTK's XML format of unstructured grids, `.vtu`: text, base64 and appended data, as they are or compressed by zlib or
//! LZ4.
//!
//! The format: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>. Where points are encoded, the
//! array of points alone is encoded again, and the offsets of appended arrays after it are corrected.

mod blocks;
mod document;

use crate::error::{Location, ReadError};
use crate::file::format::Format;
use crate::file::heights::{Heights, TextNumbers};
use crate::file::numbers::{Encoded, Form, Numbers, Offset, Places};
use crate::file::sink::{Column, Home, Layout, PointNumbers, Sink, Stored, Walk};
use crate::file::source::Source;
use crate::file::text::{CORRECT, CUT_OFF, Cursor, quoted};
use crate::file::vtk;
use crate::mesh::Precision;
use blocks::{Unwrapped, Wrapping};
use document::{Array, Coding, Document};
use std::ops::Range;
use std::sync::Arc;

pub(crate) struct Vtu;

/// An array of points or of their data where it is encoded.
struct Encoding {
    wrapping: Wrapping,
    old: Unwrapped,
    /// Where it stands in the file.
    range: Range<usize>,
    offsets: Arc<[Offset]>,
}

impl Encoded for Encoding {
    fn bytes(&self) -> &[u8] {
        &self.old.bytes
    }

    fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    fn wrapped(&self, new: &[u8]) -> Vec<u8> {
        self.wrapping.wrap(&self.old, new)
    }

    fn offsets(&self) -> &[Offset] {
        &self.offsets
    }
}

impl Walk for Vtu {
    const VERTICES: &'static str = "Points";

    fn walk(source: &Source, sink: &mut impl Sink) -> Result<Layout, ReadError> {
        let document = Document::read(source)?;
        let offsets = document.offsets().into();
        let file = File { source, document, offsets };
        let count = file.document.points;
        let points = file.array("Points", None)?;
        let cursor = &mut Cursor::standing_at(source, points.at);
        cursor.check_vertex_count(count)?;
        if points.components != 3 {
            let problem = format!("points of {} components", points.components);
            return Err(cursor.error(problem, "Points have three coordinates in VTK"));
        }
        let precision = match points.number.as_str() {
            "Float32" => Precision::Single,
            "Float64" => Precision::Double,
            other => {
                let problem = format!("points of the type {}", quoted(other.as_bytes()));
                return Err(cursor.error(problem, "Float32 and Float64 are read"));
            }
        };
        let mut heights = Heights::new(sink);
        let (numbers, encoded) = match points.format {
            Coding::Ascii => {
                text_points(source, points, count, &mut heights, sink)?;
                (Numbers::Text { precision }, None)
            }
            _ => {
                let (wrapping, old, range) = file.unwrap(points)?;
                let wide = precision.bytes();
                let size = count.checked_mul(3 * wide as u64);
                if Some(old.bytes.len() as u64) != size {
                    let problem = format!("{} bytes for {count} points", old.bytes.len());
                    return Err(cursor.error(problem, CORRECT));
                }
                // Raw bytes are replaced in place, all others encoded again.
                let plain = !wrapping.base64 && wrapping.compressor.is_none();
                let start = if plain { range.end - old.bytes.len() } else { 0 };
                sink.expect_nodes(old.bytes.len() / (3 * wide));
                for (index, point) in old.bytes.chunks_exact(3 * wide).enumerate() {
                    let number = |axis: usize| {
                        let bytes = &point[axis * wide..][..wide];
                        wrapping.order.real(precision, bytes)
                    };
                    let at = [number(0), number(1)];
                    if !at.iter().all(|x| x.is_finite()) {
                        let problem = format!("point {index} is not finite");
                        return Err(cursor.error(problem, "Write the mesh again"));
                    }
                    let x_at = start + index * 3 * wide;
                    sink.node(cursor, index as u64, 2, x_at, at);
                    heights.see((x_at + 2 * wide, number(2)));
                }
                let numbers = Numbers::adjacent(wrapping.order, precision);
                let offsets = Arc::clone(&file.offsets);
                let encoded = Encoding { wrapping, old, range, offsets };
                (numbers, (!plain).then(|| Box::new(encoded) as Box<dyn Encoded>))
            }
        };
        sink.end_nodes(cursor)?;
        let home = if encoded.is_some() { Home::Points } else { Home::File };
        heights.send_from("z", numbers.into(), home, sink);
        file.cells(sink)?;
        file.point_arrays(sink);
        Ok(Layout { format: Format::Vtu, numbers, encoded })
    }
}

/// Reads points written as text.
fn text_points(
    source: &Source,
    points: &Array,
    count: u64,
    heights: &mut Heights,
    sink: &mut impl Sink,
) -> Result<(), ReadError> {
    let cursor = &mut Cursor::within(source, points.content.clone());
    sink.expect_nodes(cursor.capacity(count, "0 0 0 ".len()));
    for index in 0..count {
        let mut point = [0.0; 3];
        let mut places = [0; 3];
        for (axis, x) in point.iter_mut().enumerate() {
            if !cursor.next_word() {
                let problem = format!("the array ends after {index} of {count} points");
                return Err(cursor.error(problem, CORRECT));
            }
            places[axis] = cursor.at();
            *x = cursor.coordinate(['x', 'y', 'z'][axis], format_args!("point {index}"))?;
        }
        sink.node(cursor, index, 2, places[0], [point[0], point[1]]);
        heights.see((places[2], point[2]));
    }
    Ok(())
}

struct File<'a> {
    source: &'a Source,
    document: Document,
    offsets: Arc<[Offset]>,
}

impl File<'_> {
    /// The array of a section, by its name where it is not alone.
    fn array(&self, section: &str, name: Option<&str>) -> Result<&Array, ReadError> {
        let fits = |array: &&Array| {
            array.section == section
                && name.is_none_or(|name| array.name.eq_ignore_ascii_case(name))
        };
        self.document.arrays.iter().find(fits).ok_or_else(|| {
            let name = name.unwrap_or(section);
            self.source.error(format!("it has no array of {name}"), CUT_OFF)
        })
    }

    #[cold]
    fn damaged(&self, array: &Array) -> ReadError {
        let place = Location::Line(self.source.line_of(array.at));
        let problem = format!("the array {} is damaged or cut off", quoted(array.name.as_bytes()));
        self.source.error_at(place, problem, CUT_OFF)
    }

    /// The bytes of an encoded array, how they are wrapped, and where.
    fn unwrap(&self, array: &Array) -> Result<(Wrapping, Unwrapped, Range<usize>), ReadError> {
        let Document { order, header, compressor, appended, .. } = self.document;
        let wrapping = |base64| Wrapping { order, header, compressor, base64 };
        let (wrapping, start, end) = match (&array.offset, appended) {
            (Some((offset, _)), Some(appended)) => {
                let start = appended.start.saturating_add(*offset);
                (wrapping(appended.base64), start, self.source.bytes.len())
            }
            (Some(_), None) => return Err(self.damaged(array)),
            (None, _) => {
                let content = &self.source.bytes[array.content.clone()];
                let blanks = content.iter().take_while(|&&byte| byte <= b' ').count();
                (wrapping(true), array.content.start + blanks, array.content.end)
            }
        };
        let found = self.source.bytes.get(start..end).and_then(|input| wrapping.unwrap(input));
        let found = found.ok_or_else(|| self.damaged(array))?;
        let range = start..start + found.taken;
        Ok((wrapping, found, range))
    }

    /// The whole numbers of an array.
    fn integers(&self, array: &Array) -> Result<Vec<u64>, ReadError> {
        if array.format == Coding::Ascii {
            return self.words(array, |cursor| cursor.integer("a number"));
        }
        let (wrapping, found, _) = self.unwrap(array)?;
        let size = self.size_of_integer(array)?;
        Ok(found.bytes.chunks_exact(size).map(|number| wrapping.order.whole(number)).collect())
    }

    /// The same with their signs.
    fn signed_integers(&self, array: &Array) -> Result<Vec<i64>, ReadError> {
        if array.format == Coding::Ascii {
            return self.words(array, |cursor| cursor.signed("a number"));
        }
        if array.number.starts_with('U') {
            return Ok(self.integers(array)?.into_iter().map(u64::cast_signed).collect());
        }
        let (wrapping, found, _) = self.unwrap(array)?;
        let size = self.size_of_integer(array)?;
        Ok(found.bytes.chunks_exact(size).map(|number| wrapping.order.signed(number)).collect())
    }

    /// The numbers of an array of any type.
    fn numbers(&self, array: &Array) -> Result<PointNumbers, ReadError> {
        let precision = precision_of(array);
        if array.format == Coding::Ascii {
            let cursor = &mut Cursor::within(self.source, array.content.clone());
            let mut numbers = TextNumbers::default();
            while cursor.next_word() {
                numbers.read(cursor)?;
            }
            let numbers = numbers.finish(precision.unwrap_or_default(), None);
            let stored = numbers.stored.filter(|_| precision.is_some());
            return Ok(PointNumbers { stored, ..numbers });
        }
        let Some(precision) = precision else {
            let numbers: Vec<f64> = match array.number.starts_with('U') {
                true => self.integers(array)?.into_iter().map(|number| number as f64).collect(),
                false => {
                    self.signed_integers(array)?.into_iter().map(|number| number as f64).collect()
                }
            };
            return Ok(PointNumbers { numbers, nodes: None, stored: None });
        };
        let (wrapping, old, range) = self.unwrap(array)?;
        let stride = precision.bytes();
        let numbers = old.bytes.chunks_exact(stride);
        let numbers = numbers.map(|number| wrapping.order.real(precision, number)).collect();
        let form = Form::Binary(wrapping.order, precision);
        // Raw bytes are replaced in place, all others encoded again.
        let (start, home) = match !wrapping.base64 && wrapping.compressor.is_none() {
            true => (range.end - old.bytes.len(), Home::File),
            false => {
                let offsets = Arc::clone(&self.offsets);
                (0, Home::Encoded(Box::new(Encoding { wrapping, old, range, offsets })))
            }
        };
        let stored = Some(Stored { places: Places::Regular { start, stride }, form, home });
        Ok(PointNumbers { numbers, nodes: None, stored })
    }

    /// The words of an array written as text.
    fn words<T>(
        &self,
        array: &Array,
        read: impl Fn(&mut Cursor<'_>) -> Result<T, ReadError>,
    ) -> Result<Vec<T>, ReadError> {
        let cursor = &mut Cursor::within(self.source, array.content.clone());
        let mut words = Vec::new();
        while cursor.next_word() {
            words.push(read(cursor)?);
        }
        Ok(words)
    }

    /// How many bytes a whole number of an array has.
    fn size_of_integer(&self, array: &Array) -> Result<usize, ReadError> {
        match array.number.as_str() {
            "Int8" | "UInt8" => Ok(1),
            "Int16" | "UInt16" => Ok(2),
            "Int32" | "UInt32" => Ok(4),
            "Int64" | "UInt64" => Ok(8),
            other => {
                let place = Location::Line(self.source.line_of(array.at));
                let problem = format!("whole numbers of the type {}", quoted(other.as_bytes()));
                Err(self.source.error_at(place, problem, "Save the mesh again"))
            }
        }
    }

    /// Hands the arrays of point data to the sink that it wants. Those that are damaged are passed over: the mesh does not
    /// depend on them.
    fn point_arrays(&self, sink: &mut impl Sink) {
        for array in &self.document.arrays {
            let of_points = array.section == "PointData";
            let is_real = precision_of(array).is_some();
            if of_points
                && sink.point_array(array.name.as_bytes(), array.components, is_real)
                && let Ok(numbers) = self.numbers(array)
            {
                sink.point_numbers(numbers);
            }
        }
    }

    /// Hands the arrays of cell data to the sink that it wants, but for those that tell regions.
    fn cell_arrays(&self, regions: &[&Array], sink: &mut impl Sink) {
        for array in &self.document.arrays {
            let tells_regions = regions.iter().any(|region| std::ptr::eq(*region, array));
            let is_real = precision_of(array).is_some();
            match array.section.as_str() {
                "FieldData" => sink.leaves_out("field data"),
                "CellData"
                    if !tells_regions
                        && sink.cell_array(array.name.as_bytes(), array.components, is_real) =>
                {
                    match self.numbers(array) {
                        Ok(numbers) => sink.cell_numbers(numbers.numbers, None),
                        Err(_) => sink.leaves_out("cell data that are damaged"),
                    }
                }
                _ => {}
            }
        }
    }

    /// Hands the cells to the sink.
    fn cells(&self, sink: &mut impl Sink) -> Result<(), ReadError> {
        let list = self.array("Cells", Some("connectivity"))?;
        let connectivity = self.integers(list)?;
        let offsets = self.integers(self.array("Cells", Some("offsets"))?)?;
        let types = self.integers(self.array("Cells", Some("types"))?)?;
        let cursor = &Cursor::standing_at(self.source, list.at);
        let cells = self.document.cells;
        let counts = [offsets.len(), types.len()].map(|count| count as u64);
        if counts != [cells; 2] {
            let [offsets, types] = counts;
            let problem = format!("{offsets} offsets and {types} types for {cells} cells");
            return Err(cursor.error(problem, CORRECT));
        }
        let most = connectivity.len() as u64;
        if !offsets.is_sorted() || offsets.last().is_some_and(|&last| last > most) {
            return Err(cursor.error("the offsets do not fit the connectivity", CORRECT));
        }
        let names_regions = |array: &&Array| {
            let named = vtk::names_regions(array.name.as_bytes());
            array.section == "CellData" && array.components == 1 && named
        };
        // Damaged data are no reason to refuse a mesh that does not depend on them.
        let arrays = self.document.arrays.iter().filter(names_regions);
        let read = |array| Some((array, self.signed_integers(array).ok()?));
        let (arrays, regions): (Vec<&Array>, Vec<_>) = arrays.filter_map(read).take(2).unzip();
        sink.columns(arrays.iter().map(|array| Column::tags(&array.name, 0)).collect());
        if sink.asks_for_data() {
            self.cell_arrays(&arrays, sink);
        }
        sink.expect_elements(offsets.len());
        let mut start = 0;
        for (tag, (&end, &cell_type)) in offsets.iter().zip(&types).enumerate() {
            let (tag, points) = (tag as u64, &connectivity[start..end as usize]);
            start = end as usize;
            let mut region = [0; 2];
            for (number, regions) in region.iter_mut().zip(&regions) {
                *number = regions.get(tag as usize).copied().unwrap_or(0);
            }
            vtk::Cell { tag, cell_type, points, region }.send(cursor, sink)?;
        }
        Ok(())
    }
}

/// How many digits the numbers of an array have, if they are real.
fn precision_of(array: &Array) -> Option<Precision> {
    match array.number.as_str() {
        "Float32" => Some(Precision::Single),
        "Float64" => Some(Precision::Double),
        _ => None,
    }
}
