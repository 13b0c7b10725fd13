//! Responses in columns of numbers: frequency, and real and imaginary part or magnitude and phase.

use fmm_record::Complex64;
use fmm_record::uff::Freedom;

use super::measured::MeasuredResponse;
use super::universal::hertz;
use crate::error::FrfError;
use crate::response::{FrequencyResponse, ResponseForm};

/// Content of a column, by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Content {
    /// Frequency, with the hertz in its unit.
    Frequency(f64),
    Real,
    Imaginary,
    Magnitude,
    /// Magnitude in dB.
    Level,
    /// Phase, with the radians in its unit.
    Phase(f64),
    Coherence,
}

impl MeasuredResponse {
    /// True if one of the `names` of columns is that of a frequency, as in a table of responses.
    pub fn is_named_by(names: &[impl AsRef<str>]) -> bool {
        names.iter().any(|name| matches!(content(name.as_ref()), Some(Ok(Content::Frequency(_)))))
    }

    /// The responses in `columns` of equal length under these `names`, but for a line at zero frequency; they are of
    /// the `form`, and `scale` turns their numbers into its SI unit. With a number of `averages` and a coherence, each
    /// has its uncertainty. The places of the responses are numbered from 1 on.
    ///
    /// The names say what is in a column: `frequency [Hz]`, then for each response `real` and `imag` or `magnitude`
    /// (with `dB` if it is a level) and `phase [deg]` or `phase [rad]`, and perhaps `coherence`. Without such names the
    /// first column is the frequency in Hz, and real and imaginary parts follow in turn.
    ///
    /// ```
    /// use fmm_frf::{MeasuredResponse, ResponseForm};
    ///
    /// let names = ["frequency [Hz]", "magnitude", "phase [deg]"];
    /// let columns = [vec![1.0, 2.0], vec![3.0, 2.0], vec![0.0, -90.0]];
    /// let measured = MeasuredResponse::of_columns(&names, &columns, ResponseForm::Mobility, 1.0, None)?;
    /// assert!((measured[0].values().values()[1].im + 2.0).abs() < 1e-15);
    /// # Ok::<(), fmm_frf::FrfError>(())
    /// ```
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for columns of which it is not clear what they are, or of different length;
    /// [`FrfError::Values`] for numbers that are not finite or frequencies that do not increase; otherwise those of
    /// [`MeasuredResponse::with_coherence_values`].
    pub fn of_columns(
        names: &[impl AsRef<str>],
        columns: &[Vec<f64>],
        form: ResponseForm,
        scale: f64,
        averages: Option<f64>,
    ) -> Result<Vec<Self>, FrfError> {
        let contents = contents(names)?;
        let length = columns.first().map_or(0, Vec::len);
        if contents.len() != columns.len() || columns.iter().any(|column| column.len() != length) {
            let what = "columns need a name each, and all the same number of lines";
            return Err(FrfError::mismatch(format!("{what}, but there are {} names", contents.len())));
        }
        let listed = || names.iter().map(|name| format!("\"{}\"", name.as_ref())).collect::<Vec<_>>().join(", ");
        let of_frequency = contents.iter().position(|content| matches!(content, Content::Frequency(_)));
        let Some((at, Content::Frequency(hertz))) = of_frequency.map(|at| (at, contents[at])) else {
            return Err(FrfError::mismatch(format!("no column is called a frequency; there are {}", listed())));
        };
        let kept: Vec<usize> = (0..length).filter(|line| columns[at][*line] != 0.0).collect();
        let frequencies: Vec<f64> = kept.iter().map(|line| columns[at][*line] * hertz).collect();
        let column = |at: usize| kept.iter().map(move |line| columns[at][*line]);
        let mut others = (0..contents.len()).filter(|other| *other != at).peekable();
        let mut found = Vec::new();
        while let Some(first) = others.next() {
            let second = others.next();
            let pair = second.map(|second| (contents[first], contents[second], second));
            let values: Vec<Complex64> = match pair {
                Some((Content::Real, Content::Imaginary, second)) => {
                    column(first).zip(column(second)).map(|(re, im)| Complex64::new(re, im) * scale).collect()
                }
                Some((Content::Magnitude, Content::Phase(radians), second)) => {
                    let polar = |(size, phase): (f64, f64)| Complex64::from_polar(size * scale, phase * radians);
                    column(first).zip(column(second)).map(polar).collect()
                }
                Some((Content::Level, Content::Phase(radians), second)) => {
                    let polar = |(level, phase): (f64, f64)| {
                        Complex64::from_polar(10f64.powf(level / 20.0) * scale, phase * radians)
                    };
                    column(first).zip(column(second)).map(polar).collect()
                }
                _ => {
                    let what = "columns must be real and imaginary part, or magnitude and phase, in turn";
                    let which = names[first].as_ref();
                    return Err(FrfError::mismatch(format!("{what}; \"{which}\" is not; there are {}", listed())));
                }
            };
            let place = Freedom { node: i32::try_from(found.len() + 1).unwrap_or(i32::MAX), ..Freedom::default() };
            let response = FrequencyResponse::new(form, frequencies.clone(), values)?;
            let mut measured = MeasuredResponse::new(response).between(place, Freedom::default());
            if let Some(other) = others.next_if(|other| contents[*other] == Content::Coherence)
                && let Some(averages) = averages
            {
                measured = measured.with_coherence_values(&column(other).collect::<Vec<_>>(), averages)?;
            }
            found.push(measured);
        }
        if found.is_empty() {
            return Err(FrfError::mismatch(format!("no column holds a response; there are {}", listed())));
        }
        Ok(found)
    }
}

