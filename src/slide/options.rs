//! The options of sliding: lines, corners, periodic pairs, and the distance that vertices may leave the given curves.

use crate::error::{MeshError, SmoothError};
use crate::options::OptionRange;
use crate::periodic::Periodic;

/// The vertices that slide along curves, and the form of the curves between vertices; set by
/// [`Smoother::set_slide`](crate::Smoother::set_slide).
///
/// Curves are chains of edges of the boundary and of [`lines`](Self::lines). Corners do not move. Corners are the ends
/// of curves, vertices where more than two edges of curves meet, [`held`](Self::held) vertices, boundary vertices in
/// [`Mesh::fixed`](crate::Mesh::fixed) with a boundary edge that `lines` lacks, and vertices where a curve turns by more
/// than [`corner_angle`](Self::corner_angle), or by any angle between two straight runs. Straight runs stay straight.
/// Elsewhere, vertices move along a piecewise cubic through the given positions of the vertices.
///
/// Two vertices of curves with equal coordinates, as on both sides of a crack or of two parts that touch, slide together
/// and keep equal coordinates. They stay where three or more vertices have one place, and at the ends of the crack or
/// contact; see [`Smoother::coincident`](crate::Smoother::coincident).
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    /// Turn of a curve, in degrees from 0 to 180, above which a vertex is a corner.
    pub corner_angle: f64,
    /// Largest distance, in the unit of the mesh, between given and moved lines: of a moved vertex from the lines
    /// between given vertices, and of a given vertex from the lines between moved vertices. `None` for a tenth of the
    /// local edge length.
    pub hausdorff: Option<f64>,
    /// Edges of curves: between regions, or on lines inside a region. Vertices in [`Mesh::fixed`](crate::Mesh::fixed)
    /// slide only along these edges, other boundary vertices along the boundary too. Pairs that are not edges of
    /// triangles are ignored, and so are edges with a free vertex.
    pub lines: Vec<[u32; 2]>,
    /// Fixed vertices that do not slide, in any order. Repeats are allowed.
    pub held: Vec<u32>,
    /// Pairs of vertices that slide together, so that the motion maps one partner to the other throughout a run. If one
    /// partner cannot slide, neither moves. Vertices also stay if no motion fits their pair, or if they are in several
    /// pairs. [`Self::pair_sides`] and [`Self::pair_by`] find pairs.
    pub periodic: Vec<Periodic>,
}

impl Default for Slide {
    fn default() -> Self {
        let (lines, held, periodic) = (Vec::new(), Vec::new(), Vec::new());
        Self { corner_angle: 40.0, hausdorff: None, lines, held, periodic }
    }
}

impl Slide {
    /// Returns the bound on the distance from a line whose edge has the length `edge`, in the unit of the mesh.
    pub(crate) fn bound(&self, edge: f64) -> f64 {
        self.hausdorff.unwrap_or(0.1 * edge)
    }

    /// Returns all data as words. Checkpoints store a hash of the words, and are refused for other curves.
    pub(crate) fn words(&self) -> Vec<u64> {
        let Self { corner_angle, hausdorff, lines, held, periodic } = self;
        let mut words = vec![corner_angle.to_bits(), hausdorff.unwrap_or(-1.0).to_bits()];
        let list = |words: &mut Vec<u64>, vertices: &[u32]| {
            words.push(vertices.len() as u64);
            words.extend(vertices.iter().map(|&v| u64::from(v)));
        };
        list(&mut words, lines.as_flattened());
        list(&mut words, held);
        for Periodic { pairs, motion } in periodic {
            list(&mut words, pairs.as_flattened());
            let motion = motion.unwrap_or_default();
            words.extend(motion.as_flattened().iter().map(|x| x.to_bits()));
        }
        words
    }

    /// Checks the ranges of the numbers, and the indices of all listed vertices.
    pub(crate) fn check(&self, vertices: usize) -> Result<(), SmoothError> {
        let pairs = self.periodic.iter().flat_map(|periodic| periodic.pairs.as_flattened());
        let mut listed = self.held.iter().chain(self.lines.as_flattened()).chain(pairs);
        if let Some(&vertex) = listed.find(|&&v| v as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange { element: None, vertex, vertices }.into());
        }
        OptionRange::CORNER_ANGLE.check(self.corner_angle)?;
        OptionRange::HAUSDORFF.check(self.hausdorff.unwrap_or(1.0))?;
        Ok(())
    }
}
