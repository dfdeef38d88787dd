//! Names in each format: of groups, of vertices by number, and of arrays of point data.

use super::Folder;
use super::facts::{between_regions, fixed, remarks};
use super::grouped::{
    ELE, FREEFEM, GMSH22, GMSH40, MEDIT, NODE, OBJ, PLY, POLY, SMS, SU2, VTK, VTU, gmsh41,
    gmsh41_binary, gmsh41_partitioned, meditb, vtk_binary,
};
use mesh_io::{GroupError, Location, MeshFile, ReadError};
use std::fs;

/// Returns each group as text: its name as a user writes it, its kind, its numbers of points, lines, triangles and
/// quadrilaterals, and its vertices.
fn told(file: &MeshFile) -> Vec<String> {
    let groups = file.groups().unwrap();
    let spellings = groups.unique_names();
    let one = |(group, spelling): (&mesh_io::Group, &String)| {
        assert_eq!(groups.find(spelling), Ok(group));
        let counts =
            [group.points, group.lines, group.triangles().len(), group.quadrilaterals().len()];
        format!("{spelling} = {group}: {counts:?} {:?}", group.vertices())
    };
    groups.iter().zip(&spellings).map(one).collect()
}

#[track_caller]
fn assert_groups(name: &str, bytes: &[u8], expected: &[&str]) {
    let folder = Folder::new(&[]);
    fs::write(folder.path(name), bytes).unwrap();
    assert_eq!(told(&folder.read(name)), expected);
}

#[test]
fn gmsh_has_physical_groups_and_entities() {
    assert_groups(
        "in.msh",
        GMSH22.as_bytes(),
        &[
            "the shore = physical line the shore: [0, 1, 0, 0] [0, 1]",
            "sea # deep = physical surface sea # deep: [0, 0, 2, 0] [0, 1, 2, 4]",
            "2 = physical surface 2: [0, 0, 2, 0] [0, 2, 3, 4]",
            "empty = physical surface empty: [0, 0, 0, 0] []",
            "3 = entity point 3: [1, 0, 0, 0] [3]",
            "line:7 = entity line 7: [0, 1, 0, 0] [0, 1]",
            "surface:7 = entity surface 7: [0, 0, 2, 0] [0, 1, 2, 4]",
            "8 = entity surface 8: [0, 0, 2, 0] [0, 2, 3, 4]",
        ],
    );
    // A name without a dimension, as in version 2.0, belongs to all groups with the tag.
    let old = GMSH22.replace("1 1 \"the", "1 \"the").replace("2 1 \"sea", "5 \"sea");
    let folder = Folder::new(&[("in.msh", &old)]);
    assert_eq!(
        told(&folder.read("in.msh"))[..2],
        [
            "line:the shore = physical line the shore: [0, 1, 0, 0] [0, 1]",
            "surface:the shore = physical surface the shore: [0, 0, 2, 0] [0, 1, 2, 4]"
        ]
    );
}

#[test]
fn gmsh_lists_the_physical_groups_of_entities_from_version_4_on() {
    let entities = [
        "3 = entity point 3: [1, 0, 0, 0] [3]",
        "line:7 = entity line 7: [0, 1, 0, 0] [0, 1]",
        "surface:7 = entity surface 7: [0, 0, 2, 0] [0, 1, 2, 4]",
        "8 = entity surface 8: [0, 0, 2, 0] [0, 2, 3, 4]",
    ];
    // A curve may be in a group with opposite direction, and a surface may be in several groups.
    let physical = [
        "the shore = physical line the shore: [0, 1, 0, 0] [0, 1]",
        "sea # deep = physical surface sea # deep: [0, 0, 2, 0] [0, 1, 2, 4]",
        "2 = physical surface 2: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
    ];
    assert_groups("in.msh", gmsh41().as_bytes(), &[&physical[..], &entities].concat());
    let without_name = "surface:1 = physical surface 1: [0, 0, 2, 0] [0, 1, 2, 4]";
    let physical = [physical[0], without_name, physical[2]];
    for big in [false, true] {
        assert_groups("in.msh", &gmsh41_binary(big), &[&physical[..], &entities].concat());
    }
    assert_groups(
        "in.msh",
        GMSH40.as_bytes(),
        &[
            "1 = physical line 1: [0, 1, 0, 0] [0, 1]",
            "2 = physical surface 2: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
            "7 = entity line 7: [0, 1, 0, 0] [0, 1]",
            "8 = entity surface 8: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
        ],
    );
    assert_groups(
        "in.msh",
        gmsh41_partitioned().as_bytes(),
        &[
            "5 = physical line 5: [0, 1, 0, 0] [0, 1]",
            "6 = physical surface 6: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
            "3 = entity point 3: [1, 0, 0, 0] [3]",
            "2 = entity line 2: [0, 1, 0, 0] [0, 1]",
            "1 = entity surface 1: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
        ],
    );
}

