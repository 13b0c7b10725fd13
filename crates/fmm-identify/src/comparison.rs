//! Several laws side by side, and which of them the data prefer.

use std::ops::ControlFlow;

use fmm_fit::{FTest, Fit, Options, Progress, f_test};

use crate::{Candidate, Finding, Identification, IdentifyError, Machine, RecordSummary, RingDown, Warning};

/// A law and the more general one that it was tested against.
#[derive(Debug, Clone, PartialEq)]
pub struct NestedTest {
    /// Name of the restricted law.
    pub restricted: String,
    /// Name of the law that has it as a special case.
    pub full: String,
    /// The test, which counts every residual as independent.
    pub test: FTest,
}

/// Identifications of the same records by several laws.
///
/// The preferred law has the smallest corrected Akaike criterion, with the number of residuals replaced by the
/// number of *independent* ones, n/τ: residuals that a record samples a thousand times a second are no thousand
/// witnesses. Laws within 2 of the best are too close to call; among them the one with the fewest parameters is
/// preferred, and [`is_decided`](Self::is_decided) is false. The uncertainties of its parameters then include what the
/// more general laws would change.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Comparison {
    records: Vec<RecordSummary>,
    identifications: Vec<Identification>,
    scores: Vec<f64>,
    tests: Vec<NestedTest>,
    preferred: usize,
    is_decided: bool,
    warnings: Vec<Warning>,
}

/// Differences of the criterion below this are too small to prefer a law (Burnham and Anderson 2002, section 2.6).
const CLOSE: f64 = 2.0;

/// Identifies `decays` by each of `candidates` and compares them.
///
/// # Errors
/// [`IdentifyError`] as for [`identify`](crate::identify), and [`IdentifyError::NoCandidate`].
pub fn compare(machine: &Machine, decays: &[RingDown], candidates: &[Candidate]) -> Result<Comparison, IdentifyError> {
    compare_observed(machine, decays, candidates, &Options::default(), |_, _| ControlFlow::Continue(()))
}

/// As [`compare`], with options for the solver and an observer that gets the law's name with every trial step.
///
/// # Errors
/// As for [`compare`].
pub fn compare_observed(
    machine: &Machine,
    decays: &[RingDown],
    candidates: &[Candidate],
    options: &Options,
    mut observer: impl FnMut(&str, &Progress<'_>) -> ControlFlow<()>,
) -> Result<Comparison, IdentifyError> {
    let mut identifications = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let name = candidate.name();
        let mut observe = |progress: &Progress<'_>| observer(&name, progress);
        identifications.push(candidate.identify(machine, decays, options, &mut observe)?);
    }
    let scores = scores(&identifications);
    let Some((preferred, is_decided)) = preferred(candidates, &identifications, &scores) else {
        return Err(IdentifyError::NoCandidate);
    };
    let mut warnings = identifications[preferred].warnings().to_vec();
    let others = unfinished(candidates, &identifications);
    let is_decided = is_decided && others.is_empty();
    warnings.extend(others);
    warnings.extend(widen_for_other_laws(candidates, &mut identifications, preferred));
    if !is_decided {
        warnings.push(Warning::Undecided);
    }
    let others = identifications.iter().enumerate().filter(|(index, _)| *index != preferred);
    let negative = |warning: &&Warning| matches!(warning, Warning::NegativeDamping { .. });
    warnings.extend(others.flat_map(|(_, found)| found.warnings().iter().filter(negative).cloned()));
    warnings.extend(misled(&identifications, preferred));
    Ok(Comparison {
        records: decays.iter().map(|decay| decay.summary().clone()).collect(),
        tests: tests(candidates, &identifications),
        identifications,
        scores,
        preferred,
        is_decided,
        warnings,
    })
}

fn tests(candidates: &[Candidate], identifications: &[Identification]) -> Vec<NestedTest> {
    let mut tests = Vec::new();
    for (restricted, small) in candidates.iter().zip(identifications) {
        for (full, large) in candidates.iter().zip(identifications) {
            if restricted.is_nested_in(full)
                && let Ok(test) = f_test(small.fit(), large.fit())
            {
                tests.push(NestedTest { restricted: restricted.name(), full: full.name(), test });
            }
        }
    }
    tests
}

/// The law among the others that states the most different friction at rest, if it does so by more than half of it and has
/// missed the record by far: what somebody would have reported who had asked no further.
fn misled(identifications: &[Identification], preferred: usize) -> Option<Warning> {
    /// Residuals that exceed those of the preferred law by this factor do not describe the record.
    const FAR: f64 = 2.0;
    let right = &identifications[preferred];
    let friction = right.friction_at_rest().filter(|friction| *friction > 0.0)?;
    let ratio = |found: &Identification| found.friction_at_rest().map(|other| other / friction);
    let wrong = identifications
        .iter()
        .filter(|found| found.rms_residual() > FAR * right.rms_residual())
        .filter_map(|found| Some((found, ratio(found)?)))
        .filter(|(_, ratio)| *ratio < 0.5)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    wrong.map(|(found, ratio)| Warning::Misled {
        law: found.law().to_owned(),
        friction: ratio * friction,
        preferred: friction,
        residuals: found.rms_residual() / right.rms_residual(),
    })
}

