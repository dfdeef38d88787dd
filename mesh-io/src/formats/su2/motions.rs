//! The motions of SU2's periodic boundaries, which older versions write as a list of centers, angles and translations.

use crate::content::constraints::Affine;
use crate::text::token::float;
use crate::visit::items::PeriodicNodes;

/// The centers, angles and translations read so far, in file order. `None` stands for a row that is not three finite
/// numbers.
#[derive(Default)]
pub(crate) struct Motions {
    centers: Vec<Option<[f64; 3]>>,
    /// Angles of rotation about x, y and z, in radians.
    angles: Vec<Option<[f64; 3]>>,
    translations: Vec<Option<[f64; 3]>>,
}

impl Motions {
    /// Reads a row of three numbers. `key` is `PERIODIC_CENTER`, `PERIODIC_ROTATION` or `PERIODIC_TRANSLATION`.
    pub(crate) fn read(&mut self, key: &[u8], values: &[u8]) {
        let list = match key {
            b"PERIODIC_CENTER" => &mut self.centers,
            b"PERIODIC_ROTATION" => &mut self.angles,
            _ => &mut self.translations,
        };
        let is_between = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        let numbers = values.split(is_between).filter(|token| !token.is_empty());
        let numbers: Option<Vec<f64>> = numbers.map(float).collect();
        let finite = |numbers: Vec<f64>| {
            let numbers: [f64; 3] = numbers.get(..3)?.try_into().ok()?;
            numbers.iter().all(|number| number.is_finite()).then_some(numbers)
        };
        list.push(numbers.and_then(finite));
    }

    /// Returns the motions of the plane, without the identity. `None` if no motion is left, if a row is missing or
    /// damaged, or if a motion rotates about x or y.
    pub(crate) fn finish(self) -> Option<Vec<PeriodicNodes>> {
        let mut found = Vec::new();
        let Self { centers, angles, translations } = self;
        if centers.len() != angles.len() || centers.len() != translations.len() {
            return None;
        }
        for ((center, angles), translation) in centers.into_iter().zip(angles).zip(translations) {
            let ([x, y, _], [about_x, about_y, angle], [along_x, along_y, _]) =
                (center?, angles?, translation?);
            if [about_x, about_y] != [0.0; 2] {
                return None;
            }
            if [angle, along_x, along_y] != [0.0; 3] {
                let (sin, cos) = angle.sin_cos();
                let motion: Affine = [
                    [cos, -sin, x + along_x - cos * x + sin * y],
                    [sin, cos, y + along_y - sin * x - cos * y],
                ];
                found.push(PeriodicNodes {
                    entities: None,
                    motion: Some(motion),
                    nodes: Vec::new(),
                });
            }
        }
        (!found.is_empty()).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(rows: &[(&str, &str)]) -> Option<Vec<PeriodicNodes>> {
        let mut motions = Motions::default();
        rows.iter().for_each(|(key, values)| motions.read(key.as_bytes(), values.as_bytes()));
        motions.finish()
    }

    #[test]
    fn motions_of_the_plane_are_read_and_others_are_unknown() {
        let rows = |angle: &'static str, along: &'static str| {
            let nothing = "0.0 0.0 0.0";
            [
                ("PERIODIC_CENTER", nothing),
                ("PERIODIC_ROTATION", nothing),
                ("PERIODIC_TRANSLATION", nothing),
                ("PERIODIC_CENTER", "1\t2\t0"),
                ("PERIODIC_ROTATION", angle),
                ("PERIODIC_TRANSLATION", along),
            ]
        };
        let found = read(&rows("0 0 0", "3 0 0")).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].motion, Some([[1.0, 0.0, 3.0], [0.0, 1.0, 0.0]]));
        let [x, y] = read(&rows("0 0 1.5707963267948966", "0 0 0")).unwrap()[0].motion.unwrap();
        // (2, 2) turns about (1, 2) to (1, 3).
        let at = |row: [f64; 3]| row[0] * 2.0 + row[1] * 2.0 + row[2];
        assert!((at(x) - 1.0).abs() < 1e-12 && (at(y) - 3.0).abs() < 1e-12, "{x:?} {y:?}");
        for (angle, along) in
            [("0 0 0", "0 0 0"), ("1 0 0", "0 0 0"), ("0 0 x", "0 0 0"), ("0", "1")]
        {
            assert_eq!(read(&rows(angle, along)), None, "{angle}, {along}");
        }
        assert_eq!(read(&rows("0 0 0", "3 0 0")[..5]), None);
    }
}
