//! The pairs of vertices that slide together, and the vertices of pairs that do not move.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::periodic::Periodic;
use crate::slide::rigid::Rigid;

/// The other vertex of a pair, and the motion that takes this one to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partner {
    pub(crate) vertex: u32,
    pub(crate) motion: Rigid,
}

/// The pairs of a mesh.
#[derive(Debug, Default)]
pub(crate) struct Partners {
    links: BTreeMap<u32, Vec<Partner>>,
    /// Vertices that do not move, as no motion fits their pair or they are in several pairs.
    stay: BTreeSet<u32>,
    /// Number of pairs that the motion of the others does not fit.
    pub(crate) unlike: usize,
}

impl Partners {
    /// How far the second vertex of a pair may be from where the motion takes the first, as a share of the edges there.
    pub(crate) const AGREE: f64 = 1e-4;

    /// Checks the given pairs of vertices at `points`. `edge` returns the length of a curve's edges at a vertex, and 0
    /// for a vertex that is on no curve.
    pub(crate) fn new(
        periodic: &[Periodic],
        points: &[[f64; 2]],
        edge: impl Fn(u32) -> f64,
    ) -> Self {
        let mut partners = Self::default();
        for Periodic { pairs, motion } in periodic {
            let placed = |&[a, b]: &[u32; 2]| {
                let ends = [a, b].map(|v| DVec2::from(points[v as usize]));
                (ends, Self::AGREE * edge(a).min(edge(b)))
            };
            let places: Vec<_> = pairs.iter().map(placed).collect();
            let motion = Rigid::of_pairs(*motion, &places);
            for (&[a, b], place) in pairs.iter().zip(&places) {
                match motion.filter(|motion| motion.takes(place.0, place.1)) {
                    Some(motion) => {
                        partners.link(a, Partner { vertex: b, motion });
                        partners.link(b, Partner { vertex: a, motion: motion.inverse() });
                    }
                    None => {
                        // A vertex that is on no curve does not slide, so it does not affect other pairs.
                        partners.unlike += 1;
                        partners.stay.extend([a, b]);
                    }
                }
            }
        }
        partners.settle();
        partners
    }

    fn link(&mut self, vertex: u32, to: Partner) {
        let links = self.links.entry(vertex).or_default();
        if to.vertex == vertex {
            self.stay.insert(vertex);
        } else if links.iter().all(|link| link.vertex != to.vertex) {
            links.push(to);
        }
    }

    /// Adds vertices that are in several pairs to those that do not move, and then all partners of vertices that do not
    /// move.
    fn settle(&mut self) {
        let several = self.links.iter().filter(|(_, links)| links.len() > 1);
        self.stay.extend(several.map(|(&vertex, _)| vertex));
        let mut new: Vec<u32> = self.stay.iter().copied().collect();
        while let Some(vertex) = new.pop() {
            for link in self.links.get(&vertex).into_iter().flatten() {
                if self.stay.insert(link.vertex) {
                    new.push(link.vertex);
                }
            }
        }
    }

    /// Whether a vertex does not move because of its pairs.
    pub(crate) fn stays(&self, vertex: u32) -> bool {
        self.stay.contains(&vertex)
    }

    /// Returns the partner of a vertex, if it has one.
    pub(crate) fn of(&self, vertex: u32) -> Option<Partner> {
        self.links.get(&vertex)?.first().copied()
    }

    /// Whether two vertices are a pair.
    pub(crate) fn are_pair(&self, a: u32, b: u32) -> bool {
        self.links.get(&a).into_iter().flatten().any(|link| link.vertex == b)
    }

    /// Whether the motion takes the first point to the second, within the tolerance for pairs at edges of this length.
    pub(crate) fn agree(motion: Rigid, pair: [DVec2; 2], edge: f64) -> bool {
        motion.takes(pair, Self::AGREE * edge)
    }
}
