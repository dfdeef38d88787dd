//! The command `gpu-smooth compare BEFORE AFTER`, which proves that only movable vertices have
//! moved.

use crate::args::{CompareArgs, OutputArgs};
use crate::error::CliError;
use crate::load::explain;
use crate::load::streams::read;
use crate::load::{LoadedMesh, lay_out};
use crate::report::FileHash;
use crate::request::{FieldsRequest, MovableRequest, ReadRequest, SlideRequest, ThirdCoordinate};
use crate::run::proof::{self, MeshVersion, Proof};
use crate::terminal::numbers::counted;
use crate::terminal::shell_words::quoted;
use crate::terminal::tell;
use std::ffi::OsStr;

/// Compares two files. Returns an error if the files differ in anything but movable vertices and
/// interpolated data.
pub(crate) fn run(args: CompareArgs, show: &OutputArgs) -> Result<(), CliError> {
    let settings = args.options.settings();
    let reading = ReadRequest::from(&args.reading).moving(args.moving.quadrilaterals);
    let (surface, z) = (settings.surface, ThirdCoordinate::of(settings, &args.fields.interpolate));
    let slide = SlideRequest::of(args.sides, settings);
    let movable = MovableRequest::of(args.moving, settings);
    // Layers are the ends of curves.
    let movable = if slide.is_some() { movable.keeping_layers() } else { movable };
    let holds_lines = !movable.free_lines;
    let fields = FieldsRequest::from(args.fields);
    let mut before = read(&args.before, &reading)?;
    let mut after = read(&args.after, &reading)?;
    let laid_out = lay_out(&mut before, surface, z)?;
    before.lay_out_likewise(&mut after)?;
    let after = after;
    let choice = movable.apply(&mut before, slide.as_ref())?;
    if choice.nothing_to_do.is_some() {
        before.domain.fix_all_but(&[])?;
    }
    for note in laid_out.iter().chain(&choice.notes).chain(&choice.nothing_to_do) {
        tell::note(show.quiet, note);
    }
    let (mut mine, mut theirs) = (fields.choose(&before)?, fields.choose(&after)?);
    mine.add_dependents(&before, &before.mesh().points)?;
    theirs.add_dependents(&after, &after.mesh().points)?;
    let told = |error: gpu_smooth::MeshError| {
        CliError::from(error).within(&args.before.display().to_string())
    };
    let slide = slide.map(|slide| slide.slide(&before)).transpose()?;
    let formats = [&before, &after].map(|file| file.source.format());
    let is_converted = formats[0] != formats[1];
    let proof = if is_converted {
        Proof::of_conversion(&before, &after, slide.as_ref())
    } else {
        Proof::of(
            MeshVersion { file: &before, fields: &mine },
            MeshVersion { file: &after, fields: &theirs },
            slide.as_ref(),
        )
    };
    let proof = proof.map_err(told)?;
    if proof.difference.is_some() {
        let error = CliError::run(proof.problem().unwrap_or_default());
        let missing = fields.missing(&before, &after);
        return Err(match &missing[..] {
            [] => error,
            names => error.with_remedy(format!(
                "If a run interpolated these data, give --interpolate {} here too",
                quoted(OsStr::new(&names.join(",")))
            )),
        });
    }
    let Proof { moved, held, bad, .. } = &proof;
    let mut problems = mine.implausible(&theirs, moved);
    problems.extend(proof.problem());
    let mut list = proof.places(&after);
    if !held.is_empty() {
        let hint = match slide {
            None => "if they slid along lines in a run with --slide, give --slide here too",
            Some(_) => {
                "if they slid in a run with other options of --slide (--corner-angle, --hausdorff, --periodic) or of \
                 layers (--keep-layers none), give the same options here, as the options determine the lines"
            }
        };
        list.push(hint.to_owned());
        let is_held = |vertex: &u32| held.binary_search(vertex).is_ok();
        let of_quadrilaterals = before.source.quadrilaterals().as_flattened();
        if !before.domain.moves_quadrilaterals() && of_quadrilaterals.iter().any(is_held) {
            list.push(
                "if they moved in a run without --quadrilaterals keep, leave the option out here too"
                    .to_owned(),
            );
        }
        let of_lines = &before.constraints().vertices;
        if holds_lines && of_lines.iter().any(|vertex| held.binary_search(vertex).is_ok()) {
            list.push(
                "if they moved in a run with --free-lines, give --free-lines here too".to_owned(),
            );
        }
    }
    if !proof.concave.is_empty() {
        list.push(
            "if the run kept the quadrilaterals by --quadrilaterals keep, give the option here too"
                .to_owned(),
        );
    }
    if explain::are_across(&after, bad) {
        list.push("--surface sphere continues longitudes across the meridian at which longitudes wrap, such as 180 degrees".to_owned());
    }
    if !problems.is_empty() {
        let text = format!("{}: {}", args.after.display(), problems.join(", "));
        return Err(CliError::run(text).with_details(list));
    }
    if !show.quiet {
        if is_converted {
            let [mine, theirs] = formats;
            tell::say(&format!(
                "{mine} and {theirs}: positions and elements were compared, and neither groups nor other data"
            ));
        }
        tell::say(&summary(&before, &after, &proof, is_converted));
        for FileHash { path, sha256 } in proof::hashes(&before).iter().chain(&proof::hashes(&after))
        {
            tell::say(&format!("{sha256}  {path}"));
        }
        if let Some(text) = mine.compared() {
            tell::say(&text);
        }
    }
    Ok(())
}

