//! The formats that are read and written, and what each is known by.

use crate::file::source::file_name;
use std::fmt;
use std::path::Path;

/// A file format that is read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// The `.node` and `.ele` of the mesh generator Triangle, with the segments of a `.poly`
    /// beside them.
    Triangle,
    /// gmsh's `.msh`, versions 2.0 to 2.2, as text.
    Gmsh22,
    /// gmsh's `.msh`, versions 2.0 to 2.2, in binary.
    Gmsh22Binary,
    /// gmsh's `.msh`, version 4.1, as text.
    Gmsh41,
    /// gmsh's `.msh`, version 4.1, in binary.
    Gmsh41Binary,
}

/// What is to be known of a format besides its reader.
struct Row {
    /// For messages.
    name: &'static str,
    /// Endings of file names that promise this format, the usual one first.
    endings: &'static [&'static str],
    /// Which of the mesh's files lists the triangles; the first one has the vertices.
    file_with_triangles: usize,
}

impl Format {
    /// Every format.
    pub const ALL: [Format; 5] = [
        Format::Triangle,
        Format::Gmsh22,
        Format::Gmsh22Binary,
        Format::Gmsh41,
        Format::Gmsh41Binary,
    ];

    fn row(self) -> Row {
        let row = |name, endings, file_with_triangles| Row { name, endings, file_with_triangles };
        match self {
            Format::Triangle => row("Triangle .node/.ele", &[".node", ".ele"], 1),
            Format::Gmsh22 => row("gmsh 2.2 ASCII", &[".msh"], 0),
            Format::Gmsh22Binary => row("gmsh 2.2 binary", &[".msh"], 0),
            Format::Gmsh41 => row("gmsh 4.1 ASCII", &[".msh"], 0),
            Format::Gmsh41Binary => row("gmsh 4.1 binary", &[".msh"], 0),
        }
    }

    /// The ending that files of this format usually have.
    pub(crate) fn usual_ending(self) -> &'static str {
        self.row().endings[0]
    }

    /// Which of the mesh's files lists the triangles.
    pub(crate) fn file_with_triangles(self) -> usize {
        self.row().file_with_triangles
    }

    /// Whether the path ends as files of this format do.
    pub(crate) fn has_ending_of(self, path: &Path) -> bool {
        has_ending(path, self.row().endings)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}

/// Whether the path has one of these endings, given in lower case; the path's own case does not matter.
pub(crate) fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let name = file_name(path).to_ascii_lowercase();
    endings.iter().any(|ending| name.ends_with(ending))
}
