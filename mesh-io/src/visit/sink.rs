//! The items that readers hand on, and the trait of what takes them.

use crate::content::constraints::Affine;
use crate::content::label::Label;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::{Encoded, Form, Numbers, Places, Splice};
use crate::error::{ReadError, WriteError};
use crate::format::Format;
use crate::text::cursor::Cursor;
use crate::text::parallel_rows::take_rows;
use crate::visit::records::{NodeRecords, TriangleRecords};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The kinds of elements. The vertices of all elements but triangles are constraints.
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

    /// Returns the dimension of the elements: 0 for points, 1 for lines, 2 for surfaces.
    pub(crate) fn dimension(self) -> u8 {
        match self {
            Kind::Point => 0,
            Kind::Line => 1,
            Kind::Triangle | Kind::Quadrilateral | Kind::Corner => 2,
        }
    }

    /// Returns the kind of a polygon with this many corners, if there is one.
    pub(crate) fn of_polygon(corners: u64) -> Option<Kind> {
        [Kind::Point, Kind::Line, Kind::Triangle, Kind::Quadrilateral]
            .into_iter()
            .find(|kind| kind.nodes() as u64 == corners)
    }
}

/// An element of a file.
pub(crate) struct Element {
    /// The file's number of the element. If it has none, its position in the list, counted as the file counts.
    pub(crate) tag: u64,
    pub(crate) kind: Kind,
    /// Numbers that name the element's region; 0 where the format has none.
    pub(crate) region: [i64; 2],
    /// The tags of as many nodes as the kind has.
    pub(crate) nodes: [u64; 4],
}

/// The meaning of one number of [`Element::region`].
pub(crate) struct Column {
    /// The kind of group that the number stands for: `physical`, `reference`, or the name of an array.
    pub(crate) what: String,
    /// The least dimension of elements that have this number.
    pub(crate) from_dimension: u8,
    /// Returns the label that a number stands for; `None` if it stands for no group.
    pub(crate) label: fn(i64) -> Option<Label>,
}

impl Column {
    /// Makes a column of tags that all stand for groups.
    pub(crate) fn tags(what: &str, from_dimension: u8) -> Column {
        Column { what: what.into(), from_dimension, label: |tag| Some(Label::Tag(tag)) }
    }

    /// Makes a column of tags in which 0 stands for no group.
    pub(crate) fn tags_from_one(what: &str) -> Column {
        let label = |tag| (tag != 0).then_some(Label::Tag(tag));
        Column { what: what.into(), from_dimension: 0, label }
    }
}

/// A group whose elements stand together in the file.
#[derive(Clone, Debug)]
pub(crate) struct Within<'w> {
    /// The kind of group, as the format calls it.
    pub(crate) what: &'w str,
    pub(crate) label: Label,
    /// The dimension of the group, if it differs from that of its elements.
    pub(crate) dimension: Option<u8>,
}

