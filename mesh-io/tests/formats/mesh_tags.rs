//! XDMF files with mesh tags, in the layout of DOLFINx. Grids of mesh tags refer to the Geometry of the mesh.

use super::Folder;
use mesh_io::{CellKind, Conversion, Format, MeshFile};

/// A square of four triangles around the vertex 4, with two tagged lines, and with tags of three triangles in another
/// order and with other first corners.
const TAGGED: &str = r#"<?xml version="1.0"?>
<Xdmf Version="3.0" xmlns:xi="https://www.w3.org/2001/XInclude">
<Domain>
<Grid Name="mesh" GridType="Uniform">
<Topology TopologyType="Triangle" NumberOfElements="4" NodesPerElement="3">
<DataItem Dimensions="4 3" NumberType="Int" Format="XML">0 1 4  1 2 4  2 3 4  3 0 4</DataItem>
</Topology>
<Geometry GeometryType="XY"><DataItem Dimensions="5 2" Format="XML" Precision="8">0 0 1 0 1 1 0 1 .4 .5</DataItem></Geometry>
</Grid>
<Grid Name="cells" GridType="Uniform">
<xi:include xpointer="xpointer(/Xdmf/Domain/Grid/Geometry)" />
<Topology TopologyType="Triangle" NumberOfElements="3" NodesPerElement="3">
<DataItem Dimensions="3 3" NumberType="Int" Format="XML">2 4 1  4 0 1  3 4 2</DataItem>
</Topology>
<Attribute Name="cells" AttributeType="Scalar" Center="Cell"><DataItem Dimensions="3 1" Format="XML">7 0 7</DataItem></Attribute>
</Grid>
<Grid Name="facets" GridType="Uniform">
<xi:include xpointer="xpointer(/Xdmf/Domain/Grid/Geometry)" />
<Topology TopologyType="PolyLine" NumberOfElements="2" NodesPerElement="2">
<DataItem Dimensions="2 2" NumberType="Int" Format="XML">0 1  2 3</DataItem>
</Topology>
<Attribute Name="facets" AttributeType="Scalar" Center="Cell"><DataItem Dimensions="2 1" Format="XML">5 6</DataItem></Attribute>
</Grid>
</Domain>
</Xdmf>
"#;

fn read(text: &str) -> Result<MeshFile, mesh_io::ReadError> {
    let folder = Folder::new(&[("in.xdmf", text)]);
    MeshFile::read(&folder.path("in.xdmf"))
}

#[test]
fn mesh_tags_are_groups_of_the_triangles_and_lines_of_the_mesh() {
    let file = read(TAGGED).unwrap();
    assert_eq!(file.triangles(), [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    // The triangle without a tag is in a region of its own.
    assert_eq!(file.regions().unwrap(), [0, 1, 1, 2]);
    let groups = file.groups().unwrap();
    let told: Vec<_> = groups
        .iter()
        .map(|group| (&*group.kind, group.tag, group.dimension, group.triangles(), group.lines))
        .collect();
    assert_eq!(
        told,
        [
            ("cells", Some(0), 2, &[0][..], 0),
            ("cells", Some(7), 2, &[1, 2], 0),
            ("facets", Some(5), 1, &[], 1),
            ("facets", Some(6), 1, &[], 1)
        ]
    );
    let content = file.content().unwrap();
    let lines: Vec<_> = content
        .cells()
        .filter(|cell| cell.kind == CellKind::Line)
        .map(|cell| (cell.vertices, cell.groups().map(|group| group.tag()).collect::<Vec<_>>()))
        .collect();
    assert_eq!(lines, [(&[0, 1][..], vec![Some(5)]), (&[2, 3][..], vec![Some(6)])]);
}

#[test]
fn damaged_mesh_tags_are_errors_with_place_and_remedy() {
    for (part, other, expected) in [
        ("2 4 1", "2 0 1", "in.xdmf:15: `cells` tags a triangle of the points [2, 0, 1]"),
        (">7 0 7<", ">7 0<", "in.xdmf:15: there are 2 tags for 9 nodes of cells with 3 nodes"),
        (">5 6<", ">5 6 7<", "in.xdmf:22: there are 3 tags for 4 nodes of cells with 2 nodes"),
        (
            "\"facets\" AttributeType=\"Scalar\" Center=\"Cell\"",
            "\"facets\" Center=\"Node\"",
            "in.xdmf:20: this is the second Topology, and not one of mesh tags",
        ),
        ("0 1  2 3", "0 1  2 9", "line 5 has node 9, which Geometry does not list"),
        ("PolyLine", "Quadrilateral", "there are 2 tags for 4 nodes of cells with 4 nodes"),
    ] {
        let error = read(&TAGGED.replacen(part, other, 1)).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// Programs of FEniCS read a grid of triangles alone, with as many columns as the space has dimensions.
#[test]
fn a_conversion_has_one_topology_of_triangles_and_mesh_tags_of_lines() {
    let msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
               $Elements\n4\n1 1 2 7 1 1 2\n2 1 2 8 2 3 4\n3 2 2 5 1 1 2 3\n4 2 2 6 1 1 3 4\n$EndElements\n";
    for (z, kind, columns) in [("0", "XY", 2), ("2.5", "XYZ", 3)] {
        let folder = Folder::new(&[("in.msh", &*msh.replace("1 1 0\n4", &format!("1 1 {z}\n4")))]);
        let file = MeshFile::read(&folder.path("in.msh")).unwrap();
        let conversion = Conversion::new(&file, Format::Xdmf).unwrap().unwrap();
        assert_eq!(conversion.losses(), [""; 0]);
        let text = conversion.text().unwrap();
        let has = |part: &str| assert!(text.contains(part), "no {part} in {text}");
        has(&format!("<Geometry GeometryType=\"{kind}\">"));
        has(&format!("Dimensions=\"4 {columns}\""));
        has("<Topology TopologyType=\"Triangle\" NumberOfElements=\"2\" NodesPerElement=\"3\">");
        has(
            "<Grid Name=\"lines\" GridType=\"Uniform\">\n<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid/Geometry)\"/>",
        );
        has("<Topology TopologyType=\"PolyLine\" NumberOfElements=\"2\" NodesPerElement=\"2\">");
        let back = read(&text).unwrap();
        let told = |file: &MeshFile| -> Vec<_> {
            let groups = file.groups().unwrap();
            let own = |group: &mesh_io::Group| {
                group.tag.map(|tag| (tag, group.lines, group.triangles().to_vec()))
            };
            let mut all: Vec<_> = groups
                .iter()
                .filter(|group| group.kind.contains("physical"))
                .filter_map(own)
                .collect();
            all.sort();
            all
        };
        assert_eq!(told(&back), told(&file));
        assert_eq!(told(&back).len(), 4);
    }
}
