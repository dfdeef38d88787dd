//! Parts of files that conversions list as losses, as the target format or the conversion does not hold them.

use super::hdf5::made;
use super::made::netcdf::{Attribute, NetCdf, RECORDS};
use mesh_io::{Conversion, Format, MeshFile, Precision};
use std::path::Path;

fn file(name: &str, bytes: impl Into<Vec<u8>>) -> MeshFile {
    MeshFile::from_bytes(Path::new(name), bytes.into()).unwrap()
}

fn conversion(name: &str, bytes: impl Into<Vec<u8>>, to: Format) -> Conversion {
    Conversion::new(&file(name, bytes), to).unwrap().unwrap()
}

/// Returns the losses of a conversion, joined by semicolons.
fn losses(name: &str, bytes: impl Into<Vec<u8>>, to: Format) -> String {
    conversion(name, bytes, to).losses().join("; ")
}

/// A former defect: conversions lost the position of a mesh with an origin without a word.
#[test]
fn the_origin_of_a_selafin_is_kept_or_listed() {
    let grid = "bay\n1 3\n1 0 0 2\n2 1 0 2\n3 0 1 2\n1 3 1 2 3\n";
    let mut slf = conversion("a.14", grid, Format::Selafin).bytes().unwrap();
    assert_eq!(losses("a.slf", &slf[..], Format::Vtu), "");
    // Records: title (80 bytes), counts (8), the name of BOTTOM (32), then ten parameters.
    let parameters = 88 + 16 + 40 + 4;
    slf[parameters + 8..][..4].copy_from_slice(&4000_i32.to_be_bytes());
    slf[parameters + 12..][..4].copy_from_slice(&(-6000_i32).to_be_bytes());
    let own = file("a.slf", &slf[..]);
    assert_eq!(own.points(), [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let lost = losses("a.slf", &slf[..], Format::Vtu);
    assert_eq!(lost, "the origin (4000, -6000), which is not added to coordinates");
    let again = conversion("a.slf", &slf[..], Format::Selafin);
    assert_eq!(again.losses(), [""; 0]);
    assert!(again.bytes().unwrap()[100..] == slf[100..]);
}

/// A former defect: the time steps of element data had one name, by which programs find only one of them.
#[test]
fn time_steps_of_element_data_are_named_like_those_of_vertex_data() {
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
        $Elements\n2\n1 2 0 1 2 3\n2 2 0 1 3 4\n$EndElements\n";
    let data = |of: &str, rows: &str| {
        let count = rows.lines().count();
        format!("${of}\n1\n\"s\"\n1\n0\n3\n0\n1\n{count}\n{rows}$End{of}\n")
    };
    // The second step is in two parts, one element each.
    let steps =
        ["1 5\n2 6\n", "1 7\n", "2 8\n", "1 9\n2 10\n"].map(|rows| data("ElementData", rows));
    let of_nodes =
        ["1 1\n2 2\n3 3\n4 4\n", "1 5\n2 6\n3 7\n4 8\n"].map(|rows| data("NodeData", rows));
    let text = [mesh, &steps.concat(), &of_nodes.concat()].concat();
    let content = file("a.msh", text.clone()).content().unwrap();
    let named = |data: &[mesh_io::DataArray]| -> Vec<(String, Vec<f64>)> {
        data.iter().map(|data| (data.name().to_owned(), data.values().to_vec())).collect()
    };
    let expected = [("s", [5., 6.]), ("s 2", [7., 8.]), ("s 3", [9., 10.])];
    assert_eq!(named(content.cell_data()), expected.map(|(name, x)| (name.to_owned(), x.to_vec())));
    let names: Vec<_> = content.point_data().iter().map(mesh_io::DataArray::name).collect();
    assert_eq!(names, ["s", "s 2"]);
    let vtu = conversion("a.msh", text, Format::Vtu);
    assert_eq!(vtu.losses(), [""; 0]);
    let back = file("a.vtu", vtu.bytes().unwrap()).content().unwrap();
    assert_eq!(named(back.cell_data()), named(content.cell_data()));
}

/// Makes a UGRID file of five nodes and four triangles, with the variables that `add` adds.
fn ugrid(records: usize, add: impl FnOnce(&mut NetCdf)) -> Vec<u8> {
    let mut file = NetCdf::new(1);
    file.ints("bay", &[], &[0]);
    file.attribute("cf_role", Attribute::Text("mesh_topology"));
    file.attribute("topology_dimension", Attribute::Whole(2));
    file.attribute("node_coordinates", Attribute::Text("x y"));
    file.attribute("face_node_connectivity", Attribute::Text("faces"));
    file.ints("faces", &["face", "corner"], &[0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]);
    for (name, numbers) in [("x", [0., 2., 2., 0., 1.]), ("y", [0., 0., 2., 2., 1.])] {
        file.reals(name, Precision::Double, &["node"], &numbers);
    }
    add(&mut file);
    let lengths = [("node", 5), ("face", 4), ("corner", 3), ("name", 16), (RECORDS, 0)];
    file.build(&lengths, records).bytes
}

/// A former defect: conversions wrote packed numbers without the factor and the offset that unpack them.
#[test]
fn packed_numbers_of_ugrid_are_unpacked() {
    let packed = ugrid(0, |file| {
        let pack = |file: &mut NetCdf| {
            file.attribute("scale_factor", Attribute::Real(0.5));
            file.attribute("add_offset", Attribute::Whole(10));
        };
        file.ints("level", &["node"], &[0, 1, -2, -9, 4]);
        file.attribute("_FillValue", Attribute::Whole(-9));
        pack(file);
        file.reals("depth", Precision::Double, &["node"], &[1., 2., 3., 4., 5.]);
        pack(file);
        file.ints("dry", &["face"], &[2, 4, 6, 8]);
        pack(file);
        file.ints("plain", &["face"], &[2, 4, 6, 8]);
    });
    let own = file("a.nc", &packed[..]);
    let vtu = Conversion::new(&own, Format::Vtu).unwrap().unwrap();
    assert_eq!(vtu.losses(), [""; 0]);
    let content = file("a.vtu", vtu.bytes().unwrap()).content().unwrap();
    let [level, depth] = content.point_data() else { panic!("two arrays of vertices") };
    assert_eq!(level.values()[..3], [10.0, 10.5, 9.0]);
    assert!(level.values()[3].is_nan() && level.is_real());
    assert_eq!(depth.values(), [10.5, 11.0, 11.5, 12.0, 12.5]);
    let [dry, plain] = content.cell_data() else { panic!("two arrays of elements") };
    assert_eq!((dry.values(), plain.values()), (&[11., 12., 13., 14.][..], &[2., 4., 6., 8.][..]));
    assert!(dry.is_real() && !plain.is_real());
    // A run interpolates the stored numbers, as it rewrites them in place.
    let mut fields = own.point_fields(Some(&["depth".to_owned()])).unwrap();
    assert_eq!(fields[0].values(), [1., 2., 3., 4., 5.]);
    fields[0].set(vec![3., 2., 3., 4., 5.]).unwrap();
    let moved = Conversion::moved(&own, Format::Vtu, own.points(), &fields).unwrap().unwrap();
    let content = file("a.vtu", moved.bytes().unwrap()).content().unwrap();
    assert_eq!(content.point_data()[1].values(), [11.5, 11.0, 11.5, 12.0, 12.5]);
}

/// A former defect: names that differ only in bytes that are not UTF-8 became one group.
#[test]
fn names_in_latin_1_stay_different_and_readable() {
    let marker = |name: &[u8], line: &str| {
        [b"MARKER_TAG= ", name, b"\nMARKER_ELEMS= 1\n3 ", line.as_bytes(), b"\n"].concat()
    };
    let mesh = b"NDIME= 2\nNELEM= 1\n5 0 1 2\nNPOIN= 3\n0 0\n1 0\n0 1\nNMARK= 2\n";
    let own = file(
        "a.su2",
        [&mesh[..], &marker(b"\xe9t\xe9", "0 1"), &marker(b"\xe8t\xe8", "1 2")].concat(),
    );
    let names: Vec<_> = own.groups().unwrap().iter().map(|group| group.to_string()).collect();
    assert_eq!(names, ["marker line \u{e9}t\u{e9}", "marker line \u{e8}t\u{e8}"]);
    let gmsh = Conversion::new(&own, Format::Gmsh22).unwrap().unwrap();
    assert_eq!((gmsh.losses(), gmsh.renamings()), (&[][..], &[][..]));
    let text = gmsh.text().unwrap();
    assert!(text.contains("\"\u{e9}t\u{e9}\"\n") && text.contains("\"\u{e8}t\u{e8}\"\n"), "{text}");
}

/// Makes a legacy VTK file of 32 triangles with data, which have a number for each triangle.
fn vtk(data: &[(&str, &dyn Fn(u64) -> u64)]) -> String {
    let points: String = (0..27).map(|k| format!("{} {} 0\n", k % 9, k / 9)).collect();
    let squares = (0..16_u32).map(|k| k % 8 + 9 * (k / 8));
    let triangles = squares.flat_map(|a| [[a, a + 1, a + 10], [a, a + 10, a + 9]]);
    let cells: String = triangles.map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    let array = |(name, of): &(&str, &dyn Fn(u64) -> u64)| {
        let numbers: String = (0..32).map(|k| format!("{}\n", of(k))).collect();
        format!("SCALARS {name} long 1\nLOOKUP_TABLE default\n{numbers}")
    };
    let data: String = data.iter().map(array).collect();
    format!(
        "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 27 double\n{points}\
         CELLS 32 128\n{cells}CELL_TYPES 32\n{}CELL_DATA 32\n{data}",
        "5\n".repeat(32)
    )
}

/// A former defect: conversions rounded large whole numbers without a word.
#[test]
fn whole_numbers_beyond_the_precision_of_doubles_are_listed() {
    let large = |k: u64| (1 << 53) + 1 - 2 * k;
    let text = vtk(&[("small", &|k| large(k.max(1))), ("id", &large)]);
    let lost = "digits of whole numbers from 2^53 on: id";
    assert_eq!(losses("a.vtk", &text[..], Format::Vtu), lost);
    assert_eq!(losses("a.vtk", &text[..], Format::Off), "data of elements: small, id");
}

/// A former defect: conversions left out the numbers of an array of regions that differ for nearly every element.
#[test]
fn numbers_of_regions_that_count_triangles_are_listed() {
    let text = vtk(&[("region", &|k| k)]);
    let lost = "numbers that differ for nearly every element: region";
    for to in [Format::Vtu, Format::Gmsh22, Format::Su2] {
        assert_eq!(losses("a.vtk", &text[..], to), lost, "{to}");
    }
    let text = vtk(&[("region", &|k| k / 16)]);
    assert_eq!(losses("a.vtk", &text[..], Format::Vtu), "");
}

/// A former defect: conversions lost the times of time steps without a word, except those of Exodus and SELAFIN.
#[test]
fn times_of_time_steps_are_listed() {
    let lost = "times of time steps";
    let gmsh = |time: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n\
             1 2 0 1 2 3\n$EndElements\n$NodeData\n1\n\"s\"\n1\n{time}\n3\n0\n1\n3\n1 1\n2 2\n3 3\n$EndNodeData\n"
        )
    };
    assert_eq!(losses("a.msh", gmsh("0.0"), Format::Vtu), "");
    assert_eq!(losses("a.msh", gmsh("2.5"), Format::Vtu), lost);
    assert_eq!(losses("a.msh", gmsh("2.5"), Format::Gmsh41), lost);
    assert_eq!(losses("a.xdmf", xdmf("<Time Value=\"0\"/>"), Format::Vtu), "");
    assert_eq!(losses("a.xdmf", xdmf("<Time Value=\"2.5\"/>"), Format::Vtu), lost);
    assert_eq!(losses("a.xdmf", xdmf(&"<Time Value=\"0\"/>".repeat(2)), Format::Vtu), lost);
    let steps = |file: &mut NetCdf| {
        file.reals("level", Precision::Double, &[RECORDS, "node"], &[0.0; 5]);
        file.reals("clock", Precision::Double, &[RECORDS], &[0.0]);
        file.attribute("units", Attribute::Text("s since 2000-01-01"));
    };
    assert_eq!(losses("a.nc", ugrid(1, steps), Format::Vtu), lost);
    assert_eq!(losses("a.nc", ugrid(2, steps), Format::Vtu), lost);
}

