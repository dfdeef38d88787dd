//! The options of sliding: which vertices slide, and how far they may leave the given curve.

use crate::error::{MeshError, SmoothError};
use crate::options::OptionRange;
use crate::periodic::Periodic;

/// Which vertices slide along the curve they are on, and how curves are continued between their vertices; set by
/// [`Smoother::set_slide`](crate::Smoother::set_slide).
///
/// Curves are chains of edges of the boundary and of [`lines`](Self::lines). Corners do not move. These are the ends of
/// curves, vertices where more than two such edges meet, [`held`](Self::held) vertices, and vertices at which a curve
/// turns by more than [`corner_angle`](Self::corner_angle), or by any angle between two straight runs. Straight runs
/// stay straight; elsewhere vertices move along a piecewise cubic through the given positions of the vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    /// A vertex at which a curve turns by more than this is a corner. In degrees, from 0 to 180.
    pub corner_angle: f64,
    /// The largest distance, in the unit of the mesh, of a vertex from the lines between the given vertices, and of a
    /// given vertex from the lines between vertices that have moved. `None` for a tenth of the edge there.
    pub hausdorff: Option<f64>,
    /// Edges of triangles that are parts of curves in addition to those of the boundary: between regions, or on lines
    /// inside a region. Pairs that are not edges, and edges with a free vertex, are ignored.
    pub lines: Vec<[u32; 2]>,
    /// Vertices that do not slide. In any order, repeats allowed.
    pub held: Vec<u32>,
    /// Pairs of vertices that slide together: either both slide, so that the motion still takes one to the other, or
    /// neither. Vertices that no motion fits, or that are in several pairs, do not move. [`Self::pair_sides`] and
    /// [`Self::pair_by`] find pairs.
    pub periodic: Vec<Periodic>,
}

impl Default for Slide {
    fn default() -> Self {
        let (lines, held, periodic) = (Vec::new(), Vec::new(), Vec::new());
        Self { corner_angle: 40.0, hausdorff: None, lines, held, periodic }
    }
}

impl Slide {
    /// Returns the bound on the distance from an edge of the given length, in the unit of the mesh.
    pub(crate) fn bound(&self, edge: f64) -> f64 {
        self.hausdorff.unwrap_or(0.1 * edge)
    }

    /// Returns all data as words, by whose hash a checkpoint tells the curves of its run.
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

    /// Checks the ranges of numbers, and that all listed vertices exist.
    pub(crate) fn check(&self, vertices: usize) -> Result<(), SmoothError> {
        let pairs = self.periodic.iter().flat_map(|periodic| periodic.pairs.as_flattened());
        let mut listed = self.held.iter().chain(self.lines.as_flattened()).chain(pairs);
        if let Some(&vertex) = listed.find(|&&v| v as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange { triangle: None, vertex, vertices }.into());
        }
        OptionRange::CORNER_ANGLE.check(self.corner_angle)?;
        OptionRange::HAUSDORFF.check(self.hausdorff.unwrap_or(1.0))?;
        Ok(())
    }
}
