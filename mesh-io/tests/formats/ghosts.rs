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
