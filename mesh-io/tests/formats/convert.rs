//! Conversions to other formats: the content that comes back, and the reported losses.

use super::facts::mesh_of;
use super::made::base;
use super::others::{folder, for_each};
use super::vtu::{self, styles};
use super::{Folder, damage};
use mesh_io::{Conversion, Encoding, Format, Group, MeshFile};
use std::collections::BTreeMap;
use std::fs;
use std::sync::Mutex;

/// Returns the content of a group: dimension, name, triangles, and numbers of lines and quadrilaterals.
fn held(group: &Group) -> (u8, Option<String>, Vec<u32>, usize, usize) {
    let triangles = group.triangles().to_vec();
    (group.dimension, group.name.clone(), triangles, group.lines, group.quadrilaterals().len())
}

/// Converts a mesh to every format and reads the result: the whole content must come back unless a loss is reported.
/// Returns the number of formats without loss.
fn check(file: &MeshFile, folder: &Folder) -> usize {
    let mut clean = 0;
    let encodings = [Encoding::Text, Encoding::Binary, Encoding::Compressed];
    let targets =
        Conversion::targets().flat_map(|target| encodings.map(|encoding| (target, encoding)));
    for ((name, format), encoding) in targets {
        let out = format!("{name}{encoding:?}{}", format.extensions()[0]);
        let mut conversion = Conversion::new(file, format).unwrap().unwrap();
        if !conversion.set_encoding(encoding) {
            continue;
        }
        conversion.write(&folder.path(&out)).unwrap();
        let back = folder.read(&out);
        assert_eq!(back.format().extensions(), format.extensions());
        assert_eq!(back.points(), file.points(), "{name}");
        let (mut triangles, mut own) = (back.triangles().to_vec(), file.triangles().to_vec());
        if conversion.losses().iter().any(|lost| lost.starts_with("the order of triangles")) {
            triangles.sort_unstable();
            own.sort_unstable();
        }
        assert_eq!(triangles, own, "{name}");
        // The reader reads the whole file: a second conversion gives an equal file without loss.
        let mut again = Conversion::new(&back, format).unwrap().unwrap();
        again.set_encoding(encoding);
        let [again_text, text] = [&again, &conversion].map(|c| c.text().unwrap_or_default());
        let differ = again_text.lines().zip(text.lines()).find(|(again, first)| again != first);
        assert_eq!(differ, None, "{name}");
        assert_eq!(again_text.len(), text.len(), "{name}");
        assert!(again.bytes() == conversion.bytes(), "{name}");
        assert_eq!(again.losses(), [""; 0], "{name}");
        if !conversion.losses().is_empty() {
            continue;
        }
        clean += 1;
        let free = |file: &MeshFile| support::check::held(&mesh_of(file));
        assert_eq!(free(&back), free(file), "{name}: other vertices are free");
        let (before, after) = (file.groups().unwrap(), back.groups().unwrap());
        let after: Vec<_> = after.iter().map(held).collect();
        // Tag 0 is not a group in every format, and physical groups, if there are any, replace entities.
        let is_kept = |group: &&Group| {
            let is_points =
                group.lines + group.triangles().len() + group.quadrilaterals().len() == 0;
            // OBJ puts lines into the groups of faces, and chains of nodes count as points.
            let is_points =
                is_points || (matches!(name, "obj" | "2dm" | "adcirc") && group.dimension < 2);
            // MIKE has no groups of triangles, so a group of all triangles loses its number.
            let is_whole = name == "mike" && group.triangles().len() == file.triangles().len();
            group.tag != Some(0) && !group.kind.contains("entity") && !is_points && !is_whole
        };
        for group in before.iter().filter(is_kept) {
            let own = held(group);
            let same = after.iter().any(|other| {
                let named = own.1.is_none() || own.1 == other.1;
                named && (own.0, &own.2, own.3, own.4) == (other.0, &other.2, other.3, other.4)
            });
            assert!(same, "{name}: {own:?} is none of {after:?}");
        }
        let values = |file: &MeshFile| -> BTreeMap<String, Vec<u64>> {
            let fields = file.point_fields(None).unwrap();
            let bits = |x: &f64| (x + 0.0).to_bits();
            let of = |field: &mesh_io::PointField| {
                (field.name().to_owned(), field.values().iter().map(bits).collect())
            };
            // Vectors of two numbers are skipped, as gmsh pads them to three numbers.
            fields.iter().filter(|field| field.components() != 2).map(of).collect()
        };
        let (mut before, after) = (values(file), values(&back));
        // A constant third coordinate may be missing in the output.
        let is_flat = |z: &Vec<u64>| z.iter().all(|bits| *bits == z[0]);
        if before.get("z").is_some_and(is_flat) {
            before.remove("z");
        }
        // Depth and height have opposite signs.
        let turned = match (file.format(), format) {
            (Format::Adcirc | Format::Fvcom, Format::Sms2dm | Format::Mike) => Some(("depth", "z")),
            (Format::Sms2dm | Format::Mike, Format::Adcirc) => Some(("z", "depth")),
            (Format::Adcirc | Format::Fvcom, Format::Selafin) => Some(("depth", "BOTTOM")),
            (from, Format::Adcirc) if from.family() == "gmsh" => Some(("z", "depth")),
            (from, Format::Selafin) if from.family() == "gmsh" => {
                before.remove("z");
                None
            }
            _ => None,
        };
        if let Some((from, to)) = turned
            && let Some(numbers) = before.remove(from)
        {
            let minus = |bits: u64| (0.0 - f64::from_bits(bits)).to_bits();
            before.insert(to.to_owned(), numbers.into_iter().map(minus).collect());
        }
        for (array, values) in before {
            let found = after.get(&array).or_else(|| after.get(&array.replace(' ', "_")));
            assert!(found == Some(&values), "{name}: {array}");
        }
    }
    clean
}