#[test]
fn su2_has_markers_and_zones() {
    let markers = [
        "corner = marker point corner: [1, 0, 0, 0] [3]",
        "shore = marker line shore: [0, 2, 0, 0] [0, 1, 2]",
    ];
    assert_groups("in.su2", SU2.as_bytes(), &markers);
    let zones = format!("NZONE= 2\nIZONE= 1\n{SU2}IZONE= 2\n{}", SU2.replace("shore", "far"));
    assert_groups(
        "in.su2",
        zones.as_bytes(),
        &[
            "1 = zone surface 1: [0, 0, 4, 0] [0, 1, 2, 3, 4]",
            "2 = zone surface 2: [0, 0, 4, 0] [5, 6, 7, 8, 9]",
            "corner = marker point corner: [2, 0, 0, 0] [3, 8]",
            "shore = marker line shore: [0, 2, 0, 0] [0, 1, 2]",
            "far = marker line far: [0, 2, 0, 0] [5, 6, 7]",
        ],
    );
}

#[test]
fn medit_and_freefem_have_references_of_each_kind() {
    let references = |what: &str| {
        [
            format!("point:3 = {what} point 3: [0, 0, 0, 0] [0, 1]"),
            format!("line:3 = {what} line 3: [0, 1, 0, 0] [0, 1]"),
            format!("-3 = {what} surface -3: [0, 0, 2, 0] [0, 2, 3, 4]"),
            format!("0 = {what} surface 0: [0, 0, 2, 0] [0, 1, 2, 4]"),
        ]
    };
    let mut medit = references("reference").to_vec();
    medit.push("Corners = list point Corners: [2, 0, 0, 0] [0, 1]".into());
    medit.push("RequiredVertices = list point RequiredVertices: [1, 0, 0, 0] [4]".into());
    let medit: Vec<_> = medit.iter().map(String::as_str).collect();
    assert_groups("in.mesh", MEDIT.as_bytes(), &medit);
    assert_groups("in.meshb", &meditb([15, 5]), &medit);
    let labels = references("label");
    assert_groups("in.msh", FREEFEM.as_bytes(), &labels.each_ref().map(String::as_str));
}

/// Vertices of required edges and ridges do not slide.
#[test]
fn required_edges_and_ridges_are_groups_whose_vertices_are_anchored() {
    for (name, keyword) in [("RequiredEdges", 16), ("Ridges", 14)] {
        let text = MEDIT.replace("RequiredVertices\n1\n5", &format!("{name}\n3\n1\n9\n1"));
        assert_ne!(text, MEDIT);
        for (path, bytes) in [("in.mesh", text.into_bytes()), ("in.meshb", meditb([keyword, 1]))] {
            let file = MeshFile::from_bytes(path.as_ref(), bytes).unwrap();
            let listed = format!("{name} = list line {name}: [0, 1, 0, 0] [0, 1]");
            assert!(told(&file).contains(&listed), "{:?}", told(&file));
            let reference = "line:3 = reference line 3: [0, 1, 0, 0] [0, 1]".to_owned();
            assert!(told(&file).contains(&reference), "{:?}", told(&file));
            let anchored = &file.constraints().anchored;
            assert!(anchored.ends_with(&[0, 1]) && anchored.len() == 4, "{path}: {anchored:?}");
            assert_eq!(file.constraints().lines, [[0, 1]]);
        }
    }
}

