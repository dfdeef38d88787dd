//! Detection of a file's format, first by its content, then by its extension.

use crate::compress::file::beginning;
use crate::disk::source::{Source, file_name};
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::mike;
use crate::formats::nastran;
use crate::formats::triangle;
use crate::formats::triangle::names::Names;
use crate::hdf5::{REMOVE_USER_BLOCK, user_block};
use crate::registry::{
    ADCIRC, FREEFEM, FormatEntry, MIKE, NASTRAN, REGISTRY, STL, SURFER, TRIANGLE, XDMF,
};
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::text::token::{float, integer};
use crate::visit::reader::ReaderFunctions;
use std::path::{Path, PathBuf};

/// Returns the reader of a file's format.
///
/// # Errors
/// [`ReadError::Format`] if the file is empty, or if its format is unknown or unsupported. An unsupported format is
/// named.
pub(crate) fn reader(source: &Source) -> Result<&'static ReaderFunctions, ReadError> {
    let head = head(&source.bytes, b"%");
    if head.is_empty() {
        return Err(source.error("the file is empty", "Write the mesh again"));
    }
    if let Some((problem, remedy)) = other_content(&source.bytes) {
        return Err(source.error(problem, remedy));
    }
    // The title of an ADCIRC grid may start like any other format. Other programs, such as SHYFEM and Surfer, name other
    // files `.grd` too. The second row of a grid of Surfer has two counts, as that of ADCIRC has.
    let is_of_many = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("grd"));
    let is_of_surfer = || SURFER.magic.iter().any(|magic| source.bytes.starts_with(magic));
    let is_adcirc = !is_of_many || (has_adcirc_counts(source) && !is_of_surfer());
    if ADCIRC.matches_extension(&source.path) && is_adcirc {
        return reader_of(source, &ADCIRC);
    }
    let promised = |family: &&&FormatEntry| family.matches_extension(&source.path);
    let by_content = || detect_by_magic(&source.bytes);
    let known = by_content().find(promised).or_else(|| by_content().next());
    // A Nastran file may start like any other format, for example with a title.
    if known.is_none_or(|family| !family.is_read()) && nastran::is_nastran(source) {
        return reader_of(source, &NASTRAN);
    }
    if let Some(family) = known {
        return reader_of(source, family);
    }
    // MIKE files may start with any numbers, and have the extension of Medit.
    let [first, second, _] = first_rows(source, Syntax::PLAIN);
    if mike::is_mike(&first, &second) {
        return reader_of(source, &MIKE);
    }
    if TRIANGLE.matches_extension(&source.path) {
        return reader_of(source, &TRIANGLE);
    }
    // Formats without magic bytes are detected by an extension of their own, unlike FreeFem's `.msh`. An STL in text
    // must start with the magic bytes, in capital or small letters, so its extension alone does not count.
    let is_text = memchr::memchr(0, &source.bytes[..source.bytes.len().min(512)]).is_none();
    let is_solid = head
        .split(u8::is_ascii_whitespace)
        .next()
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let by_ending = |family: &&&FormatEntry| {
        let is_told_otherwise = (is_text && !is_solid && std::ptr::eq(**family, &STL))
            || std::ptr::eq(**family, &ADCIRC);
        promised(family) && family.extensions != FREEFEM.extensions && !is_told_otherwise
    };
    match REGISTRY.iter().filter(|family| family.reader.is_some()).find(by_ending) {
        Some(family) => reader_of(source, family),
        None => detect_by_rows(source),
    }
}

