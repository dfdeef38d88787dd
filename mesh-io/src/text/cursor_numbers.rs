//! Reads the numbers of a text file.

use crate::error::ReadError;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::syntax::Commas;
use crate::text::token::{float, fortran_float, integer, parse_digits, quoted, short_float};
use std::fmt::Display;

/// Offset and value of the third coordinate of points with two coordinates in the file.
pub(crate) const NO_Z: (usize, f64) = (usize::MAX, 0.0);

const WHOLE: &str = "a whole number from 0 to 2^64-1";
const SIGNED: &str = "a whole number from -2^63 to 2^63-1";

impl<'a> Cursor<'a> {
    /// Reads an unsigned whole number, called `what` in messages.
    #[inline]
    pub(crate) fn integer(&mut self, what: impl Display) -> Result<u64, ReadError> {
        let bytes = self.bytes;
        let start = self.skip_blanks(self.at);
        let (number, at) = parse_digits(bytes, start, 0);
        // This many digits cannot overflow. Other numbers are rare.
        if (1..=19).contains(&(at - start)) && self.is_word_end(at) {
            self.at = at;
            return Ok(number);
        }
        let token = self.token();
        token.and_then(integer).ok_or_else(|| self.unusable(token, what, WHOLE))
    }

    /// Reads a signed whole number, called `what` in messages.
    #[inline]
    pub(crate) fn signed(&mut self, what: impl Display) -> Result<i64, ReadError> {
        if let Some((number, end)) = self.short_signed()
            && self.is_word_end(end)
        {
            self.at = end;
            return Ok(number);
        }
        let token = self.token();
        let number = token.and_then(|token| str::from_utf8(token).ok()?.parse().ok());
        number.ok_or_else(|| self.unusable(token, what, SIGNED))
    }

    /// Reads the whole number at the start of the next token, and skips the token. If the number is followed by another
    /// byte than `stop` or a separator, returns `None` without moving the cursor.
    #[inline]
    pub(crate) fn signed_up_to(&mut self, stop: u8) -> Option<i64> {
        let (number, end) = self.short_signed()?;
        (self.is_word_end(end) || self.bytes[end] == stop).then(|| {
            self.at = self.word_end(end);
            number
        })
    }

    /// Returns the whole number at the start of the next token, and its exclusive end. `None` without digits, and for
    /// more than 18 digits, which might overflow.
    #[inline]
    fn short_signed(&self) -> Option<(i64, usize)> {
        let start = self.skip_blanks(self.at);
        let first = start + usize::from(self.bytes.get(start) == Some(&b'-'));
        let (number, end) = parse_digits(self.bytes, first, 0);
        let number = number.cast_signed();
        (1..=18)
            .contains(&(end - first))
            .then(|| (if first > start { -number } else { number }, end))
    }

    /// Reads a number as [`integer`](Self::integer) does. Returns `absent` if the row has no token left.
    pub(crate) fn integer_or(&mut self, absent: u64, what: &str) -> Result<u64, ReadError> {
        match self.token() {
            None => Ok(absent),
            token => token.and_then(integer).ok_or_else(|| self.unusable(token, what, WHOLE)),
        }
    }

    /// Reads the number of vertices, which must fit 32-bit indices.
    pub(crate) fn vertex_count(&mut self) -> Result<u64, ReadError> {
        let count = self.integer("the number of vertices")?;
        self.check_vertex_count(count)?;
        Ok(count)
    }

    /// Returns an error if there are more vertices than 32-bit indices can number.
    pub(crate) fn check_vertex_count(&self, count: u64) -> Result<(), ReadError> {
        if count > u64::from(u32::MAX) {
            let problem = format!("{count} vertices are announced, but at most {} fit", u32::MAX);
            return Err(self.error(problem, "Correct the count, or split the mesh"));
        }
        Ok(())
    }

