//! Unusual layouts of text that the programs of a format read: commas between numbers, items anywhere on lines, rows
//! continued by a backslash. Each layout gives the mesh of the plain layout, and a rewrite changes only moved vertices.

use super::Folder;
use super::facts::{fixed, mesh_of};
use super::long;
use mesh_io::MeshFile;

/// Reads a mesh in a plain and in an odd layout, checks that both meshes are equal, and moves a vertex of the odd file.
#[track_caller]
pub(crate) fn assert_same(name: &str, plain: &str, odd: &str) -> MeshFile {
    assert_ne!(plain, odd);
    let read = |text: &str| {
        let folder = Folder::new(&[(name, text)]);
        let file =
            MeshFile::read(&folder.path(name)).unwrap_or_else(|e| panic!("{e} of {odd:.400}"));
        (folder, file)
    };
    let (_plain, plain) = read(plain);
    let (folder, file) = read(odd);
    assert_eq!(file.format(), plain.format());
    assert!(file.points() == plain.points(), "{odd:.400}");
    assert!(file.triangles() == plain.triangles(), "{odd:.400}");
    assert_eq!((fixed(&file), file.regions()), (fixed(&plain), plain.regions()));
    let groups = |file: &MeshFile| format!("{:?}", file.groups().unwrap());
    assert_eq!(groups(&file), groups(&plain));
    let out = folder.path(&format!("out-{name}"));
    file.write(&out, file.points()).unwrap();
    assert!(std::fs::read_to_string(&out).unwrap() == odd, "{odd:.400}");
    let mut moved = file.points().to_vec();
    moved[2] = [1.062_5, 1.187_5];
    file.write(&out, &moved).unwrap();
    let after = MeshFile::read(&out).unwrap();
    assert!(after.points() == moved, "{odd:.400}");
    assert_eq!(file.difference(&after), None);
    assert_ne!(std::fs::read_to_string(&out).unwrap(), odd);
    file
}

#[track_caller]
pub(crate) fn assert_refused(name: &str, text: &str, parts: &[&str]) {
    let folder = Folder::new(&[(name, text)]);
    let error = MeshFile::read(&folder.path(name)).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "no {part:?} in {error:?}");
    }
}

const GRID: &str = "bay\n2 4\n1 0.0 0.0 1.5\n2 1.0 0.0 2.5\n3 1.0 1.25 0.5\n4 0.0 1.0 0.5\n1 3 1 2 3\n\
2 3 1 3 4\n1 = open boundaries\n2 = nodes\n2 = nodes of the first\n1\n2\n0\n0\n";

/// Returns the text with each row of a node or element changed.
fn rows(text: &str, change: impl Fn(&str) -> String) -> String {
    let is_row = |(line, text): (usize, &str)| match (2..8).contains(&line) {
        true => change(text),
        false => format!("{text}\n"),
    };
    text.lines().enumerate().map(is_row).collect()
}

#[test]
fn grids_are_read_as_fortran_reads_lists() {
    for between in [",", ", ", " ,", " , ", "\t,\t"] {
        assert_same(
            "fort.14",
            GRID,
            &rows(GRID, |row| format!(" {}\n", row.replace(' ', between))),
        );
    }
    let commas =
        rows(GRID, |row| format!("{},\n", row.replace(' ', ","))).replace("\n2 4\n", "\n2,4\n");
    assert_same("a.gr3", GRID, &commas);
    assert_same("a.dat", GRID, &commas);
    // The rest of a line after a slash is ignored.
    let slash = rows(GRID, |row| format!("{row}/ 7 8\n")).replace("\n2 4\n", "\n2 4/ of them\n");
    assert_same("fort.14", GRID, &slash);
    // Rows of several lines, into which programs break long rows.
    for (from, to) in [(" ", "\n "), (" ", ",\n"), (" ", "\r\n"), (".0 ", ".0\n  ")] {
        assert_same("fort.14", GRID, &rows(GRID, |row| format!("{}\n", row.replace(from, to))));
    }
    for number in ["1.25D0", "1.25q+0", "125-002", "+.125+001", "12.5E-1", "1.25+000"] {
        assert_same("fort.14", GRID, &GRID.replace("1.25", number));
    }
    let repeated =
        "fort.14:5: y of node 3 is `2*1.25`, a repeated number. Write each number by itself";
    assert_refused("fort.14", &GRID.replace("1.25", "2*1.25"), &[repeated]);
    // A row with a missing number does not continue in the next row.
    assert_refused(
        "fort.14",
        &GRID.replace("1.25 0.5", "1.25"),
        &["fort.14:5: z of node 3 is missing"],
    );
    assert_refused(
        "fort.14",
        &GRID.replace("1.0 1.25", "1.0,,1.25"),
        &["fort.14:5: y of node 3 is missing"],
    );
}