/// Makes an XDMF of one triangle, with further elements in its grid.
fn xdmf(elements: &str) -> String {
    let item = |of: &str, kind: &str, numbers: &str| {
        format!(
            "<DataItem Dimensions=\"{of}\" NumberType=\"{kind}\" Format=\"XML\">{numbers}</DataItem>"
        )
    };
    format!(
        "<?xml version=\"1.0\"?><Xdmf Version=\"3.0\"><Domain><Grid Name=\"mesh\"><Geometry GeometryType=\"XY\">{}</Geometry>\
         <Topology TopologyType=\"Triangle\" NumberOfElements=\"1\">{}</Topology>{elements}</Grid></Domain></Xdmf>",
        item("3 2", "Float\" Precision=\"8", "0 0 1 0 0 1"),
        item("1 3", "Int", "0 1 2")
    )
}

/// A former defect: conversions lost variables of UGRID and elements of XDMF without a word.
#[test]
fn variables_and_attributes_of_no_vertex_and_no_element_are_listed() {
    let others = |file: &mut NetCdf| {
        file.names("stations", &["node", "name"], &["a", "b", "c", "d", "e"]);
        file.ints("crs", &[], &[0]);
        file.attribute("epsg", Attribute::Whole(25832));
        file.reals("sigma", Precision::Double, &["corner"], &[0.0; 3]);
    };
    let lost = "variables of neither nodes nor faces: stations, sigma";
    assert_eq!(losses("a.nc", ugrid(0, others), Format::Vtu), lost);
    assert_eq!(losses("a.nc", ugrid(0, |_| ()), Format::Vtu), "");
    let set = "<Set Name=\"inlet\" SetType=\"Node\"><DataItem Dimensions=\"1\" NumberType=\"Int\">0</DataItem></Set>";
    assert_eq!(losses("a.xdmf", xdmf(set), Format::Vtu), "sets of nodes or cells (Set)");
    let reference = "<Attribute Name=\"a\" Center=\"Node\"><DataItem Reference=\"XML\">/Xdmf/Domain/DataItem</DataItem></Attribute>";
    assert_eq!(
        losses("a.xdmf", xdmf(reference), Format::Vtu),
        "attributes that refer to other items"
    );
    assert_eq!(losses("a.xdmf", xdmf(""), Format::Vtu), "");
}

