//! The crate `gpu-smooth-job` and the command line write equal files, for each option that changes where vertices go.

use gpu_smooth::layers::KeepLayers;
use gpu_smooth::{Backend, Options};
use gpu_smooth_job::options::{GivenOptions, Kind, OPTIONS, OptionRow};
use gpu_smooth_job::{Job, RunRequest, TargetKind, TargetRequest};
use mesh_io::{MeshFile, ReadOptions};

use super::free_lines::msh;
use super::regions::{folder, halves};
use super::{Folder, disturbed};

/// Returns options of the table that test a row, with the row's option among them; `None` for options that change no file.
fn sample(row: &OptionRow) -> Option<&'static [(&'static str, &'static str)]> {
    Some(match row.name {
        "scheme" => &[("scheme", "edge+imr")],
        "tolerance" => &[("scheme", "rms"), ("tolerance", "1e-4")],
        "fraction" => &[("fraction", "0.9")],
        "desired" => &[("desired", "1.3"), ("fraction", "0.5")],
        "max-sweeps" => &[("max-sweeps", "3")],
        "method" => &[("method", "multilevel")],
        "omega" => &[("omega", "1.2")],
        "inner" => &[("method", "paper"), ("inner", "3")],
        "derivatives" => &[("derivatives", "finite-difference")],
        "edge-norm" => &[("scheme", "edge"), ("edge-norm", "fixed")],
        "guard" => &[("guard", "worst")],
        "improve-worst" => &[("improve-worst", "min-angle")],
        "target-rings" => &[("target-rings", "2")],
        "target-of" => &[("target-of", "place")],
        "surface" => &[("surface", "sphere")],
        "z" => &[("z", "data")],
        "slide" => &[("slide", "true")],
        "corner-angle" => &[("slide", "true"), ("corner-angle", "10")],
        "hausdorff" => &[("slide", "true"), ("hausdorff", "0.01")],
        "free-lines" => &[("free-lines", "true")],
        "only-bad" => &[("only-bad", "1.2")],
        "rings" => &[("only-bad", "1.2"), ("rings", "0")],
        "max-move" => &[("max-move", "0.2")],
        "keep-altitude" => &[("keep-altitude", "true")],
        "untangle" => &[("untangle", "true")],
        "engine" | "adapter" | "time-limit" | "checkpoint-every" | "history" => return None,
        other => panic!("{other} is in the table: add options that test it"),
    })
}

/// Returns the words of a command line that give options of the table.
fn words(options: &[(&str, &str)]) -> String {
    let word = |(name, text): &(&str, &str)| match GivenOptions::row(name).unwrap().kind {
        Kind::Flag(_) => format!("--{name}"),
        _ => format!("--{name}={text}"),
    };
    options.iter().map(word).collect::<Vec<_>>().join(" ")
}