/// Laws that were not fitted to their minimum, or not to the lowest: a law cannot be worse than a special case of it.
fn unfinished(candidates: &[Candidate], identifications: &[Identification]) -> Vec<Warning> {
    /// Rounding of a sum of squares.
    const ROUNDING: f64 = 1e-9;
    let mut warnings = Vec::new();
    for (candidate, found) in candidates.iter().zip(identifications) {
        let law = candidate.name();
        if !found.fit().outcome().is_success() {
            let sentence = format!("the fit {}", found.fit().outcome());
            warnings.push(Warning::OtherLaw { law: law.clone(), sentence });
        }
        let sum = found.fit().sum_of_squares();
        let lower = |(special, other): &(&Candidate, &Identification)| {
            special.is_nested_in(candidate) && other.fit().sum_of_squares() < sum * (1.0 - ROUNDING) - found.floor()
        };
        if let Some((special, _)) = candidates.iter().zip(identifications).find(lower) {
            let sentence = format!("the fit missed its lowest minimum, as {} fits better", special.name());
            warnings.push(Warning::OtherLaw { law, sentence });
        }
    }
    warnings
}

/// Widens the uncertainties of the preferred law's parameters for what a more general law, which the record does not
/// exclude, sees differently; returns a warning for each that matters.
///
/// Preferring a law because the record is too short to show that it is too simple does not make it true. The
/// standard uncertainty becomes the root sum of squares of that under the general law and the difference between the two.
fn widen_for_other_laws(
    candidates: &[Candidate],
    identifications: &mut [Identification],
    preferred: usize,
) -> Vec<Warning> {
    /// An uncertainty that grows by this factor is worth a line.
    const NOTABLE: f64 = 2.0;
    let mut warnings = Vec::new();
    for general in 0..candidates.len() {
        if !candidates[preferred].is_nested_in(&candidates[general]) {
            continue;
        }
        let wider: Vec<Finding> = identifications[general].findings().to_vec();
        for finding in wider {
            let Some(own) = identifications[preferred].finding_mut(finding.parameter().name()) else { continue };
            let (Some(u), Some(wider_u)) = (own.uncertainty, finding.uncertainty()) else { continue };
            let widened = wider_u.hypot(own.value - finding.value());
            own.widen(widened);
            if widened > NOTABLE * u && !finding.is_of_record() {
                warnings.push(Warning::DependsOnLaw {
                    parameter: finding.parameter().name().to_owned(),
                    law: candidates[general].name(),
                    finding: finding.quantity(),
                });
            }
        }
    }
    warnings
}

/// Corrected Akaike criterion of each identification with the number of independent residuals instead of all, so far as
/// differences of it count; empty without identifications.
fn scores(identifications: &[Identification]) -> Vec<f64> {
    let Some(best) = identifications.iter().min_by(|a, b| a.rms_residual().total_cmp(&b.rms_residual())) else {
        return Vec::new();
    };
    let total = best.fit().residuals().len() as f64;
    let score = |fit: &Fit| {
        let parameters = fit.rank() as f64 + 1.0;
        let count = (total / best.autocorrelation_time()).max(parameters + 2.0);
        let correction = 2.0 * parameters * count / (count - parameters - 1.0);
        count * (fit.sum_of_squares().max(best.floor()) / total).ln() + correction
    };
    identifications.iter().map(|found| score(found.fit())).collect()
}

/// Index of the preferred law, and whether no other comes close; none without candidates.
fn preferred(candidates: &[Candidate], identifications: &[Identification], scores: &[f64]) -> Option<(usize, bool)> {
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    let close: Vec<usize> = (0..scores.len()).filter(|i| scores[*i] - least <= CLOSE).collect();
    let simplest = close.iter().copied().min_by_key(|i| candidates[*i].parameter_count())?;
    // A law whose extra parameter ended at its bound is the simpler law over again, not a rival.
    let rivals = close.iter().filter(|i| identifications[**i].fit().rank() != identifications[simplest].fit().rank());
    Some((simplest, rivals.count() == 0))
}

impl Comparison {
    /// One identification per law, in the order given.
    pub fn identifications(&self) -> &[Identification] {
        &self.identifications
    }

    /// The identification by the preferred law.
    pub fn preferred(&self) -> &Identification {
        &self.identifications[self.preferred]
    }

    /// Whether the data decide for the preferred law.
    pub fn is_decided(&self) -> bool {
        self.is_decided
    }

    /// The criterion by which laws are preferred, one per identification: Akaike's, corrected, with n/τ residuals. Only
    /// differences mean anything.
    pub fn scores(&self) -> &[f64] {
        &self.scores
    }

    /// F-tests of every law against the more general ones.
    pub fn tests(&self) -> &[NestedTest] {
        &self.tests
    }

    /// What each record is, what was done to it before it was fitted, and what was seen in it.
    pub fn records(&self) -> &[RecordSummary] {
        &self.records
    }

    /// What limits the findings of the preferred law, and the preference itself.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
