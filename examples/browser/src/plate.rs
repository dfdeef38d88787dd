//! A generated mesh: a square plate with a hole and displaced vertices.

use gpu_smooth::Mesh;

/// A plate of 2 by 2 around the origin, of triangles and quadrilaterals, with a round hole of radius 0.35.
#[derive(Clone)]
pub(crate) struct Plate {
    pub(crate) mesh: Mesh,
    /// Indices of the vertices on the hole.
    pub(crate) hole: Vec<u32>,
}

/// Largest displacement of a vertex along each coordinate, in units of the distance between vertices. Values above
/// approximately a quarter invert elements.
const BADLY: f64 = 0.2;

impl Plate {
    /// Makes a plate of approximately `vertices` vertices.
    pub(crate) fn new(vertices: usize) -> Self {
        // Rings of vertices surround the hole, each with approximately 4.5 times as many vertices as there are rings.
        // Some vertices of the outermost ring are the corners of the square.
        let rings = ((vertices as f64 / 4.5).sqrt() as u32).max(4);
        let around = (vertices as u32 / rings).max(16) / 8 * 8;
        let mut random = Random(1);
        let mut points = Vec::new();
        for ring in 0..=rings {
            for i in 0..around {
                let is_inside = 0 < ring && ring < rings;
                let mut shift = || if is_inside { BADLY * random.next() } else { 0.0 };
                let (i, ring) = (f64::from(i) + shift(), f64::from(ring) + shift());
                points.push(at(i / f64::from(around), ring / f64::from(rings)));
            }
        }
        // The upper half has quadrilaterals, the lower half triangles.
        let (mut triangles, mut quadrilaterals) = (Vec::new(), Vec::new());
        for ring in 0..rings {
            for i in 0..around {
                let of = |ring, i| ring * around + i % around;
                let [a, b, c, d] =
                    [of(ring, i), of(ring + 1, i), of(ring + 1, i + 1), of(ring, i + 1)];
                match 2 * i < around {
                    true => quadrilaterals.push([a, b, c, d]),
                    false => triangles.extend([[a, b, c], [a, c, d]]),
                }
            }
        }
        let hole = (0..around).collect();
        Self { mesh: Mesh { points, triangles, quadrilaterals, ..Mesh::default() }, hole }
    }

    /// Returns every `each`th interior vertex.
    pub(crate) fn some(&self, each: usize) -> impl Iterator<Item = u32> + '_ {
        let (around, all) = (self.hole.len(), self.mesh.points.len());
        (around as u32..(all - around) as u32).step_by(each)
    }
}

/// Returns the point at two fractions: `around` of a full turn, and `outward` of the way from the hole to the square.
fn at(around: f64, outward: f64) -> [f64; 2] {
    let angle = std::f64::consts::TAU * around;
    let direction = [angle.cos(), angle.sin()];
    // Distance from the center to the side of the square in this direction.
    let far = 1.0 / direction[0].abs().max(direction[1].abs());
    let radius = 0.35 + (far - 0.35) * outward;
    direction.map(|x| radius * x)
}

/// Pseudorandom numbers from -1 to 1.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        // The constants of Knuth's MMIX.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
