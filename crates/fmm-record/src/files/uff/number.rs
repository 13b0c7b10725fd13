//! Numbers as Fortran writes them.

/// The numbers of a line. They may touch where the sign of one follows the exponent of another.
pub(super) struct Numbers<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Self { line, at: 0 }
    }

    /// Whether the number given last ends where the line does.
    pub(super) fn at_end(&self) -> bool {
        self.at == self.line.len()
    }

    /// The text up to the next blank.
    fn word(&self) -> &'a [u8] {
        let rest = &self.line[self.at..];
        &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())]
    }
}

impl<'a> Iterator for Numbers<'a> {
    /// A number, or the text that is not one.
    type Item = Result<f64, &'a [u8]>;

    fn next(&mut self) -> Option<Self::Item> {
        self.at += self.line[self.at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let word = self.word();
        if word.is_empty() {
            return None;
        }
        let plain = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        let (value, length) = match plain {
            Some(value) => (Ok(value), word.len()),
            None => leading(word).map_or((Err(word), word.len()), |(value, length)| (Ok(value), length)),
        };
        self.at += length;
        Some(value)
    }
}

/// The number at the start of `word`, and its length: with an exponent after E or D, or of three digits after a mere
/// sign, as Fortran writes it where the letter would not fit.
fn leading(word: &[u8]) -> Option<(f64, usize)> {
    let digits = |from: usize| word[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(word.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    // What is no number fills little of its field, so that a number that fills the whole of the next one touches it.
    for (name, value) in [(b"NaN", f64::NAN), (b"inf", f64::INFINITY)] {
        let after = end + name.len();
        if word.get(end..after).is_some_and(|text| text.eq_ignore_ascii_case(name)) && sign(after) == 1 {
            return Some((if word[0] == b'-' { -value } else { value }, after));
        }
    }
    let whole = digits(end);
    end += whole;
    let mut fraction = 0;
    if word.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return None;
    }
    let mantissa = end;
    let letter = usize::from(matches!(word.get(end), Some(b'E' | b'e' | b'D' | b'd')));
    let exponent = end + letter;
    let count = digits(exponent + sign(exponent));
    let after = exponent + sign(exponent) + count;
    let is_exponent =
        if letter == 1 { count > 0 } else { sign(exponent) == 1 && count == 3 && word.get(after) != Some(&b'.') };
    if is_exponent {
        end = after;
    }
    // What follows must be another number, which begins with its sign.
    if end < word.len() && sign(end) == 0 {
        return None;
    }
    let text = |bytes| std::str::from_utf8(bytes).ok();
    let exponent = if is_exponent { text(&word[exponent..end])? } else { "0" };
    format!("{}e{exponent}", text(&word[..mantissa])?).parse().ok().map(|value| (value, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(line: &str) -> Result<Vec<f64>, String> {
        Numbers::new(line.as_bytes())
            .map(|number| number.map_err(|text| String::from_utf8_lossy(text).into()))
            .collect()
    }

    #[test]
    fn numbers_of_fortran_in_all_their_forms() {
        assert_eq!(all(" -1.47553E-02 1.0e3\t5 ").unwrap(), [-1.475_53e-2, 1000.0, 5.0]);
        assert_eq!(all("1.5D+02 -2.5d-1 .5 5.").unwrap(), [150.0, -0.25, 0.5, 5.0]);
        assert_eq!(all("1.23456-105 1.23456+105").unwrap(), [1.23456e-105, 1.23456e105]);
        assert_eq!(all("2.99110e-02-10.00000e-05-1.0E-003-2.0").unwrap(), [0.029_911, -1e-4, -1e-3, -2.0]);
        assert_eq!(all("-1.5-2.5").unwrap(), [-1.5, -2.5]);
        assert!(all("NaN").unwrap()[0].is_nan());
        let touching = all("NaN-1.757388200993E+159").unwrap();
        assert!(touching[0].is_nan() && touching[1..] == [-1.757_388_200_993e159], "{touching:?}");
        assert_eq!(all("-inf-1.0E+100 inf+1.0").unwrap(), [f64::NEG_INFINITY, -1e100, f64::INFINITY, 1.0]);
        assert_eq!(all("").unwrap(), [0.0; 0]);
        for line in ["abc", "1.5x", "*************", "1.5E", "1,5", "-", ".", "--1", "1.5E+-2", "NaN1.5", "in-1.5"] {
            assert_eq!(all(line), Err(line.to_owned()), "{line}");
        }
    }

    #[test]
    fn the_end_of_a_line_is_known() {
        let mut numbers = Numbers::new(b"1 2");
        assert_eq!((numbers.next(), numbers.at_end()), (Some(Ok(1.0)), false));
        assert_eq!((numbers.next(), numbers.at_end()), (Some(Ok(2.0)), true));
    }
}
