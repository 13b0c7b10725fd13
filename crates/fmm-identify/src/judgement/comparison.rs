//! Several laws side by side, and which of them the data prefer.

use std::ops::ControlFlow;

use fmm_fit::{Options, Progress, f_tail};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, RecordSummary};
use crate::finding::{Finding, Source};
use crate::identification::Identification;
use crate::identification::closest;
use crate::judgement::Sign;
use crate::judgement::filtering::filtering_sensor;
use crate::judgement::{Judgement, shortcomings};
use crate::machine::Machine;
use crate::warning::Warning;

/// A law and the more general one that it was tested against.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NestedTest {
    /// Name of the restricted law.
    pub restricted: String,
    /// Name of the law that has it as a special case.
    pub full: String,
    /// Probability of so much less misfit by the full law if the restricted one is true, for the noise that the
    /// residuals show (1).
    pub p_value: f64,
}

/// Identifications of the same records by several laws.
///
/// A law is *excluded* if its misfit, beside the law that fits best, has p below 0.002 for the noise that the
/// residuals show; correlated residuals count for as much as they tell, so that the answer is the same however often a
/// record is sampled. Among the others the simplest with p of at least 0.0125 is preferred. The preference is *decided*
/// if its p is at least 0.05 and what is left beside it are laws that have it as a special case, whose further
/// parameters the record does not ask for, if no filter in the sensor would explain the record as well, and if no drift
/// was fitted beside residuals that are still correlated. Where a simple law is true, about one simulated record of
/// seven stays undecided (example `judgement`). The uncertainties of the preferred law include what the laws that are
/// left would change, by how probable they are.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Comparison {
    pub(crate) records: Vec<RecordSummary>,
    pub(crate) identifications: Vec<Identification>,
    pub(crate) judgement: Judgement,
    pub(crate) tests: Vec<NestedTest>,
    pub(crate) signs: Vec<Sign>,
    pub(crate) is_complete: bool,
    pub(crate) warnings: Vec<Warning>,
}

/// Identifies `decays` by each of `candidates` and compares them.
///
/// # Errors
/// [`IdentifyError`] as for [`identify`](crate::identify), and [`IdentifyError::Missing`].
pub fn compare(
    machine: &Machine,
    decays: &[Experiment],
    candidates: &[Candidate],
) -> Result<Comparison, IdentifyError> {
    compare_observed(machine, decays, candidates, &Options::default(), |_, _| ControlFlow::Continue(()))
}

