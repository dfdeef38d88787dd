//! Data of vertices: fields are found by name and replaced in place, and no other byte changes.

use super::facts::mesh_of;
use super::made::base;
use super::others::{folder, for_each, pieces, value};
use super::vtu::{self, Place, styles};
use super::{Folder, damage};
use mesh_io::Precision;
use mesh_io::{Conversion, Format, MeshFile, PointField};
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Returns a changed value with few digits; every fourth value stays unchanged.
fn changed(value: f64, index: usize) -> f64 {
    value + 0.25 * (index % 4) as f64
}

/// Sets changed values in each field.
fn change(fields: &mut [PointField]) {
    for field in fields {
        let values = field.values().iter().enumerate();
        let values = values.map(|(i, &value)| changed(value, i)).collect();
        assert_eq!(field.set(values).unwrap(), 0);
    }
}

fn bits(fields: &[PointField]) -> Vec<(String, usize, Vec<u64>)> {
    let bits = |field: &PointField| field.values().iter().map(|x| x.to_bits()).collect();
    let all = fields.iter().map(|field| (field.name().to_owned(), field.components(), bits(field)));
    all.collect()
}

/// Changes all data and coordinates of a file, and checks that the file has the new numbers and no other change.
/// Returns how many numbers the fields have.
fn check(folder: &Folder, name: &str) -> usize {
    let file = folder.read(name);
    let out = name.replace("in.", "out.").replace("fort", "out");
    let mut fields = file.point_fields(None).unwrap();
    let numbers = fields.iter().map(|field| field.values().len()).sum();
    let read = fs::read(folder.path(name)).unwrap();
    file.write_with_fields(&folder.path(&out), file.points(), &fields).unwrap();
    assert!(fs::read(folder.path(&out)).unwrap() == read, "{name}: unchanged");
    change(&mut fields);
    // Changes coordinates and data in one call.
    let points: Vec<_> = file.points().iter().map(|[x, y]| [x + 0.125, *y]).collect();
    file.write_with_fields(&folder.path(&out), &points, &fields).unwrap();
    let after = folder.read(&out);
    let rounded = |x: f64| file.precision().rounded(x);
    assert_eq!(after.points(), points.iter().map(|p| p.map(rounded)).collect::<Vec<_>>());
    assert_eq!(after.triangles(), file.triangles());
    let found = after.point_fields(None).unwrap();
    assert_eq!(bits(&found), bits(&fields), "{name}");
    assert_eq!(file.difference_ignoring(&after, [&fields, &found]), None);
    if numbers > 0 {
        assert!(file.difference(&after).is_some());
    }
    // Changes only data, then restores them: the original numbers must be read.
    file.write_with_fields(&folder.path(&out), file.points(), &fields).unwrap();
    let after = folder.read(&out);
    let mut back = after.point_fields(None).unwrap();
    let original = file.point_fields(None).unwrap();
    for (field, own) in back.iter_mut().zip(&original) {
        field.set(own.values().to_vec()).unwrap();
    }
    let again = format!("again-{out}");
    after.write_with_fields(&folder.path(&again), file.points(), &back).unwrap();
    let again = folder.read(&again);
    assert_eq!(bits(&again.point_fields(None).unwrap()), bits(&original));
    assert_eq!(mesh_of(&again), mesh_of(&file));
    numbers
}

#[test]
fn data_are_replaced_in_every_format() {
    let (files, numbers) = (AtomicUsize::new(0), AtomicUsize::new(0));
    for_each(&base(), |made| {
        let found = check(&folder(made, &made.bytes), made.name);
        files.fetch_add(usize::from(found > 0), Ordering::Relaxed);
        numbers.fetch_add(found, Ordering::Relaxed);
    });
    let (files, numbers) = (files.into_inner(), numbers.into_inner());
    assert!(files >= 30 && numbers > 30 * files, "{numbers} numbers in {files} files");
}