/// Formats with a number for each vertex have one group of a vertex, and files of 32-bit numbers no larger numbers.
#[test]
fn groups_of_vertices_that_do_not_fit_their_numbers_are_told() {
    let sets = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 0., 1.\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*NSET, NSET=a\n1, 2\n*NSET, NSET=b\n2, 3\n";
    let told = "names of groups of vertices, which become numbers: a, b; further groups of a vertex: the first group is kept";
    assert_eq!(losses("a.inp", sets, Format::FreeFem), told);
    let text = conversion("a.inp", sets, Format::FreeFem).text().unwrap();
    assert!(text.contains("0.0 0.0 1\n1.0 0.0 1\n0.0 1.0 2\n"), "{text}");
    let wide = "MeshVersionFormatted 2\nDimension 2\nVertices\n3\n0 0 4294967301\n1 0 1\n0 1 7\nTriangles\n1\n1 2 3 8589934599\nEnd\n";
    let told = "numbers of groups beyond 32 bits, which become others: 8589934599, 4294967301";
    for (to, name) in [(Format::Medit, "a.mesh"), (Format::MeditBinary, "a.meshb")] {
        assert_eq!(losses("a.mesh", wide, to), told);
        let back = file(name, conversion("a.mesh", wide, to).bytes().unwrap());
        let mut told: Vec<String> =
            back.groups().unwrap().iter().map(ToString::to_string).collect();
        told.sort();
        let points = ["reference point 1", "reference point 2", "reference point 7"];
        assert_eq!(told, [&points[..], &["reference surface 1"]].concat());
    }
}

