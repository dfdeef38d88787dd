//! Vertices between regions: default, report, and `--free-interfaces`.

use super::files::{assert_middle_row_held, middle_row};
use super::{Folder, assert_holds, assert_smoothed, disturbed};
use gpu_smooth::Mesh;
use std::fs;

const NOTE: &str = "9 vertices between regions stay fixed (--free-interfaces lets them move)";

pub(super) fn folder(files: &support::regions::Files) -> Folder {
    let folder = Folder::new(&[]);
    for (name, bytes) in files {
        fs::write(folder.path(name), bytes).unwrap();
    }
    folder
}

/// Returns the region of each triangle of the small mesh: `below` or `above` its middle row.
pub(super) fn halves(mesh: &Mesh, [below, above]: [[i32; 2]; 2]) -> Vec<[i32; 2]> {
    let half = mesh.triangles.len() / 2;
    (0..mesh.triangles.len()).map(|t| if t < half { below } else { above }).collect()
}

#[test]
fn interfaces_between_regions_stay_and_a_note_says_so() {
    let mesh = disturbed();
    // Regions are physical groups, or entities within one physical group.
    for regions in [[[1, 7], [2, 7]], [[-1, 7], [-1, 8]]] {
        for files in support::write_regions(&mesh, &halves(&mesh, regions)) {
            let (folder, input) = (folder(&files), files[0].0);
            let output = input.replace("in", "out");
            let run = folder.run([input, &output, "--engine", "cpu"]);
            assert_eq!((run.code, run.err), (Some(0), format!("gpu-smooth: {NOTE}\n")));
            let (before, after) = (folder.mesh(input), folder.mesh(&output));
            assert_smoothed(&before, &after);
            assert_middle_row_held(&before, &after);

            let told = folder.line(&format!("quality {input}")).clean().out;
            assert_holds(&told, &[NOTE, "\n99 vertices (54 free), 160 triangles\n"]);
        }
    }
}

/// Two adjacent squares in two regions, with a vertex in the middle of their common edge.
#[test]
fn interfaces_that_lines_hold_are_told_where_they_were_to_be_free() {
    let mesh = |lines: &str| {
        let count = 10 + lines.lines().count();
        let triangles =
            [[1, 2, 5], [2, 8, 5], [8, 3, 5], [3, 4, 5], [4, 1, 5]].iter().map(|t| (t, 1));
        let others = [[2, 6, 9], [6, 7, 9], [7, 3, 9], [3, 8, 9], [8, 2, 9]].iter().map(|t| (t, 2));
        let rows = (1..)
            .zip(triangles.chain(others))
            .map(|(k, ([a, b, c], region))| format!("{k} 2 2 {region} {region} {a} {b} {c}\n"));
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .4 .5 0\n6 2 0 0\n7 2 1 0\n\
             8 1 .4 0\n9 1.6 .5 0\n$EndNodes\n$Elements\n{count}\n{}{lines}$EndElements\n",
            rows.collect::<String>()
        )
    };
    let lines = mesh("11 1 2 3 3 2 8\n12 1 2 3 3 8 3\n");
    let folder = Folder::new(&[("lines.msh", &lines), ("none.msh", &mesh(""))]);
    let told = "--free-interfaces: 1 vertex between regions is on line elements, points or quadrilaterals of the file";
    let run = folder.line("lines.msh out.msh --engine cpu --free-interfaces --report r.json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &[told]);
    assert_holds(&folder.json("r.json").to_string(), &[told]);
    let run = folder.line("none.msh out.msh --engine cpu --free-interfaces --force");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}

#[test]
fn free_interfaces_move_as_if_all_were_one_region() {
    let mesh = disturbed();
    let of_one = support::write_regions(&mesh, &halves(&mesh, [[1, 7], [1, 7]]));
    let of_two = support::write_regions(&mesh, &halves(&mesh, [[1, 7], [2, 7]]));
    for (of_one, of_two) in of_one.iter().zip(&of_two) {
        let input = of_one[0].0;
        let output = input.replace("in", "out");
        let [one, two] = [of_one, of_two].map(folder);
        one.run([input, &output, "--engine", "cpu"]).clean();
        two.run([input, &output, "--engine", "cpu", "--free-interfaces"]).clean();
        assert_eq!(one.mesh(&output).points, two.mesh(&output).points);
        let moved = |v: &u32| two.mesh(&output).points[*v as usize] != mesh.points[*v as usize];
        assert_eq!(middle_row().into_iter().flatten().filter(moved).count(), 18);
    }
}

