//! Values of options: numbers, flags and words, checked, with messages that name the option.

use std::path::PathBuf;
use std::time::Duration;

use gpu_smooth::options::OptionRange;
use gpu_smooth_cli::mistyped_names;
use gpu_smooth_job::options::{GivenOptions, Kind, OptionRow};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use crate::error;

/// Meaning of third coordinates that differ.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ThirdCoordinate {
    /// A coordinate of a mesh that lies in any plane of space, and is smoothed in it.
    Coordinate,
    /// Data of a mesh in x and y, such as depths.
    Data,
}

/// An option that a caller passed: its name and its value.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a, 'py> {
    pub(crate) name: &'a str,
    pub(crate) value: &'a Bound<'py, PyAny>,
}

impl Given<'_, '_> {
    /// Returns the error of a value that is not as wanted.
    pub(crate) fn refused(&self, wanted: &str) -> PyErr {
        let Self { name, value } = self;
        let shown = value.repr().map_or_else(|_| "…".to_owned(), |shown| shown.to_string());
        let shown = match shown.chars().count() {
            0..=80 => shown,
            _ => shown.chars().take(79).chain(['…']).collect(),
        };
        error::option(value.py(), &format!("{name}: the value is {shown}, and must be {wanted}"))
    }

    fn is_bool(&self) -> bool {
        self.value.is_instance_of::<PyBool>()
    }

    /// Returns a flag. Numbers are no flags.
    pub(crate) fn flag(&self) -> PyResult<bool> {
        self.value.extract().map_err(|_| self.refused("True or False"))
    }

    /// Returns a number within a range.
    pub(crate) fn number(&self, range: OptionRange) -> PyResult<f64> {
        self.number_in(range.words, |number| range.contains(number))
    }

    /// Returns a number for which `is_within` holds; `words` describe such numbers.
    pub(crate) fn number_in(&self, words: &str, is_within: impl Fn(f64) -> bool) -> PyResult<f64> {
        match self.value.extract::<f64>() {
            Ok(number) if !self.is_bool() && is_within(number) => Ok(number),
            _ => Err(self.refused(words)),
        }
    }

    /// Returns a whole number from `least` to `most`.
    pub(crate) fn count(&self, least: u32, most: u32) -> PyResult<u32> {
        match self.value.extract::<u32>() {
            Ok(count) if !self.is_bool() && (least..=most).contains(&count) => Ok(count),
            _ => Err(self.refused(&format!("a whole number from {least} to {most}"))),
        }
    }

    /// Returns the value of a word in the list `words`. Underscores may replace hyphens.
    pub(crate) fn word<T: Clone>(&self, words: &[(&str, T)]) -> PyResult<T> {
        let given = self.value.cast::<PyString>().ok().map(|word| word.to_string());
        let given = given.map(|word| word.to_lowercase().replace('_', "-"));
        match words.iter().find(|(word, _)| Some(*word) == given.as_deref()) {
            Some((_, value)) => Ok(value.clone()),
            None => {
                let names: Vec<_> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
                Err(self.refused(&names.join(" or ")))
            }
        }
    }

    /// Returns the meaning of third coordinates.
    pub(crate) fn third_coordinate(&self) -> PyResult<ThirdCoordinate> {
        self.word(&[("coordinate", ThirdCoordinate::Coordinate), ("data", ThirdCoordinate::Data)])
    }

    /// Sets an option of the table. A flag that is False is left out.
    pub(crate) fn set(&self, row: &OptionRow, to: &mut GivenOptions) -> PyResult<()> {
        let word = |words: &'static [&'static str]| {
            let words: Vec<_> = words.iter().map(|word| (*word, *word)).collect();
            self.word(&words).map(str::to_owned)
        };
        let is = |text: &str| self.value.extract::<&str>().is_ok_and(|value| value == text);
        let text = match row.kind {
            Kind::Flag(_) if !self.flag()? => return Ok(()),
            Kind::Flag(_) => "true".to_owned(),
            Kind::Count([least, most], _) => self.count(least, most)?.to_string(),
            Kind::Number(range, _) => self.number(range)?.to_string(),
            Kind::NumberOrAuto(..) if is("auto") => "auto".to_owned(),
            Kind::NumberOrAuto(range, _) => {
                let words = format!("{} or \"auto\"", range.words);
                self.number_in(&words, |number| range.contains(number))?.to_string()
            }
            Kind::Seconds(_) => {
                let is_duration = |seconds: f64| Duration::try_from_secs_f64(seconds).is_ok();
                self.number_in(&row.wanted(), is_duration)?.to_string()
            }
            Kind::Word(words, _) => word(words)?,
            Kind::WordOrFlag(words, _) => match self.value.extract::<bool>() {
                Ok(false) => return Ok(()),
                Ok(true) => words[0].to_owned(),
                Err(_) => word(words)?,
            },
            Kind::Scheme(_) => self.scheme()?,
            _ => self.text()?,
        };
        to.set(row, &text)
            .map_err(|refused| error::option(self.value.py(), &format!("{}: {refused}", self.name)))
    }

    /// Returns the text of a scheme such as `edge+imr`, or of a list of metrics.
    fn scheme(&self) -> PyResult<String> {
        let names: String = match self.value.extract::<Vec<String>>() {
            Ok(names) if !self.value.is_instance_of::<PyString>() => names.join("+"),
            _ => self
                .value
                .extract()
                .map_err(|_| self.refused("a text such as \"imr\" or \"edge+imr\""))?,
        };
        Ok(names.replace('_', "-"))
    }

    /// Returns a path that is given as a text or a path-like object.
    pub(crate) fn path(&self) -> PyResult<PathBuf> {
        let os = self.value.py().import("os")?;
        let path = os.call_method1("fsdecode", (self.value,)).and_then(|path| path.extract());
        path.map_err(|_| self.refused("the path of a file"))
    }

    /// Returns a text.
    pub(crate) fn text(&self) -> PyResult<String> {
        self.value.extract().map_err(|_| self.refused("a text"))
    }
}

/// Returns the `TypeError` for an option that `function` lacks. The message has the one of `names` that differs by at most two
/// letters, or else all of them.
pub(crate) fn unknown(name: &str, function: &str, names: &[String]) -> PyErr {
    let advice = match mistyped_names::nearest(name, names.to_vec()) {
        Some(similar) => format!("Did you mean {similar}?"),
        None => format!("There are {}", names.join(", ")),
    };
    PyTypeError::new_err(format!("{name}: {function} has no option of this name. {advice}"))
}