/// A lone group without a name was left out without a word, even if it has only some of the elements. So were groups of points in
/// formats without points.
#[test]
fn a_lone_group_of_some_elements_is_a_loss() {
    let msh = |elements: &[&str]| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
             $Elements\n{}\n{}\n$EndElements\n",
            elements.len(),
            elements.join("\n")
        )
    };
    let losses = |elements: &[&str], to| losses("a.msh", msh(elements), to);
    let some = ["1 15 2 9 1 3", "2 1 2 7 1 1 2", "3 2 2 5 1 1 2 3", "4 2 2 0 1 1 3 4"];
    let all_groups = "groups of points (physical): 9; groups of lines (physical): 7; groups of surfaces (physical): 5";
    assert_eq!(losses(&some, Format::Off), all_groups);
    let points = ["1 15 2 9 0 3", "2 15 2 10 0 2", "3 2 2 5 1 1 2 3", "4 2 2 5 1 1 3 4"];
    assert_eq!(losses(&points, Format::Abaqus), "groups of points (physical): 9, 10");
    // The numbers of groups of the whole boundary and of all triangles say nothing.
    let whole = [
        "1 1 2 7 1 1 2",
        "2 1 2 7 1 2 3",
        "3 1 2 7 1 3 4",
        "4 1 2 7 1 4 1",
        "5 2 2 5 1 1 2 3",
        "6 2 2 5 1 1 3 4",
    ];
    assert_eq!(losses(&whole, Format::Off), "");
}

