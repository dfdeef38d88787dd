//! VTK's legacy `.vtk`: unstructured grids and polygonal data, as text and in binary.
//!
//! The format: <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>, versions 1.0 to 5.1. Binary
//! numbers are big-endian. Points of the type `float` have single precision in text too, as VTK parses them. Region
//! arrays of cells are read with the mesh, other point and cell data on request.

mod data;
mod lists;
mod skip;

use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, NumberEncoding};
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::vtk::regions::RegionNumbers;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::token::quoted;
use crate::visit::ghosts::GhostNodes;
use crate::visit::reader::FormatReader;
use crate::visit::records::{NodeIds, NodeRecords};
use crate::visit::rows::each_row;
use crate::visit::send::REWRITE;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use data::RegionArrays;
use lists::{Cells, List};
use skip::take;

pub(crate) struct Vtk;

impl FormatReader for Vtk {
    const VERTICES: &'static str = "POINTS";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source);
        cursor.line();
        cursor.line();
        cursor.row(0, 1, "lines that say ASCII or BINARY")?;
        let binary = match cursor.token().unwrap_or_default() {
            b"ASCII" | b"ascii" => false,
            b"BINARY" | b"binary" => true,
            other => {
                let problem = format!("`{}` is neither ASCII nor BINARY", quoted(other));
                return Err(cursor.error(problem, CORRECT));
            }
        };
        let mut cells: Vec<Cells<'_>> = Vec::new();
        let mut precision = None;
        let mut z_values = None;
        let mut regions = RegionArrays::default();
        while cursor.next_word() {
            // VTK ignores the case of keywords.
            let keyword = cursor.token().unwrap_or_default().to_ascii_uppercase();
            match keyword.as_slice() {
                b"DATASET" => dataset(cursor)?,
                b"POINTS" => {
                    if precision.is_some() {
                        let problem = "this is the second list of POINTS";
                        return Err(cursor.error(problem, "Save each mesh to a separate file"));
                    }
                    let mut seen = ZValues::new(visitor);
                    precision = Some(points(cursor, binary, &mut seen, visitor)?);
                    skip::skip_metadata(cursor, 3);
                    z_values = Some(seen);
                }
                b"CELLS" | b"POLYGONS" | b"LINES" | b"VERTICES" | b"TRIANGLE_STRIPS" => {
                    let kind = match keyword.as_slice() {
                        b"CELLS" => List::Cells,
                        b"POLYGONS" => List::Polygons,
                        b"TRIANGLE_STRIPS" => List::Strips,
                        b"LINES" => List::Lines,
                        _ => List::Vertices,
                    };
                    cells.push(lists::read(cursor, binary, kind)?);
                }
                b"CELL_TYPES" => {
                    let count = cursor.integer("the number of cell types")?;
                    let types = Some(lists::integers(cursor, count, binary.then_some(4))?);
                    skip::skip_metadata(cursor, 1);
                    match cells.last_mut() {
                        Some(cells) if cells.count as u64 == count => cells.types = types,
                        _ => {
                            let problem = format!(
                                "the number of cell types, {count}, is not the number of cells"
                            );
                            return Err(cursor.error(problem, CORRECT));
                        }
                    }
                }
                b"METADATA" => while cursor.line().is_some_and(|line| !line.is_empty()) {},
                b"FIELD" => {
                    visitor.unsupported("field data");
                    skip::skip_field(cursor, binary)?;
                }
                // Point and cell data extend to the end of the file.
                b"POINT_DATA" | b"CELL_DATA" => {
                    regions = data::regions(cursor, binary, &keyword, visitor);
                    break;
                }
                other => {
                    let problem = format!("the keyword `{}` is not known here", quoted(other));
                    return Err(cursor.error(problem, "Save as an unstructured grid"));
                }
            }
        }
        let Some(precision) = precision else {
            return Err(source.error("it has no POINTS", "Save the mesh again"));
        };
        visitor.end_nodes(cursor)?;
        if let Some(z_values) = z_values {
            let form = match binary {
                true => NumberEncoding::Binary(ByteOrder::Big, precision),
                false => NumberEncoding::Text(precision),
            };
            z_values.send("z", form, visitor);
        }
        visitor.region_attributes(regions.columns);
        cells.sort_by_key(|cells| cells.kind);
        let [ghost_cells, ghost_points] = regions.ghosts;
        let regions = RegionNumbers::from_iter(regions.numbers);
        let send = |visitor: &mut dyn MeshVisitor| {
            let mut id = 0;
            cells.iter().try_for_each(|cells| cells.send(cursor, &regions, &mut id, visitor))
        };
        send(visitor)?;
        if !ghost_points.is_empty() {
            visitor.ghosts("ghost point", ghost_points.len() as u64, &ghost_points);
        }
        GhostNodes::of(ghost_cells.into_iter().collect()).send(visitor, send)?;
        let (format, numbers) = match binary {
            false => (Format::Vtk, CoordinateEncoding::Text { precision }),
            true => (Format::VtkBinary, CoordinateEncoding::adjacent(ByteOrder::Big, precision)),
        };
        Ok(CoordinateStorage::in_place(format, numbers))
    }
}

