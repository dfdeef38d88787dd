//! The command line of `examples/make_mesh.rs`, separate so that a test can execute the command that produced a mesh.

use super::Mesh;
use super::{Outline, distort_smooth, perturb_random, tangle, triangle_text, triangulate};
use std::path::PathBuf;

const USAGE: &str = "usage: make_mesh OUTLINE OUT_STEM [options]
  --vertices N  make about N vertices, within 1 % (default 2000)
  --perturb S   move each interior vertex at random; 0.5 is mild, 1 leaves some triangles nearly flat
  --distort A   move the interior by long waves; 1 is where the first triangle becomes flat
  --tangle KIND tangle the interior: scatter, noise, collapse, fold or turn; see docs/untangling.md
  --seed K      of the random moves (default 1)";

/// The request of the command line.
#[derive(Debug)]
pub struct Recipe {
    /// The command as typed, for the comment in the files.
    pub command: String,
    /// File with the outline of the domain.
    pub outline: PathBuf,
    /// Path of the files to write, without their endings.
    pub stem: PathBuf,
    vertices: usize,
    perturb: Option<f64>,
    distort: Option<f64>,
    tangle: Option<Tangle>,
    seed: u64,
}

/// A function that tangles a mesh with a given seed.
type Tangle = fn(&Mesh, u64) -> Mesh;

/// Functions that tangle meshes, by their names on the command line.
const TANGLES: [(&str, Tangle); 5] = [
    ("scatter", tangle::scattered),
    ("noise", |mesh, seed| tangle::noisy(mesh, 3.0, seed)),
    ("collapse", tangle::collapsed),
    ("fold", tangle::folded),
    ("turn", |mesh, seed| tangle::turned(mesh, seed as f64 / 10.0)),
];

impl Recipe {
    /// Parses the arguments after the program's name.
    pub fn parse(args: &[String]) -> Result<Self, String> {
        let mut recipe = Self {
            command: format!("cargo run --release --example make_mesh -- {}", args.join(" ")),
            outline: PathBuf::new(),
            stem: PathBuf::new(),
            vertices: 2000,
            perturb: None,
            distort: None,
            tangle: None,
            seed: 1,
        };
        let mut paths = Vec::new();
        let mut args = args.iter();
        while let Some(arg) = args.next() {
            if !arg.starts_with("--") {
                paths.push(PathBuf::from(arg));
                continue;
            }
            let value = args.next().ok_or_else(|| format!("{arg} needs a value\n{USAGE}"))?;
            match arg.as_str() {
                "--vertices" => recipe.vertices = number(arg, value, 3..=100_000_000)?,
                "--perturb" => recipe.perturb = Some(number(arg, value, 0.0..=1.0)?),
                "--distort" => recipe.distort = Some(number(arg, value, 0.0..=1.0)?),
                "--tangle" => {
                    let kind = TANGLES.iter().find(|(name, _)| name == value);
                    let (_, tangle) = kind.ok_or_else(|| {
                        let names = TANGLES.map(|(name, _)| name).join(", ");
                        format!("{arg} takes one of {names}, not '{value}'")
                    })?;
                    recipe.tangle = Some(*tangle);
                }
                "--seed" => recipe.seed = number(arg, value, 0..=u64::MAX)?,
                _ => return Err(format!("unknown option {arg}\n{USAGE}")),
            }
        }
        let given = [recipe.perturb.is_some(), recipe.distort.is_some(), recipe.tangle.is_some()];
        if given.into_iter().filter(|&given| given).count() > 1 {
            return Err("--perturb, --distort and --tangle exclude each other".into());
        }
        [recipe.outline, recipe.stem] = paths
            .try_into()
            .map_err(|paths: Vec<_>| format!("expected two paths, got {}\n{USAGE}", paths.len()))?;
        Ok(recipe)
    }

    /// Returns the mesh as the texts of a `.node` and an `.ele` file.
    pub fn texts(&self) -> Result<[String; 2], String> {
        Ok(triangle_text(&self.mesh()?, &self.command))
    }

    /// Makes the mesh. The error names the outline and the problem.
    pub fn mesh(&self) -> Result<Mesh, String> {
        let named = |problem: String| format!("{}: {problem}", self.outline.display());
        let text = std::fs::read_to_string(&self.outline).map_err(|e| named(e.to_string()))?;
        let outline = Outline::parse(&text).map_err(named)?;
        let mesh = triangulate(&outline, self.vertices).map_err(named)?;
        Ok(match (self.perturb, self.distort, self.tangle) {
            (Some(strength), ..) => perturb_random(&mesh, strength, self.seed),
            (_, Some(amplitude), _) => distort_smooth(&mesh, amplitude),
            (_, _, Some(tangle)) => tangle(&mesh, self.seed),
            _ => mesh,
        })
    }
}

fn number<T>(option: &str, value: &str, allowed: std::ops::RangeInclusive<T>) -> Result<T, String>
where
    T: std::str::FromStr + PartialOrd + std::fmt::Display,
{
    match value.parse() {
        Ok(number) if allowed.contains(&number) => Ok(number),
        _ => Err(format!(
            "{option} takes a number from {} to {}, not '{value}'",
            allowed.start(),
            allowed.end()
        )),
    }
}
