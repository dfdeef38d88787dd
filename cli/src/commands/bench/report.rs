//! The tables of `gpu-smooth bench`.

use serde::Serialize;

use crate::args::BenchArgs;
use crate::commands::bench::kernels::{ITERATIONS, KernelTime};
use crate::commands::bench::machine::{self, Place};
use crate::render::columns::right;
use crate::terminal::tell;

/// Measurements of one mesh on one engine.
#[derive(Serialize)]
pub(super) struct Row {
    pub(super) version: String,
    pub(super) machine: String,
    pub(super) engine: String,
    /// Whether the engine is a software adapter, whose driver computes on the CPU.
    pub(super) software: bool,
    pub(super) scheme: String,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) free: usize,
    pub(super) colors: usize,
    /// Seconds per sweep, including the objective. The row's rates are derived from this time.
    pub(super) seconds_per_sweep: f64,
    /// Seconds per sweep in the baseline; `None` if `--baseline` is not given or lacks this row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) baseline_seconds_per_sweep: Option<f64>,
    pub(super) vertex_updates_per_second: f64,
    /// Smallest number of bytes that a sweep and the objective can transfer, divided by their time.
    pub(super) bytes_per_second: f64,
    pub(super) share_of_copy_rate: f64,
    /// Time of each kernel by the device's timestamps; `None` on devices without timestamps.
    pub(super) kernels: Option<Vec<KernelRow>>,
    /// The same for a sweep with a correction from coarser levels.
    pub(super) corrected_kernels: Option<Vec<KernelRow>>,
    /// The same for a Newton step with [`ITERATIONS`] iterations, without its sweep.
    pub(super) step_kernels: Option<Vec<KernelRow>>,
}

/// Time of a kernel per sweep.
#[derive(Serialize)]
pub(super) struct KernelRow {
    kernel: String,
    passes: u32,
    seconds_per_sweep: f64,
    bytes_per_second: Option<f64>,
    share_of_copy_rate: Option<f64>,
}

impl KernelRow {
    /// Makes the row of a kernel. `bytes` is the smallest number of bytes that the kernel can transfer; `None` for
    /// kernels that transfer little.
    pub(super) fn new(time: &KernelTime, bytes: Option<u64>, copy_rate: f64) -> Self {
        let rate = bytes.map(|bytes| bytes as f64 / time.seconds);
        Self {
            kernel: time.kernel.label().replace("gpu-smooth ", ""),
            passes: time.passes,
            seconds_per_sweep: time.seconds,
            bytes_per_second: rate,
            share_of_copy_rate: rate.map(|rate| rate / copy_rate),
        }
    }
}

/// Columns of the table before the engine. Without `--baseline`, the columns `baseline` and `change` are omitted.
const COLUMNS: [&str; 7] =
    ["vertices", "ms/sweep", "baseline", "change", "M updates/s", "GB/s", "of copying"];
const WIDTHS: [usize; 7] = [10, 10, 10, 9, 12, 8, 11];

/// The form of the table: Markdown or plain text, with or without a baseline.
#[derive(Clone, Copy)]
pub(super) struct Form {
    markdown: bool,
    compared: bool,
}

impl Form {
    pub(super) fn new(args: &BenchArgs) -> Self {
        Self { markdown: args.markdown, compared: args.baseline.is_some() }
    }

    /// Returns the lines on version, machine and engines, and the head of the table.
    pub(super) fn head(self, args: &BenchArgs, places: &[Place]) -> String {
        let mark = if self.markdown { "- " } else { "" };
        let mut text = format!("{mark}{}\n{mark}{}\n", machine::version(), machine::machine());
        for place in places {
            let driver = place.gpu.as_ref().map(|gpu| {
                let adapter = gpu.adapter();
                format!(" {}", tell::adapter(adapter))
            });
            text += &format!(
                "{mark}{}{}: copies {:.1} GB/s, read and written\n",
                place.name,
                driver.unwrap_or_default(),
                place.copy_rate / 1e9
            );
        }
        text += &format!(
            "\nA sweep by {} with the objective after it; bytes are the least it can read and write\n\n",
            args.scheme()
        );
        text += &self.line(COLUMNS.map(str::to_owned), "engine");
        if self.markdown {
            let columns = if self.compared { COLUMNS.len() } else { COLUMNS.len() - 2 };
            text += &format!("\n|{}---|", "---:|".repeat(columns));
        }
        text
    }