/// As [`compare`], with options for the solver and an observer that gets the law's name with every trial step.
///
/// # Errors
/// As for [`compare`].
pub fn compare_observed(
    machine: &Machine,
    decays: &[Experiment],
    candidates: &[Candidate],
    options: &Options,
    mut observer: impl FnMut(&str, &Progress<'_>) -> ControlFlow<()> + Send,
) -> Result<Comparison, IdentifyError> {
    let mut fit = |decays: &[Experiment]| {
        let fitted = candidates.iter().map(|candidate| {
            let name = candidate.name();
            let mut observe = |progress: &Progress<'_>| observer(&name, progress);
            candidate.identify(machine, decays, options, &mut observe)
        });
        fitted.collect::<Result<Vec<_>, _>>()
    };
    let identifications = fit(decays)?;
    if let Some(drifting) = closest(&identifications).and_then(|found| found.with_drift(decays)) {
        let with_drift = fit(&drifting)?;
        if explains(&with_drift) {
            return Comparison::of(&drifting, candidates, with_drift);
        }
    }
    Comparison::of(decays, candidates, identifications)
}

/// Whether what is left of the records by the closest of these laws is noise: a drift that leaves more may be a law
/// that misses something.
pub(crate) fn explains(identifications: &[Identification]) -> bool {
    closest(identifications).is_some_and(|found| !found.structure().is_structured())
}

impl Comparison {
    /// The comparison of `candidates` by their `identifications` from `decays`.
    pub(crate) fn of(
        decays: &[Experiment],
        candidates: &[Candidate],
        mut identifications: Vec<Identification>,
    ) -> Result<Self, IdentifyError> {
        let mut judgement = Judgement::of(candidates, &identifications)
            .ok_or_else(|| IdentifyError::missing("there is no law to compare; give at least one candidate"))?;
        let preferred = judgement.preferred;
        let others = unfinished(candidates, &identifications);
        judgement.is_decided &= others.is_empty();
        // What the fit by the preferred law says of itself stands among its own warnings.
        let own = format!("the fit {}", identifications[preferred].fit().outcome());
        let is_said = |warning: &Warning| matches!(warning, Warning::OtherLaw { law, sentence } if *law == candidates[preferred].name() && *sentence == own);
        let others: Vec<Warning> = others.into_iter().filter(|warning| !is_said(warning)).collect();
        // A filter in the sensor that explains the record as well is a rival, though it is no law.
        let sensor = filtering_sensor(decays, &identifications, preferred);
        judgement.is_decided &= sensor.is_none();
        // What a drift leaves may have been taken for the law.
        let drifts = decays.iter().any(Experiment::drifts);
        judgement.is_decided &= !(drifts && identifications[preferred].structure().is_correlated());
        // Noise that grows with the motion hides what a law that is left has more than the preferred one.
        let grows = identifications[preferred].noise().growth().is_some();
        let has_others = (0..candidates.len()).any(|place| place != preferred && judgement.is_left(place));
        judgement.is_decided &= !(grows && has_others);
        let widened = widen_for_other_laws(candidates, &mut identifications, &judgement);
        let mut warnings = identifications[preferred].warnings().to_vec();
        warnings.extend(others);
        warnings.extend(widened);
        if !judgement.is_decided {
            warnings.push(Warning::Undecided);
        }
        let others = identifications.iter().enumerate().filter(|(index, _)| *index != preferred);
        let negative = |warning: &&Warning| matches!(warning, Warning::NegativeDamping { .. });
        warnings.extend(others.flat_map(|(_, found)| found.warnings().iter().filter(negative).cloned()));
        warnings.extend(misled(&identifications, preferred));
        warnings.extend(sensor);
        Ok(Self {
            records: decays.iter().map(|decay| decay.summary().clone()).collect(),
            tests: tests(candidates, &identifications),
            identifications,
            judgement,
            signs: Vec::new(),
            is_complete: true,
            warnings,
        })
    }
}

fn tests(candidates: &[Candidate], identifications: &[Identification]) -> Vec<NestedTest> {
    let mut tests = Vec::new();
    for (restricted, small) in candidates.iter().zip(identifications) {
        for (full, large) in candidates.iter().zip(identifications) {
            let further = large.fit().rank().saturating_sub(small.fit().rank());
            if further == 0 || !restricted.is_nested_in(full) {
                continue;
            }
            let (misfit, freedom) = small.misfit_beside(large);
            if let Some(p_value) = f_tail(misfit / further as f64, further as f64, freedom) {
                tests.push(NestedTest { restricted: restricted.name(), full: full.name(), p_value });
            }
        }
    }
    tests
}

/// The level and straight line among the others that states the most different friction at rest, if it does so by more
/// than half of it and has missed the record by far: what somebody would have reported who had asked no further.
fn misled(identifications: &[Identification], preferred: usize) -> Option<Warning> {
    /// Residuals that exceed those of the preferred law by this factor do not describe the record.
    const FAR: f64 = 2.0;
    /// Times its standard uncertainty from which on a level is there.
    const SHOWN: f64 = 2.0;
    let right = &identifications[preferred];
    let is_shown = |level: &&Finding| level.uncertainty().is_some_and(|u| level.value() > SHOWN * u);
    right.main_findings().into_iter().find(is_shown)?;
    // A law that was not fitted to its minimum misleads nobody.
    let friction = right.friction_at_rest().filter(|friction| *friction > 0.0)?;
    let ratio = |found: &Identification| found.friction_at_rest().map(|other| other / friction);
    let wrong = identifications
        .iter()
        .filter(|found| found.rms_residual() > FAR * right.rms_residual())
        .filter(|found| found.fit().outcome().is_success() && found.family().dry_name() == Some("coulomb"))
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

/// What was not fitted to the end, law by law.
fn unfinished(candidates: &[Candidate], identifications: &[Identification]) -> Vec<Warning> {
    let of_law = |(place, candidate): (usize, &Candidate)| {
        let law = candidate.name();
        let sentences = shortcomings(place, candidates, identifications).into_iter();
        sentences.map(move |sentence| Warning::OtherLaw { law: law.clone(), sentence })
    };
    candidates.iter().enumerate().flat_map(of_law).collect()
}

/// Widens the uncertainties of the preferred law's parameters for what other laws, which the record does not exclude,
/// see differently; returns a warning for each that matters.
///
/// Preferring a law because the record is too short to show that it is too simple does not make it true. With the
/// weight w of the other law the variance becomes
///
/// ```text
/// (1 − w) u² + w (u_o² + (θ − θ_o)²)
/// ```
///
/// # References
/// S. T. Buckland, K. P. Burnham, N. H. Augustin, "Model selection: an integral part of inference", Biometrics 53
/// (1997) 603, <https://doi.org/10.2307/2533961>.
fn widen_for_other_laws(
    candidates: &[Candidate],
    identifications: &mut [Identification],
    judgement: &Judgement,
) -> Vec<Warning> {
    /// An uncertainty that grows by this factor is worth a line.
    const NOTABLE: f64 = 2.0;
    let preferred = judgement.preferred;
    let mut widths: Vec<(String, f64, Option<Warning>)> = Vec::new();
    for other in 0..candidates.len() {
        let (own, theirs) = (&candidates[preferred], &candidates[other]);
        let added = theirs.parameter_count().saturating_sub(own.parameter_count());
        let own_rank = identifications[preferred].fit().rank();
        // A parameter that ended on its bound is one more all the same.
        let further = identifications[other].fit().rank().saturating_sub(own_rank).max(added.min(1));
        if other == preferred
            || !judgement.is_left(other)
            || !judgement.is_finished[other]
            || further == 0 && own.is_nested_in(theirs)
        {
            continue;
        }
        let is_general = candidates[preferred].is_nested_in(&candidates[other]);
        let told = identifications[preferred].effective_count();
        let weight =
            judgement.weight(other, further, candidates[preferred].differs_by_damping(&candidates[other]), told);
        // Where the record does not decide, either law is as good as the other.
        let weight = if judgement.is_decided && is_general { weight } else { weight.max(0.5) };
        for (own, theirs) in identifications[preferred].common_findings(&identifications[other]) {
            let (Some(u), Some(their_u)) = (own.uncertainty(), theirs.uncertainty()) else { continue };
            // A law that leaves the value open says nothing of it.
            if their_u > theirs.value().abs() && !own.is_of_record() {
                continue;
            }
            let difference = own.value() - theirs.value();
            let widened = ((1.0 - weight) * u * u + weight * (their_u * their_u + difference * difference)).sqrt();
            let notable = widened > NOTABLE * u && !own.is_of_record();
            let warning = notable.then(|| Warning::DependsOnLaw {
                parameter: own.parameter().name().to_owned(),
                law: candidates[other].name(),
                finding: theirs.quantity(),
            });
            widths.push((own.parameter().name().to_owned(), widened, warning));
        }
    }
    // The widest counts, and one line says so.
    widths.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut warnings = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for (name, widened, warning) in widths {
        if names.contains(&name) {
            continue;
        }
        if let Some(own) = identifications[preferred].finding_mut(&name) {
            let narrow = own.uncertainty().unwrap_or(widened);
            own.add(Source::OtherLaws, (widened * widened - narrow * narrow).max(0.0).sqrt());
        }
        warnings.extend(warning);
        names.push(name);
    }
    // Several names of one quantity need one line: the one that is farthest from the fit.
    let last = warnings.pop();
    let of_law =
        |warning: &Warning, law: &str| matches!(warning, Warning::DependsOnLaw { law: other, .. } if other == law);
    if let Some(Warning::DependsOnLaw { law, .. }) = &last {
        warnings.retain(|warning| !of_law(warning, law));
    }
    warnings.extend(last);
    warnings
}

impl Comparison {
    /// One identification per law, in the order given.
    pub fn identifications(&self) -> &[Identification] {
        &self.identifications
    }

    /// The identification by the preferred law.
    pub fn preferred(&self) -> &Identification {
        &self.identifications[self.judgement.preferred]
    }

    /// Whether the data decide for the preferred law.
    pub fn is_decided(&self) -> bool {
        self.judgement.is_decided
    }

    /// The laws that the records do not exclude, the preferred one among them.
    pub fn not_excluded(&self) -> impl Iterator<Item = &Identification> {
        let left = |place: &usize| self.judgement.is_left(*place);
        (0..self.identifications.len()).filter(left).map(|place| &self.identifications[place])
    }

    /// p, probability of a misfit at least as large as that of each law, beside the law that fits best, if the law were
    /// true (1), one per identification. It is no probability of the law.
    pub fn p_values(&self) -> &[f64] {
        &self.judgement.p_values
    }

    /// The misfit of each law beside the law that fits best in variances of the noise, with 2 for each parameter that
    /// is determined or on a bound other than zero (1), one per identification. Only differences mean anything.
    pub fn scores(&self) -> &[f64] {
        &self.judgement.scores
    }

    /// What was looked for beside the simple laws, and how plain it is.
    pub fn signs(&self) -> &[Sign] {
        &self.signs
    }

    /// Whether all laws that the search would have tried were tried; false where a time limit ended it.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Tests of every law against the more general ones.
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
