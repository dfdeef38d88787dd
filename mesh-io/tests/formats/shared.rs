//! Files in which several arrays have the same bytes. A rewrite of one array must not change another.

use super::Folder;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mesh_io::{Conversion, Format, MeshFile, PointField};
use std::fs;

/// Points of a square with a vertex inside, and its four triangles.
const POINTS: [f64; 15] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0.5, 0.25, 0.];
const CORNERS: [i64; 12] = [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];
/// Data of the points.
const DATA: [f64; 5] = [2.5, 3.5, 4.5, 5.5, 6.5];

fn reals(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn longs(numbers: impl IntoIterator<Item = i64>) -> Vec<u8> {
    numbers.into_iter().flat_map(i64::to_le_bytes).collect()
}

/// Returns a VTU of `pieces` equal pieces with appended data, with an array of point data for each name, number of
/// components and array index: 0 for the data, 1 for the points.
fn vtu(base64: bool, pieces: usize, data: &[(&str, u64, usize)]) -> Vec<u8> {
    let arrays = [
        reals(&DATA),
        reals(&POINTS),
        longs(CORNERS),
        longs((1..=4).map(|cell| 3 * cell)),
        vec![5; 4],
    ];
    let (mut appended, mut offsets) = (Vec::new(), Vec::new());
    for bytes in arrays {
        offsets.push(appended.len());
        let whole = [&(bytes.len() as u32).to_le_bytes()[..], &bytes].concat();
        appended.extend(if base64 { STANDARD.encode(whole).into_bytes() } else { whole });
    }
    let array = |kind: &str, name: &str, components: u64, index: usize| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" \
             offset=\"{}\"/>\n",
            offsets[index]
        )
    };
    let data: String =
        data.iter().map(|(name, each, index)| array("Float64", name, *each, *index)).collect();
    let piece = format!(
        "<Piece NumberOfPoints=\"5\" NumberOfCells=\"4\">\n<PointData>\n{data}</PointData>\n<Points>\n{}</Points>\n\
         <Cells>\n{}{}{}</Cells>\n</Piece>\n",
        array("Float64", "Points", 3, 1),
        array("Int64", "connectivity", 1, 2),
        array("Int64", "offsets", 1, 3),
        array("UInt8", "types", 1, 4)
    );
    let encoding = if base64 { "base64" } else { "raw" };
    let head = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n<UnstructuredGrid>\n\
         {}</UnstructuredGrid>\n<AppendedData encoding=\"{encoding}\">\n_",
        piece.repeat(pieces)
    );
    [head.as_bytes(), &appended, b"\n</AppendedData>\n</VTKFile>\n"].concat()
}

/// Returns the fields with these names, each with its values doubled.
fn doubled(file: &MeshFile, names: &[&str]) -> Vec<PointField> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let mut fields = file.point_fields(Some(&names)).unwrap();
    for field in &mut fields {
        field.set(field.values().iter().map(|x| 2.0 * x).collect()).unwrap();
    }
    fields
}

fn moved(file: &MeshFile) -> Vec<[f64; 2]> {
    file.points().iter().map(|[x, y]| [x + 0.125 * x * y, *y]).collect()
}

/// Checks that `file` is written with both of `names`, and refused with one of them.
fn check_twins(folder: &Folder, name: &str, names: [&str; 2]) {
    let (file, out) = (folder.read(name), folder.path(&format!("out-{name}")));
    for (own, other) in [(names[0], names[1]), (names[1], names[0])] {
        let fields = doubled(&file, &[own]);
        let error = file.write_with_fields(&out, &moved(&file), &fields).unwrap_err().to_string();
        let problem =
            format!("'{own}' has the bytes of '{other}' too, and would change both. Inter");
        assert!(error.contains(&problem), "{error}");
        assert!(!out.exists());
    }
    let fields = doubled(&file, &names);
    file.write_with_fields(&out, &moved(&file), &fields).unwrap();
    let again = MeshFile::read(&out).unwrap();
    assert_eq!(again.points(), moved(&file));
    for field in again.point_fields(None).unwrap().iter().filter(|f| names.contains(&f.name())) {
        assert_eq!(field.values(), DATA.map(|x| 2.0 * x), "{}", field.name());
    }
    assert_eq!(again.difference_ignoring(&file, [&doubled(&again, &names), &fields]), None);
}

#[test]
fn arrays_of_a_vtu_with_the_same_bytes_change_together() {
    for base64 in [false, true] {
        let folder = Folder::new(&[]);
        folder.put("a.vtu", vtu(base64, 1, &[("A", 1, 0), ("B", 1, 0)]));
        check_twins(&folder, "a.vtu", ["A", "B"]);
        // Without data to change, and without data of the same bytes, nothing is refused.
        let file = folder.read("a.vtu");
        file.write(&folder.path("b.vtu"), &moved(&file)).unwrap();
        let again = folder.read("b.vtu");
        assert_eq!(again.points(), moved(&file));
        assert_eq!(again.difference(&file), None);
        folder.put("c.vtu", vtu(base64, 1, &[("A", 1, 0)]));
        let file = folder.read("c.vtu");
        file.write_with_fields(&folder.path("d.vtu"), &moved(&file), &doubled(&file, &["A"]))
            .unwrap();
    }
}

