//! The page of a run: its content, and that it loads no other file. CONTRIBUTING.md explains how to test the
//! page in a browser.

use super::{Folder, assert_holds, plate_path, small};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gpu_smooth::{
    Mesh, Topology,
    measure::{Measure, Measured},
};
use serde_json::Value;
use std::fs;

/// Returns the text of the page, and the data drawn by the script.
fn page(folder: &Folder, args: &str) -> (String, Value) {
    page_of(folder, &format!("{args} --engine cpu"))
}

/// Returns the text and the data of the page of any command.
fn page_of(folder: &Folder, args: &str) -> (String, Value) {
    let run = folder.line(&format!("{args} --html page.html"));
    assert_eq!(run.code, Some(0), "{}", run.err);
    let page = folder.text("page.html");
    let data = page.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
    let data = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    (page, data)
}

fn bytes(value: &Value) -> Vec<u8> {
    BASE64_STANDARD.decode(value.as_str().unwrap()).unwrap()
}

fn indices(value: &Value) -> Vec<usize> {
    let word = |four: &[u8]| u32::from_le_bytes(four.try_into().unwrap()) as usize;
    bytes(value).chunks(4).map(word).collect()
}

fn points(value: &Value) -> Vec<[f64; 2]> {
    let number = |eight: &[u8]| f64::from_le_bytes(eight.try_into().unwrap());
    bytes(value).chunks(16).map(|two| [number(&two[..8]), number(&two[8..])]).collect()
}

fn values(value: &Value) -> Vec<f32> {
    let number = |four: &[u8]| f32::from_le_bytes(four.try_into().unwrap());
    bytes(value).chunks(4).map(number).collect()
}

/// Returns the corners of all drawn triangles: before the run for state 0, after the run for state 1.
fn corners(data: &Value, state: usize) -> Vec<[[f64; 2]; 3]> {
    let points = points(&data["states"][state]["points"]);
    let triangles = indices(&data["triangles"]);
    triangles.chunks(3).map(|t| [points[t[0]], points[t[1]], points[t[2]]]).collect()
}

/// Returns the corners of all triangles of a mesh, in counterclockwise order.
fn of_mesh(mesh: &Mesh, topology: &Topology<'_>) -> Vec<[[f64; 2]; 3]> {
    topology.triangles().iter().map(|t| t.map(|v| mesh.points[v as usize])).collect()
}

#[test]
fn the_mesh_of_a_page_is_that_of_the_files() {
    let folder = small();
    let (_, data) = page(&folder, "in out");
    let before = folder.mesh("in");
    let topology = Topology::new(&before).unwrap();
    for (state, name) in ["in", "out"].into_iter().enumerate() {
        let mesh = folder.mesh(name);
        assert_eq!(corners(&data, state), of_mesh(&mesh, &topology), "{name}");
        let measured = Measured::new(&mesh.points, &topology).unwrap();
        for (k, measure) in data["measures"].as_array().unwrap().iter().enumerate() {
            let told = values(&data["states"][state]["values"][k]);
            assert_eq!(told.len(), 160);
            let name: Measure = measure["name"].as_str().unwrap().parse().unwrap();
            for (told, value) in told.into_iter().zip(measured.values(name)) {
                assert!((f64::from(told) - value).abs() <= 1e-7 * value, "{name}: {told}, {value}");
            }
        }
    }
    // The outline has each edge of the boundary once: 36 edges of two indices.
    assert_eq!(indices(&data["boundary"]).len(), 2 * 36);
    assert_eq!(data["states"][0]["pictures"], serde_json::json!([]));
    assert!(indices(&data["pieces"]).is_empty() && data["face"].is_null());
}

