//! Makes grids of coastal models, MFEM, JIGSAW and FreeFem, which consist mostly of rows of numbers.

use super::{
    LINE, Made, POINT, PROBED, QUADRILATERAL, Text, cells, fixing, joined, points, region, regions,
    z,
};
use mesh_io::Format;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;
/// Row of the probed triangle in the list of [`cells`].
const CELL: usize = TRIANGLE + 1;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![
        fort_14(mesh),
        gr3(mesh),
        gr3_of_four(mesh),
        sms(mesh),
        sms_in_order(mesh),
        mike(mesh),
        mike_of_2011(mesh),
        fvcom(mesh),
        fvcom_of_fortran(mesh),
        mfem(mesh),
        mfem_of_words(mesh),
        mfem_of_nodes(mesh),
        jigsaw(mesh),
        jigsaw_in_space(mesh),
        freefem(mesh),
    ]
}

/// Returns node numbers that are not consecutive.
fn sparse(vertices: &[u32]) -> String {
    let numbers: Vec<_> = vertices.iter().map(|v| (100 + 3 * v).to_string()).collect();
    numbers.join("  ")
}

fn fort_14(mesh: &Mesh) -> Made {
    let mut text = Text::new("Bay of 3 islands, 2024 # first try\n ");
    let cells = cells(mesh);
    text.count(cells.len());
    text.put("  ");
    text.count(mesh.points.len());
    text.put(" ! elements, nodes\n");
    // Fortran writes exponents of double precision with a D.
    let fortran = |x: f64| format!("{x:E}").replace('E', "D");
    let vertices = text.rows(mesh.points.iter().enumerate().map(|(i, &[x, y])| {
        format!("{:>9} {} {}  {}", 100 + 3 * i, fortran(x), fortran(y), fortran(z(i)))
    }));
    let triangles = text.rows(
        cells
            .iter()
            .enumerate()
            .map(|(i, c)| format!("{} {} {} {}", 9 + 2 * i, c.len(), sparse(c), i % 2)),
    );
    text.put("1 = Number of open boundaries\n2 = Total number of open boundary nodes\n");
    text.put("2 = Number of nodes for open boundary 1\n100\n103\n0 = Number of land boundaries\n");
    let mesh = fixing(mesh, QUADRILATERAL);
    let probes = [(142, vertices[VERTEX]), (9 + 2 * CELL as u64, triangles[CELL])];
    text.made("with boundaries", "fort.14", Format::Adcirc, mesh, probes)
}

fn gr3(mesh: &Mesh) -> Made {
    let mut text = Text::new("hgrid\n");
    text.count(mesh.triangles.len());
    text.put(" ");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{}\t{point} {}", i + 1, z(i))));
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(i, t)| format!("{} 3 {}", i + 1, joined(t, 1))));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    text.made("without boundaries", "in.gr3", Format::Adcirc, mesh.clone(), probes)
}

/// Makes a grid whose rows all have four nodes. The fourth node of a triangle is 0, its third or its first node.
fn gr3_of_four(mesh: &Mesh) -> Made {
    let mut text = Text::new("mixed\n");
    let cells = cells(mesh);
    text.count(cells.len());
    text.put(" ");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{} {point} {}", i + 1, z(i))));
    let triangles = text.rows(cells.iter().enumerate().map(|(i, cell)| {
        let fourth = match cell.len() {
            4 => String::new(),
            _ => [" 0".to_owned(), format!(" {}", cell[2] + 1), format!(" {}", cell[0] + 1)][i % 3]
                .clone(),
        };
        format!("{} 4 {}{fourth}", i + 1, joined(cell, 1))
    }));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (CELL as u64 + 1, triangles[CELL])];
    let mesh = fixing(mesh, QUADRILATERAL);
    text.made("of four nodes", "in.gr3", Format::Adcirc, mesh, probes)
}