#[test]
fn every_format_is_converted_to_every_other() {
    let clean = Mutex::new(0);
    for_each(&base(), |made| {
        let folder = folder(made, &made.bytes);
        *clean.lock().unwrap() += check(&folder.read(made.name), &folder);
    });
    let clean = clean.into_inner().unwrap();
    assert!(clean > 70, "{clean} conversions lose nothing");
}

const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"in let\"\n1 2 \"wall\"\n2 1 \"steel\"\n\
$EndPhysicalNames\n$Nodes\n6\n1 0 0 0.5\n2 1 0 1\n3 1 1 1\n4 0 1 1\n5 .5 .5 1\n6 2 .5 1\n$EndNodes\n$Elements\n9\n\
1 1 2 1 7 1 2\n2 1 2 2 8 2 3\n3 1 2 2 8 3 4\n4 1 2 2 9 4 1\n5 2 2 1 4 1 2 5\n6 2 2 1 4 2 3 5\n7 2 2 1 4 3 4 5\n\
8 2 2 1 4 4 1 5\n9 2 2 3 4 2 6 3\n$EndElements\n$ElementData\n1\n\"e\"\n1\n0\n3\n0\n1\n1\n6 2.5\n$EndElementData\n";

/// Converts a mesh. Returns the text of the result and the reported losses.
fn converted(name: &str, text: &str, to: Format) -> (String, String) {
    let folder = Folder::new(&[(name, text)]);
    let conversion = Conversion::new(&folder.read(name), to).unwrap().unwrap();
    (conversion.text().unwrap(), conversion.losses().join("; "))
}

