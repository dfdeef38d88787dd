//! Which format a file is in, by its content first and its ending second.

use crate::error::ReadError;
use crate::file::format::{Format, has_ending};
use crate::file::source::{Source, file_name};
use crate::file::text::{Cursor, integer};
use crate::file::triangle::{Names, appended};
use std::path::{Path, PathBuf};

/// What a file holds, of the formats with a reader.
pub(crate) enum Content {
    Gmsh,
    Triangle(Names),
}

/// A format without a reader, so that messages can name it.
struct Foreign {
    name: &'static str,
    endings: &'static [&'static str],
    /// What a file of the format may start with, after blanks and `%` comment lines.
    opens: &'static [&'static [u8]],
}

const fn foreign(
    name: &'static str,
    endings: &'static [&'static str],
    opens: &'static [&'static [u8]],
) -> Foreign {
    Foreign { name, endings, opens }
}

const FOREIGN: [Foreign; 15] = [
    foreign("legacy VTK", &[".vtk"], &[b"# vtk DataFile"]),
    foreign("VTK XML", &[".vtu", ".vtp", ".pvtu"], &[b"<VTKFile", b"<?xml"]),
    foreign("SU2", &[".su2"], &[b"NDIME", b"NZONE", b"IZONE"]),
    foreign("Medit", &[".mesh"], &[b"MeshVersionFormatted"]),
    foreign("binary Medit", &[".meshb"], &[&[1, 0, 0, 0], &[0, 0, 0, 1]]),
    foreign("OFF", &[".off"], &[b"OFF", b"COFF", b"NOFF"]),
    foreign("SMS 2dm", &[".2dm"], &[b"MESH2D"]),
    foreign("SELAFIN", &[".slf"], &[&[0, 0, 0, 80]]),
    foreign("Wavefront OBJ", &[".obj"], &[b"v ", b"mtllib "]),
    foreign("STL", &[".stl"], &[b"solid "]),
    foreign("PLY", &[".ply"], &[b"ply\n", b"ply\r"]),
    foreign("Abaqus", &[".inp"], &[b"*HEADING", b"*Heading", b"*NODE", b"*Node"]),
    foreign("netCDF or HDF5", &[".exo", ".med", ".cgns"], &[b"CDF", b"\x89HDF"]),
    foreign("gmsh 1", &[], &[b"$NOD\n", b"$NOD\r"]),
    // Files of it start with a free title: `by_rows` tells it.
    foreign("ADCIRC or SCHISM grid", &["fort.14", ".gr3", ".grd"], &[]),
];

/// Finds the format of a file. The error names what else it holds, if that is known.
pub(crate) fn content(source: &Source) -> Result<Content, ReadError> {
    let head = head(&source.bytes);
    if head.is_empty() {
        return Err(source.error("the file is empty", "Write the mesh again"));
    }
    if head.starts_with(b"$MeshFormat") || head.starts_with(b"$Comments") {
        return Ok(Content::Gmsh);
    }
    let opens = |magic: &&[u8]| head.starts_with(magic) || source.bytes.starts_with(magic);
    if let Some(foreign) = FOREIGN.iter().find(|foreign| foreign.opens.iter().any(opens)) {
        return Err(not_read(source, foreign.name));
    }
    if Format::Triangle.has_ending_of(&source.path) {
        return Ok(Content::Triangle(Names::of(&source.path)));
    }
    by_rows(source)
}

/// Tells formats apart that consist only of rows of numbers, by how many numbers the first rows have.
fn by_rows(source: &Source) -> Result<Content, ReadError> {
    let [first, second, third] = first_rows(source);
    let numbers =
        |row: &[&[u8]]| row.iter().map(|token| integer(token)).collect::<Option<Vec<_>>>();
    let outline = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("poly"));
    match numbers(&first).as_deref() {
        Some([_, 2, _, 0..=1]) if outline => {
            let problem = "a .poly holds the outline of a mesh, not its triangles";
            return Err(source.error(problem, "Name the mesh itself, its .node or .ele"));
        }
        Some([_, 2, _, 0..=1]) if second.len() > 2 => {
            return match companion(&source.path, "ele") {
                Some((ele, poly)) => {
                    Ok(Content::Triangle(Names { node: source.path.clone(), ele, poly }))
                }
                None => {
                    let wanted = file_name(&source.path.with_extension("ele"));
                    let problem = "the vertices of a Triangle mesh, without its triangles";
                    Err(source.error(problem, format!("Put {wanted} beside it")))
                }
            };
        }
        Some([_, 3 | 6, ..]) => {
            if let Some((node, poly)) = companion(&source.path, "node") {
                return Ok(Content::Triangle(Names { node, ele: source.path.clone(), poly }));
            }
        }
        _ => {}
    }
    if numbers(&first).is_some_and(|counts| counts.len() == 3) && second.len() == 3 {
        return Err(not_read(source, "FreeFem .msh"));
    }
    let counts = second.get(..2).and_then(numbers);
    if counts.is_some() && third.len() >= 4 && integer(third[0]).is_some() {
        return Err(not_read(source, FOREIGN[FOREIGN.len() - 1].name));
    }
    Err(source.error("the format is not recognized", formats_read()))
}