/// Contents of all columns.
fn contents(names: &[impl AsRef<str>]) -> Result<Vec<Content>, FrfError> {
    let known: Vec<_> = names.iter().map(|name| content(name.as_ref())).collect();
    if known.iter().all(Option::is_none) {
        let in_turn = |at: usize| match at {
            0 => Content::Frequency(1.0),
            at if at % 2 == 1 => Content::Real,
            _ => Content::Imaginary,
        };
        return Ok((0..names.len()).map(in_turn).collect());
    }
    let unclear = |name: &str| FrfError::mismatch(format!("it is not clear what the column \"{name}\" is"));
    names.iter().zip(known).map(|(name, known)| known.unwrap_or_else(|| Err(unclear(name.as_ref())))).collect()
}

/// Content of a column of this name, if the name says it.
fn content(name: &str) -> Option<Result<Content, FrfError>> {
    let name = name.trim().to_lowercase();
    let has = |word: &str| name.contains(word);
    // A unit in brackets, or behind the last space or underscore.
    let unit = name.trim_end_matches([']', ')']).rsplit(['[', '(', ' ', '_']).next().unwrap_or_default();
    let is_word = |word: &str| name.split(|c: char| !c.is_alphabetic()).any(|part| part == word);
    if has("freq") || is_word("f") || is_word("hz") {
        let hertz = hertz(if unit == name || unit.starts_with("freq") { "" } else { unit });
        let what = || FrfError::mismatch(format!("the frequencies \"{name}\" must be in Hz, kHz or rad/s"));
        return Some(hertz.ok_or_else(what).map(Content::Frequency));
    }
    if has("coh") {
        return Some(Ok(Content::Coherence));
    }
    if has("phase") || is_word("angle") || is_word("arg") {
        let what =
            || FrfError::mismatch(format!("is \"{name}\" in degrees? Call it \"phase [deg]\" or \"phase [rad]\""));
        let radians = if has("deg") || has("°") { Some(1f64.to_radians()) } else { has("rad").then_some(1.0) };
        return Some(radians.ok_or_else(what).map(Content::Phase));
    }
    if is_word("real") || is_word("re") {
        return Some(Ok(Content::Real));
    }
    // Before the magnitude, whose beginning it contains.
    if is_word("im") || has("imag") {
        return Some(Ok(Content::Imaginary));
    }
    let size = if is_word("db") { Content::Level } else { Content::Magnitude };
    (has("mag") || has("amp") || is_word("abs") || is_word("db")).then_some(Ok(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(names: &[&str], columns: &[&[f64]]) -> Result<Vec<MeasuredResponse>, FrfError> {
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| column.to_vec()).collect();
        MeasuredResponse::of_columns(names, &columns, ResponseForm::Accelerance, 2.0, Some(4.0))
    }

    #[test]
    fn the_names_say_what_is_in_a_column() {
        let frequency: &[f64] = &[0.0, 1.0, 2.0];
        let one: &[f64] = &[9.0, 3.0, 2.0];
        for (names, unit) in [
            (["frequency [Hz]", "real", "imag"], 1.0),
            (["f (kHz)", "re", "im"], 1e3),
            (["freq_hz", "H_real", "H_imag"], 1.0),
            (["data[:,0]", "data[:,1]", "data[:,2]"], 1.0),
            (["Frequency", "Re(H)", "Im(H)"], 1.0),
        ] {
            let found = read(&names, &[frequency, one, one]).unwrap_or_else(|error| panic!("{names:?}: {error}"));
            assert_eq!(found[0].values().frequencies(), [unit, 2.0 * unit], "{names:?}");
            assert_eq!(found[0].values().values()[0], Complex64::new(6.0, 6.0), "{names:?}");
        }
        let names = ["Hz", "mag [dB]", "phase [deg]", "coherence", "mag_2", "phase_2 (rad)"];
        let half: &[f64] = &[0.5, 0.5, 0.5];
        let found = read(&names, &[frequency, &[0.0, 20.0, 40.0], &[0.0, 180.0, 0.0], half, one, &[0.0; 3]]).unwrap();
        assert!((found[0].values().values()[0] + 20.0).norm() < 1e-12 && found[0].uncertainty().is_some());
        assert!((found[1].values().values()[0] - 6.0).norm() < 1e-12 && found[1].uncertainty().is_none());
        assert_eq!(found[1].response().to_string(), "2");
    }

    #[test]
    fn what_is_not_clear_is_refused() {
        let frequency: &[f64] = &[1.0, 2.0];
        for (names, part) in [
            (["frequency", "magnitude", "phase"], "phase [deg]"),
            (["frequency [rpm]", "real", "imag"], "Hz, kHz or rad/s"),
            (["frequency", "force", "imag"], "\"force\""),
            (["frequency", "imag", "real"], "in turn"),
            (["coherence", "real", "imag"], "no column is called a frequency"),
        ] {
            let error = read(&names, &[frequency; 3]).expect_err("it is not clear").to_string();
            assert!(error.contains(part), "{names:?}: {error}");
        }
        assert!(matches!(read(&["a", "b", "c"], &[&[1.0, f64::NAN][..]; 3]), Err(FrfError::Values { .. })));
        assert!(read(&["a", "b", "c"], &[&[1.0], &[1.0, 2.0], &[1.0]]).is_err());
        assert!(read(&["frequency"], &[frequency]).is_err() && read(&[], &[]).is_err());
    }
}