/// Each array may change its length, which moves the arrays after it.
#[test]
fn data_are_replaced_in_every_encoding_of_vtu() {
    for style in styles().into_iter().step_by(3) {
        let numbers = check(&vtu::folder(&vtu::write(&base(), style)), "in.vtu");
        assert_eq!(numbers, 30 + 2 * 60, "{style:?}");
    }
    let ascii = styles().into_iter().find(|style| style.place == Place::Text).unwrap();
    let file = vtu::folder(&vtu::write(&base(), ascii)).read("in.vtu");
    assert_eq!(file.data_names(), ["z", "flow", "wind"]);
}

/// In text, only words that are data change. The test splits the file without the reader.
#[test]
fn only_the_tokens_of_data_change_in_text() {
    let tried = AtomicUsize::new(0);
    for_each(&base(), |made| {
        let folder = folder(made, &made.bytes);
        let file = folder.read(made.name);
        let mut fields = file.point_fields(None).unwrap();
        if !made.is_text() || fields.is_empty() {
            return;
        }
        change(&mut fields);
        let mut out = Vec::new();
        file.write_to_with_fields("out".as_ref(), &mut out, file.points(), &fields).unwrap();
        let [old, new] = [&made.bytes, &out].map(|bytes| pieces(made.format, bytes));
        assert_eq!(old.len(), new.len());
        let mut differ = 0;
        for (old, new) in old.iter().zip(&new).filter(|(old, new)| old != new) {
            let [old, new] = [old, new].map(|word| value(word));
            assert!([0.25, 0.5, 0.75].iter().any(|by| (new - old - by).abs() < 1e-6));
            differ += 1;
        }
        let numbers: usize = fields.iter().map(|field| field.values().len()).sum();
        let same = fields.iter().map(|field| field.values().len().div_ceil(4)).sum::<usize>();
        assert_eq!(differ, numbers - same, "{}", made.what);
        tried.fetch_add(1, Ordering::Relaxed);
    });
    assert!(tried.into_inner() > 12);
}

const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n\
50 .5 .5 0\n$EndNodes\n$Elements\n4\n1 2 2 1 1 10 20 50\n2 2 2 1 1 20 30 50\n3 2 2 1 1 30 40 50\n4 2 2 1 1 40 10 50\n\
$EndElements\n$NodeData\n1\n\"a view\"\n1\n0.0\n3\n0\n1\n3\n50 1.50\n10 2\n30 7\n$EndNodeData\n$NodeData\n1\n\"v\"\n\
1\n1.0\n4\n0\n3\n5\n0\n10 1 2 3\n20 1 2 3\n30 1 2 3\n40 1 2 3\n50 4.0 5 6\n$EndNodeData\n";

#[test]
fn node_data_of_gmsh_are_those_of_the_nodes_they_name() {
    let folder = Folder::new(&[("in.msh", GMSH)]);
    let file = folder.read("in.msh");
    assert_eq!(file.data_names(), ["a view", "v"]);
    let mut fields = file.point_fields(Some(&["a view".into(), "v".into()])).unwrap();
    let [view, v] = &mut fields[..] else { panic!() };
    let (given, none): (Vec<f64>, Vec<f64>) = view.values().iter().partition(|x| !x.is_nan());
    assert_eq!((given, none.len()), (vec![2.0, 7.0, 1.5], 2));
    assert_eq!((v.components(), v.values().len()), (3, 15));
    assert_eq!(v.values()[12..], [4.0, 5.0, 6.0]);
    let mut values = v.values().to_vec();
    values[13] = 5.5;
    v.set(values).unwrap();
    // The view has no value for one node, so the new value of this node is not written. A NaN leaves the number
    // unchanged.
    assert_eq!(view.set(vec![f64::NAN, 9.0, 8.0, 9.0, 1.5]).unwrap(), 1);
    file.write_with_fields(&folder.path("out.msh"), file.points(), &fields).unwrap();
    let expected = GMSH.replace("30 7", "30 8.0").replace("50 4.0 5 6", "50 4.0 5.5 6");
    assert_eq!(folder.text("out.msh"), expected);
    assert!(fields[0].set(vec![0.0; 4]).is_err());
}

