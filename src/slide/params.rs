//! The parameters of vertices along their curves.

/// Curve parameters of the vertices, one list for each curve. Two curves whose vertices form pairs share a list.
pub(crate) type Params = Vec<Vec<f64>>;
