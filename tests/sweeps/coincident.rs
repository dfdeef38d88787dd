//! Coincident vertices, on both sides of a crack or of two parts that touch, slide together.

use crate::{backends, name, run};
use gpu_smooth::{Mesh, Options, Slide, Smoother, Topology, options::Precision};
use std::ops::Range;

/// Position of a vertex of a lattice of six columns of cells. Interfaces are curved: rows and columns bend, and vertices
/// are spaced unevenly.
fn at(column: u32, row: u32) -> [f64; 2] {
    let [c, r] = [column, row].map(f64::from);
    let is_inside = |i: u32, n: u32| 0 < i && i < n;
    let shift = |inside: bool, phase: f64| if inside { 0.25 * phase.sin() } else { 0.0 };
    let x = c + shift(is_inside(column, 6), 7.0 * c);
    let y = r + shift(is_inside(row, 4) && row != 2, 5.0 * c + r);
    [x, y + 0.02 * x * (6.0 - x)]
}

/// Adds a rectangle of a lattice, whose vertices belong to no other part of the mesh.
fn add(mesh: &mut Mesh, columns: Range<u32>, rows: Range<u32>) {
    let first = mesh.points.len() as u32;
    let width = columns.len() as u32 + 1;
    for row in rows.start..=rows.end {
        for column in columns.start..=columns.end {
            mesh.points.push(at(column, row));
            if row < rows.end && column < columns.end {
                let a = first + (row - rows.start) * width + column - columns.start;
                mesh.triangles.extend([[a, a + 1, a + width + 1], [a, a + width + 1, a + width]]);
            }
        }
    }
}

/// Returns the vertices at each place with several vertices.
fn places(points: &[[f64; 2]]) -> Vec<Vec<usize>> {
    let mut all: Vec<([u64; 2], usize)> =
        points.iter().map(|point| point.map(f64::to_bits)).zip(0..).collect();
    all.sort_unstable();
    let groups = all.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1);
    groups.map(|group| group.iter().map(|&(_, v)| v).collect()).collect()
}

/// Runs with sliding vertices, and asserts that vertices at one place stay at one place, and that `together` pairs slide
/// and `alone` further vertices stay.
fn assert_together(mesh: &Mesh, [together, alone]: [usize; 2]) {
    let mut smoother = Smoother::new(mesh).unwrap();
    let slide = Slide::default();
    smoother.set_slide(Some(&slide)).unwrap();
    assert_eq!(smoother.coincident(), [together, alone]);
    let topology = Topology::new(mesh).unwrap();
    let misplaced =
        |points: &[[f64; 2]]| slide.misplaced(&topology, &mesh.points, points, Precision::Double);
    let given = places(&mesh.points);
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        let label = name(backend);
        assert_eq!(outcome.slid.unwrap().coincident, together, "{label}");
        let mut now = places(&outcome.points);
        now.sort();
        let mut before = given.clone();
        before.sort();
        assert_eq!(now, before, "{label}");
        let has_moved = |v: usize| mesh.points[v] != outcome.points[v];
        let moved = given.iter().filter(|group| has_moved(group[0]));
        assert_eq!(moved.clone().count(), together, "{label}");
        assert!(misplaced(&outcome.points).is_empty(), "{label}");
        for group in moved {
            assert_eq!(group.len(), 2, "{label}");
            let mut torn = outcome.points.clone();
            torn[group[0]] = mesh.points[group[0]];
            assert_eq!(misplaced(&torn), [group[1] as u32], "{label}");
            // The other one goes back, too.
            assert_eq!(smoother.certify(&mut torn), Ok(1), "{label}");
            assert_eq!(torn[group[1]], mesh.points[group[1]], "{label}");
        }
    }
}

/// A former defect: the vertices of both parts slid independently, and the parts overlapped on curved interfaces.
#[test]
fn vertices_of_two_parts_that_touch_slide_together() {
    let mut mesh = Mesh::default();
    add(&mut mesh, 0..6, 0..2);
    add(&mut mesh, 0..6, 2..4);
    // Both ends of the interface are corners.
    assert_together(&mesh, [5, 4]);
}

