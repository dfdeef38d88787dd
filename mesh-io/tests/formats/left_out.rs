//! Contents of single formats that conversions keep, or list as losses.

use super::Folder;
use super::made::netcdf::{Attribute, NetCdf};
use mesh_io::{Conversion, Format, MeshFile, Precision};
use std::path::Path;

fn conversion(name: &str, bytes: impl Into<Vec<u8>>, to: Format) -> Conversion {
    let file = MeshFile::from_bytes(Path::new(name), bytes.into()).unwrap();
    Conversion::new(&file, to).unwrap().unwrap()
}

/// Requires that a conversion to VTU lists exactly the losses `expected`, joined by semicolons.
fn assert_lost(name: &str, bytes: impl Into<Vec<u8>>, expected: &str) {
    let losses = conversion(name, bytes, Format::Vtu).losses().join("; ");
    assert_eq!(losses, expected);
}

/// A former defect: a MIKE mesh in degrees became one in local coordinates.
#[test]
fn the_projection_of_mike_is_kept_or_listed() {
    let mesh =
        |head: &str| format!("{head}\n1 4 55 0 1\n2 5 55 0 1\n3 4 56 0 1\n1 3 21\n1 1 2 3\n");
    let projection = "PROJCS[\"WGS 84 / UTM zone 32N\",UNIT[\"Meter\",1]]";
    for (head, projection) in [
        ("3 LONG/LAT", "LONG/LAT"),
        ("100079 1000 3 NON-UTM", "NON-UTM"),
        (&format!("100079 1000 3 {projection}"), projection),
    ] {
        let own = conversion("a.mesh", mesh(head), Format::Mike);
        assert_eq!(own.losses(), [""; 0]);
        let text = own.text().unwrap();
        assert_eq!(text.lines().next(), Some(&*format!("100079  1000  3  {projection}")));
    }
    assert_lost("a.mesh", mesh("3 LONG/LAT"), "the projection LONG/LAT");
    assert_lost("a.mesh", mesh("3 NON-UTM"), "");
}

const POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n";

#[test]
fn colors_and_weights_of_obj_are_listed() {
    let mesh = |more: &str| format!("v 0 0 0{more}\nv 1 0 0{more}\nv 0 1 0{more}\nf 1 2 3\n");
    assert_lost("a.obj", mesh(""), "");
    assert_lost("a.obj", mesh(" # plain"), "");
    assert_lost("a.obj", mesh(" .1 .2 .3"), "colors of vertices");
    assert_lost("a.obj", mesh(" 2"), "weights of vertices");
}

#[test]
fn colors_of_off_are_listed() {
    let faces = |more: &str| format!("OFF\n3 1 0\n{POINTS}3 0 1 2{more}\n");
    assert_lost("a.off", faces(""), "");
    assert_lost("a.off", faces(" # red"), "");
    assert_lost("a.off", faces(" .1 .2 .3"), "colors of faces");
    let vertices = format!("OFF\n3 1 0\n{}3 0 1 2\n", POINTS.replace('\n', " 9 9 9\n"));
    assert_lost("a.off", vertices, "normals, colors or texture coordinates");
    // Vertices that share a line are no colors.
    assert_lost("a.off", "OFF\n3 1 0\n0 0 0 1 0 0\n0 1 0\n3 0 1 2\n", "");
}

#[test]
fn lists_of_vertices_of_ply_are_listed() {
    let mesh = |property: &str, more: &str| {
        let points = POINTS.replace('\n', &format!("{more}\n"));
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n{property}\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n{points}3 0 1 2\n"
        )
    };
    assert_lost("a.ply", mesh("", ""), "");
    let list = "property list uchar float hist\n";
    assert_lost("a.ply", mesh(list, " 2 1 1"), "lists of numbers of vertices");
}

#[test]
fn sets_of_attributes_of_mfem_are_listed() {
    let mesh = |sets: &str| {
        format!(
            "MFEM mesh v1.3\n\ndimension\n2\n\nelements\n1\n1 2 0 1 2\n\n{sets}boundary\n0\n\nvertices\n3\n2\n0 0\n1 0\n0 1\n"
        )
    };
    assert_lost("a.mesh", mesh(""), "");
    let sets = mesh("attribute_sets\n1\n\"all\" 1 1\n\n");
    assert_lost("a.mesh", sets, "the section attribute_sets");
}

#[test]
fn further_materials_of_2dm_are_listed() {
    let mesh =
        |more: &str| format!("MESH2D\nE3T 1 1 2 3 7{more}\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\n");
    assert_lost("a.2dm", mesh(""), "");
    assert_lost("a.2dm", mesh(" 0.5"), "further materials or values of elements");
}

