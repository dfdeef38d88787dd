//! VTK's XML format of unstructured grids, `.vtu`: text, base64 and appended data, as they are or compressed by zlib or
//! LZ4.
//!
//! The format: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>. Where points are encoded, the
//! array of points alone is encoded again, and the offsets of appended arrays after it are corrected.

mod blocks;
mod document;

use crate::error::{Location, ReadError};
use crate::file::format::Format;
use crate::file::numbers::{Encoded, Numbers, Splice};
use crate::file::sink::{Column, Layout, Sink, Walk};
use crate::file::source::Source;
use crate::file::text::{CORRECT, CUT_OFF, Cursor, quoted};
use crate::file::vtk;
use crate::mesh::Precision;
use blocks::{Unwrapped, Wrapping};
use document::{Array, Coding, Document};
use std::ops::Range;

pub(crate) struct Vtu;

/// The array of points where it is encoded.
struct Points {
    wrapping: Wrapping,
    old: Unwrapped,
    /// Where it stands in the file.
    range: Range<usize>,
    /// The offsets of the appended arrays that stand after it, and where the file has them.
    later: Vec<(usize, Range<usize>)>,
}

impl Encoded for Points {
    fn bytes(&self) -> &[u8] {
        &self.old.bytes
    }

    fn ranges(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<_> = self.later.iter().map(|(_, range)| range.clone()).collect();
        ranges.push(self.range.clone());
        ranges.sort_by_key(|range| range.start);
        ranges
    }

    fn splices(&self, new: &[u8]) -> Vec<Splice> {
        let wrapped = self.wrapping.wrap(&self.old, new);
        let offset = |(offset, range): &(usize, Range<usize>)| {
            let moved = offset - self.range.len() + wrapped.len();
            Splice { range: range.clone(), bytes: moved.to_string().into_bytes() }
        };
        let mut splices: Vec<Splice> = match wrapped.len() == self.range.len() {
            true => Vec::new(),
            false => self.later.iter().map(offset).collect(),
        };
        splices.push(Splice { range: self.range.clone(), bytes: wrapped });
        splices.sort_by_key(|splice| splice.range.start);
        splices
    }
}

impl Walk for Vtu {
    const VERTICES: &'static str = "Points";

    fn walk(source: &Source, sink: &mut impl Sink) -> Result<Layout, ReadError> {
        let file = File { source, document: Document::read(source)? };
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
        let (numbers, encoded) = match points.format {
            Coding::Ascii => {
                text_points(source, points, count, sink)?;
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
                    sink.node(cursor, index as u64, 2, start + index * 3 * wide, at);
                }
                let numbers = Numbers::adjacent(wrapping.order, precision);
                let later = file.later_than(points);
                let encoded = Points { wrapping, old, range, later };
                (numbers, (!plain).then(|| Box::new(encoded) as Box<dyn Encoded>))
            }
        };
        sink.end_nodes(cursor)?;
        file.cells(sink)?;
        file.point_arrays(sink)?;
        if file.document.arrays.iter().any(|array| array.section == "PointData") {
            sink.note("point data stay with their points: where those move, they no longer fit");
        }
        Ok(Layout { format: Format::Vtu, numbers, encoded })
    }
}

/// Reads points written as text.
fn text_points(
    source: &Source,
    points: &Array,
    count: u64,
    sink: &mut impl Sink,
) -> Result<(), ReadError> {
    let cursor = &mut Cursor::within(source, points.content.clone());
    sink.expect_nodes(cursor.capacity(count, "0 0 0 ".len()));
    for index in 0..count {
        let mut point = [0.0; 3];
        let mut x_at = 0;
        for (axis, x) in point.iter_mut().enumerate() {
            if !cursor.next_word() {
                let problem = format!("the array ends after {index} of {count} points");
                return Err(cursor.error(problem, CORRECT));
            }
            if axis == 0 {
                x_at = cursor.at();
            }
            *x = cursor.coordinate(['x', 'y', 'z'][axis], format_args!("point {index}"))?;
        }
        sink.node(cursor, index, 2, x_at, [point[0], point[1]]);
    }
    Ok(())
}

struct File<'a> {
    source: &'a Source,
    document: Document,
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
    fn numbers(&self, array: &Array) -> Result<Vec<f64>, ReadError> {
        if array.format == Coding::Ascii {
            return self.words(array, |cursor| cursor.coordinate('v', "a point"));
        }
        let precision = match array.number.as_str() {
            "Float32" => Precision::Single,
            "Float64" => Precision::Double,
            number if number.starts_with('U') => {
                return Ok(self.integers(array)?.into_iter().map(|number| number as f64).collect());
            }
            _ => {
                let numbers = self.signed_integers(array)?;
                return Ok(numbers.into_iter().map(|number| number as f64).collect());
            }
        };
        let (wrapping, found, _) = self.unwrap(array)?;
        let numbers = found.bytes.chunks_exact(precision.bytes());
        Ok(numbers.map(|number| wrapping.order.real(precision, number)).collect())
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

    /// Hands the arrays of point data to the sink that it wants.
    fn point_arrays(&self, sink: &mut impl Sink) -> Result<(), ReadError> {
        for array in &self.document.arrays {
            let of_points = array.section == "PointData";
            if of_points && sink.point_array(array.name.as_bytes(), array.components) {
                sink.point_numbers(self.numbers(array)?);
            }
        }
        Ok(())
    }

    /// The appended arrays that stand after this one.
    fn later_than(&self, points: &Array) -> Vec<(usize, Range<usize>)> {
        let Some((before, _)) = points.offset else {
            return Vec::new();
        };
        let offsets = self.document.arrays.iter().filter_map(|array| array.offset.clone());
        offsets.filter(|(offset, _)| *offset > before).collect()
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
