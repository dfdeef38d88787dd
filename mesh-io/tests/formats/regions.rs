//! Regions of triangles, and the fixed vertices between regions.

use super::Folder;
use super::facts::{between_regions, fixed, freed, mesh_of};
use super::long::{points, triangles};
use mesh_io::{Conversion, Format, MeshFile, Remark};
use std::fs;
use support::Mesh;
use support::{lattice, write_regions};

fn folder(files: &[(&str, Vec<u8>)]) -> Folder {
    let folder = Folder::new(&[]);
    for (name, bytes) in files {
        fs::write(folder.path(name), bytes).unwrap();
    }
    folder
}

/// Returns the vertices between regions by definition: inside the mesh, with triangles of more than one region.
pub(crate) fn interfaces(mesh: &Mesh, regions: &[u32]) -> Vec<u32> {
    let on_boundary = support::boundary(mesh);
    let mut of_vertex = vec![Vec::new(); mesh.points.len()];
    for (t, &region) in mesh.triangles.iter().zip(regions) {
        t.iter().for_each(|&v| of_vertex[v as usize].push(region));
    }
    let between = |v: &u32| {
        let regions = &of_vertex[*v as usize];
        !on_boundary[*v as usize] && regions.iter().any(|region| *region != regions[0])
    };
    (0..mesh.points.len() as u32).filter(between).collect()
}

/// Checks that each format gives the regions, and that a rewrite without moves keeps every byte.
#[track_caller]
fn assert_regions(mesh: &Mesh, names: &[[i32; 2]], numbers: &[u32]) {
    let held = interfaces(mesh, numbers);
    for files in write_regions(mesh, names) {
        let folder = folder(&files);
        let file = folder.read(files[0].0);
        let format = file.format();
        assert!(file.regions() == Some(numbers), "{format}");
        assert!(between_regions(&file) == held, "{format}");
        assert!(fixed(&file) == held, "{format}");
        file.write(&folder.path("out"), &mesh.points).unwrap();
        for (name, bytes) in &files {
            let out = if files.len() == 1 { "out" } else { &name.replace("in", "out") };
            assert!(fs::read(folder.path(out)).unwrap() == *bytes, "{format}");
        }
        assert!(freed(&file) == *mesh, "{format}");
        assert!(file.regions() == Some(numbers), "{format}");
    }
}

#[test]
fn triangles_of_one_group_and_entity_are_a_region_in_every_format() {
    let mesh = lattice(6, 4);
    // A region of one triangle; stripes; region numbers that occur in several separate places.
    let names = [[7, 1], [-7, 1], [7, 2], [0, 0]];
    let of_triangle: [fn(usize) -> usize; 3] =
        [|t| usize::from(t == 17), |t| t / 12, |t| [0, 1, 2, 0, 3, 3, 1][t % 7]];
    for of_triangle in of_triangle {
        let regions: Vec<_> = (0..mesh.triangles.len()).map(of_triangle).collect();
        let names: Vec<_> = regions.iter().map(|&region| names[region]).collect();
        let numbers: Vec<_> = regions.iter().map(|&region| region as u32).collect();
        assert_regions(&mesh, &names, &numbers);
    }
}

#[test]
fn regions_of_long_lists_are_those_of_short_ones() {
    let mesh = Mesh { points: points(), triangles: triangles(), ..Mesh::default() };
    let regions: Vec<_> = (0..mesh.triangles.len() as u32).map(|t| t / 9000 % 5).collect();
    let names: Vec<_> =
        regions.iter().map(|&region| [region as i32 / 2, 3 - region as i32]).collect();
    assert_regions(&mesh, &names, &regions);
}

#[test]
fn a_mesh_of_one_region_fixes_nothing() {
    let mesh = lattice(6, 4);
    for name in [[0, 0], [3, -1]] {
        for files in write_regions(&mesh, &vec![name; mesh.triangles.len()]) {
            let folder = folder(&files);
            let file = folder.read(files[0].0);
            assert_eq!((file.regions(), &mesh_of(&file)), (None, &mesh));
        }
    }
}

fn regions_of(ele: &str) -> Option<Vec<u32>> {
    let folder = Folder::new(&[("a.node", super::NODE), ("a.ele", ele)]);
    MeshFile::read(&folder.path("a")).unwrap().regions().map(<[u32]>::to_vec)
}

