//! A row of the table of options.

use std::time::Duration;

use gpu_smooth::options::OptionRange;
use gpu_smooth::{Metric, Scheme};

use crate::options::settings::Settings;
use crate::options::spelling::Spelling;

/// The part of a set-up to which an option belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Belongs {
    /// The mesh, which is prepared once for several runs.
    ToMesh,
    /// A run.
    ToRun,
}

/// The values that an option takes, with the function that stores a value.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum Kind {
    /// An option without a value.
    Flag(fn(&mut Settings)),
    /// A whole number in a range, ends included.
    Count([u32; 2], fn(&mut Settings, u32)),
    /// A number in a range.
    Number(OptionRange, fn(&mut Settings, f64)),
    /// A number in a range, or `auto`, for which the function has `None`.
    NumberOrAuto(OptionRange, fn(&mut Settings, Option<f64>)),
    /// A duration in seconds, 0 or above.
    Seconds(fn(&mut Settings, Duration)),
    /// One of several words. The function takes the index of the word in the list.
    Word(&'static [&'static str], fn(&mut Settings, usize)),
    /// As [`Kind::Word`]. The option alone stands for the first word.
    WordOrFlag(&'static [&'static str], fn(&mut Settings, usize)),
    /// A metric, or several metrics with `+` between them.
    Scheme(fn(&mut Settings, Scheme)),
    /// Any text.
    Text(fn(&mut Settings, String)),
}

/// An option that the command line and the Python package share.
#[non_exhaustive]
pub struct OptionRow {
    /// Name of the option, in lower case, with hyphens between words.
    pub name: &'static str,
    /// The part of a set-up to which the option belongs.
    pub belongs: Belongs,
    /// Heading under which help texts and documents have the option.
    pub heading: &'static str,
    /// The values of the option.
    pub kind: Kind,
    /// Placeholder of the value in help texts.
    pub placeholder: &'static str,
    /// The value that stands for an option which is left out; empty if none does.
    pub default: &'static str,
    /// Options one of which this option needs.
    pub needs: &'static [&'static str],
    /// Options that exclude this option.
    pub excludes: &'static [&'static str],
    help: &'static str,
    on_command_line: &'static str,
    in_python: &'static str,
    usually: &'static str,
}

/// Begins a row of the table.
pub(super) const fn row(
    name: &'static str,
    belongs: Belongs,
    heading: &'static str,
    kind: Kind,
    help: &'static str,
) -> OptionRow {
    OptionRow {
        name,
        belongs,
        heading,
        kind,
        placeholder: "",
        default: "",
        needs: &[],
        excludes: &[],
        help,
        on_command_line: "",
        in_python: "",
        usually: "",
    }
}

impl OptionRow {
    /// Sets the placeholder of the value.
    pub(super) const fn takes(self, placeholder: &'static str) -> Self {
        Self { placeholder, ..self }
    }

    /// Sets the value that stands for an option which is left out.
    pub(super) const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }

    /// Describes the default of an option that depends on other options or on the mesh.
    pub(super) const fn usually(self, usually: &'static str) -> Self {
        Self { usually, ..self }
    }

    pub(super) const fn needs(self, needs: &'static [&'static str]) -> Self {
        Self { needs, ..self }
    }

    pub(super) const fn excludes(self, excludes: &'static [&'static str]) -> Self {
        Self { excludes, ..self }
    }

    /// Adds sentences to the help text of one front end alone.
    pub(super) const fn and(self, on_command_line: &'static str, in_python: &'static str) -> Self {
        Self { on_command_line, in_python, ..self }
    }

    /// Returns the description of the option in the words of a front end, as sentences. The last sentence has no period on the
    /// command line, and its default is in brackets.
    pub fn help(&self, spelling: Spelling) -> String {
        let own = match spelling {
            Spelling::CommandLine => self.on_command_line,
            Spelling::Python => self.in_python,
        };
        let text = match own {
            "" => self.help.to_owned(),
            own => format!("{}. {own}", self.help),
        };
        let text = spelling.text(&text);
        match (spelling, self.usually) {
            (Spelling::CommandLine, "") => text,
            (Spelling::Python, "") => format!("{text}."),
            (Spelling::CommandLine, usually) => {
                format!("{text} [default: {}]", spelling.text(usually))
            }
            (Spelling::Python, usually) => {
                format!("{text}. The default is {}.", spelling.text(usually))
            }
        }
    }

    /// Returns the words that the option accepts in place of numbers or beside them, for completions.
    pub fn words(&self) -> Vec<&'static str> {
        match self.kind {
            Kind::Word(words, _) | Kind::WordOrFlag(words, _) => words.to_vec(),
            Kind::NumberOrAuto(..) => vec!["auto"],
            Kind::Scheme(_) => Metric::ALL.iter().map(|metric| metric.name()).collect(),
            Kind::Flag(_)
            | Kind::Count(..)
            | Kind::Number(..)
            | Kind::Seconds(_)
            | Kind::Text(_) => Vec::new(),
        }
    }

    /// Returns the description of valid values, to follow "it must be".
    pub fn wanted(&self) -> String {
        match self.kind {
            Kind::Flag(_) => "true or false".to_owned(),
            Kind::Count([least, most], _) => format!("a whole number from {least} to {most}"),
            Kind::Number(range, _) => range.words.to_owned(),
            Kind::NumberOrAuto(range, _) => format!("{}, or auto", range.words),
            Kind::Seconds(_) => "a number of seconds, 0 or above".to_owned(),
            Kind::Word(words, _) | Kind::WordOrFlag(words, _) => words.join(" or "),
            Kind::Scheme(_) => "a metric, or metrics with + between them".to_owned(),
            Kind::Text(_) => "a text".to_owned(),
        }
    }

    /// Parses a value and stores it. A flag takes `true` alone.
    ///
    /// # Errors
    /// A text for the user, without the name of the option.
    pub fn set(&self, to: &mut Settings, text: &str) -> Result<(), String> {
        let refused = || format!("it must be {}", self.wanted());
        let number = || text.parse::<f64>().map_err(|_| format!("not a number; {}", refused()));
        match self.kind {
            Kind::Flag(set) if text == "true" => set(to),
            Kind::Flag(_) => return Err(refused()),
            Kind::Count([least, most], set) => {
                let count = text.parse().ok().filter(|count| (least..=most).contains(count));
                set(to, count.ok_or_else(refused)?);
            }
            Kind::NumberOrAuto(_, set) if text == "auto" => set(to, None),
            Kind::NumberOrAuto(range, set) => match number()? {
                number if range.contains(number) => set(to, Some(number)),
                _ => return Err(refused()),
            },
            Kind::Number(range, set) => match number()? {
                number if range.contains(number) => set(to, number),
                _ => return Err(refused()),
            },
            Kind::Seconds(set) => {
                set(to, Duration::try_from_secs_f64(number()?).map_err(|_| refused())?);
            }
            Kind::Word(words, set) | Kind::WordOrFlag(words, set) => {
                let place = words.iter().position(|word| *word == text);
                set(to, place.ok_or_else(refused)?);
            }
            Kind::Scheme(set) => set(to, scheme(text)?),
            Kind::Text(set) => set(to, text.to_owned()),
        }
        Ok(())
    }
}

/// Parses a scheme.
fn scheme(text: &str) -> Result<Scheme, String> {
    let scheme: Scheme = text.parse().map_err(|error| format!("{error}"))?;
    match scheme.period() <= Scheme::LONGEST {
        true => Ok(scheme),
        false => Err(format!("a scheme can have {} metrics at most", Scheme::LONGEST)),
    }
}
