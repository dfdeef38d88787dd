//! Everything that is printed, and the commands that only print.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::io::{ErrorKind, IsTerminal, Write};

use gpu_smooth::gpu::AdapterSummary;
use gpu_smooth::{GpuError, MeshFile, Metric, Quality, Topology};

use crate::cli::QualityArgs;
use crate::engine::INSTALL;
use crate::explain;
use crate::report::{QualityReport, six};
use crate::smooth::read;

/// Prints what the user asked for. A reader that went away, as `head` does, is no error; a disk that
/// is full ends the process.
pub(crate) fn say(text: &str) {
    match writeln!(std::io::stdout(), "{text}") {
        Err(problem) if problem.kind() != ErrorKind::BrokenPipe => {
            error(&format!("standard output: {problem}"));
            std::process::exit(1);
        }
        _ => {}
    }
}

/// Prints to standard error what else goes to standard output.
pub(crate) fn aside(text: &str) {
    eprintln!("{text}");
}

/// Prints a remark to standard error, unless the user wants none.
pub(crate) fn note(quiet: bool, text: &str) {
    if !quiet {
        eprintln!("gpu-smooth: {text}");
    }
}

/// Goes to a line of its own where a bar may stand on the last one.
pub(crate) fn leave_bar() {
    if std::io::stderr().is_terminal() {
        eprintln!();
    }
}

pub(crate) fn error(text: &str) {
    eprintln!("gpu-smooth: error: {text}");
}

/// Remarks on a mesh besides its size, one line each.
pub(crate) fn remarks(file: &MeshFile) -> Vec<String> {
    let mut remarks = file.notes().to_vec();
    match file.interface_vertices().len() {
        0 => {}
        1 => remarks.push(
            "1 vertex between regions stays fixed (--free-interfaces lets it move)".to_owned(),
        ),
        n => remarks.push(format!(
            "{n} vertices between regions stay fixed (--free-interfaces lets them move)"
        )),
    }
    remarks
}

/// `gpu-smooth quality MESH`.
pub(crate) fn quality(args: &QualityArgs) -> Result<(), String> {
    let file = read(&args.mesh)?;
    let mesh = file.mesh();
    let refused = |error| explain::mesh_error(&file, &error);
    let topology = Topology::new(mesh).map_err(refused)?;
    let quality = Quality::of(&mesh.points, &topology).map_err(refused)?;
    let bad = topology.bad_triangles(&mesh.points).map_err(refused)?;
    let (vertices, triangles) = (mesh.points.len(), mesh.triangles.len());
    let free = topology.free_count();
    if args.json {
        let mut value =
            serde_json::to_value(QualityReport::from(&quality)).map_err(|e| e.to_string())?;
        value["vertices"] = vertices.into();
        value["triangles"] = triangles.into();
        value["free"] = free.into();
        let bad = explain::bad_triangles(&file, &bad);
        value["bad_triangles"] = serde_json::to_value(bad).map_err(|e| e.to_string())?;
        say(&format!("{value:#}"));
        return Ok(());
    }
    say(&format!("{}: {}", args.mesh.display(), file.format()));
    remarks(&file).iter().for_each(|remark| say(remark));
    say(&format!("{vertices} vertices ({free} free), {triangles} triangles\n"));
    for &metric in Metric::ALL {
        say(&format!("{:<22}{:>12}", format!("f {metric}"), six(quality.f(metric))));
    }
    say(&format!("{:<22}{:>11.2}°", "min angle", quality.min_angle));
    say(&format!("{:<22}{:>11.2}°", "max angle", quality.max_angle));
    let worst = file.triangle_place(quality.worst_triangle);
    let at = format!("  triangle {} ({worst})", worst.label);
    say(&format!("{:<22}{:>12}{at}", "worst imr", six(quality.worst_imr)));
    if free > 0 && quality.worst_movable_imr < quality.worst_imr {
        let movable = six(quality.worst_movable_imr);
        say(&format!(
            "{:<22}{movable:>12}  among triangles with a free vertex",
            "worst imr movable"
        ));
    }
    let first = explain::bad_triangles(&file, &bad[..bad.len().min(explain::TOLD)]);
    let list = explain::list(&first, bad.len(), "--json");
    say(&format!("{:<22}{:>12}{list}", "inverted or flat", quality.inverted));
    Ok(())
}

/// `gpu-smooth adapters`.
pub(crate) fn adapters() -> Result<(), String> {
    let adapters = gpu_smooth::gpu::checked_adapters();
    if adapters.is_empty() {
        say(&format!("no GPU adapter was found. {INSTALL}"));
    }
    for (adapter, usable) in adapters {
        let state = match usable {
            Ok(()) if adapter.is_software() => {
                "arithmetic checked, used only where asked for (--engine gpu, --adapter)".to_owned()
            }
            Ok(()) => "arithmetic checked".to_owned(),
            Err(GpuError::Arithmetic { operation, .. }) => {
                format!("wrong arithmetic, not used: {operation}")
            }
            Err(error) => format!("not used: {error}"),
        };
        say(&format!("{} {}; {state}", adapter.name, self::adapter(&adapter)));
    }
    Ok(())
}

/// What an adapter is and what drives it.
pub(crate) fn adapter(adapter: &AdapterSummary) -> String {
    let software = if adapter.is_software() { ": software" } else { "" };
    format!("({}{software}, {}; {})", adapter.kind, adapter.backend, adapter.driver)
}

/// `gpu-smooth metrics`.
pub(crate) fn metrics() -> Result<(), String> {
    for metric in Metric::ALL {
        let row = metric.properties();
        say(&format!("{:<10} q = {}", row.name, row.formula));
        say(&format!("           {}", row.purpose));
        let barrier = if row.barrier { "barrier at zero area" } else { "no barrier" };
        let guard = match row.shape_guard {
            guard if guard.is_finite() => format!(", shape guard at imr {guard}"),
            _ => String::new(),
        };
        say(&format!("           best q {}, {barrier}{guard}, omega {}", row.ideal, row.omega));
        say(&format!("           {}\n", row.citation));
    }
    Ok(())
}
