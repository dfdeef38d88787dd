//! Nets of Delft3D, which list edges and no faces.

use std::collections::BTreeSet;
use std::fs;

use super::{Folder, assert_holds, disturbed};
use mesh_io::MeshFile;
use support::{Binary, Mesh};

/// Adds a name or a text in netCDF's classic format: its length, its bytes, and zeros up to a multiple of four.
fn put_text(out: &mut Binary, text: &str) {
    out.ints(&[text.len() as i32]);
    out.text(text);
    out.bytes.resize(out.bytes.len().next_multiple_of(4), 0);
}

/// Returns an older net in netCDF's classic format. `units` are the units of x and y.
fn net(mesh: &Mesh, units: [&str; 2]) -> Vec<u8> {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let edges: BTreeSet<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    let mut out = Binary::empty(true);
    out.text("CDF\u{1}");
    out.ints(&[0, 10, 3]);
    let lengths = [("nNetNode", mesh.points.len()), ("nNetLink", edges.len()), ("two", 2)];
    for (name, length) in lengths {
        put_text(&mut out, name);
        out.ints(&[length as i32]);
    }
    out.ints(&[0, 0, 11, 3]);
    let mut begins = Vec::new();
    let sizes = [8 * mesh.points.len(), 8 * mesh.points.len(), 8 * edges.len()];
    for (k, name) in ["NetNode_x", "NetNode_y", "NetLink"].into_iter().enumerate() {
        put_text(&mut out, name);
        out.ints(if k < 2 { &[1, 0] } else { &[2, 1, 2] });
        match units.get(k) {
            Some(unit) => {
                out.ints(&[12, 1]);
                put_text(&mut out, "units");
                out.ints(&[2]);
                put_text(&mut out, unit);
            }
            None => out.ints(&[0, 0]),
        }
        out.ints(&[if k < 2 { 6 } else { 4 }, sizes[k] as i32]);
        begins.push(out.bytes.len());
        out.ints(&[0]);
    }
    let starts = [0, sizes[0], sizes[0] + sizes[1]].map(|start| start + out.bytes.len());
    for (begin, start) in begins.into_iter().zip(starts) {
        out.bytes[begin..begin + 4].copy_from_slice(&(start as u32).to_be_bytes());
    }
    for axis in [0, 1] {
        out.doubles(&mesh.points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    }
    let nodes: Vec<i32> = edges.iter().flatten().map(|&v| v as i32 + 1).collect();
    out.ints(&nodes);
    out.bytes
}

#[test]
fn a_net_is_smoothed_by_the_triangles_between_its_edges() {
    let mesh = disturbed();
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.nc"), net(&mesh, ["m"; 2])).unwrap();
    let run = folder.line("in.nc out.nc --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["cells were found from edges, as the file lists no faces"]);
    let [before, after] =
        ["in.nc", "out.nc"].map(|name| MeshFile::read(&folder.path(name)).unwrap());
    assert_eq!(before.triangles().len(), mesh.triangles.len());
    assert_eq!(before.triangles(), after.triangles());
    assert!(before.points() != after.points() && before.difference(&after).is_none());
}

#[test]
fn coordinates_of_a_net_look_like_degrees_unless_units_say_otherwise() {
    let mut mesh = disturbed();
    mesh.points.iter_mut().for_each(|[_, y]| *y = 60.0 + 0.5 * *y);
    let folder = Folder::new(&[]);
    let note = "--surface sphere smooths them as longitude and latitude";
    for (units, is_noted) in
        [(["", ""], true), (["degrees_east", "degrees_north"], true), (["m", "m"], false)]
    {
        fs::write(folder.path("in.nc"), net(&mesh, units)).unwrap();
        let run = folder.line("in.nc out.nc --engine cpu");
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_eq!(run.err.contains(note), is_noted, "{units:?}: {}", run.err);
    }
}