#[test]
fn names_and_numbers_stand_where_formats_have_them() {
    let (su2, lost) = converted("in.msh", GMSH, Format::Su2);
    let expected = "NDIME= 2\nNELEM= 5\n5 0 1 4 0\n5 1 2 4 1\n5 2 3 4 2\n5 3 0 4 3\n5 1 5 2 4\nNPOIN= 6\n\
        0.0 0.0 0\n1.0 0.0 1\n1.0 1.0 2\n0.0 1.0 3\n0.5 0.5 4\n2.0 0.5 5\nNMARK= 2\nMARKER_TAG= in_let\n\
        MARKER_ELEMS= 1\n3 0 1\nMARKER_TAG= wall\nMARKER_ELEMS= 3\n3 1 2\n3 2 3\n3 3 0\n";
    assert_eq!(su2, expected);
    let expected =
        "third coordinates; groups of surfaces (physical): steel, 3; data of elements: e";
    assert_eq!(lost, expected);

    let (sms, lost) = converted("in.msh", GMSH, Format::Sms2dm);
    let expected = "MESH2D\nE3T 1 1 2 5 1\nE3T 2 2 3 5 1\nE3T 3 3 4 5 1\nE3T 4 4 1 5 1\nE3T 5 2 6 3 3\n\
        ND 1 0.0 0.0 0.5\nND 2 1.0 0.0 1.0\nND 3 1.0 1.0 1.0\nND 4 0.0 1.0 1.0\nND 5 0.5 0.5 1.0\nND 6 2.0 0.5 1.0\n\
        NS 1 -2 \"in let\"\nNS 2 3 4 -1 \"wall\"\nMAT 1 \"steel\"\n";
    assert_eq!(sms, expected);
    assert_eq!(lost, "data of elements: e");

    let (medit, lost) = converted("in.msh", GMSH, Format::Medit);
    assert!(medit.starts_with("MeshVersionFormatted 2\nDimension 3\nVertices\n6\n0.0 0.0 0.5 0\n"));
    assert!(medit.ends_with(
        "Edges\n4\n1 2 1\n2 3 2\n3 4 2\n4 1 2\nTriangles\n5\n1 2 5 1\n2 3 5 1\n\
                             3 4 5 1\n4 1 5 1\n2 6 3 3\nEnd\n"
    ));
    assert!(
        lost.contains("names of groups of lines, which become numbers: in let, wall"),
        "{lost}"
    );

    // Names of groups pass from one version of gmsh's format to the other and back.
    let (newer, lost) = converted("in.msh", GMSH, Format::Gmsh41);
    assert_eq!(lost, "");
    let (older, lost) = converted("in.msh", &newer, Format::Gmsh22);
    assert_eq!(lost, "");
    let rows = |text: &str| -> Vec<String> {
        let words = |row: &str| row.split_whitespace().collect::<Vec<_>>().join(" ");
        text.lines().map(words).collect()
    };
    let (older, elements) = (rows(&older), "2 1 2 2 8 2 3".to_owned());
    assert!(older.contains(&elements) && older.contains(&"1 2 \"wall\"".to_owned()), "{older:?}");
    assert!(older.contains(&"6 2.5".to_owned()), "{older:?}");
    assert!(older.contains(&"9 2 2 3 1 2 6 3".to_owned()), "{older:?}");
}

const GRID: &str = "bay\n4 5\n1 0 0 2.5\n2 1 0 3\n3 1 1 4\n4 0 1 5\n5 .5 .5 9\n1 3 1 2 5\n2 3 2 3 5\n3 3 3 4 5\n4 3 4 1 5\n\
1 = Number of open boundaries\n2 = Total\n2 = Number of nodes for open boundary 1\n1\n2\n2 ! land\n5\n3 0 = first\n2\n3\n4\n2 1\n4\n1\n";

#[test]
fn boundaries_of_a_grid_are_groups() {
    let folder = Folder::new(&[("in.14", GRID)]);
    let groups = folder.read("in.14").groups().unwrap();
    let told: Vec<_> = groups.iter().map(|group| (group.to_string(), group.vertices())).collect();
    let expected: [(String, &[u32]); 3] = [
        ("boundary line open1".into(), &[0, 1]),
        ("boundary line land1".into(), &[1, 2, 3]),
        ("boundary line island2".into(), &[0, 3]),
    ];
    assert_eq!(told, expected);
    let (gmsh, lost) = converted("in.14", GRID, Format::Gmsh22);
    assert_eq!(lost, "");
    assert!(gmsh.contains("1 1 \"open1\"") && gmsh.contains("$NodeData\n1\n\"depth\""), "{gmsh}");
    let (sms, lost) = converted("in.14", GRID, Format::Sms2dm);
    assert!(sms.contains("NS 2 3 -4 \"land1\"\n"), "{sms}");
    assert_eq!(lost, "");
    let (back, lost) = converted("in.msh", &gmsh, Format::Adcirc);
    assert_eq!(lost, "names of groups of lines, which become numbers: open1, land1, island2");
    let tail = &back[back.find("1 = Number of open").unwrap()..];
    let expected = "1 = Number of open boundaries\n2 = Total number of open boundary nodes\n\
        2 = Number of nodes for open boundary\n1\n2\n2 = Number of land boundaries\n5 = Total number of land boundary nodes\n\
        3 0 = Number of nodes for land boundary\n2\n3\n4\n2 1 = Number of nodes for land boundary\n4\n1\n";
    assert_eq!(tail, expected);
}