const MEDIT: &str = "MeshVersionFormatted 2\nDimension 2\nVertices\n4\n0 0 3\n1 0 0\n1 1.25 0\n0 1 0\n\
Triangles\n2\n1 2 3 5\n1 3 4 7\nEdges\n1\n1 2 4\nCorners\n2\n1\n2\nNormals\n1\n0 0\nRequiredTriangles\n1\n2\nEnd\n";

#[test]
fn items_of_medit_stand_anywhere_on_lines() {
    for (from, to) in [
        ("\n", " "),
        (" ", "\n"),
        ("\n", "\r\n\t\r\n"),
        ("0\n", "0 "),
        (" 1.25", "\n\n1.25"),
        ("\n1 ", " 1 "),
        (" ", " # 7 x\n"),
    ] {
        assert_same("a.mesh", MEDIT, &MEDIT.replace(from, to));
    }
    for numbers in ["NaN inf", "1e5 -2D3", "0 0 # Edges", "nan\n7"] {
        assert_same(
            "a.mesh",
            MEDIT,
            &MEDIT.replace("Normals\n1\n0 0", &format!("Normals\n1\n{numbers}")),
        );
    }
    let p2 =
        |keyword: &str, count: u32| MEDIT.replace("Normals\n1\n", &format!("{keyword}\n{count}\n"));
    for keyword in ["TrianglesP2", "EdgesP2", "QuadrilateralsQ2", "TrianglesP3"] {
        let problem =
            format!("a.mesh:21: {keyword} are of higher order, which is not read. Save linear");
        assert_refused("a.mesh", &p2(keyword, 1), &[&problem]);
        assert_same("a.mesh", MEDIT, &p2(keyword, 0).replace("\n0\n0 0\n", "\n0\n"));
        assert_same("a.mesh", MEDIT, &p2(&format!("{keyword}Ordering"), 1));
    }
    assert_refused(
        "a.mesh",
        &p2("TetrahedraP2", 1),
        &["a.mesh:21: TetrahedraP2 make this a volume mesh"],
    );
    for (keyword, count, part) in [
        (24, 1, "elements of higher order (keyword 24), which are not read"),
        (93, 1, "elements of higher order (keyword 93), which are not read"),
        (96, 1, "elements of a volume make this a volume mesh"),
        (24, 0, "it has no list of Vertices"),
    ] {
        let numbers = [1, 2, keyword, 0, count];
        let folder = Folder::new(&[]);
        std::fs::write(folder.path("a.meshb"), numbers.map(i32::to_le_bytes).as_flattened())
            .unwrap();
        let error = MeshFile::read(&folder.path("a.meshb")).unwrap_err().to_string();
        assert!(error.contains(part), "no {part:?} in {error:?}");
    }
    let few =
        "a.mesh:8: `0` stands where a keyword should. Correct the count of the preceding list";
    assert_refused("a.mesh", &MEDIT.replace("Vertices\n4", "Vertices\n3"), &[few]);
    // A single row of the list lacks a number.
    let missing = "a.mesh:7: the reference of a vertex is missing. Correct the line";
    assert_refused("a.mesh", &MEDIT.replace("1.25 0", "1.25"), &[missing]);
}

const OFF: &str = "OFF\n4 2 5\n0 0 0\n1 0 0\n1 1.25 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