/// Many views of one node each, read as fields of all nodes, would take many times the file's memory.
#[test]
fn node_data_of_very_few_nodes_are_no_field() {
    let row = |n: u32| format!("{} {} 7 0\n", n + 100, n);
    let more: String = (0..60).map(row).collect();
    let text = GMSH.replace("$Nodes\n5\n", &format!("$Nodes\n65\n{more}"));
    let folder = Folder::new(&[("in.msh", &text)]);
    let file = folder.read("in.msh");
    assert_eq!(file.data_names(), ["v"]);
    let one = text.replace("3\n5\n0\n10 1 2 3\n", "3\n1\n0\n10 1 2 3\n");
    let folder = Folder::new(&[("in.msh", &one)]);
    assert!(folder.read("in.msh").data_names().is_empty());
}

#[test]
fn data_that_are_not_real_numbers_are_refused_by_name() {
    let vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nCELLS 1 4\n\
               3 0 1 2\nCELL_TYPES 1\n5\nPOINT_DATA 3\nSCALARS n int\nLOOKUP_TABLE default\n1 2 3\nSCALARS depth double\n\
               LOOKUP_TABLE default\n1 nan 3\n";
    let folder = Folder::new(&[("in.vtk", vtk), ("cut.vtk", &vtk[..vtk.len() - 7])]);
    let file = folder.read("in.vtk");
    let refused = |file: &MeshFile, name: &str| {
        file.point_fields(Some(&[name.to_owned()])).unwrap_err().to_string()
    };
    assert!(refused(&file, "n").contains("'n' holds whole numbers"));
    let unknown = refused(&file, "deep");
    assert!(unknown.contains("no point data is called 'deep'. There are depth, z"), "{unknown}");
    assert!(refused(&folder.read("cut.vtk"), "depth").contains("'depth' is damaged or cut off"));
    let depth = file.point_fields(Some(&["depth".into()])).unwrap();
    assert!(depth[0].values()[1].is_nan() && depth[0].values()[2] == 3.0);
    assert_eq!(file.point_array("n").unwrap(), [1.0, 2.0, 3.0]);
}

#[test]
fn attributes_of_triangle_are_data() {
    let node = "4 2 2 1\n1 0 0 5 6.50 1\n2 1 0 5 7 1\n3 0 1 5 8 1 # eight\n4 .2 .2 5 9 0\n";
    let folder = Folder::new(&[("in.node", node), ("in.ele", "3 3\n1 1 2 4\n2 2 3 4\n3 3 1 4\n")]);
    let file = folder.read("in.node");
    assert_eq!(file.data_names(), ["attribute1", "attribute2"]);
    let mut fields = file.point_fields(None).unwrap();
    assert_eq!(fields[1].values(), [6.5, 7.0, 8.0, 9.0]);
    fields[1].set(vec![6.5, 7.0, -1.0, 10.0]).unwrap();
    file.write_with_fields(&folder.path("out.node"), file.points(), &fields).unwrap();
    let expected = node.replace("5 8 1", "5 -1.0 1").replace("5 9 0", "5 10.0 0");
    assert_eq!(folder.text("out.node"), expected);
}

#[test]
fn third_coordinates_of_triangle_are_data_before_the_attributes() {
    let node = "4 3 1 1\n0 0 7 .50 5 1\n1 1 7 2e0 5 1\n2 0 7 3 5 1 # up\n3 .2 7 .2 5 0\n";
    let folder = Folder::new(&[("in.node", node), ("in.ele", "3 3\n0 0 1 3\n1 1 2 3\n2 2 0 3\n")]);
    let file = folder.read("in.node");
    assert!(file.has_third_coordinates());
    assert_eq!(file.points()[3], [0.2, 7.0]);
    assert_eq!(file.data_names(), ["z", "attribute"]);
    assert_eq!(file.groups().unwrap().find("1").unwrap().vertices(), [0, 1, 2]);
    let mut fields = file.point_fields(None).unwrap();
    assert_eq!(fields[0].values(), [0.5, 2.0, 3.0, 0.2]);
    assert_eq!(fields[1].values(), [5.0; 4]);
    fields[0].set(vec![0.5, 2.0, -1.0, 0.25]).unwrap();
    let mut points = file.points().to_vec();
    points[3][0] = 0.125;
    file.write_with_fields(&folder.path("out.node"), &points, &fields).unwrap();
    let expected = node.replace("7 3 5", "7 -1.0 5").replace(".2 7 .2", "0.125 7 0.25");
    assert_eq!(folder.text("out.node"), expected);
    let converted = Conversion::new(&file, Format::Obj).unwrap().unwrap().text().unwrap();
    assert!(converted.contains("v 0.2 7.0 0.2\n"), "{converted}");
}

