//! Runs with `--slide` on random meshes: the exit code does not depend on `--report`, and `compare` proves each result.

use super::Folder;
use support::SplitMix64;

/// Returns a random mesh with curved sides as a file of VTK: a lattice with displaced vertices, of doubles or floats, in the
/// plane of x and y or in a tilted one, sometimes of two parts that touch. The second result is true for a tilted plane.
fn random(random: &mut SplitMix64) -> (String, bool) {
    let (columns, rows) = (4 + random.range(0.0, 8.0) as u32, 3 + random.range(0.0, 5.0) as u32);
    let bends = [0; 4].map(|_| random.range(0.0, 0.5));
    let noise = random.range(0.0, 0.35);
    let (scale, away) =
        (10_f64.powf(random.range(-4.0, 4.0)), 10_f64.powf(random.range(-2.0, 3.0)));
    let cut = (random.range(0.0, 1.0) < 0.3).then_some(columns / 2);
    let [slope, is_float] = [0; 2].map(|_| random.range(0.0, 1.0) < 0.5);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    // Rows of vertices, with the vertices of the cut twice.
    let places: Vec<u32> =
        (0..=columns).flat_map(|c| vec![c; 1 + usize::from(cut == Some(c))]).collect();
    let width = places.len() as u32;
    for row in 0..=rows {
        let mut last = None;
        for (k, &column) in places.iter().enumerate() {
            let mut off = |i: u32, n: u32| {
                if i.is_multiple_of(n) { 0.0 } else { noise * random.range(-1.0, 1.0) }
            };
            let (x, y) =
                (f64::from(column) + off(column, columns), f64::from(row) + off(row, rows));
            let at = [
                x + bends[0] * (bends[1] * 4.0 * y).sin(),
                y + bends[2] * (bends[3] * 4.0 * x).sin(),
            ];
            let at = if Some(column) == cut { *last.get_or_insert(at) } else { at };
            points.push(at.map(|x| scale * (x + away)));
            if row < rows && (k as u32) < width - 1 && places[k + 1] != column {
                let a = row * width + k as u32;
                triangles.extend([[a, a + 1, a + width + 1], [a, a + width + 1, a + width]]);
            }
        }
    }
    let number = |x: f64| if is_float { (x as f32).to_string() } else { x.to_string() };
    let (cosine, sine) = if slope { (0.8, 0.6) } else { (1.0, 0.0) };
    let point = |&[x, y]: &[f64; 2]| [x, cosine * y, sine * y].map(number).join(" ") + "\n";
    let points_text: String = points.iter().map(point).collect();
    let triangle = |[a, b, c]: &[u32; 3]| format!("3 {a} {b} {c}\n");
    let cells: String = triangles.iter().map(triangle).collect();
    let (kind, count) = (if is_float { "float" } else { "double" }, triangles.len());
    let text = format!(
        "# vtk DataFile Version 3.0\nrandom\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} {kind}\n{points_text}\
         CELLS {count} {}\n{cells}CELL_TYPES {count}\n{}",
        points.len(),
        4 * count,
        "5\n".repeat(count)
    );
    (text, slope)
}

/// Returns random options of a run, and those that `compare` takes too.
fn options(random: &mut SplitMix64) -> [String; 2] {
    let mut pick = |of: &[&str]| of[random.below(of.len())].to_owned();
    let curves = ["--corner-angle 60", "--corner-angle 20", "", ""];
    let bounds = ["--hausdorff 1e-3", "--hausdorff 1", "", ""];
    let slide = format!("--slide {} {}", pick(&curves), pick(&bounds));
    let stages =
        ["--max-move 0.3", "--keep-altitude", "--improve-worst", "--guard worst", "", "", ""];
    let metrics = ["--scheme shape-size", "--scheme rms", "--scheme ar", "", "", ""];
    let sweeps = ["--max-sweeps 4", "--max-sweeps 30", ""];
    [format!("{} {} {}", pick(&stages), pick(&metrics), pick(&sweeps)), slide]
}

#[test]
fn runs_with_and_without_a_report_and_comparisons_agree_on_random_meshes() {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let (first, count) = (
        number("GPU_SMOOTH_RANDOM_SEED").unwrap_or(0),
        number("GPU_SMOOTH_RANDOM_MESHES").unwrap_or(40),
    );
    let mut slid = 0;
    for seed in first..first + count {
        let mut random_numbers = SplitMix64::new(seed);
        let (mesh, is_tilted) = random(&mut random_numbers);
        let [of_run, slide] = options(&mut random_numbers);
        let folder = Folder::new(&[("in.vtk", &mesh)]);
        let line = format!("-q in.vtk --engine cpu {slide} {of_run}");
        let plain = folder.line(&format!("{line} out.vtk"));
        let reported = folder.line(&format!("{line} too.vtk --report r.json"));
        let told = format!("seed {seed}: {line}\n{}", reported.err);
        assert_eq!(plain.code, reported.code, "{told}");
        // Some meshes are refused as inverted.
        if plain.code != Some(0) {
            assert!(reported.err.contains("inverted"), "{told}");
            continue;
        }
        assert!(folder.text("out.vtk") == folder.text("too.vtk"), "{told}");
        let report = folder.json("r.json");
        let moved = report["slid"]["moved"].as_u64().unwrap_or(0);
        slid += u64::from(moved > 0);
        let compared = folder.line(&format!("compare in.vtk out.vtk {slide}"));
        assert_eq!(compared.code, Some(0), "{told}{}", compared.err);
        // In a tilted plane, a short move may round to no move in the file.
        if moved > 1 && !is_tilted {
            assert!(
                compared.out.contains(&format!("{moved} vertices slid")),
                "{told}{}",
                compared.out
            );
        }
    }
    assert!(2 * slid > count, "only {slid} of {count} meshes have vertices that slid");
}