/// Attributes of an `.ele` may have any values, even a value for each two triangles.
#[test]
fn a_mesh_with_a_region_for_each_two_triangles_is_refused_with_the_way_to_smooth_it() {
    let mesh = disturbed();
    let regions: Vec<_> = (0..mesh.triangles.len() as i32).map(|t| [t / 2, 0]).collect();
    for files in support::write_regions(&mesh, &regions) {
        let (folder, input) = (folder(&files), files[0].0);
        let output = input.replace("in", "out");
        let run = folder.run([input, &output, "--engine", "cpu"]);
        assert_eq!((run.code, run.out.as_str()), (Some(3), ""));
        let error = run.err.lines().last().unwrap();
        assert_holds(
            error,
            &["error: ", "none of the 99 vertices is free to move", ": --free-interfaces"],
        );
        folder.run([input, &output, "--engine", "cpu", "--free-interfaces"]).clean();
    }
}

#[test]
fn numbers_that_count_triangles_are_no_regions_in_any_format() {
    let mesh = disturbed();
    let regions: Vec<_> = (0..mesh.triangles.len() as i32).map(|t| [t, 0]).collect();
    for files in support::write_regions(&mesh, &regions) {
        let (folder, input) = (folder(&files), files[0].0);
        let output = input.replace("in", "out");
        let run = folder.run([input, &output, "--engine", "cpu"]);
        assert_eq!(run.code, Some(0), "{input}: {}", run.err);
        let freed = input.replace("in", "freed");
        folder.run([input, &freed, "--engine", "cpu", "--free-interfaces"]);
        assert_eq!(folder.mesh(&output).points, folder.mesh(&freed).points, "{input}");
    }
}

/// An array of cell data: its name, whether its numbers are real, and the number of each triangle.
type CellData<'n> = (&'n str, bool, Vec<f64>);

