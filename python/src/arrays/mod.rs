//! Arrays of NumPy: points, triangles, lists of vertices and numbers per vertex, checked and copied to the types of the
//! library, and results in the form of the arguments.
//!
//! Arrays are converted in one pass, without an array in between, before the library works without Python's lock: other
//! threads may write to the arrays meanwhile. Exact predicates and bounds of indices then hold for the numbers that were
//! read.

mod conversion;
mod numbers;
mod points;

pub(crate) use conversion::matrix;
pub(crate) use numbers::{
    Cells, PerVertex, labels, pairs, pairs_of, per_vertex, triangles, vertex_set, vertex_set_of,
};
pub(crate) use points::{Points, PointsForm, check_finite, points};