#[test]
fn attributes_count_as_numbers_and_only_if_announced() {
    assert_eq!(regions_of(super::ELE), Some(vec![0, 0, 0, 1]));
    let ele = |columns: &str| {
        format!("4 3 {columns}\n1 1 2 5 1 7\n2 2 3 5 1.0 8\n3 3 4 5 +1e0 # 2 3\n4 4 1 5\t1.5e0  7")
    };
    assert_eq!(regions_of(&ele("")), None);
    assert_eq!(regions_of(&ele("0")), None);
    assert_eq!(regions_of(&ele("1")), Some(vec![0, 0, 0, 1]));
    assert_eq!(regions_of(&ele("2")), Some(vec![0, 1, 2, 3]));
}

#[test]
fn vertices_fixed_by_other_means_are_not_counted_between_regions() {
    let mesh = lattice(6, 4);
    let names: Vec<_> = (0..mesh.triangles.len() as i32).map(|t| [t / 24, 0]).collect();
    let files = &write_regions(&mesh, &names)[0];
    let folder = folder(files);
    let held = between_regions(&folder.read("in"));
    assert_eq!(held, [15, 16, 17, 18, 19]);
    // A segment along a part of the interface, with vertices numbered from one.
    fs::write(folder.path("in.poly"), "0 2 0 0\n1 0\n1 17 18\n0\n").unwrap();
    let file = folder.read("in");
    assert_eq!(between_regions(&file), [15, 18, 19]);
    assert_eq!(fixed(&file), [16, 17, 15, 18, 19]);
    assert_eq!(file.constraints().vertices, [16, 17]);
}

/// The first of the two numbers of regions divides the mesh in halves; the second counts triangles.
#[test]
fn numbers_that_count_triangles_are_neither_regions_nor_groups() {
    let mesh = lattice(6, 4);
    let halves: Vec<u32> = (0..mesh.triangles.len() as u32).map(|t| t / 24).collect();
    let names: Vec<_> = (0..mesh.triangles.len() as i32).map(|t| [1 + t / 24, t + 1]).collect();
    for files in write_regions(&mesh, &names) {
        let folder = folder(&files);
        let file = folder.read(files[0].0);
        let format = file.format();
        assert_eq!(file.remarks(), [Remark::CountedElements], "{format}");
        // In this version of gmsh's format, the entity alone identifies a region.
        let has_halves = !matches!(format, Format::Gmsh41 | Format::Gmsh41Binary);
        assert_eq!(file.regions(), has_halves.then_some(&halves[..]), "{format}");
        let groups = file.groups().unwrap();
        let surfaces = groups.iter().filter(|group| group.dimension == 2);
        let triangles: Vec<_> = surfaces.map(|group| group.triangles().len()).collect();
        assert_eq!(triangles, if has_halves { vec![24, 24] } else { vec![] }, "{format}");
        for format in [Format::Gmsh41, Format::Gmsh22, Format::Sms2dm] {
            Conversion::new(&file, format).unwrap().unwrap().write(&folder.path("out")).unwrap();
            let back = folder.read("out");
            assert_eq!(back.regions(), file.regions());
            assert_eq!(back.remarks(), []);
        }
    }
}

/// WAVEWATCH III's dialect: no physical group, the number of the triangle as the entity, and points on the boundary.
#[test]
fn triangles_of_a_wavewatch_file_are_one_region() {
    let mesh = lattice(6, 4);
    let mut text = format!("$MeshFormat\n2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.points.len());
    for (node, [x, y]) in (1..).zip(&mesh.points) {
        text += &format!("{node} {x:.8} {y:.8} {}.5\n", 20 + node);
    }
    text += &format!(
        "$EndNodes\n$Elements\n{}\n1 15 2 0 0 1\n2 15 2 0 0 2\n",
        mesh.triangles.len() + 2
    );
    for (t, triangle) in (1..).zip(&mesh.triangles) {
        let [a, b, c] = triangle.map(|v| v + 1);
        text += &format!("{} 2 3 0 {t} 0 {a} {b} {c}\n", t + 2);
    }
    text += "$EndElements\n";
    let folder = Folder::new(&[("in.msh", &text)]);
    let file = folder.read("in.msh");
    assert_eq!((file.regions(), between_regions(&file)), (None, Vec::new()));
    assert_eq!(file.groups().unwrap().iter().count(), 0);
    file.write(&folder.path("out.msh"), file.points()).unwrap();
    assert_eq!(folder.text("out.msh"), text);
    let conversion = Conversion::new(&file, Format::Gmsh41).unwrap().unwrap();
    assert!(!conversion.losses().iter().any(|lost| lost.contains("group")));
    assert!(
        conversion.text().unwrap().contains("$Elements\n2 "),
        "points and one block of triangles"
    );
}