    /// Reads a finite coordinate, called the `axis` of `owner` in messages.
    #[inline]
    pub(crate) fn coordinate(&mut self, axis: char, owner: impl Display) -> Result<f64, ReadError> {
        if let Some(value) = self.short_number() {
            return Ok(value);
        }
        let token = self.token();
        let value = token.and_then(|token| self.float(token)).filter(|x| x.is_finite());
        value.ok_or_else(|| {
            self.unusable(token, format_args!("{axis} of {owner}"), "a finite number")
        })
    }

    /// Reads a number that need not be finite, called `what` in messages.
    #[inline]
    pub(crate) fn real(&mut self, what: impl Display) -> Result<f64, ReadError> {
        if let Some(value) = self.short_number() {
            return Ok(value);
        }
        let token = self.token();
        let value = token.and_then(|token| self.float(token));
        value.ok_or_else(|| self.unusable(token, what, "a number"))
    }

    /// Reads the next token by [`short_float`]. For tokens in other notations, returns `None` without moving the
    /// cursor.
    #[inline]
    fn short_number(&mut self) -> Option<f64> {
        let (value, end) = short_float(self.bytes, self.skip_blanks(self.at))?;
        self.is_word_end(end).then(|| {
            self.at = end;
            value
        })
    }

    /// Parses a token as a number. Where commas are blanks (Fortran, Abaqus), Fortran's further notations of exponents
    /// are accepted.
    fn float(&self, token: &[u8]) -> Option<f64> {
        let of_fortran = || match self.syntax.commas {
            Commas::Blanks => fortran_float(token),
            _ => None,
        };
        float(token).or_else(of_fortran)
    }

    /// Reads z, and returns its offset and value. NaN is accepted, which programs write for an unknown depth.
    #[inline]
    pub(crate) fn z(&mut self, owner: impl Display) -> Result<(usize, f64), ReadError> {
        Ok((self.at(), self.real(format_args!("z of {owner}"))?))
    }

    /// Reads z if the row has more than x and y. Otherwise returns [`NO_Z`].
    #[inline]
    pub(crate) fn z_if_any(&mut self, owner: impl Display) -> Result<(usize, f64), ReadError> {
        if self.is_at_end() { Ok(NO_Z) } else { self.z(owner) }
    }

    /// Reads x and y. Returns the offset of x, and both coordinates.
    #[inline]
    pub(crate) fn point(
        &mut self,
        owner: impl Display + Copy,
    ) -> Result<(usize, [f64; 2]), ReadError> {
        let x_at = self.skip_blanks(self.at);
        Ok((x_at, [self.coordinate('x', owner)?, self.coordinate('y', owner)?]))
    }

    /// Returns the error for a missing token, or for a token that is not `wanted`. `what` names the number.
    #[cold]
    pub(crate) fn unusable(
        &self,
        token: Option<&[u8]>,
        what: impl Display,
        wanted: &str,
    ) -> ReadError {
        match token {
            // Without a further line feed, the file is cut off.
            None if memchr::memchr(b'\n', &self.bytes[self.at..]).is_none() => {
                self.error(format!("{what} is missing"), CUT_OFF)
            }
            None => self.error(format!("{what} is missing"), CORRECT),
            Some(token) if self.syntax.commas == Commas::Blanks && token.contains(&b'*') => {
                let problem = format!("{what} is `{}`, a repeated number", quoted(token));
                self.error(problem, "Write each number by itself: repeat counts are not read")
            }
            Some(token) => {
                self.error(format!("{what} is `{}`, not {wanted}", quoted(token)), CORRECT)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::text::cursor::tests::{row_of, source};

    #[test]
    fn signed_integers() {
        let numbers = source(b"0 +17 -3 9223372036854775807 -9223372036854775808");
        let mut cursor = row_of(&numbers);
        for expected in [0, 17, -3, i64::MAX, i64::MIN] {
            assert_eq!(cursor.signed("a tag").unwrap(), expected);
        }
        for wrong in ["-", "--1", "1.0", "9223372036854775808", "7a", ""] {
            assert!(row_of(&source(wrong.as_bytes())).signed("a tag").is_err(), "{wrong}");
        }
    }
}