/// Writes the mesh in formats with cell data: legacy VTK, VTU, XDMF, gmsh and PLY.
fn with_cell_data(mesh: &Mesh, arrays: &[CellData<'_>]) -> Vec<(&'static str, String)> {
    let (n, m) = (mesh.points.len(), mesh.triangles.len());
    let points: String = mesh.points.iter().map(|[x, y]| format!("{x:?} {y:?} 0\n")).collect();
    let triangles = |before: &str| -> String {
        mesh.triangles.iter().map(|[a, b, c]| format!("{before}{a} {b} {c}\n")).collect()
    };
    let numbers = |(_, is_real, values): &CellData<'_>| -> String {
        let number =
            |value: &f64| if *is_real { format!("{value:?} ") } else { format!("{value} ") };
        values.iter().map(number).collect()
    };
    let of_vtk: String = arrays
        .iter()
        .map(|array| {
            let kind = if array.1 { "double" } else { "int" };
            format!("{} 1 {m} {kind}\n{}\n", array.0.replace(' ', "%20"), numbers(array))
        })
        .collect();
    let of_vtu: String = arrays
        .iter()
        .map(|array| {
            let kind = if array.1 { "Float64" } else { "Int32" };
            let (name, numbers) = (array.0, numbers(array));
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{numbers}</DataArray>\n")
        })
        .collect();
    let of_xdmf: String = arrays
        .iter()
        .map(|array| {
            let kind = if array.1 { "Float" } else { "Int" };
            let (name, numbers) = (array.0, numbers(array));
            format!(
                "<Attribute Name=\"{name}\" AttributeType=\"Scalar\" Center=\"Cell\"><DataItem Format=\"XML\" \
                 NumberType=\"{kind}\" Precision=\"8\" Dimensions=\"{m}\">{numbers}</DataItem></Attribute>\n"
            )
        })
        .collect();
    let of_gmsh: String = arrays
        .iter()
        .map(|(name, _, values)| {
            let rows = (1..).zip(values).map(|(id, value)| format!("{id} {value:?}\n"));
            let rows = rows.collect::<String>();
            format!("$ElementData\n1\n\"{name}\"\n1\n0\n3\n0\n1\n{m}\n{rows}$EndElementData\n")
        })
        .collect();
    let of_ply: String = arrays
        .iter()
        .map(|(name, is_real, _)| {
            let kind = if *is_real { "double" } else { "int" };
            format!("property {kind} {}\n", name.replace(' ', "_"))
        })
        .collect();
    let faces_of_ply: String = (0..m)
        .map(|t| {
            let [a, b, c] = mesh.triangles[t];
            let own: String = arrays.iter().map(|array| format!(" {}", array.2[t])).collect();
            format!("3 {a} {b} {c}{own}\n")
        })
        .collect();
    let ends: String = (1..=m).map(|t| format!("{} ", 3 * t)).collect();
    let (nodes, elements): (String, String) = (
        (1..).zip(&mesh.points).map(|(v, [x, y])| format!("{v} {x:?} {y:?} 0\n")).collect(),
        (1..)
            .zip(&mesh.triangles)
            .map(|(t, [a, b, c])| format!("{t} 2 2 1 1 {} {} {}\n", a + 1, b + 1, c + 1))
            .collect(),
    );
    vec![
        (
            "in.vtk",
            format!(
                "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {n} double\n{points}\
                 CELLS {m} {}\n{}CELL_TYPES {m}\n{}\nCELL_DATA {m}\nFIELD FieldData {}\n{of_vtk}",
                4 * m,
                triangles("3 "),
                "5 ".repeat(m),
                arrays.len(),
            ),
        ),
        (
            "in.vtu",
            format!(
                "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
                 <UnstructuredGrid><Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{m}\">\n<Points><DataArray type=\"Float64\" \
                 NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>\n<Cells><DataArray type=\"Int64\" \
                 Name=\"connectivity\" format=\"ascii\">{}</DataArray><DataArray type=\"Int64\" Name=\"offsets\" \
                 format=\"ascii\">{ends}</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray>\
                 </Cells>\n<CellData>{of_vtu}</CellData></Piece></UnstructuredGrid></VTKFile>\n",
                triangles(""),
                "5 ".repeat(m),
            ),
        ),
        (
            "in.xdmf",
            format!(
                "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain><Grid GridType=\"Uniform\">\n<Geometry \
                 GeometryType=\"XYZ\"><DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{n} 3\">{points}\
                 </DataItem></Geometry>\n<Topology TopologyType=\"Triangle\" NumberOfElements=\"{m}\"><DataItem Format=\"XML\" \
                 NumberType=\"Int\" Precision=\"8\" Dimensions=\"{m} 3\">{}</DataItem></Topology>\n{of_xdmf}\
                 </Grid></Domain></Xdmf>\n",
                triangles(""),
            ),
        ),
        (
            "in.msh",
            format!(
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{n}\n{nodes}$EndNodes\n$Elements\n{m}\n{elements}$EndElements\n\
                 {of_gmsh}"
            ),
        ),
        (
            "in.ply",
            format!(
                "ply\nformat ascii 1.0\nelement vertex {n}\nproperty double x\nproperty double y\nproperty double z\n\
                 element face {m}\nproperty list uchar int vertex_indices\n{of_ply}end_header\n{points}{faces_of_ply}"
            ),
        ),
    ]
}

#[test]
fn cell_data_under_any_name_that_look_like_regions_are_regions() {
    let mesh = disturbed();
    let m = mesh.triangles.len();
    let halves: Vec<f64> = (0..m).map(|t| if t < m / 2 { 1.0 } else { 2.0 }).collect();
    for (name, is_real) in [
        ("attribute", false),
        ("subdomains", true),
        ("PartId", false),
        ("MatId", true),
        ("Cell tags", false),
        ("mesh_tags", false),
        ("zone", true),
        ("MaterialIDs", true),
    ] {
        for (input, text) in with_cell_data(&mesh, &[(name, is_real, halves.clone())]) {
            let folder = Folder::new(&[(input, &text)]);
            let output = input.replace("in", "out");
            let run = folder.run([input, &output, "--engine", "cpu"]);
            assert_eq!(run.code, Some(0), "{name} {input}: {}", run.err);
            assert_holds(&run.err, &[NOTE]);
            let (before, after) = (folder.mesh(input), folder.mesh(&output));
            assert_smoothed(&before, &after);
            assert_middle_row_held(&before, &after);
            // The reader of legacy VTK takes real numbers under usual names as regions too.
            if (name, input) != ("MaterialIDs", "in.vtk") {
                // Names of PLY are words.
                let name = if input == "in.ply" { name.replace(' ', "_") } else { name.to_owned() };
                let note = format!(
                    "the cell data `{name}` number the regions (--regions NAME takes others)"
                );
                assert_holds(&run.err, &[&note]);
            }
        }
    }
}