/// Makes a 2dm file with elements before nodes, gaps in the numbers, materials and node strings.
fn sms(mesh: &Mesh) -> Made {
    let mut text = Text::new("MESH2D\nMESHNAME \"ND 1 bay\"\nNUM_MATERIALS_PER_ELEM 1\n");
    let mut triangle = 0;
    let triangles = text.rows(cells(mesh).into_iter().enumerate().map(|(i, cell)| {
        let material = region(triangle);
        triangle += usize::from(cell.len() == 3);
        let kind = if cell.len() == 3 { "E3T" } else { "E4Q" };
        format!("{kind}\t{}  {}   {material}", 9 + 2 * i, sparse(&cell))
    }));
    text.put(&format!("E2L 7 {} 5\n", sparse(&[POINT, 3])));
    let rows = points(mesh);
    let vertices = text.rows(rows.map(|(i, at)| format!("ND {:>6} {at} {}", 100 + 3 * i, z(i))));
    let [a, b] = LINE.map(|v| 100 + 3 * v);
    text.put(&format!(
        "NS  {a} \nNS {b} 100\nNS 103 -106 1 \"shore 160\"\nBEGPARAMDEF\nGM \"Mesh\"\n"
    ));
    let regions = regions(mesh);
    let fixed = [0, 1, 2, 3, POINT].into_iter().chain(LINE).chain(QUADRILATERAL);
    let probes = [(142, vertices[VERTEX]), (9 + 2 * CELL as u64, triangles[CELL])];
    let made = text.made("elements first", "in.2dm", Format::Sms2dm, fixing(mesh, fixed), probes);
    Made { regions, ..made }
}

fn sms_in_order(mesh: &Mesh) -> Made {
    let mut text = Text::new("MESH2D\n");
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("ND {} {at} 0.0", i + 1)));
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(i, t)| format!("E3T {} {}", i + 1, joined(t, 1))));
    // A file that is cut off among the elements is a valid smaller mesh, so the list is removed.
    text.lists.pop();
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    text.made("nodes first", "in.2dm", Format::Sms2dm, mesh.clone(), probes)
}

/// Makes a MIKE mesh with a quadrilateral. Triangles have 0 as their fourth node.
fn mike(mesh: &Mesh) -> Made {
    let mut text = Text::new("100079  1000  ");
    text.count(mesh.points.len());
    text.put(" PROJCS[\"WGS_1984_UTM_Zone_32N\",GEOGCS[\"GCS WGS 1984\"],UNIT[\"Meter\",1]]\n");
    let vertices = text
        .rows(points(mesh).map(|(i, at)| format!("{:>6} {at} {} {}", 100 + 3 * i, z(i), i % 3)));
    let cells = cells(mesh);
    text.count(cells.len());
    text.put("\t4\t25\n");
    let triangles = text.rows(cells.iter().enumerate().map(|(i, cell)| {
        let fourth = if cell.len() == 3 { " 0" } else { "" };
        format!("{} {}{fourth}", 9 + 2 * i, sparse(cell))
    }));
    let probes = [(142, vertices[VERTEX]), (9 + 2 * CELL as u64, triangles[CELL])];
    let mesh = fixing(mesh, QUADRILATERAL);
    text.made("with a quadrilateral", "in.mesh", Format::Mike, mesh, probes)
}

/// Makes a MIKE mesh in the form before 2012, of triangles alone.
fn mike_of_2011(mesh: &Mesh) -> Made {
    let mut text = Text::new("");
    text.count(mesh.points.len());
    text.put("  LONG/LAT\n");
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("{} {at} -5 {}", i + 1, i % 2)));
    text.count(mesh.triangles.len());
    text.put("  3  21\n");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(i, t)| format!("{}\t{}", i + 1, joined(t, 1))));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    text.made("before 2012", "in.mesh", Format::Mike, mesh.clone(), probes)
}

