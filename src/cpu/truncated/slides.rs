//! The sliding vertices of a Newton step: each has one unknown, the length of its way along its curve, and partners have one
//! together.

use super::scalar::{Scalar, narrowed};
use crate::slide::Tangents;

/// The admitted moves of a sliding vertex in a Newton step.
#[derive(Clone, Copy, Default)]
pub(super) struct Line<T> {
    /// Unit tangent; zero for a vertex that stays.
    pub(super) along: [T; 2],
    /// Second derivative of the objective by the length because of the bend of the curve.
    curvature: T,
    /// The curvature, or 0 if negative, in the preconditioner.
    pub(super) stiffness: T,
    /// Index of the unknown of the vertex, and the share of the vertex in it.
    unknown: u32,
    share: T,
}

/// The sliding vertices of a mesh.
pub(super) struct Slides<T> {
    /// Place of each sliding vertex in the vectors.
    at: Vec<u32>,
    pub(super) lines: Vec<Line<T>>,
    /// Second derivative by each unknown, because of bounds.
    curvatures: Vec<T>,
    /// Scratch memory: the value of each unknown in a vector.
    values: Vec<T>,
}

impl<T: Scalar> Slides<T> {
    pub(super) fn new(at: Vec<u32>) -> Self {
        let lines = vec![Line::default(); at.len()];
        Self { at, lines, curvatures: Vec::new(), values: Vec::new() }
    }

    /// Sets the tangents of a step.
    pub(super) fn set(&mut self, tangents: &Tangents) {
        for (line, vertex) in self.lines.iter_mut().zip(&tangents.vertices) {
            *line = Line {
                along: narrowed(vertex.along.to_array()),
                curvature: T::of(vertex.curvature),
                stiffness: T::of(vertex.curvature.max(0.0)),
                unknown: vertex.unknown,
                share: T::of(vertex.share),
            };
        }
        self.curvatures.clear();
        self.curvatures.extend(tangents.curvatures.iter().map(|&curvature| T::of(curvature)));
        self.values.resize(tangents.curvatures.len(), T::default());
    }

    /// Returns the place and the line of each sliding vertex.
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, &Line<T>)> {
        self.at.iter().map(|&at| at as usize).zip(&self.lines)
    }

    /// Sets the values of the unknowns to those of a vector.
    fn gather(&mut self, vector: &[[T; 2]]) {
        self.values.fill(T::default());
        for (&at, line) in self.at.iter().zip(&self.lines) {
            let ([x, y], [tx, ty]) = (vector[at as usize], line.along);
            self.values[line.unknown as usize] += line.share * (tx * x + ty * y);
        }
    }

    /// Projects a vector to the admitted moves.
    pub(super) fn project(&mut self, vector: &mut [[T; 2]]) {
        self.gather(vector);
        for (at, line) in self.each() {
            let length = line.share * self.values[line.unknown as usize];
            vector[at] = line.along.map(|t| t * length);
        }
    }

    /// Adds the product of the curvatures and `vector`, which has admitted moves alone, to `product`, and projects `product`.
    /// Returns the inner product of `vector` with the added part.
    pub(super) fn bend(&mut self, vector: &[[T; 2]], product: &mut [[T; 2]]) -> f64 {
        self.gather(vector);
        let mut inner = 0.0;
        for (at, line) in self.each() {
            let unknown = line.unknown as usize;
            let value = self.values[unknown];
            let by = (line.share * line.curvature + self.curvatures[unknown] * line.share) * value;
            // A vertex has a part of the curvature of its unknown, as the squares of shares add up to 1.
            let to = &mut product[at];
            *to = [to[0] + by * line.along[0], to[1] + by * line.along[1]];
            inner += (by * line.share * value).wide();
        }
        self.project(product);
        inner
    }

    /// Returns the length of the way of a sliding vertex in a step.
    pub(super) fn length(&self, k: usize, step: &[[T; 2]]) -> f64 {
        let ([x, y], [tx, ty]) = (step[self.at[k] as usize], self.lines[k].along);
        (tx * x + ty * y).wide()
    }
}
