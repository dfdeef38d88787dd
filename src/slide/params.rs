//! The parameters of vertices along their curves, and their form in checkpoints.

use crate::run::records::{Reader, Writer};

/// Curve parameters of the vertices, one list for each curve. Two curves whose vertices form pairs share a list.
pub(crate) type Params = Vec<Vec<f64>>;

/// Writes parameters to a checkpoint.
pub(crate) fn write_params(params: &Params, out: &mut Writer) {
    out.list(params, |out, of_curve| out.reals(of_curve));
}

/// Reads parameters from a checkpoint. Returns `None` if a parameter is not finite, or if `like` has lists of other
/// lengths.
pub(crate) fn read_params(like: &Params, from: &mut Reader<'_>) -> Option<Params> {
    let params = from.list(8, Reader::reals)?;
    let counts = |params: &Params| params.iter().map(Vec::len).collect::<Vec<_>>();
    let is_finite = params.iter().flatten().all(|t| t.is_finite());
    (is_finite && counts(&params) == counts(like)).then_some(params)
}