/// Variables of faces of a UGRID have names and numbers like other cell data.
#[test]
fn variables_of_the_faces_of_a_ugrid_that_look_like_regions_are_regions() {
    let mesh = disturbed();
    let m = mesh.triangles.len();
    let halves = (0..m).map(|t| if t < m / 2 { 1.0 } else { 2.0 }).collect();
    let files = with_cell_data(&mesh, &[("zone", false, halves)]);
    let folder = Folder::new(&[(files[0].0, &files[0].1)]);
    folder.line("convert in.vtk in.nc -q").clean();
    for options in ["", " --regions zone"] {
        let run = folder.line(&format!("in.nc out.nc --engine cpu{options}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &[NOTE]);
        assert_middle_row_held(&folder.mesh("in.nc"), &folder.mesh("out.nc"));
    }
}

/// The regions of a format come before cell data, whose interfaces then move.
#[test]
fn cell_data_that_divide_regions_further_are_told() {
    let mesh = disturbed();
    let m = mesh.triangles.len();
    let parts = |size: usize| (0..m).map(|t| (1 + t / size) as f64).collect::<Vec<_>>();
    let told = |arrays: &[CellData<'_>]| {
        let files = with_cell_data(&mesh, arrays);
        let folder = Folder::new(&[(files[0].0, &files[0].1)]);
        folder.line("in.vtk out.vtk --engine cpu").err
    };
    let (halves, quarters) = (parts(m / 2), parts(m / 4));
    let err = told(&[("region", false, halves.clone()), ("zone", true, quarters.clone())]);
    let note = "the cell data `zone` divide the regions further, and are not used (--regions NAME takes them instead)";
    assert_holds(&err, &[NOTE, note]);
    let err = told(&[("region", false, quarters), ("zone", true, halves)]);
    assert!(!err.contains("zone"), "{err}");
}

#[test]
fn regions_are_not_chosen_for_interfaces_that_are_free() {
    let folder = Folder::new(&[]);
    for line in ["in.vtk out.vtk", "compare in.vtk out.vtk"] {
        let run = folder.line(&format!("{line} --regions zone --free-interfaces"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{line}: {}", run.err);
        let message = "--regions has no effect with --free-interfaces: drop one of them";
        assert_holds(&run.err, &[message]);
    }
}

#[test]
fn an_option_chooses_the_cell_data_of_regions() {
    let mesh = disturbed();
    let m = mesh.triangles.len();
    let halves: Vec<f64> = (0..m).map(|t| if t < m / 2 { 1.0 } else { 2.0 }).collect();
    let arrays = [
        ("error", true, (0..m).map(|t| 0.5 + t as f64).collect()),
        ("marked", false, (0..m).map(|t| (t % 2) as f64).collect()),
        ("id", false, (0..m).map(|t| t as f64).collect()),
        ("partition", false, (0..m).map(|t| (t / (m / 4)) as f64).collect()),
        ("zone", false, halves),
    ];
    for (input, text) in with_cell_data(&mesh, &arrays) {
        let folder = Folder::new(&[(input, &text)]);
        let output = input.replace("in", "out");
        let line =
            |rest: &str| folder.line(&format!("{input} {output} --engine cpu --force {rest}"));
        let run = line("");
        let note = "the cell data `partition` number the regions, and not `zone` (--regions NAME takes others)";
        assert_holds(&run.err, &[note, "27 vertices between regions stay fixed"]);
        let run = line("--regions zone");
        assert_eq!((run.code, run.err), (Some(0), format!("gpu-smooth: {NOTE}\n")), "{input}");
        assert_middle_row_held(&folder.mesh(input), &folder.mesh(&output));
        let all = "`error`, `marked`, `id`, `partition`, `zone`";
        for (name, problem) in [
            ("zones", "it has no cell data `zones`"),
            ("error", "the cell data `error` are not a whole number for each element"),
        ] {
            let run = line(&format!("--regions {name}"));
            assert_eq!(run.code, Some(3));
            assert_holds(&run.err.replace("\n  ", " "), &[input, problem, all]);
        }
    }
}

#[test]
fn a_run_with_chosen_regions_replaces_its_own_result() {
    let mesh = disturbed();
    let m = mesh.triangles.len();
    let parts = |size: usize| (0..m).map(|t| (1 + t / size) as f64).collect::<Vec<_>>();
    let arrays = [("region", false, parts(m / 2)), ("zone", true, parts(m / 4))];
    let files = with_cell_data(&mesh, &arrays);
    let moved =
        with_cell_data(&mesh, &[("region", false, parts(m / 2)), ("zone", true, parts(m / 8))]);
    let other = with_cell_data(&mesh, &arrays[..1]);
    let other = [("other.vtk", &*moved[0].1), ("without.vtk", &*other[0].1)];
    let folder = Folder::new(&[(files[0].0, &files[0].1), other[0], other[1]]);
    std::fs::create_dir(folder.path("results")).unwrap();
    for out in ["out.vtk", "--out-dir results"] {
        let line = format!("in.vtk {out} --engine cpu --regions zone");
        for run in 0..2 {
            let run = (run, folder.line(&line));
            assert_eq!(run.1.code, Some(0), "{} {}", run.0, run.1.err);
        }
    }
    // Files with other regions, or without the chosen cell data, are still other meshes.
    for (name, _) in other {
        let told = format!("{name}: holds another mesh than in.vtk: its fixed vertices are others");
        folder.line(&format!("in.vtk {name} --engine cpu --regions zone")).refused(&[&told]);
    }
}

/// Numbers that cannot be read hide no later array, whether the later array has a usual name or not.
#[test]
fn regions_are_found_behind_cell_data_that_are_damaged() {
    let mesh = disturbed();
    let half = mesh.triangles.len() / 2;
    let numbers: Vec<f64> = (0..2 * half).map(|t| f64::from(u8::from(t >= half)) + 1.0).collect();
    for name in ["MaterialIds", "partition"] {
        let errors = vec![0.4375; 2 * half];
        let arrays = [("error", true, errors), (name, false, numbers.clone())];
        let text = with_cell_data(&mesh, &arrays).swap_remove(0).1;
        let folder = Folder::new(&[("in.vtk", &text.replacen("0.4375 ", "none ", 1))]);
        let run = folder.line("in.vtk out.vtk --engine cpu");
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &[NOTE]);
        assert_middle_row_held(&folder.mesh("in.vtk"), &folder.mesh("out.vtk"));
    }
}

/// Each piece of the mesh has the triangles of the other piece as ghosts.
#[test]
fn vertices_that_pieces_of_a_mesh_have_in_common_stay() {
    let mesh = disturbed();
    let half = mesh.triangles.len() / 2;
    for (name, ghost) in [("vtkGhostType", 1), ("vtkGhostType", 33), ("vtkGhostLevels", 2)] {
        let of = |is_ghost: &dyn Fn(usize) -> bool| {
            let ghosts = (0..2 * half).map(|t| f64::from(ghost * i32::from(is_ghost(t)))).collect();
            with_cell_data(&mesh, &[(name, false, ghosts)]).swap_remove(0).1
        };
        let [below, above] = [of(&|t| t >= half), of(&|t| t < half)];
        let folder = Folder::new(&[("0.vtk", &below), ("1.vtk", &above)]);
        let mut moved = Vec::new();
        for (piece, ghosts) in ["0.vtk", "1.vtk"].into_iter().zip([half..2 * half, 0..half]) {
            folder.line(&format!("convert {piece} {piece}.vtu --quiet")).clean();
            let told = "80 ghost elements: their vertices stay fixed\n";
            for piece in [piece.to_owned(), format!("{piece}.vtu")] {
                for options in ["", "--slide"] {
                    let run =
                        folder.line(&format!("{piece} out-{piece} --engine cpu --force {options}"));
                    assert_eq!(run.code, Some(0), "{}", run.err);
                    assert_holds(&run.err, &[told]);
                    assert!(!run.err.contains("regions"), "{}", run.err);
                    let after = folder.mesh(&format!("out-{piece}")).points;
                    assert_ne!(after, mesh.points);
                    let fixed = mesh.triangles[ghosts.clone()].iter().flatten();
                    let is_held = |&v: &u32| after[v as usize] == mesh.points[v as usize];
                    assert!(fixed.into_iter().all(is_held), "{piece} {options}");
                    moved.push(after);
                }
            }
        }
        assert_eq!(moved.len(), 8);
    }
    // Other bits mark hidden cells and the surface, not ghosts.
    let hidden = (0..2 * half).map(|t| (32 * (t % 2)) as f64).collect();
    let text = with_cell_data(&mesh, &[("vtkGhostType", false, hidden)]).swap_remove(0).1;
    let folder = Folder::new(&[("in.vtk", &text)]);
    let run = folder.line("in.vtk out.vtk --engine cpu");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}
