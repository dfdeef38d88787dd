//! Ghosts of partitioned meshes, and pieces in one file.

use super::Folder;
use super::facts::remarks;

/// Two triangles of partition 1 and two of partition 2 around a common vertex.
const GMSH: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 6 1 9\n2 1 0 6\n1\n2\n3\n4\n5\n9\n\
0 0 0\n1 0 0\n1 1 0\n0 1 0\n.4 .5 0\n-1 .5 0\n$EndNodes\n$Elements\n1 5 10 14\n2 1 2 5\n\
10 1 2 5\n11 2 3 5\n12 3 4 5\n13 4 1 5\n14 4 9 1\n$EndElements\n";

fn ghosts(rows: &[&str]) -> String {
    format!("$GhostElements\n{}\n{}\n$EndGhostElements\n", rows.len(), rows.join("\n"))
}

#[test]
fn vertices_of_ghost_elements_of_gmsh_are_constrained() {
    let read = |section: &str| {
        let folder = Folder::new(&[("a.msh", &format!("{GMSH}{section}"))]);
        let file = folder.read("a.msh");
        let mut vertices = file.constraints().vertices.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let mut anchored = file.constraints().anchored.clone();
        anchored.sort_unstable();
        anchored.dedup();
        assert_eq!(vertices, anchored);
        (vertices, remarks(&file))
    };
    let told = |text: &str| vec![text.to_owned()];
    assert_eq!(
        read(&ghosts(&["12 2 1 1", "11 2 1 1"])),
        (vec![1, 2, 3, 4], told("2 ghost elements"))
    );
    assert_eq!(read(&ghosts(&["14 2 2 1 1"])), (vec![0, 3, 5], told("1 ghost element")));
    assert_eq!(read(&ghosts(&[])), (Vec::new(), Vec::new()));
    // A file of all partitions has the ghosts of each, and each vertex once.
    assert_eq!(read(&ghosts(&["12 2 1 1", "13 1 1 2"])), (Vec::new(), Vec::new()));
    let unread = "the list of ghost elements cannot be read, so their vertices are not held";
    assert_eq!(read(&ghosts(&["12 2 x"])), (Vec::new(), told(unread)));
}

#[test]
fn ghost_elements_in_binary_are_those_of_the_text() {
    let int = |number: i32| number.to_le_bytes().to_vec();
    let size = |number: u64| number.to_le_bytes().to_vec();
    let mut file = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec();
    file.extend([1, 4, 1, 4].map(size).concat());
    file.extend([2, 1, 0].map(int).concat());
    file.extend([4, 1, 2, 3, 4].map(size).concat());
    for number in [0.0_f64, 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.] {
        file.extend(number.to_le_bytes());
    }
    file.extend(b"\n$EndNodes\n$Elements\n");
    file.extend([1, 2, 1, 2].map(size).concat());
    file.extend([2, 1, 2].map(int).concat());
    file.extend([2, 1, 1, 2, 3, 2, 1, 3, 4].map(size).concat());
    file.extend(b"\n$EndElements\n$GhostElements\n");
    file.extend([size(1), size(2), int(1), size(2), int(2), int(2)].concat());
    file.extend(b"\n$EndGhostElements\n");
    let folder = Folder::new(&[]);
    folder.put("a.msh", &file);
    let found = folder.read("a.msh");
    assert_eq!(found.constraints().vertices, [0, 2, 3]);
    assert_eq!(remarks(&found), ["1 ghost element"]);
}

fn piece(points: &str, count: usize, data: &str) -> String {
    format!(
        "<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"1\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>\n\
         <Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\
         <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>\
         <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells>\n{data}</Piece>\n"
    )
}

#[test]
fn ghosts_of_vtu_and_common_vertices_of_its_pieces_are_anchored() {
    let read = |pieces: &[String]| {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>\n{}</UnstructuredGrid></VTKFile>\n",
            pieces.concat()
        );
        let folder = Folder::new(&[("a.vtu", &text)]);
        let file = folder.read("a.vtu");
        let mut anchored = file.constraints().anchored.clone();
        anchored.sort_unstable();
        anchored.dedup();
        (file.constraints().vertices.clone(), anchored, remarks(&file))
    };
    let [first, second] = ["0 0 0 1 0 0 0 1 0", "1 0 0 1 1 0 -0.0 1 0 5 5 0"];
    let data = |section: &str, numbers: &str| {
        format!(
            "<{section}><DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">{numbers}</DataArray></{section}>\n"
        )
    };
    // The pieces have two vertices in common.
    let (vertices, anchored, told) = read(&[piece(first, 3, ""), piece(second, 4, "")]);
    assert_eq!((vertices, anchored, told), (Vec::new(), vec![1, 2, 3, 5], Vec::new()));
    // A ghost cell in the second piece, and ghost points in the first.
    let (vertices, anchored, told) = read(&[
        piece(first, 3, &data("PointData", "1 0 2")),
        piece(second, 4, &data("CellData", "1")),
    ]);
    assert_eq!(vertices, [0, 3, 4, 5]);
    assert_eq!(anchored, [0, 1, 2, 3, 4, 5]);
    assert_eq!(told, ["1 ghost point", "1 ghost element"]);
    let (vertices, ..) = read(&[piece(first, 3, &data("CellData", "32"))]);
    assert_eq!(vertices, [0; 0]);
}