#[test]
fn a_page_colors_edges_by_the_measures_that_the_command_line_names() {
    let folder = small();
    let names = |data: &Value| -> Vec<String> {
        let measures = data["measures"].as_array().unwrap().iter();
        measures.map(|measure| measure["name"].as_str().unwrap().to_owned()).collect()
    };
    let usual = ["shape", "min-angle", "max-angle", "size-ratio"];
    let (_, data) = page(&folder, "in out --for dflowfm");
    assert_eq!(names(&data), [&usual[..], &["orthogonality", "flow-link"]].concat());
    assert_eq!(data["first"], 0);
    let before = folder.mesh("in");
    let topology = Topology::new(&before).unwrap();
    for (state, name) in ["in", "out"].into_iter().enumerate() {
        let mesh = folder.mesh(name);
        let edges = Measured::new(&mesh.points, &topology).unwrap().edges();
        let told = &data["states"][state];
        let drawn = points(&told["points"]);
        let ends: Vec<[f64; 2]> = indices(&data["edges"]).into_iter().map(|v| drawn[v]).collect();
        let of_mesh = edges.iter().flat_map(|edge| edge.vertices.map(|v| mesh.points[v as usize]));
        assert_eq!(ends, of_mesh.collect::<Vec<_>>());
        let links: Vec<f32> = edges.iter().map(|edge| edge.flow_link as f32).collect();
        assert_eq!(values(&told["edge_values"][5]), links);
        assert!(values(&told["edge_values"][0]).is_empty());
    }
    let (_, data) = page_of(&folder, "quality in --picture-measure orthogonality");
    assert_eq!((names(&data).len(), &data["first"]), (5, &4.into()));
    let (_, data) = page_of(&folder, "quality in -m skewness,flow-link,smoothness");
    assert_eq!(names(&data)[4..], ["flow-link", "smoothness"]);
    let measured = Measured::new(&before.points, &topology).unwrap();
    let ratios: Vec<f32> = measured.edges().iter().map(|edge| edge.smoothness as f32).collect();
    assert_eq!(values(&data["states"][0]["edge_values"][5]), ratios);
    let (_, data) = page_of(&folder, "quality in");
    assert_eq!((names(&data).len(), indices(&data["edges"]).len()), (4, 0));
}

#[test]
fn a_page_needs_nothing_else_and_tells_all_of_the_run() {
    let folder = small();
    fs::rename(folder.path("in.node"), folder.path("<i>&.node")).unwrap();
    fs::rename(folder.path("in.ele"), folder.path("<i>&.ele")).unwrap();
    let (page, data) = page(&folder, "<i>&.node out --scheme edge+imr --fix-box 0,0,3,3");
    for part in ["http:", "https:", "src=", "@import", "url(", "fetch(", "<i>"] {
        assert!(!page.contains(part), "{part}");
    }
    assert_holds(
        &page,
        &["<!doctype html>", "<h1>&lt;i&gt;&amp;.node</h1>", "prefers-color-scheme: dark"],
    );
    assert_holds(&page, &["width=device-width", "--fix-box 0,0,3,3", "gpu-smooth 0."]);
    let command = page.split("<pre>").nth(1).unwrap().split("</pre>").next().unwrap();
    assert_holds(command, &["gpu-smooth &#39;&lt;i&gt;&amp;.node&#39; out --scheme edge+imr "]);
    assert_holds(
        &page,
        &["0 of 160 triangles are inverted or flat", "vertices that must stay have"],
    );
    for title in ["Mesh", "Worst triangles", "Distribution", "Convergence", "Statistics", "The run"]
    {
        assert_eq!(page.matches(&format!("<h2>{title}</h2>")).count(), 1, "{title}");
    }
    for measure in Measure::ALL {
        match measure.equal_to() {
            None => assert_holds(&page, &[&format!(">{measure}")]),
            Some(twin) => assert_holds(&page, &[&format!("{measure} equals {twin}")]),
        }
    }
    // Each link leads to the triangle shown by its picture.
    let links = page.matches("<a href=\"#spot-").count();
    let spots = data["spots"].as_array().unwrap();
    assert!(links == spots.len() && links >= 16, "{links}");
    for (i, spot) in spots.iter().enumerate() {
        let state = spot["state"].as_u64().unwrap() as usize;
        let corners = corners(&data, state)[spot["element"].as_u64().unwrap() as usize];
        let middle =
            [0, 1].map(|axis| corners.iter().map(|corner| corner[axis] / 3.0).sum::<f64>());
        for axis in 0..2 {
            assert!((spot["at"][axis].as_f64().unwrap() - middle[axis]).abs() < 1e-12);
        }
        assert_holds(&page, &[&format!("href=\"#spot-{i}\"")]);
    }
}

