//! Measures of edges of the meshes in `meshes/`, compared with MeshKernel's numbers in `meshkernel.txt`.

use gpu_smooth::measure::Measured;
use gpu_smooth::targets::Surface;
use gpu_smooth::{Mesh, Topology};
use std::collections::HashMap;

#[test]
fn edges_of_shipped_meshes_have_the_measures_of_meshkernel() {
    let text = include_str!("meshkernel.txt");
    let (mut meshes, mut in_degrees) = (HashMap::new(), 0);
    for row in text.lines().filter(|row| !row.starts_with('#')) {
        let mut words = row.split(' ');
        let name = words.next().unwrap();
        let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        let points = &meshes
            .entry(name)
            .or_insert_with(|| support::read_mesh(&support::meshes().join(format!("{name}.node"))))
            .points;
        let surface = if name == "mechanic" { Surface::Sphere } else { Surface::Plane };
        // The measures of an edge depend on its two triangles alone.
        let place = |vertex: &f64| {
            let [x, y] = points[*vertex as usize];
            match surface {
                Surface::Plane => [x, y],
                Surface::Sphere => [x / 2.0 + 4.0, y / 2.0 + 52.0],
            }
        };
        let index = |vertex: &f64| numbers[..6].iter().position(|v| v == vertex).unwrap() as u32;
        let corners: Vec<u32> = numbers[..6].iter().map(index).collect();
        let mesh = Mesh {
            points: numbers[..6].iter().map(place).collect(),
            triangles: corners.chunks(3).map(|t| [t[0], t[1], t[2]]).collect(),
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh).unwrap();
        let edges = Measured::on(surface, &mesh.points, &topology).unwrap().edges();
        let [edge] = edges[..] else { panic!("{row}") };
        let found = [edge.orthogonality, edge.flow_link, edge.smoothness];
        for (found, expected) in found.iter().zip(&numbers[6..]) {
            assert!((found - expected).abs() <= 1e-9 * expected.max(1.0), "{row}: {edge:?}");
        }
        in_degrees += usize::from(surface == Surface::Sphere);
    }
    assert!(meshes.len() == 6 && in_degrees > 30);
}
