//! The faces of a UGRID mesh.

use super::mesh::Mesh;
use crate::error::ReadError;
use crate::file::netcdf::{Header, Items, Number, Variable};
use crate::file::records::{Field, Region, TriangleRecords};
use crate::file::sink::{Element, Kind, Sink};
use crate::file::text::{CORRECT, Cursor};
use crate::file::token::quoted;

/// The corners of faces: a table of nodes with a row for each face, or with a column.
pub(super) struct Faces<'h, 'a> {
    variable: &'h Variable,
    items: Items<'a>,
    pub(super) count: usize,
    /// How many corners a face has at most.
    corners: usize,
    /// Whether the corners of a face stand side by side.
    has_rows: bool,
    /// What stands in the place of a corner that a face does not have.
    missing: Option<f64>,
    /// The number of the first node, which is that of the first face too.
    pub(super) first: u64,
}

/// What stands in the place of a corner.
enum Corner {
    Node(u64),
    /// The face has fewer corners.
    Missing,
    /// No number of a node.
    Other(f64),
}

impl<'h, 'a> Mesh<'h, 'a> {
    /// Finds the faces.
    pub(super) fn faces(&self) -> Result<Faces<'h, 'a>, ReadError> {
        let (header, variable) = (self.header, self.face_nodes);
        let wrong = |problem: &str| {
            let problem = format!("{}, the nodes of the faces, {problem}", quoted(&variable.name));
            Cursor::at_byte_of(header.source, header.place(variable)).error(problem, CORRECT)
        };
        let is_numeric = matches!(variable.number, Number::Whole(_) | Number::Real(_));
        let (&[rows, columns], true, false) = (&variable.shape[..], is_numeric, variable.is_record)
        else {
            return Err(wrong("are not a table of numbers"));
        };
        // The dimension of faces comes second if the mesh says so, or if there are more of it than a face has corners.
        let dimension = self.own.text("face_dimension").and_then(|name| str::from_utf8(name).ok());
        let has_rows = match dimension.and_then(|name| header.dimension(name)) {
            Some(length) if (length == rows) != (length == columns) => length == rows,
            _ => rows >= columns,
        };
        let (count, corners) = if has_rows { (rows, columns) } else { (columns, rows) };
        if corners < 3 {
            return Err(wrong(&format!("have {corners} corners")));
        }
        let (count, corners) = (count as usize, corners as usize);
        let items = header.items(variable)?;
        let missing = variable.missing();
        let mut faces = Faces { variable, items, count, corners, has_rows, missing, first: 0 };
        faces.first = match variable.whole("start_index") {
            Some(first @ (0 | 1)) => first as u64,
            Some(other) => return Err(wrong(&format!("start at number {other}, not at 0 or 1"))),
            None => faces.likely_first(self.nodes as u64),
        };
        Ok(faces)
    }
}

impl Faces<'_, '_> {
    /// Hands on all faces.
    pub(super) fn send(&self, header: &Header<'_>, sink: &mut dyn Sink) -> Result<(), ReadError> {
        sink.expect_elements(self.count);
        let mut taken = 0;
        if let (Number::Whole(width @ (4 | 8)), 3, true) =
            (self.variable.number, self.corners, self.has_rows)
        {
            taken = sink.triangle_records(&TriangleRecords {
                count: self.count,
                corners: Field::new(
                    Some(self.items.own()),
                    (3 * width, width),
                    self.variable.order,
                ),
                first: 0,
                below: u64::MAX,
                regions: [Region::Same(0), Region::Same(0)],
                expected: &[],
            });
        }
        let mut nodes = Vec::with_capacity(self.corners);
        for face in taken..self.count {
            self.face(header, face, &mut nodes)?;
            let cursor = &Cursor::at_byte_of(header.source, self.byte_of(face));
            let (tag, region) = (face as u64 + self.first, [0, 0]);
            let kind = match nodes.len() {
                3 => Kind::Triangle,
                4 => Kind::Quadrilateral,
                _ => {
                    sink.polygon(cursor, (tag, region), &nodes)?;
                    continue;
                }
            };
            let mut own = [0; 4];
            own[..nodes.len()].copy_from_slice(&nodes);
            sink.element(cursor, &Element { tag, kind, region, nodes: own })?;
        }
        Ok(())
    }

    /// Reads the nodes of a face.
    fn face(
        &self,
        header: &Header<'_>,
        face: usize,
        nodes: &mut Vec<u64>,
    ) -> Result<(), ReadError> {
        nodes.clear();
        let wrong = |problem: String| {
            let cursor = Cursor::at_byte_of(header.source, self.byte_of(face));
            Err(cursor.error(format!("face {} {problem}", face as u64 + self.first), CORRECT))
        };
        let mut has_ended = false;
        for place in 0..self.corners {
            match self.corner(face, place) {
                Corner::Missing => has_ended = true,
                Corner::Node(_) if has_ended => {
                    return wrong("has a corner after a missing one".into());
                }
                Corner::Node(node) => nodes.push(node),
                Corner::Other(number) => {
                    return wrong(format!("has the corner {number}, which is no node"));
                }
            }
        }
        match nodes.len() {
            0..3 => wrong(format!("has {} corners", nodes.len())),
            _ => Ok(()),
        }
    }

    /// Where the number of a corner stands among the bytes.
    fn place(&self, face: usize, corner: usize) -> usize {
        let item = match self.has_rows {
            true => face * self.corners + corner,
            false => corner * self.count + face,
        };
        self.items.range(0).start + item * self.variable.number.bytes()
    }

    fn byte_of(&self, face: usize) -> usize {
        self.items.byte_of(self.place(face, 0))
    }

    fn corner(&self, face: usize, corner: usize) -> Corner {
        let at = self.place(face, corner);
        let own = &self.items.bytes[at..at + self.variable.number.bytes()];
        let number = match self.variable.number {
            Number::Real(precision) => self.variable.order.real(precision, own),
            _ => self.variable.order.signed(own) as f64,
        };
        let is_missing = number.is_nan() || Some(number) == self.missing;
        // Without a value for what is missing, negative numbers stand for it, which no node has.
        if is_missing || (number < 0.0 && corner >= 3) {
            return Corner::Missing;
        }
        let is_node = number >= 0.0 && number.fract() == 0.0 && number < 9e15;
        if is_node { Corner::Node(number as u64) } else { Corner::Other(number) }
    }

    /// The number of the first node where the file does not say it: 0 by the conventions, but 1 if the numbers go from 1 to as
    /// many as there are nodes.
    fn likely_first(&self, nodes: u64) -> u64 {
        let (mut least, mut most) = (u64::MAX, 0);
        for face in 0..self.count {
            for corner in 0..self.corners {
                if let Corner::Node(node) = self.corner(face, corner) {
                    (least, most) = (least.min(node), most.max(node));
                }
            }
        }
        u64::from(least >= 1 && most >= nodes)
    }
}
