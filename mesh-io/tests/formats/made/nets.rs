//! Makes nets of edges without faces: UGRID, and older nets of Delft3D FM with variables of fixed names.

use super::netcdf::{Attribute, Built, NetCdf};
use super::{Made, PROBED};
use mesh_io::{Format, Precision};
use std::collections::BTreeSet;
use support::Mesh;

/// Number of columns of the lattice of which the sample mesh is made.
const COLUMNS: u32 = 5;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    [(1, false), (2, true), (5, false)].map(|(version, is_old)| net(mesh, version, is_old)).into()
}

/// Returns the edges of a mesh, each once. At each vertex, the first edge is the one from which the triangles of the
/// lattice come in the order of the mesh, counterclockwise: in even rows the edge to the upper right, in odd rows the edge
/// to the right.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let all: BTreeSet<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    let comes_first = |&[a, b]: &[u32; 2]| match a / (COLUMNS + 1) % 2 {
        0 => b == a + COLUMNS + 1,
        _ => b == a + 1,
    };
    let first = all.iter().rev().filter(|edge| comes_first(edge));
    let others = all.iter().filter(|edge| !comes_first(edge));
    // Every third edge is listed from its other end.
    let turned =
        (0..).zip(first.chain(others)).map(|(k, &[a, b])| if k % 3 == 0 { [b, a] } else { [a, b] });
    turned.collect()
}

/// A net of edges.
pub(crate) struct Net<'n> {
    pub(crate) points: &'n [[f64; 2]],
    pub(crate) edges: &'n [[u32; 2]],
    /// Whether variables have the fixed names of older nets of Delft3D FM, which no mesh variable names.
    pub(crate) is_old: bool,
    /// The attribute `units` of x and y.
    pub(crate) units: [&'static str; 2],
    /// The type of each link in an older net.
    pub(crate) types: &'n [i32],
    /// The centers of cells, unless the net is old.
    pub(crate) centers: &'n [[f64; 2]],
    pub(crate) precision: Precision,
    /// The form of netCDF: 1, 2 or 5.
    pub(crate) version: u8,
    /// Number of the first node.
    pub(crate) first: i32,
}

impl Net<'_> {
    /// Returns the names of x, y and the table of edges.
    fn names(&self) -> [&'static str; 3] {
        match self.is_old {
            true => ["NetNode_x", "NetNode_y", "NetLink"],
            false => ["net_x", "net_y", "net_edges"],
        }
    }

    /// Makes the file, with a depth for each node and, unless the net is old, the middle of each edge.
    pub(crate) fn build(&self) -> Built {
        let Net { points, edges, is_old, units, types, centers, precision, version, first } = *self;
        let mut file = NetCdf::new(version);
        let [x, y, table] = self.names();
        if !is_old {
            file.ints("net", &[], &[0]);
            file.attribute("cf_role", Attribute::Text("mesh_topology"));
            file.attribute("topology_dimension", Attribute::Whole(2));
            file.attribute("node_coordinates", Attribute::Text("net_x net_y"));
            file.attribute("edge_node_connectivity", Attribute::Text("net_edges"));
            file.attribute("edge_coordinates", Attribute::Text("edge_x edge_y"));
            if !centers.is_empty() {
                file.attribute("face_coordinates", Attribute::Text("face_x face_y"));
            }
            // The file lacks the variable that this attribute names, as files of Delft3D FM without faces do.
            file.attribute("face_node_connectivity", Attribute::Text("net_faces"));
        }
        for (axis, name) in [x, y].into_iter().enumerate() {
            let numbers: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            file.reals(name, precision, &["node"], &numbers);
            file.attribute("units", Attribute::Text(units[axis]));
        }
        let depths: Vec<f64> = (0..points.len()).map(super::z).collect();
        file.reals("NetNode_z", Precision::Double, &["node"], &depths);
        let nodes: Vec<i32> = edges.as_flattened().iter().map(|&v| v as i32 + first).collect();
        file.ints(table, &["edge", "two"], &nodes);
        if is_old {
            file.ints("NetLinkType", &["edge"], types);
        } else {
            file.attribute("start_index", Attribute::Whole(first));
            for (axis, name) in ["edge_x", "edge_y"].into_iter().enumerate() {
                // A node beyond the list counts as 0.
                let at = |v: u32| points.get(v as usize).map_or(0.0, |point| point[axis]);
                let middles: Vec<f64> = edges.iter().map(|&[a, b]| 0.5 * (at(a) + at(b))).collect();
                file.reals(name, Precision::Double, &["edge"], &middles);
            }
        }
        for (axis, name) in ["face_x", "face_y"].into_iter().enumerate() {
            let numbers: Vec<f64> = centers.iter().map(|center| center[axis]).collect();
            if !numbers.is_empty() {
                file.reals(name, Precision::Double, &["face"], &numbers);
            }
        }
        let mut lengths = vec![("node", points.len()), ("edge", edges.len()), ("two", 2)];
        if !centers.is_empty() {
            lengths.push(("face", centers.len()));
        }
        file.build(&lengths, 0)
    }
}

fn net(mesh: &Mesh, version: u8, is_old: bool) -> Made {
    let edges = edges(mesh);
    let precision = if version == 5 { Precision::Single } else { Precision::Double };
    let first = if version == 5 { 0 } else { 1 };
    let (units, types, centers) = (["m"; 2], &vec![2; edges.len()][..], &[][..]);
    let (points, edges) = (&mesh.points[..], &edges[..]);
    let net = Net { points, edges, is_old, units, types, centers, precision, version, first };
    let built = net.build();
    let size = super::binary::size_of(precision);
    let [x, y, table] = net.names().map(|name| built.variable(name).unwrap());
    Made {
        what: format!("net of edges, version {version} of netCDF, {precision:?}"),
        name: "in.nc",
        format: Format::Ugrid,
        precision,
        mesh: mesh.clone(),
        regions: None,
        vertex: (u64::from(PROBED.0) + first as u64, x.clone()),
        triangle: (PROBED.1 as u64 + first as u64, table),
        lists: built.lists(),
        counts: built.lengths(&["node", "edge"]),
        coordinates: (0..points.len()).map(|i| [x.start + i * size, y.start + i * size]).collect(),
        big: true,
        bytes: built.bytes,
    }
}
