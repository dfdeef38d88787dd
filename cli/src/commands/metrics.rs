//! The command `gpu-smooth metrics`, which explains all metrics.

use gpu_smooth::Metric;

use crate::error::CliError;
use crate::terminal::tell::say;

/// Prints the formula, purpose, properties and source of each metric.
pub(crate) fn run() -> Result<(), CliError> {
    for metric in Metric::ALL {
        say(&format!("{:<10} q = {}", metric.name(), metric.formula()));
        say(&format!("           {}", metric.purpose()));
        let barrier = if metric.has_barrier() { "barrier at zero area" } else { "no barrier" };
        let guard = match metric.shape_guard() {
            guard if guard.is_finite() => format!(", shape guard at imr {guard}"),
            _ => String::new(),
        };
        // Single precision shows the significant digits of an ideal, without rounding errors of
        // double precision.
        say(&format!(
            "           best q {}, {barrier}{guard}, omega {}",
            metric.ideal() as f32,
            metric.omega()
        ));
        say(&format!("           {}\n", metric.citation()));
    }
    Ok(())
}