/// Returns the problem and the remedy for a file that a program stored in place of a mesh, or in an encoding that no
/// format of meshes has; `None` for any other content. Files with the extension of a mesh may have such content.
fn other_content(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let text = head(bytes, b"");
    let starts =
        |word: &[u8]| text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    if starts(b"version https://git-lfs.github.com/spec/") {
        return Some(("a pointer of Git LFS, not the mesh itself", "Fetch the mesh: git lfs pull"));
    }
    if starts(b"<!doctype html") || starts(b"<html") {
        return Some((
            "an HTML page, not a mesh",
            "Download the mesh again, by the address of the file instead of that of a page about the file",
        ));
    }
    if user_block(bytes).is_some() {
        return Some(("HDF5 behind a user block, which is not read", REMOVE_USER_BLOCK));
    }
    // Without a byte-order mark, every second byte of a text in the Latin alphabet is zero.
    let is_utf16 = |zero: usize| {
        let pairs = bytes[..bytes.len().min(64)].as_chunks::<2>().0;
        let is_letter =
            |pair: &[u8; 2]| pair[zero] == 0 && matches!(pair[1 - zero], 9..=13 | 32..=126);
        let is_text = |pairs: &[[u8; 2]]| pairs.len() >= 3 && pairs.iter().all(is_letter);
        let mark = if zero == 1 { [0xFF, 0xFE] } else { [0xFE, 0xFF] };
        match pairs {
            [first, rest @ ..] if *first == mark => is_text(&rest[..rest.len().min(4)]),
            _ => is_text(pairs),
        }
    };
    (is_utf16(0) || is_utf16(1))
        .then_some(("a text in UTF-16", "Convert it to UTF-8: iconv -f UTF-16 -t UTF-8 IN > OUT"))
}

/// Detects the format of a file of plain numbers by the counts of numbers in its first rows.
fn detect_by_rows(source: &Source) -> Result<&'static ReaderFunctions, ReadError> {
    let [first, second, _] = first_rows(source, Syntax::PLAIN);
    let outline = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("poly"));
    match integers(&first).as_deref() {
        Some([_, 2, _, 0..=1]) if outline => {
            let problem = "a .poly holds the outline of a mesh, not its triangles";
            return Err(source.error(problem, "Name the mesh itself, its .node or .ele"));
        }
        Some([_, 2, _, 0..=1]) if second.len() > 2 => {
            return match triangle::files::names(source) {
                Some(_) => reader_of(source, &TRIANGLE),
                None => {
                    let problem = "the vertices of a Triangle mesh, without its triangles";
                    let wanted = file_name(&source.path.with_extension("ele"));
                    let remedy = match source.path.exists() {
                        true => format!("Put {wanted} beside it"),
                        false => "A mesh of this format consists of several files, which are read together".to_owned(),
                    };
                    Err(source.error(problem, remedy))
                }
            };
        }
        Some([_, 3 | 6, ..]) if triangle::files::names(source).is_some() => {
            return reader_of(source, &TRIANGLE);
        }
        _ => {}
    }
    if let Some(family) = freefem_or_adcirc(source) {
        return reader_of(source, family);
    }
    // Unsupported formats without magic bytes are detected by their extension.
    match REGISTRY.iter().find(|family| !family.is_read() && family.matches_extension(&source.path))
    {
        Some(family) => reader_of(source, family),
        None => {
            let remedy = format!("{}. Convert it, with meshio or gmsh for example", formats_read());
            Err(source.error("the format is not recognized", remedy))
        }
    }
}

/// Returns the entry of FreeFem or ADCIRC by the counts of numbers in the first rows of a file.
fn freefem_or_adcirc(source: &Source) -> Option<&'static FormatEntry> {
    let [first, second, _] = first_rows(source, Syntax::PLAIN);
    if integers(&first).is_some_and(|counts| counts.len() == 3) && second.len() == 3 {
        return Some(&FREEFEM);
    }
    let [_, _, third] = first_rows(source, Syntax::FORTRAN);
    let is_adcirc = has_adcirc_counts(source) && third.len() >= 4 && integer(third[0]).is_some();
    is_adcirc.then_some(&ADCIRC)
}

/// Returns whether the second row of a file starts with two whole numbers, which no third number follows, as the counts of
/// an ADCIRC grid. Rows of SHYFEM's `.grd`, of TELEMAC's `.cli` and of other lists have more numbers.
fn has_adcirc_counts(source: &Source) -> bool {
    let [_, second, _] = first_rows(source, Syntax::FORTRAN);
    let counts = second.get(..2).and_then(integers);
    counts.is_some() && second.get(2).is_none_or(|word| float(word).is_none())
}