/// Takes the items of a file: first all nodes, then all elements, each in the order of the file.
pub(crate) trait Sink {
    /// Whether the sink uses the cursor only for errors. Then items that were read in parallel may come with another
    /// cursor, and a call that returns an error must leave the sink unchanged.
    fn takes_ahead(&self) -> bool {
        false
    }
    /// Whether the sink takes nodes. If not, readers may leave out calls of [`node`](Self::node).
    fn asks_for_nodes(&self) -> bool {
        true
    }
    /// Announces about how many nodes follow.
    fn expect_nodes(&mut self, _count: usize) {}
    /// Takes a node that was just read. `x_at` is the offset of x, and `at` are x and y. `dimension` is that of the
    /// model entity it lies on if the file tells it, else 2.
    fn node(&mut self, cursor: &Cursor<'_>, tag: u64, dimension: u64, x_at: usize, at: [f64; 2]);
    /// Takes nodes of a binary list from the first one on. Returns how many it took; the caller hands the others to
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
    /// Takes an element that was just read. Sinks that look for something else ignore it.
    fn element(&mut self, _cursor: &Cursor<'_>, _element: &Element) -> Result<(), ReadError> {
        Ok(())
    }
    /// Takes triangles of a binary list from the first one on. Returns how many it took; the caller hands the others to
    /// [`element`](Self::element).
    fn triangle_records(&mut self, _records: &TriangleRecords<'_>) -> usize {
        0
    }
    /// Takes a polygon of more than four corners. Its vertices are constraints.
    fn polygon(
        &mut self,
        cursor: &Cursor<'_>,
        tag: u64,
        region: [i64; 2],
        corners: &[u64],
    ) -> Result<(), ReadError> {
        corners.iter().try_for_each(|&corner| {
            let nodes = [corner, 0, 0, 0];
            self.element(cursor, &Element { tag, kind: Kind::Corner, region, nodes })
        })
    }
    /// Takes a line through any number of nodes, which are constraints.
    fn polyline(
        &mut self,
        cursor: &Cursor<'_>,
        tag: u64,
        region: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        nodes.iter().try_for_each(|&node| {
            let nodes = [node, 0, 0, 0];
            self.element(cursor, &Element { tag, kind: Kind::Point, region, nodes })
        })
    }
    /// Whether the sink asks for periodic pairs of vertices. If not, readers may leave out calls of
    /// [`pairs`](Self::pairs).
    fn asks_for_pairs(&self) -> bool {
        false
    }
    /// Takes the periodic pairs of the file; `None` if they could not be read.
    fn pairs(&mut self, _pairs: Option<Vec<Pairs>>) {}
    /// Takes a remark for the user.
    fn remark(&mut self, _remark: Remark) {}

    /// Whether the sink asks for groups. If not, readers may leave out the calls on groups below.
    fn asks_for_groups(&self) -> bool {
        false
    }
    /// Takes the meaning of the numbers in [`Element::region`], before the first element.
    fn columns(&mut self, _columns: Vec<Column>) {}
    /// Takes the groups that the elements after this call belong to besides those of their regions, until the next
    /// call.
    fn within(&mut self, _groups: &[Within<'_>]) {}
    /// Takes the label of a group that a node belongs to. `node` is the index of the node in the order of the file.
    fn node_within(&mut self, _node: u32, _what: &str, _label: &Label) {}
    /// Takes the name of the groups with a tag, in one dimension or (for `None`) in all.
    fn name(&mut self, _what: &str, _dimension: Option<u8>, _tag: i64, _name: &[u8]) {}

    /// Whether the sink asks for data that a plain reading may leave out: third coordinates that are all the same, and
    /// lists after the elements.
    fn asks_for_data(&self) -> bool {
        false
    }
    /// Takes the name of an array of point data, its numbers per point, and whether these are real, not whole. Third
    /// coordinates are such an array too. Returns whether the sink wants the numbers.
    fn point_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes notice that nodes have parameters on a surface of the model. Returns whether the sink wants them, two
    /// numbers for each node.
    fn parameters(&mut self, _surface: i64) -> bool {
        false
    }
    /// Takes the parameters that were announced last, if the sink wants them.
    fn parameter_numbers(&mut self, _numbers: PointNumbers) {}
    /// Takes the name of an array that has a coordinate of the center of each of some elements: x for the axis 0, y for 1.
    /// Returns whether the sink wants the numbers.
    fn center_array(&mut self, _name: &[u8], _axis: usize) -> bool {
        false
    }
    /// Takes the centers that were announced last, if the sink wants them.
    fn center_numbers(&mut self, _centers: Centers) {}
    /// Announces third coordinates or depths as an array of point data. Returns whether the sink wants the numbers.
    fn height_array(&mut self, name: &[u8]) -> bool {
        self.point_array(name, 1, true)
    }
    /// Takes the name of an array of cell data, with the same arguments and result as
    /// [`point_array`](Self::point_array). Called only if the sink asks for data.
    fn cell_array(&mut self, _name: &[u8], _components: u64, _is_real: bool) -> bool {
        false
    }
    /// Takes the numbers of the cell data that were announced last, if the sink wants them. `tags` are those of the
    /// elements that the numbers belong to; `None` if they belong to all.
    fn cell_numbers(&mut self, _numbers: Vec<f64>, _tags: Option<Vec<u64>>) {}
    /// Takes a few words on a part of the file that is not handed on. Sinks that do not ask for data ignore it.
    fn leaves_out(&mut self, _what: &str) {}
    /// Takes the numbers of the point data that were announced last, if the sink wants them.
    fn point_numbers(&mut self, _numbers: PointNumbers) {}
}

/// Nodes that belong together in pairs, as in a periodic model.
#[derive(Debug, PartialEq)]
pub(crate) struct Pairs {
    /// The motion that takes the first node of each pair to the second, if the file gives it.
    pub(crate) motion: Option<Affine>,
    /// The tags of the two nodes of each pair; empty if the file gives only the motion.
    pub(crate) nodes: Vec<[u64; 2]>,
}

/// The numbers of an array of point data.
pub(crate) struct PointNumbers {
    /// The numbers, tuple by tuple in the order of the file.
    pub(crate) numbers: Vec<f64>,
    /// The tag of each tuple's node; `None` if there is a tuple for each node in order.
    pub(crate) nodes: Option<Vec<u64>>,
    /// Where the numbers stand; `None` if they cannot be replaced.
    pub(crate) stored: Option<Stored>,
}

/// One coordinate of the centers of some elements: faces, edges, or single nodes.
pub(crate) struct Centers {
    /// The tags of the nodes of all elements, one element after another, and where those of each end. An element without nodes has
    /// no center.
    pub(crate) nodes: Vec<u64>,
    pub(crate) ends: Vec<usize>,
    /// A number for each element.
    pub(crate) numbers: PointNumbers,
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
    /// Makes the value for numbers that stand in the file itself.
    pub(crate) fn in_place(places: Places, form: Form) -> Option<Stored> {
        Some(Stored { places, form, home: Home::File, part: 0 })
    }
}

/// The bytes that the places of numbers refer to.
pub(crate) enum Home {
    File,
    /// The decoded bytes of the encoded points.
    Points,
    /// Those of an array that is encoded itself, perhaps with other arrays.
    Encoded(Arc<dyn Encoded>),
}

/// How a file stores its numbers, known after it was read.
pub(crate) struct Layout {
    pub(crate) format: Format,
    pub(crate) numbers: Numbers,
    /// The encoded points, if they are encoded. The offsets of coordinates are then those in its decoded bytes.
    pub(crate) encoded: Option<Box<dyn Encoded>>,
    /// Where the coordinates stand, if a vertex may have them in several places.
    pub(crate) copies: Option<Copies>,
    /// The index of the file that has the coordinates, in the order of [`Source::parts`].
    pub(crate) part: usize,
}

/// All places of coordinates in a file that repeats vertices.
pub(crate) struct Copies {
    /// The offset of each x, ascending.
    pub(crate) x_at: Vec<usize>,
    /// The index of each x's vertex.
    pub(crate) vertices: Vec<u32>,
}

impl Layout {
    /// Makes the layout of a file that has its coordinates in place.
    pub(crate) fn in_place(format: Format, numbers: Numbers) -> Layout {
        Layout { format, numbers, encoded: None, copies: None, part: 0 }
    }
}

/// The reader of a format.
pub(crate) trait Walk {
    /// Names the file's list of vertices in messages.
    const VERTICES: &'static str;
    /// Loads the other files of the mesh that `given` belongs to. Returns the main file, with the other files as
    /// companions.
    ///
    /// # Errors
    /// If `given` is damaged, or if another file is missing or cannot be read.
    fn load_companions(given: Source) -> Result<Source, ReadError> {
        Ok(given)
    }
    /// Refuses bytes that were not read from a file, if the mesh has other files.
    ///
    /// # Errors
    /// If the mesh has other files, or if the bytes are damaged.
    fn require_single(_source: &Source) -> Result<(), ReadError> {
        Ok(())
    }
    /// Returns the files to which the mesh is written for `path`, in the order of [`Source::parts`].
    ///
    /// # Errors
    /// If `path` does not suit the format, or if a file of another mesh is in the way.
    fn destinations(_source: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        Ok(vec![path.to_owned()])
    }
    /// Returns the edits of the main file that rename its companions for `path`.
    fn renames(_source: &Source, _path: &Path) -> Vec<Splice> {
        Vec::new()
    }
    /// Feeds the nodes and elements of the mesh to the sink.
    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError>;
}

/// The reader of a format, as a value: the functions of a [`Walk`] under their names. A file is read by this walk alone.
/// It takes any sink, so that it is compiled once.
pub(crate) struct Reader {
    pub(crate) walk: fn(&Source, &mut dyn Sink) -> Result<Layout, ReadError>,
    pub(crate) load_companions: fn(Source) -> Result<Source, ReadError>,
    pub(crate) require_single: fn(&Source) -> Result<(), ReadError>,
    pub(crate) destinations: fn(&Source, &Path) -> Result<Vec<PathBuf>, WriteError>,
    pub(crate) renames: fn(&Source, &Path) -> Vec<Splice>,
    pub(crate) vertices: &'static str,
}

impl Reader {
    pub(crate) const fn of<W: Walk>() -> Reader {
        Reader {
            walk: W::walk,
            load_companions: W::load_companions,
            require_single: W::require_single,
            destinations: W::destinations,
            renames: W::renames,
            vertices: W::VERTICES,
        }
    }
}

/// Reads a list and hands its items, one in each row, to the sink with their positions. Plain rows are read on all
/// threads if the sink allows it. The rest is read row by row, or as the cursor's syntax lays out items.
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

/// Reads a list as [`each_row`] does. `next` moves to the next item, given how many were read. `read` may get the
/// item's position, for messages.
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
        // The sink uses this cursor for errors only. They are dropped here, as reading row by row meets them again.
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
            // The cursor stands on the last row, before its words. A reader that continues by words must find none of
            // them.
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
            // If one row among many lacks a number, the rows after it are read wrongly.
            Err(error) if is_plain => return Err(missing.unwrap_or(error)),
            Err(error) => return Err(error),
        }
        is_plain |= missing.is_none();
        done += 1;
    }
    Ok(())
}

/// Reads all rows that follow, of any kind, and hands them to `take`. Long files are read on all threads if the sink
/// allows it.
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

/// Returns the error that a file holds elements of a volume.
#[cold]
pub(crate) fn volume(cursor: &Cursor<'_>, what: &str) -> ReadError {
    let problem = format!("{what} make this a volume mesh");
    cursor.error(problem, "Only meshes of the plane are read: save a mesh of the plane")
}