#[test]
fn vertices_of_an_off_stand_anywhere_on_lines() {
    for (from, to) in [
        ("0\n1", "0 1"),
        (" 0\n", " 0  "),
        (" ", "\n"),
        ("1 1.25", "1\n\n1.25"),
        ("1 2", "1\n2"),
        (" ", " # of the plane\n"),
        ("OFF\n", ""),
        ("OFF", "off"),
        ("4 2 5", "4 2"),
        ("4 2 5\n0 0 0\n", "4 2 5 0 0 0 "),
    ] {
        assert_same("a.off", OFF, &OFF.replace(from, to).replace("  3 0", "\n3 0"));
    }
    let normals =
        OFF.replace("OFF", "NOFF").replace(" 0\n", " 0 0 0 1 ").replace("1 3 0", "1\n3 0");
    assert_same("a.off", OFF, &OFF.replace("0 1 0\n3", "0 1 0 255 0 0\n3"));
    // Vertices have colors although the header announces none.
    assert_same("a.off", OFF, &OFF.replace(" 0\n", " 0 255 0 0\n"));
    let folder = Folder::new(&[("a.off", &normals), ("b.off", OFF)]);
    assert_eq!(mesh_of(&folder.read("a.off")), mesh_of(&folder.read("b.off")));
    assert_refused("a.off", &OFF.replace("OFF", "4OFF"), &["a.off:1: the header is `4OFF`"]);
}

const FREEFEM: &str = "4 2 1\n0 0 1\n1 0 1\n1 1.25 0\n0 1 2\n1 2 3 5\n1 3 4 7\n1 2 4\n";

#[test]
fn items_of_freefem_stand_anywhere_on_lines() {
    for (from, to) in
        [("1 0 1\n", "1 0 1 "), ("1 1.25", "1\n1.25"), ("5\n1", "5 1"), ("3 5", "3\n5")]
    {
        assert_same("a.msh", FREEFEM, &FREEFEM.replace(from, to));
    }
}

const OBJ: &str =
    "v 0 0 0\nv 1 0 0\nv 1 1.25 0\nv 0 1 0\nusemtl a\ng one two\nf 1 2 3\nusemtl b\nf 1 3 4\n";

#[test]
fn rows_of_an_obj_may_go_on_in_the_next_line() {
    for (from, to) in [
        ("1 1.25", "1 \\\n1.25"),
        ("v 0 1", "v\\\n  0 1"),
        (" 1.25 0", "\\\r\n\t1.25 \\ \n 0"),
        ("f 1 2 3", "f 1/1\\\n \\\n2/2 3 # x"),
        ("one two", "one \\\n two"),
        ("usemtl b\n", "# a \\\n# b\nusemtl b\n"),
        ("f 1 2 3", "fo 1 2 3"),
    ] {
        let file = assert_same("a.obj", OBJ, &OBJ.replace(from, to));
        let lines = to.matches('\n').count().saturating_sub(usize::from(to.ends_with('\n')));
        let place = file.triangle_location(1).to_string();
        assert!(place.contains(&format!("a.obj:{}", 9 + lines)), "{place} of {to}");
    }
    let broken = OBJ.replace("v 1 0 0", "v 1 \\\n 0 x");
    assert_refused("a.obj", &broken, &["a.obj:3: z of a vertex is `x`"]);
}

const SU2: &str = "NDIME= 2\nNELEM= 2\n5 0 1 2\n5 0 2 3\nNPOIN= 4\n0 0\n1 0\n1 1.25\n0 1\nNMARK= 1\n\
MARKER_TAG= shore\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\n";

#[test]
fn comments_of_su2_follow_numbers_at_once() {
    let glued = SU2
        .replace("1 0\n", "1 0%x\n")
        .replace("1.25\n", "1.25%\n")
        .replace("0 1 2\n", "0 1 2%5\n");
    assert_same("a.su2", SU2, &glued);
    assert_same(
        "a.su2",
        SU2,
        &SU2.replace("NPOIN= 4", "NPOIN= 4%points").replace("shore", "shore%x"),
    );
    // Partitioned meshes have a keyword for the exchange between partitions.
    assert_same("a.su2", SU2, &SU2.replace("ELEMS= 2\n", "ELEMS= 2\nSEND_TO= 1\n"));
}