/// Returns the integers of a row; `None` if a word of the row is no integer.
fn integers(row: &[&[u8]]) -> Option<Vec<u64>> {
    row.iter().map(|token| integer(token)).collect()
}

/// Returns the name of the format with the extension of `path`, supported or not; `None` if no format has the
/// extension.
pub(crate) fn format_name_of_extension(path: &Path) -> Option<&'static str> {
    let family = REGISTRY.iter().find(|family| family.matches_extension(path));
    family.map(|family| family.name)
}

impl Format {
    /// Returns the extensions of the format, the usual one first. Some extensions are whole file names, such as
    /// `fort.14`.
    pub fn extensions(self) -> &'static [&'static str] {
        FormatEntry::of(self).extensions
    }

    /// Returns the name of a family of formats with one reader: `gmsh` for all versions of gmsh, in text and in binary.
    pub fn family(self) -> &'static str {
        FormatEntry::of(self).name
    }

    /// Returns whether `path` has an extension of the format, before the extension of a compression, in capital or small
    /// letters.
    pub fn has_extension(self, path: &Path) -> bool {
        FormatEntry::of(self).matches_extension(path)
    }

    /// Returns the name of the format with the extension of `path`, before the extension of a compression, in capital
    /// or small letters. Unsupported formats have names too. `None` if no format has the extension.
    pub fn name_of_extension(path: &Path) -> Option<&'static str> {
        format_name_of_extension(path)
    }

    /// Returns the paths of all files of a mesh that follow from the name of one: `.node`, `.ele` and `.poly` of
    /// Triangle, an XDMF and the `.h5` of the same name, else `path` alone. The files need not exist.
    pub fn files_of(path: &Path) -> Vec<PathBuf> {
        if let Some(Names { node, ele, poly }) = Names::of_file(path) {
            return vec![node, ele, poly];
        }
        match XDMF.matches_extension(path) {
            true => vec![path.to_owned(), path.with_extension("h5")],
            false => vec![path.to_owned()],
        }
    }

    /// Returns the name of the format whose magic bytes or first rows of numbers start `head`, the beginning of a file,
    /// which may be compressed. Unsupported formats have names too. `None` also for formats that only an extension
    /// identifies, such as STL in binary.
    pub fn name_of_content(head: &[u8]) -> Option<&'static str> {
        let decompressed = beginning(head);
        let head = decompressed.as_deref().unwrap_or(head);
        let family = detect_by_magic(head).next().copied();
        family.or_else(|| family_of_rows(head)).map(|family| family.name)
    }
}

/// Returns the entry of a format without magic bytes by the beginning of a file, independent of its name.
fn family_of_rows(head: &[u8]) -> Option<&'static FormatEntry> {
    let source = Source::new(Path::new(""), head.to_vec()).ok()?;
    let [first, second, _] = first_rows(&source, Syntax::PLAIN);
    let is_of_triangle = match integers(&first).as_deref() {
        Some([_, 2, _, 0..=1]) => second.len() > 2,
        Some([_, 3 | 6, _]) => second.len() > 3 && integers(&second).is_some(),
        _ => false,
    };
    if is_of_triangle {
        return Some(&TRIANGLE);
    }
    if nastran::is_nastran(&source) {
        return Some(&NASTRAN);
    }
    if mike::is_mike(&first, &second) {
        return Some(&MIKE);
    }
    freefem_or_adcirc(&source)
}

/// Returns the entries whose magic bytes start a content, in the order of the registry.
fn detect_by_magic(bytes: &[u8]) -> impl Iterator<Item = &'static &'static FormatEntry> {
    let head = head(bytes, b"%");
    // Comment lines that start with `#` may precede the magic bytes, but the magic bytes of VTK start with `#` too.
    let heads = [head, bytes, self::head(head, b"%#"), after_prolog(head)];
    let opens = move |magic: &&[u8]| heads.iter().any(|head| head.starts_with(magic));
    REGISTRY.iter().filter(move |family| family.magic.iter().any(opens))
}

