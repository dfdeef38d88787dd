//! The precision of stored coordinates.

use std::fmt;
use std::hash::{Hash, Hasher};

/// Precision in which the application or file stores the coordinates of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Single precision: about seven digits, as in files of 32-bit floats.
    Single,
    /// Double precision: about sixteen digits.
    #[default]
    Double,
    /// Numbers that an application rounds by a rule of its own, such as the text fields of a file format.
    Custom(Rounding),
}

/// A rule that rounds coordinates to the numbers that an application can store.
#[derive(Clone, Copy)]
pub struct Rounding {
    /// Name of the rule. Rules of equal name count as equal, and a checkpoint identifies the rule of its run by this
    /// name.
    pub name: &'static str,
    /// Returns the stored value of a number, as read back by a reader. Must be idempotent: a rounded number rounds to
    /// itself.
    pub round: fn(f64) -> f64,
    /// Returns a bound on the error of `round` for numbers up to the given absolute value. The smallest and the largest
    /// numbers of the format may have a larger error.
    pub error: fn(f64) -> f64,
}

impl Precision {
    /// Returns the stored value of `number`, as read back by a reader.
    pub fn rounded(self, number: f64) -> f64 {
        match self {
            Precision::Single => f64::from(number as f32),
            Precision::Double => number,
            Precision::Custom(rule) => (rule.round)(number),
        }
    }

    /// Returns the name of the precision in checkpoints.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Single => "single",
            Precision::Double => "double",
            Precision::Custom(rule) => rule.name,
        }
    }

    /// Returns a bound on the rounding error of numbers up to the absolute value `size`. The bound does not hold for
    /// the smallest and the largest numbers of the precision.
    pub fn error(self, size: f64) -> f64 {
        match self {
            Precision::Single => f64::from(f32::EPSILON) * size,
            Precision::Double => f64::EPSILON * size,
            Precision::Custom(rule) => (rule.error)(size),
        }
    }
}

impl PartialEq for Rounding {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Rounding {}

impl Hash for Rounding {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl fmt::Debug for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