#[test]
fn numbers_of_triangle_may_have_a_comma_behind() {
    const NODE: &str = "4 2 1 0\n1 0 0 7\n2 1 0 7\n3 1 1.25 7\n4 0 1 7\n";
    const ELE: &str = "2 3 1\n1 1 2 3 5\n2 1 3 4 5.0\n";
    let commas = |text: &str| text.replace(' ', ", ");
    let folder = Folder::new(&[
        ("a.node", NODE),
        ("a.ele", ELE),
        ("b.node", &commas(NODE)),
        ("b.ele", &commas(ELE)),
    ]);
    let (plain, file) = (folder.read("a"), folder.read("b"));
    assert_eq!((mesh_of(&file), file.regions()), (mesh_of(&plain), plain.regions()));
    assert_eq!(file.vertex_location(3).id, 4);
    let mut moved = file.points().to_vec();
    moved[2] = [0.5, 0.75];
    file.write(&folder.path("c"), &moved).unwrap();
    assert_eq!(folder.text("c.node"), commas(NODE).replace("3, 1, 1.25", "3, 0.5, 0.75"));
    assert_eq!(folder.text("c.ele"), commas(ELE));
}

/// Long lists with odd rows among plain rows give equal meshes on several threads and on one thread.
#[test]
fn odd_rows_in_long_lists_are_read_in_their_order() {
    let (points, triangles) = (long::points(), long::triangles());
    for every in [1, 7_001, 31_000] {
        let pick = |row: usize, plain: &'static str, odd: &'static str| match row % every {
            0 if row > 0 => odd,
            _ => plain,
        };
        let mut medit =
            format!("MeshVersionFormatted 2\nDimension 2\nVertices\n{}\n", points.len());
        let mut off = format!("OFF\n{} {} 0\n", points.len(), triangles.len());
        let mut grid = format!("t\n{} {}\n", triangles.len(), points.len());
        for (v, [x, y]) in points.iter().enumerate() {
            let [inside, after] = [pick(v + 1, " ", "\n"), pick(v, "\n", " ")];
            medit += &format!("{x:?} {y:?}{inside}0{after}");
            off += &format!("{x:?} {y:?} 0{}", if every == 1 { " " } else { "\n" });
            grid += &format!("{},{x:?}{}{y:?} 0\n", v + 1, pick(v, ",", ",\n"));
        }
        off += "\n";
        medit += &format!("\nTriangles\n{}\n", triangles.len());
        for (t, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| v + 1);
            medit += &format!("{a} {b} {c} 1{}", pick(t, "\n", "  "));
            off += &format!("3 {} {} {}\n", corners[0], corners[1], corners[2]);
            grid += &format!("{},3,{a},{b}{}{c}\n", t + 1, pick(t, " ", "\n"));
        }
        for (name, text) in [("a.mesh", medit + "End"), ("a.off", off), ("fort.14", grid)] {
            let folder = Folder::new(&[(name, &text)]);
            let file = folder.read(name);
            assert!(file.points() == points, "{name} {every}");
            assert!(file.triangles() == triangles, "{name} {every}");
        }
    }
}

/// The next list of a binary Medit file starts within the vertices, so a moved vertex would change the other list.
#[test]
fn lists_of_a_binary_medit_that_share_bytes_are_refused() {
    let file = |next: i32| {
        let x = |x: f32| x.to_bits() as i32;
        let vertices = [[x(0.0), x(0.0), 0], [x(1.0), x(0.0), 0], [x(0.0), x(1.0), 0]];
        let head = [1, 1, 3, 20, 2, 4, next, 3];
        let numbers = [&head[..], vertices.as_flattened(), &[6, 0, 1, 1, 2, 3, 0]].concat();
        let folder = Folder::new(&[]);
        let bytes: Vec<u8> = numbers.into_iter().flat_map(i32::to_le_bytes).collect();
        std::fs::write(folder.path("a.meshb"), bytes).unwrap();
        MeshFile::read(&folder.path("a.meshb")).map(|file| file.points().len())
    };
    assert_eq!(file(68).map_err(|error| error.to_string()), Ok(3));
    for next in [32, 56, 64] {
        let error = file(next).unwrap_err().to_string();
        let problem = format!("the next list is announced at byte {next}, which does not follow");
        assert!(error.contains(&problem), "{error}");
    }
}
