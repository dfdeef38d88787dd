//! What `gpu-smooth bench` prints.

use serde::Serialize;

use super::Place;
use super::kernels::KernelTime;
use crate::bench::BenchArgs;
use crate::tell;

/// What was measured of one mesh on one engine.
#[derive(Serialize)]
pub(super) struct Row {
    pub(super) engine: String,
    /// Whether it is an adapter whose driver computes on the CPU.
    pub(super) software: bool,
    pub(super) scheme: String,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) free: usize,
    pub(super) colors: usize,
    /// The time of a sweep with the objective after it, from which the rates below follow.
    pub(super) seconds_per_sweep: f64,
    pub(super) vertex_updates_per_second: f64,
    /// The least bytes that have to be read and written, over the time.
    pub(super) bytes_per_second: f64,
    pub(super) share_of_copy_rate: f64,
    /// The time of each kernel by the device's clock, if it has one.
    pub(super) kernels: Option<Vec<KernelRow>>,
}

/// What one kernel takes of a sweep.
#[derive(Serialize)]
pub(super) struct KernelRow {
    kernel: String,
    passes: u32,
    seconds_per_sweep: f64,
    bytes_per_second: Option<f64>,
    share_of_copy_rate: Option<f64>,
}

impl KernelRow {
    /// The row of a kernel. `bytes` is the least that it has to read and write, given only where that is much.
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

/// The head of the table.
pub(super) fn head(args: &BenchArgs, places: &[Place]) -> String {
    let mut text = String::new();
    for place in places {
        let driver = place.gpu.as_ref().map(|gpu| {
            let adapter = gpu.adapter();
            format!(" {}", tell::adapter(adapter))
        });
        text += &format!(
            "{}{}: copies {:.1} GB/s, read and written\n",
            place.name,
            driver.unwrap_or_default(),
            place.copy_rate / 1e9
        );
    }
    text += &format!(
        "\nA sweep by {} with the objective after it; bytes are the least it can read and write\n\n",
        args.scheme
    );
    text + &line(["vertices", "ms/sweep", "M updates/s", "GB/s", "of copying"], "engine")
}

fn line(columns: [&str; 5], engine: &str) -> String {
    let [vertices, time, updates, bytes, share] = columns;
    format!("{vertices:>10} {time:>10} {updates:>12} {bytes:>8} {share:>11}  {engine}")
}

impl Row {
    /// The row as it is printed.
    pub(super) fn line(&self) -> String {
        let columns = [
            self.vertices.to_string(),
            format!("{:.3}", self.seconds_per_sweep * 1e3),
            format!("{:.2}", self.vertex_updates_per_second / 1e6),
            format!("{:.2}", self.bytes_per_second / 1e9),
            percent(self.share_of_copy_rate),
        ];
        line(columns.each_ref().map(String::as_str), &self.engine)
    }
}

/// The tables of kernels, one for each row that has them.
pub(super) fn kernels(rows: &[Row]) -> String {
    let timed = rows.iter().filter_map(|row| Some((row, row.kernels.as_ref()?)));
    let mut text = String::new();
    for (row, kernels) in timed {
        text += &format!(
            "\n{} vertices in {} colors on {}, by its clock\n",
            row.vertices, row.colors, row.engine
        );
        text += &format!(
            "  {:<24} {:>6} {:>13} {:>8} {:>11}\n",
            "kernel", "passes", "\u{b5}s/sweep", "GB/s", "of copying"
        );
        for kernel in kernels {
            let rate = kernel.bytes_per_second.map(|rate| format!("{:.2}", rate / 1e9));
            let share = kernel.share_of_copy_rate.map(percent);
            text += &format!(
                "  {:<24} {:>6} {:>13.1} {:>8} {:>11}\n",
                kernel.kernel,
                kernel.passes,
                kernel.seconds_per_sweep * 1e6,
                rate.unwrap_or_default(),
                share.unwrap_or_default()
            );
        }
        let whole = row.seconds_per_sweep * 1e6;
        text += &format!("  {:<24} {:>6} {whole:>13.1}\n", "whole, without the clock", "");
    }
    text.trim_end().to_owned()
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}