#[test]
fn content_that_a_format_cannot_hold_is_listed() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 0\nv 2 0 0\nv 2 1 0\nvn 0 0 1\nvt 0 0\nusemtl a b\no part\nf 1/1/1 2//1 5\n\
               f 2 3 5\no other\nf 3 4 5\nf 4 1 5\nf 2 6 7 3\nl 1 2 3\np 5\n";
    let of = |to| converted("in.obj", obj, to).1;
    let left =
        "normals; texture coordinates; lines of more than two points, which become several lines";
    // Materials and objects become physical groups.
    assert_eq!(of(Format::Gmsh22), left);
    let gmsh = converted("in.obj", obj, Format::Gmsh22).0;
    let names =
        "$PhysicalNames\n5\n0 1 \"a b\"\n0 2 \"other\"\n1 1 \"a b\"\n1 2 \"other\"\n2 1 \"a b\"\n";
    assert!(gmsh.contains(&names.replacen('5', "7", 1)), "{gmsh}");
    let medit = of(Format::Medit);
    assert!(medit.contains("groups of surfaces (object): part, other"), "{medit}");
    let off = of(Format::Off);
    assert!(off.starts_with("1 point; 2 lines; groups of points (material): a b; "), "{off}");
    let vtu = of(Format::Vtu);
    let names = "names of groups of surfaces, which become numbers: a b, part, other; ";
    assert!(vtu.contains(names) && vtu.ends_with(left), "{vtu}");
    assert!(of(Format::FreeFem).starts_with("1 point; 1 quadrilateral; "));

    let sparse = GMSH.replace("\n6 2 .5 1", "\n60 2 .5 1").replace("4 2 6 3\n", "4 2 60 3\n");
    let (_, lost) = converted("in.msh", &sparse, Format::Vtu);
    assert!(lost.contains("the vertices' own numbers, which are not consecutive"), "{lost}");
    let (text, lost) = converted("in.msh", &sparse, Format::Gmsh41);
    assert!(lost.is_empty() && text.contains("\n60\n"), "{lost}");
    assert!(
        Conversion::new(&Folder::new(&[("in.msh", GMSH)]).read("in.msh"), Format::Fvcom)
            .unwrap()
            .is_none()
    );
}

/// A square of two entities, one of which is in two groups, and whose left and right curve are periodic.
const PERIODIC: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"all\"\n2 2 \"wet\"\n1 1 \"left\"\n\
$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .5 .5 0\n$EndNodes\n$Elements\n9\n\
1 1 2 1 7 4 1\n2 1 2 0 8 2 3\n3 2 2 1 4 1 2 5\n4 2 2 1 4 2 3 5\n5 2 2 1 5 3 4 5\n6 2 2 2 5 3 4 5\n7 2 2 1 5 4 1 5\n\
8 2 2 2 5 4 1 5\n9 15 2 0 3 1\n$EndElements\n$Periodic\n2\n0 2 3\n1\n2 1\n1 8 7\n\
Affine 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n2\n2 1\n3 4\n$EndPeriodic\n";

