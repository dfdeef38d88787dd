//! Makes the tables of docs/formats.md from the rows of formats and targets, and tests that the document matches.
//!
//! After a change, `UPDATE_DOCS=1 cargo test -p mesh-io --lib doc_tests` rewrites the tables.

use super::tables;
use super::targets::{TARGETS, Target, WriteFunction};
use crate::compress::file::Compression;
use crate::format::Format;
use crate::registry::{FormatEntry, REGISTRY};
use std::fmt::Write;
use std::path::Path;

/// Texts of a row in the table of formats. Names, endings and conversions come from the code.
struct Row {
    formats: &'static [Format],
    /// Versions and layouts that are read and written.
    layouts: &'static str,
    /// Vertices that stay fixed besides boundary vertices.
    fixed: &'static str,
    /// The property that triangles of a region share.
    region: &'static str,
    /// Groups that can be named.
    named: &'static str,
    /// Content that is refused or not kept.
    limits: &'static str,
}

const fn row(
    formats: &'static [Format],
    layouts: &'static str,
    [fixed, region, named, limits]: [&'static str; 4],
) -> Row {
    Row { formats, layouts, fixed, region, named, limits }
}

const ROWS: &[Row] = &[
    row(
        &[Format::Triangle],
        "text, with the `.poly` beside it; vertices of two or three coordinates, `convert` writes two",
        [
            "vertices and segments of the `.poly`",
            "attributes of the `.ele`",
            "attributes of triangles, markers of vertices and segments",
            "triangles of 3 nodes",
        ],
    ),
    row(
        &[Format::Gmsh1, Format::Gmsh22, Format::Gmsh22Binary],
        "version 1 as text, versions 2.0 to 2.2 in text and in either byte order",
        [
            "points, lines",
            "physical group and geometrical entity",
            "physical groups with their names, entities",
            "first order",
        ],
    ),
    row(
        &[Format::Gmsh40, Format::Gmsh40Binary, Format::Gmsh41, Format::Gmsh41Binary],
        "versions 4.0 and 4.1, either byte order",
        [
            "the same, and nodes on points and curves of the model",
            "entity",
            "the same; the parts of an entity of a partitioned mesh are named by the entity",
            "first order; in a partitioned mesh each part of an entity counts as one",
        ],
    ),
    row(
        &[Format::Vtk, Format::VtkBinary],
        "versions 1.0 to 5.1; unstructured grids and polygonal data; `float` and `double`",
        [
            "vertices, lines, polygons",
            "cell data of a usual name (`gmsh:physical`, `medit:ref`, `MaterialIDs`, `CellEntityIds`, `region` and so on), the first two such arrays",
            "values of that cell data; point data of one number for `--fix-array`",
            "no strips, no structured grids",
        ],
    ),
    row(
        &[Format::Vtu, Format::Vtp],
        "text, base64, appended base64 and raw; uncompressed, zlib or LZ4; headers of 32 and 64 bits, either byte order; Float32 and Float64; one piece or several",
        [
            "as legacy VTK",
            "the same, of whole numbers",
            "the same",
            "without `--weld`, pieces are not joined: each keeps its own boundary; compressed arrays of points are compressed again, with the same values where nothing moved; strips, `.pvtu`, `.pvd` and LZMA are refused",
        ],
    ),
    row(
        &[Format::Su2],
        "zones, markers, any order of the lists",
        [
            "lines of markers",
            "zone",
            "markers by name; zones if there are several",
            "two dimensions",
        ],
    ),
    row(
        &[Format::Medit],
        "dimension 2 or 3, items anywhere on lines",
        [
            "edges, corners, required vertices, triangles and quadrilaterals",
            "reference",
            "references of vertices, edges, triangles and quadrilaterals; `Corners`, `RequiredVertices`, `RequiredTriangles`, `RequiredQuadrilaterals`",
            "",
        ],
    ),
    row(
        &[Format::MeditBinary],
        "versions 1 to 4, either byte order",
        ["the same", "reference", "the same", ""],
    ),
    row(
        &[Format::Obj],
        "negative numbers, texture coordinates and normals, rows joined by a backslash, with z or without",
        [
            "points, lines, polygons",
            "material, and group or object",
            "materials, objects, groups",
            "",
        ],
    ),
    row(
        &[Format::Ply, Format::PlyBinary],
        "either byte order, `float` and `double`, any other elements and properties",
        [
            "edges, polygons",
            "data of faces that look like regions",
            "nothing; numbers of vertices for `--fix-array`",
            "y next to x; no strips",
        ],
    ),
    row(
        &[Format::Off],
        "text, with or without normals and colors, vertices anywhere on lines",
        [
            "–",
            "–",
            "nothing",
            "each face on a line of its own; no polygons of more than four corners",
        ],
    ),
    row(
        &[Format::Adcirc],
        "text as Fortran reads it: commas between numbers, items of several lines, exponents without a letter",
        [
            "–",
            "–",
            "boundaries: `open1`, `land1`, `island2` and so on",
            "no repeat counts (`2*0.5`)",
        ],
    ),
    row(
        &[Format::Sms2dm],
        "rows in any order, with z or without, keywords in capital or small letters",
        [
            "node strings, lines",
            "material",
            "materials with the names of `MAT` rows, node strings",
            "linear elements",
        ],
    ),
    row(
        &[Format::Mike],
        "text, with a first row as before 2012 or since, triangles or both kinds of elements",
        ["–", "–", "codes of vertices", ""],
    ),
    row(
        &[Format::Fvcom],
        "text as Fortran reads it, with depths behind the coordinates or without",
        [
            "–",
            "–",
            "nothing",
            "other files of a case, which may repeat coordinates (`_dep.dat`, `_cor.dat`, `_spg.dat`), stay as they are",
        ],
    ),
    row(
        &[Format::Mfem],
        "versions 1.0 to 1.3 of conforming meshes with straight edges, items anywhere on lines; vertices or `nodes` of order 1",
        [
            "points, segments",
            "attribute",
            "attributes of elements and of the boundary",
            "no `nodes` of other finite element spaces than `H1_2D_P1`, as curved and periodic meshes have them; coordinates of a vertex next to each other (`Ordering: 1`)",
        ],
    ),
    row(
        &[Format::Jigsaw],
        "meshes of the kind EUCLIDEAN-MESH with 2 or 3 coordinates, keys in capital or small letters",
        [
            "edges",
            "tag",
            "tags of points, edges, triangles and quadrilaterals",
            "no grids, nothing on an ellipsoid",
        ],
    ),
    row(
        &[Format::FreeFem],
        "text, items anywhere on lines",
        ["edges", "label", "labels of vertices, triangles and edges", ""],
    ),
    row(
        &[Format::Selafin],
        "either byte order; single or double precision, by the length of the records and whatever the title; time steps are kept; the list of boundary conditions beside it (`.cli`) is copied to a new name",
        [
            "–",
            "–",
            "boundaries of the `.cli`: `open1`, `land1`, `island2` and so on",
            "triangles in one plane",
        ],
    ),
    row(
        &[Format::Stl, Format::StlBinary],
        "with `--weld` only, which joins corners at the same place to vertices; every copy of a corner is written, normals and attributes are kept",
        ["–", "solid", "solids by name", "no other elements"],
    ),
    row(
        &[Format::Xdmf],
        "versions 2 and 3 with the numbers in the XML, in HDF5 or raw files beside it; points as XY or XYZ, `Float` of 4 and 8 bytes; Triangle, Mixed and other topologies; time steps of data are kept",
        [
            "as legacy VTK",
            "cell data of the usual names, of whole numbers",
            "the same",
            "several grids with points of their own, hyperslabs and compressed raw files are refused; HDF5 as described below",
        ],
    ),
    row(
        &[Format::Exodus],
        "netCDF classic, with 64-bit offsets, CDF-5 and netCDF-4; `float` and `double`; time steps are kept",
        [
            "bars, spheres, sides in side sets",
            "block",
            "blocks, side sets and node sets, with their names",
            "blocks of TRI3, QUAD4, BAR2, SPHERE and shells; netCDF-4 as described for HDF5 below",
        ],
    ),
    row(
        &[Format::Ugrid],
        "netCDF classic, with 64-bit offsets, CDF-5 and netCDF-4, by UGRID 0.9 and 1.0; nets of Delft3D FM (`NetNode`, `NetLink`), and edges without faces; `float` and `double`; numbers of nodes from 0 or 1; time steps and layers are kept",
        [
            "polygons, edges at no face",
            "variables of faces that look like regions",
            "nothing; variables of nodes for `--fix-array`",
            "one mesh of faces or edges; as described below; netCDF-4 as for HDF5",
        ],
    ),
    row(
        &[Format::Med],
        "versions 3 and 4, of Salome, Code_Aster, gmsh and meshio, one mesh at one time",
        [
            "PO1, SE2",
            "family",
            "groups of elements and of nodes by name, families",
            "PO1, SE2, TR3 and QU4; fields stay as they are and are not interpolated; HDF5 as described below",
        ],
    ),
    row(
        &[Format::Cgns],
        "one unstructured zone in HDF5, as gmsh writes it; `R4` and `R8`; sections of BAR_2, TRI_3, QUAD_4, NODE and MIXED",
        [
            "BAR_2, NODE",
            "section",
            "sections, boundary conditions and their families by name",
            "several zones, structured zones, NGON_n and files in ADF are refused; HDF5 as described below",
        ],
    ),
    row(
        &[Format::Abaqus],
        "Abaqus and CalculiX; keywords in any case, rows and keywords of several lines; with parts, an assembly and instances",
        [
            "lines, sides of elements in surfaces, nodes of masses, springs, connectors and elements of a user",
            "`ELSET` of its `*ELEMENT`, and section; where there are neither, sets",
            "element sets, node sets and surfaces by name",
            "linear triangles and quadrilaterals of the plane, shells and membranes; no nodes or elements that keywords make (`*NGEN`), `INPUT` or `*INCLUDE` have; as described below",
        ],
    ),
    row(
        &[Format::Nastran],
        "bulk data in small, large and free field, mixed, with tabs, with the other sections before them or without",
        [
            "lines, nodes of masses, springs and rigid elements",
            "property",
            "properties, by the names in comments of HyperMesh, ANSA and Femap",
            "linear triangles and quadrilaterals (CTRIA3, CQUAD4 and others); nodes in the basic coordinate system; no `INCLUDE`; as described below",
        ],
    ),
];

/// Formats whose files have no quadrilaterals. `elements.rs` of mesh-io/tests/formats compares the table with the samples of all
/// formats.
const TRIANGLES_ALONE: &[Format] = &[
    Format::Triangle,
    Format::Fvcom,
    Format::FreeFem,
    Format::Selafin,
    Format::Stl,
    Format::StlBinary,
];

/// Makes the table of formats.
fn formats() -> String {
    let mut table = "| format | named by | read and written | elements | stays fixed, besides the boundary | \
                     a region has the same | what can be named | limits | `convert` writes it as |\n\
                     |---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for Row { formats, layouts, fixed, region, named, limits } in ROWS {
        let names: Vec<String> = formats.iter().map(ToString::to_string).collect();
        let mut endings: Vec<String> = Vec::new();
        for ending in formats.iter().flat_map(|&format| FormatEntry::of(format).extensions) {
            let ending = format!("`{ending}`");
            if !endings.contains(&ending) {
                endings.push(ending);
            }
        }
        let targets: Vec<String> = formats.iter().filter_map(|&f| tables::name_of(f)).collect();
        let targets = if targets.is_empty() { "–".to_owned() } else { targets.join(", ") };
        let (names, endings) = (names.join(", "), endings.join(", "));
        let elements = match formats.iter().any(|format| TRIANGLES_ALONE.contains(format)) {
            true => "triangles",
            false => "triangles, quadrilaterals",
        };
        writeln!(
            table,
            "| {names} | {endings} | {layouts} | {elements} | {fixed} | {region} | {named} | {limits} | {targets} |"
        )
        .unwrap();
    }
    table
}

