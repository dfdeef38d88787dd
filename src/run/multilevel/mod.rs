//! Coarser levels of a mesh, and corrections from them: what makes a run converge in a number of sweeps that does not grow
//! with the mesh.
//!
//! Sweeps even out neighbors at once and the whole mesh never. So after each sweep the gradient of the
//! objective is handed down a hierarchy of graph Laplacians that stand in for its Hessian (aggregates
//! of neighbors, prolongation smoothed once: Vaněk, Mandel & Brezina, Computing 56, 1996), and all free vertices
//! move along what comes back up, as far as the true objective falls and no triangle is inverted.
//!
//! Weights depend on the size of elements alone, so the operator is always positive definite, however
//! bad the mesh. No Hessian is ever assembled.

mod aggregate;
mod dense;
mod hierarchy;
mod search;
mod sparse;

pub(crate) use aggregate::NONE;
pub(crate) use hierarchy::{CHEBYSHEV, Coarser, Hierarchy, Level, SMOOTHING};
pub(crate) use search::Search;
pub(crate) use sparse::Sparse;
