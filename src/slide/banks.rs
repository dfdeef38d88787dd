//! Pairs of vertices that face each other on two banks, such as those of a weir.

use glam::DVec2;

use crate::periodic::Periodic;
use crate::slide::options::Slide;
use crate::slide::pairing::Boundary;
use crate::slide::partners::Partners;
use crate::topology::Topology;

impl Slide {
    /// Adds the pairs of vertices that face each other on two banks of the boundary. Each list in `banks` has the pairs
    /// of two banks, in order along the banks. `points` are the positions of all vertices.
    ///
    /// Where two banks are parallel, one translation maps consecutive vertices of one bank to the other bank, within 1e-4
    /// of the shorter local edge, and the vertices of each pair slide together. All other pairs stay.
    pub fn pair_banks(
        &mut self,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        banks: &[Vec<[u32; 2]>],
    ) {
        if banks.is_empty() {
            return;
        }
        let Some(boundary) = Boundary::of(topology, points) else { return };
        let across = |[a, b]: [u32; 2]| boundary.at(b) - boundary.at(a);
        let edge = |[a, b]: [u32; 2]| boundary.edge(a).min(boundary.edge(b));
        for pairs in banks {
            // The translation at the start of a parallel part, and the pairs of the part.
            let mut part: Option<(DVec2, Vec<[u32; 2]>)> = None;
            for &pair in pairs {
                match &mut part {
                    Some((motion, pairs))
                        if motion.distance(across(pair)) <= Partners::AGREE * edge(pair) =>
                    {
                        pairs.push(pair);
                    }
                    _ => self.add_part(part.replace((across(pair), vec![pair]))),
                }
            }
            self.add_part(part);
        }
    }

    fn add_part(&mut self, part: Option<(DVec2, Vec<[u32; 2]>)>) {
        let periodic = part.map(|(DVec2 { x, y }, pairs)| Periodic {
            pairs,
            motion: Some([[1.0, 0.0, x], [0.0, 1.0, y]]),
        });
        self.periodic.extend(periodic);
    }
}
