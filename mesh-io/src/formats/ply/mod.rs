//! PLY, as text and in binary of either byte order.
//!
//! The format: Turk, The PLY Polygon File Format (1994), <http://paulbourke.net/dataformats/ply/>. The reader uses x, y
//! and data of vertices, `vertex_indices` or `vertex_index` and data of faces, `vertex1` and `vertex2` of edges. Other
//! elements and properties are skipped. Coordinates of the type `float` have single precision in text, too.

use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, Offsets};
use crate::error::ReadError;
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::visit::items::{CellKind, Element, PointNumbers};
use crate::visit::reader::FormatReader;
use crate::visit::rows::end_of_list;
use crate::visit::storage::{ArrayLocation, CoordinateStorage};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

use header::{Items, List, Number, Property, header};

mod header;
mod plain;
pub(crate) mod write;

pub(crate) struct Ply;

/// Names of the list property with the corners of a face.
const CORNERS: [&[u8]; 2] = [b"vertex_indices", b"vertex_index"];
/// Names of the properties with the vertices of an edge.
const ENDS: [&[u8]; 2] = [b"vertex1", b"vertex2"];

impl FormatReader for Ply {
    const VERTICES: &'static str = "the list of vertices";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source);
        let (items, lists) = header(cursor)?;
        let Some(vertices) = lists.iter().position(|list| list.name == b"vertex") else {
            return Err(cursor.error("it has no element vertex", "Save the mesh again"));
        };
        if lists[..vertices].iter().any(|list| list.name == b"face" || list.name == b"edge") {
            let problem = "faces stand before the vertices";
            return Err(cursor.error(problem, "Save the vertices first"));
        }
        let of_faces = lists.iter().filter(|list| list.name == b"face");
        let faces = of_faces.fold(0, |sum: u64, list| sum.saturating_add(list.count));
        let mut layout = None;
        for list in &lists {
            match list.name {
                b"vertex" => layout = Some(items.vertices(cursor, list, visitor)?),
                b"face" => {
                    let start = cursor.clone();
                    items.elements(cursor, list, &CORNERS, 0, visitor)?;
                    items.face_data(&start, list, visitor);
                }
                // Ids of edges follow those of faces, by which data belong to faces alone.
                b"edge" => items.elements(cursor, list, &ENDS, faces, visitor)?,
                b"tristrips" => {
                    let problem = "strips of triangles are not read";
                    return Err(cursor.error(problem, "Save them as faces"));
                }
                _ => {
                    visitor.unsupported("elements that are neither vertices, faces nor edges");
                    items.each(cursor, list, 0, |_, _, _| Ok(()))?;
                }
            }
        }
        let listed = lists.iter().map(|list| list.count).fold(0, u64::saturating_add);
        if items.order.is_some() {
            end_of_bytes(cursor, listed)?;
        } else {
            end_of_list(cursor, listed, "items", |cursor| cursor.real("a number"))?;
        }
        layout.ok_or_else(|| cursor.error("it has no element vertex", "Save the mesh again"))
    }
}

/// Checks that a binary file ends after its `listed` items. Blanks and zeros may follow.
///
/// # Errors
/// At the first further byte. A count that is too small would drop elements of the mesh without a word.
fn end_of_bytes(cursor: &Cursor<'_>, listed: u64) -> Result<(), ReadError> {
    let at = Cursor::at_byte_offset(cursor.source, cursor.at_byte());
    let mut rest = cursor.clone();
    while let Some(&[byte]) = rest.take(1) {
        if byte != 0 && !byte.is_ascii_whitespace() {
            let problem =
                format!("further bytes follow the {listed} items that the header announces");
            return Err(at.error(problem, "Correct the counts, or write the mesh again"));
        }
    }
    Ok(())
}

/// The scalar properties of vertices, except coordinates.
struct Data<'l, 'a> {
    properties: Vec<(usize, &'l Property<'a>)>,
    /// The numbers of each property and their offsets, if the visitor asks for data.
    numbers: Option<Vec<(Vec<f64>, Vec<usize>)>>,
}

impl<'l, 'a> Data<'l, 'a> {
    fn new(list: &'l List<'a>, z: Option<usize>, visitor: &dyn MeshVisitor) -> Self {
        let is_data = |(index, property): &(usize, &Property<'_>)| {
            property.length.is_none() && Some(*index) != z && !matches!(property.name, b"x" | b"y")
        };
        let properties: Vec<_> = list.properties.iter().enumerate().filter(is_data).collect();
        let empty = || properties.iter().map(|_| Default::default()).collect();
        let numbers = visitor.asks_for_data().then(empty);
        Data { properties, numbers }
    }

