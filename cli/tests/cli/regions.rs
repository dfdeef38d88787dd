//! Vertices between regions: default, report, and `--free-interfaces`.

use super::files::{assert_middle_row_held, middle_row};
use super::{Folder, assert_holds, assert_smoothed, disturbed, support};
use gpu_smooth::Mesh;
use std::fs;

const NOTE: &str = "9 vertices between regions stay fixed (--free-interfaces lets them move)";

fn folder(files: &support::regions::Files) -> Folder {
    let folder = Folder::new(&[]);
    for (name, bytes) in files {
        fs::write(folder.path(name), bytes).unwrap();
    }
    folder
}

/// Returns the region of each triangle of the small mesh: `below` or `above` its middle row.
fn halves(mesh: &Mesh, [below, above]: [[i32; 2]; 2]) -> Vec<[i32; 2]> {
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

/// Attributes of an `.ele` may have any values, even a unique value for each triangle.
#[test]
fn a_mesh_with_a_region_for_each_triangle_is_refused_with_the_way_to_smooth_it() {
    let mesh = disturbed();
    let regions: Vec<_> = (0..mesh.triangles.len() as i32).map(|t| [t, 0]).collect();
    for files in support::write_regions(&mesh, &regions) {
        let (folder, input) = (folder(&files), files[0].0);
        let output = input.replace("in", "out");
        let run = folder.run([input, &output, "--engine", "cpu"]);
        assert_eq!((run.code, run.out.as_str()), (Some(1), ""));
        let error = run.err.lines().last().unwrap();
        assert_holds(
            error,
            &["error: ", "none of the 99 vertices is free to move", ": --free-interfaces"],
        );
        folder.run([input, &output, "--engine", "cpu", "--free-interfaces"]).clean();
    }
}