#[test]
fn histograms_and_curves_are_of_the_run() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    let (page, _) = page(&folder, &format!("{plate} out --report r.json --scheme edge+imr"));
    // In each of the three histograms, the bars before and after count all triangles.
    for state in ["before", "after"] {
        assert_eq!(counted(&page, &format!("\n{state}: ")), 3 * 3735);
    }
    let sweeps = folder.json("r.json")["history"].as_array().unwrap().len();
    let curve = page.split("aria-label=\"f against sweep\"").nth(1).unwrap();
    let points = curve.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
    assert_eq!(points.split_whitespace().count(), sweeps);
    let heights: Vec<f64> =
        points.split_whitespace().map(|p| p.split(',').nth(1).unwrap().parse().unwrap()).collect();
    // y grows downward in SVG: f falls from the top of the plot to its bottom.
    assert!(heights[0] < 30.0 && heights.iter().any(|y| *y > 210.0), "{heights:?}");
    // The x axis is linear.
    let places: Vec<f64> =
        points.split_whitespace().map(|p| p.split(',').next().unwrap().parse().unwrap()).collect();
    let step = (places[sweeps - 1] - places[0]) / (sweeps - 1) as f64;
    assert!(places.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 0.11), "{places:?}");
}

/// Returns the sum of the numbers of elements that follow a text in the titles of bars.
fn counted(page: &str, before: &str) -> usize {
    let titles = page.split("<title>").skip(2).map(|title| title.split('<').next().unwrap());
    let counts = titles.filter_map(|title| title.split(before).nth(1)?.split(" element").next());
    counts.map(|count| count.parse::<usize>().unwrap()).sum()
}

/// The page has each sentence and each value that the terminal has. A row of the worst imr of movable triangles belongs to
/// the row above.
#[test]
fn a_page_has_the_summary_of_the_terminal() {
    let folder = small();
    let run = folder.line("in out --engine cpu --fix-box 0,0,4,4 --html page.html");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let page = folder.text("page.html");
    assert_holds(&run.out, &["\n  of movable ", "\nvertices moved "]);
    assert_holds(&page, &["<th class=\"under\">of movable</th>"]);
    let times = |line: &&str| !line.starts_with("read ");
    for line in run.out.lines().filter(times) {
        // Columns are apart by several blanks, sentences have none.
        for part in line.split("  ").filter(|part| !part.is_empty()) {
            let part = part.trim().replace('"', "&quot;").replace('\'', "&#39;");
            assert!(page.contains(&format!(">{part}<")), "{part} of {line}");
        }
    }
}

/// The legend of a page names what the mesh has.
#[test]
fn the_legend_has_no_symbol_that_the_mesh_lacks() {
    let folder = small();
    let [node, ele] = super::output::INVERTED;
    fs::write(folder.path("bad.node"), node).unwrap();
    fs::write(folder.path("bad.ele"), ele).unwrap();
    let signs = |args: &str| {
        let (page, _) = page_of(&folder, args);
        let keys = page.split("<ul class=\"keys\">").nth(1).unwrap();
        let keys = keys.split("</ul>").next().unwrap();
        let names = keys.split("</span>").skip(1).map(|key| key.split('<').next().unwrap());
        names.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(signs("quality in.node --worst 0"), ["boundary"]);
    assert_eq!(signs("quality in.node"), ["boundary", "among the worst"]);
    assert_eq!(signs("quality bad.node --worst 0"), ["boundary", "inverted or flat"]);
    assert_eq!(signs("in out --engine cpu"), ["boundary", "among the worst"]);
    let fixed = signs("in out --engine cpu --force --fix-box 2,2,3,3");
    assert_eq!(fixed, ["boundary", "fixed vertex inside", "among the worst"]);
}

/// The box at the pointer has the ids of the file.
#[test]
fn a_page_has_the_numbers_that_the_file_gives_to_triangles() {
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.6 0.5 0\n";
    let triangles = "7 2 2 1 1 1 2 5\n8 2 2 1 1 2 3 5\n90 2 2 1 1 3 4 5\n12 2 2 1 1 4 1 5\n";
    let mesh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{nodes}$EndNodes\n$Elements\n4\n{triangles}$EndElements\n"
    );
    let folder = Folder::new(&[("in.msh", &*mesh)]);
    let (_, data) = page(&folder, "in.msh out.msh");
    assert_eq!(data["ids"], serde_json::json!([[0, 7], [2, 90], [3, 12]]));
}

