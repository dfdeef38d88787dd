//! Orders vertices along a space-filling curve (Z-order): most mesh neighbors are also close along the curve.

use glam::DVec2;
use rayon::slice::ParallelSliceMut;

use crate::mesh::Mesh;
use crate::parallel::counting_sort::Groups;
use crate::parallel::{for_each_part, map_ranges};
use crate::topology::Topology;

/// Average number of vertices in a cell of the first pass of sorting.
const PER_CELL: usize = 8;

/// Number of cells that one task sorts.
const CELLS: usize = 1 << 8;

/// Number of vertices from which the cell is sorted by several threads.
const CROWD: usize = 1 << 14;

/// Returns the vertices that some triangle uses, in the order of their positions along a Z-order curve.
pub(crate) fn along_curve(mesh: &Mesh, topology: &Topology<'_>) -> Vec<u32> {
    // If stars have been dropped, this line computes them again before several threads need them.
    topology.star(0);
    let (low, high) = bounds(mesh, topology);
    let scale = f64::from(u32::MAX) / (high - low).max_element();
    let key = |v: u32| {
        let cell = (DVec2::from(mesh.points[v as usize]) - low) * scale;
        z_order(cell.x as u32, cell.y as u32)
    };
    // The first pass sorts vertices into cells of the plane, the second sorts the vertices of each cell.
    let bits = (mesh.points.len() / PER_CELL).max(2).ilog2().min(22);
    let unused = 1 << bits;
    let mut cells = Groups::new(mesh.points.len(), unused + 1, |v| {
        let v = v as u32;
        [if topology.star(v).is_empty() { unused as u32 } else { (key(v) >> (64 - bits)) as u32 }]
    });
    let used = cells.starts()[unused] as usize;
    for_each_part(cells.chunks_mut(CELLS), |_, (bounds, vertices)| {
        let keyed = &mut Vec::new();
        for cell in bounds.windows(2).filter(|cell| cell[1] <= used as u32) {
            let cell = (cell[0] - bounds[0]) as usize..(cell[1] - bounds[0]) as usize;
            sort(&mut vertices[cell], key, keyed);
        }
    });
    let mut vertices = cells.into_items();
    vertices.truncate(used);
    vertices
}

/// Sorts vertices by key, and vertices of equal keys by index. `keyed` is scratch memory.
fn sort(vertices: &mut [u32], key: impl Fn(u32) -> u64 + Sync, keyed: &mut Vec<(u64, u32)>) {
    keyed.clear();
    keyed.extend(vertices.iter().map(|&v| (key(v), v)));
    match keyed.len() {
        CROWD.. => keyed.par_sort_unstable(),
        _ => keyed.sort_unstable(),
    }
    for (vertex, &(_, v)) in vertices.iter_mut().zip(&*keyed) {
        *vertex = v;
    }
}

/// Returns the lower and the upper corner of the bounding box of all vertices that some triangle uses.
pub(crate) fn bounds(mesh: &Mesh, topology: &Topology<'_>) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let both = |a: (DVec2, DVec2), b: (DVec2, DVec2)| (a.0.min(b.0), a.1.max(b.1));
    let of_range = |range: std::ops::Range<usize>| {
        let used = range.filter(|&v| !topology.star(v as u32).is_empty());
        let points = used.map(|v| DVec2::from(mesh.points[v]));
        points.map(|point| (point, point)).fold(none, both)
    };
    map_ranges(mesh.points.len(), 1 << 14, of_range).into_iter().fold(none, both)
}

/// Returns the position along the Z-order curve: the bits of x and y interleaved, x in the lowest bit.
fn z_order(x: u32, y: u32) -> u64 {
    let spread = |bits: u32| {
        let mut b = u64::from(bits);
        b = (b | b << 16) & 0x0000_ffff_0000_ffff;
        b = (b | b << 8) & 0x00ff_00ff_00ff_00ff;
        b = (b | b << 4) & 0x0f0f_0f0f_0f0f_0f0f;
        b = (b | b << 2) & 0x3333_3333_3333_3333;
        (b | b << 1) & 0x5555_5555_5555_5555
    };
    spread(x) | spread(y) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_vertices_in_use_stand_along_the_curve() {
        // A third of the points is spread over the plane, the others are crowded in a corner. No triangle uses the last
        // 300.
        let mut points: Vec<[f64; 2]> = Vec::new();
        for k in 0..3000 {
            let [x, y] = [k * 7919 % 3001, k * 104_729 % 2999].map(f64::from);
            let shrink = if k % 3 == 0 { 1.0 } else { 1e-6 };
            points.push([x * shrink, y * shrink]);
        }
        let triangles: Vec<[u32; 3]> = (0..900).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let found = along_curve(&mesh, &topology);
        let (low, high) = bounds(&mesh, &topology);
        let mut expected: Vec<(u64, u32)> = (0..2700)
            .map(|v| {
                let point = DVec2::from(mesh.points[v as usize]);
                let cell = (point - low) * (f64::from(u32::MAX) / (high - low).max_element());
                (z_order(cell.x as u32, cell.y as u32), v)
            })
            .collect();
        expected.sort_unstable();
        let expected: Vec<u32> = expected.into_iter().map(|(_, v)| v).collect();
        assert!(found == expected);
    }

    #[test]
    fn z_order_interleaves() {
        assert_eq!(z_order(0b11, 0b00), 0b0101);
        assert_eq!(z_order(0b01, 0b10), 0b1001);
        assert_eq!(z_order(u32::MAX, u32::MAX), u64::MAX);
    }
}
