//! Background fields that gmsh writes as text (`.pos`): a view of scalars on triangles.

use std::collections::HashMap;
use std::path::Path;

use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::text::token::quoted;

/// A triangle mesh with a value at each vertex, such as a target size, read from a gmsh view.
#[derive(Clone, Debug, PartialEq)]
pub struct GmshView {
    points: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    values: Vec<f64>,
}

const SAVE: &str = "Save the view from gmsh as text (.pos), of scalars on triangles (ST)";

impl GmshView {
    /// Reads the first view of a `.pos` file of gmsh. The elements of the view must be scalar triangles, `ST(x, y, z,
    /// ...){value, ...};`. Corners with equal x and y become one vertex, with the value of the first corner in the
    /// file. If a view has several time steps, the first step is read. Third coordinates are ignored.
    ///
    /// # Errors
    /// [`ReadError`] if the file cannot be read, or has no such view.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let source = Source::load(path)?;
        let mut parser = Parser { source: &source, at: source.begin() };
        parser.header()?;
        let mut view = Self { points: Vec::new(), triangles: Vec::new(), values: Vec::new() };
        let mut vertices = HashMap::new();
        while let Some(kind) = parser.kind()? {
            if kind == b"TIME" {
                parser.list([b'{', b'}'], 0)?;
                parser.skip(b';');
                continue;
            }
            if kind != b"ST" {
                let problem = format!("an element of kind `{}` is not read", quoted(kind));
                return Err(parser.error(problem, SAVE));
            }
            let places = parser.list([b'(', b')'], 9)?;
            let values = parser.list([b'{', b'}'], 3)?;
            parser.skip(b';');
            let mut corners = [0; 3];
            for (k, corner) in corners.iter_mut().enumerate() {
                // Adding zero makes a negative zero positive, so both zeros are one place.
                let place = [places[3 * k] + 0.0, places[3 * k + 1] + 0.0];
                *corner = *vertices.entry(place.map(f64::to_bits)).or_insert_with(|| {
                    view.points.push(place);
                    view.values.push(values[k]);
                    view.values.len() as u32 - 1
                });
            }
            view.triangles.push(corners);
        }
        match view.triangles.is_empty() {
            true => Err(source.error("the view has no triangles", SAVE)),
            false => Ok(view),
        }
    }

    /// Returns x and y of each vertex, in the order of their first occurrence in the file.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns the vertex indices of each triangle, in the order of the file.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the value at each vertex, in the order of [`points`](Self::points).
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

struct Parser<'s> {
    source: &'s Source,
    at: usize,
}

impl<'s> Parser<'s> {
    fn error(&self, problem: impl Into<String>, remedy: &str) -> ReadError {
        let at = self.at.min(self.source.bytes.len());
        self.source.error_at(Location::Line(self.source.line_of(at)), problem, remedy)
    }

    /// Skips white space and comments, and returns the rest of the text.
    fn rest(&mut self) -> &'s [u8] {
        let bytes = &self.source.bytes;
        loop {
            let rest = &bytes[self.at.min(bytes.len())..];
            let space = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            self.at += space;
            let rest = &rest[space..];
            if !rest.starts_with(b"//") {
                return rest;
            }
            self.at += memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        }
    }

    /// Skips the character `sign` after white space and comments. Returns whether `sign` was next.
    fn skip(&mut self, sign: u8) -> bool {
        let is_next = self.rest().first() == Some(&sign);
        self.at += usize::from(is_next);
        is_next
    }

    /// Reads the start of a view: `View "name" {`.
    fn header(&mut self) -> Result<(), ReadError> {
        if !self.rest().starts_with(b"View") {
            return Err(self.error("no view begins here", SAVE));
        }
        self.at += b"View".len();
        let name = self.rest().strip_prefix(b"\"");
        let end = name.and_then(|name| memchr::memchr(b'"', name));
        self.at += end.map_or(0, |end| end + 2);
        match self.skip(b'{') {
            true => Ok(()),
            false => Err(self.error("a view is `View \"name\" {`", SAVE)),
        }
    }

    /// Reads the kind of the next element; `None` at the end of the view.
    fn kind(&mut self) -> Result<Option<&'s [u8]>, ReadError> {
        let rest = self.rest();
        if rest.is_empty() {
            return Err(self.error("the file ends within the view", SAVE));
        }
        if rest[0] == b'}' {
            return Ok(None);
        }
        let length = rest.iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_');
        let length = length.count();
        self.at += length;
        match length {
            0 => Err(self.error(format!("`{}` is not an element", quoted(&rest[..1])), SAVE)),
            _ => Ok(Some(&rest[..length])),
        }
    }

    /// Reads a list of at least `least` finite numbers, separated by commas, between the characters `open` and `close`.
    fn list(&mut self, [open, close]: [u8; 2], least: usize) -> Result<Vec<f64>, ReadError> {
        let remedy = "Correct the line, or save the view again";
        if !self.skip(open) {
            return Err(self.error(format!("`{}` is missing", char::from(open)), remedy));
        }
        let rest = self.rest();
        let Some(end) = memchr::memchr(close, rest) else {
            return Err(self.error(format!("`{}` is missing", char::from(close)), remedy));
        };
        let mut numbers = Vec::with_capacity(least);
        for text in rest[..end].split(|byte| *byte == b',').map(<[u8]>::trim_ascii) {
            let number = std::str::from_utf8(text).ok().and_then(|text| text.parse().ok());
            match number.filter(|number: &f64| number.is_finite()) {
                Some(number) => numbers.push(number),
                None => {
                    return Err(self.error(format!("`{}` is not a number", quoted(text)), remedy));
                }
            }
        }
        if numbers.len() < least {
            let problem = format!("{} numbers where {least} are needed", numbers.len());
            return Err(self.error(problem, remedy));
        }
        self.at += end + 1;
        Ok(numbers)
    }
}
