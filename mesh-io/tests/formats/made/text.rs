//! Makes files of text formats with keywords or headers, except VTK.

use super::{
    LINE, Made, POINT, PROBED, QUADRILATERAL, Text, cells, fixing, joined, point, points, region,
    regions, triples, z,
};
use mesh_io::Format;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;
/// Row of the probed triangle in the list of [`cells`].
const CELL: usize = TRIANGLE + 1;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![
        su2(mesh),
        su2_elements_first(mesh),
        su2_zones(mesh),
        medit(mesh),
        medit_of_space(mesh),
        obj(mesh),
        obj_counted_back(mesh),
        off(mesh),
        off_with_normals(mesh),
    ]
}

fn su2_points(text: &mut Text, mesh: &Mesh, more: &str) -> Vec<usize> {
    text.put("NPOIN= ");
    text.count(mesh.points.len());
    text.put(more);
    text.rows(points(mesh).map(|(i, point)| match i % 3 {
        0 => point,
        1 => format!("  {point} {i}"),
        _ => format!("{point}\t{i}\n% between"),
    }))
}

fn su2_elements(text: &mut Text, cells: &[Vec<u32>]) -> Vec<usize> {
    text.put("NELEM= ");
    text.count(cells.len());
    text.put("\n");
    text.rows(cells.iter().enumerate().map(|(i, cell)| {
        let kind = if cell.len() == 3 { 5 } else { 9 };
        let index = if i % 2 == 0 { format!(" {i}") } else { String::new() };
        format!("{kind}  {}{index}", joined(cell, 0))
    }))
}

fn su2_markers(text: &mut Text) {
    text.put("NMARK= 2\nMARKER_TAG= shore\nMARKER_ELEMS= ");
    text.count(2);
    text.put("\n3 0 1\n3 1 2 7\nMARKER_TAG= inner\nMARKER_ELEMS= ");
    text.count(2);
    text.put(&format!(" % two\n3 {}\n1 {POINT}\n", joined(&LINE, 0)));
}

fn su2(mesh: &Mesh) -> Made {
    let mut text = Text::new("% by hand\n%\nNDIME= 2 % of the plane\n\n");
    let vertices = su2_points(&mut text, mesh, " 28 % 2 of them not its own\n");
    let triangles = su2_elements(&mut text, &cells(mesh));
    su2_markers(&mut text);
    text.put("FFD_NBOX= 0\n% end");
    let mesh = fixing(mesh, [0, 1, 2, POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(VERTEX as u64, vertices[VERTEX]), (CELL as u64, triangles[CELL])];
    text.made("points first", "in.su2", Format::Su2, mesh, probes)
}

fn su2_elements_first(mesh: &Mesh) -> Made {
    let mut text = Text::new("NDIME=2\n");
    su2_markers(&mut text);
    let triangles = su2_elements(&mut text, &triples(mesh));
    let vertices = su2_points(&mut text, mesh, "\n");
    let mesh = fixing(mesh, [0, 1, 2, POINT].into_iter().chain(LINE));
    let probes = [(VERTEX as u64, vertices[VERTEX]), (TRIANGLE as u64, triangles[TRIANGLE])];
    text.made("elements first", "in.su2", Format::Su2, mesh, probes)
}

/// Makes an SU2 file with the mesh twice, in two zones.
fn su2_zones(mesh: &Mesh) -> Made {
    let mut text = Text::new("NZONE= 2\n");
    let mut both = Mesh::default();
    let mut probes = Vec::new();
    for zone in 0..2 {
        text.put(&format!("IZONE= {}\nNDIME= 2\n", zone + 1));
        let mut own = mesh.clone();
        own.points.iter_mut().for_each(|p| p[0] += 8.0 * f64::from(zone));
        let triangles = su2_elements(&mut text, &triples(&own));
        let vertices = su2_points(&mut text, &own, "\n");
        text.put(&format!(
            "NMARK= 1\nMARKER_TAG= inner\nMARKER_ELEMS= 1\n3 {}\n",
            joined(&LINE, 0)
        ));
        probes.push([(VERTEX as u64, vertices[VERTEX]), (TRIANGLE as u64, triangles[TRIANGLE])]);
        let first = both.points.len() as u32;
        both.points.extend(own.points);
        both.triangles.extend(own.triangles.iter().map(|t| t.map(|v| v + first)));
        both.fixed.extend(LINE.map(|v| v + first));
    }
    let of_second = |t| u32::from(t >= mesh.triangles.len());
    let regions = Some((0..both.triangles.len()).map(of_second).collect());
    Made { regions, ..text.made("two zones", "in.su2", Format::Su2, both, probes[0]) }
}

fn medit(mesh: &Mesh) -> Made {
    let mut text = Text::new("MeshVersionFormatted 2\n\nDimension 2\n# of the plane\nVertices\n");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{point} {}", i % 3)));
    text.put("\nTriangles\n");
    text.count(mesh.triangles.len());
    text.put("\n");
    let triangles =
        text.rows(mesh.triangles.iter().map(|t| format!("\t{}  1 # one", joined(t, 1))));
    text.put("\nTetrahedra\n0\n");
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    text.made("of two coordinates", "in.mesh", Format::Medit, mesh.clone(), probes)
}

fn medit_of_space(mesh: &Mesh) -> Made {
    let mut text =
        Text::new("\n MeshVersionFormatted\n1\nDimension\n3\nCorners 2\n1\n6\nTriangles ");
    text.count(mesh.triangles.len());
    text.put("\n");
    let name = |t| if region(t) == 5 { 5 } else { -2 };
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(t, c)| format!("{} {}", joined(c, 1), name(t))));
    text.put("RequiredVertices\n");
    text.count(1);
    text.put(&format!("\n{}\nVertices\n", POINT + 1));
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{point} {:.3} -{i}", z(i))));
    text.put("Edges\n");
    text.count(1);
    text.put(&format!("\n{} 7\nRidges\n1\n1\nQuadrilaterals\n", joined(&LINE, 1)));
    text.count(1);
    text.put(&format!(
        "\n{} 0\nNormals\n1\n0 0 1\nEnd\nafter the end\n",
        joined(&QUADRILATERAL, 1)
    ));
    let regions = regions(mesh);
    let mesh = fixing(mesh, [0, 5, POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    Made { regions, ..text.made("of three coordinates", "in.mesh", Format::Medit, mesh, probes) }
}

fn obj(mesh: &Mesh) -> Made {
    let mut text = Text::new("mtllib sea.mtl\n# by hand\no bay\nvt 0.5 0.5\nvn 0 0 1\n\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| match i % 3 {
        0 => format!("v {point} {}", z(i)),
        1 => format!("v  {point} {} 1 0.5 0.5 # red", z(i)),
        _ => format!("v\t{point} {} \nvn 0 1 0", z(i)),
    }));
    text.put("g open sea\nusemtl water\ns off\n");
    let mut triangle = 0;
    let faces = text.rows(cells(mesh).into_iter().enumerate().map(|(i, cell)| {
        let corner = |v: &u32| match i % 4 {
            0 => format!(" {}", v + 1),
            1 => format!("  {}/1", v + 1),
            2 => format!(" {}/1/1", v + 1),
            _ => format!("\t{}//2", v + 1),
        };
        let face: String = cell.iter().map(corner).collect();
        triangle += usize::from(cell.len() == 3);
        let next = region(triangle) != region(triangle.saturating_sub(1)) && cell.len() == 3;
        format!("f{face}{}", if next { "\nusemtl ice" } else { "" })
    }));
    // A file that is cut off among the faces is a valid smaller mesh, so the list is removed.
    text.lists.pop();
    text.put(&format!("l {}\np {}\n", joined(&LINE, 1), POINT + 1));
    let regions = regions(mesh);
    let mesh = fixing(mesh, [POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (CELL as u64 + 1, faces[CELL])];
    Made { regions, ..text.made("of materials", "in.obj", Format::Obj, mesh, probes) }
}

