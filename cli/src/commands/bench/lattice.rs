//! Lattice meshes for measurements, of any size and generated within seconds.

use gpu_smooth::Mesh;

/// Largest displacement of a vertex along each axis, in edge lengths. Below a quarter, no triangle is inverted.
const SHIFT: f64 = 0.2;

/// Makes a square lattice of approximately `vertices` vertices, at least 9. Diagonals and displacements are
/// pseudorandom with a fixed seed.
pub(crate) fn lattice(vertices: usize) -> Mesh {
    let side = ((vertices as f64).sqrt().round() as u32).max(3);
    let mut random = Random(1);
    let inside = |i: u32| i > 0 && i + 1 < side;
    let point = |k: u32| {
        let (column, row) = (k % side, k / side);
        let mut shift = || SHIFT * (2.0 * random.next() - 1.0);
        let (dx, dy) = if inside(column) && inside(row) { (shift(), shift()) } else { (0.0, 0.0) };
        [f64::from(column) + dx, f64::from(row) + dy]
    };
    let points = (0..side * side).map(point).collect();
    let mut triangles = Vec::with_capacity(2 * (side as usize - 1).pow(2));
    for k in (0..side * (side - 1)).filter(|k| k % side + 1 < side) {
        let [p, q, r, s] = [k, k + 1, k + 1 + side, k + side];
        triangles.extend(if random.next() < 0.25 {
            [[p, q, s], [q, r, s]]
        } else {
            [[p, q, r], [p, r, s]]
        });
    }
    Mesh { points, triangles, ..Mesh::default() }
}

/// The generator SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    /// Returns the next pseudorandom number, from 0 inclusive to 1 exclusive.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gpu_smooth::{Quality, Topology};

    #[test]
    fn a_lattice_is_valid_and_of_the_size_asked_for() {
        for vertices in [1, 100, 10_000] {
            let mesh = lattice(vertices);
            let topology = Topology::new(&mesh).unwrap();
            assert_eq!(Quality::of(&mesh.points, &topology).unwrap().inverted, 0);
            assert!(topology.free_count() > 0);
            let count = mesh.points.len();
            assert!(count >= 9 && (count == vertices || vertices == 1), "{count}");
        }
        assert_eq!(lattice(400), lattice(400));
    }
}