/// Each row of a weir names the node that faces its node on the other bank.
#[test]
fn both_banks_of_a_weir_of_adcirc_are_one_group_and_pairs() {
    let nodes = "1 0 0 1\n2 1 0 1\n3 2 0 1\n4 0 1 1\n5 1 1 1\n6 2 1 1\n7 1 -1 1\n8 1 2 1\n";
    let elements = "1 3 1 7 2\n2 3 2 7 3\n3 3 4 5 8\n4 3 5 6 8\n";
    let rows = "1 4 1.5 1.0 1.0\n2, 5, 1.5, 1.0, 1.0\n3 6 1.5 1.0 1.0\n";
    for kind in [4, 24, 5, 25, 64, 0, 21] {
        let text = format!("weir\n4 8\n{nodes}{elements}0\n0\n2\n5\n3 {kind}\n{rows}2 20\n1\n7\n");
        let file = MeshFile::from_bytes("fort.14".as_ref(), text.into_bytes()).unwrap();
        let groups = file.groups().unwrap();
        let group = groups.iter().find(|group| group.name.as_deref() == Some("land1"));
        let is_weir = kind != 0 && kind != 21;
        assert_eq!(file.constraints().weirs.len(), usize::from(is_weir), "{kind}");
        assert!(file.constraints().periodic.is_empty() && !file.constraints().has_unread_pairs);
        if is_weir {
            assert_eq!(file.constraints().weirs, [[[0, 3], [1, 4], [2, 5]]]);
            let group = group.unwrap();
            assert_eq!((group.vertices(), group.points), (&[0, 1, 2, 3, 4, 5][..], 6));
            assert_eq!(groups.find("land2").unwrap().vertices(), [0, 6]);
            assert_eq!(file.group_ends().unwrap(), [0, 2, 3, 5, 6]);
        }
    }
    // A weir without the node on its other bank.
    let text = format!("weir\n4 8\n{nodes}{elements}0\n0\n2\n5\n3 4\n{rows}3 24\n1 4\n2\n");
    let error = MeshFile::from_bytes("fort.14".as_ref(), text.into_bytes()).unwrap_err();
    assert!(
        error.to_string().starts_with("fort.14:25: the other node of one of the nodes of land")
    );
}

/// Vertices of required triangles stay fixed, as mmg does not change such triangles.
#[test]
fn vertices_of_required_triangles_stay() {
    let text = MEDIT.replace("RequiredVertices\n1\n5", "RequiredTriangles\n2\n3\n3");
    assert_ne!(text, MEDIT);
    for (name, bytes) in [("in.mesh", text.into_bytes()), ("in.meshb", meditb([17, 3]))] {
        let folder = Folder::new(&[]);
        fs::write(folder.path(name), bytes).unwrap();
        let file = folder.read(name);
        let mut fixed = fixed(&file);
        fixed.sort_unstable();
        fixed.dedup();
        assert_eq!(fixed, [0, 1, 2, 3, 4], "{name}");
        assert!(between_regions(&file).is_empty(), "{name}");
        assert_eq!(remarks(&file), ["1 required triangle"]);
        let list = "RequiredTriangles = list surface RequiredTriangles: [0, 0, 0, 0] [2, 3, 4]";
        let told = told(&file);
        assert!(told.contains(&list.to_owned()), "{told:?}");
        let references = "-3 = reference surface -3: [0, 0, 2, 0] [0, 2, 3, 4]";
        assert!(told.contains(&references.to_owned()), "{told:?}");
    }
    // A required triangle that does not exist is not an error.
    let text = MEDIT.replace("RequiredVertices\n1\n5", "RequiredTriangles\n1\n99");
    let folder = Folder::new(&[("in.mesh", &text)]);
    assert_eq!(between_regions(&folder.read("in.mesh")), [4]);
    // A required triangle that does not exist does not hide later entries of the list.
    let text = MEDIT.replace("RequiredVertices\n1\n5", "RequiredTriangles\n2\n0\n3");
    let folder = Folder::new(&[("in.mesh", &text)]);
    let fixed = fixed(&folder.read("in.mesh"));
    assert!([2, 3, 4].iter().all(|vertex| fixed.contains(vertex)), "{fixed:?}");
    assert!(between_regions(&folder.read("in.mesh")).is_empty());
}

