//! Sliding on periodic models (`--slide`): the vertices of a pair slide together.

use super::{Folder, assert_holds, number, slide};
use gpu_smooth::Mesh;

/// Returns a mesh of 9 by 5 vertices, with two triangles per cell, and its materials. Vertices of the left and right
/// sides have equal heights.
fn channel() -> (Mesh, Vec<i32>) {
    let (mut mesh, materials) = slide::square();
    for row in 0..5 {
        mesh.points[9 * row + 8][1] = mesh.points[9 * row][1];
    }
    (mesh, materials)
}

fn rows<'a, T: 'a>(items: impl IntoIterator<Item = T>, row: impl Fn(T) -> String) -> String {
    items.into_iter().map(row).collect()
}

/// A mesh as a file of gmsh 2.2, with a section of periodic pairs.
fn gmsh2(mesh: &Mesh, pairs: &str) -> String {
    let nodes = rows(mesh.points.iter().zip(1..), |([x, y], tag)| format!("{tag} {x:?} {y:?} 0\n"));
    let elements = rows(mesh.triangles.iter().zip(1..), |([a, b, c], tag)| {
        format!("{tag} 2 2 1 1 {} {} {}\n", a + 1, b + 1, c + 1)
    });
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{elements}$EndElements\n{pairs}",
        mesh.points.len(),
        mesh.triangles.len(),
    )
}

/// A mesh as a file of gmsh 4.0 or 4.1, with a section of periodic pairs.
fn gmsh4(mesh: &Mesh, version: &str, pairs: &str) -> String {
    let (n, m) = (mesh.points.len(), mesh.triangles.len());
    let row = |([x, y], tag): (&[f64; 2], i32)| match version {
        "4.0" => format!("{tag} {x:?} {y:?} 0\n"),
        _ => format!("{x:?} {y:?} 0\n"),
    };
    let tags = if version == "4.0" { String::new() } else { rows(1..=n, |tag| format!("{tag}\n")) };
    let nodes = rows(mesh.points.iter().zip(1..), row);
    let elements = rows(mesh.triangles.iter().zip(1..), |([a, b, c], tag)| {
        format!("{tag} {} {} {}\n", a + 1, b + 1, c + 1)
    });
    let (counts, block) = match version {
        "4.0" => (format!("1 {n}"), format!("1 2 0 {n}")),
        _ => (format!("1 {n} 1 {n}"), format!("2 1 0 {n}")),
    };
    let (all, part) = match version {
        "4.0" => (format!("1 {m}"), format!("1 2 2 {m}")),
        _ => (format!("1 {m} 1 {m}"), format!("2 1 2 {m}")),
    };
    format!(
        "$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$Nodes\n{counts}\n{block}\n{tags}{nodes}$EndNodes\n$Elements\n{all}\n{part}\n{elements}$EndElements\n{pairs}"
    )
}

/// Returns a mesh as a binary file of gmsh 4.1. Each pair has the image vertex first and its master vertex second.
fn binary41(mesh: &Mesh, motion: &[f64], pairs: &[[u64; 2]]) -> Vec<u8> {
    let mut file = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec();
    let put = |file: &mut Vec<u8>, sizes: &[u64]| {
        sizes.iter().for_each(|size| file.extend(size.to_le_bytes()));
    };
    let ints = |file: &mut Vec<u8>, ints: &[i32]| {
        ints.iter().for_each(|int| file.extend(int.to_le_bytes()));
    };
    let (n, m) = (mesh.points.len() as u64, mesh.triangles.len() as u64);
    put(&mut file, &[1, n, 1, n]);
    ints(&mut file, &[2, 1, 0]);
    put(&mut file, &[n]);
    put(&mut file, &(1..=n).collect::<Vec<_>>());
    for [x, y] in &mesh.points {
        [*x, *y, 0.0].iter().for_each(|x| file.extend(x.to_le_bytes()));
    }
    file.extend(b"\n$EndNodes\n$Elements\n");
    put(&mut file, &[1, m, 1, m]);
    ints(&mut file, &[2, 1, 2]);
    put(&mut file, &[m]);
    for (t, tag) in mesh.triangles.iter().zip(1..) {
        put(&mut file, &[tag, u64::from(t[0]) + 1, u64::from(t[1]) + 1, u64::from(t[2]) + 1]);
    }
    file.extend(b"\n$EndElements\n$Periodic\n");
    put(&mut file, &[1]);
    ints(&mut file, &[1, 2, 4]);
    put(&mut file, &[motion.len() as u64]);
    motion.iter().for_each(|x| file.extend(x.to_le_bytes()));
    put(&mut file, &[pairs.len() as u64]);
    put(&mut file, pairs.as_flattened());
    file.extend(b"\n$EndPeriodic\n");
    file
}