#[test]
fn versions_of_gmsh_keep_elements_of_several_groups_and_periodic_pairs() {
    let (newer, lost) = converted("in.msh", PERIODIC, Format::Gmsh41);
    assert_eq!(lost, "");
    // The two surfaces, and their physical groups behind the box around each.
    let is_surface = |row: &&str| row.ends_with(" 1 1 0") || row.ends_with(" 2 1 2 0");
    let surfaces: Vec<&str> = newer.lines().filter(is_surface).collect();
    assert_eq!(surfaces.len(), 3, "{newer}");
    let pairs = "$Periodic\n1\n1 8 7\n16 1.0 0.0 0.0 1.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0\n2\n2 1\n3 4\n";
    assert!(newer.contains(pairs), "{newer}");
    let (older, lost) = converted("in.msh", &newer, Format::Gmsh22);
    assert_eq!(lost, "");
    let rows =
        ["5 2 2 1 5 3 4 5\n6 2 2 2 5 3 4 5\n", "$Periodic\n1\n1 8 7\nAffine 1.0 0.0 0.0 1.0"];
    assert!(rows.iter().all(|rows| older.contains(rows)), "{older}");
    let folder = Folder::new(&[("in.msh", PERIODIC), ("out.msh", &older)]);
    let [before, after] = ["in.msh", "out.msh"].map(|name| folder.read(name));
    let pairs = |file: &MeshFile| {
        let pairs = file.constraints().periodic.iter().map(|set| set.pairs.clone());
        pairs.max_by_key(Vec::len).unwrap()
    };
    assert_eq!(pairs(&before), pairs(&after));
    assert_eq!(before.groups().unwrap().len(), after.groups().unwrap().len());
    let (_, lost) = converted("in.msh", PERIODIC, Format::Vtu);
    assert!(lost.contains("pairs of periodic vertices"), "{lost}");
}

#[test]
fn every_encoding_of_vtu_is_converted() {
    for style in styles().into_iter().step_by(7) {
        let folder = vtu::folder(&vtu::write(&base(), style));
        assert!(check(&folder.read("in.vtu"), &folder) >= 2, "{style:?}");
    }
}

/// Every damaged file that still can be read can be converted too.
#[test]
fn damaged_files_are_converted_or_refused() {
    let mut random = damage::random(17);
    let styles: Vec<_> = styles().into_iter().step_by(17).collect();
    let vtus = styles.iter().map(|style| ("in.vtu", vtu::write(&base(), *style)));
    let mut samples: Vec<(&str, Vec<u8>)> = vtus.collect();
    samples.extend([("in.msh", GMSH.into()), ("in.14", GRID.into())]);
    let mut read = 0;
    for round in 0..200 {
        let (name, bytes) = &samples[round % samples.len()];
        let folder = Folder::new(&[]);
        fs::write(folder.path(name), damage::damaged(bytes, &mut random)).unwrap();
        let Ok(file) = MeshFile::read(&folder.path(name)) else { continue };
        for (_, format) in Conversion::targets() {
            if let Ok(Some(conversion)) = Conversion::new(&file, format) {
                conversion.text();
                read += 1;
            }
        }
    }
    assert!(read > 300, "{read} conversions");
}