#[test]
fn materials_objects_and_node_strings_have_names() {
    assert_groups(
        "in.2dm",
        SMS.as_bytes(),
        &[
            "material:1 = material surface 1: [0, 0, 2, 0] [0, 1, 2, 4]",
            "mud = material surface mud: [0, 0, 2, 0] [0, 2, 3, 4]",
            "the weir = nodestring line the weir: [3, 0, 0, 0] [0, 1, 2]",
            "nodestring:2 = nodestring line 2: [2, 0, 0, 0] [0, 3]",
        ],
    );
    assert_groups(
        "in.obj",
        OBJ.as_bytes(),
        &[
            "steel = material surface steel: [2, 0, 2, 0] [0, 1, 2, 4]",
            "tin = material surface tin: [0, 0, 2, 0] [0, 2, 3, 4]",
            "a plate = object surface a plate: [2, 0, 4, 0] [0, 1, 2, 3, 4]",
            "left = group surface left: [2, 0, 2, 0] [0, 1, 2, 4]",
            "wet = group surface wet: [2, 0, 2, 0] [0, 1, 2, 4]",
        ],
    );
    let pentagon = OBJ.replace("f 4 1 5\n", "f 4 1 5\nf 1 2 3 4 5\n");
    let folder = Folder::new(&[("in.obj", &pentagon)]);
    let tin = "tin = material surface tin: [0, 0, 2, 0] [0, 1, 2, 3, 4]";
    assert_eq!(told(&folder.read("in.obj"))[1], tin);
}

#[test]
fn vtk_has_the_cell_data_that_tell_regions() {
    assert_groups(
        "in.vtk",
        VTK.as_bytes(),
        &[
            "4 = MaterialIDs line 4: [0, 1, 0, 0] [0, 1]",
            "1.5 = MaterialIDs surface 1.5: [0, 0, 2, 0] [0, 1, 2, 4]",
            "-2 = MaterialIDs surface -2: [0, 0, 2, 0] [0, 2, 3, 4]",
        ],
    );
    assert_groups(
        "in.vtk",
        &vtk_binary(),
        &[
            "1 = material surface 1: [0, 0, 2, 0] [0, 2, 3, 4]",
            "200 = material surface 200: [0, 0, 2, 0] [0, 1, 2, 4]",
        ],
    );
    // Unsigned numbers of four bytes, under the name that VTK 9 gives them.
    let bytes = vtk_binary();
    let at = |part: &[u8]| bytes.windows(part.len()).position(|own| own == part).unwrap();
    let (start, end) = (at(b"unsigned_char 1"), at(b"\nPOINT_DATA"));
    let wide = b"vtktypeuint32 1\nLOOKUP_TABLE default\n".to_vec();
    let numbers = [4_000_000_000_u32, 4_000_000_000, 1, 1].map(u32::to_be_bytes).concat();
    assert_groups(
        "in.vtk",
        &[&bytes[..start], &wide, &numbers, &bytes[end..]].concat(),
        &[
            "1 = material surface 1: [0, 0, 2, 0] [0, 2, 3, 4]",
            "4000000000 = material surface 4000000000: [0, 0, 2, 0] [0, 1, 2, 4]",
        ],
    );
    assert_groups(
        "in.vtu",
        VTU.as_bytes(),
        &[
            "-1 = medit:ref surface -1: [0, 0, 2, 0] [0, 2, 3, 4]",
            "7 = medit:ref surface 7: [0, 0, 2, 0] [0, 1, 2, 4]",
        ],
    );
    let folder = Folder::new(&[("in.vtu", VTU)]);
    assert_eq!(folder.read("in.vtu").regions(), Some(&[0, 0, 1, 1][..]));
    assert_groups("in.ply", PLY.as_bytes(), &[]);
}