/// Lists the formats that are recognized but not read.
fn not_read() -> String {
    let unread = REGISTRY.iter().filter(|family| !family.is_read());
    let names: Vec<&str> = unread.map(|family| family.name).collect();
    format!("**Not read,** but known by name: {}.\n", names.join(", "))
}

/// Replaces the text between two marks of a document.
fn with(document: &str, mark: &str, content: &str) -> String {
    let [begin, end] = ["begin", "end"].map(|word| format!("<!-- {mark}: {word} -->\n"));
    let start = document.find(&begin).unwrap_or_else(|| panic!("no {begin}")) + begin.len();
    let length = document[start..].find(&end).unwrap_or_else(|| panic!("no {end}"));
    [&document[..start], content, &document[start + length..]].concat()
}

#[test]
fn the_document_has_the_tables_of_the_code() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("docs/formats.md");
    let document = std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    let mut expected = document.clone();
    for (mark, content) in
        [("formats", formats()), ("targets", tables::targets()), ("not read", not_read())]
    {
        expected = with(&expected, mark, &content);
    }
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, &expected).unwrap();
        return;
    }
    let differs =
        expected.lines().zip(document.lines()).find(|(expected, found)| expected != found);
    let remedy = "UPDATE_DOCS=1 cargo test -p mesh-io --lib doc_tests writes the tables of docs/formats.md anew";
    assert_eq!(differs, None, "{remedy}");
    assert_eq!(document.len(), expected.len(), "{remedy}");
}

