//! What readers make of a file, item by item, and who takes it.

use crate::error::ReadError;
use crate::file::format::Format;
use crate::file::label::Label;
use crate::file::numbers::{Encoded, Form, Numbers, Places};
use crate::file::parallel_rows::take_rows;
use crate::file::records::{NodeRecords, TriangleRecords};
use crate::file::source::{Named, Source};
use crate::file::text::Cursor;
use crate::periodic::Motion;
use std::sync::Arc;

/// The kinds of elements: triangles to smooth, and others whose vertices stay fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Point,
    /// A corner of a polygon with more corners than a quadrilateral.
    Corner,
    Line,
    Triangle,
    Quadrilateral,
}

impl Kind {
    pub(crate) fn nodes(self) -> usize {
        match self {
            Kind::Point | Kind::Corner => 1,
            Kind::Line => 2,
            Kind::Triangle => 3,
            Kind::Quadrilateral => 4,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Kind::Point => "point",
            Kind::Corner => "polygon",
            Kind::Line => "line",
            Kind::Triangle => "triangle",
            Kind::Quadrilateral => "quadrilateral",
        }
    }

    /// The dimension of the elements: 0 for points, 1 for lines, 2 for surfaces.
    pub(crate) fn dimension(self) -> u8 {
        match self {
            Kind::Point => 0,
            Kind::Line => 1,
            Kind::Triangle | Kind::Quadrilateral | Kind::Corner => 2,
        }
    }

    /// The kind of a polygon with so many corners, if it is one.
    pub(crate) fn of_polygon(corners: u64) -> Option<Kind> {
        [Kind::Point, Kind::Line, Kind::Triangle, Kind::Quadrilateral]
            .into_iter()
            .find(|kind| kind.nodes() as u64 == corners)
    }
}

/// One element, as the file has it.
pub(crate) struct Element {
    /// The file's number for it; where it has none, its position in the list, counted as the file counts.
    pub(crate) tag: u64,
    pub(crate) kind: Kind,
    /// What names its region, of what the format has for that; zeros where it has nothing.
    pub(crate) region: [i64; 2],
    /// As many node tags as the kind has.
    pub(crate) nodes: [u64; 4],
}

/// What one of the numbers of [`Element::region`] tells.
pub(crate) struct Column {
    /// What the format calls the groups that the number tells apart: `physical`, `reference`, or the name of an array.
    pub(crate) what: String,
    /// The least dimension of elements that have the number.
    pub(crate) from_dimension: u8,
    /// The label that the number stands for; none if elements with this number are of no group.
    pub(crate) label: fn(i64) -> Option<Label>,
}

impl Column {
    /// A column of tags, all of which are groups.
    pub(crate) fn tags(what: &str, from_dimension: u8) -> Column {
        Column { what: what.into(), from_dimension, label: |tag| Some(Label::Tag(tag)) }
    }

    /// A column of tags of which zero stands for no group.
    pub(crate) fn tags_from_one(what: &str) -> Column {
        let label = |tag| (tag != 0).then_some(Label::Tag(tag));
        Column { what: what.into(), from_dimension: 0, label }
    }
}

/// A group that elements belong to for where they stand in the file.
#[derive(Clone, Debug)]
pub(crate) struct Within<'w> {
    /// What the format calls such a group.
    pub(crate) what: &'w str,
    pub(crate) label: Label,
    /// The dimension of the group, where that is not the dimension of each element.
    pub(crate) dimension: Option<u8>,
}

