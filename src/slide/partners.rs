//! Pairs of vertices that slide together, and the vertices that stay because of their pairs.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::periodic::Periodic;
use crate::slide::coincident::Coincident;
use crate::slide::rigid::Rigid;

/// The partner of a vertex, and the motion that maps the vertex to its partner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partner {
    pub(crate) vertex: u32,
    pub(crate) motion: Rigid,
    /// Whether the partners have equal coordinates, as on both sides of a crack. The motion is then the identity.
    pub(crate) is_coincident: bool,
}

/// The pairs of a mesh, checked for a common motion.
#[derive(Debug, Default)]
pub(crate) struct Partners {
    links: BTreeMap<u32, Vec<Partner>>,
    /// Vertices that stay, because no motion fits their pair or because they are in several pairs.
    stay: BTreeSet<u32>,
    /// Number of pairs that the common motion does not fit.
    pub(crate) unlike: usize,
}

impl Partners {
    /// Largest distance of a vertex from the image of its partner, as a share of the shorter local edge.
    pub(crate) const AGREE: f64 = 1e-4;

    /// Checks the given pairs of vertices at `points`, and adds the coincident ones. `edge` returns the length of the
    /// shortest curve edge at a vertex, and 0 for a vertex on no curve.
    pub(crate) fn new(
        periodic: &[Periodic],
        coincident: &Coincident,
        points: &[[f64; 2]],
        edge: impl Fn(u32) -> f64,
    ) -> Self {
        let mut partners = Self::default();
        for &[a, b] in &coincident.pairs {
            let to = |vertex| Partner { vertex, motion: Rigid::IDENTITY, is_coincident: true };
            partners.link(a, to(b));
            partners.link(b, to(a));
        }
        partners.stay.extend(&coincident.crowded);
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
                        let to = |vertex, motion| Partner { vertex, motion, is_coincident: false };
                        partners.link(a, to(b, motion));
                        partners.link(b, to(a, motion.inverse()));
                    }
                    None => {
                        // A vertex on no curve does not slide, so it does not affect other pairs.
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

    /// Adds vertices of several pairs to the vertices that stay, and then the partners of all vertices that stay.
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

    /// Returns whether pairs keep a vertex from moving.
    pub(crate) fn stays(&self, vertex: u32) -> bool {
        self.stay.contains(&vertex)
    }

    /// Returns the first partner of a vertex, or `None`.
    pub(crate) fn of(&self, vertex: u32) -> Option<Partner> {
        self.links.get(&vertex)?.first().copied()
    }

    /// Returns whether two vertices form a pair.
    pub(crate) fn are_pair(&self, a: u32, b: u32) -> bool {
        self.links.get(&a).into_iter().flatten().any(|link| link.vertex == b)
    }

    /// Returns whether the motion maps the first point to the second, within [`Self::AGREE`] times the length `edge`.
    pub(crate) fn agree(motion: Rigid, pair: [DVec2; 2], edge: f64) -> bool {
        motion.takes(pair, Self::AGREE * edge)
    }
}
