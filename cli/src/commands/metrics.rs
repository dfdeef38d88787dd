//! `gpu-smooth metrics`: tells what each metric measures.

use gpu_smooth::Metric;

use crate::error::CliError;
use crate::terminal::tell::say;

/// Prints the properties of all metrics, for `gpu-smooth metrics`.
pub(crate) fn run() -> Result<(), CliError> {
    for metric in Metric::ALL {
        say(&format!("{:<10} q = {}", metric.name(), metric.formula()));
        say(&format!("           {}", metric.purpose()));
        let barrier = if metric.has_barrier() { "barrier at zero area" } else { "no barrier" };
        let guard = match metric.shape_guard() {
            guard if guard.is_finite() => format!(", shape guard at imr {guard}"),
            _ => String::new(),
        };
        // Single precision has the digits that tell, and none that only rounding has made.
        say(&format!(
            "           best q {}, {barrier}{guard}, omega {}",
            metric.ideal() as f32,
            metric.omega()
        ));
        say(&format!("           {}\n", metric.citation()));
    }
    Ok(())
}