#[test]
fn depths_of_grids_are_heights_of_sms() {
    let grid = "t\n2 4\n1 0.0 0.0 1.5\n2 1.0 0.0 0.0\n3 1.0 1.0 -3.5\n4 0.0 1.0 NaN\n1 3 1 2 3\n2 3 1 3 4\n";
    let folder = Folder::new(&[("a.14", grid)]);
    let convert = |from: &str, format, to: &str| {
        let conversion = Conversion::new(&folder.read(from), format).unwrap().unwrap();
        conversion.write(&folder.path(to)).unwrap();
        conversion.losses().to_vec()
    };
    assert_eq!(convert("a.14", Format::Sms2dm, "a.2dm"), [""; 0]);
    let nodes = "ND 1 0.0 0.0 -1.5\nND 2 1.0 0.0 0.0\nND 3 1.0 1.0 3.5\nND 4 0.0 1.0 NaN\n";
    assert!(folder.text("a.2dm").ends_with(nodes), "{}", folder.text("a.2dm"));
    assert_eq!(convert("a.2dm", Format::Adcirc, "b.14"), [""; 0]);
    assert!(folder.text("b.14").contains(&grid[2..]), "{}", folder.text("b.14"));
    // Depths are reported as lost: z of other formats may have any meaning, so depths do not become z.
    assert_eq!(convert("a.14", Format::Off, "a.off"), ["data of vertices: depth"]);
    assert_eq!(convert("a.2dm", Format::Off, "b.off"), [""; 0]);
    assert_eq!(convert("b.off", Format::Adcirc, "c.14"), ["third coordinates"]);
    // In UGRID, depths become the variable `depth` and third coordinates `z`, and both come back from other formats.
    assert_eq!(convert("a.14", Format::Ugrid, "a.nc"), [""; 0]);
    assert_eq!(folder.read("a.nc").data_names(), ["depth"]);
    assert_eq!(convert("a.nc", Format::Sms2dm, "d.2dm"), [""; 0]);
    assert!(folder.text("d.2dm").ends_with(nodes), "{}", folder.text("d.2dm"));
    assert_eq!(convert("a.2dm", Format::Ugrid, "b.nc"), [""; 0]);
    assert_eq!(folder.read("b.nc").data_names(), ["z"]);
    assert_eq!(convert("b.nc", Format::Adcirc, "d.14"), [""; 0]);
    assert!(folder.text("d.14").contains(&grid[2..]), "{}", folder.text("d.14"));
    // In SELAFIN, heights are the variable BOTTOM.
    assert_eq!(convert("a.14", Format::Selafin, "a.slf"), [""; 0]);
    assert_eq!(folder.read("a.slf").data_names(), ["BOTTOM"]);
    assert_eq!(convert("a.slf", Format::Sms2dm, "e.2dm"), [""; 0]);
    assert!(folder.text("e.2dm").ends_with(nodes), "{}", folder.text("e.2dm"));
    assert_eq!(convert("e.2dm", Format::Selafin, "e.slf"), [""; 0]);
    assert_eq!(convert("e.slf", Format::Adcirc, "e.14"), [""; 0]);
    assert!(folder.text("e.14").contains(&grid[2..]), "{}", folder.text("e.14"));
}

/// The codes of nodes are those of boundaries, and come back.
#[test]
fn grids_are_meshes_of_mike_with_codes_of_boundaries() {
    // A square with a node inside, and a quadrilateral beside it. The left side is open.
    let nodes = "1 0.0 0.0 1.5\n2 1.0 0.0 2.5\n3 1.0 1.0 -3.5\n4 0.0 1.0 0.5\n5 0.5 0.5 1.0\n6 2.0 0.0 1.0\n7 2.0 1.0 1.0\n";
    let elements = "1 3 1 2 5\n2 3 2 3 5\n3 3 3 4 5\n4 3 4 1 5\n5 4 2 6 7 3\n";
    let open = "1 = open\n2 = nodes\n2\n1\n4\n1 = land\n6 = nodes\n6 0\n4\n3\n7\n6\n2\n1\n";
    let (mike, lost) = converted("a.14", &format!("t\n5 7\n{nodes}{elements}{open}"), Format::Mike);
    assert_eq!(lost, "");
    let expected = "100079  1000  7  NON-UTM\n1 0.0 0.0 -1.5 2\n2 1.0 0.0 -2.5 1\n3 1.0 1.0 3.5 1\n4 0.0 1.0 -0.5 2\n\
        5 0.5 0.5 -1.0 0\n6 2.0 0.0 -1.0 1\n7 2.0 1.0 -1.0 1\n5  4  25\n1 1 2 5 0\n2 2 3 5 0\n3 3 4 5 0\n\
        4 4 1 5 0\n5 2 6 7 3\n";
    assert_eq!(mike, expected);
    let codes = mike.replace("-2.5 1", "-2.5 7").replace("-1.0 1", "-1.0 0");
    assert_eq!(converted("a.mesh", &codes, Format::Mike), (codes.clone(), String::new()));
    // Codes become boundaries of a grid and node strings. A mesh with a code inside keeps its codes, which grids cannot hold.
    let (grid, lost) = converted("a.mesh", &mike, Format::Adcirc);
    assert_eq!(lost, "");
    let folder = Folder::new(&[("a.14", &grid)]);
    let groups = folder.read("a.14").groups().unwrap();
    let told: Vec<_> = groups.iter().map(|group| (group.to_string(), group.vertices())).collect();
    let [open, land]: [&[u32]; 2] = [&[0, 3], &[0, 1, 2, 3, 5, 6]];
    let names = ["boundary line open1".to_owned(), "boundary line land1".to_owned()];
    assert_eq!(told, names.into_iter().zip([open, land]).collect::<Vec<_>>());
    assert_eq!(converted("a.14", &grid, Format::Mike).0, mike);
    let (sms, lost) = converted("a.mesh", &mike, Format::Sms2dm);
    assert!(lost.is_empty() && sms.contains("NS 4 -1 \"open1\"\n"), "{lost} {sms}");
    assert_eq!(converted("a.2dm", &sms, Format::Mike), (mike.clone(), String::new()));
    let (_, lost) = converted("a.mesh", &mike.replace("-1.0 0", "-1.0 3"), Format::Adcirc);
    assert_eq!(lost, "groups of vertices: 2, 1, 3");
    // A node string inside of the mesh, one with another name, and two open boundaries with a common node.
    for (string, expected) in [
        ("NS 1 -5 \"open2\"\n", "7 lines; groups of lines (nodestring): open1, open2"),
        ("NS 1 -2 \"weir\"\n", "groups of lines (nodestring): weir"),
        ("NS 4 -3 \"open2\"\n", "groups of lines (nodestring): open1, land1"),
    ] {
        let (_, lost) = converted("a.2dm", &(sms.clone() + string), Format::Mike);
        assert_eq!(lost, expected);
    }
    // Without a quadrilateral, rows have three nodes.
    let triangles = "t\n1 3\n1 0.0 0.0 1.0\n2 1.0 0.0 1.0\n3 0.0 1.0 1.0\n1 3 1 2 3\n";
    let (mike, lost) = converted("a.14", triangles, Format::Mike);
    assert!(lost.is_empty() && mike.ends_with(" 1\n1  3  21\n1 1 2 3\n"), "{lost} {mike}");
}

