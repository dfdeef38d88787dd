//! Precision and recall of layers by families of meshes.

use super::bodies::{Wall, bodies, body, c_grid, circle, mean_edge, naca, plate, sheet, square};
use super::grown::{CUTS, Cut, Grown};
use super::shapes::{Rows, channel, crossing, flat, merged, noisy, stairs};
use super::{layers, layers_of};
use gpu_smooth::Mesh;
use gpu_smooth::layers::KeepLayers;

/// Shares that a study of boundary layers measured for a family of meshes with a prototype of the rule.
struct Figures {
    /// Share of the found vertices that are in layers.
    precision: f64,
    /// Share of the vertices in layers that are found.
    recall: f64,
    /// Share of the vertices in first rows that are found.
    first_row: f64,
}

/// Largest distance of a share below that of the study.
const BELOW: f64 = 0.005;

/// Numbers of vertices inside the meshes of a family.
#[derive(Default)]
struct Counts {
    found: usize,
    in_layers: usize,
    both: usize,
    first_row: [usize; 2],
}

impl Counts {
    fn add(&mut self, grown: &Grown) {
        let found = layers_of(grown);
        let is_boundary = grown.boundary();
        let mut is_found = vec![false; is_boundary.len()];
        found.vertices.iter().for_each(|&v| is_found[v as usize] = true);
        for (v, row) in grown.row.iter().enumerate() {
            let is_inside = !is_boundary[v] && *row != Some(0);
            let (is_found, in_layer) = (is_inside && is_found[v], is_inside && row.is_some());
            self.found += usize::from(is_found);
            self.in_layers += usize::from(in_layer);
            self.both += usize::from(is_found && in_layer);
            if is_inside && *row == Some(1) {
                self.first_row[0] += usize::from(is_found);
                self.first_row[1] += 1;
            }
        }
    }
}

/// Checks the shares of a family against those of the study.
fn check(family: &str, figures: &Figures, meshes: impl IntoIterator<Item = Grown>) {
    let mut counts = Counts::default();
    meshes.into_iter().for_each(|grown| counts.add(&grown));
    let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
    let Counts { found, in_layers, both, first_row: [first, all] } = counts;
    let shares = [share(both, found), share(both, in_layers), share(first, all)];
    let least = [figures.precision, figures.recall, figures.first_row];
    let holds = shares.iter().zip(least).all(|(share, least)| *share >= least - BELOW);
    assert!(holds, "{family}: precision, recall and row 1 are {shares:?}, in the study {least:?}");
}

#[test]
fn rows_around_airfoils_are_found_with_every_aspect_thickness_fan_and_diagonal() {
    let wall = naca(0.12, 60, false);
    let edge = mean_edge(&wall);
    let pairs =
        [4.0, 100.0, 10_000.0_f64].into_iter().flat_map(|a| [1.05, 1.2, 1.4].map(|g| (a, g)));
    let extruded = pairs.enumerate().map(|(k, (aspect, growth))| {
        let count = (aspect.ln() / f64::ln(growth)) as usize + 1;
        let rows = Rows::of_aspect(edge, aspect, growth, count.clamp(3, 40));
        body(&wall, rows, [6, 0, 12, 3][k % 4], CUTS[k % 4])
    });
    let figures = Figures { precision: 0.9999, recall: 1.0, first_row: 1.0 };
    check("extruded airfoils", &figures, extruded);
    let walls =
        [0.02, 0.06, 0.24, 0.5].into_iter().flat_map(|t| [false, true].map(|b| naca(t, 60, b)));
    let thick = walls.enumerate().map(|(k, wall)| {
        let (aspect, growth, count) = [(50.0, 1.25, 15), (1000.0, 1.2, 30), (8.0, 1.2, 8)][k % 3];
        let rows = Rows::of_aspect(mean_edge(&wall), aspect, growth, count);
        body(&wall, rows, 6, CUTS[k % 4])
    });
    let figures = Figures { precision: 0.9994, recall: 1.0, first_row: 1.0 };
    check("thin and thick airfoils", &figures, thick);
}

