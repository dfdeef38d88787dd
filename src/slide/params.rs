//! The parameters of vertices along their curves, and their form in checkpoints.

use crate::run::records::{Reader, Writer};

/// The parameters of the vertices of each curve. Two curves whose vertices form pairs share them.
pub(crate) type Params = Vec<Vec<f64>>;

/// Writes parameters to a checkpoint.
pub(crate) fn write_params(params: &Params, out: &mut Writer) {
    out.list(params, |out, of_curve| out.reals(of_curve));
}

/// Reads parameters from a checkpoint. `None` if a parameter is not finite, or if a curve has another number of
/// parameters than in `like`.
pub(crate) fn read_params(like: &Params, from: &mut Reader<'_>) -> Option<Params> {
    let params = from.list(8, Reader::reals)?;
    let counts = |params: &Params| params.iter().map(Vec::len).collect::<Vec<_>>();
    let is_finite = params.iter().flatten().all(|t| t.is_finite());
    (is_finite && counts(&params) == counts(like)).then_some(params)
}