/// A ring of triangles around a square island: all codes are 1.
#[test]
fn closed_land_inside_of_a_mesh_of_mike_is_an_island_of_adcirc() {
    let points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [2, 1], [2, 2], [1, 2]];
    let mut text = "100079  1000  8  NON-UTM\n".to_owned();
    for (i, [x, y]) in points.iter().enumerate() {
        text += &format!("{} {x} {y} -1 1\n", i + 1);
    }
    text += "8 3 21\n";
    for side in 0..4 {
        let next = (side + 1) % 4;
        let [a, b, c, d] = [side, next, 4 + next, 4 + side].map(|v| v + 1);
        text += &format!("{} {a} {b} {c}\n{} {a} {c} {d}\n", 2 * side + 1, 2 * side + 2);
    }
    let (grid, lost) = converted("a.mesh", &text, Format::Adcirc);
    assert_eq!(lost, "");
    let folder = Folder::new(&[("a.14", &grid)]);
    let groups = folder.read("a.14").groups().unwrap();
    let told: Vec<_> = groups.iter().map(|group| (group.to_string(), group.vertices())).collect();
    let [outer, inner]: [&[u32]; 2] = [&[0, 1, 2, 3], &[4, 5, 6, 7]];
    let names = ["boundary line land1".to_owned(), "boundary line island2".to_owned()];
    assert_eq!(told, names.into_iter().zip([outer, inner]).collect::<Vec<_>>());
}