/// Returns two or three lines on the moved vertices. `is_converted` is true for files of different formats.
fn summary(before: &LoadedMesh, after: &LoadedMesh, proof: &Proof, is_converted: bool) -> String {
    let Proof { moved, slid, pairs, coincident, .. } = proof;
    let (old, new) = (&before.mesh().points, &after.mesh().points);
    let distance = |&vertex: &u32| {
        let ([a, b], [c, d]) = (old[vertex as usize], new[vertex as usize]);
        (c - a).hypot(d - b)
    };
    let slides = match slid {
        0 => String::new(),
        1 => "1 vertex slid along its line; ".to_owned(),
        n => format!(
            "{n} vertices slid along their lines{}{}; ",
            match (pairs, before.source.constraints().weirs.is_empty()) {
                (0, _) => String::new(),
                (1, true) => ", two of them as a periodic pair together".to_owned(),
                (n, true) => format!(", {n} periodic pairs of them together"),
                (1, false) => ", two of them as a pair across a weir together".to_owned(),
                (n, false) => format!(", {n} pairs across weirs of them together"),
            },
            match coincident {
                0 => String::new(),
                1 => ", two of them at the same place together".to_owned(),
                n => format!(", {n} pairs at the same place together"),
            }
        ),
    };
    let farthest = moved.iter().copied().max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let triangles = after.mesh().triangles.len();
    let elements = match (triangles, after.mesh().quadrilaterals.len()) {
        (triangles, 0) => format!("none of {} is inverted or flat", counted(triangles, "triangle")),
        (0, count) => format!("each of {} is convex", counted(count, "quadrilateral")),
        (triangles, count) => format!(
            "none of {} is inverted or flat, and each of {} is convex",
            counted(triangles, "triangle"),
            counted(count, "quadrilateral")
        ),
    };
    let mut text = format!(
        "{}: {} of {} vertices have moved\n\
         {slides}every vertex that must stay has the same {}; {elements}",
        if is_converted { "the elements are the same" } else { "only coordinates differ" },
        moved.len(),
        after.source.points().len(),
        if is_converted { "position, rounded as the second file stores it" } else { "bits" },
    );
    if let Some(vertex) = farthest {
        let place = after.vertex_place(vertex);
        let by = distance(&vertex);
        text += &format!("\nthe farthest has moved by {by:.6}: vertex {} ({place})", place.id);
    }
    text
}