    fn line(self, columns: [String; COLUMNS.len()], engine: &str) -> String {
        let is_shown = |i: usize| self.compared || !(2..4).contains(&i);
        let shown = columns.iter().zip(WIDTHS).enumerate().filter(|(i, _)| is_shown(*i));
        match self.markdown {
            true => {
                let fields: Vec<&str> = shown.map(|(_, (field, _))| field.as_str()).collect();
                format!("| {} | {engine} |", fields.join(" | "))
            }
            false => {
                let fields: Vec<String> =
                    shown.map(|(_, (field, width))| right(field, width)).collect();
                format!("{}  {engine}", fields.join(" "))
            }
        }
    }

    /// Formats a row of the table.
    pub(super) fn row(self, row: &Row) -> String {
        let seconds = row.seconds_per_sweep;
        let milliseconds = |seconds: f64| format!("{:.3}", seconds * 1e3);
        let change = |before: f64| format!("{:+.1} %", 100.0 * (seconds / before - 1.0));
        let before = row.baseline_seconds_per_sweep;
        let columns = [
            row.vertices.to_string(),
            milliseconds(seconds),
            before.map_or("-".into(), milliseconds),
            before.map_or("-".into(), change),
            format!("{:.2}", row.vertex_updates_per_second / 1e6),
            format!("{:.2}", row.bytes_per_second / 1e9),
            percent(row.share_of_copy_rate),
        ];
        self.line(columns, &row.engine)
    }

    /// Formats a row of the table of kernels.
    fn kernel(self, fields: [&str; 6]) -> String {
        let [name, passes, time, share, rate, of_copying] = fields;
        match self.markdown {
            true => {
                format!("| {name} | {passes} | {time} | {share} | {rate} | {of_copying} |\n")
            }
            false => format!(
                "  {name:<24} {passes:>6} {time:>11} {share:>8} {rate:>8} {of_copying:>11}\n"
            ),
        }
    }

    /// Returns the tables of kernels, one for each measurement with timestamps.
    pub(super) fn kernels(self, rows: &[Row]) -> String {
        let timed = rows.iter().flat_map(|row| {
            [
                ("a sweep".to_owned(), "sweep", &row.kernels),
                ("a corrected sweep".to_owned(), "sweep", &row.corrected_kernels),
                (format!("a Newton step with {ITERATIONS} iterations"), "step", &row.step_kernels),
            ]
            .into_iter()
            .filter_map(move |(what, unit, kernels)| Some((row, what, unit, kernels.as_ref()?)))
        });
        let mut text = String::new();
        for (row, what, unit, kernels) in timed {
            let (vertices, colors, engine) = (row.vertices, row.colors, &row.engine);
            text += &format!(
                "\n{what} of {vertices} vertices in {colors} colors on {engine}, each kernel by itself, by its clock\n"
            );
            let sum: f64 = kernels.iter().map(|kernel| kernel.seconds_per_sweep).sum();
            let per = format!("\u{b5}s/{unit}");
            let head = ["kernel", "passes", &per, "share", "GB/s", "of copying"];
            if self.markdown {
                text += &format!("\n{}|---|---:|---:|---:|---:|---:|\n", self.kernel(head));
            } else {
                text += &self.kernel(head);
            }
            for kernel in kernels {
                let rate = kernel.bytes_per_second.map(|rate| format!("{:.2}", rate / 1e9));
                let share = kernel.share_of_copy_rate.map(percent);
                text += &self.kernel([
                    &kernel.kernel,
                    &kernel.passes.to_string(),
                    &microseconds(kernel.seconds_per_sweep),
                    &percent(kernel.seconds_per_sweep / sum),
                    &rate.unwrap_or_default(),
                    &share.unwrap_or_default(),
                ]);
            }
            let together = (what == "a sweep").then_some((TOGETHER, row.seconds_per_sweep));
            for (name, seconds) in std::iter::once((APART, sum)).chain(together) {
                text += self.kernel([name, "", &microseconds(seconds), "", "", ""]).trim_end();
                text.push('\n');
            }
        }
        text.trim_end().to_owned()
    }
}

/// Names of the last two rows of a table of kernels: the sum of the rows above, and the measured time of a whole sweep.
/// On a device, kernels without timestamps between them overlap.
const APART: &str = "all, one after another";
const TOGETHER: &str = "a sweep without clock";

fn microseconds(seconds: f64) -> String {
    format!("{:.1}", seconds * 1e6)
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}