/// Returns the pairs of the channel's left and right sides, as tags counted from 1.
fn sides() -> Vec<[u64; 2]> {
    (0..5).map(|row| [9 * row + 9, 9 * row + 1]).collect()
}

const MOTION: &str = "1 0 0 8 0 1 0 0 0 0 1 0 0 0 0 1";

/// Returns a `$Periodic` section in the syntax of gmsh 4.1, or of the versions before.
fn section(version: &str, with_motion: bool, pairs: &[[u64; 2]]) -> String {
    let motion = match (version, with_motion) {
        ("4.1", true) => format!("16 {MOTION}\n"),
        ("4.1", false) => "0\n".to_owned(),
        (_, true) => format!("Affine {MOTION}\n"),
        (_, false) => String::new(),
    };
    let list = rows(pairs, |[a, b]| format!("{a} {b}\n"));
    format!("$Periodic\n1\n1 2 4\n{motion}{}\n{list}$EndPeriodic\n", pairs.len())
}

fn write(folder: &Folder, name: &str, content: impl AsRef<[u8]>) {
    std::fs::write(folder.path(name), content).unwrap();
}

/// Checks that the vertices of each pair slide together in a run, and that `compare` proves the pairs.
fn slides_together(folder: &Folder, mesh: &str, pairs: usize, options: &str) {
    let out = format!("out-{mesh}");
    let line = format!("{mesh} {out} --engine cpu --slide {options} --report r.json");
    let run = folder.line(&line);
    assert_eq!(run.code, Some(0), "{mesh}: {}", run.err);
    assert_holds(&run.err, &[&format!("{} of them in {pairs} periodic pairs", 2 * pairs)]);
    assert_holds(&run.out, &[&format!("{pairs} periodic pairs together")]);
    let report = folder.json("r.json");
    assert_eq!(report["slid"]["pairs"], pairs, "{mesh}");
    assert_eq!(report["certificate"]["fixed_moved"], 0, "{mesh}");
    assert!(number(&report["after"]["f"]["imr"]) < number(&report["before"]["f"]["imr"]));
    let compared = folder.line(&format!("compare {mesh} {out} --slide {options}")).clean();
    assert_holds(&compared.out, &[&format!("{pairs} periodic pairs of them together")]);
}

#[test]
fn partners_of_a_translation_slide_together_in_all_forms_of_gmsh() {
    let (mesh, _) = channel();
    let pairs = sides();
    let motion: Vec<f64> = MOTION.split(' ').map(|x| x.parse().unwrap()).collect();
    let folder = Folder::new(&[]);
    for with_motion in [true, false] {
        write(&folder, "2.msh", gmsh2(&mesh, &section("2.2", with_motion, &pairs)));
        write(&folder, "40.msh", gmsh4(&mesh, "4.0", &section("4.0", with_motion, &pairs)));
        write(&folder, "41.msh", gmsh4(&mesh, "4.1", &section("4.1", with_motion, &pairs)));
        let motion = if with_motion { &motion[..] } else { &[] };
        write(&folder, "b.msh", binary41(&mesh, motion, &pairs));
        for mesh in ["2.msh", "40.msh", "41.msh", "b.msh"] {
            slides_together(&folder, mesh, 3, "");
        }
    }
    // `compare` must notice if one vertex of a pair returns to its old position.
    let text = folder.text("out-2.msh");
    let was = folder.text("2.msh");
    let own = |text: &str| text.lines().find(|row| row.starts_with("18 8")).unwrap().to_owned();
    write(&folder, "spoiled.msh", text.replace(&own(&text), &own(&was)));
    folder
        .line("compare 2.msh spoiled.msh --slide")
        .refused(&["1 vertex has moved that must not", "vertex 10"]);
}

#[test]
fn pairs_that_make_no_sense_stay_and_nothing_else_is_harmed() {
    let (mut mesh, _) = channel();
    // Moves one vertex of a pair along its side by a tenth of an edge.
    mesh.points[9 * 2 + 8][1] += 0.1;
    let folder = Folder::new(&[]);
    let run = |pairs: &[[u64; 2]], told: &[&str]| {
        write(&folder, "in.msh", gmsh2(&mesh, &section("2.2", false, pairs)));
        let run = folder.line("in.msh out.msh --engine cpu --slide");
        assert_eq!(run.code, Some(0), "{pairs:?}: {}", run.err);
        assert_holds(&run.err, told);
        folder.line("compare in.msh out.msh --slide").clean();
    };
    // The neighbors of this vertex are paired with no neighbors of its partner.
    run(&sides(), &["--slide: 14 vertices", "1 pair stays"]);
    // A vertex paired with itself, a vertex in three pairs, a vertex inside, and vertices that do not exist.
    run(&[[10, 10]], &["--slide: 19 vertices"]);
    run(&[[10, 18], [18, 28], [28, 10]], &["--slide: 17 vertices"]);
    run(&[[10, 12]], &["--slide: 19 vertices"]);
    run(&[[10, 99], [18, u64::MAX]], &["does not list do not slide: 2", "--slide: 18 vertices"]);
    for broken in ["$Periodic\n1\n1 2 4\n3\n9 1\n$EndPeriodic\n", "$Periodic\nx\n$EndPeriodic\n"] {
        write(&folder, "in.msh", gmsh2(&mesh, broken));
        let run = folder.line("in.msh out.msh --engine cpu --slide");
        assert_holds(&run.err, &["the boundary stays fixed, as the model is periodic"]);
    }
}

