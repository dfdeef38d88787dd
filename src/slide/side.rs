//! Curves with the vertices on them.

use crate::layout::Problem;
use crate::patch::Fan;
use crate::slide::chains::Chain;
use crate::slide::curve::{Curve, Place};
use crate::slide::options::Slide;
use crate::topology::Topology;

/// A curve and its vertices, in order. Only vertices with a fan slide: all except the ends of a curve that is not
/// closed.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    pub(crate) curve: Curve,
    /// The numbers of the vertices in the mesh.
    pub(crate) vertices: Vec<u32>,
    pub(crate) fans: Vec<Option<Fan>>,
}

impl Side {
    /// Makes the curve of a chain and, if the chain has partners, the curve of these, which shares the parameters.
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
        let of_partners =
            |image: &Vec<u32>| side(curve.of_partners(points, &chain, image, slide), image.clone());
        let image = chain.image.as_ref().map(of_partners);
        let own = side(curve, chain.vertices.clone());
        std::iter::once(own).chain(image).collect()
    }

    /// Returns the point of a parameter and its derivatives by the parameter, normalized like the problem.
    pub(crate) fn at(&self, problem: &Problem, param: f64) -> Place {
        let (center, scale) = problem.normalization();
        let Place { point, first, second } = self.curve.at(param);
        Place { point: (point - center) * scale, first: first * scale, second: second * scale }
    }

    /// Whether a vertex slides.
    pub(crate) fn slides(&self, k: usize) -> bool {
        self.fans[k].is_some()
    }
}
