//! Directions in which the parameters can change without changing the residuals.

use std::fmt;

/// A direction, in relative changes of the parameters, that the residuals do not see.
///
/// ```text
/// Σⱼ (∂r/∂θⱼ) sⱼ cⱼ = 0,     dθⱼ = sⱼ cⱼ,     max |cⱼ| = 1
/// ```
///
/// The scale sⱼ is |θⱼ|, so that the components are relative changes d ln|θⱼ|. For a value of zero, or zero to
/// rounding, which has no relative change, it is the change that would move the residuals as much as the most
/// influential parameter does when it changes by its own value. Several directions are given in reduced form: each has
/// a component of 1 that is 0 in all others.
#[derive(Debug, Clone, PartialEq)]
pub struct NullDirection {
    names: Vec<String>,
    components: Vec<f64>,
    /// The changes of the parameters themselves, each in its unit.
    changes: Vec<f64>,
    /// True where the component is relative to the value of its parameter.
    is_relative: Vec<bool>,
    /// Components smaller than this are rounding or differencing noise.
    noise: f64,
}

impl NullDirection {
    /// One relative change per parameter of the problem, in its order.
    pub fn components(&self) -> &[f64] {
        &self.components
    }

    /// The parameters that take part, with their relative changes.
    pub fn participants(&self) -> impl Iterator<Item = (&str, f64)> {
        let all = self.names.iter().zip(&self.components);
        all.filter(|(_, change)| change.abs() > self.noise).map(|(name, change)| (name.as_str(), *change))
    }
}

/// A value whose whole influence is less than this share of the largest is zero to rounding, as the position is that a
/// fit finds to be 1e-17 m.
const ZERO: f64 = 1e-8;

/// Turns right singular vectors of zero singular values into directions.
///
/// `null` holds vectors over the columns `columns` with `scales` the norms of these columns; `values` has all
/// parameters, `names` too.
pub(crate) fn null_directions(
    null: &[Vec<f64>],
    columns: &[usize],
    scales: &[f64],
    values: &[f64],
    names: &[&str],
    noise: f64,
) -> Vec<NullDirection> {
    let influence = columns.iter().zip(scales).map(|(&j, scale)| values[j].abs() * scale).fold(0.0, f64::max);
    let is_relative = |(&j, scale): (&usize, &f64)| values[j].abs() * scale > ZERO * influence;
    let unit = |(&j, scale): (&usize, &f64)| match values[j].abs() * scale {
        own if is_relative((&j, scale)) => own,
        _ if influence > 0.0 => influence,
        _ => 1.0,
    };
    let units: Vec<f64> = columns.iter().zip(scales).map(unit).collect();
    let relative = |vector: &Vec<f64>| vector.iter().zip(&units).map(|(v, unit)| v / unit).collect();
    let mut rows: Vec<Vec<f64>> = null.iter().map(relative).collect();
    reduce(&mut rows);
    rows.into_iter()
        .map(|row| {
            let mut direction = NullDirection {
                names: names.iter().map(|&name| name.to_owned()).collect(),
                components: vec![0.0; values.len()],
                changes: vec![0.0; values.len()],
                is_relative: vec![true; values.len()],
                noise,
            };
            for (((&j, scale), unit), component) in columns.iter().zip(scales).zip(&units).zip(row) {
                direction.components[j] = component;
                direction.changes[j] = component * unit / scale;
                direction.is_relative[j] = is_relative((&j, scale));
            }
            direction
        })
        .collect()
}

/// Gauss–Jordan elimination with complete pivoting; each row ends with 1 as its largest component.
fn reduce(rows: &mut [Vec<f64>]) {
    for row in rows.iter_mut() {
        normalise(row);
    }
    for done in 0..rows.len() {
        let largest = |row: &[f64]| {
            row.iter().enumerate().fold((0, 0.0f64), |best, (j, x)| if x.abs() > best.1.abs() { (j, *x) } else { best })
        };
        let candidates = done..rows.len();
        let Some(pivot_row) =
            candidates.max_by(|&a, &b| largest(&rows[a]).1.abs().total_cmp(&largest(&rows[b]).1.abs()))
        else {
            return;
        };
        rows.swap(done, pivot_row);
        let (column, pivot) = largest(&rows[done]);
        if pivot == 0.0 {
            return;
        }
        let lead: Vec<f64> = rows[done].iter().map(|x| x / pivot).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            if i == done {
                row.clone_from(&lead);
            } else {
                let factor = row[column];
                for (x, l) in row.iter_mut().zip(&lead) {
                    *x -= factor * l;
                }
            }
        }
    }
    for row in rows {
        normalise(row);
    }
}

/// Scales a vector so that its first component of nearly largest magnitude becomes 1.
fn normalise(row: &mut [f64]) {
    let largest = row.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    // Nearly, as equal components differ by rounding and the sign should not hang on that.
    if let Some(lead) = row.iter().copied().find(|x| x.abs() > 0.999 * largest) {
        for x in row {
            *x = *x / lead.abs() * lead.signum();
        }
    }
}

