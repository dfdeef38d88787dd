//! Meshes with third coordinates: in planes of any orientation, on curved surfaces, and with z as data.

use super::{Folder, assert_holds, assert_smoothed, disturbed, number};
use gpu_smooth::Mesh;
use mesh_io::{MeshFile, ReadOptions};
use std::fmt::Write;

type Point = [f64; 3];

/// Returns an OBJ of the mesh of [`disturbed`], with vertices where `place` puts them.
fn obj(place: impl Fn([f64; 2]) -> Point) -> String {
    let mesh = disturbed();
    let mut text = String::from("# made for a test\n");
    for [x, y, z] in mesh.points.iter().map(|&point| place(point)) {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

/// Returns the mesh as an STL, with the normal of its plane in each facet.
fn stl(place: impl Fn([f64; 2]) -> Point, [n, m, l]: Point) -> String {
    let mesh = disturbed();
    let mut text = String::from("solid made for a test\n");
    for triangle in &mesh.triangles {
        writeln!(text, "facet normal {n} {m} {l}\nouter loop").unwrap();
        for [x, y, z] in triangle.map(|v| place(mesh.points[v as usize])) {
            writeln!(text, "vertex {x} {y} {z}").unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

/// Returns the vertices of the mesh as a `.node` of three coordinates, and its triangles.
fn node_and_ele(place: impl Fn([f64; 2]) -> Point) -> [String; 2] {
    let mesh = disturbed();
    let mut node = format!("{} 3 0 0\n", mesh.points.len());
    for (v, [x, y, z]) in mesh.points.iter().map(|&point| place(point)).enumerate() {
        writeln!(node, "{v} {x} {y} {z}").unwrap();
    }
    let mut ele = format!("{} 3 0\n", mesh.triangles.len());
    for (t, [a, b, c]) in mesh.triangles.iter().enumerate() {
        writeln!(ele, "{t} {a} {b} {c}").unwrap();
    }
    [node, ele]
}

/// Returns the vertices of a file in space.
fn space(folder: &Folder, name: &str) -> Vec<Point> {
    let file = ReadOptions::new().weld(true).read(&folder.path(name)).unwrap();
    let fields = file.point_fields(Some(&["z".into()])).unwrap();
    let z = fields.iter().find(|field| field.is_third_of_points()).unwrap();
    file.points().iter().zip(z.values()).map(|(&[x, y], &z)| [x, y, z]).collect()
}

/// Returns the vertices by two of their coordinates.
fn by(points: &[Point], axes: [usize; 2]) -> Vec<[f64; 2]> {
    points.iter().map(|point| axes.map(|axis| point[axis])).collect()
}

#[test]
fn a_mesh_in_the_plane_of_any_two_axes_is_smoothed_as_in_x_and_y() {
    let folder = Folder::new(&[
        ("xy.obj", &obj(|[x, y]| [x, y, 5.5])),
        ("xz.obj", &obj(|[x, y]| [x, 5.5, y])),
        ("yz.obj", &obj(|[x, y]| [5.5, x, y])),
    ]);
    folder.line("xy.obj xy_out.obj --engine cpu").clean();
    let expected = by(&space(&folder, "xy_out.obj"), [0, 1]);
    for (name, axes, held, words) in
        [("xz", [0, 2], 1, "the plane of x and z"), ("yz", [1, 2], 0, "the plane of y and z")]
    {
        for ending in ["obj", "vtk", "vtu", "msh", "off", "mesh", "inp", "ply", "exo", "xdmf"] {
            if ending != "obj" {
                folder.line(&format!("convert {name}.obj {name}.{ending}")).clean();
            }
            let line = format!("{name}.{ending} {name}_out.{ending} --engine cpu --report r.json");
            let run = folder.line(&line);
            assert_eq!(run.code, Some(0), "{ending}: {}", run.err);
            assert_holds(&run.err, &[words]);
            assert!(!run.err.contains("z stays"), "{}", run.err);
            let certificate = &folder.json("r.json")["certificate"];
            assert_eq!([&certificate["inverted"], &certificate["fixed_moved"]], [0, 0], "{ending}");
            let after = space(&folder, &format!("{name}_out.{ending}"));
            assert!(after.iter().all(|point| point[held].to_bits() == 5.5_f64.to_bits()));
            assert!(by(&after, axes) == expected, "{ending}");
            folder.line(&format!("compare {name}.{ending} {name}_out.{ending} -q")).clean();
        }
    }
    // Rows of fixed vertices, and all other rows, keep their bytes.
    let (before, after) = (folder.text("xz.obj"), folder.text("xz_out.obj"));
    let same = before.lines().zip(after.lines()).filter(|(a, b)| a == b).count();
    assert!(same > before.lines().count() - 100 && before != after);
}

/// Formats that `convert` does not write with third coordinates.
#[test]
fn an_stl_and_a_node_file_in_the_plane_of_any_two_axes_are_smoothed_as_in_x_and_y() {
    type Place = fn([f64; 2]) -> Point;
    let planes: [(&str, Place, [usize; 2], Point); 3] = [
        ("xy", |[x, y]| [x, y, 5.5], [0, 1], [0.0, 0.0, 1.0]),
        ("xz", |[x, y]| [x, 5.5, y], [0, 2], [0.0, -1.0, 0.0]),
        ("yz", |[x, y]| [5.5, x, y], [1, 2], [1.0, 0.0, 0.0]),
    ];
    let folder = Folder::new(&[]);
    let put = |name: String, text: String| std::fs::write(folder.path(&name), text).unwrap();
    for (name, place, _, normal) in planes {
        put(format!("{name}.stl"), stl(place, normal));
        let [node, ele] = node_and_ele(place);
        put(format!("{name}.node"), node);
        put(format!("{name}.ele"), ele);
    }
    for ending in ["stl", "node"] {
        let mut expected = None;
        for (name, _, axes, normal) in planes {
            let file = format!("{name}.{ending}");
            let line = format!("{file} {name}_out.{ending} --weld --engine cpu --report r.json");
            let run = folder.line(&line);
            assert_eq!(run.code, Some(0), "{file}: {}", run.err);
            assert_eq!(run.err.contains("the mesh lies in the plane of"), name != "xy");
            let certificate = &folder.json("r.json")["certificate"];
            assert_eq!([&certificate["inverted"], &certificate["fixed_moved"]], [0, 0], "{file}");
            let after = space(&folder, &format!("{name}_out.{ending}"));
            let held = (0..3).find(|k| !axes.contains(k)).unwrap();
            assert!(after.iter().all(|point| point[held] == 5.5), "{file}");
            let flat = by(&after, axes);
            assert!(*expected.get_or_insert(flat.clone()) == flat, "{file}");
            folder.line(&format!("compare {file} {name}_out.{ending} --weld -q")).clean();
            // Each facet keeps its normal, which is that of its moved corners by the right-hand rule.
            let text = if ending == "stl" {
                folder.text(&format!("{name}_out.stl"))
            } else {
                String::new()
            };
            for rows in text.lines().skip(1).collect::<Vec<_>>().chunks_exact(7) {
                let numbers = |row: usize| -> Vec<f64> {
                    rows[row].split(' ').filter_map(|word| word.parse().ok()).collect()
                };
                let [a, b, c] = [2, 3, 4].map(numbers);
                let (ab, ac) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
                let across = |k: usize, l: usize| ab[k] * ac[l] - ab[l] * ac[k];
                let across = [across(1, 2), across(2, 0), across(0, 1)];
                let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
                assert_eq!(across.map(|x| x / length), normal, "{rows:?}");
                assert_eq!(numbers(0), normal);
            }
        }
    }
}

/// HDF5 stores the axes of both formats one after another.
#[test]
fn meshes_of_med_and_cgns_in_the_plane_of_x_and_z_are_smoothed_as_in_x_and_y() {
    let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/../mesh-io/tests/formats/h5");
    for ending in ["med", "cgns"] {
        let folder = Folder::new(&[]);
        let [flat, upright] = ["xy", "xz"].map(|name| format!("{name}.{ending}"));
        let sample = std::path::Path::new(samples).join(format!("gmsh.{ending}"));
        std::fs::copy(&sample, folder.path(&flat)).unwrap();
        let file = ReadOptions::new().read(&sample).unwrap();
        let points: Vec<_> = file.points().iter().map(|&[x, _]| [x, 5.5]).collect();
        let mut z = file.point_fields(Some(&["z".into()])).unwrap();
        z[0].set(file.points().iter().map(|point| point[1]).collect()).unwrap();
        file.write_with_fields(&folder.path(&upright), &points, &z).unwrap();
        for (name, is_upright) in [(&flat, false), (&upright, true)] {
            let run = folder.line(&format!("{name} out-{name} --engine cpu --report r.json"));
            assert_eq!(run.code, Some(0), "{}", run.err);
            assert_eq!(run.err.contains("the plane of x and z"), is_upright, "{}", run.err);
            let certificate = &folder.json("r.json")["certificate"];
            assert!(number(&certificate["moved"]) > 5.0, "{certificate}");
        }
        let [flat, upright] = [flat, upright].map(|name| space(&folder, &format!("out-{name}")));
        assert!(by(&flat, [0, 1]) == by(&upright, [0, 2]), "{ending}");
        assert!(upright.iter().all(|point| point[1] == 5.5), "{ending}");
    }
}

#[test]
fn views_of_a_mesh_in_a_plane_name_its_axes() {
    let folder = Folder::new(&[
        ("xy.obj", &obj(|[x, y]| [x, y, 5.5])),
        ("xz.obj", &obj(|[x, y]| [x, 5.5, y])),
        ("yz.obj", &obj(|[x, y]| [5.5, x, y])),
        ("tilted.obj", &obj(tilted)),
    ]);
    for (name, axes, legend) in [
        ("xy", ["x", "y"], None),
        ("xz", ["x", "z"], Some("x to the right, z upward")),
        ("yz", ["y", "z"], Some("y to the right, z upward")),
        ("tilted", ["u", "v"], Some("u to the right, v upward in a tilted plane")),
    ] {
        let [a, b] = axes;
        let run = format!("{name}.obj {name}_out.obj --engine cpu");
        for (line, views) in [(run, 2), (format!("quality {name}.obj"), 1)] {
            let run = folder.line(&format!("{line} --picture p.svg --html p.html"));
            assert_eq!(run.code, Some(0), "{}", run.err);
            let [picture, page] = ["p.svg", "p.html"].map(|file| folder.text(file));
            assert_eq!(picture.matches("upward").count(), legend.map_or(0, |_| views), "{line}");
            assert_eq!(page.contains(" upward"), legend.is_some(), "{line}");
            if let Some(legend) = legend {
                assert!(picture.contains(&format!("; {legend}<")), "{line}");
                assert_holds(&page, &[&format!("Axes: {legend}.")]);
            }
            assert_holds(&page, &[&format!("<th>{a}</th><th>{b}</th>")]);
        }
    }
}

/// Places a point in a plane that slopes in x and in y, with unequal lengths of the axes.
fn tilted([x, y]: [f64; 2]) -> Point {
    [x - 0.3 * y + 100.0, 0.2 * x + y, 0.75 * x + 2.0 * y - 7.0]
}

#[test]
fn a_mesh_in_a_tilted_plane_is_smoothed_by_its_lengths_in_space() {
    let folder = Folder::new(&[("in.obj", &obj(tilted))]);
    folder.line("convert in.obj in.vtk").clean();
    for ending in ["obj", "vtk"] {
        let line =
            format!("in.{ending} out.{ending} --engine cpu --tolerance 1e-12 --report r.json");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &["in a tilted plane with the normal ("]);
        let report = folder.json("r.json");
        let certificate = &report["certificate"];
        assert_eq!([&certificate["inverted"], &certificate["fixed_moved"]], [0, 0]);
        assert!(number(&certificate["moved"]) > 10.0);
        let [before, after] = ["in", "out"].map(|name| space(&folder, &format!("{name}.{ending}")));
        for (a, b) in before.iter().zip(&after) {
            // The cross product of (1, 0.2, 0.75) and (-0.3, 1, 2).
            let normal = [-0.35, -2.225, 1.06];
            let off: f64 = (0..3).map(|k| normal[k] * (b[k] - a[k])).sum();
            assert!(off.abs() < 1e-12, "{off}");
        }
        // The optimum does not depend on the coordinates in which the mesh is smoothed.
        let triangles = disturbed().triangles;
        let f = mean_imr_squared(&triangles, &after);
        assert!((f - number(&report["after"]["f"]["imr"])).abs() < 1e-9, "{f}");
        folder.line(&format!("compare in.{ending} out.{ending}"));
    }
    let quality = folder.line("quality out.vtk --json");
    assert_eq!(quality.code, Some(0), "{}", quality.err);
    // In 32-bit floats, the vertices of the file are off the plane by rounding.
    let single = folder.text("in.vtk").replace(" double", " float");
    std::fs::write(folder.path("single.vtk"), single).unwrap();
    let run = folder.line("single.vtk single_out.vtk --engine cpu --report r.json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(folder.json("r.json")["certificate"]["inverted"], 0);
}

/// Returns the mean of the squared inverse mean ratio of triangles in space, by lengths of edges.
fn mean_imr_squared(triangles: &[[u32; 3]], points: &[Point]) -> f64 {
    let value = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let squared =
            |p: Point, q: Point| (0..3).map(|k| (q[k] - p[k]) * (q[k] - p[k])).sum::<f64>();
        let [ab, bc, ca] = [squared(a, b), squared(b, c), squared(c, a)];
        // Heron's formula for 16 times the square of the area.
        let area = (2.0 * (ab * bc + bc * ca + ca * ab) - ab * ab - bc * bc - ca * ca).sqrt();
        let imr = (ab + bc + ca) / (3.0_f64.sqrt() * area);
        imr * imr
    };
    triangles.iter().map(value).sum::<f64>() / triangles.len() as f64
}

#[test]
fn a_curved_surface_is_refused_unless_z_is_data() {
    let curved = obj(|[x, y]| [x, y, 0.05 * x * x + 0.02 * y]);
    let folder = Folder::new(&[("in.obj", &curved)]);
    let parts = ["in.obj:", "the mesh is not planar", "add --z data"];
    folder.line("in.obj out.obj --engine cpu").refused(&parts);
    folder.line("quality in.obj").refused(&parts);
    let run = folder.line("in.obj out.obj --engine cpu --z data");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["`z` stays as it is"]);
    let (before, after) = (space(&folder, "in.obj"), space(&folder, "out.obj"));
    assert!(before.iter().zip(&after).all(|(a, b)| a[2].to_bits() == b[2].to_bits()));
    let mesh = |points: &[Point]| Mesh { points: by(points, [0, 1]), ..disturbed() };
    assert_smoothed(&mesh(&before), &mesh(&after));
    folder.line("compare in.obj out.obj --z data").clean();
    // The name of z says too that z is data.
    let run = folder.line("in.obj out.obj --engine cpu --interpolate z");
    assert_eq!(run.code, Some(0), "{}", run.err);
    folder.line("compare in.obj out.obj --interpolate z").clean();
    // The third number of a 2dm is a height by definition.
    folder.line("convert in.obj in.2dm").clean();
    let run = folder.line("in.2dm out.2dm --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["`z` stays as it is"]);
}

#[test]
fn a_vertex_that_leaves_the_plane_of_its_mesh_is_told() {
    let folder = Folder::new(&[("in.obj", &obj(|[x, y]| [x, 5.5, y]))]);
    assert_eq!(folder.line("in.obj out.obj --engine cpu").code, Some(0));
    let pairs = folder.text("in.obj");
    let row = folder
        .text("out.obj")
        .lines()
        .find(|row| row.starts_with('v') && !pairs.lines().any(|old| old == *row))
        .unwrap()
        .to_owned();
    let off = folder.text("out.obj").replace(&row, &row.replacen(" 5.5 ", " 5.6 ", 1));
    std::fs::write(folder.path("off.obj"), off).unwrap();
    assert_eq!(folder.line("compare in.obj out.obj").code, Some(0));
    let run = folder.line("compare in.obj off.obj");
    assert_eq!(run.code, Some(1));
    assert_holds(&run.err, &["1 vertex has moved that must not"]);
}

/// Returns a legacy VTK of the mesh of [`disturbed`], with vertices where `place` puts them, and data of vertices named z.
fn vtk(place: impl Fn([f64; 2]) -> Point, data: impl Fn([f64; 2]) -> f64) -> String {
    let Mesh { points, triangles, .. } = disturbed();
    let mut text = format!(
        "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n",
        points.len()
    );
    for [x, y, z] in points.iter().map(|&point| place(point)) {
        writeln!(text, "{x} {y} {z}").unwrap();
    }
    writeln!(text, "CELLS {0} {1}", triangles.len(), 4 * triangles.len()).unwrap();
    triangles.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    writeln!(text, "CELL_TYPES {}\n{}", triangles.len(), "5\n".repeat(triangles.len())).unwrap();
    writeln!(text, "POINT_DATA {}\nSCALARS z double 1\nLOOKUP_TABLE default", points.len())
        .unwrap();
    points.iter().for_each(|&point| writeln!(text, "{}", data(point)).unwrap());
    text
}

/// Returns the third coordinates of a file, and its data named z.
fn both(folder: &Folder, name: &str) -> [Vec<f64>; 2] {
    let file = MeshFile::read(&folder.path(name)).unwrap();
    let fields = file.point_fields(Some(&["z".into()])).unwrap();
    [true, false].map(|is_third| {
        let mut of_kind = fields.iter().filter(|field| field.is_third_of_points() == is_third);
        let found = of_kind.next().unwrap().values().to_vec();
        assert!(of_kind.next().is_none());
        found
    })
}

#[test]
fn data_named_z_are_no_third_coordinates() {
    let curved = |[x, y]: [f64; 2]| [x, y, x * x];
    let folder = Folder::new(&[
        ("curved.vtk", &vtk(curved, |[x, _]| 2.0 * x)),
        ("tilted.vtk", &vtk(tilted, |[x, y]| x * y)),
        ("data.vtk", &vtk(|[x, y]| [x, y, 2.0 * y], |[x, _]| 100.0 + x)),
    ]);
    folder.line("curved.vtk out.vtk --engine cpu").refused(&["the mesh is not planar"]);
    let run = folder.line("tilted.vtk out.vtk --engine cpu");
    assert_holds(&run.err, &["tilted plane", "`z` stays as it is"]);
    let [third, data] = both(&folder, "tilted.vtk");
    let [third_after, data_after] = both(&folder, "out.vtk");
    assert!(third != third_after && data == data_after);
    let run = folder.line("tilted.vtk named.vtk --engine cpu --interpolate z");
    assert_holds(&run.err, &["tilted plane"]);
    let [third_named, data_named] = both(&folder, "named.vtk");
    assert!(third_after == third_named && data != data_named);
    let compared = folder.line("compare tilted.vtk named.vtk --interpolate z");
    assert_eq!(compared.code, Some(0), "{}", compared.err);
    for (at, z) in space(&folder, "out.vtk").iter().zip(&third_after) {
        assert_eq!(at[2], *z);
    }
    // Both are interpolated, each by its own values, in a file of the same format and of another.
    for out in ["out.vtk", "out.vtu"] {
        let words = "--z data --interpolate all --engine cpu --force";
        let run = folder.line(&format!("data.vtk {out} {words}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let points = MeshFile::read(&folder.path(out)).unwrap().points().to_vec();
        let [third, data] = both(&folder, out);
        for ([x, y], (third, data)) in points.into_iter().zip(third.into_iter().zip(data)) {
            assert!((third - 2.0 * y).abs() < 1e-9 && (data - 100.0 - x).abs() < 1e-9, "{out}");
        }
    }
}