/// Takes what a file lists: first all nodes, then all elements, each in the order of the file.
pub(crate) trait Sink {
    /// Whether it uses the cursor for nothing but errors. Then it may also be handed what was read in parallel, with
    /// another cursor. Where it returns an error it must not have changed.
    fn takes_ahead(&self) -> bool {
        false
    }
    /// Announces about how many nodes follow.
    fn expect_nodes(&mut self, _count: usize) {}
    /// Takes a node whose coordinates were just read. `dimension` is that of the model entity it lies on,
    /// where the file says so; else 2.
    fn node(&mut self, cursor: &Cursor<'_>, tag: u64, dimension: u64, x_at: usize, at: [f64; 2]);
    /// Takes nodes of a list in binary, from the first one on, and returns how many. The others are to be handed to
    /// [`node`](Self::node).
    fn node_records(&mut self, _records: &NodeRecords<'_>) -> usize {
        0
    }
    /// Ends the list of nodes.
    fn end_nodes(&mut self, _cursor: &Cursor<'_>) -> Result<(), ReadError> {
        Ok(())
    }
    /// Announces about how many elements follow.
    fn expect_elements(&mut self, _count: usize) {}
    /// Takes an element that was just read.
    fn element(&mut self, cursor: &Cursor<'_>, element: &Element) -> Result<(), ReadError>;
    /// Takes triangles of a list in binary, from the first one on, and returns how many. The others are to be handed to
    /// [`element`](Self::element).
    fn triangle_records(&mut self, _records: &TriangleRecords<'_>) -> usize {
        0
    }
    /// Takes a polygon of more than four corners, which stay fixed.
    fn polygon(
        &mut self,
        cursor: &Cursor<'_>,
        (tag, region): (u64, [i64; 2]),
        corners: &[u64],
    ) -> Result<(), ReadError> {
        corners.iter().try_for_each(|&corner| {
            let nodes = [corner, 0, 0, 0];
            self.element(cursor, &Element { tag, kind: Kind::Corner, region, nodes })
        })
    }
    /// Takes a line through any number of nodes, which stay fixed.
    fn polyline(
        &mut self,
        cursor: &Cursor<'_>,
        (tag, region): (u64, [i64; 2]),
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        nodes.iter().try_for_each(|&node| {
            let nodes = [node, 0, 0, 0];
            self.element(cursor, &Element { tag, kind: Kind::Point, region, nodes })
        })
    }
    /// Whether it asks for vertices that belong together in pairs, as where a model is periodic. If not, readers may leave out the call
    /// below.
    fn asks_for_pairs(&self) -> bool {
        false
    }
    /// Takes what the file says of such vertices; `None` if that could not be read.
    fn pairs(&mut self, _pairs: Option<Vec<Pairs>>) {}
    /// Takes a remark for the user, one line.
    fn note(&mut self, _note: &str) {}

    /// Whether it asks for groups. If not, readers may leave out the calls below.
    fn asks_for_groups(&self) -> bool {
        false
    }
    /// Takes what the numbers of each element's region tell, before the first element.
    fn columns(&mut self, _columns: Vec<Column>) {}
    /// Takes the groups that the elements that follow belong to besides, until it is called again.
    fn within(&mut self, _groups: &[Within<'_>]) {}
    /// Takes the tag of a group that a node belongs to, by the position of the node among those that were taken.
    fn node_within(&mut self, _node: u32, _what: &str, _tag: i64) {}
    /// Takes the name of the groups of a tag, of one dimension or of all.
    fn name(&mut self, _what: &str, _dimension: Option<u8>, _tag: i64, _name: &[u8]) {}

    /// Whether it asks for data of points that a reading may leave out: third coordinates that are all the same, and
    /// lists after the elements.
    fn asks_for_data(&self) -> bool {
        false
    }
    /// Takes the name of an array of point data, how many numbers it has a point, and whether these are real numbers, not
    /// whole ones. Third coordinates are such an array too. Whether its numbers are wanted.
    fn point_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes notice that nodes have parameters on a surface of the model. Whether these are wanted, two numbers a node.
    fn parameters(&mut self, _surface: i64) -> bool {
        false
    }
    /// Takes the parameters that were announced last and are wanted.
    fn parameter_numbers(&mut self, _numbers: PointNumbers) {}
    /// Announces third coordinates or depths as an array of point data.
    fn height_array(&mut self, name: &[u8]) -> bool {
        self.point_array(name, 1, true)
    }
    /// Takes the name of an array of cell data, as [`point_array`](Self::point_array) does those of points. Only a sink that
    /// asks for data is to be told.
    fn cell_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes the numbers of the array of cell data that was announced last and is wanted. `tags` are those of the elements
    /// that have them.
    fn cell_numbers(&mut self, _numbers: Vec<f64>, _tags: Option<Vec<u64>>) {}
    /// Takes what the file holds that is handed on nowhere, a few words. Only a sink that asks for data is to be told.
    fn leaves_out(&mut self, _what: &str) {}
    /// Takes the numbers of the array that was announced last and is wanted.
    fn point_numbers(&mut self, _numbers: PointNumbers) {}
}

/// Nodes that belong together in pairs.
#[derive(Debug, PartialEq)]
pub(crate) struct Pairs {
    /// The motion that takes the first of each pair to the second, if the file gives it.
    pub(crate) motion: Option<Motion>,
    /// The tags of both nodes of each pair; none if the file gives the motion alone.
    pub(crate) nodes: Vec<[u64; 2]>,
}

/// The numbers of an array of point data.
pub(crate) struct PointNumbers {
    /// Those of one point after those of another, in the order of the file.
    pub(crate) numbers: Vec<f64>,
    /// The tag of the node that each tuple belongs to, if they are not those of all nodes in their order.
    pub(crate) nodes: Option<Vec<u64>>,
    /// Where they stand; none if they cannot be replaced.
    pub(crate) stored: Option<Stored>,
}

/// Where the numbers of an array stand.
pub(crate) struct Stored {
    pub(crate) places: Places,
    pub(crate) form: Form,
    pub(crate) home: Home,
    /// Which file of the mesh that is.
    pub(crate) part: usize,
}

impl Stored {
    /// Numbers that stand in the file itself.
    pub(crate) fn in_place(places: Places, form: Form) -> Option<Stored> {
        Some(Stored { places, form, home: Home::File, part: 0 })
    }
}

/// What bytes the places of numbers are those of.
pub(crate) enum Home {
    File,
    /// Those of the encoded points.
    Points,
    /// Those of an array that is encoded itself, perhaps with other arrays.
    Encoded(Arc<dyn Encoded>),
}

/// How a file has its numbers, known once it was read.
pub(crate) struct Layout {
    pub(crate) format: Format,
    pub(crate) numbers: Numbers,
    /// The points, if they are encoded. Places of coordinates are then those in its bytes.
    pub(crate) encoded: Option<Box<dyn Encoded>>,
    /// Where the coordinates stand, if a vertex may have them in several places.
    pub(crate) copies: Option<Copies>,
    /// Which file of the mesh has the coordinates: 0, or the one beside it of this number, counted from one.
    pub(crate) part: usize,
}

/// All places of coordinates in a file that repeats them.
pub(crate) struct Copies {
    /// Where each x starts, ascending.
    pub(crate) x_at: Vec<usize>,
    /// The index of the vertex of each.
    pub(crate) vertices: Vec<u32>,
}

impl Layout {
    /// Of a file that has its coordinates in place.
    pub(crate) fn in_place(format: Format, numbers: Numbers) -> Layout {
        Layout { format, numbers, encoded: None, copies: None, part: 0 }
    }
}

/// A format of one file, by the way through it.
pub(crate) trait Walk {
    /// Where the file lists its vertices, for messages.
    const VERTICES: &'static str;
    /// The files that it names, in which it has numbers.
    ///
    /// # Errors
    /// If it is damaged.
    fn beside(_source: &Source) -> Result<Vec<Named>, ReadError> {
        Ok(Vec::new())
    }
    /// Feeds the file's nodes and elements to the sink.
    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError>;
}

/// The reader of a format of one file. All that is read of a file is read by its one way through it, which takes any sink, so
/// that it is compiled once.
pub(crate) struct Reader {
    /// [`Walk::walk`].
    pub(crate) walk: fn(&Source, &mut dyn Sink) -> Result<Layout, ReadError>,
    /// [`Walk::beside`].
    pub(crate) beside: fn(&Source) -> Result<Vec<Named>, ReadError>,
    /// [`Walk::VERTICES`].
    pub(crate) vertices: &'static str,
}

impl Reader {
    pub(crate) const fn of<W: Walk>() -> Reader {
        Reader { walk: W::walk, beside: W::beside, vertices: W::VERTICES }
    }
}

/// Reads a list of one row an item and hands the items to the sink with their positions: on all threads as far as its
/// rows are plain and the sink allows that, and then row by row, or as the cursor's syntax has items on lines.
pub(crate) fn each_row<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    what: &str,
    sink: &mut dyn Sink,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(&Cursor<'a>, &mut dyn Sink, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let next = |cursor: &mut Cursor<'a>, done: u64| cursor.row(done, count, what);
    each_item(cursor, count, sink, next, |cursor, _| read(cursor), take)
}

/// The same, where `next` moves to the next item, given how many were read, and `read` may be told its position for what it says in
/// errors.
pub(crate) fn each_item<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    sink: &mut dyn Sink,
    next: impl Fn(&mut Cursor<'a>, u64) -> Result<(), ReadError>,
    read: impl Fn(&mut Cursor<'a>, Option<u64>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(&Cursor<'a>, &mut dyn Sink, u64, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut done = 0;
    if sink.takes_ahead() {
        // The sink uses this cursor for errors only. They are dropped: reading row by row meets them again.
        let nowhere = &Cursor::new(cursor.source);
        take_rows(
            cursor,
            count,
            |cursor| read(cursor, None),
            |item| {
                let taken = take(nowhere, sink, done, item).is_ok();
                done += u64::from(taken);
                taken
            },
        );
        if done > 0 {
            // It stands on the last row, before its words. A reader that goes on by words is to find none of them.
            cursor.rest();
        }
    }
    let mut missing = None;
    let mut is_plain = done > 0;
    while done < count {
        let read = |cursor: &mut Cursor<'a>| read(cursor, Some(done));
        let item = next(cursor, done).and_then(|()| cursor.item(read, &mut missing));
        match item.and_then(|item| take(cursor, sink, done, item)) {
            Ok(()) => {}
            // Where a single row of many lacks a number, the next ones are read wrongly.
            Err(error) if is_plain => return Err(missing.unwrap_or(error)),
            Err(error) => return Err(error),
        }
        is_plain |= missing.is_none();
        done += 1;
    }
    Ok(())
}

/// The same for all rows that follow, of whatever kind each is.
pub(crate) fn all_rows<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    sink: &mut dyn Sink,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(&Cursor<'a>, &mut dyn Sink, T) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    if sink.takes_ahead() && cursor.is_long() {
        let nowhere = &Cursor::new(cursor.source);
        take_rows(cursor, u64::MAX, &read, |item| take(nowhere, sink, item).is_ok());
    }
    while cursor.next_row() {
        let item = read(cursor)?;
        take(cursor, sink, item)?;
    }
    Ok(())
}

/// Reads the numbers of an element's nodes.
#[inline]
pub(crate) fn nodes(cursor: &mut Cursor<'_>, kind: Kind) -> Result<[u64; 4], ReadError> {
    let mut nodes = [0; 4];
    for node in &mut nodes[..kind.nodes()] {
        *node = cursor.integer(format_args!("a vertex of a {}", kind.name()))?;
    }
    Ok(nodes)
}

/// The error that a file holds elements of a volume.
#[cold]
pub(crate) fn volume(cursor: &Cursor<'_>, what: &str) -> ReadError {
    let problem = format!("{what} make this a volume mesh");
    cursor.error(problem, "Only triangles of the plane are smoothed: save a mesh of the plane")
}
