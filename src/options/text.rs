//! The options as lines of text, which checkpoints store and compare.

use crate::options::method::{Derivatives, Method, Paper, Relaxed};
use crate::options::norm::PNormExponent;
use crate::options::run_options::Options;
use crate::options::stopping::{Goal, Stopping};

impl Options {
    /// Returns a line `name = value` for each option. Names and values do not change when a field is renamed, so old
    /// checkpoints remain valid. A new option is a new line; in a checkpoint without the line, the option had its default.
    /// Equal options have equal lines; numbers are written with all digits.
    pub(crate) fn lines(&self) -> String {
        let Self {
            scheme,
            method,
            stopping,
            max_sweeps,
            guard,
            max_move,
            keep_altitude,
            improve_worst,
            stored,
            edge_norm,
            track_all,
        } = self;
        let method = match method {
            Method::Auto => "auto".to_owned(),
            Method::Multilevel => "multilevel".to_owned(),
            Method::Relaxed(Relaxed { omega, unrelaxed_sweeps }) => {
                let omega = optional(*omega);
                format!("relaxed by {omega} after {unrelaxed_sweeps} sweeps")
            }
            Method::Paper(Paper { newton_steps, derivatives }) => {
                let derivatives = match derivatives {
                    Derivatives::Analytic => "analytic derivatives",
                    Derivatives::FiniteDifference => "finite differences",
                };
                format!("paper with {newton_steps} Newton steps by {derivatives}")
            }
        };
        let stopping = match stopping {
            Stopping::Tolerance(tolerance) => format!("tolerance {tolerance}"),
            Stopping::Goal(Goal { fraction, desired }) => {
                format!("fraction {fraction} of the way to {}", optional(*desired))
            }
        };
        let edge_norm = match edge_norm {
            None => "by method".to_owned(),
            Some(PNormExponent { first, every, last }) => {
                format!("2^{first} to 2^{last}, doubled every {every} sweeps")
            }
        };
        let worst = improve_worst.map_or("none", |by| by.name());
        let lines = [
            format!("scheme = {scheme}"),
            format!("method = {method}"),
            format!("stopping = {stopping}"),
            format!("max sweeps = {max_sweeps}"),
            format!("guard = {}", guard.name()),
            format!("max move = {}", optional(*max_move)),
            format!("keep altitude = {keep_altitude}"),
            format!("improve worst = {worst}"),
            format!("stored = {}", stored.name()),
            format!("edge norm = {edge_norm}"),
            format!("track all = {track_all}"),
        ];
        lines.join("\n")
    }
}

/// Formats a number with all digits; `None` becomes "none".
fn optional(number: Option<f64>) -> String {
    number.map_or("none".to_owned(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Metric;
    use crate::options::{Guard, WorstBy};
    use crate::precision::Precision;

    /// A change of any line voids every checkpoint of earlier versions.
    #[test]
    fn the_lines_of_the_default_options_do_not_change() {
        let expected = "scheme = imr\nmethod = auto\nstopping = tolerance 0.000001\nmax sweeps = 1000\n\
                        guard = by-metric\nmax move = none\nkeep altitude = false\nimprove worst = none\n\
                        stored = double\nedge norm = by method\ntrack all = false";
        assert_eq!(Options::default().lines(), expected);
    }

    #[test]
    fn any_other_option_gives_other_lines() {
        let default = Options::default;
        let relaxed = Relaxed { omega: Some(1.5), unrelaxed_sweeps: 4 };
        let goal = Goal { fraction: 0.95, desired: None };
        let mut all = vec![
            default(),
            Options { scheme: Metric::Rms.into(), ..default() },
            Options { method: Method::Multilevel, ..default() },
            Options { method: Method::RELAXED, ..default() },
            Options { method: Method::Relaxed(relaxed), ..default() },
            Options { method: Method::PAPER, ..default() },
            Options { stopping: Stopping::Tolerance(1e-6 * (1.0 + f64::EPSILON)), ..default() },
            Options { stopping: Stopping::Goal(goal), ..default() },
            Options { max_sweeps: 999, ..default() },
            Options { guard: Guard::Worst, ..default() },
            Options { max_move: Some(0.5), ..default() },
            Options { keep_altitude: true, ..default() },
            Options { improve_worst: Some(WorstBy::Imr), ..default() },
            Options { stored: Precision::Single, ..default() },
            Options { edge_norm: Some(PNormExponent::FIXED), ..default() },
            Options { track_all: true, ..default() },
        ];
        let count = all.len();
        let mut lines: Vec<String> = all.drain(..).map(|options| options.lines()).collect();
        lines.sort();
        lines.dedup();
        assert_eq!(lines.len(), count);
    }
}
