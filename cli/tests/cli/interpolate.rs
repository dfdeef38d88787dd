//! Vertex data interpolated at moved vertices (`--interpolate`).

use super::{Folder, assert_holds, disturbed, small};
use gpu_smooth::Mesh;
use mesh_io::MeshFile;
use std::fmt::Write;
use std::fs;

/// Returns a depth linear in x and y.
fn depth([x, y]: [f64; 2]) -> f64 {
    2.5 * x - 4.0 * y + 3.0
}

fn gr3(mesh: &Mesh) -> String {
    let mut text = format!("bay\n{} {}\n", mesh.triangles.len(), mesh.points.len());
    for (i, &[x, y]) in mesh.points.iter().enumerate() {
        writeln!(text, "{} {x} {y} {:.16e}", i + 1, depth([x, y])).unwrap();
    }
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        writeln!(text, "{} 3 {} {} {}", i + 1, a + 1, b + 1, c + 1).unwrap();
    }
    text + "0 = Number of open boundaries\n"
}

/// Returns the largest difference between the depths of a file and the linear depth at its vertices.
fn error(folder: &Folder, name: &str) -> f64 {
    let file = MeshFile::read(&folder.path(name)).unwrap();
    let fields = file.point_fields(Some(&["depth".into()])).unwrap();
    let pairs = file.points().iter().zip(fields[0].values());
    pairs.map(|(&point, value)| (depth(point) - value).abs()).fold(0.0, f64::max)
}

/// Constant data remain valid at all positions, so no note may say that they no longer fit.
#[test]
fn equal_depths_are_not_told_as_left_behind() {
    let flat: String = gr3(&disturbed())
        .lines()
        .map(|row| match row.split(' ').collect::<Vec<_>>()[..] {
            [number, x, y, depth] if depth.contains('e') => format!("{number} {x} {y} 2.5\n"),
            _ => format!("{row}\n"),
        })
        .collect();
    let folder = Folder::new(&[("in.gr3", &flat)]);
    assert_eq!(folder.line("convert in.gr3 in.vtk").code, Some(0));
    assert!(folder.line("in.vtk out.vtk --engine cpu").err.contains("`depth` stays as it is"));
    let run = folder.line("in.vtk out.vtk --engine cpu --interpolate all");
    let none =
        "gpu-smooth: no data of the mesh differ from vertex to vertex: nothing to interpolate\n";
    assert_eq!((run.code, run.err.as_str()), (Some(0), none));
}

