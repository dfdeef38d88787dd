//! Makes input files of Abaqus and CalculiX as several programs write them.

use super::{LINE, Made, POINT, PROBED, QUADRILATERAL, Text, fixing, number, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;
/// Index of the first triangle of the second region.
const SECOND: usize = super::SECOND_REGION;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![flat(mesh), elements_first(mesh), parts(mesh)]
}

fn made(text: Text, what: &str, mesh: Mesh, probes: [(u64, usize); 2]) -> Made {
    let regions = regions(&mesh);
    let made = text.made(what, "in.inp", Format::Abaqus, mesh, probes);
    Made { regions, precision: Precision::Text20, ..made }
}

/// Writes x and y in several styles, separated by a comma.
fn point(vertex: usize, [x, y]: [f64; 2]) -> String {
    let comma = [" , ", "\t,", ", \t "][vertex % 3];
    format!("{} {comma} {}", number(vertex, x), number(vertex + 1, y))
}

/// Returns vertex numbers, which are multiples of three apart and start at 100.
fn sparse(vertices: &[u32]) -> String {
    let numbers: Vec<_> = vertices.iter().map(|v| (100 + 3 * v).to_string()).collect();
    numbers.join(" , ")
}

/// Adds rows of triangles with the numbers 10, 12, 14 and so on. Returns the offset of each row.
fn triangles(text: &mut Text, mesh: &Mesh, range: std::ops::Range<usize>) -> Vec<usize> {
    let rows = range.map(|t| format!("{}, {}", 10 + 2 * t, sparse(&mesh.triangles[t])));
    let starts = text.rows(rows);
    // A file that is cut off among the elements may be a valid smaller mesh.
    text.lists.pop();
    starts
}