#[test]
fn further_properties_of_exodus_are_listed() {
    let mesh = |properties: usize| {
        let mut file = NetCdf::new(1);
        for (name, numbers) in [("coordx", [0., 1., 0.]), ("coordy", [0., 0., 1.])] {
            file.reals(name, Precision::Double, &["num_nodes"], &numbers);
        }
        file.ints("connect1", &["num_el_in_blk1", "num_nod_per_el1"], &[1, 2, 3]);
        file.attribute("elem_type", Attribute::Text("TRI3"));
        (1..=properties)
            .for_each(|number| file.ints(&format!("eb_prop{number}"), &["num_el_blk"], &[5]));
        let lengths =
            [("num_nodes", 3), ("num_el_in_blk1", 1), ("num_nod_per_el1", 3), ("num_el_blk", 1)];
        file.build(&lengths, 0).bytes
    };
    assert_lost("a.exo", mesh(1), "");
    assert_lost("a.exo", mesh(2), "further properties of blocks and sets");
}

const GMSH: &str =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";

#[test]
fn partitions_of_gmsh_are_listed() {
    let mesh = |tags: &str| format!("{GMSH}$Elements\n1\n1 2 {tags} 1 2 3\n$EndElements\n");
    for tags in ["0", "2 0 0", "3 0 0 0"] {
        assert_lost("a.msh", mesh(tags), "");
    }
    assert_lost("a.msh", mesh("4 0 0 1 2"), "partitions of the mesh");
    let binary = |partition: i32| {
        let ints =
            |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0_f64]];
        let nodes = points.iter().zip(1..).flat_map(|(point, tag)| {
            let bytes = point.iter().flat_map(|x| x.to_le_bytes());
            ints(&[tag]).into_iter().chain(bytes)
        });
        let nodes: Vec<u8> = nodes.collect();
        [
            &b"$MeshFormat\n2.2 1 8\n"[..],
            &ints(&[1]),
            b"\n$EndMeshFormat\n$Nodes\n3\n",
            &nodes,
            b"\n$EndNodes\n$Elements\n1\n",
            &ints(&[2, 1, 4, 1, 0, 0, i32::from(partition > 0), partition, 1, 2, 3]),
            b"\n$EndElements\n",
        ]
        .concat()
    };
    assert_lost("a.msh", binary(0), "");
    assert_lost("a.msh", binary(2), "partitions of the mesh");
    let newer = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n2\n0\n0 0 1 0\n\
        1 2 1 1 1 0 0 0 1 1 0 0 0\n$EndPartitionedEntities\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n\
        $EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n";
    assert_lost("a.msh", newer, "partitions of the mesh");
}

#[test]
fn data_of_gmsh_that_are_not_read_are_listed() {
    let mesh = format!("{GMSH}$Elements\n1\n1 2 0 1 2 3\n$EndElements\n");
    let data = |names: &str, rows: &str| {
        format!("{mesh}$NodeData\n{names}1\n0\n3\n0\n1\n3\n{rows}$EndNodeData\n")
    };
    assert_lost("a.msh", data("1\n\"T\"\n", "1 5\n2 5\n3 6\n"), "");
    let lost = "data without a name, or with damaged tags";
    assert_lost("a.msh", data("0\n", "1 5\n2 5\n3 6\n"), lost);
    assert_lost("a.msh", data("1\n\"T\"\n", "1 5\n2 5\n"), "T, whose numbers cannot be read");
}

#[test]
fn fields_and_constraining_elements_of_nastran_are_listed() {
    let mesh = |node: &str, element: &str, more: &str| {
        format!(
            "BEGIN BULK\nGRID,1,,0.,0.,0.{node}\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nCTRIA3,1,1,1,2,3{element}\n{more}ENDDATA\n"
        )
    };
    assert_lost("a.bdf", mesh("", "", ""), "");
    assert_lost("a.bdf", mesh(",0,,0", ",0.,", ""), "");
    let nodes = "systems and constraints of nodes (CD, PS, SEID)";
    assert_lost("a.bdf", mesh(",,123456", "", ""), nodes);
    assert_lost("a.bdf", mesh("", "", "GRDSET,,,,,,,345\n"), nodes);
    let elements = "fields of elements behind their nodes, such as thicknesses and angles";
    assert_lost("a.bdf", mesh("", ",30.", ""), elements);
    assert_lost("a.bdf", mesh("", ",,,,+\n+,,,.1,.1,.1", ""), elements);
    let rigid = "elements that constrain nodes, called RBE2";
    assert_lost("a.bdf", mesh("", "", "RBE2,9,1,123,2,3\n"), rigid);
}

#[test]
fn holes_and_region_points_of_a_poly_are_listed() {
    let node = "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n";
    let lost = |tail: &str| {
        let poly = format!("0 2 0 0\n1 0\n1 1 2\n{tail}");
        let files = [("a.node", node), ("a.ele", "1 3 0\n1 1 2 3\n"), ("a.poly", &poly)];
        let file = Folder::new(&files).read("a.node");
        Conversion::new(&file, Format::Vtu).unwrap().unwrap().losses().join("; ")
    };
    assert_eq!(lost("0\n"), "");
    assert_eq!(lost("0\n0\n"), "");
    assert_eq!(lost("1\n1 .1 .1\n"), "holes of the .poly");
    assert_eq!(lost("0\n1\n1 .2 .2 7 .1\n"), "region points of the .poly");
    let both = "holes of the .poly; region points of the .poly";
    assert_eq!(lost("1\n1 .1 .1\n1\n1 .2 .2 7 .1\n"), both);
    assert_eq!(lost("9\n1 .1 .1\n"), "holes of the .poly");
}

