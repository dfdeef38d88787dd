//! Makes bulk data of Nastran in small, large and free field.

use super::{LINE, Made, POINT, PROBED, QUADRILATERAL, Text, fixing, number, region, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![small(mesh), large(mesh), free(mesh)]
}

/// Returns the vertex number in the file: 100, 103, 106 and so on.
fn tag(vertex: u32) -> usize {
    100 + 3 * vertex as usize
}

fn made(text: Text, what: &str, mesh: &Mesh, precision: Precision, starts: [usize; 2]) -> Made {
    let fixed = [POINT].into_iter().chain(LINE).chain(QUADRILATERAL);
    let mesh = fixing(mesh, fixed);
    let regions = regions(&mesh);
    let probes = [(tag(PROBED.0) as u64, starts[0]), (10 + 2 * TRIANGLE as u64, starts[1])];
    let made = text.made(what, "in.bdf", Format::Nastran, mesh, probes);
    Made { regions, precision, ..made }
}

/// Writes a number, rounded to the precision, in at most `most` characters.
fn fitting(x: f64, precision: Precision, most: usize) -> String {
    let x = precision.rounded(x);
    let scientific = format!("{x:e}").replace("e-", "-").replace('e', "+");
    let forms =
        [format!("{x:?}"), format!("{x}"), format!("{x}").replacen("0.", ".", 1), scientific];
    let fits = forms.iter().find(|form| form.len() <= most);
    fits.unwrap_or_else(|| panic!("{x:?} does not fit")).clone()
}

/// Writes a card with fields of `width` characters, broken into lines of four or eight fields.
fn fixed(name: &str, width: usize, fields: &[String]) -> String {
    let (mark, count) = if width == 16 { ("*", 4) } else { ("", 8) };
    let lines = fields.chunks(count).enumerate().map(|(line, fields)| {
        let head = if line == 0 { format!("{name}{mark}") } else { mark.to_owned() };
        let fields: String = fields.iter().map(|field| format!("{field:>width$}")).collect();
        format!("{head:<8}{fields}")
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn corners(numbers: [usize; 2], vertices: &[u32]) -> Vec<String> {
    let nodes = vertices.iter().map(|&vertex| tag(vertex));
    numbers.into_iter().chain(nodes).map(|number| number.to_string()).collect()
}

fn triangle(mesh: &Mesh, t: usize) -> Vec<String> {
    corners([10 + 2 * t, region(t) as usize], &mesh.triangles[t])
}

/// Makes a file like those of preprocessors, with all sections. Some rows have tabs, and element cards precede and
/// follow node cards.
fn small(mesh: &Mesh) -> Made {
    let precision = Precision::Text8;
    let mut text =
        Text::new("$ by hand\nSOL 101\nCEND\nTITLE = GRID\nSPC = 1\n begin bulk\nPARAM,POST,-1\n");
    text.put(&fixed("CQUAD4", 8, &corners([9000, 5], &QUADRILATERAL)));
    text.put("\n$ GRID, 1,,0.,0.\n");
    let rows = mesh.points.iter().enumerate().map(|(v, &[x, y])| {
        let [x, y] = [x, y].map(|x| fitting(x, precision, 8));
        let fields = [tag(v as u32).to_string(), String::new(), x, y, z(v).to_string(), "0".into()];
        let has_room = fields.iter().all(|field| field.len() < 8);
        match v % 4 {
            0 => fixed("GRID", 8, &fields),
            1 if has_room => format!("grid\t{}", fields.join("\t")),
            2 => fixed("Grid", 8, &fields[..4]) + &format!("{:<8}$ 0.5, 7", fields[4]),
            _ => format!("{:<72}+A{v}\n+A{v}     0.5", fixed("GRID", 8, &fields)),
        }
    });
    let vertices = text.rows(rows.collect::<Vec<_>>());
    let rows = (0..mesh.triangles.len()).map(|t| fixed("CTRIA3", 8, &triangle(mesh, t)));
    let triangles = text.rows(rows);
    text.lists.pop();
    text.put(&fixed("CBAR", 8, &corners([9001, 7], &LINE)));
    text.put(&format!("\n{}", fixed("CONM2", 8, &corners([9002, tag(POINT)], &[]))));
    text.put("\nenddata\nGRID, 1\n");
    made(text, "small field", mesh, precision, [vertices[VERTEX], triangles[TRIANGLE]])
}

/// Makes bulk data in large field without other sections. Elements are in large and in small field.
fn large(mesh: &Mesh) -> Made {
    let precision = Precision::Text16;
    let mut text = Text::new("$HMNAME PROP 5\"one\" 4\n");
    let rows = (0..mesh.triangles.len()).map(|t| match t % 3 {
        0 => fixed("CTRIA3", 16, &triangle(mesh, t)),
        1 => fixed("CTRIA3", 16, &triangle(mesh, t)).replace("\n*", "\n$ 7, 8\n\n*"),
        _ => fixed("CTRIAR", 8, &triangle(mesh, t)),
    });
    let triangles = text.rows(rows.collect::<Vec<_>>());
    text.put(&format!("CONROD,9000,{},{},1,.5\n", tag(LINE[0]), tag(LINE[1])));
    text.put(&fixed("CQUAD4", 16, &corners([9001, 5], &QUADRILATERAL)));
    text.put(&format!("\nCELAS2,9002,1.+3,{},1,,\n", tag(POINT)));
    let rows = mesh.points.iter().enumerate().map(|(v, &[x, y])| {
        let [x, y] = [x, y].map(|x| fitting(x, precision, 16));
        let fields = [tag(v as u32).to_string(), "0".into(), x, y, z(v).to_string()];
        match v % 3 {
            0 => fixed("GRID", 16, &fields),
            1 => fixed("GRID", 16, &fields).replace("\n*", "+B\n$ 7.\n*"),
            _ => format!("GRID*, {}\n*, {}", fields[..4].join(" ,"), fields[4]),
        }
    });
    let vertices = text.rows(rows.collect::<Vec<_>>());
    made(text, "large field", mesh, precision, [vertices[VERTEX], triangles[TRIANGLE]])
}

/// Makes bulk data in free field, with all digits, as programs write that ignore the limits of fields.
fn free(mesh: &Mesh) -> Made {
    let mut text = Text::new("BEGIN BULK\n");
    let rows = mesh.points.iter().enumerate().map(|(v, &[x, y])| {
        let comma = [",", " , ", ",\t"][v % 3];
        let fields = [
            tag(v as u32).to_string(),
            String::new(),
            number(v, x),
            number(v + 1, y),
            z(v).to_string(),
        ];
        let end = ["", ",,$ 5", ",,,,\r"][v % 3];
        format!("GRID{comma}{}{end}", fields.join(comma))
    });
    let vertices = text.rows(rows.collect::<Vec<_>>());
    let rows = (0..mesh.triangles.len())
        .map(|t| format!("CTRIA3 , {},0.,", triangle(mesh, t).join(" , ")));
    let triangles = text.rows(rows);
    text.lists.pop();
    text.put(&format!("CQUADR,{}\n", corners([9001, 5], &QUADRILATERAL).join(",")));
    text.put(&format!("PLOTEL,9000,{},{}\n", tag(LINE[0]), tag(LINE[1])));
    text.put(&format!("RBE3,9002,,{},123,1.,123,{}\n", tag(POINT), tag(LINE[0])));
    made(text, "free field", mesh, Precision::Double, [vertices[VERTEX], triangles[TRIANGLE]])
}