/// Every variable of SELAFIN is read and replaced in every time step, in both byte orders.
#[test]
fn variables_of_selafin_are_data_in_every_step() {
    let tried = AtomicUsize::new(0);
    for_each(&base(), |made| {
        if made.format != Format::Selafin {
            return;
        }
        let file = folder(made, &made.bytes).read(made.name);
        let fields = file.point_fields(None).unwrap();
        assert!(fields.len() >= 2, "{} fields", fields.len());
        tried.fetch_add(1, Ordering::Relaxed);
    });
    assert!(tried.into_inner() > 1);
}

/// Damaged data give an error or other values, never a panic. All readable fields can also be written.
#[test]
fn damaged_data_never_panic() {
    let mut random = damage::random(31);
    let raw = styles().into_iter().filter(|style| style.precision == Precision::Single).step_by(5);
    let mut samples: Vec<(&str, Vec<u8>)> = vec![("in.msh", GMSH.into())];
    samples.extend(raw.map(|style| ("in.vtu", vtu::write(&base(), style))));
    let mut read = 0;
    for round in 0..400 {
        let (name, bytes) = &samples[round % samples.len()];
        let folder = Folder::new(&[]);
        fs::write(folder.path(name), damage::damaged(bytes, &mut random)).unwrap();
        let Ok(file) = MeshFile::read(&folder.path(name)) else { continue };
        let Ok(mut fields) = file.point_fields(None) else { continue };
        for field in &mut fields {
            let values = field.values().iter().map(|value| value + 0.5).collect();
            field.set(values).unwrap();
        }
        let mut out = Vec::new();
        file.write_to_with_fields("out".as_ref(), &mut out, file.points(), &fields).unwrap();
        read += 1;
    }
    assert!(read > 40, "{read} of 400 files were read");
}