/// Returns the reader of an entry.
///
/// # Errors
/// If the format is unsupported. The error names the format and a remedy.
fn reader_of(
    source: &Source,
    family: &'static FormatEntry,
) -> Result<&'static ReaderFunctions, ReadError> {
    match &family.reader {
        Some(reader) => Ok(reader),
        None => {
            let remedy = match family.hint {
                "" => formats_read(),
                instead => instead.to_owned(),
            };
            Err(source.error(format!("{} is not read", family.name), remedy))
        }
    }
}

fn formats_read() -> String {
    let read = REGISTRY.iter().filter(|family| family.is_read());
    let names: Vec<_> = read.map(|family| family.name).collect();
    format!("Formats read: {}", names.join(", "))
}

/// Returns the content without a byte order mark, leading blanks, and comment lines, which start with a byte of
/// `comments`.
fn head<'a>(bytes: &'a [u8], comments: &[u8]) -> &'a [u8] {
    let mut head = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    while head.first().is_some_and(|first| comments.contains(first)) {
        let end = memchr::memchr(b'\n', head).unwrap_or(head.len());
        head = head[end..].trim_ascii_start();
    }
    head
}

/// Returns the content from the first XML element on, without the declarations and comments before.
fn after_prolog(bytes: &[u8]) -> &[u8] {
    let mut head = bytes;
    while head.starts_with(b"<?") || head.starts_with(b"<!") {
        let end: &[u8] = if head.starts_with(b"<!--") { b"-->" } else { b">" };
        let Some(at) = memchr::memmem::find(head, end) else { break };
        head = head[at + end.len()..].trim_ascii_start();
    }
    head
}