/// Makes an OBJ with each face right after its last vertex, by numbers counted back from the latest vertex.
fn obj_counted_back(mesh: &Mesh) -> Made {
    let mut text = Text::default();
    let (mut before, mut probes) = (0, [(VERTEX as u64 + 1, 0), (18, 0)]);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let last = triangle.iter().max().map_or(0, |&v| v as usize);
        while before <= last && before < mesh.points.len() {
            if before == VERTEX {
                probes[0].1 = text.text.len();
            }
            text.put(&format!("v {} 0.0\n", point(before, mesh.points[before])));
            before += 1;
        }
        if t == TRIANGLE {
            probes[1].1 = text.text.len();
        }
        let back = |v: u32| match i64::from(v) - before as i64 {
            back @ ..0 => back,
            _ => i64::from(v) + 1,
        };
        let [a, b, c] = triangle.map(back);
        text.put(&format!("f {a} {b}/{b} {c}//\n"));
    }
    text.made("counted back", "in.obj", Format::Obj, mesh.clone(), probes)
}

fn off(mesh: &Mesh) -> Made {
    let mut text = Text::new("OFF\n# by hand\n\n  ");
    text.count(mesh.points.len());
    text.put("\t");
    let mut faces = cells(mesh);
    faces.push(LINE.to_vec());
    faces.push(vec![POINT]);
    text.count(faces.len());
    text.put(" 0 # no edges\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{point} {}", z(i))));
    let triangles = text.rows(faces.iter().enumerate().map(|(i, face)| {
        let color = ["", " 255 0 0", "  0.5 0.5 0.5 1 # gray\n"][i % 3];
        format!("{}  {}{color}", face.len(), joined(face, 0))
    }));
    let mesh = fixing(mesh, [POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(VERTEX as u64, vertices[VERTEX]), (CELL as u64, triangles[CELL])];
    text.made("with colors", "in.off", Format::Off, mesh, probes)
}

fn off_with_normals(mesh: &Mesh) -> Made {
    let mut text = Text::new("NOFF ");
    text.count(mesh.points.len());
    text.put(" ");
    text.count(mesh.triangles.len());
    text.put(" 69\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!(" {point} {} 0 0 1", z(i))));
    let triangles = text.rows(mesh.triangles.iter().map(|t| format!("3 {}", joined(t, 0))));
    let probes = [(VERTEX as u64, vertices[VERTEX]), (TRIANGLE as u64, triangles[TRIANGLE])];
    text.made("with normals", "in.off", Format::Off, mesh.clone(), probes)
}