/// Once, grids with a vertex without depth were refused, and PLY files with NaN in further properties.
#[test]
fn depths_and_other_numbers_need_not_be_finite() {
    // A square and its center, where `z` is the depth of the center.
    let square = ["0 0", "4 0", "4 4", "0 4"];
    let row = |before: &str, z: &str| -> String {
        let corner = |at: &&str| format!("{before}{at} 1\n");
        square.iter().map(corner).collect::<String>() + &format!("{before}1 2 {z}\n")
    };
    let numbered = |before: &str, z: &str| -> String {
        let row = |(n, at): (usize, String)| format!("{before}{} {at}\n", n + 1);
        row_ends(&square, z).into_iter().enumerate().map(row).collect()
    };
    fn row_ends(square: &[&str], z: &str) -> Vec<String> {
        let corners = square.iter().map(|at| format!("{at} 1"));
        corners.chain([format!("1 2 {z}")]).collect()
    }
    let from = |first: usize, lead: &str, numbers: bool| -> String {
        let triangle = |k: usize| {
            let number = if numbers { format!("{} ", k + 1) } else { String::new() };
            let corners = [k, (k + 1) % 4, 4].map(|v| (v + first).to_string());
            format!("{}{}\n", lead.replace("N ", &number), corners.join(" "))
        };
        (0..4).map(triangle).collect()
    };
    for z in ["NaN", "-nan", "inf"] {
        let grid = format!("a grid\n4 5\n{}{}", numbered("", z), from(1, "N 3 ", true));
        let sms = format!("MESH2D\n{}{}", numbered("ND ", z), from(1, "E3T N ", true));
        let obj = format!("{}{}", row("v ", z), from(1, "f ", false));
        let off = format!("OFF\n5 4 0\n{}{}", row("", z), from(0, "3 ", false));
        let gmsh = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{}$EndNodes\n$Elements\n4\n{}$EndElements\n",
            numbered("", z),
            from(1, "N 2 0 ", true)
        );
        let head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty float quality\n";
        let ply = format!(
            "{head}element face 4\nproperty list uchar int vertex_indices\nend_header\n{}{}",
            row("", z),
            from(0, "3 ", false)
        );
        let files = [
            ("a.gr3", grid),
            ("a.2dm", sms),
            ("a.obj", obj),
            ("a.off", off),
            ("a.msh", gmsh),
            ("a.ply", ply),
        ];
        for (name, text) in files {
            let folder = Folder::new(&[(name, &text)]);
            let file = folder.read(name);
            let out = folder.path(&format!("out-{name}"));
            file.write(&out, file.points()).unwrap();
            assert_eq!(fs::read_to_string(&out).unwrap(), text, "{name}");
            let [field] = &file.point_fields(None).unwrap()[..] else { panic!("{name}") };
            assert_eq!(field.values()[..4], [1.0; 4], "{name}");
            assert!(!field.values()[4].is_finite(), "{name}");
            for (_, target) in Conversion::targets() {
                let converted = Conversion::new(&file, target).unwrap().unwrap();
                let Some(text) = converted.text() else { continue };
                MeshFile::from_bytes("converted".as_ref(), text.into_bytes()).unwrap();
            }
            // A vertex that moves keeps its data.
            let mut points = file.points().to_vec();
            points[4] = [2.0, 2.0];
            file.write(&out, &points).unwrap();
            let moved = fs::read_to_string(&out).unwrap();
            assert!(moved.contains(&format!("2 {z}\n")), "{name}: {moved}");
        }
    }
    let wrong = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty int n\nend_header\n0 0 nan\n";
    let folder = Folder::new(&[("b.ply", wrong)]);
    let error = MeshFile::read(&folder.path("b.ply")).unwrap_err().to_string();
    assert!(error.contains("b.ply:8: an integer of an item is not finite"), "{error}");
}

/// Real numbers are checked even if integers of an equal name come before them.
#[test]
fn damaged_data_of_a_name_that_is_there_twice_are_errors() {
    let head = "<Xdmf Version=\"3.0\"><Domain><Grid><Geometry Type=\"XY\"><DataItem Dimensions=\"4 2\">\
        0 0 1 0 1 1 0 1</DataItem></Geometry><Topology Type=\"Triangle\"><DataItem NumberType=\"Int\">\
        0 1 2 0 2 3</DataItem></Topology>";
    let data = |kind: &str, numbers: &str| {
        format!(
            "<Attribute Name=\"T\" Center=\"Node\"><DataItem NumberType=\"{kind}\" Dimensions=\"4\">\
             {numbers}</DataItem></Attribute>"
        )
    };
    let fields = |real: &str| {
        let text = [head, &data("Int", "1 2 3 4"), &data("Float", real), "</Grid></Domain></Xdmf>"];
        let file = MeshFile::from_bytes("in.xdmf".as_ref(), text.concat().into()).unwrap();
        file.point_fields(None).map(|fields| fields.len()).map_err(|error| error.to_string())
    };
    assert_eq!(fields("1 2 3 4"), Ok(1));
    let error = fields("1 2 3").unwrap_err();
    assert!(error.contains("'T' has 3 numbers, 1 per vertex"), "{error}");
}

/// In the header of a PLY, comments are rows of their own, so that names may have number signs.
#[test]
fn number_signs_of_a_ply_belong_to_names() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty float u#1\n\
                property float #2\nelement face 2\nproperty list uchar int vertex_indices\nproperty int f#1\n\
                end_header\n0 0 1 5\n1 0 2 6\n1 1 3 7\n0 1 4 8\n3 0 1 2 9\n3 0 2 3 10\n";
    let folder = Folder::new(&[("a.ply", text)]);
    let content = folder.read("a.ply").content().unwrap();
    let names: Vec<_> = content.point_data().iter().map(mesh_io::DataArray::name).collect();
    assert_eq!(names, ["u#1", "#2"]);
    assert_eq!(content.cell_data()[0].name(), "f#1");
}