#[test]
fn every_format_has_one_row() {
    for format in Format::ALL {
        let rows = ROWS.iter().filter(|row| row.formats.contains(&format)).count();
        assert_eq!(rows, 1, "ROWS of mesh-io/src/convert/doc_tests.rs needs one row for {format}");
    }
}

/// Returns the text of a document of the repository, without carriage returns.
fn document(name: &str) -> String {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(name);
    std::fs::read_to_string(path).unwrap().replace("\r\n", "\n")
}

/// Returns the text of a document from `mark` up to `end`, exclusive.
fn part<'d>(document: &'d str, mark: &str, end: &str) -> &'d str {
    let start = document.find(mark).unwrap_or_else(|| panic!("no {mark}"));
    document[start..].split(end).next().unwrap()
}

/// Each list of formats must have every format, by its usual file ending or by its name.
#[test]
fn the_list_of_formats_in_the_readme_file_has_every_format() {
    let of_library = document("mesh-io/README.md");
    let list = part(&of_library, "## Formats", "\n\n[");
    let families = || REGISTRY.iter().filter(|family| family.is_read());
    for family in families().filter(|family| !HOLDS_OTHERS.contains(&family.name)) {
        let ending = format!("`{}`", family.extensions[0]);
        let has = list.contains(&ending) || list.contains(family.name);
        assert!(has, "mesh-io/README.md must name {} by its ending {ending}", family.name);
    }
    let is_packed = Compression::of(Path::new("m.msh.gz")).is_some();
    assert!(is_packed && document("docs/commands.md").contains("`.gz`"));
}