/// Makes a file like those of gmsh: no parts, one set per element list.
fn flat(mesh: &Mesh) -> Made {
    let mut text = Text::new("*Heading\n in.inp, *NODE\n*NODE , NSET = all\n");
    let rows = mesh.points.iter().enumerate();
    let vertices =
        text.rows(rows.map(|(i, &at)| format!("{}, {} , {}", 100 + 3 * i, point(i, at), z(i))));
    text.put("******* E L E M E N T S *************\n*ELEMENT, type=T3D2, ELSET=Line1\n");
    text.put(&format!("1, {}\n", sparse(&LINE)));
    text.put("*ELEMENT, type=CPS3, ELSET=Surface1\n");
    triangles(&mut text, mesh, 0..10);
    text.put(&format!("*ELEMENT, type=CPS4, ELSET=Surface1\n 5000, {}\n", sparse(&QUADRILATERAL)));
    text.put("*ELEMENT, type=CPS3, ELSET=surface1\n");
    let probed = triangles(&mut text, mesh, 10..SECOND)[TRIANGLE - 10];
    text.put("*ELEMENT, type=CPE3, ELSET=Surface2\n");
    triangles(&mut text, mesh, SECOND..mesh.triangles.len());
    text.put(&format!("*ELEMENT,TYPE=MASS\n3, {}\n", sparse(&[POINT])));
    text.put(
        "*ELSET,ELSET=left\n10, 12, 14,\n16\n*NSET,NSET=corner\n100\n*STEP\n*STATIC\n*END STEP\n",
    );
    let mesh = fixing(mesh, [POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(142, vertices[VERTEX]), (10 + 2 * TRIANGLE as u64, probed)];
    made(text, "flat", mesh, probes)
}

/// Makes a file with elements before nodes, keywords in small letters, rows of several lines, and comments and blank
/// lines among the rows.
fn elements_first(mesh: &Mesh) -> Made {
    let mut text = Text::new("** by hand\n*element , type = s3r ,\n elset = \"Plate\"\n\n");
    let mut rows: Vec<_> =
        (0..SECOND).map(|t| format!("{}, {}", 10 + 2 * t, sparse(&mesh.triangles[t]))).collect();
    rows[3] = rows[3].replacen(" , ", " ,\n** comment\n\n  ", 1);
    rows[5].push_str(" ,");
    rows[7] = format!("** 1, 2, 3, 4\n{}", rows[7]);
    let probed = text.rows(rows)[TRIANGLE];
    text.put("*Element, Type=M3D3, Elset=Rim\n");
    triangles(&mut text, mesh, SECOND..mesh.triangles.len());
    text.put(&format!("*Element, type=U7\n9, {},\n {}\n", sparse(&LINE), sparse(&[POINT])));
    text.put("*user element, type=U7, nodes=3\n1, 2\n* node\n");
    let half = mesh.points.len() / 2;
    let row = |(i, &at): (usize, &[f64; 2])| {
        let end = if i % 2 == 0 { " , 0." } else { " ," };
        format!("{} , {}{end}", 100 + 3 * i, point(i, at))
    };
    let mut vertices = text.rows(mesh.points.iter().enumerate().take(half).map(row));
    text.put("*NODE, NSET=more, SYSTEM=R\n");
    vertices.extend(text.rows(mesh.points.iter().enumerate().skip(half).map(row)));
    text.put("*END");
    let mesh = fixing(mesh, [POINT].into_iter().chain(LINE));
    let probes = [(142, vertices[VERTEX]), (10 + 2 * TRIANGLE as u64, probed)];
    made(text, "elements first", mesh, probes)
}

/// Makes a file like those of Abaqus/CAE: a part with sections and sets, and an assembly that instantiates the part and
/// adds a node, a spring and a surface.
fn parts(mesh: &Mesh) -> Made {
    let mut text = Text::new("*Heading\n** PARTS\n**\n*Part, name=Plate\n*Node\n");
    let rows = mesh.points.iter().enumerate();
    let vertices = text.rows(rows.map(|(i, &at)| format!("{:>7}, {}", 100 + 3 * i, point(i, at))));
    text.put("*Element, type=CPS3\n");
    let count = mesh.triangles.len();
    let probed = triangles(&mut text, mesh, 0..count)[TRIANGLE];
    let last = |t: usize| 10 + 2 * t;
    text.put(&format!(
        "*Elset, elset=_PickedSet2, internal, generate\n 10, {}, 2\n",
        last(SECOND - 1)
    ));
    text.put(&format!(
        "*Elset, elset=Set-1, generate\n {}, {}, 2\n",
        last(SECOND),
        last(count - 1)
    ));
    text.put("** Section: a\n*Solid Section, elset=_PickedSet2, material=Steel\n,\n");
    text.put("*Solid Section, elset=SET-1, material=Tin\n,\n*End Part\n**\n*Part, name=Tool\n*End Part\n");
    text.put("*Assembly, name=Assembly\n*Instance, name=Plate-1, part=Plate\n 5., 0., 0.\n*End Instance\n");
    text.put("*Instance, name=Tool-1, part=Tool\n*End Instance\n*Node\n1, 7., 7., 0.\n");
    text.put(&format!(
        "*Element, type=SPRINGA\n1, Plate-1.{}, 1\n2, Tool-1.5, 1\n",
        100 + 3 * POINT
    ));
    text.put("*Nset, nset=Set-1, instance=Plate-1\n 100, 103\n*Nset, nset=Set-1\n 1\n");
    let side = last(TRIANGLE);
    text.put(&format!("*Elset, elset=_S_S2, internal, instance=Plate-1\n {side},\n"));
    text.put("*Surface, type=ELEMENT, name=S\n_S_S2, S2\n*End Assembly\n*Material, name=Steel\n*Elastic\n 210000., 0.3\n");
    let [_, b, c] = mesh.triangles[TRIANGLE];
    let mesh = fixing(mesh, [POINT, b, c]);
    let probes = [(142, vertices[VERTEX]), (10 + 2 * TRIANGLE as u64, probed)];
    made(text, "with parts", mesh, probes)
}