#[test]
fn a_mesh_that_was_tangled_is_shown_as_it_was() {
    let [node, ele] = super::output::INVERTED;
    let folder = Folder::new(&[("in.node", node), ("in.ele", ele)]);
    let (_, data) = page(&folder, "in out --untangle");
    // The value of an inverted triangle is not a number.
    let bad = |state: usize| {
        let values = values(&data["states"][state]["values"][0]);
        values.iter().filter(|value| value.is_nan()).count()
    };
    assert_eq!([bad(0), bad(1)], [1, 0]);
}

#[test]
fn a_page_without_a_run_shows_one_mesh() {
    let folder = small();
    let before = folder.content().len();
    let (page, data) = page_of(&folder, "quality in.node --worst 7 -m min-angle,skewness");
    assert_eq!(folder.content().len(), before + 1, "the page is the only new file");
    let mesh = folder.mesh("in");
    let topology = Topology::new(&mesh).unwrap();
    assert_eq!(data["states"].as_array().unwrap().len(), 1);
    assert_eq!(corners(&data, 0), of_mesh(&mesh, &topology));
    // One view, and nothing of a run.
    assert_eq!(page.matches("<canvas").count(), 1);
    for word in ["before", "after the run", "that slid", "both views", "Convergence"] {
        let body = page.split("<main>").nth(1).unwrap().split("<script").next().unwrap();
        assert!(!body.contains(word), "{word}");
    }
    for part in ["http:", "https:", "src=", "@import", "url(", "fetch("] {
        assert!(!page.contains(part), "{part}");
    }
    assert_holds(&page, &["<h1>in.node</h1>", "99 vertices (63 free), 160 triangles"]);
    // The worst triangles of the page are those of the report.
    let told = folder.line("quality in.node --worst 7 -m min-angle,skewness --json").clean().out;
    let told: Value = serde_json::from_str(&told).unwrap();
    let list = page.split("The worst by min-angle").nth(1).unwrap();
    for (i, worst) in told["worst"].as_array().unwrap().iter().enumerate() {
        assert_holds(list, &[&format!("href=\"#spot-{i}\"")]);
        assert_holds(list, &[&format!(">{}</a>", worst["triangle"])]);
    }
    assert_eq!(list.matches("href=\"#spot-").count(), 7);
    assert_eq!(page.matches("<svg").count(), 2);
    assert_eq!(counted(&page, "\n"), 2 * 160);
    let statistics = page.split("<h2>Statistics</h2>").nth(1).unwrap();
    assert_eq!(statistics.matches("<tr>").count(), 3, "a head and two measures");
}

#[test]
fn a_page_of_several_meshes_has_an_overview_and_a_picture_of_each() {
    let folder = small();
    folder.line("in out --engine cpu").clean();
    let run = folder.line("quality out.node in.node none.node --html page.html");
    assert_eq!(run.code, Some(3));
    assert_holds(&run.err, &["none.node: "]);
    let page = folder.text("page.html");
    assert_holds(&page, &["<h1>Quality of 2 meshes</h1>", "<h2>in.node</h2>", "<h2>out.node</h2>"]);
    assert_eq!(page.matches("<img src=\"data:image/png;base64,").count(), 2);
    assert!(!page.contains("<canvas") && !page.contains("#spot-"), "there is no viewer");
    // The overview is the first section, and has the worse mesh first, with links to the sections.
    let overview = page.split("<section").nth(1).unwrap();
    assert_holds(overview, &["<h2>Overview</h2>", "<td data-key=\"-160\">160</td>"]);
    let [first, second] = ["<a href=\"#mesh-2\">in.node</a>", "<a href=\"#mesh-1\">out.node</a>"]
        .map(|a| overview.find(a));
    assert!(first.is_some() && first < second, "{overview}");
    assert_holds(
        &page,
        &["<section id=\"mesh-1\"><h2>out.node", "<section id=\"mesh-2\"><h2>in.node"],
    );
    let own = Measure::ALL.iter().filter(|measure| measure.equal_to().is_none()).count();
    assert_eq!(overview.matches("<th data-sort=\"number\"").count(), 2 + own);
    let told: Value =
        serde_json::from_str(&folder.line("quality in.node --json").clean().out).unwrap();
    let worst = told["min_angle"].as_f64().unwrap_or_else(|| panic!("{told}"));
    assert_holds(overview, &[&format!("<td data-key=\"{worst}\">")]);
    // Each section has the statistics of its mesh.
    assert_eq!(page.matches("aria-label=\"statistics\"").count(), 2);
}