/// The channel as a file of SU2.
fn su2(mesh: &Mesh, rest: &str) -> String {
    let points = rows(&mesh.points, |[x, y]| format!("{x:?} {y:?}\n"));
    let triangles = rows(&mesh.triangles, |[a, b, c]| format!("5 {a} {b} {c}\n"));
    let (n, m) = (mesh.points.len(), mesh.triangles.len());
    format!("NDIME= 2\nNELEM= {m}\n{triangles}NPOIN= {n}\n{points}{rest}")
}

fn marker(name: &str, vertices: &[usize]) -> String {
    let edges = rows(vertices.windows(2), |pair| format!("3 {} {}\n", pair[0], pair[1]));
    format!("MARKER_TAG= {name}\nMARKER_ELEMS= {}\n{edges}", vertices.len() - 1)
}

#[test]
fn pairs_of_su2_are_found_by_its_motions_or_between_markers() {
    let (mesh, _) = channel();
    let [left, right] = [0, 8].map(|column| (0..5).map(|row| 9 * row + column).collect::<Vec<_>>());
    let markers = format!("NMARK= 2\n{}{}", marker("left", &left), marker("right", &right));
    let motion = |k: u32, along: &str| {
        format!(
            "PERIODIC_INDEX= {k}\nPERIODIC_CENTER= 0.0 0.0 0.0\nPERIODIC_ROTATION= 0.0 0.0 0.0\nPERIODIC_TRANSLATION= {along}\n"
        )
    };
    let listed = |along: &str| format!("NPERIODIC= 2\n{}{}", motion(0, "0 0 0"), motion(1, along));
    let folder = Folder::new(&[
        ("markers.su2", &su2(&mesh, &markers)),
        ("one.su2", &su2(&mesh, "NPERIODIC= 1\n")),
        ("two.su2", &su2(&mesh, "NMARK= 0\nNPERIODIC= 2\n")),
        ("listed.su2", &su2(&mesh, &listed("8.0\t0.0\t0.0"))),
        ("other.su2", &su2(&mesh, &listed("7.0 0.0 0.0"))),
    ]);
    slides_together(&folder, "markers.su2", 3, "--periodic left,right");
    slides_together(&folder, "markers.su2", 3, "--periodic right,left");
    slides_together(&folder, "listed.su2", 3, "");
    let run = folder.line("one.su2 out.su2 --engine cpu --slide --force");
    assert_holds(&run.err, &["--slide: 20 vertices"]);
    for unknown in ["two.su2", "other.su2"] {
        let run = folder.line(&format!("{unknown} out.su2 --engine cpu --slide --force"));
        assert_holds(
            &run.err,
            &["no vertex can slide", "the boundary stays fixed, as the model is periodic"],
        );
    }
    for (names, told) in [
        ("left", "two groups are needed"),
        ("left,middle", "`gpu-smooth groups` lists"),
        ("left,left", "no translation or rotation"),
    ] {
        let line = format!("markers.su2 out.su2 --engine cpu --slide --force --periodic {names}");
        let run = folder.line(&line);
        assert!(run.code != Some(0), "{names}");
        assert_holds(&run.err, &[told]);
    }
}

#[test]
fn a_file_of_gmsh_without_pairs_slides_as_ever() {
    let (mesh, _) = channel();
    let folder = Folder::new(&[("in.msh", &gmsh2(&mesh, "$Periodic\n0\n$EndPeriodic\n"))]);
    let run = folder.line("in.msh out.msh --engine cpu --slide");
    assert_holds(&run.err, &["--slide: 20 vertices on the boundary and other lines may slide"]);
    assert!(!run.err.contains("periodic"), "{}", run.err);
}

/// The sides of the square are free of lines, so their vertices slide, and both vertices of a pair have other neighbors.
#[test]
fn partners_of_a_zone_of_cgns_slide_together() {
    let folder = Folder::new(&[]);
    let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/../mesh-io/tests/formats/h5");
    std::fs::copy(format!("{samples}/periodic.cgns"), folder.path("in.cgns")).unwrap();
    slides_together(&folder, "in.cgns", 2, "");
}