fn first_rows(source: &Source, syntax: Syntax) -> [Vec<&[u8]>; 3] {
    // Enough tokens to tell formats apart by their rows.
    const TOKENS: usize = 8;
    let mut cursor = Cursor::new(source).with_syntax(syntax);
    std::array::from_fn(|_| {
        let row = cursor.next_row();
        std::iter::from_fn(|| if row { cursor.token() } else { None }).take(TOKENS).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::source::ReadOptions;
    use crate::disk::stamp::KnownState;

    fn problem(name: &str, content_bytes: &[u8]) -> String {
        let source = Source {
            path: name.into(),
            bytes: content_bytes.to_vec(),
            compressed: None,
            options: ReadOptions::new(),
            known: KnownState::default(),
            companions: Vec::new(),
            beside: None,
        };
        match reader(&source) {
            Ok(reader) => {
                let of =
                    |f: &&&FormatEntry| f.reader.as_ref().is_some_and(|r| std::ptr::eq(r, reader));
                REGISTRY.iter().find(of).unwrap().name.into()
            }
            Err(ReadError::Format { problem, .. }) => problem,
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn content_comes_before_the_ending() {
        assert_eq!(problem("a.node", b"\n $MeshFormat\n"), "gmsh");
        assert_eq!(problem("a.msh", b"\xEF\xBB\xBF$MeshFormat\r\n"), "gmsh");
        assert_eq!(problem("a.node", b"# vtk DataFile Version 2.0\n"), "legacy VTK");
        assert_eq!(problem("a.node", b"# made by hand\n3 2 0 0\n"), "Triangle .node/.ele");
        assert_eq!(problem("a.ELE", b"1 3 0\n"), "Triangle .node/.ele");
    }

    #[test]
    fn formats_are_known_by_their_content() {
        let cases: [(&[u8], &str); 35] = [
            (b"TITLE = \"by hand\"\nVARIABLES = \"X\"\n", "Tecplot is not read"),
            (b"# by hand\nmesh3d\n\ndimension\n2\n", "Netgen is not read"),
            (b"* FLAC3D grid\n* GRIDPOINTS\n", "FLAC3D is not read"),
            (b"#RADIOSS STARTER\n", "Radioss is not read"),
            (b"<?xml version=\"1.0\"?>\n<!DOCTYPE X3D>\n<X3D>", "X3D is not read"),
            (b"<?xml version=\"1.0\"?>\n<!-- <Xdmf> -->\n<VTKFile>", "VTK XML"),
            (b"<?xml version=\"1.0\"?><!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf>", "XDMF"),
            (b"solid part\n", "STL"),
            (b"CDF\x02\0\0", "HDF5 or netCDF"),
            (b"\x89HDF\r\n", "HDF5 or netCDF"),
            (b"(1 \"made by hand\")\n(2 2)\n", "Fluent is not read"),
            (b"MFEM mesh v1.0\n\ndimension\n2\n", "MFEM"),
            (b"MFEM NC mesh v1.0\n", "nonconforming, NURBS or inline MFEM is not read"),
            (b"100079  1000  4  UTM-32\n1 0 0 0 1\n", "MIKE (DHI)"),
            (b"100000 1014 4 PROJCS[\"WGS 84 / UTM zone 32N\"]\n1 0 0 -5e0 1\n", "MIKE (DHI)"),
            (b"4 LONG/LAT\n 1 4.5 55.5 -3 0\n", "MIKE (DHI)"),
            (b"Node Number = 3\nCell Number = 1\n1 1 2 3 1\n", "FVCOM"),
            (b"# a.msh\nmshid=3;EUCLIDEAN-MESH\nndims=2\n", "JIGSAW"),
            (b"3 islands\n 1 3\n 1 0.0 0.0 4.5\n", "ADCIRC or SCHISM grid"),
            (b"% made by\n%\nNDIME= 2\n", "SU2"),
            (b" MeshVersionFormatted 2\n", "Medit"),
            (&[1, 0, 0, 0, 2, 0, 0, 0], "binary Medit"),
            (b"OFF\n3 1 0\n", "OFF"),
            (b"# made by hand\n#\no part\nv 0 0 0\n", "Wavefront OBJ"),
            (b"MESH2D\nE3T 1 1 2 3 1\n", "SMS 2dm"),
            (b"\0\0\0\x50River", "SELAFIN"),
            (b" 3 1 3\n 0.0 0.0 1\n", "FreeFem .msh"),
            (b"title\n 1 3\n 1 0.0 0.0 4.5\n", "ADCIRC or SCHISM grid"),
            (b"$ made by hand\nGRID,1,,0.,0.\n", "Nastran"),
            (b"TITLE = a plate\nSPC = 1\nbegin  bulk\n", "Nastran"),
            (b"ID a,b\nSOL 101\nCEND\n", "Nastran"),
            (b"PARAM,POST,-1\n$\nctria3  7       1       1       2       3\n", "Nastran"),
            (b"Grid*    12                              .5-1            2.0\n", "Nastran"),
            (b"Grid 5 of the lake\n 1 3\n 1 0.0 0.0 4.5\n", "ADCIRC or SCHISM grid"),
            (b"Grid, 5, of the lake\n 1 3\n 1 0.0 0.0 4.5\n", "ADCIRC or SCHISM grid"),
        ];
        for (bytes, name) in cases {
            assert_eq!(problem("mesh.dat", bytes), name);
        }
        assert_eq!(problem("mesh.dat", b"hello\n"), "the format is not recognized");
        assert_eq!(
            problem("a.cgns", b"@(#)ADF Database Version A02011>\0"),
            "CGNS in ADF is not read"
        );
        assert_eq!(problem("a.grd", b"Begin bay\n 1 3\n"), "ADCIRC or SCHISM grid");
        assert_eq!(problem("a.grd", b"1 islands\n 1 3 elements, nodes\n"), "ADCIRC or SCHISM grid");
        assert_eq!(problem("mesh.bdf", b"$ made by hand\n"), "Nastran");
        assert_eq!(problem("mesh.unv", b"    -1\n  2411\n"), "I-DEAS universal is not read");
        assert_eq!(problem("mesh.avs", b"# by hand\n4 2 0 0 0\n"), "AVS-UCD is not read");
        assert_eq!(problem("mesh.dat", b" \n\t"), "the file is empty");
    }

    /// SHYFEM's grid, grids of Surfer, the model of Kratos and boundary conditions of TELEMAC, which start with rows of
    /// numbers or with words.
    #[test]
    fn files_of_other_programs_are_not_damaged_grids_of_adcirc() {
        const SHYFEM: &[u8] =
            b"0 (a lagoon)\n\n1 1 0 0. 0. 5.\n1 2 0 1. 0. 5.\n1 3 0 1. 1. 5.\n2 1 0 3 1 2 3\n";
        const CLI: &[u8] = b"2 2 2 0.000 0.000 0.000 0.000 2 0.000 0.000 0.000 1 1\n\
            2 2 2 0.000 0.000 0.000 0.000 2 0.000 0.000 0.000 2 2\n2 2 2 0.0 0.0 0.0 0.0 2 0.0 0.0 0.0 3 3\n";
        const SURFER: &str = "a grid of heights without a mesh (Surfer) is not read";
        const KRATOS: &[u8] = b"Begin Nodes\n1 0 0 0\n2 1 0 0\n3 1 1 0\nEnd Nodes\n";
        let unknown = "the format is not recognized";
        for (name, content, expected) in [
            ("a.grd", SHYFEM, unknown),
            ("a.grd", &SHYFEM[14..], unknown),
            ("a.dat", SHYFEM, unknown),
            ("a.grd", b"DSBB\x0a\0\x14\0", SURFER),
            ("a.grd", b"DSAA\n3 2\n0.0 1.0\n0.0 2.0\n-5.0 5.0\n1 2 3\n4 5 6\n", SURFER),
            ("a.dat", b"DSRB\x04\0\0\0", SURFER),
            ("a.bas", b"\x08\0\0\0\x1b\0\0\0", "SHYFEM is not read"),
            ("a.cli", CLI, "a list of boundary conditions (TELEMAC) is not read"),
            ("a.dat", CLI, unknown),
            ("a.mdpa", KRATOS, "Kratos is not read"),
            ("a.dat", KRATOS, "Kratos is not read"),
        ] {
            assert_eq!(problem(name, content), expected, "{name}");
        }
    }

    #[test]
    fn a_file_ending_belongs_to_one_format() {
        let owner = |name: &str| format_name_of_extension(Path::new(name));
        assert_eq!(owner("a/B.VTK"), Some("legacy VTK"));
        assert_eq!(owner("la.1.ele"), Some("Triangle .node/.ele"));
        assert_eq!(owner("fort.14"), Some("ADCIRC or SCHISM grid"));
        assert_eq!(owner("la.15"), None);
        assert_eq!(owner("la"), None);
    }

    #[test]
    fn meshes_are_recognized_by_their_beginning_and_other_files_are_not() {
        let name = Format::name_of_content;
        assert_eq!(name(b"$MeshFormat\n4.1 0 8\n"), Some("gmsh"));
        assert_eq!(name(b"<?xml version=\"1.0\"?>\n<VTKFile type=\"Unst"), Some("VTK XML"));
        assert_eq!(name(b"# made by hand\n*NODE\n"), Some("Abaqus"));
        for (head, format) in [
            ("5 2 0 0\n1 0 0\n", "Triangle .node/.ele"),
            ("4 3 0\n1 1 2 5\n", "Triangle .node/.ele"),
            ("5 4 4\n0 0 1\n1 0 1\n", "FreeFem"),
            ("a bay\n4 5\n1 0 0 3.5\n", "ADCIRC or SCHISM grid"),
            ("$ by hand\nGRID,1,,0.,0.,0.\n", "Nastran"),
        ] {
            assert!(name(head.as_bytes()).is_some_and(|own| own.contains(format)), "{head}");
        }
        assert_eq!(Format::name_of_extension(Path::new("a.vtu.gz")), Some("VTK XML"));
        for head in [
            &b"{ \"engine\": 1 }"[..],
            b"1\n2\n3\n",
            b"mesh,f\n1,2\n",
            b"",
            b"\x89PNG\r\n",
            b"<svg xmlns",
            b"<!DOCTYPE html><html>",
        ] {
            assert_eq!(name(head), None);
        }
        assert_eq!(name(b"gpu-smooth checkpoint 1\n"), None);
    }
}