#[test]
fn pages_that_would_replace_something_are_refused() {
    let folder = small();
    fs::write(folder.path("other.html"), "old\n").unwrap();
    for (options, part) in [
        ("--html page.txt", "page.txt: a page is HTML. End its name in .html"),
        ("--html page", "End its name in .html"),
        ("--html r.html --report r.html", "r.html: the page would replace this file"),
    ] {
        folder.line(&format!("in out {options}")).misused(&[part]);
        assert!(!folder.path("out.node").exists());
    }
    folder.line("quality in --html page.txt").misused(&["a page is HTML"]);
    folder.line("quality in --html in.node").misused(&["in.node"]);
    folder.line("in out --html none/page.html").refused(&["the page cannot be written"]);
    assert!(!folder.path("out.node").exists());
    let run = folder.line("in.node other --out-dir d --html page.html");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["--html"]);
}

/// A square of 4 triangles, with two quadrilaterals on its right and one inner vertex between them.
pub(crate) const MIXED: &str = "OFF\n9 6 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n0.5 1.2 0\n4 0 0\n4 2 0\n2 4 0\n0 4 0\n\
    3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n4 1 5 6 2\n4 3 2 7 8\n";

#[test]
fn a_page_shows_kept_quadrilaterals_beside_the_triangles() {
    let folder = Folder::new(&[("in.off", MIXED)]);
    let (of_run, run) = page(&folder, "in.off out.off --quadrilaterals keep");
    let (of_mesh, mesh) = page_of(&folder, "quality in.off --quadrilaterals keep");
    for (page, data) in [(of_run, run), (of_mesh, mesh)] {
        assert_holds(
            &page,
            &["fixed quadrilateral</li>", "All 4 triangles and 2 fixed quadrilaterals."],
        );
        assert_eq!(data["face"], "fixed quadrilateral");
        let points = points(&data["states"][0]["points"]);
        let corners: Vec<[f64; 2]> =
            indices(&data["pieces"]).into_iter().map(|v| points[v]).collect();
        let area = |t: &[[f64; 2]]| {
            let [p, q, r] = [t[0], t[1], t[2]];
            0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs()
        };
        assert_eq!(corners.chunks(3).map(area).sum::<f64>(), 8.0);
        assert_eq!(data["extent"], serde_json::json!([[0.0, 0.0], [4.0, 4.0]]));
        // The boundary has no edge between a triangle and a quadrilateral.
        let boundary: Vec<[f64; 2]> =
            indices(&data["boundary"]).into_iter().map(|v| points[v]).collect();
        let middles: Vec<[f64; 2]> = boundary
            .chunks(2)
            .map(|e| [0, 1].map(|axis| (e[0][axis] + e[1][axis]) / 2.0))
            .collect();
        assert_eq!(middles.len(), 8);
        assert!(!middles.contains(&[2.0, 1.0]) && !middles.contains(&[1.0, 2.0]), "{middles:?}");
        assert!(indices(&data["held"]).is_empty());
    }
}

/// Two rules of axe-core, the checker of accessibility: `scrollable-region-focusable` and `empty-table-header`.
#[test]
fn keys_reach_wide_tables_and_each_column_has_a_header() {
    let folder = small();
    let (of_run, _) = page(&folder, "in out");
    let (of_mesh, _) = page_of(&folder, "quality in.node");
    folder.line("quality in.node out.node --html page.html").clean();
    for page in [of_run, of_mesh, folder.text("page.html")] {
        assert!(!page.contains("<th></th>"), "a header is empty");
        let wide: Vec<&str> = page
            .split("<div class=\"wide\"")
            .skip(1)
            .map(|tag| tag.split('>').next().unwrap())
            .collect();
        assert!(!wide.is_empty());
        for tag in wide {
            assert_holds(tag, &["tabindex=\"0\"", "role=\"group\"", "aria-label=\""]);
        }
    }
}
