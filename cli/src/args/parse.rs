//! Parsers of the values of options.

use gpu_smooth::{layers::KeepLayers, options::OptionRange};

use crate::kept_layers::KeptLayers;

/// Parses a number. If `fits` is false for the number, returns an error with `range`, the
/// description of valid numbers.
pub(crate) fn number(text: &str, fits: impl Fn(f64) -> bool, range: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("not a number; it must be {range}"))?;
    if fits(value) { Ok(value) } else { Err(format!("it must be {range}")) }
}

/// Parses the names or tags of groups.
pub(crate) fn group_names(text: &str) -> Result<String, String> {
    // If the value was forgotten, the next option is taken for it. A tag may be negative.
    let is_option = text.starts_with('-') && !text[1..].starts_with(|c: char| c.is_ascii_digit());
    match is_option || text.trim().is_empty() {
        true => Err("the name or the tag of a group is needed".into()),
        false => Ok(text.to_owned()),
    }
}

/// Parses the layers that stay, and the groups of their walls behind a comma.
pub(crate) fn kept_layers(text: &str) -> Result<KeptLayers, String> {
    let (keep, groups) = match text.split_once(',') {
        Some((keep, groups)) => (keep, Some(group_names(groups)?)),
        None => (text, None),
    };
    match (keep.parse()?, groups) {
        (KeepLayers::None, Some(_)) => Err("none takes no groups".into()),
        (keep, groups) => Ok(KeptLayers { keep, groups }),
    }
}

/// Parses finite numbers with commas between them; `None` if the text is not `N` such numbers.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let finite = |x: &str| x.trim().parse().ok().filter(|x: &f64| x.is_finite());
    text.split(',').map(finite).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// Parses two finite numbers, as in `0.5,1`.
pub(crate) fn two_numbers(text: &str) -> Result<[f64; 2], String> {
    numbers(text)
        .ok_or_else(|| "two numbers with a comma between them are needed, as in 0.5,1".into())
}

/// Parses two opposite corners of a box, as in `0,0,1,1`. All four numbers must be finite.
pub(crate) fn corners(text: &str) -> Result<[[f64; 2]; 2], String> {
    match numbers(text) {
        Some([x0, y0, x1, y1]) => Ok([[x0, y0], [x1, y1]]),
        None => Err("four numbers with commas between them are needed".into()),
    }
}

/// Parses two opposite corners of a box that has an area.
pub(crate) fn area(text: &str) -> Result<[[f64; 2]; 2], String> {
    let [[x0, y0], [x1, y1]] = corners(text)?;
    match x0 != x1 && y0 != y1 {
        true => Ok([[x0, y0], [x1, y1]]),
        false => Err("the corners must differ in both coordinates".into()),
    }
}

/// Parses the names of two groups with a comma between them.
pub(crate) fn two_names(text: &str) -> Result<[String; 2], String> {
    match text.split_once(',') {
        Some((a, b)) if !a.trim().is_empty() && !b.trim().is_empty() => {
            Ok([a.to_owned(), b.to_owned()])
        }
        _ => Err("the names or tags of two groups are needed, with a comma between them".into()),
    }
}

/// Parses the name of data of vertices, or `all`.
pub(crate) fn field_name(text: &str) -> Result<String, String> {
    match text.starts_with("--") || text.trim().is_empty() {
        true => Err("the name of data is needed, or all".into()),
        false => Ok(text.to_owned()),
    }
}

/// Parses a number that is not negative.
pub(crate) fn nonnegative(text: &str) -> Result<f64, String> {
    let range = OptionRange::TOLERANCE;
    number(text, |value| range.contains(value), range.words)
}

/// Parses the width of a picture: an integer from 400 to 8000.
pub(crate) fn pixels(text: &str) -> Result<u32, String> {
    let range = "a number of pixels from 400 to 8000";
    let value = text.trim().parse().ok().filter(|pixels| (400..=8000).contains(pixels));
    value.ok_or_else(|| format!("it must be {range}"))
}

/// Parses the number of vertices of a lattice: an integer from 9 to 100,000,000.
pub(crate) fn vertices(text: &str) -> Result<usize, String> {
    let range = "a number of vertices from 9 to 100000000";
    let value = text.trim().parse().map_err(|_| range.to_owned())?;
    if (9..=100_000_000).contains(&value) { Ok(value) } else { Err(format!("it must be {range}")) }
}