#[test]
fn vertices_at_which_three_parts_meet_stay() {
    let mut mesh = Mesh::default();
    add(&mut mesh, 0..6, 0..2);
    add(&mut mesh, 0..3, 2..4);
    add(&mut mesh, 3..6, 2..4);
    // Three vertices in the middle of the lower part's upper side, one of them on a smooth curve; a pair above on the
    // straight side between the upper parts; and the ends of the sides.
    assert_together(&mesh, [5, 3 + 4 + 2]);
}

/// The upper part is narrower than the lower one, whose side goes on smoothly.
#[test]
fn the_ends_of_a_contact_stay() {
    let mut mesh = Mesh::default();
    add(&mut mesh, 0..6, 0..2);
    add(&mut mesh, 1..5, 2..4);
    assert_together(&mesh, [3, 4]);
}

/// A crack opens to no side. Its tips are single vertices.
#[test]
fn both_sides_of_a_crack_slide_together_and_its_tips_stay() {
    for corner_angle in [40.0, 180.0] {
        let mut mesh = Mesh::default();
        add(&mut mesh, 0..6, 0..4);
        // Vertices of row 2 in columns 2 to 4 are doubled for the triangles above.
        let doubled = 2 * 7 + 2..2 * 7 + 5_u32;
        let first = mesh.points.len() as u32;
        mesh.points.extend(doubled.clone().map(|v| at(v % 7, 2)));
        for triangle in mesh.triangles.iter_mut().skip(2 * 6 * 2) {
            for v in triangle.iter_mut().filter(|v| doubled.contains(v)) {
                *v += first - doubled.start;
            }
        }
        let slide = Slide { corner_angle, ..Slide::default() };
        let mut smoother = Smoother::new(&mesh).unwrap();
        smoother.set_slide(Some(&slide)).unwrap();
        assert_eq!(smoother.coincident(), [3, 0]);
        let tips = [doubled.start - 1, doubled.end].map(|v| v as usize);
        let outcome = run(&smoother, &Options::default(), &gpu_smooth::Backend::Cpu);
        assert!(tips.iter().all(|&v| outcome.points[v] == mesh.points[v]), "{corner_angle}");
        let mut now = places(&outcome.points);
        now.sort();
        assert_eq!(now, [[16, 35], [17, 36], [18, 37]]);
        assert!(now.iter().all(|group| outcome.points[group[0]] != mesh.points[group[0]]));
        if corner_angle == 40.0 {
            assert_together(&mesh, [3, 0]);
        }
    }
}

/// A disc in a plate: both lines between the parts are closed curves without a corner.
#[test]
fn vertices_of_a_closed_interface_slide_together() {
    let count = 24_u32;
    let ring = |radius: f64, off: f64| {
        (0..count).map(move |k| {
            let turn = f64::from(k) + off * (3.0 * f64::from(k)).sin();
            let (sin, cos) = (turn * std::f64::consts::TAU / f64::from(count)).sin_cos();
            [radius * cos, radius * sin]
        })
    };
    let mut mesh = Mesh::default();
    let add_ring = |inner: u32, outer: u32, triangles: &mut Vec<[u32; 3]>| {
        for k in 0..count {
            let next = (k + 1) % count;
            let [a, b, c, d] = [inner + k, inner + next, outer + next, outer + k];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    };
    // The disc: rings at radius 0.4, 0.7 and 1. The plate: rings at radius 1, 1.4 and 1.8.
    for (radius, off) in [(0.4, 0.0), (0.7, 0.1), (1.0, 0.3), (1.0, 0.3), (1.4, 0.1), (1.8, 0.0)] {
        mesh.points.extend(ring(radius, off));
    }
    let mut triangles = Vec::new();
    for ring in [0, 1, 3, 4] {
        add_ring(ring * count, (ring + 1) * count, &mut triangles);
    }
    mesh.triangles = triangles;
    let given = places(&mesh.points).len();
    assert_eq!(given, count as usize);
    assert_together(&mesh, [given, 0]);
}
