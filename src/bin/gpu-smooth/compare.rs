//! `gpu-smooth compare BEFORE AFTER`.

use gpu_smooth::{MeshFile, Topology};

use crate::cli::{CompareArgs, OutputArgs};
use crate::streams::read;
use crate::tell;

/// How many vertices or triangles of a kind are listed.
const LISTED: usize = 10;

/// Compares two files. An error if more than vertices that may move is different.
pub(crate) fn run(args: &CompareArgs, show: &OutputArgs) -> Result<(), String> {
    let mut before = read(&args.before)?;
    let after = read(&args.after)?;
    let choice = args.moving.apply(&mut before)?;
    if choice.nothing_to_do.is_some() {
        before.fix_all_but(&[]).map_err(|error| error.to_string())?;
    }
    for note in choice.notes.iter().chain(&choice.nothing_to_do) {
        tell::note(show.quiet, note);
    }
    let (mut mine, mut theirs) = (args.riding.choose(&before)?, args.riding.choose(&after)?);
    mine.add_parameters(&before, &before.mesh().points)?;
    theirs.add_parameters(&after, &after.mesh().points)?;
    let fields = [mine.fields(), theirs.fields()];
    if let Some(difference) = before.difference_besides(&after, fields) {
        let (place, other) = (&difference.place, &difference.other_place);
        let what = &difference.what;
        return Err(format!("{place} and {other}: more than coordinates is different: {what}"));
    }
    let told = |error: gpu_smooth::MeshError| format!("{}: {error}", args.before.display());
    let topology = Topology::new(before.mesh()).map_err(told)?;
    let (old, new) = (&before.mesh().points, &after.mesh().points);
    let bits = |point: &[f64; 2]| point.map(f64::to_bits);
    let moved: Vec<u32> = (0..)
        .zip(old.iter().zip(new))
        .filter(|(_, (old, new))| bits(old) != bits(new))
        .map(|(vertex, _)| vertex)
        .collect();
    let held: Vec<u32> =
        moved.iter().copied().filter(|&vertex| !topology.free()[vertex as usize]).collect();
    let bad = topology.bad_triangles(new).map_err(told)?;
    let (mut problems, mut list) = (mine.implausible(&theirs, &moved), String::new());
    match held.len() {
        0 => {}
        1 => problems.push("1 vertex has moved that must not".to_owned()),
        count => problems.push(format!("{count} vertices have moved that must not")),
    }
    match bad.len() {
        0 => {}
        1 => problems.push("1 triangle is inverted or flat".to_owned()),
        count => problems.push(format!("{count} triangles are inverted or flat")),
    }
    for place in after.vertex_places(held.iter().copied().take(LISTED)).values() {
        list += &format!("\n  {place}: vertex {}", place.label);
    }
    for place in after.triangle_places(bad.iter().map(|bad| bad.triangle).take(LISTED)).values() {
        list += &format!("\n  {place}: triangle {}", place.label);
    }
    if !problems.is_empty() {
        return Err(format!("{}: {}{list}", args.after.display(), problems.join(", ")));
    }
    if !show.quiet {
        tell::say(&summary(&after, old, new, &moved));
        if let Some(text) = mine.compared() {
            tell::say(&text);
        }
    }
    Ok(())
}

/// What moved, in a line or two.
fn summary(after: &MeshFile, old: &[[f64; 2]], new: &[[f64; 2]], moved: &[u32]) -> String {
    let distance = |&vertex: &u32| {
        let ([a, b], [c, d]) = (old[vertex as usize], new[vertex as usize]);
        (c - a).hypot(d - b)
    };
    let farthest = moved.iter().copied().max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let triangles = after.mesh().triangles.len();
    let mut text = format!(
        "only coordinates differ: {} of {} vertices have moved\n\
         every vertex that must stay has the same bits; none of {triangles} triangles is inverted or flat",
        moved.len(),
        new.len()
    );
    if let Some(vertex) = farthest {
        let place = after.vertex_place(vertex);
        let by = distance(&vertex);
        text += &format!("\nthe farthest has moved by {by:.6}: vertex {} ({place})", place.label);
    }
    text
}