/// Names of registry entries for container files, whose formats have separate entries.
const HOLDS_OTHERS: [&str; 1] = ["HDF5 or netCDF"];

/// The paragraph names a target by the name that `--to` takes, or by the first word of the format's name.
#[test]
fn the_document_of_commands_names_every_format_that_meshes_are_converted_to() {
    let commands = document("docs/commands.md");
    let paragraph = part(&commands, "**Conversion.**", "\n\n").to_lowercase();
    for target in TARGETS {
        let format = target.format.to_string().to_lowercase();
        let has =
            [target.name, format.split(' ').next().unwrap()].map(|name| paragraph.contains(name));
        let name = target.name;
        assert!(
            has.contains(&true),
            "the paragraph **Conversion.** of docs/commands.md must name {name}"
        );
    }
}

/// Returns whether a row of a table is about a format, by the first word of the format's name and a file ending.
fn is_about(row: &[&str], format: Format) -> bool {
    let name = format.to_string();
    let mut words = row[0].split(|c: char| !c.is_alphanumeric());
    let has_ending = |ending: &&str| row[1].contains(&format!("`{ending}`"));
    words.any(|word| name.split(' ').next() == Some(word))
        && FormatEntry::of(format).extensions.iter().any(has_ending)
}

/// Returns the targets with the registry entry of a format.
fn targets_of(format: Format) -> impl Iterator<Item = &'static Target> {
    let name = FormatEntry::of(format).name;
    TARGETS.iter().filter(move |target| FormatEntry::of(target.format).name == name)
}

#[test]
fn the_table_of_the_readme_file_states_which_formats_are_converted_to() {
    let name = "mesh-io/README.md";
    let text = document(name);
    let cells = |row| str::trim_matches(row, '|').split('|').map(str::trim).collect();
    let rows = part(&text, "| format |", "\n\n");
    let rows: Vec<Vec<&str>> = rows.lines().skip(2).map(cells).collect();
    for format in Format::ALL {
        let count = rows.iter().filter(|row| is_about(row, format)).count();
        assert_eq!(count, 1, "the table of {name} needs one row for {format}");
    }
    for row in &rows {
        let formats = || Format::ALL.into_iter().filter(|&format| is_about(row, format));
        let is_target = |format| targets_of(format).next().is_some();
        let has_binary = formats().flat_map(targets_of).any(|target| {
            matches!(target.write, WriteFunction::Encoded { .. } | WriteFunction::Binary(_))
        });
        let column = *row.last().unwrap();
        let place = format!("{name}, row {}: {column}", row[0]);
        assert_eq!(column == "no", !formats().any(is_target), "{place}");
        assert!(column != "yes" || formats().all(is_target), "{place}");
        assert!(!column.contains("text") || column.contains("binary") == has_binary, "{place}");
    }
}

/// Documents must not state the number of formats, which becomes wrong with every new format.
#[test]
fn documents_do_not_count_formats() {
    for name in ["README.md", "mesh-io/README.md", "mesh-io/src/lib.rs", "docs/formats.md"] {
        let text = document(name);
        let words: Vec<&str> = text.split_whitespace().collect();
        let counts = words.windows(2).filter(|pair| {
            let is_number = pair[0].trim_start_matches('[').parse::<u32>().is_ok();
            is_number && pair[1].starts_with("format")
        });
        let found: Vec<_> = counts.collect();
        assert!(found.is_empty(), "{name} counts formats, which are more with each row: {found:?}");
    }
}