/// A former defect: data of vertices that could not be read were lost without a word.
#[test]
fn data_whose_numbers_cannot_be_read_are_listed() {
    let vtk = |data: &str| {
        format!(
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n\
             CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n{data}"
        )
    };
    let lost = "T, whose numbers cannot be read";
    for (numbers, expected) in [("1 2 3", ""), ("1 none 3", lost)] {
        let of_points =
            format!("POINT_DATA 3\nFIELD f 2\nT 1 3 double\n{numbers}\nU 1 3 int\n1 2 3\n");
        assert_lost("a.vtk", vtk(&of_points), expected);
        let xdmf = format!(
            "<Xdmf><Domain><Grid><Topology TopologyType=\"Triangle\"><DataItem NumberType=\"Int\">0 1 2</DataItem>\
             </Topology><Geometry GeometryType=\"XY\"><DataItem>0 0 1 0 0 1</DataItem></Geometry>\
             <Attribute Name=\"T\" Center=\"Node\"><DataItem>{numbers}</DataItem></Attribute></Grid></Domain></Xdmf>"
        );
        assert_lost("a.xdmf", xdmf, expected);
    }
    let exodus = |shape: &[&'static str]| {
        let mut file = NetCdf::new(1);
        for (name, numbers) in [("coordx", [0., 1., 0.]), ("coordy", [0., 0., 1.])] {
            file.reals(name, Precision::Double, &["num_nodes"], &numbers);
        }
        file.ints("connect1", &["one", "three"], &[1, 2, 3]);
        file.attribute("elem_type", Attribute::Text("TRI3"));
        file.names("name_nod_var", &["one", "len_name"], &["T"]);
        file.names("name_elem_var", &["one", "len_name"], &["e"]);
        file.reals("vals_nod_var1", Precision::Double, shape, &[1., 2., 3.]);
        let (of_block, numbers): (&'static str, &[f64]) =
            if shape.len() > 1 { ("three", &[1., 2., 3.]) } else { ("one", &[1.]) };
        file.reals("vals_elem_var1eb1", Precision::Double, &[of_block], numbers);
        let lengths = [("num_nodes", 3), ("one", 1), ("three", 3), ("len_name", 16)];
        file.build(&lengths, 0).bytes
    };
    assert_lost("a.exo", exodus(&["num_nodes"]), "");
    let lost = "T, whose numbers cannot be read; e, whose numbers cannot be read";
    assert_lost("a.exo", exodus(&["one", "num_nodes"]), lost);
}

/// Surfaces become lines of element sides. Abaqus also has surfaces of nodes and of faces.
#[test]
fn surfaces_of_nodes_and_faces_of_abaqus_are_listed() {
    let deck = |kind: &str, surface: &str| {
        format!(
            "*NODE, NSET=all\n1, 0., 0.\n2, 1., 0.\n3, 0., 1.\n*ELEMENT, TYPE={kind}, ELSET=own\n1, 1, 2, 3\n\
             *SURFACE, NAME=s#1{surface}\n"
        )
    };
    let lost = "nodes or faces of the surface s#1";
    for (kind, surface, expected) in [
        ("CPS3", "\n1, S1", ""),
        ("CPS3", ", TYPE=ELEMENT\nown, S2", ""),
        ("CPS3", ", TYPE=NODE\nall, 1.", lost),
        ("CPS3", "\nown,", lost),
        ("S3", "\nown, SPOS", lost),
        ("S3", "\nown, S1", lost),
        ("S3", "\nown, E1", ""),
    ] {
        let file = MeshFile::from_bytes(Path::new("a.inp"), deck(kind, surface).into()).unwrap();
        let losses = Conversion::new(&file, Format::Abaqus).unwrap().unwrap().losses().join("; ");
        assert_eq!(losses, expected, "{kind}{surface}");
    }
}

/// Sides 1 and 2 of a shell are its faces, which no other format has.
#[test]
fn faces_of_shells_in_side_sets_of_exodus_are_listed() {
    let exodus = |side: i32| {
        let mut file = NetCdf::new(1);
        for (name, numbers) in [("coordx", [0., 1., 0.]), ("coordy", [0., 0., 1.])] {
            file.reals(name, Precision::Double, &["num_nodes"], &numbers);
        }
        file.ints("connect1", &["one", "three"], &[1, 2, 3]);
        file.attribute("elem_type", Attribute::Text("SHELL3"));
        file.ints("elem_ss1", &["one"], &[1]);
        file.ints("side_ss1", &["one"], &[side]);
        file.build(&[("num_nodes", 3), ("one", 1), ("three", 3)], 0).bytes
    };
    assert_lost("a.exo", exodus(3), "");
    assert_lost("a.exo", exodus(2), "sides of side sets that are no edges");
}
