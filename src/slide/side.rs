//! A curve together with the vertices on it.

use glam::DVec2;

use crate::layout::Problem;
use crate::patch::Fan;
use crate::slide::chains::{Chain, Image};
use crate::slide::curve::{Curve, Place};
use crate::slide::options::Slide;
use crate::topology::Topology;

/// A curve and its vertices, in order along the curve. Only vertices with a fan slide: all vertices of a closed curve,
/// and all but the two ends of an open curve.
#[derive(Clone, Debug)]
pub(crate) struct BoundaryCurve {
    pub(crate) curve: Curve,
    /// Indices of the vertices in the mesh.
    pub(crate) vertices: Vec<u32>,
    pub(crate) fans: Vec<Option<Fan>>,
}

impl BoundaryCurve {
    /// Returns the curve of a chain. If the chain has partners, a second side follows: the curve of the partners, with
    /// equal parameters. Partners at equal positions share the curve, and so have equal bits wherever they slide.
    pub(crate) fn of(
        points: &[[f64; 2]],
        topology: &Topology<'_>,
        slide: &Slide,
        chain: Chain,
    ) -> Vec<Self> {
        let last = chain.vertices.len() - 1;
        let slides = |k: usize| chain.is_closed || k != 0 && k != last;
        let side = |curve: Curve, vertices: Vec<u32>| {
            let fan = |(k, &v): (usize, &u32)| slides(k).then(|| Fan::new(topology, v));
            let fans = vertices.iter().enumerate().map(fan).collect();
            Self { curve, vertices, fans }
        };
        let curve = Curve::new(points, &chain, slide);
        let of_partners = |Image { vertices, is_coincident }: &Image| {
            let curve = match is_coincident {
                true => curve.clone(),
                false => curve.of_partners(points, &chain, vertices, slide),
            };
            side(curve, vertices.clone())
        };
        let image = chain.image.as_ref().map(of_partners);
        let own = side(curve, chain.vertices.clone());
        std::iter::once(own).chain(image).collect()
    }

    /// Returns the point at a parameter and its derivatives by the parameter, in the normalized coordinates of the
    /// problem. See [`Curve::at`] for `near`.
    pub(crate) fn at(&self, problem: &Problem, param: f64, near: usize) -> Place {
        let (center, scale) = problem.normalization();
        let Place { point, first, second } = self.curve.at(param, near);
        let (first, second) = (first * scale, second * scale);
        let coordinates = problem.coordinates();
        if !coordinates.is_projected() {
            return Place { point: (point - center) * scale, first, second };
        }
        let point = coordinates.position(DVec2::new(point.x - center.x, point.y) * scale);
        let [slope, bend] = coordinates.slopes(point);
        let first = DVec2::new(first.x, first.y / slope);
        let second = DVec2::new(second.x, (second.y - bend * first.y * first.y) / slope);
        Place { point, first, second }
    }

    /// Returns the curve of a chain whose vertices, but for the ends of an open chain, slide without any triangles.
    #[cfg(test)]
    pub(crate) fn without_triangles(curve: Curve, chain: Chain) -> Self {
        let last = chain.vertices.len() - 1;
        let slides = |k: usize| chain.is_closed || k != 0 && k != last;
        let fans = (0..=last).map(|k| slides(k).then(Fan::default)).collect();
        Self { curve, vertices: chain.vertices, fans }
    }

    /// Returns whether the vertex of index `k` slides.
    pub(crate) fn slides(&self, k: usize) -> bool {
        self.fans[k].is_some()
    }
}