    /// Adds the data of the next vertex, from the numbers and offsets of all its properties.
    fn push(&mut self, values: &[Vec<f64>], at: &[usize]) {
        let Some(numbers) = &mut self.numbers else { return };
        for ((numbers, places), &(index, _)) in numbers.iter_mut().zip(&self.properties) {
            numbers.push(values[index][0]);
            places.push(at[index]);
        }
    }

    fn send(self, items: Items, visitor: &mut dyn MeshVisitor) {
        let mut numbers = self.numbers.map(Vec::into_iter);
        for (_, property) in self.properties {
            let precision = property.precision();
            let own = numbers.as_mut().and_then(Iterator::next);
            if visitor.point_array(property.name, 1, precision.is_some())
                && let Some((mut numbers, places)) = own
            {
                let stored = precision.and_then(|precision| {
                    numbers.iter_mut().for_each(|number| *number = precision.rounded(*number));
                    ArrayLocation::in_place(Offsets::List(places), items.form(precision))
                });
                visitor.point_numbers(PointNumbers { numbers, nodes: None, location: stored });
            }
        }
    }
}

impl Items {
    /// Hands the numbers of each item to `take`, from item `from` on, with the offset of each property's first number.
    fn each<'a>(
        self,
        cursor: &mut Cursor<'a>,
        list: &List<'_>,
        from: u64,
        mut take: impl FnMut(&Cursor<'a>, &[Vec<f64>], &[usize]) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        // Items without properties have no bytes in the file, so the file size cannot limit their count.
        if list.properties.is_empty() {
            return Ok(());
        }
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); list.properties.len()];
        let mut places = vec![0; list.properties.len()];
        let (mut missing, mut is_plain) = (None, from > 0);
        for done in from..list.count {
            let mut item = None;
            let mut read = |cursor: &mut Cursor<'a>| {
                for (index, property) in list.properties.iter().enumerate() {
                    values[index].clear();
                    let length = match property.length {
                        None => 1,
                        Some(length) => self.value(cursor, length, &mut item)?.0 as u64,
                    };
                    for n in 0..length {
                        let (value, at) = self.value(cursor, property.number, &mut item)?;
                        if n == 0 {
                            places[index] = at;
                        }
                        values[index].push(value);
                    }
                }
                Ok(())
            };
            let read = match self.order {
                Some(_) => read(cursor),
                None => cursor
                    .row(done, list.count, "items")
                    .and_then(|()| cursor.item(&mut read, &mut missing)),
            };
            let taken = read.and_then(|()| match item {
                Some(at) => take(&Cursor::at_byte_offset(cursor.source, at), &values, &places),
                None => take(cursor, &values, &places),
            });
            match taken {
                Ok(()) => is_plain |= missing.is_none(),
                // If a single row lacks a number, later rows are read out of step, so the first short row is the error.
                Err(error) if is_plain => return Err(missing.unwrap_or(error)),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Reads a number. Returns the number and its offset. In binary, sets an empty `item` to the offset.
    fn value(
        self,
        cursor: &mut Cursor<'_>,
        number: Number,
        item: &mut Option<usize>,
    ) -> Result<(f64, usize), ReadError> {
        let Some(order) = self.order else {
            let at = cursor.at();
            let value = cursor.real("a number of an item")?;
            // Programs write `nan` for a number that they could not compute.
            if matches!(number, Number::Integer { .. }) && !value.is_finite() {
                return Err(cursor.error("an integer of an item is not finite", CORRECT));
            }
            return Ok((value, at));
        };
        let size = number.size();
        let Some(bytes) = cursor.take(size) else {
            return Err(cursor.error("the file ends within its lists", CUT_OFF));
        };
        let at = cursor.last_taken();
        item.get_or_insert(at);
        let value = match number {
            Number::Float => order.real(Precision::Single, bytes),
            Number::Double => order.real(Precision::Double, bytes),
            Number::Integer { signed: true, .. } => order.signed(bytes) as f64,
            Number::Integer { signed: false, .. } => order.whole(bytes) as f64,
        };
        Ok((value, at))
    }

    fn vertices(
        self,
        cursor: &mut Cursor<'_>,
        list: &List<'_>,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        cursor.check_vertex_count(list.count)?;
        let named =
            |name: &[u8]| list.properties.iter().position(|p| p.name == name && p.length.is_none());
        let (Some(x), Some(y)) = (named(b"x"), named(b"y")) else {
            return Err(cursor.error("vertices without x and y", "Save the mesh again"));
        };
        let number = list.properties[x].number;
        let precision = match number {
            Number::Float => Precision::Single,
            Number::Double => Precision::Double,
            Number::Integer { .. } => {
                let problem = "coordinates are whole numbers";
                return Err(cursor.error(problem, "Save them as float or double"));
            }
        };
        if list.properties[y].number != number || y != x + 1 {
            let problem = "y does not follow x with the same type";
            return Err(cursor.error(problem, "Save vertices with x, y and z in this order"));
        }
        if list.properties.iter().any(|property| property.length.is_some()) {
            visitor.unsupported("lists of numbers of vertices");
        }
        let z = named(b"z").filter(|&z| list.properties[z].precision().is_some());
        let mut z_values = ZValues::new(visitor);
        let mut data = Data::new(list, z, visitor);
        let mut id = self.plain_vertices(cursor, list, x, z, &mut z_values, visitor);
        self.each(cursor, list, id, |place, values, places| {
            data.push(values, places);
            if let Some(z) = z {
                z_values.push((places[z], values[z][0]));
            }
            let at = [values[x][0], values[y][0]];
            if !at.iter().all(|x| x.is_finite()) {
                let problem = format!("a coordinate of vertex {id} is not a finite number");
                return Err(place.error(problem, CORRECT));
            }
            visitor.node(place, id, 2, places[x], at);
            id += 1;
            Ok(())
        })?;
        visitor.end_nodes(cursor)?;
        if let Some(precision) = z.and_then(|z| list.properties[z].precision()) {
            z_values.send("z", self.form(precision), visitor);
        }
        data.send(self, visitor);
        Ok(match self.order {
            None => {
                CoordinateStorage::in_place(Format::Ply, CoordinateEncoding::Text { precision })
            }
            Some(order) => CoordinateStorage::in_place(
                Format::PlyBinary,
                CoordinateEncoding::adjacent(order, precision),
            ),
        })
    }

    /// Visits elements, whose corners are the numbers of all properties with the given names. The ids of the elements
    /// start at `first_id`.
    fn elements(
        self,
        cursor: &mut Cursor<'_>,
        list: &List<'_>,
        names: &[&[u8]],
        first_id: u64,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let properties = &list.properties;
        let is_data = |property: &Property<'_>| list.name == b"face" && property.length.is_none();
        if properties.iter().any(|own| !names.contains(&own.name) && !is_data(own)) {
            visitor.unsupported("lists of numbers of faces, and properties of edges");
        }
        let taken = self.plain_triangles(cursor, list, names, visitor);
        let mut id = first_id.saturating_add(taken);
        self.each(cursor, list, taken, |place, values, _| {
            let named = properties.iter().zip(values).filter(|(p, _)| names.contains(&p.name));
            let corners: Vec<f64> = named.flat_map(|(_, values)| values).copied().collect();
            // A corner that is negative or not whole becomes `u64::MAX`, which is no vertex.
            let node = |&corner: &f64| match corner >= 0.0 && corner.fract() == 0.0 {
                true => corner as u64,
                false => u64::MAX,
            };
            let region = [0; 2];
            match CellKind::of_polygon(corners.len() as u64) {
                Some(kind) => {
                    let mut nodes = [0; 4];
                    for (to, corner) in nodes.iter_mut().zip(&corners) {
                        *to = node(corner);
                    }
                    visitor.element(place, &Element { id, kind, region, nodes })?;
                }
                None => {
                    let corners: Vec<u64> = corners.iter().map(node).collect();
                    visitor.polygon(place, id, region, &corners)?;
                }
            }
            id += 1;
            Ok(())
        })
    }

    /// Visits the data of faces: the properties of one number. `start` is the start of the faces, which are valid.
    fn face_data(self, start: &Cursor<'_>, list: &List<'_>, visitor: &mut dyn MeshVisitor) {
        if !visitor.asks_for_cell_arrays() {
            return;
        }
        for (index, property) in list.properties.iter().enumerate() {
            let is_real = property.precision().is_some();
            if property.length.is_some()
                || CORNERS.contains(&property.name)
                || !visitor.cell_array(property.name, 1, is_real)
            {
                continue;
            }
            let mut numbers = Vec::new();
            let read = self.each(&mut start.clone(), list, 0, |_, values, _| {
                numbers.push(values[index][0]);
                Ok(())
            });
            if read.is_ok() {
                visitor.cell_numbers(numbers, None);
            }
        }
    }
}