#[test]
fn rows_on_flat_walls_are_found_with_open_ends_and_stairs() {
    let on_wall = |heights: &[(f64, f64, usize)]| {
        let heights = heights.to_vec();
        let kinds = CUTS.into_iter().flat_map(|cut| [0.6, 1.0].map(|share| (cut, share)));
        kinds.flat_map(move |(cut, share)| {
            heights.clone().into_iter().map(move |(aspect, growth, count)| {
                flat(share, Rows::of_aspect(share / 30.0, aspect, growth, count), cut)
            })
        })
    };
    let figures = Figures { precision: 0.997, recall: 1.0, first_row: 1.0 };
    let high = on_wall(&[(6.0, 1.15, 10), (42.0, 1.25, 14), (500.0, 1.3, 20)]);
    check("flat walls", &figures, high);
    // Vertices whose aspect is below 1.5 are not kept.
    let figures = Figures { precision: 1.0, recall: 0.7, first_row: 0.9 };
    check("flat walls, aspects of 2 and 3", &figures, on_wall(&[(2.0, 1.1, 6), (3.0, 1.2, 6)]));
    let figures = Figures { precision: 0.9997, recall: 0.995, first_row: 1.0 };
    let rising = CUTS.into_iter().flat_map(|cut| {
        [(20.0, 1.15), (200.0, 1.3), (1000.0, 1.3)].map(|(aspect, growth)| {
            let count = |c: usize| 3 + 17 * c / 30;
            stairs(1.0, Rows::of_aspect(1.0 / 30.0, aspect, growth, 20), cut, count)
        })
    });
    check("stairs", &figures, rising);
}

#[test]
fn rows_are_found_on_both_sides_of_walls_and_in_corners_and_channels() {
    let rows = Rows::of_aspect(mean_edge(&plate(40)), 40.0, 1.25, 14);
    let kinds = CUTS.into_iter().flat_map(|cut| [false, true].map(|is_crack| (cut, is_crack)));
    let sheets = kinds.map(|(cut, is_crack)| sheet(is_crack, rows, cut));
    let figures = Figures { precision: 0.995, recall: 1.0, first_row: 1.0 };
    check("inner walls and cracks", &figures, sheets);
    // Where rows cross at equal spacing, triangles are not stretched and move.
    let figures = Figures { precision: 1.0, recall: 0.952, first_row: 1.0 };
    check("crossing rows", &figures, CUTS.map(crossing));
    let figures = Figures { precision: 1.0, recall: 0.985, first_row: 1.0 };
    check("merged columns", &figures, CUTS.map(merged));
    let figures = Figures { precision: 1.0, recall: 1.0, first_row: 1.0 };
    check("channels", &figures, CUTS.map(channel));
}

#[test]
fn rows_are_found_although_vertices_are_displaced() {
    // Precision is that of all three amplitudes.
    for (noise, recall, first_row) in [(0.1, 0.9997, 1.0), (0.2, 0.67, 1.0), (0.3, 0.15, 0.5)] {
        let figures = Figures { precision: 0.0, recall, first_row };
        check("noise", &figures, (0..2).map(|seed| noisy(noise, CUTS[1 + seed], seed as u64)));
    }
    let all = [0.1, 0.2, 0.3].into_iter().flat_map(|noise| [0, 1].map(|seed| (noise, seed)));
    let all = all.map(|(noise, seed)| noisy(noise, CUTS[1 + seed], seed as u64));
    check("noise", &Figures { precision: 0.971, recall: 0.0, first_row: 0.0 }, all);
}