#[test]
fn triangle_has_attributes_and_markers() {
    let folder = Folder::new(&[("in.node", NODE), ("in.ele", ELE), ("in.poly", POLY)]);
    assert_eq!(
        told(&folder.read("in")),
        [
            "2.5 = attribute1 surface 2.5: [0, 0, 2, 0] [0, 2, 3, 4]",
            "1 = attribute1 surface 1: [0, 0, 2, 0] [0, 1, 2, 4]",
            "land = attribute2 surface land: [0, 0, 1, 0] [0, 3, 4]",
            "0 = attribute2 surface 0: [0, 0, 3, 0] [0, 1, 2, 3, 4]",
            "point:3 = marker point 3: [0, 0, 0, 0] [0, 1]",
            "line:3 = marker line 3: [0, 1, 0, 0] [0, 1]",
        ]
    );
    let plain = Folder::new(&[
        ("in.node", "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"),
        ("in.ele", "1 3 0\n1 1 2 3\n"),
    ]);
    assert!(plain.read("in").groups().unwrap().is_empty());
    assert!(folder.read("in").may_name_lines() && !plain.read("in").may_name_lines());
}

#[test]
fn triangles_of_a_group_are_those_of_the_mesh() {
    let folder = Folder::new(&[("in.msh", &gmsh41())]);
    let groups = folder.read("in.msh").groups().unwrap();
    assert_eq!(groups.find("physical:2").unwrap().triangles(), [0, 1, 2, 3]);
    assert_eq!(groups.find("8").unwrap().triangles(), [2, 3]);
    let Err(GroupError::Ambiguous { candidates, .. }) = groups.find("7") else { panic!() };
    assert_eq!(candidates, ["line:7", "surface:7"]);
    let error = groups.find("the shoer").unwrap_err();
    assert!(
        error.to_string().starts_with("no group is called 'the shoer'; there are the shore, "),
        "{error}"
    );
}

/// A mesh with damaged entities is read. Reading its groups then succeeds, or fails with a location.
#[test]
fn damaged_entities_are_refused_only_where_groups_are_asked_for() {
    let text = gmsh41();
    let damaged = text.replace("7 0 0 0 1 1 0 2 1 2 1 7", "7 0 0 0 1 1 0 9 1 2 1 7");
    let folder = Folder::new(&[("in.msh", &damaged)]);
    let file = folder.read("in.msh");
    assert_eq!(file.triangles().len(), 4);
    let Err(ReadError::Content { location, problem, .. }) = file.groups() else { panic!() };
    assert_eq!((location, problem.as_str()), (Location::Line(13), "a physical group is missing"));
    let nameless = text.replace("\"the shore\"", "shore");
    let folder = Folder::new(&[("in.msh", &nameless)]);
    let error = folder.read("in.msh").groups().unwrap_err().to_string();
    assert!(error.contains("in.msh:6: a name without quotes"), "{error}");
}