/// gmsh has heights as z, and data of vertices from other grids under their names.
#[test]
fn depths_of_grids_are_heights_of_gmsh() {
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 -1.5\n2 1 0 0\n3 1 1 3.5\n4 0 1 -2\n$EndNodes\n\
                $Elements\n2\n1 2 2 0 1 1 2 3\n2 2 2 0 1 1 3 4\n$EndElements\n";
    let folder = Folder::new(&[("a.msh", gmsh)]);
    let convert = |from: &str, format, to: &str| {
        let conversion = Conversion::new(&folder.read(from), format).unwrap().unwrap();
        conversion.write(&folder.path(to)).unwrap();
        conversion.losses().to_vec()
    };
    let values = |name: &str| {
        let fields = folder.read(name).point_fields(None).unwrap();
        let told = fields.iter().map(|field| (field.name().to_owned(), field.values().to_vec()));
        // gmsh writes a third coordinate for every vertex.
        told.filter(|(name, values)| name != "z" || values.iter().any(|z| *z != 0.0))
            .collect::<Vec<_>>()
    };
    let heights = vec![-1.5, 0.0, 3.5, -2.0];
    let depths = vec![1.5, 0.0, -3.5, 2.0];
    assert_eq!(convert("a.msh", Format::Adcirc, "a.14"), [""; 0]);
    assert_eq!(values("a.14"), [("depth".to_owned(), depths.clone())]);
    assert_eq!(convert("a.msh", Format::Selafin, "a.slf"), [""; 0]);
    assert_eq!(values("a.slf"), [("BOTTOM".to_owned(), heights.clone())]);
    assert_eq!(convert("a.msh", Format::Sms2dm, "a.2dm"), [""; 0]);
    assert_eq!(values("a.2dm"), [("z".to_owned(), heights.clone())]);
    for (from, name, own) in [("a.14", "depth", depths), ("a.slf", "BOTTOM", heights.clone())] {
        for format in [Format::Gmsh22, Format::Gmsh41] {
            assert_eq!(convert(from, format, "b.msh"), [""; 0]);
            assert_eq!(values("b.msh"), [(name.to_owned(), own.clone())]);
            assert_eq!(convert("b.msh", Format::Sms2dm, "b.2dm"), [""; 0]);
            assert_eq!(values("b.2dm"), [("z".to_owned(), heights.clone())]);
            assert_eq!(convert("b.msh", Format::Adcirc, "b.14"), [""; 0]);
            assert_eq!(folder.text("b.14"), folder.text("a.14"));
            assert_eq!(convert("b.msh", Format::Selafin, "b.slf"), [""; 0]);
            assert_eq!(values("b.slf"), values("a.slf"));
        }
    }
}

#[test]
fn sets_of_an_input_file_of_abaqus_are_the_groups_of_a_mesh() {
    let (inp, lost) = converted("in.msh", GMSH, Format::Abaqus);
    assert!(
        lost.starts_with("groups of surfaces (entity)") || lost.contains("data of elements: e"),
        "{lost}"
    );
    let expected = "*HEADING\nmesh\n*NODE\n1, 0.0, 0.0, 0.5\n2, 1.0, 0.0, 1.0\n3, 1.0, 1.0, 1.0\n4, 0.0, 1.0, 1.0\n5, 0.5, 0.5, 1.0\n\
        6, 2.0, 0.5, 1.0\n*ELEMENT, TYPE=T3D2\n1, 1, 2\n2, 2, 3\n3, 3, 4\n4, 4, 1\n\
        *ELEMENT, TYPE=S3\n5, 1, 2, 5\n6, 2, 3, 5\n7, 3, 4, 5\n8, 4, 1, 5\n9, 2, 6, 3\n\
        *ELSET, ELSET=in_let\n1\n*ELSET, ELSET=set3\n9\n*ELSET, ELSET=steel\n5, 6, 7, 8\n*ELSET, ELSET=wall\n2, 3, 4\n";
    assert_eq!(inp, expected);
    let exodus = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 0., 1e-7\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*NSET, NSET=\"a b\"\n1, 3\n*NSET, NSET=A_B\n2\n";
    let (inp, lost) = converted("in.inp", exodus, Format::Abaqus);
    assert_eq!(lost, "");
    assert!(
        inp.ends_with(
            "*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*NSET, NSET=a_b_2\n1, 3\n*NSET, NSET=A_B\n2\n"
        ),
        "{inp}"
    );
    let grid = "t\n1 3\n1 0 0 0\n2 -0.0012345678901234567 0 0\n3 0 1 0\n1 3 1 2 3\n";
    let (inp, lost) = converted("fort.14", grid, Format::Abaqus);
    assert!(
        lost.starts_with("digits of coordinates, of which 20 characters are written"),
        "{lost}"
    );
    assert!(inp.contains("\n2, -.001234567890123457, 0.0\n"), "{inp}");
}
