//! Small files of each format with groups. Each mesh is a square of four triangles around a fifth vertex. Triangles 0
//! and 1 form one region, triangles 2 and 3 another.

use support::Binary;

pub(crate) const GMSH22: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"the shore\"\n2 1 \"sea # deep\"\n\
2 9 \"empty\"\n$EndPhysicalNames\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n50 .5 .5 0\n$EndNodes\n$Elements\n6\n\
1 1 2 1 7 10 20\n2 15 2 0 3 40\n3 2 2 1 7 10 20 50\n4 2 2 1 7 20 30 50\n5 2 3 2 8 1 30 40 50\n6 2 2 2 8 40 10 50\n\
$EndElements\n";

const NODES41: &str = "$Nodes\n1 5 1 5\n2 7 0 5\n10\n20\n30\n40\n50\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .5 0\n$EndNodes\n";
const ELEMENTS41: &str = "$Elements\n4 6 1 6\n1 7 1 1\n1 10 20\n0 3 15 1\n2 40\n2 7 2 2\n3 10 20 50\n4 20 30 50\n\
2 8 2 2\n5 30 40 50\n6 40 10 50\n$EndElements\n";

pub(crate) fn gmsh41() -> String {
    let entities = "$Entities\n1 1 2 0\n3 0 1 0 0 \n7 0 0 0 1 0 0 1 -1 2 3 -4 \n7 0 0 0 1 1 0 2 1 2 1 7 \n\
                    8 0 0 0 1 1 0 1 2 0 \n$EndEntities\n";
    let names = "$PhysicalNames\n2\n1 1 \"the shore\"\n2 1 \"sea # deep\"\n$EndPhysicalNames\n";
    format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}{entities}{NODES41}{ELEMENTS41}")
}

/// Returns a partitioned mesh: entities 7 and 8 are parts of surface 1, curve 7 is a part of curve 2, and point 3 is
/// new.
pub(crate) fn gmsh41_partitioned() -> String {
    let entities = "$Entities\n0 1 1 0\n2 0 0 0 1 0 0 1 5 0\n1 0 0 0 1 1 0 1 6 0\n$EndEntities\n";
    let parts = "$PartitionedEntities\n2\n1\n90 1\n1 1 2 0\n3 2 1 2 1 2 0 1 0 0\n7 1 2 1 1 0 0 0 1 0 0 1 5 0\n\
                 7 2 1 1 1 0 0 0 1 1 0 1 6 0\n8 2 1 1 2 0 0 0 1 1 0 1 6 0\n$EndPartitionedEntities\n";
    format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{entities}{parts}{NODES41}{ELEMENTS41}")
}

pub(crate) const GMSH40: &str = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n0 1 1 0\n7 0 0 0 1 0 0 1 1 0\n\
8 0 0 0 1 1 0 1 2 0\n$EndEntities\n$Nodes\n1 5\n7 2 0 5\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n50 .5 .5 0\n$EndNodes\n\
$Elements\n2 5\n7 1 1 1\n1 10 20\n8 2 2 4\n3 10 20 50\n4 20 30 50\n5 30 40 50\n6 40 10 50\n$EndElements\n";

pub(crate) fn gmsh41_binary(big: bool) -> Vec<u8> {
    let mut file = Binary::new("4.1", big);
    file.text("$PhysicalNames\n1\n1 1 \"the shore\"\n$EndPhysicalNames\n$Entities\n");
    file.sizes(&[1, 1, 2, 0]);
    file.ints(&[3]);
    file.doubles(&[0.0; 3]);
    file.sizes(&[0]);
    let mut entity = |tag: i32, physical: &[i32], bounds: &[i32]| {
        file.ints(&[tag]);
        file.doubles(&[0.0; 6]);
        file.sizes(&[physical.len() as u64]);
        file.ints(physical);
        file.sizes(&[bounds.len() as u64]);
        file.ints(bounds);
    };
    entity(7, &[-1], &[3, -4]);
    entity(7, &[1, 2], &[7]);
    entity(8, &[2], &[]);
    file.text("\n$EndEntities\n$Nodes\n");
    file.sizes(&[1, 5, 1, 5]);
    file.ints(&[2, 7, 0]);
    file.sizes(&[5, 10, 20, 30, 40, 50]);
    file.doubles(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0.5, 0.5, 0.]);
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[4, 6, 1, 6]);
    for (header, rows) in [
        ([1, 7, 1], vec![1, 10, 20]),
        ([0, 3, 15], vec![2, 40]),
        ([2, 7, 2], vec![3, 10, 20, 50, 4, 20, 30, 50]),
        ([2, 8, 2], vec![5, 30, 40, 50, 6, 40, 10, 50]),
    ] {
        file.ints(&header);
        file.sizes(&[if header[0] == 2 { 2 } else { 1 }]);
        file.sizes(&rows);
    }
    file.text("\n$EndElements\n");
    file.bytes
}

pub(crate) const SU2: &str = "NDIME= 2\nNELEM= 4\n5 0 1 4\n5 1 2 4\n5 2 3 4\n5 3 0 4\nNPOIN= 5\n0 0\n1 0\n1 1\n0 1\n.5 .5\n\
NMARK= 2\nMARKER_TAG= shore\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\nSEND_RECV= 0\nMARKER_TAG= corner % one\nMARKER_ELEMS= 1\n1 3\n";

pub(crate) const MEDIT: &str = "MeshVersionFormatted 2\nDimension 2\nVertices\n5\n0 0 3\n1 0 3\n1 1 0\n0 1 0\n.5 .5 0\n\
Corners\n2\n1\n2\nEdges\n1\n1 2 3\nTriangles\n4\n1 2 5 0\n2 3 5 0\n3 4 5 -3\n4 1 5 -3\nRequiredVertices\n1\n5\nEnd\n";

