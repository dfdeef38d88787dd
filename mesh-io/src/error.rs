//! Errors, one enum for each kind of operation.

use std::path::PathBuf;
use std::{fmt, io};

/// A position in a file. Displays as a suffix of the file's name: `:18`, `, byte 4711`, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// One-based line of a text file.
    Line(usize),
    /// Offset in a binary file, in bytes.
    Byte(usize),
    /// Somewhere in the file: a second search of the file did not find the item.
    Unknown,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Line(line) => write!(f, ":{line}"),
            Location::Byte(at) => write!(f, ", byte {at}"),
            Location::Unknown => Ok(()),
        }
    }
}

/// A mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system reported an error.
    #[error("{}: {source}. {remedy}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
        /// What the user can do about it.
        remedy: String,
    },
    /// The content does not follow the format.
    #[error("{}{location}: {problem}. {remedy}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where the error is.
        location: Location,
        /// What is wrong there.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// The file can be read, but its format is not known.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// An STL was read without [`ReadOptions::weld`](crate::ReadOptions::weld).
    #[error(
        "{}: an STL lists corners of triangles, and has no vertices that these share. Have corners at the same place joined: \
         ReadOptions::weld",
        path.display()
    )]
    Unwelded {
        /// The file.
        path: PathBuf,
    },
    /// A mesh file names a file outside of its directory, and was read without
    /// [`ReadOptions::allow_outside`](crate::ReadOptions::allow_outside).
    #[error(
        "{}{location}: it names {names}, which is {}, outside of the directory of the mesh. Move the file beside the mesh, or, if you \
         trust the mesh, let it name files elsewhere: ReadOptions::allow_outside",
        path.display(), target.display()
    )]
    Outside {
        /// The mesh file.
        path: PathBuf,
        /// Where it names the other file.
        location: Location,
        /// The name that it gives.
        names: String,
        /// The other file, without symbolic links.
        target: PathBuf,
    },
}

/// A file could not be written. A file that was there before is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system reported an error.
    #[error("{}: {source}. {remedy}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
        /// What the user can do about it.
        remedy: String,
    },
    /// The name has the ending of another format than the one the mesh was read in.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with the name.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// The file is one that the mesh was read from, and another program has changed its content since.
    #[error(
        "{}: another program has changed this file since it was read, so it is not replaced. Write to another name, or read \
         the mesh again",
        path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// The points do not fit the mesh: a mistake in the calling program, not of its user.
    #[error("{}: not written: {problem}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// What is wrong with the points.
        problem: String,
    },
}

/// A name does not stand for exactly one group of a mesh file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GroupError {
    /// No group has this name.
    #[error("{}", unknown(name, known))]
    Unknown {
        /// The name that was given.
        name: String,
        /// The names of all groups, the most similar first.
        known: Vec<String>,
    },
    /// Several groups have this name.
    #[error("'{name}' is ambiguous: it may be {}", join_first(candidates, " or "))]
    Ambiguous {
        /// The name that was given.
        name: String,
        /// For each of these groups, a name that no other group has.
        candidates: Vec<String>,
    },
}

fn unknown(name: &str, known: &[String]) -> String {
    match known {
        [] => format!("no group is called '{name}': the file names none"),
        _ => format!("no group is called '{name}'; there are {}", join_first(known, ", ")),
    }
}

/// Joins the first names of a list, and says how many more there are.
fn join_first(names: &[String], between: &str) -> String {
    const MAX_NAMES: usize = 12;
    let told = names[..names.len().min(MAX_NAMES)].join(between);
    match names.len().saturating_sub(MAX_NAMES) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}

/// Data or positions that are given for a mesh file do not have the length that the file needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// A list of positions does not have exactly one for each vertex of the mesh.
    #[error("{given} points are given for the {expected} vertices of the mesh")]
    PointCount {
        /// Number of vertices of the mesh.
        expected: usize,
        /// Number of points that were given.
        given: usize,
    },
    /// A list of data does not have as many numbers as the field.
    #[error("{given} numbers are given where the vertices of the mesh need {expected}")]
    ValueCount {
        /// Number of numbers in the field.
        expected: usize,
        /// Number of numbers that were given.
        given: usize,
    },
}