fn toward(job: Job<'_>, kind: TargetKind) -> Job<'_> {
    job.target(TargetRequest { kind, ..TargetRequest::default() })
}

/// Compares the file that a command line writes with that of a job.
fn compare(folder: &Folder, input: &str, words: &str, request: &RunRequest, job: Job<'_>) {
    let output = input.replace("in", "out");
    let line = folder.line(&format!("{input} {output} --engine cpu --force {words}"));
    assert_eq!(line.code, Some(0), "{words}: {}", line.err);
    let options = job.options(request);
    let smoothed = job.smooth(&options, &Backend::Cpu).unwrap();
    let own = input.replace("in", "own");
    smoothed.write(&folder.path(&own)).unwrap();
    let [by_line, by_job] = [output, own].map(|name| std::fs::read(folder.path(&name)).unwrap());
    assert!(by_line == by_job, "{input} {words}: the files differ");
    let options = ReadOptions::new().allow_quadrilaterals_alone(true);
    let points = |name: &str| options.clone().read(&folder.path(name)).unwrap().points().to_vec();
    let [before, after] = [input, &input.replace("in", "out")].map(&points);
    assert_ne!(before, after, "{input} {words}: no vertex has moved");
}

#[test]
fn a_job_and_the_command_line_write_equal_files_by_each_option_of_the_table() {
    let mesh = disturbed();
    let of_regions = support::write_regions(&mesh, &halves(&mesh, [[1, 7], [2, 7]]));
    for (i, row) in OPTIONS.iter().enumerate() {
        let Some(options) = sample(row) else { continue };
        assert!(options.iter().any(|(name, _)| *name == row.name), "{}", row.name);
        // The formats take turns.
        let files = match row.name {
            "free-lines" => &vec![("in.msh", msh(&mesh, true).into_bytes())],
            _ => &of_regions[i % 2],
        };
        let (folder, input) = (folder(files), files[0].0);
        let file = MeshFile::read(&folder.path(input)).unwrap();
        let given = GivenOptions::of(options).unwrap();
        let mut job = match row.name {
            "surface" => Job::on_sphere(&file).unwrap(),
            _ => Job::of_file(&file).unwrap(),
        };
        let mut line = words(options);
        if row.name.starts_with("target") {
            line += " --target keep-shape";
            job = toward(job, TargetKind::KeepShape);
        }
        let job = job.settings(given.settings()).unwrap();
        compare(&folder, input, &line, &given.settings().run, job);
    }
}

#[test]
fn a_job_and_the_command_line_move_and_keep_vertices_of_quadrilaterals() {
    let mut cells = Vec::new();
    let mut points = String::new();
    for v in 0..49_u32 {
        let [x, y] = [f64::from(v % 7), f64::from(v / 7)];
        let is_inner = (1..6).contains(&(v % 7)) && (1..6).contains(&(v / 7));
        let by = if is_inner { 0.2 * f64::from(v * v % 5) - 0.4 } else { 0.0 };
        points += &format!("{} {} 0\n", x + by, y - by / 2.0);
    }
    for corner in (0..42_u32).filter(|corner| corner % 7 < 6) {
        let [a, b, c, d] = [corner, corner + 1, corner + 8, corner + 7];
        match corner % 7 < 3 {
            true => cells.extend([vec![a, b, c], vec![a, c, d]]),
            false => cells.push(vec![a, b, c, d]),
        }
    }
    let text = |cells: &[Vec<u32>]| {
        let rows = cells.iter().map(|cell| {
            let corners = cell.iter().map(u32::to_string).collect::<Vec<_>>();
            format!("{} {}\n", cell.len(), corners.join(" "))
        });
        let kinds = cells.iter().map(|cell| if cell.len() == 3 { "5\n" } else { "9\n" });
        let size: usize = cells.iter().map(|cell| cell.len() + 1).sum();
        format!(
            "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 49 double\n{points}\
             CELLS {} {size}\n{}CELL_TYPES {}\n{}",
            cells.len(),
            rows.collect::<String>(),
            cells.len(),
            kinds.collect::<String>()
        )
    };
    let alone: Vec<Vec<u32>> = cells.iter().filter(|cell| cell.len() == 4).cloned().collect();
    for (cells, is_mixed) in [(&cells, true), (&alone, false)] {
        let folder = Folder::new(&[]);
        std::fs::write(folder.path("in.vtk"), text(cells)).unwrap();
        let options = ReadOptions::new().allow_quadrilaterals_alone(true);
        let file = options.read(&folder.path("in.vtk")).unwrap();
        let request = RunRequest::default();
        let job = || Job::of_file(&file).unwrap();
        assert!(!job().mesh().quadrilaterals.is_empty());
        compare(&folder, "in.vtk", "--quadrilaterals move", &request, job());
        let given = GivenOptions::of(&[("slide", "true")]).unwrap();
        let sliding = || job().settings(given.settings()).unwrap();
        let run = &given.settings().run;
        compare(&folder, "in.vtk", "--quadrilaterals move --slide", run, sliding());
        let on_sphere = Job::on_sphere(&file).unwrap();
        compare(&folder, "in.vtk", "--quadrilaterals move --surface sphere", &request, on_sphere);
        if is_mixed {
            let kept = job().keep_quadrilaterals();
            assert!(kept.mesh().quadrilaterals.is_empty());
            compare(&folder, "in.vtk", "--quadrilaterals keep", &request, kept);
            // Vertices that were fixed before stay, and the options of the mesh hold.
            std::fs::write(folder.path("held.txt"), "15\n").unwrap();
            let kept = sliding().fix(&[15]).unwrap().keep_quadrilaterals();
            let words = "--quadrilaterals keep --slide --fix-vertices held.txt";
            compare(&folder, "in.vtk", words, run, kept);
        }
    }
}

/// A mesh across the date line, and a band around the globe, each of triangles and quadrilaterals.
#[test]
fn a_job_on_the_sphere_keeps_quadrilaterals_as_the_command_line_does() {
    for (columns, first, step) in [(7_u32, 177.0, 1.0), (36, -180.0, 10.0)] {
        let is_closed = columns == 36;
        let mut text = String::new();
        for vertex in 0..7 * columns {
            let (column, row) = (vertex % columns, vertex / columns);
            let by = if (column, row) == (2, 3) { 0.3 * step } else { 0.0 };
            let longitude = first + step * f64::from(column) + by;
            let longitude = if longitude > 180.0 { longitude - 360.0 } else { longitude };
            text += &format!("v {longitude} {} 0\n", 10.0 + f64::from(row));
        }
        for (column, row) in (0..columns).flat_map(|column| (0..6).map(move |row| (column, row))) {
            let at = |c: u32, r: u32| (row + r) * columns + (column + c) % columns + 1;
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            match column {
                6 if !is_closed => {}
                0..4 => text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n"),
                _ => text += &format!("f {a} {b} {c} {d}\n"),
            }
        }
        let folder = folder(&vec![("in.obj", text.into_bytes())]);
        let file = MeshFile::read(&folder.path("in.obj")).unwrap();
        let job = Job::on_sphere(&file).unwrap().keep_quadrilaterals();
        assert!(job.mesh().quadrilaterals.is_empty());
        let words = "--surface sphere --quadrilaterals keep";
        compare(&folder, "in.obj", words, &RunRequest::default(), job);
        let written = MeshFile::read(&folder.path("own.obj")).unwrap();
        assert!(written.points().iter().all(|[longitude, _]| longitude.abs() <= 180.0));
    }
}

#[test]
fn a_job_and_the_command_line_write_equal_files_by_the_options_of_a_mesh() {
    let mesh = disturbed();
    for files in support::write_regions(&mesh, &halves(&mesh, [[1, 7], [2, 7]])).iter().take(2) {
        let (folder, input, request) = (folder(files), files[0].0, RunRequest::default());
        let file = MeshFile::read(&folder.path(input)).unwrap();
        let job = || Job::of_file(&file).unwrap();
        compare(&folder, input, "", &request, job());
        compare(&folder, input, "--free-interfaces", &request, job().free_interfaces());
        let free = job().keep_layers(KeepLayers::None);
        compare(&folder, input, "--keep-layers none", &request, free);
        let of_sizes = toward(job(), TargetKind::KeepSize);
        compare(&folder, input, "--target keep-size", &request, of_sizes);
        std::fs::write(folder.path("held.txt"), "41\n42\n").unwrap();
        let held = job().fix(&[40, 41]).unwrap();
        compare(&folder, input, "--fix-vertices held.txt", &request, held);
    }
}

#[test]
fn without_a_bad_triangle_a_job_and_the_command_line_move_no_vertex() {
    let mesh = disturbed();
    let files = &support::write_regions(&mesh, &halves(&mesh, [[1, 7], [2, 7]]))[0];
    let (folder, input) = (folder(files), files[0].0);
    let line = folder.line(&format!("{input} out.node --engine cpu --only-bad 1e6"));
    assert_eq!(line.code, Some(0), "{}", line.err);
    let given = GivenOptions::of(&[("only-bad", "1e6"), ("slide", "true")]).unwrap();
    let file = MeshFile::read(&folder.path(input)).unwrap();
    let job = Job::of_file(&file).unwrap().settings(given.settings()).unwrap();
    let smoothed = job.smooth(&Options::default(), &Backend::Cpu).unwrap();
    smoothed.write(&folder.path("own.node")).unwrap();
    for own in ["out.node", "own.node"] {
        assert_eq!(folder.text(own), folder.text(input), "{own}");
    }
}

#[test]
fn a_job_untangles_as_the_command_line_does() {
    let mut mesh = disturbed();
    let regions = halves(&mesh, [[1, 7], [2, 7]]);
    mesh.points[41] = mesh.points[43];
    for files in support::write_regions(&mesh, &regions).iter().take(2) {
        let (folder, input) = (folder(files), files[0].0);
        let file = MeshFile::read(&folder.path(input)).unwrap();
        let job = || Job::of_file(&file).unwrap();
        assert!(job().smooth(&Options::default(), &Backend::Cpu).is_err());
        compare(&folder, input, "--untangle", &RunRequest::default(), job().untangle());
    }
}
