//! A mesh in a window that smooths itself while you pull at it:
//!
//! ```text
//! cargo run --release --example live -- [MESH] [--script FILE] [--out DIR] [--headless] [--size WxH]
//! ```
//!
//! Every frame is one command buffer: sweeps for the budgeted time, then the drawing, both on the application's own
//! vertex buffer (see `smoothing.rs`). On the device, a drag stops before a triangle inverts. With a free hand (key F),
//! triangles may invert, and the following frames turn them back.
//!
//! A script replaces the user (see `script.rs` for the format), and `--headless` replaces the window.
#![allow(clippy::print_stdout, clippy::print_stderr)]

pub(crate) mod app;
pub(crate) mod capture;
pub(crate) mod drag;
pub(crate) mod headless;
pub(crate) mod overlay;
pub(crate) mod render;
pub(crate) mod script;
pub(crate) mod smoothing;
pub(crate) mod view;
pub(crate) mod window;

use std::path::PathBuf;
use std::process::ExitCode;

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const USAGE: &str =
    "usage: live [MESH] [--script FILE] [--out DIR] [--headless] [--size WIDTHxHEIGHT]";

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args().skip(1).collect();
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("live: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// The request of the command line.
pub(crate) struct Request {
    pub(crate) mesh: gpu_smooth::Mesh,
    pub(crate) size: [u32; 2],
    pub(crate) script: Option<script::Script>,
}

pub(crate) fn run(args: &[String]) -> Result<()> {
    let mut mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../meshes/plate.node").to_owned();
    let (mut script, mut out, mut headless, mut size) = (None, PathBuf::new(), false, [1200, 880]);
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| format!("{arg} needs a value. {USAGE}"));
        match arg.as_str() {
            "--script" => script = Some(value()?),
            "--out" => out = value()?.into(),
            "--headless" => headless = true,
            "--size" => size = parse_size(value()?)?,
            "--help" | "-h" => {
                println!("{USAGE}");
                return Ok(());
            }
            option if option.starts_with('-') => {
                return Err(format!("there is no option {option}. {USAGE}").into());
            }
            path => mesh = path.to_owned(),
        }
    }
    let file = mesh_io::MeshFile::read(mesh.as_ref())?;
    let mesh = gpu_smooth_job::Job::of_file(&file)?.into_mesh();

    let script = match script {
        Some(path) => {
            let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
            let parsed = script::Script::parse(&text, out);
            Some(parsed.map_err(|problem| format!("{path}, {problem}"))?)
        }
        None if headless => return Err("--headless needs a --script".into()),
        None => None,
    };
    let request = Request { mesh, size, script };
    if headless { headless::run(request) } else { window::run(request) }
}

fn parse_size(text: &str) -> Result<[u32; 2]> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let fits = |sides: &[u32; 2]| sides.iter().all(|side| (64..=8192).contains(side));
    sides.filter(fits).ok_or_else(|| format!("'{text}' is no size such as 1200x880").into())
}