#[test]
fn rows_of_quadrilaterals_are_found_at_noses_corners_and_between_airfoils() {
    // A slat and a flap, turned around the origin and moved.
    let placed = |wall: Wall, size: f64, degrees: f64, [x, y]: [f64; 2]| -> Wall {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let turned = |[a, b]: [f64; 2]| [a * cosine - b * sine, a * sine + b * cosine];
        wall.into_iter().map(turned).map(|[a, b]| [x + size * a, y + size * b]).collect()
    };
    let three = [
        naca(0.12, 60, false),
        placed(naca(0.15, 40, true), 0.3, -25.0, [1.02, -0.06]),
        placed(naca(0.1, 40, false), 0.2, 25.0, [-0.2, -0.12]),
    ];
    let of_cut = |cut: Cut| {
        let rows = |count| Rows { first: 2e-3, growth: 1.25, count };
        let airfoils = [(0.06, 0), (0.06, 8), (0.12, 0), (0.12, 8), (0.24, 0), (0.24, 8)];
        let mut all: Vec<Grown> =
            airfoils.map(|(t, fan)| body(&naca(t, 50, false), rows(7), fan, cut)).into();
        all.push(body(&circle(80), rows(12), 0, cut));
        all.extend([0, 6].map(|fan| body(&square(20), rows(10), fan, cut)));
        all.push(bodies(&three, Rows { first: 3e-4, growth: 1.25, count: 10 }, 6, cut));
        all
    };
    let figures = Figures { precision: 0.9985, recall: 1.0, first_row: 0.999 };
    check("hybrids", &figures, [Cut::Whole, Cut::Random].into_iter().flat_map(of_cut));
}

#[test]
fn wakes_of_c_grids_and_the_rows_on_both_sides_are_found() {
    for cut in CUTS.into_iter().chain([Cut::Whole]) {
        let (mut grown, wake) = c_grid(0.12, cut);
        let quadrilaterals = grown.faces.drain(..).map(|face| face.try_into().unwrap());
        grown.mesh.quadrilaterals = quadrilaterals.collect();
        let found = layers_of(&grown);
        let is_found = |v: &u32| found.vertices.binary_search(v).is_ok();
        assert!(wake.len() >= 25 && wake.iter().all(is_found), "{cut:?}");
        // The first rows above the wake and the airfoil, in which aspects exceed 1.5.
        let rows = grown.row.iter().enumerate().filter(|(_, row)| matches!(row, Some(1..=8)));
        let is_boundary = grown.boundary();
        let inside = rows.filter(|(v, _)| !is_boundary[*v]).map(|(v, _)| v as u32);
        let (found, missed): (Vec<u32>, Vec<u32>) = inside.partition(is_found);
        let recall = found.len() as f64 / (found.len() + missed.len()) as f64;
        assert!(recall >= 0.995, "{cut:?}: {recall}");
    }
}

/// Rows at the inner side of a sector of a ring end at its two straight sides. One edge of the curved wall bends by more than the
/// first row is high, so the ends of rows were taken for those of others, and slid.
#[test]
fn rows_on_a_curved_wall_end_at_both_sides() {
    let (columns, rows) = (24, 12);
    let mut heights = vec![0.0];
    (0..rows).for_each(|row| heights.push(heights[row] + 1e-3 * 1.35_f64.powi(row as i32)));
    // Above the rows are triangles of the size of wall edges.
    heights.extend((1..6).map(|row| 0.15 + 0.3 * f64::from(row)));
    let point = |k: usize| {
        let (angle, radius) = (0.1 * (k % (columns + 1)) as f64, 3.0 + heights[k / (columns + 1)]);
        [radius * angle.cos(), -radius * angle.sin()]
    };
    let points = (0..(columns + 1) * heights.len()).map(point).collect();
    let of_cell = |k: usize| {
        let a = (k / columns * (columns + 1) + k % columns) as u32;
        let [b, c] = [a + 1, a + columns as u32 + 1];
        [[a, c, b], [b, c, c + 1]]
    };
    let triangles = (0..columns * (heights.len() - 1)).flat_map(of_cell).collect();
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let found = layers(&mesh, KeepLayers::Auto);
    assert_eq!(found.rows, rows);
    let ends: Vec<u32> = (1..=rows as u32)
        .flat_map(|row| [0, columns as u32].map(|column| row * (columns as u32 + 1) + column))
        .collect();
    assert_eq!(found.sides, ends);
}