fn dataset(cursor: &mut Cursor<'_>) -> Result<(), ReadError> {
    let kind = cursor.token().unwrap_or_default();
    match kind.to_ascii_uppercase().as_slice() {
        b"UNSTRUCTURED_GRID" | b"POLYDATA" => Ok(()),
        other => {
            let problem = format!("datasets of kind {} have no triangles", quoted(other));
            Err(cursor.error(problem, "Save as an unstructured grid (UNSTRUCTURED_GRID)"))
        }
    }
}

/// Reads the points after the keyword POINTS, three coordinates each. Returns the precision of the coordinates.
fn points(
    cursor: &mut Cursor<'_>,
    binary: bool,
    z_values: &mut ZValues,
    visitor: &mut dyn MeshVisitor,
) -> Result<Precision, ReadError> {
    let count = cursor.vertex_count()?;
    let precision = match cursor.token().unwrap_or_default().to_ascii_lowercase().as_slice() {
        b"float" => Precision::Single,
        b"double" => Precision::Double,
        other => {
            let problem = format!("points are of the type `{}`", quoted(other));
            return Err(cursor.error(problem, "Points of the types float and double are read"));
        }
    };
    if binary {
        let width = precision.bytes();
        let bytes = take(cursor, count, 3 * width)?;
        let start = cursor.last_taken();
        let count = bytes.len() / (3 * width);
        let [x, y, z] = [0, 1, 2].map(|axis| {
            NumberField::new(bytes.get(axis * width..), 3 * width, width, ByteOrder::Big)
        });
        let place = |index| Cursor::at_byte_offset(cursor.source, start + index * 3 * width);
        let not_finite = |index| place(index).error("a coordinate is not a finite number", REWRITE);
        let records = NodeRecords { count, x, y, x_offset: start, ids: NodeIds::Consecutive(0) };
        records.send(visitor, place, not_finite)?;
        z_values.push_records(z, count, start + 2 * width);
        return Ok(precision);
    }
    visitor.expect_nodes(cursor.capacity(count, "0 0 0\n".len()));
    // Points may also be words anywhere on lines, even on the line of the keyword. If the rows do not hold a point
    // each, `rest` reads all points word by word; `done` counts those already visited.
    let mut rest = cursor.clone();
    let mut done = 0;
    let in_rows = if cursor.is_at_end() { count } else { 0 };
    let plain = each_row(
        cursor,
        in_rows,
        "points",
        visitor,
        |cursor| {
            let point = cursor.point("a point")?;
            let z = cursor.z("a point")?;
            match cursor.is_at_end() {
                true => Ok((point, z)),
                false => Err(cursor.error("more than a point on a line", CORRECT)),
            }
        },
        |cursor, visitor, index, ((x_at, at), z)| {
            visitor.node(cursor, index, 2, x_at, at);
            z_values.push(z);
            done = index + 1;
            Ok(())
        },
    );
    if plain.is_ok() && in_rows == count {
        return Ok(precision);
    }
    for index in 0..count {
        let mut places = [0; 3];
        let mut point = [0.0; 3];
        for (axis, x) in point.iter_mut().enumerate() {
            if !rest.next_word() {
                let problem = format!("the file ends after {index} of {count} points");
                return Err(rest.error(problem, CUT_OFF));
            }
            places[axis] = rest.at();
            *x = rest.coordinate(['x', 'y', 'z'][axis], format_args!("point {index}"))?;
        }
        if index >= done {
            visitor.node(&rest, index, 2, places[0], [point[0], point[1]]);
            z_values.push((places[2], point[2]));
        }
    }
    *cursor = rest;
    Ok(precision)
}