#[test]
fn no_damage_makes_the_search_for_groups_panic() {
    let samples: [(&str, Vec<u8>); 9] = [
        ("in.msh", gmsh41().into_bytes()),
        ("in.msh", gmsh41_partitioned().into_bytes()),
        ("in.msh", gmsh41_binary(false)),
        ("in.msh", GMSH22.into()),
        ("in.2dm", SMS.into()),
        ("in.mesh", MEDIT.into()),
        ("in.meshb", meditb([17, 3])),
        ("in.vtk", vtk_binary()),
        ("in.vtk", VTK.into()),
    ];
    let folder = Folder::new(&[]);
    let mut read = 0;
    for (name, bytes) in samples {
        for at in (0..bytes.len()).step_by(bytes.len() / 40) {
            let mut damaged = bytes.clone();
            damaged[at] = [b'9', b'-', b'"', 0xff][at % 4];
            fs::write(folder.path(name), &damaged).unwrap();
            if let Ok(file) = MeshFile::read(&folder.path(name)) {
                read += 1;
                let vertices = file.points().len() as u32;
                for group in file.groups().iter().flatten() {
                    assert!(group.vertices().iter().all(|&v| v < vertices));
                }
                let _ = file.point_array("weight");
            }
        }
    }
    assert!(read > 80, "only {read} files were read");
}

#[test]
fn point_data_have_a_number_a_vertex() {
    let hold = [0.0, 0.0, 0.0, 0.0];
    for (name, bytes, last) in [
        ("in.vtk", VTK.as_bytes().to_vec(), 1.0),
        ("in.vtk", vtk_binary(), 65535.0),
        ("in.vtu", VTU.into(), -1.0),
        ("in.ply", PLY.into(), 1.0),
    ] {
        let folder = Folder::new(&[]);
        fs::write(folder.path(name), bytes).unwrap();
        let file = folder.read(name);
        assert_eq!(file.point_array("hold").unwrap(), [&hold[..], &[last]].concat(), "{name}");
        assert_eq!(file.point_array("weight").unwrap(), [1.0, 2.0, 3.0, 4.0, 5.5], "{name}");
        let error = file.point_array("holt").unwrap_err().to_string();
        assert!(error.contains("no point data is called 'holt'. There are hold, "), "{error}");
    }
    for (name, text) in [("in.vtk", VTK), ("in.vtu", VTU)] {
        let folder = Folder::new(&[(name, text)]);
        let error = folder.read(name).point_array("v").unwrap_err().to_string();
        assert!(error.contains("numbers per point. Take an array with one number"), "{error}");
        let short = text.replace("4 5.5", "4");
        let folder = Folder::new(&[(name, &short)]);
        let error = folder.read(name).point_array("weight").unwrap_err().to_string();
        assert!(error.contains("in.vt"), "{error}");
    }
    let folder = Folder::new(&[("in.su2", SU2)]);
    let error = folder.read("in.su2").point_array("hold").unwrap_err().to_string();
    assert!(error.contains("The file has no point data"), "{error}");
}

#[test]
fn vertices_are_listed_by_the_numbers_of_the_file() {
    let list = "# two of them\n50 10\n\n 10 # again";
    let folder = Folder::new(&[
        ("in.msh", GMSH22),
        ("list", list),
        ("bad", "10\n\n20 77\n"),
        ("word", "10 x\n"),
    ]);
    let file = folder.read("in.msh");
    assert_eq!(file.read_vertices(&folder.path("list")).unwrap(), [4, 0, 0]);
    let error = file.read_vertices(&folder.path("bad")).unwrap_err().to_string();
    assert!(error.contains("bad:3: ") && error.contains("in.msh has no vertex 77"), "{error}");
    assert!(error.ends_with("numbered from 10 to 50"), "{error}");
    let error = file.read_vertices(&folder.path("word")).unwrap_err().to_string();
    assert!(error.contains("word:1: ") && error.contains("`x`"), "{error}");
    let error = file.read_vertices(&folder.path("none")).unwrap_err().to_string();
    assert!(error.contains("none"), "{error}");

    let from_zero =
        [("in.node", NODE), ("in.ele", ELE), ("list", "4 0"), ("in.su2", SU2), ("in.mesh", MEDIT)];
    let folder = Folder::new(&from_zero);
    let list = folder.path("list");
    assert_eq!(folder.read("in.node").read_vertices(&list).unwrap(), [4, 0]);
    assert_eq!(folder.read("in.su2").read_vertices(&list).unwrap(), [4, 0]);
    assert!(folder.read("in.mesh").read_vertices(&list).is_err(), "numbers start at one");
}
