//! The quality of meshes as JSON and CSV.

use std::fmt::Write;

use gpu_smooth::measure::{QUANTILES, Statistics};
use serde_json::{Value, json};

use crate::commands::quality::mesh_quality::{MeshQuality, Region};
use crate::commands::quality::worst::WorstPart;
use crate::error::CliError;
use crate::load::explain::BadCorner;
use crate::load::{Place, placed};
use crate::render::columns::quoted;
use crate::report::{Finding, Histogram, Worst};

/// Returns an object for a single mesh, or an array of objects for several meshes.
pub(crate) fn json(qualities: &[MeshQuality]) -> Result<Value, CliError> {
    let one = |quality| object(quality).map_err(CliError::from);
    match qualities {
        [only] => one(only),
        several => several.iter().map(one).collect::<Result<Vec<_>, _>>().map(Value::from),
    }
}

fn object(quality: &MeshQuality) -> Result<Value, serde_json::Error> {
    let mut value = serde_json::to_value(&quality.report)?;
    value["file"] = quality.path.display().to_string().into();
    value["format"] = quality.format.clone().into();
    value["vertices"] = quality.vertices.into();
    value["triangles"] = quality.triangles.into();
    if quality.quadrilaterals > 0 {
        value["quadrilaterals"] = quality.quadrilaterals.into();
        value["bad_corners"] = quality.bad_corners.iter().map(bad_corner).collect();
    }
    value["free"] = quality.free.into();
    value["flat"] = quality.flat.into();
    value["hanging_nodes"] = quality.hanging_nodes.into();
    value["duplicate_vertices"] = quality.duplicate_vertices.into();
    value["unused_vertices"] = quality.unused_vertices.into();
    value["bad_triangles"] = serde_json::to_value(&quality.bad)?;
    value["measures"] = measures(&quality.statistics);
    value["histograms"] = quality.histograms.iter().map(histogram).collect();
    value["worst"] = quality.worst.iter().map(worst).collect();
    if !quality.regions.is_empty() {
        let regions = quality.regions.iter().map(|region| {
            let mut object = placed(first_of(region), region.first.location());
            object.insert("groups".into(), json!(spellings(region)));
            object.insert("triangles".into(), region.triangles.into());
            if quality.quadrilaterals > 0 {
                object.insert("quadrilaterals".into(), region.quadrilaterals.into());
            }
            object.insert("measures".into(), measures(&region.statistics));
            Value::from(object)
        });
        value["regions"] = regions.collect();
    }
    if let Some(profile) = &quality.profile {
        value["profile"] = serde_json::to_value(profile)?;
    }
    if !quality.findings.is_empty() {
        value["thresholds"] = quality.findings.iter().map(finding).collect();
    }
    Ok(value)
}

/// Converts statistics to JSON. Measures that no element has are left out, as null stands for infinite numbers.
fn measures(statistics: &[Statistics]) -> Value {
    let one = |s: &Statistics| {
        let [low, median, high] = s.quantiles.map(|quantile| quantile as f32);
        let numbers = json!({
            "min": s.min, "p5": low, "p50": median, "mean": s.mean, "p95": high, "max": s.max, "sd": s.deviation,
        });
        (s.measure.name().to_owned(), numbers)
    };
    Value::Object(statistics.iter().filter(|s| s.count > 0).map(one).collect())
}

/// Converts a histogram to JSON. The last edge is null if the last bin is unbounded.
fn histogram(histogram: &Histogram) -> Value {
    let Histogram { measure, edges, counts } = histogram;
    json!({ "measure": measure.name(), "edges": edges, "counts": counts })
}

/// Returns the key of the first element of a region.
fn first_of(region: &Region) -> &'static str {
    match region.first {
        Place::Quadrilateral(_) => "first_quadrilateral",
        _ => "first_triangle",
    }
}

fn bad_corner(bad: &BadCorner) -> Value {
    let mut object = bad.place.json();
    object.insert("vertex".into(), bad.vertex.into());
    object.insert("problem".into(), bad.problem.into());
    object.into()
}

fn worst(worst: &WorstPart) -> Value {
    let mut object = worst.place.json();
    object.insert("vertices".into(), json!(worst.vertices));
    object.insert("corners".into(), json!(worst.corners));
    for (measure, value) in &worst.values {
        object.insert(measure.name().into(), json!(value));
    }
    object.insert("movable".into(), worst.can_move.into());
    object.into()
}

fn finding(finding: &Finding) -> Value {
    let Finding { threshold, parts, count, worst, .. } = finding;
    let violating = worst.as_ref().filter(|_| *count > 0);
    let worst = violating.map(|Worst { place, value }| {
        let mut object = place.json();
        object.insert("value".into(), json!(value));
        object
    });
    json!({ "threshold": threshold.to_string(), *parts: count, "worst": worst })
}

/// Returns the group names of a region, in the spelling that options accept.
fn spellings(region: &Region) -> Vec<&str> {
    region.groups.iter().map(|group| &*group.spelling).collect()
}

/// Returns a table in CSV with a row for each measure of each file. With regions, further rows
/// follow for each region.
pub(crate) fn csv(qualities: &[MeshQuality]) -> String {
    let mut text = String::from("file,region,measure,triangles,min,mean,max,sd");
    for share in QUANTILES {
        let _ = write!(text, ",p{:.0}", 100.0 * share);
    }
    let by_region = qualities.iter().any(|quality| !quality.regions.is_empty());
    if by_region {
        text.push_str(",groups");
    }
    for quality in qualities {
        let file = quoted(&quality.path.display().to_string());
        let mut rows = |region: &str, groups: &str, statistics: &[Statistics]| {
            for s in statistics {
                let (measure, count) = (s.measure, s.count);
                let _ = write!(text, "\n{file},{region},{measure},{count}");
                let quantiles = s.quantiles.map(|quantile| quantile as f32);
                let numbers = [s.min, s.mean, s.max, s.deviation].map(|number| number.to_string());
                for number in numbers.into_iter().chain(quantiles.map(|number| number.to_string()))
                {
                    // Measures of triangles have no value in a mesh of quadrilaterals.
                    let _ = write!(text, ",{}", if count > 0 { &number } else { "" });
                }
                if by_region {
                    let _ = write!(text, ",{}", quoted(groups));
                }
            }
        };
        rows("", "", &quality.statistics);
        for (number, region) in (1..).zip(&quality.regions) {
            rows(&format!("{number}"), &spellings(region).join(";"), &region.statistics);
        }
    }
    text
}