/// Returns a binary Medit mesh. `last` holds the keyword and the single number of the last list.
pub(crate) fn meditb(last: [i32; 2]) -> Vec<u8> {
    let mut file = Binary::empty(false);
    // Each list has a header with its keyword, the offset of the next list, and its length.
    file.ints(&[1, 2, 3, 20, 2]);
    let mut list = |keyword: i32, count: usize, body: &dyn Fn(&mut Binary)| {
        let mut content = Binary::empty(false);
        body(&mut content);
        let next = file.bytes.len() + 12 + content.bytes.len();
        file.ints(&[keyword, next as i32, count as i32]);
        file.bytes.extend(content.bytes);
    };
    list(4, 5, &|file| {
        for (at, reference) in
            [([0., 0.], 3), ([1., 0.], 3), ([1., 1.], 0), ([0., 1.], 0), ([0.5; 2], 0)]
        {
            file.doubles(&at);
            file.ints(&[reference]);
        }
    });
    list(13, 2, &|file| file.ints(&[1, 2]));
    list(5, 1, &|file| file.ints(&[1, 2, 3]));
    list(6, 4, &|file| file.ints(&[1, 2, 5, 0, 2, 3, 5, 0, 3, 4, 5, -3, 4, 1, 5, -3]));
    list(last[0], 1, &|file| file.ints(&last[1..]));
    file.ints(&[54, 0]);
    file.bytes
}

pub(crate) const FREEFEM: &str =
    "5 4 1\n0 0 3\n1 0 3\n1 1 0\n0 1 0\n.5 .5 0\n1 2 5 0\n2 3 5 0\n3 4 5 -3\n4 1 5 -3\n1 2 3\n";

pub(crate) const SMS: &str = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\nND 5 .5 .5 0\nE3T 1 1 2 5 1\nE3T 2 2 3 5 1\n\
E3T 3 3 4 5 2\nE3T 4 4 1 5 2\nNS 1 2\nNS -3 \"the weir\"\nNS 4 -1\nMAT 2 \"mud\"\nMAT 1\n";

pub(crate) const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 0\no a plate\nusemtl steel\ng left wet\nf 1 2 5\nf 2 3 5\n\
l 1 2\nusemtl tin\ng\nf 3 4 5\nf 4 1 5\n";

pub(crate) const VTK: &str = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n\
0 0 0 1 0 0 1 1 0 0 1 0 .5 .5 0\nCELLS 5 19\n2 0 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\nCELL_TYPES 5\n3 5 5 5 5\n\
POINT_DATA 5\nSCALARS hold int 1\nLOOKUP_TABLE default\n0 0 0 0 1\nVECTORS v float\n1 2 3 1 2 3 1 2 3 1 2 3 1 2 3\n\
FIELD more 1\nweight 1 5 float\n1 2 3 4 5.5\nCELL_DATA 5\nSCALARS MaterialIDs float\nLOOKUP_TABLE default\n4 1.5 1.5 -2 -2\n";

pub(crate) fn vtk_binary() -> Vec<u8> {
    let mut file = Binary::empty(true);
    file.text("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 5 double\n");
    file.doubles(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0.5, 0.5, 0.]);
    file.text("\nPOLYGONS 4 16\n");
    file.ints(&[3, 0, 1, 4, 3, 1, 2, 4, 3, 2, 3, 4, 3, 3, 0, 4]);
    file.text("\nCELL_DATA 4\nSCALARS material unsigned_char 1\nLOOKUP_TABLE default\n");
    file.bytes.extend([200, 200, 1, 1]);
    file.text("\nPOINT_DATA 5\nSCALARS hold unsigned_short 1\nLOOKUP_TABLE default\n");
    file.bytes.extend([0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff]);
    file.text("\nFIELD more 1\nweight 1 5 float\n");
    file.reals(mesh_io::Precision::Single, &[1., 2., 3., 4., 5.5]);
    file.text("\n");
    file.bytes
}

pub(crate) const VTU: &str = "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
<Piece NumberOfPoints=\"5\" NumberOfCells=\"4\">\n<PointData>\n\
<DataArray type=\"Int8\" Name=\"hold\" format=\"binary\">BQAAAAAAAAD/</DataArray>\n\
<DataArray type=\"Float32\" Name=\"weight\" format=\"ascii\">1 2 3 4 5.5</DataArray>\n\
<DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"2\" format=\"ascii\">1 2 3 4 5 6 7 8 9 0</DataArray>\n\
</PointData>\n<CellData>\n<DataArray type=\"Int32\" Name=\"medit:ref\" format=\"ascii\">7 7 -1 -1</DataArray>\n</CellData>\n\
<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0 .5 .5 0</DataArray></Points>\n\
<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 4 1 2 4 2 3 4 3 0 4</DataArray>\n\
<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray>\n\
<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 5 5 5</DataArray></Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

pub(crate) const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty uchar hold\n\
property float weight\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n\
0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n.5 .5 1 5.5\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

pub(crate) const NODE: &str =
    "5 2 1 1\n0 0 0 7.5 3\n1 1 0 7.5 3\n2 1 1 7.5 0\n3 0 1 7.5 0\n4 .5 .5 7.5 0\n";
pub(crate) const ELE: &str =
    "4 3 2\n0 0 1 4 1 0\n1 1 2 4 1.0 0\n2 2 3 4 2.5 0\n3 3 0 4 2.5 land # dry\n";
pub(crate) const POLY: &str = "0 2 0 1\n2 1\n1 0 1 3\n2 1 2 0\n";