/// Points may have the bytes of data, or of the points of another piece.
#[test]
fn points_of_a_vtu_with_the_bytes_of_another_array_are_not_written() {
    let data: &[(&str, u64, usize)] = &[("A", 1, 0), ("V", 3, 1)];
    for (base64, pieces, data) in
        [false, true].into_iter().flat_map(|base64| [(base64, 1, data), (base64, 2, &[])])
    {
        let folder = Folder::new(&[]);
        folder.put("a.vtu", vtu(base64, pieces, data));
        let file = folder.read("a.vtu");
        let other = if pieces > 1 { "the points of piece 2" } else { "'V'" };
        let problem =
            format!("the points of a.vtu have the bytes of {other} too, and would change");
        let out = folder.path("out.vtu");
        let errors = [
            file.check_destination(&out).unwrap_err(),
            file.write(&out, &moved(&file)).unwrap_err(),
            file.write_to(&out, &mut Vec::new(), &moved(&file)).unwrap_err(),
        ];
        for error in errors.map(|error| error.to_string()) {
            assert!(
                error.contains(&problem) && error.contains("Convert the mesh first"),
                "{error}"
            );
        }
        // Third coordinates have the bytes of the points.
        let z = doubled(&file, &["z"]);
        assert!(z[0].values().iter().all(|z| *z == 0.0));
        assert!(!out.exists());
        // A write that changes nothing returns the same bytes.
        file.write_with_fields(&out, file.points(), &z).unwrap();
        assert!(fs::read(&out).unwrap() == fs::read(folder.path("a.vtu")).unwrap());
        assert_eq!(file.difference(&folder.read("out.vtu")), None);
        let mut z = z;
        z[0].set(vec![1.0; file.points().len()]).unwrap();
        let error = file.write_with_fields(&out, file.points(), &z).unwrap_err().to_string();
        assert!(error.contains(&problem), "{error}");
        // The remedy of the message.
        let conversion = Conversion::new(&file, Format::Gmsh41).unwrap().unwrap();
        conversion.write(&folder.path("a.msh")).unwrap();
        let file = folder.read("a.msh");
        file.write(&folder.path("b.msh"), &moved(&file)).unwrap();
        assert_eq!(folder.read("b.msh").points(), moved(&file));
    }
}

/// Pieces without points or cells may name the offset of the next array, as they have no bytes.
#[test]
fn empty_arrays_have_no_bytes_in_common() {
    let mut bytes = vtu(false, 2, &[("A", 1, 0)]);
    let [old, new] = [(5, 4), (0, 0)].map(|(points, cells)| {
        format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\"").into_bytes()
    });
    let at = memchr::memmem::find(&bytes, &old).unwrap();
    bytes.splice(at..at + old.len(), new);
    let folder = Folder::new(&[]);
    folder.put("a.vtu", bytes);
    let file = folder.read("a.vtu");
    assert_eq!(file.points().len(), 5);
    let fields = doubled(&file, &["A"]);
    file.write_with_fields(&folder.path("b.vtu"), &moved(&file), &fields).unwrap();
    assert_eq!(folder.read("b.vtu").points(), moved(&file));
}

/// Returns an XDMF with points and data in raw files. `data` has the name of each attribute, the file, the offset and
/// the number of its values.
fn xdmf(data: &[(&str, &str, usize, usize)]) -> String {
    let item = |file: &str, seek: usize, shape: &str| {
        format!(
            "<DataItem Format=\"Binary\" NumberType=\"Float\" Precision=\"8\" Endian=\"Little\" Seek=\"{seek}\" \
             Dimensions=\"{shape}\">{file}</DataItem>"
        )
    };
    let data: String = data
        .iter()
        .map(|(name, file, seek, count)| {
            let item = item(file, *seek, &count.to_string());
            format!("<Attribute Name=\"{name}\" Center=\"Node\">{item}</Attribute>\n")
        })
        .collect();
    format!(
        "<Xdmf Version=\"3.0\"><Domain><Grid><Topology TopologyType=\"Triangle\" NumberOfElements=\"4\">\
         <DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"4 3\">0 1 4 1 2 4 2 3 4 3 0 4</DataItem></Topology>\n\
         <Geometry GeometryType=\"XYZ\">{}</Geometry>\n{data}</Grid></Domain></Xdmf>\n",
        item("p.bin", 0, "5 3")
    )
}

#[test]
fn attributes_of_an_xdmf_with_the_same_bytes_change_together() {
    let folder = Folder::new(&[("a.xdmf", &xdmf(&[("A", "d.bin", 0, 5), ("B", "d.bin", 0, 5)]))]);
    folder.put("p.bin", reals(&POINTS));
    folder.put("d.bin", reals(&DATA));
    check_twins(&folder, "a.xdmf", ["A", "B"]);
    // Some bytes in common.
    folder.put("d.bin", reals(&[DATA, DATA].concat()));
    folder.put("b.xdmf", xdmf(&[("A", "d.bin", 0, 5), ("B", "d.bin", 8, 5)]));
    let file = folder.read("b.xdmf");
    for names in [&["A"][..], &["B"], &["A", "B"]] {
        let fields = doubled(&file, names);
        let out = folder.path("no.xdmf");
        let error = file.write_with_fields(&out, &moved(&file), &fields).unwrap_err().to_string();
        assert!(error.contains("too, and would change both"), "{error}");
        assert!(!out.exists());
    }
}

#[test]
fn points_of_an_xdmf_with_the_bytes_of_an_attribute_are_not_written() {
    let folder = Folder::new(&[("a.xdmf", &xdmf(&[("V", "p.bin", 0, 15)]))]);
    folder.put("p.bin", reals(&POINTS));
    let file = folder.read("a.xdmf");
    let error = file.write(&folder.path("b.xdmf"), &moved(&file)).unwrap_err().to_string();
    assert!(error.contains("the points of a.xdmf have the bytes of 'V' too"), "{error}");
    assert!(fs::read(folder.path("p.bin")).unwrap() == reals(&POINTS));
}