fn fvcom(mesh: &Mesh) -> Made {
    let mut text = Text::new("Node Number = ");
    text.count(mesh.points.len());
    text.put("\nCell Number = ");
    text.count(mesh.triangles.len());
    text.put("\n");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(i, t)| format!("{0} {1} {0}", i + 1, joined(t, 1))));
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("{} {at} {}", i + 1, z(i))));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    text.made("with depths", "in_grd.dat", Format::Fvcom, mesh.clone(), probes)
}

/// Makes an FVCOM grid with commas and comments, without depths.
fn fvcom_of_fortran(mesh: &Mesh) -> Made {
    let mut text = Text::new("Node Number=");
    text.count(mesh.points.len());
    text.put(" ! of the bay\n\n  cell number =\t");
    text.count(mesh.triangles.len());
    text.put("\n");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(i, [a, b, c])| {
        let [a, b, c] = [a, b, c].map(|v| 100 + 3 * v);
        format!("{} , {a},{b} ,\t{c} /", 9 + 2 * i)
    }));
    let vertices = text.rows(
        mesh.points.iter().enumerate().map(|(i, [x, y])| format!("  {}\t{x} {y} /", 100 + 3 * i)),
    );
    let probes = [(142, vertices[VERTEX]), (9 + 2 * TRIANGLE as u64, triangles[TRIANGLE])];
    text.made("with commas", "in_grd.dat", Format::Fvcom, mesh.clone(), probes)
}

/// Makes a mesh as MFEM writes it, with a quadrilateral and named sets of attributes.
fn mfem(mesh: &Mesh) -> Made {
    let head = "MFEM mesh v1.3\n\n#\n# TRIANGLE    = 2\n#\n\ndimension\n2\n\nelements\n";
    let mut text = Text::new(head);
    let cells = cells(mesh);
    text.count(cells.len());
    text.put("\n");
    let mut triangle = 0;
    let triangles = text.rows(cells.iter().map(|cell| {
        let (attribute, kind) = (region(triangle), cell.len() - 1);
        triangle += usize::from(kind == 2);
        format!("{attribute} {kind} {}", joined(cell, 0))
    }));
    text.put("\nattribute_sets\n1\n\"steel\" 1 5\n\nboundary\n");
    text.count(2);
    text.put("\n");
    text.rows([format!("7 1 {}", joined(&LINE, 0)), "8 1 0 1".into()]);
    text.put("\nvertices\n");
    text.count(mesh.points.len());
    text.put("\n3\n");
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("{at} {}", z(i))));
    text.put("mfem_mesh_end\n");
    let probes = [(u64::from(PROBED.0), vertices[VERTEX]), (CELL as u64, triangles[CELL])];
    let regions = regions(mesh);
    let mesh = fixing(mesh, QUADRILATERAL.into_iter().chain(LINE).chain([0, 1]));
    Made { regions, ..text.made("with a quadrilateral", "in.mesh", Format::Mfem, mesh, probes) }
}

/// Makes an MFEM mesh with many words per line.
fn mfem_of_words(mesh: &Mesh) -> Made {
    let mut text = Text::new("MFEM mesh v1.0\n dimension 2 elements ");
    text.count(mesh.triangles.len());
    text.put("\n");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(t, c)| format!(" {}\t2  {}", region(t), joined(c, 0))));
    text.put("boundary 0 vertices ");
    text.count(mesh.points.len());
    text.put(" 2\n");
    let vertices = text.rows(points(mesh).map(|(_, at)| at));
    let probes = [(u64::from(PROBED.0), vertices[VERTEX]), (17, triangles[TRIANGLE])];
    let regions = regions(mesh);
    Made { regions, ..text.made("of words", "in.mesh", Format::Mfem, mesh.clone(), probes) }
}