/// The name of the format, with a reader or without, whose files end as this path does.
pub(crate) fn owner_of_ending(path: &Path) -> Option<String> {
    let format = Format::ALL.iter().find(|format| format.has_ending_of(path));
    format.map(ToString::to_string).or_else(|| {
        let foreign = FOREIGN.iter().find(|foreign| has_ending(path, foreign.endings));
        foreign.map(|foreign| foreign.name.to_owned())
    })
}

fn not_read(source: &Source, name: &str) -> ReadError {
    source.error(format!("not read yet: {name}"), formats_read())
}

fn formats_read() -> String {
    let names: Vec<_> = Format::ALL.iter().map(ToString::to_string).collect();
    format!("Formats read: {}", names.join(", "))
}

/// The content without what may stand before its first words: a byte order mark, blanks and `%` comment lines.
fn head(bytes: &[u8]) -> &[u8] {
    let mut head = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    while head.starts_with(b"%") {
        let end = memchr::memchr(b'\n', head).unwrap_or(head.len());
        head = head[end..].trim_ascii_start();
    }
    head
}

fn first_rows(source: &Source) -> [Vec<&[u8]>; 3] {
    // Longer rows belong to none of the formats told apart here.
    const TOKENS: usize = 8;
    let mut cursor = Cursor::new(source);
    std::array::from_fn(|_| {
        let row = cursor.next_row();
        std::iter::from_fn(|| if row { cursor.token() } else { None }).take(TOKENS).collect()
    })
}

/// For a `.node` or `.ele` under another ending: the other file of the mesh if it exists, and where its `.poly` would
/// be.
fn companion(path: &Path, ending: &str) -> Option<(PathBuf, PathBuf)> {
    [path.with_extension(""), path.to_owned()].iter().find_map(|stem| {
        let other = appended(stem, &format!(".{ending}"));
        other.is_file().then(|| (other, appended(stem, ".poly")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(name: &str, content_bytes: &[u8]) -> String {
        let source = Source { path: name.into(), bytes: content_bytes.to_vec() };
        match content(&source) {
            Ok(Content::Gmsh) => "gmsh".into(),
            Ok(Content::Triangle(_)) => "triangle".into(),
            Err(ReadError::Format { problem, .. }) => problem,
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn content_comes_before_the_ending() {
        assert_eq!(problem("a.node", b"\n $MeshFormat\n"), "gmsh");
        assert_eq!(problem("a.msh", b"\xEF\xBB\xBF$MeshFormat\r\n"), "gmsh");
        assert_eq!(problem("a.node", b"# vtk DataFile Version 2.0\n"), "not read yet: legacy VTK");
        assert_eq!(problem("a.node", b"# made by hand\n3 2 0 0\n"), "triangle");
        assert_eq!(problem("a.ELE", b"1 3 0\n"), "triangle");
    }

    #[test]
    fn formats_without_a_reader_are_named() {
        let cases: [(&[u8], &str); 9] = [
            (b"<?xml version=\"1.0\"?>", "VTK XML"),
            (b"% made by\n%\nNDIME= 2\n", "SU2"),
            (b" MeshVersionFormatted 2\n", "Medit"),
            (&[1, 0, 0, 0, 2, 0, 0, 0], "binary Medit"),
            (b"OFF\n3 1 0\n", "OFF"),
            (b"MESH2D\nE3T 1 1 2 3 1\n", "SMS 2dm"),
            (b"\0\0\0\x50River", "SELAFIN"),
            (b" 3 1 3\n 0.0 0.0 1\n", "FreeFem .msh"),
            (b"title\n 1 3\n 1 0.0 0.0 4.5\n", "ADCIRC or SCHISM grid"),
        ];
        for (bytes, name) in cases {
            assert_eq!(problem("mesh.dat", bytes), format!("not read yet: {name}"));
        }
        assert_eq!(problem("mesh.dat", b"hello\n"), "the format is not recognized");
        assert_eq!(problem("mesh.dat", b" \n\t"), "the file is empty");
    }

    #[test]
    fn endings_have_owners() {
        let owner = |name: &str| owner_of_ending(Path::new(name));
        assert_eq!(owner("a/B.VTK").as_deref(), Some("legacy VTK"));
        assert_eq!(owner("la.1.ele").as_deref(), Some("Triangle .node/.ele"));
        assert_eq!(owner("fort.14").as_deref(), Some("ADCIRC or SCHISM grid"));
        assert_eq!(owner("la.14"), None);
        assert_eq!(owner("la"), None);
    }
}