/// gmsh displays data of 1, 3 or 9 components, and reads any number of components.
#[test]
fn filled_components_of_gmsh_are_listed() {
    let vtk = |each: usize| {
        let numbers =
            |count: usize| (1..=count * each).map(|n| n.to_string()).collect::<Vec<_>>().join(" ");
        format!(
            "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n\
             0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\nCELL_DATA 1\nFIELD FieldData 1\n\
             c {each} 1 double\n{}\nPOINT_DATA 3\nFIELD FieldData 1\np {each} 3 double\n{}\n",
            numbers(1),
            numbers(3)
        )
    };
    for (each, padded) in [(1, 1), (2, 3), (3, 3), (4, 9), (9, 9), (12, 12)] {
        for format in [Format::Gmsh22, Format::Gmsh41] {
            let conversion = conversion("a.vtk", vtk(each), format);
            let expected = match padded == each {
                true => "",
                false => {
                    "numbers of components of data of vertices, which zeros fill up to 3 or 9: p; \
                     numbers of components of data of elements, which zeros fill up to 3 or 9: c"
                }
            };
            assert_eq!(conversion.losses(), [""; 0]);
            assert_eq!(conversion.omissions().join("; "), expected);
            let content = file("a.msh", conversion.bytes().unwrap()).content().unwrap();
            assert_eq!(content.unsupported(), [""; 0]);
            let data = &content.point_data()[0];
            assert_eq!(data.components(), padded);
            let second = |k: usize| if k < each { (each + k + 1) as f64 } else { 0.0 };
            let expected: Vec<f64> = (0..padded).map(second).collect();
            assert_eq!(data.values()[padded..2 * padded], expected);
            assert_eq!(content.cell_data()[0].components(), padded);
        }
    }
}

/// A former defect: beside lines, data that are zero in all triangles were left out.
#[test]
fn cell_data_of_zeros_are_written_as_xdmf_beside_lines() {
    let vtk = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
               0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 3 11\n3 0 1 2\n3 0 2 3\n2 0 1\nCELL_TYPES 3\n5\n5\n3\n\
               CELL_DATA 3\nFIELD FieldData 3\nmarked 1 3 int\n0 0 1\nn 1 3 int\n1 2 0\nboth 1 3 int\n0 0 0\n";
    let conversion = conversion("a.vtk", vtk, Format::Xdmf);
    assert_eq!(conversion.losses(), [""; 0]);
    let text = conversion.text().unwrap();
    let (triangles, lines) = text.split_once("</Grid>").unwrap();
    for array in ["marked", "n", "both"] {
        let attribute = format!("<Attribute Name=\"{array}\"");
        assert!(triangles.contains(&attribute) && lines.contains(&attribute), "{array}: {text}");
    }
    let content = file("a.xdmf", text).content().unwrap();
    // Numbers of lines are mesh tags, which are groups. Triangles without a group have the number 0.
    let data: Vec<_> =
        content.cell_data().iter().map(|data| (data.name(), &data.values()[..2])).collect();
    assert_eq!(data, [("n", &[1.0, 2.0][..])]);
    let line = content.cells().find(|cell| cell.kind == mesh_io::CellKind::Line).unwrap();
    let tags: Vec<_> = line.groups().map(|group| (group.kind(), group.tag())).collect();
    assert_eq!(tags, [("marked", Some(1)), ("n", Some(0)), ("both", Some(0))]);
}