/// Makes an MFEM mesh whose points are those of a finite element space of order 1.
fn mfem_of_nodes(mesh: &Mesh) -> Made {
    let mut text = Text::new("MFEM mesh v1.0\n\ndimension\n2\n\nelements\n");
    text.count(mesh.triangles.len());
    text.put("\n");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(t, c)| format!("{} 2 {}", region(t), joined(c, 0))));
    text.put("\nboundary\n0\n\nvertices\n");
    text.count(mesh.points.len());
    text.put("\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: H1_2D_P1\nVDim: 3\nOrdering: 1\n\n");
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("{at} {}", z(i))));
    let probes = [(u64::from(PROBED.0), vertices[VERTEX]), (17, triangles[TRIANGLE])];
    let regions = regions(mesh);
    Made { regions, ..text.made("of nodes", "in.mesh", Format::Mfem, mesh.clone(), probes) }
}

/// Makes a JIGSAW mesh with an edge, a quadrilateral, tags and values of points, and with element lists before the
/// points.
fn jigsaw(mesh: &Mesh) -> Made {
    let mut text = Text::new("# in.msh; by hand\nmshid=3;euclidean-mesh\nTRIA3=");
    text.count(mesh.triangles.len());
    text.put("\n");
    let semicolons = |vertices: &[u32]| joined(vertices, 0).replace(' ', " ; ");
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(t, c)| format!("{};{}", semicolons(c), region(t))));
    text.put("quad4=1\n");
    text.rows([format!("{};2", semicolons(&QUADRILATERAL)), String::new()]);
    text.put("NDIMS=2\nPOINT= ");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(
        mesh.points
            .iter()
            .enumerate()
            .map(|(i, [x, y])| format!("{x:e} ;\t{y};{}", i as i32 % 3 - 1)),
    );
    text.put(&format!("EDGE2=1\n{};-3\nVALUE={};2\n", semicolons(&LINE), mesh.points.len()));
    (0..mesh.points.len()).for_each(|i| text.put(&format!("{};{i}\n", z(i))));
    text.put("BOUND=1\n1;0;3\n");
    let probes = [(u64::from(PROBED.0), vertices[VERTEX]), (17, triangles[TRIANGLE])];
    let regions = regions(mesh);
    let mesh = fixing(mesh, QUADRILATERAL.into_iter().chain(LINE));
    Made { regions, ..text.made("elements first", "in.msh", Format::Jigsaw, mesh, probes) }
}

/// Makes a mesh as JIGSAW writes it, with three coordinates.
fn jigsaw_in_space(mesh: &Mesh) -> Made {
    let mut text =
        Text::new("# in.msh; created by JIGSAW\nMSHID=3;EUCLIDEAN-MESH\nNDIMS=3\nPOINT=");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices =
        text.rows(mesh.points.iter().enumerate().map(|(i, [x, y])| format!("{x};{y};{};0", z(i))));
    text.put("TRIA3=");
    text.count(mesh.triangles.len());
    text.put("\n");
    let rows = mesh.triangles.iter();
    let triangles = text.rows(rows.map(|c| format!("{};0", joined(c, 0).replace(' ', ";"))));
    let probes = [(u64::from(PROBED.0), vertices[VERTEX]), (17, triangles[TRIANGLE])];
    text.made("in space", "in.msh", Format::Jigsaw, mesh.clone(), probes)
}

fn freefem(mesh: &Mesh) -> Made {
    let mut text = Text::new(" ");
    text.count(mesh.points.len());
    text.put("  ");
    text.count(mesh.triangles.len());
    text.put(" ");
    text.count(2);
    text.put("\n");
    let vertices = text.rows(points(mesh).map(|(i, point)| format!("{point}  {}", i % 4)));
    let rows = mesh.triangles.iter().enumerate();
    let triangles = text.rows(rows.map(|(t, c)| format!("{}\t{}", joined(c, 1), region(t))));
    text.rows([format!("{} -1", joined(&LINE, 1)), "1 2 4".into()]);
    text.put("\n \n");
    let regions = regions(mesh);
    let mesh = fixing(mesh, [0, 1].into_iter().chain(LINE));
    let probes = [(VERTEX as u64 + 1, vertices[VERTEX]), (18, triangles[TRIANGLE])];
    Made { regions, ..text.made("as it is written", "in.msh", Format::FreeFem, mesh, probes) }
}
