//! Conversions of meshes with names that a format cannot hold or cannot tell apart.

use super::Folder;
use mesh_io::{Conversion, Format};
use std::collections::{BTreeMap, HashSet};

/// Returns a square with one named group of lines per side and a named surface.
fn square(names: [&str; 5]) -> String {
    let [a, b, c, d, surface] = names;
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"{a}\"\n1 2 \"{b}\"\n1 3 \"{c}\"\n1 4 \"{d}\"\n\
         2 9 \"{surface}\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .5 .5 0\n$EndNodes\n\
         $Elements\n8\n1 1 2 1 1 1 2\n2 1 2 2 2 2 3\n3 1 2 3 3 3 4\n4 1 2 4 4 4 1\n5 2 2 9 5 1 2 5\n6 2 2 9 5 2 3 5\n\
         7 2 2 9 5 3 4 5\n8 2 2 9 5 4 1 5\n$EndElements\n$NodeData\n1\n\"h \"1\"\"\n1\n0\n3\n0\n1\n5\n\
         1 1\n2 2\n3 3\n4 4\n5 5\n$EndNodeData\n"
    )
}

/// Returns the group names after a conversion, each with its number of vertices, and the reported renamings.
fn converted(names: [&str; 5], to: Format) -> (BTreeMap<String, usize>, Vec<String>) {
    let folder = Folder::new(&[("in.msh", &square(names))]);
    let conversion = Conversion::new(&folder.read("in.msh"), to).unwrap().unwrap();
    let out = match to {
        Format::Su2 => "out.su2",
        Format::Obj => "out.obj",
        Format::Ply => "out.ply",
        Format::Sms2dm => "out.2dm",
        _ => "out.msh",
    };
    conversion.write(&folder.path(out)).unwrap();
    let groups = folder.read(out).groups().unwrap();
    let named = groups.iter().filter_map(|g| Some((g.name.clone()?, g.vertices().len())));
    (named.collect(), conversion.renamings().to_vec())
}

fn groups<'n>(names: impl IntoIterator<Item = (&'n str, usize)>) -> BTreeMap<String, usize> {
    names.into_iter().map(|(name, vertices)| (name.to_owned(), vertices)).collect()
}

/// Each side of the square has two vertices, so merged groups would have more.
#[test]
fn groups_stay_apart_where_names_are_words() {
    let names = ["a b", "a_b", "wall", "wall", "50 % open"];
    let (found, told) = converted(names, Format::Su2);
    assert_eq!(found, groups([("a_b_2", 2), ("a_b", 2), ("wall", 2), ("wall_2", 2)]));
    assert_eq!(told, ["groups: `a b` (1) to `a_b_2`, `wall` (4) to `wall_2`"]);
    let (found, told) = converted(names, Format::Obj);
    let own = [("a_b_2", 2), ("a_b", 2), ("wall", 2), ("wall_2", 2), ("50_open", 5)];
    assert_eq!(found, groups(own));
    let all = "groups: `a b` (1) to `a_b_2`, `wall` (4) to `wall_2`, `50 % open` (9) to `50_open`";
    assert_eq!(told, [all]);
    // A name may equal the number of an unnamed group, or the name of a group of another dimension.
    let (found, _) = converted(["2", "", "2_2", "x", "x"], Format::Obj);
    assert_eq!(found, groups([("2", 2), ("2_3", 2), ("2_2", 2), ("x", 2), ("x_2", 5)]));
}

#[test]
fn names_that_fit_are_kept_and_nothing_is_told() {
    let names = ["in", "out", "wall", "top", "steel"];
    for format in [Format::Su2, Format::Obj, Format::Sms2dm, Format::Gmsh41] {
        let (_, told) = converted(names, format);
        let told: Vec<_> = told.iter().filter(|line| line.starts_with("groups")).collect();
        assert_eq!(told, [""; 0], "{format}");
    }
}

#[test]
fn quotation_marks_that_change_are_told() {
    let names = ["a \"b\"", "a 'b'", "wall", "wall", "the \"best\" one"];
    let told = "groups: `a \"b\"` (1) to `a 'b'_2`, `the \"best\" one` (9) to `the 'best' one`";
    let data = "data of vertices: `h \"1\"` to `h '1'`";
    let (found, renamed) = converted(names, Format::Gmsh41);
    // In gmsh, numbers tell groups of equal names apart.
    assert_eq!(found, groups([("a 'b'_2", 2), ("a 'b'", 2), ("wall", 2), ("the 'best' one", 5)]));
    assert_eq!(renamed, [told, data]);
    let (found, renamed) = converted(names, Format::Sms2dm);
    assert_eq!(found, groups([("a 'b'_2", 2), ("a 'b'", 2), ("wall", 2), ("the 'best' one", 5)]));
    assert_eq!(renamed, [told]);
    let (_, renamed) = converted(names, Format::Ply);
    assert_eq!(renamed, ["data of vertices: `h \"1\"` to `h_\"1\"`"]);
}