impl NullDirection {
    /// The combination that is determined, if it has a name.
    ///
    /// A direction is known at one point only, where values of one size can be scaled and shifted alike.
    fn pattern(&self) -> (Pattern, Pattern) {
        let parts: Vec<usize> = (0..self.names.len()).filter(|&j| self.components[j].abs() > self.noise).collect();
        let of = |numbers: &[f64]| {
            let first = numbers.first().copied().unwrap_or(0.0);
            let is = |number: f64, wanted: f64| (number - wanted).abs() <= 1e-3 * first.abs();
            if numbers.iter().all(|number| is(*number, first)) {
                Pattern::Together
            } else if numbers.len() == 2 && is(numbers[1], -first) {
                Pattern::Opposite
            } else {
                Pattern::None
            }
        };
        let collect = |numbers: &[f64]| parts.iter().map(|&j| numbers[j]).collect::<Vec<f64>>();
        let has_shares = parts.iter().all(|&j| self.is_relative[j]);
        let shares = if has_shares { of(&collect(&self.components)) } else { Pattern::None };
        // The change of a value whose sign the share does not tell.
        (shares, of(&collect(&self.changes)))
    }
}

/// Likeness of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pattern {
    /// All are equal.
    Together,
    /// There are two, and they are opposite.
    Opposite,
    /// Otherwise.
    None,
}

impl fmt::Display for NullDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.participants().map(|(name, _)| name).collect();
        let (how, what) = match names.as_slice() {
            [] => return write!(f, "no parameter has any influence on the residuals"),
            [name] => return write!(f, "{name} has no influence on the residuals"),
            _ => match self.pattern() {
                (Pattern::Together, Pattern::None) => ("can be scaled together", "only their ratios are determined"),
                (Pattern::None, Pattern::Together) => {
                    ("can be shifted together", "only their differences are determined")
                }
                (Pattern::Together, Pattern::Together) => {
                    ("can be changed together", "only their ratios or their differences are determined")
                }
                (Pattern::Opposite, Pattern::None) => ("can grow as", "only their product is determined"),
                (Pattern::None, Pattern::Opposite) => ("can grow by as much as", "only their sum is determined"),
                (Pattern::Opposite, Pattern::Opposite) => {
                    ("can grow as", "only their product or their sum is determined")
                }
                (Pattern::Together, Pattern::Opposite) => {
                    ("can grow in size together", "only their ratio or their sum is determined")
                }
                (Pattern::Opposite, Pattern::Together) => {
                    ("can be shifted together", "only their difference or their product is determined")
                }
                (Pattern::None, Pattern::None) => return self.write_changes(f),
            },
        };
        match names.as_slice() {
            [first, second] if how.ends_with("as") => {
                write!(f, "{first} {how} {second} shrinks without changing the residuals; {what}")
            }
            names => write!(f, "{} {how} without changing the residuals; {what}", enumerate(names)),
        }
    }
}

impl NullDirection {
    /// Changes in percent, and for values of zero as they are.
    fn write_changes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = (0..self.names.len()).filter(|&j| self.components[j].abs() > self.noise);
        let changes: Vec<String> = parts
            .map(|j| {
                let name = &self.names[j];
                if self.is_relative[j] {
                    format!("{name} by {:+.3} %", self.components[j])
                } else {
                    format!("{name} by {:+.3e}", 0.01 * self.changes[j])
                }
            })
            .collect();
        let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
        write!(f, "the residuals stay the same when {} change together", enumerate(&changes))
    }
}

/// "a, b and c".
pub(crate) fn enumerate(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_name_what_is_determined() {
        let direction = |components: &[f64]| NullDirection {
            names: ["mass", "stiffness", "damping"].map(str::to_owned).to_vec(),
            components: components.to_vec(),
            changes: components.iter().zip([1.0, 20.0, 0.3]).map(|(share, value)| share * value).collect(),
            is_relative: vec![true; 3],
            noise: 1e-6,
        };
        assert_eq!(
            direction(&[1.0, 1.0, 1.0]).to_string(),
            "mass, stiffness and damping can be scaled together without changing the residuals; \
             only their ratios are determined"
        );
        assert!(direction(&[1.0, -1.0, 0.0]).to_string().ends_with("only their product is determined"));
        assert_eq!(direction(&[0.0, 1.0, 1e-9]).to_string(), "stiffness has no influence on the residuals");
        assert_eq!(
            direction(&[1.0, 0.5, -0.25]).to_string(),
            "the residuals stay the same when mass by +1.000 %, stiffness by +0.500 % and damping by -0.250 % \
             change together"
        );
    }

    #[test]
    fn two_directions_are_separated() {
        // Mixtures of (1, 1, 0, 0) and (0, 0, 1, −2), as a decomposition returns them.
        let null = [vec![0.3, 0.3, 0.4, -0.8], vec![-0.5, -0.5, 0.1, -0.2]];
        let names = ["a", "b", "c", "d"];
        let directions = null_directions(&null, &[0, 1, 2, 3], &[1.0; 4], &[1.0; 4], &names, 1e-9);
        for direction in &directions {
            let c = direction.components();
            // A few operations on numbers of order one.
            let first = (c[0] - c[1]).abs() + c[2].abs() + c[3].abs() < 1e-14;
            let second = c[0].abs() + c[1].abs() + (c[2] + 0.5).abs() + (c[3] - 1.0).abs() < 1e-14;
            assert!(first || second, "components {c:?}");
        }
    }
}