/// A former defect: types of boundary conditions were lost without a word.
#[test]
fn types_of_boundaries_of_cgns_are_listed() {
    let bytes = std::fs::read(made("periodic.cgns")).unwrap();
    assert!(!losses("a.cgns", &bytes[..], Format::Cgns).contains("types"));
    let (from, to) = (b"FamilySpecified", b"BCWallViscous  ");
    let at = bytes.windows(from.len()).position(|own| own == from).unwrap();
    let typed = [&bytes[..at], to, &bytes[at + to.len()..]].concat();
    for format in [Format::Cgns, Format::Vtu] {
        let expected = "types of boundaries: S_1 (BCWallViscous)";
        assert!(losses("a.cgns", &typed[..], format).contains(expected));
    }
}

/// A former defect: polylines became lines, and sets of points single points, without a word.
#[test]
fn polylines_and_sets_of_points_that_are_divided_are_listed() {
    let lines = "lines of more than two points, which become several lines";
    let points = "sets of points, which become single points";
    for (vertices, ends, expected) in
        [("1 0", "2 0 1", ""), ("2 0 1", "3 0 1 2", &*format!("{points}; {lines}"))]
    {
        let count = |list: &str| list.split(' ').count();
        let text = format!(
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n\
             VERTICES 1 {}\n{vertices}\nLINES 1 {}\n{ends}\nPOLYGONS 1 4\n3 0 1 2\n",
            count(vertices),
            count(ends)
        );
        assert_eq!(losses("a.vtk", text, Format::Vtu), expected);
        let corners: Vec<usize> = (1..count(ends)).collect();
        let corners = corners.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nl {corners}\nf 1 2 3\n");
        let expected = if count(ends) > 3 { lines } else { "" };
        assert_eq!(losses("a.obj", text, Format::Obj), expected);
    }
}

/// A former defect: whole numbers that some lines lack were left out at all lines.
#[test]
fn numbers_of_some_lines_are_written_as_xdmf() {
    let piece = |data: &str| {
        format!(
            "<Piece NumberOfPoints=\"3\" NumberOfCells=\"2\"><CellData>{data}</CellData><Points>\n\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells>\n\
             <DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 0 1</DataArray>\n\
             <DataArray type=\"Int32\" Name=\"offsets\">3 5</DataArray>\n\
             <DataArray type=\"UInt8\" Name=\"types\">5 3</DataArray></Cells></Piece>\n"
        )
    };
    let array = "<DataArray type=\"Int32\" Name=\"n\">4 5</DataArray>";
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\n{}{}</UnstructuredGrid></VTKFile>",
        piece(array),
        piece("")
    );
    let conversion = conversion("a.vtu", vtu, Format::Xdmf);
    assert_eq!(conversion.losses(), [""; 0]);
    let content = file("a.xdmf", conversion.bytes().unwrap()).content().unwrap();
    let [n] = content.cell_data() else { panic!("{} arrays", content.cell_data().len()) };
    let lines =
        content.cells().zip(n.values()).filter(|(cell, _)| cell.kind == mesh_io::CellKind::Line);
    let given: Vec<f64> = lines.map(|(_, value)| *value).filter(|value| !value.is_nan()).collect();
    assert_eq!(given, [5.0]);
}

/// A former defect: numbers of nodes were lost without a word.
#[test]
fn numbers_of_nodes_of_med_are_listed() {
    let bytes = std::fs::read(made("gmsh.med")).unwrap();
    assert_eq!(losses("a.med", &bytes[..], Format::Med), "");
    // NUM has the numbers of the 30 nodes. There are more elements.
    let numbers: Vec<u8> = (1..=30_i64).flat_map(i64::to_le_bytes).collect();
    let next = 31_i64.to_le_bytes();
    let is_list = |at: &usize| {
        bytes[*at..].starts_with(&numbers) && !bytes[at + numbers.len()..].starts_with(&next)
    };
    let at = (0..bytes.len()).find(is_list).unwrap();
    let changed = [&bytes[..at], &77_i64.to_le_bytes(), &bytes[at + 8..]].concat();
    assert_eq!(losses("a.med", changed, Format::Med), "numbers of nodes (NUM)");
}
