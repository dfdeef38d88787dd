//! `gpu-smooth metrics`: tells what each metric measures.

use gpu_smooth::Metric;

use crate::error::CliError;
use crate::terminal::tell::say;

/// Prints the properties of all metrics, for `gpu-smooth metrics`.
pub(crate) fn run() -> Result<(), CliError> {
    for metric in Metric::ALL {
        let row = metric.properties();
        say(&format!("{:<10} q = {}", row.name, row.formula));
        say(&format!("           {}", row.purpose));
        let barrier = if row.barrier { "barrier at zero area" } else { "no barrier" };
        let guard = match row.shape_guard {
            guard if guard.is_finite() => format!(", shape guard at imr {guard}"),
            _ => String::new(),
        };
        // Single precision has the digits that tell, and none that only rounding has made.
        say(&format!(
            "           best q {}, {barrier}{guard}, omega {}",
            row.ideal as f32, row.omega
        ));
        say(&format!("           {}\n", row.citation));
    }
    Ok(())
}