#[test]
fn depths_stay_as_they_are_unless_they_are_to_come_along() {
    let folder = Folder::new(&[("in.gr3", &gr3(&disturbed()))]);
    let kept = folder.line("in.gr3 kept.gr3 --engine cpu");
    let note = "gpu-smooth: `depth` stays as it is and no longer fits where vertices have moved \
                (--interpolate depth takes it to the new places)\n";
    assert_eq!((kept.code, kept.err.as_str()), (Some(0), note));
    assert!(error(&folder, "kept.gr3") > 0.1);
    folder.line("compare in.gr3 kept.gr3").clean();

    for names in ["depth", "all", "depth,depth"] {
        let run = folder
            .line(&format!("in.gr3 out.gr3 --engine cpu --report r.json --interpolate {names}"));
        assert_eq!(run.code, Some(0));
        assert!(
            run.err.starts_with("gpu-smooth: interpolated where 63 vertices have moved: depth\n")
        );
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
        assert!(error(&folder, "out.gr3") < 1e-12);
        let told = folder.json("r.json")["interpolated"].to_string();
        assert_holds(&told, &["63 vertices", "depth"]);
    }
    let out = folder.line("compare in.gr3 out.gr3 --interpolate depth").clean().out;
    assert_holds(&out, &["depth differs only at vertices that have moved"]);
    let remedy = "give --interpolate depth here too";
    let told = folder.line("compare in.gr3 out.gr3").refused(&[remedy]).err;
    // The message shows both numbers that differ, though the lines are longer than a message quotes.
    let (old, new) = (folder.text("in.gr3"), folder.text("out.gr3"));
    let depths = [old, new].map(|text| {
        let depth = |row: &str| row.rsplit(' ').next().unwrap_or_default().to_owned();
        text.lines().map(depth).collect::<Vec<_>>()
    });
    let at = depths[0].iter().zip(&depths[1]).position(|(old, new)| old != new).unwrap();
    let numbers = format!("`...{}` and `...{}`", depths[0][at], depths[1][at]);
    assert_holds(&told, &[&format!("in.gr3:{}", at + 1), "more than coordinates", &numbers]);
    // Without a remedy where other bytes differ, too.
    fs::write(folder.path("named.gr3"), folder.text("out.gr3").replacen('\n', " \n", 1)).unwrap();
    let told = folder.line("compare in.gr3 named.gr3").refused(&["differ in more than"]).err;
    assert!(!told.contains("--interpolate"), "{told}");
    // Compressed output, and a run without sweeps, which leaves all data unchanged.
    fs::write(folder.path("empty"), "").unwrap();
    folder.run(["in.gr3", "again.gr3.gz", "--engine=cpu", "--interpolate=all", "--quiet"]).clean();
    assert!(error(&folder, "again.gr3.gz") < 1e-12);
    folder.line("in.gr3 same.gr3 --max-sweeps 0 --interpolate all --quiet --engine cpu").clean();
    assert_eq!(folder.text("same.gr3"), folder.text("in.gr3"));
}

#[test]
fn compare_finds_interpolated_data_that_are_wrong() {
    let text = gr3(&disturbed());
    let folder = Folder::new(&[("in.gr3", &text)]);
    folder.line("in.gr3 out.gr3 --engine cpu --quiet --interpolate all").clean();
    let out = folder.text("out.gr3");
    // Spoils the depth of the first vertex, a fixed corner, then that of a vertex inside with a value outside
    // of the range.
    let corner = out.lines().nth(2).unwrap();
    let other = corner.rsplit_once(' ').unwrap().0.to_owned() + " 2.75";
    fs::write(folder.path("corner.gr3"), out.replace(corner, &other)).unwrap();
    folder
        .line("compare in.gr3 corner.gr3 --interpolate depth")
        .refused(&["depth differs at 1 vertex that has not moved"]);
    let inside = out.lines().nth(2 + 35).unwrap();
    let other = inside.rsplit_once(' ').unwrap().0.to_owned() + " 2.75e9";
    fs::write(folder.path("inside.gr3"), out.replace(inside, &other)).unwrap();
    folder
        .line("compare in.gr3 inside.gr3 --interpolate depth")
        .refused(&["1 value of depth outside the range of the old ones"]);
}

#[test]
fn data_that_cannot_be_interpolated_are_refused() {
    let folder = Folder::new(&[("in.gr3", &gr3(&disturbed()))]);
    folder
        .line("in.gr3 out.gr3 --interpolate deep")
        .refused(&["no point data is called 'deep'. There are depth (--interpolate)"]);
    let tangled = gr3(&disturbed()).replacen("\n35 ", "\n35 -9 ", 1);
    fs::write(folder.path("bad.gr3"), tangled).unwrap();
    let run = folder.line("bad.gr3 out.gr3 --untangle --interpolate all --engine cpu");
    assert_eq!(run.code, Some(3));
    assert_holds(&run.err, &["untangle it without --interpolate"]);
    assert!(!folder.path("out.gr3").exists());
    let folder = small();
    let run = folder.line("in.node out.node --interpolate all --engine cpu");
    assert_eq!(run.code, Some(0));
    assert_holds(
        &run.err,
        &["no data of the mesh differ from vertex to vertex: nothing to interpolate"],
    );
    folder.line("in.node out.node --interpolate z").refused(&["The file has no point data"]);
}
