//! Errors of reading, of writing, of names of groups and of given data.

use std::path::PathBuf;
use std::{fmt, io};

/// A position in a file. Displays as a suffix of the file's name: `:18`, `, byte 4711`, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// One-based line of a text file.
    Line(usize),
    /// Offset in a binary file, in bytes.
    Byte(usize),
    /// An unknown place in the file: a second search of the file did not find the item.
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
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
        /// Remedy for the user, without a final period.
        remedy: String,
    },
    /// The content does not follow the format.
    #[error("{}{location}: {problem}. {remedy}", path.display())]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Line or byte of the error.
        location: Location,
        /// What is wrong there.
        problem: String,
        /// Remedy for the user, without a final period.
        remedy: String,
    },
    /// The file was read, but its format is unknown or unsupported.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// Path of the file.
        path: PathBuf,
        /// What was found instead of a supported format.
        problem: String,
        /// Remedy for the user, without a final period.
        remedy: String,
    },
    /// An STL was read without [`ReadOptions::weld`](crate::ReadOptions::weld).
    #[error(
        "{}: an STL lists corners of triangles, and has no vertices that these share. Have corners at the same place joined: \
         ReadOptions::weld",
        path.display()
    )]
    Unwelded {
        /// Path of the file.
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
        /// Path of the file that names the other file.
        path: PathBuf,
        /// Location of the name in this file.
        location: Location,
        /// Name of the other file as this file spells it.
        names: String,
        /// Path of the other file, with symbolic links resolved.
        target: PathBuf,
    },
}

/// A file could not be written. An existing file keeps its content, or the remedy says where the content is.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system reported an error.
    #[error("{}: {source}. {remedy}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
        /// Remedy for the user, without a final period.
        remedy: String,
    },
    /// The extension belongs to a format that differs from the format of the mesh, or the file has bytes that belong to
    /// several arrays, of which the rewrite would change one.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// Path of the file.
        path: PathBuf,
        /// What is wrong with the name or with the arrays.
        problem: String,
        /// Remedy for the user, without a final period.
        remedy: String,
    },
    /// Another program has changed the file since the mesh was read from it.
    #[error(
        "{}: another program has changed this file after the file was read, so the file is not replaced. Write to another name, or read \
         the mesh again",
        path.display()
    )]
    Changed {
        /// Path of the file.
        path: PathBuf,
    },
    /// The points do not fit the mesh, by a mistake in the calling program.
    #[error("{}: not written: {problem}", path.display())]
    Points {
        /// Path of the file.
        path: PathBuf,
        /// What is wrong with the points.
        problem: String,
    },
}

/// A name stands for no group of a mesh file, or for several groups.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GroupError {
    /// No group has this name.
    #[error("{}", unknown(name, known))]
    Unknown {
        /// The name that was given.
        name: String,
        /// Names of all groups, with the names most similar to `name` first.
        known: Vec<String>,
    },
    /// Several groups have this name.
    #[error("'{name}' is ambiguous: it may be {}", join_first(candidates, " or "))]
    Ambiguous {
        /// The name that was given.
        name: String,
        /// For each matching group, a longer name that no other group has.
        candidates: Vec<String>,
    },
}

fn unknown(name: &str, known: &[String]) -> String {
    match known {
        [] => format!("no group is called '{name}': the file names none"),
        _ => format!("no group is called '{name}'; there are {}", join_first(known, ", ")),
    }
}

/// Joins the first 12 names of a list, followed by the number of further names.
fn join_first(names: &[String], between: &str) -> String {
    const MAX_NAMES: usize = 12;
    let told = names[..names.len().min(MAX_NAMES)].join(between);
    match names.len().saturating_sub(MAX_NAMES) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}

/// Positions or data of vertices whose length does not fit the mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// The list of positions differs in length from the list of vertices.
    #[error("{given} points are given for the {expected} vertices of the mesh")]
    PointCount {
        /// Number of vertices of the mesh.
        expected: usize,
        /// Number of points that were given.
        given: usize,
    },
    /// The list of values differs in length from the field.
    #[error("{given} numbers are given where the vertices of the mesh need {expected}")]
    ValueCount {
        /// Number of values in the field.
        expected: usize,
        /// Number of values that were given.
        given: usize,
    },
}
