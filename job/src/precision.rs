//! The precision of a file in terms of the smoother.

use gpu_smooth::options::{Precision, Rounding};

/// Returns the precision of the smoother that rounds as a file of the given precision does.
pub fn smoother_precision(stored: mesh_io::Precision) -> Precision {
    use mesh_io::Precision as Stored;
    /// Makes the rounding rule of a precision. Each rule needs functions of its own, because function pointers capture
    /// nothing.
    macro_rules! rule {
        ($variant:ident) => {
            Precision::Custom(Rounding {
                name: stringify!($variant),
                round: |number| Stored::$variant.rounded(number),
                error: |size| Stored::$variant.error(size),
            })
        };
    }
    match stored {
        Stored::Single => Precision::Single,
        Stored::Double => Precision::Double,
        Stored::Text20 => rule!(Text20),
        Stored::Text16 => rule!(Text16),
        Stored::Text8 => rule!(Text8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precisions_of_files_round_and_are_told_apart_by_name() {
        let text8 = smoother_precision(mesh_io::Precision::Text8);
        assert_eq!(text8.rounded(0.123_456_789), mesh_io::Precision::Text8.rounded(0.123_456_789));
        assert_ne!(text8, smoother_precision(mesh_io::Precision::Text16));
        assert_eq!(text8.name(), "Text8");
    }
}
