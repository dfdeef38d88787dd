//! Search for duplicate and unused vertices.

use crate::measure::measured::Measured;
use crate::parallel::counting_sort::Groups;
use crate::parallel::map_ranges;

impl Measured<'_> {
    /// Returns the vertices whose position exactly equals that of an earlier vertex, ascending. Duplicates may be
    /// intended, for example along a weir or a crack.
    pub fn duplicate_vertices(&self) -> Vec<u32> {
        let points = self.points();
        // Adding zero turns -0 into 0, so that equal positions have equal bits.
        let bits = |v: u32| points[v as usize].map(|x| (x + 0.0).to_bits());
        let buckets = points.len() / 4 + 1;
        let bucket = |v: usize| {
            let [x, y] = bits(v as u32).map(|bits| bits.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let mixed = (x ^ y.rotate_left(32)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((u128::from(mixed) * buckets as u128) >> 64) as u32
        };
        let groups = Groups::new(points.len(), buckets, |v| [bucket(v)]);
        let mut found = map_ranges(buckets, 1 << 12, |range| {
            let mut found = Vec::new();
            for bucket in range {
                // Vertices ascend among equal positions, so the first vertex of each position is not listed.
                let mut members: Vec<([u64; 2], u32)> =
                    groups.of(bucket).iter().map(|&v| (bits(v), v)).collect();
                members.sort_unstable();
                let repeated = members.windows(2).filter(|pair| pair[0].0 == pair[1].0);
                found.extend(repeated.map(|pair| pair[1].1));
            }
            found
        })
        .concat();
        found.sort_unstable();
        found
    }

    /// Returns the vertices that no element uses, ascending.
    pub fn unused_vertices(&self) -> Vec<u32> {
        let topology = self.topology();
        // If stars have been dropped, this line computes them again before several threads need them.
        topology.star(0);
        let unused = |v: &u32| topology.star(*v).is_empty();
        map_ranges(self.points().len(), 1 << 14, |range| {
            range.map(|v| v as u32).filter(unused).collect::<Vec<_>>()
        })
        .concat()
    }
}
