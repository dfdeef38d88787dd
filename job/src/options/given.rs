//! The options that a user gave.

use gpu_smooth::options::Feature;
use gpu_smooth::targets::Surface;

use crate::options::row::OptionRow;
use crate::options::settings::Settings;
use crate::options::table::OPTIONS;
use crate::target::TargetKind;

/// The options of the table that a user gave, with their values.
#[derive(Clone, Default)]
pub struct GivenOptions {
    texts: Vec<(&'static str, String)>,
    settings: Settings,
}

impl GivenOptions {
    /// Returns the options with the given names and values, such as `("max-move", "0.5")`. A flag takes `true` alone.
    ///
    /// # Errors
    /// A text for the user if the table has no such option, or a value is not valid.
    pub fn of(options: &[(&str, &str)]) -> Result<Self, String> {
        let mut given = Self::default();
        for (name, text) in options {
            let row = Self::row(name).ok_or_else(|| format!("no option is called {name}"))?;
            given.set(row, text).map_err(|refused| format!("{name} {text}: {refused}"))?;
        }
        Ok(given)
    }

    /// Returns the row of an option, by its name with hyphens or with underscores; `None` if the table has no such option.
    pub fn row(name: &str) -> Option<&'static OptionRow> {
        OPTIONS.iter().find(|row| row.name == name || row.name == name.replace('_', "-"))
    }

    /// Sets an option. A flag takes `true` alone.
    ///
    /// # Errors
    /// A text for the user, without the name of the option, if the value is not valid.
    pub fn set(&mut self, row: &OptionRow, text: &str) -> Result<(), String> {
        row.set(&mut self.settings, text)?;
        self.texts.retain(|(name, _)| *name != row.name);
        self.texts.push((row.name, text.to_owned()));
        Ok(())
    }

    /// Returns these options and the options of `other`, which take precedence.
    pub fn and(&self, other: &Self) -> Self {
        let mut all = self.clone();
        for (name, text) in other.values() {
            // The other options have accepted their texts.
            let _ = Self::row(name).map(|row| all.set(row, text));
        }
        all
    }

    /// Returns the values of all options.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns whether the user gave an option, such as `guard`, or an option with a value, such as `guard=worst`.
    pub fn has(&self, option: &str) -> bool {
        let (wanted, value) = option.split_once('=').map_or((option, None), |(n, v)| (n, Some(v)));
        let is_wanted = |(name, text): &(&str, String)| {
            *name == wanted && value.is_none_or(|value| value == text)
        };
        self.texts.iter().any(is_wanted)
    }

    /// Returns the names and values of the options, in the order in which they were given.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.texts.iter().map(|(name, text)| (*name, text.as_str()))
    }

    /// Returns the features of the mesh that some options of runs exclude. `is_of_places` holds if targets belong to places.
    pub fn features(&self, target: TargetKind, is_of_places: bool) -> Vec<Feature> {
        let Settings { slides, surface, untangles, .. } = self.settings;
        let has_targets = target != TargetKind::Equilateral || surface == Surface::Sphere;
        Feature::present([
            (Feature::Slide, slides),
            (Feature::Targets, has_targets),
            (Feature::TargetField, is_of_places),
            (Feature::Untangle, untangles),
        ])
    }
}