/// Returns the constrained vertices, ascending.
fn held(file: &mesh_io::MeshFile) -> Vec<u32> {
    let mut held = file.constraints().vertices.clone();
    held.sort_unstable();
    held
}

/// Two triangles with a common edge, the second of which is a ghost, in formats without a rule for ghosts of their own.
#[test]
fn ghosts_by_cell_data_of_any_format_are_anchored() {
    let points = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    let item = |kind: &str, size: &str, numbers: &str| {
        format!(
            "<DataItem Format=\"XML\" NumberType=\"{kind}\" Precision=\"8\" Dimensions=\"{size}\">{numbers}</DataItem>"
        )
    };
    let xdmf = format!(
        "<Xdmf Version=\"3.0\"><Domain><Grid><Geometry GeometryType=\"XYZ\">{}</Geometry><Topology \
         TopologyType=\"Triangle\" NumberOfElements=\"2\">{}</Topology><Attribute Name=\"vtkGhostType\" \
         AttributeType=\"Scalar\" Center=\"Cell\">{}</Attribute></Grid></Domain></Xdmf>\n",
        item("Float", "4 3", points),
        item("Int", "2 3", "0 1 2 1 3 2"),
        item("Int", "2", "0 1")
    );
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
         property uchar vtkGhostType\nproperty list uchar int vertex_indices\nend_header\n{points}0 3 0 1 2\n1 3 1 3 2\n"
    );
    for (name, text) in [("a.xdmf", &xdmf), ("a.ply", &ply)] {
        let folder = Folder::new(&[(name, text)]);
        let file = folder.read(name);
        assert_eq!(held(&file), [1, 2, 3], "{name}");
        assert_eq!(remarks(&file), ["1 ghost element"], "{name}");
    }
}

/// meshio names the types of whole numbers in binary files of VTK like `vtktypeuint8`.
#[test]
fn whole_numbers_of_every_size_in_a_vtk_of_meshio_are_read() {
    for (kind, size) in
        [("int8", 1), ("uint8", 1), ("int16", 2), ("uint16", 2), ("int32", 4), ("uint64", 8)]
    {
        let mut bytes = b"# vtk DataFile Version 5.1\nmesh\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n".to_vec();
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        bytes.extend(points.iter().flatten().flat_map(|x: &f64| x.to_be_bytes()));
        bytes.extend(b"\nCELLS 3 6\nOFFSETS vtktypeint64\n");
        bytes.extend([0_i64, 3, 6].iter().flat_map(|n| n.to_be_bytes()));
        bytes.extend(b"\nCONNECTIVITY vtktypeint64\n");
        bytes.extend([0_i64, 1, 2, 1, 3, 2].iter().flat_map(|n| n.to_be_bytes()));
        bytes.extend(b"\nCELL_TYPES 2\n");
        bytes.extend([5_i32, 5].iter().flat_map(|n| n.to_be_bytes()));
        bytes.extend(b"\nCELL_DATA 2\nFIELD FieldData 2\n");
        for (name, numbers) in [("vtkGhostType", [0_u64, 1]), ("region", [7, 8])] {
            bytes.extend(format!("{name} 1 2 vtktype{kind}\n").bytes());
            bytes.extend(numbers.iter().flat_map(|n| n.to_be_bytes()[8 - size..].to_vec()));
            bytes.push(b'\n');
        }
        let folder = Folder::new(&[]);
        std::fs::write(folder.path("a.vtk"), bytes).unwrap();
        let file = folder.read("a.vtk");
        assert_eq!(held(&file), [1, 2, 3], "{kind}");
        assert_eq!(file.regions(), Some(&[0, 1][..]), "{kind}");
        let groups = file.groups().unwrap();
        assert_eq!(groups.find("8").unwrap().triangles(), [1], "{kind}");
    }
}