/// Two data arrays of equal names would become one property of PLY, and an array called `x` would become coordinates.
#[test]
fn data_stay_apart_where_names_are_words() {
    let vtk = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n\
               POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nFIELD f 3\na%20b 1 3 double\n1 2 3\na_b 1 3 double\n4 5 6\n\
               x 1 3 double\n7 8 9\n";
    let folder = Folder::new(&[("in.vtk", vtk)]);
    let file = folder.read("in.vtk");
    let conversion = Conversion::new(&file, Format::Ply).unwrap().unwrap();
    assert_eq!(conversion.renamings(), ["data of vertices: `a b` to `a_b_2`, `x` to `x_2`"]);
    conversion.write(&folder.path("out.ply")).unwrap();
    let back = folder.read("out.ply");
    assert_eq!(back.points(), file.points());
    let fields = back.point_fields(None).unwrap();
    let fields = fields.iter().filter(|field| field.name() != "z");
    let found: Vec<_> = fields.map(|field| (field.name(), field.values()[0])).collect();
    assert_eq!(found, [("a_b_2", 1.0), ("a_b", 4.0), ("x_2", 7.0)]);
}

/// Objects and materials both have numbers from 1 on in gmsh's formats, of which the materials keep theirs. A search for
/// free numbers from 1, or a list of kinds for each group, would take minutes.
#[test]
fn very_many_groups_have_numbers_of_their_own_in_files_of_gmsh() {
    const GROUPS: usize = 30_000;
    let mut text = String::new();
    for group in 0..GROUPS {
        text += &format!("v {group} 0\nv {group} 1\n");
        if group > 0 {
            let first = 2 * group - 1;
            text += &format!("o part{group}\nusemtl steel{group}\n");
            text += &format!("f {first} {} {}\n", first + 2, first + 1);
        }
    }
    let folder = Folder::new(&[("a.obj", &text)]);
    let file = folder.read("a.obj");
    for format in [Format::Gmsh22, Format::Gmsh41] {
        let conversion = Conversion::new(&file, format).unwrap().unwrap();
        conversion.write(&folder.path("b.msh")).unwrap();
        let groups = folder.read("b.msh").groups().unwrap();
        let physical: Vec<_> = groups.iter().filter(|group| group.kind == "physical").collect();
        assert_eq!(physical.len(), 2 * (GROUPS - 1), "{format}");
        let tags: HashSet<_> = physical.iter().map(|group| group.tag).collect();
        assert_eq!(tags.len(), physical.len(), "{format}");
        for group in physical {
            let number = group.name.as_ref().unwrap().trim_start_matches(char::is_alphabetic);
            let triangle = number.parse::<u32>().unwrap() - 1;
            assert_eq!(group.triangles(), [triangle], "{format}");
        }
    }
}

/// Arrays of regions get the names by which other programs recognize regions.
#[test]
fn arrays_of_regions_that_get_a_usual_name_are_told() {
    let vtk = |name: &str| {
        format!(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\n\
             POLYGONS 2 8\n3 0 1 2\n3 0 2 3\nCELL_DATA 2\nSCALARS {name} int 1\nLOOKUP_TABLE default\n1 2\n"
        )
    };
    for (name, new) in
        [("MaterialIds", "MaterialIDs"), ("material", "MaterialIDs"), ("MaterialIDs", "")]
    {
        let folder = Folder::new(&[("in.vtk", &vtk(name))]);
        let file = folder.read("in.vtk");
        for (to, out) in
            [(Format::Vtu, "out.vtu"), (Format::Vtk, "out.vtk"), (Format::Xdmf, "out.xdmf")]
        {
            let conversion = Conversion::new(&file, to).unwrap().unwrap();
            let told = match new {
                "" => Vec::new(),
                new => vec![format!("data of elements: `{name}` to `{new}`")],
            };
            assert_eq!(conversion.renamings(), told);
            conversion.write(&folder.path(out)).unwrap();
            assert_eq!(
                folder.read(out).groups().unwrap().iter().next().unwrap().kind,
                "MaterialIDs"
            );
        }
        // In other formats, groups have the numbers, and no array has a name.
        let conversion = Conversion::new(&file, Format::Gmsh41).unwrap().unwrap();
        assert_eq!(conversion.renamings(), [""; 0]);
    }
}

/// A former defect: readers of Exodus drop blanks at the ends of names, and conversions did not list the changed names.
#[test]
fn blanks_at_the_ends_of_names_are_listed_for_exodus() {
    let msh = square([" lead", "lead", "c", "d ", " in let"]);
    let folder =
        Folder::new(&[("in.msh", &msh), ("in.inp", &format!("{ABAQUS}*NSET, NSET=\" pin\"\n1\n"))]);
    let mut renamed = Vec::new();
    for (name, from) in [("a.exo", "in.msh"), ("b.exo", "in.inp")] {
        let conversion = Conversion::new(&folder.read(from), Format::Exodus).unwrap().unwrap();
        renamed.extend_from_slice(conversion.renamings());
        conversion.write(&folder.path(name)).unwrap();
        let again = Conversion::new(&folder.read(name), Format::Exodus).unwrap().unwrap();
        assert_eq!(again.renamings(), [""; 0]);
    }
    let groups = "groups: ` lead` (1) to `lead_2`, `d ` (4) to `d`, ` in let` (9) to `in let`";
    assert_eq!(renamed, [groups, "groups of vertices: ` pin` to `pin`"]);
    assert_eq!(folder.read("a.exo").groups().unwrap().find("lead_2").unwrap().lines, 1);
}

const ABAQUS: &str = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 0., 1.\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n";
