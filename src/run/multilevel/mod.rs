//! The coarser levels of a mesh, and corrections from the levels. With corrections, runs on meshes of any size converge
//! in about equally many sweeps.
//!
//! Sweeps quickly remove errors between neighbors, but hardly reduce errors that extend over the whole mesh. So after
//! each sweep, the gradient of the objective is restricted to a hierarchy of graph Laplacians, which approximate the
//! Hessian of the objective (aggregates of neighbors, prolongation smoothed once: Vaněk, Mandel & Brezina, Computing
//! 56, 1996). The levels return a direction for all free vertices. A line search moves the vertices along the
//! direction, as far as the true objective falls and no triangle is inverted.
//!
//! The weights of the Laplacians depend only on one positive number at each vertex, so the operators are positive
//! definite even on a bad mesh. No Hessian is ever assembled.

mod aggregate;
mod dense;
mod hierarchy;
pub(crate) mod search;
mod sparse;

pub(crate) use aggregate::{Aggregates, NONE};
pub(crate) use dense::invert;
pub(crate) use hierarchy::{CHEBYSHEV, Coarser, Hierarchy, Level};
#[cfg(feature = "gpu")]
pub(crate) use hierarchy::{OF_QUADRILATERALS, SMOOTHING};
pub(crate) use search::{MIN_FIRST_LENGTH, Search};
pub(crate) use sparse::Sparse;
