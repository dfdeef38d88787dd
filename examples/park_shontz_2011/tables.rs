//! The paper's tables beside the measured ones. Measured numbers come from the records, published ones
//! from `published`.

use super::analysis::{Data, Reach, View, base, paper_name};
use super::document::Table;
use super::domains::DOMAINS;
use super::published;
use super::study::{Setting, Size};

/// Text of cells without a number.
pub(crate) const NONE: &str = "–";

/// Formats a number with three significant digits, because repeated runs hardly agree to more.
pub(crate) fn three(x: f64) -> String {
    let digits = (2 - x.abs().max(1e-9).log10().floor() as i32).clamp(0, 8);
    format!("{x:.*}", digits as usize)
}

pub(crate) fn percent(x: f64) -> String {
    format!("{:.1} %", 100.0 * x)
}

/// Formats a fraction of the way in percent, such as 95 % or 99.9 %.
pub(crate) fn share(fraction: f64) -> String {
    percent(fraction).replace(".0 ", " ")
}

fn cell(reach: Option<Reach>, number: impl Fn(u32, f64) -> String) -> String {
    match reach {
        None => NONE.into(),
        Some(Reach::Passed { sweeps, seconds }) => number(sweeps, seconds),
        Some(Reach::Missed { best }) => format!("not reached ({})", percent(best)),
    }
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| (*word).to_owned()).collect()
}

fn published_row<T: Copy>(table: &[(&str, [T; 6])], domain: &str, scheme: &str) -> Option<T> {
    let i = DOMAINS.iter().position(|d| d.name == domain)?;
    published::row(table, scheme).map(|row| row[i])
}

/// Returns Table 2, the sizes of the meshes.
pub(crate) fn sizes(data: &Data, size: Size) -> Table {
    let rows = data.meshes.iter().filter(|mesh| mesh.size == size).filter_map(|mesh| {
        let paper = DOMAINS.iter().find(|d| d.name == mesh.domain)?;
        Some(vec![
            mesh.domain.clone(),
            paper.vertices.to_string(),
            mesh.vertices.to_string(),
            paper.elements.to_string(),
            mesh.elements.to_string(),
            // With H holes, the boundary has 2 V - 2 + 2 H - E vertices. The paper does not state H.
            (2 * paper.vertices - 2 - paper.elements).to_string(),
            mesh.boundary.to_string(),
            format!("{:.2}°", mesh.min_angle),
        ])
    });
    Table {
        caption: format!(
            "Table 2: the meshes ({size} size). The paper's boundary vertices follow from its counts, \
             2V − 2 − E, plus two for each hole"
        ),
        head: words(&[
            "mesh",
            "vertices, paper",
            "ours",
            "elements, paper",
            "ours",
            "boundary vertices, paper",
            "ours",
            "smallest angle, ours",
        ]),
        rows: rows.collect(),
        prose: false,
    }
}

/// Returns Table 3 or 4: times to convergence, and the fraction saved against the base metric alone.
pub(crate) fn seconds(data: &Data, view: View, caption: &str, schemes: &[&str]) -> Table {
    let mut head = vec!["mesh".to_owned()];
    for scheme in schemes {
        let name = paper_name(scheme);
        head.extend([format!("{name}, paper (s)"), format!("{name}, ours (s)")]);
        if *scheme != base(scheme) {
            head.extend(["saved, paper".to_owned(), "saved, ours".to_owned()]);
        }
    }
    let rows = data.domains(view).into_iter().map(|domain| {
        let mut row = vec![domain.to_owned()];
        for scheme in schemes {
            let paper = |scheme| published_row(published::SECONDS, domain, scheme);
            row.push(paper(scheme).map_or(NONE.into(), |s| s.to_string()));
            let reach = data.reach(view, domain, scheme);
            row.push(cell(reach, |_, seconds| three(seconds)));
            if *scheme != base(scheme) {
                let saved = |scheme: Option<f64>, alone: Option<f64>| {
                    scheme.zip(alone).map_or(NONE.into(), |(s, a)| percent(1.0 - s / a))
                };
                row.push(saved(paper(scheme), paper(base(scheme))));
                let alone = data.reach(view, domain, base(scheme)).and_then(Reach::seconds);
                row.push(saved(reach.and_then(Reach::seconds), alone));
            }
        }
        row
    });
    Table { caption: caption.into(), head, rows: rows.collect(), prose: false }
}

/// Returns Table 5: numbers of sweeps, and times per sweep.
pub(crate) fn sweeps(data: &Data, view: View, caption: &str, schemes: &[&str]) -> Table {
    let mut head = vec!["mesh".to_owned()];
    for scheme in schemes {
        let name = paper_name(scheme);
        head.extend([
            format!("{name}: sweeps, paper"),
            "ours".into(),
            "s per sweep, paper".into(),
            "ours".into(),
        ]);
    }
    let rows = data.domains(view).into_iter().map(|domain| {
        let mut row = vec![domain.to_owned()];
        for scheme in schemes {
            let paper = published_row(published::SWEEPS, domain, scheme);
            row.push(paper.map_or(NONE.into(), |n| n.to_string()));
            row.push(cell(data.reach(view, domain, scheme), |sweeps, _| sweeps.to_string()));
            let paper = published_row(published::SECONDS_PER_SWEEP, domain, scheme);
            row.push(paper.map_or(NONE.into(), three));
            row.push(data.per_sweep(view, domain, scheme).map_or(NONE.into(), three));
        }
        row
    });
    Table { caption: caption.into(), head, rows: rows.collect(), prose: false }
}

/// Returns sweeps and seconds of all schemes at several fractions of the way, as medians over the meshes.
pub(crate) fn stricter(data: &Data, views: &[View], caption: &str, schemes: &[&str]) -> Table {
    let mut head = vec!["scheme".to_owned()];
    for view in views {
        let share = share(view.fraction);
        head.extend([
            format!("sweeps to {share}"),
            "time".into(),
            "of base".into(),
            "passed".into(),
        ]);
    }
    let rows = schemes.iter().map(|scheme| {
        let mut row = vec![paper_name(scheme)];
        for &view in views {
            let domains = data.domains(view);
            let reaches: Vec<_> =
                domains.iter().filter_map(|d| data.reach(view, d, scheme)).collect();
            let of = |values: Vec<f64>| super::analysis::median(values);
            let sweeps = reaches.iter().filter_map(|r| r.sweeps()).map(f64::from).collect();
            let seconds = reaches.iter().filter_map(|r| r.seconds()).collect();
            let ratios = data.ratios(view, scheme, base(scheme)).into_iter().flatten().collect();
            row.push(of(sweeps).map_or(NONE.into(), |n| n.to_string()));
            row.push(of(seconds).map_or(NONE.into(), |s| format!("{} s", three(s))));
            row.push(of(ratios).map_or(NONE.into(), percent));
            let passed = reaches.iter().filter(|r| r.seconds().is_some()).count();
            row.push(format!("{passed} of {}", reaches.len()));
        }
        row
    });
    Table { caption: caption.into(), head, rows: rows.collect(), prose: false }
}

/// Returns the name of a setting in the report.
pub(crate) fn setting_name(setting: Setting) -> &'static str {
    match setting {
        Setting::Published => "as published",
        Setting::Plain => "analytic, plain",
        Setting::Analytic => "analytic",
    }
}
