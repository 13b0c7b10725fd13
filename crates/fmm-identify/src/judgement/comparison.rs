//! Comparison of several laws by their fits to the same records.

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, RecordSummary};
use crate::finding::{Finding, Source};
use crate::identification::beside::closest;
use crate::identification::{Identification, Validation};
use crate::judgement::change::asks_for_change;
use crate::judgement::filtering::{Filtered, filtering_sensor, other_quantity};
use crate::judgement::rules::{EQUAL_PREDICTION, FAR, MISLEADING, NOTABLE_WIDENING, SHOWN, SHOWN_CHANGE};
use crate::judgement::score_test::ScoreTest;
use crate::judgement::unseen::Unseen;
use crate::judgement::{Judgement, shortcomings};
use crate::quantities::derived::OF_DAMPING;
use crate::warning::Warning;

/// Identifications of the same records by several laws.
///
/// A law is *excluded* if its misfit, beside the law that fits best, has p below 0.002 for the noise that the residuals
/// show. Correlated residuals count as fewer independent ones, so that the answer does not depend on the sampling rate.
/// Among the others the simplest law with p of at least 0.0125 is preferred. The preference is *decided* if
///
/// * its p is at least 0.05,
/// * the laws that are left beside it have it as a special case, and the record does not need their further parameters,
/// * no filter in the sensor explains the record as well, and
/// * no drift was fitted beside residuals that are still correlated.
///
/// If a simple law is true, about one simulated record of seven stays undecided (example `judgement`). The
/// uncertainties of the preferred law include the difference to the laws that are left, by their probability.
///
/// With forces to which nothing was fitted, the law that predicts them best is preferred.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Comparison {
    pub(crate) records: Vec<RecordSummary>,
    pub(crate) identifications: Vec<Identification>,
    pub(crate) judgement: Judgement,
    pub(crate) score_tests: Vec<ScoreTest>,
    /// Change of the friction during the records that the preferred law leaves out.
    pub(crate) change: Option<Unseen>,
    /// Dependence of the friction on the position that it leaves out.
    pub(crate) over_position: Option<Unseen>,
    /// Damping of the machine that it leaves out.
    pub(crate) unseen_damping: Option<Unseen>,
    /// Names of the laws that the friction over the speed excludes without a fit.
    pub(crate) excluded: Vec<String>,
    pub(crate) is_complete: bool,
    validations: Vec<Vec<Validation>>,
    pub(crate) warnings: Vec<Warning>,
}

/// The closest of these laws leaves noise of the records. A drift that leaves more may be a law that misses something.
pub(crate) fn explains(identifications: &[Identification]) -> bool {
    closest(identifications).is_some_and(|found| !found.structure.is_structured())
}

impl Comparison {
    /// The comparison of `candidates` by their `identifications` from `decays`, of which forces along motions have
    /// none, by the `validations` of each with forces that were not fitted, of which there may be none, and by a fit
    /// behind a filter that is known.
    pub(crate) fn of(
        decays: &[Experiment],
        candidates: &[Candidate],
        mut identifications: Vec<Identification>,
        validations: Vec<Vec<Validation>>,
        filtered: Option<Filtered>,
    ) -> Result<Self, IdentifyError> {
        let mut judgement = Judgement::of(candidates, &identifications)
            .ok_or_else(|| IdentifyError::missing("there is no law to compare; give at least one candidate"))?;
        let fits_best = judgement.preferred;
        judgement.preferred = predicts_best(&validations, fits_best);
        judgement.is_decided &= judgement.preferred == fits_best;
        let preferred = judgement.preferred;
        let others = unfinished(candidates, &identifications);
        judgement.is_decided &= others.is_empty();
        // The preferred law has the sentence on its own fit among its warnings.
        let own = format!("the fit {}", identifications[preferred].fit().outcome());
        let name = candidates[preferred].name();
        let is_said = |warning: &Warning| *warning == Warning::OtherLaw { law: name.clone(), sentence: own.clone() };
        let others: Vec<Warning> = others.into_iter().filter(|warning| !is_said(warning)).collect();
        // A filter in the sensor that explains the record as well is a rival, though it is no law.
        let sensor = filtering_sensor(decays, &identifications, preferred, filtered)
            .unwrap_or_else(|error| Some(Warning::left_out("a filter in the sensor", &error)));
        judgement.is_decided &= sensor.as_ref().is_none_or(|warning| matches!(warning, Warning::LeftOut { .. }));
        let quantity = other_quantity(decays, &identifications[preferred]);
        judgement.is_decided &= quantity.is_none();
        // The law may have taken a part of the drift.
        let drifts = decays.iter().any(Experiment::drifts);
        let is_simple = matches!(identifications[preferred].family().dry_name(), None | Some("coulomb"));
        judgement.is_decided &= !drifts || is_simple && !identifications[preferred].structure.is_correlated();
        // Noise that grows with the motion hides further parameters of a law that is left.
        let grows = identifications[preferred].covariance.noise.growth().is_some();
        let has_others = (0..candidates.len()).any(|place| place != preferred && judgement.is_left(place));
        judgement.is_decided &= !(grows && has_others);
        let widened = widen_for_other_laws(candidates, &mut identifications, &judgement);
        let mut warnings = identifications[preferred].warnings().to_vec();
        warnings.extend(others);
        warnings.extend(widened);
        if preferred != fits_best {
            let (fits, predicts) = (candidates[fits_best].name(), candidates[preferred].name());
            warnings.push(Warning::OtherPredicts { fits, predicts });
        } else if !judgement.is_decided {
            warnings.push(Warning::Undecided);
        }
        let predicted = validations.get(preferred).into_iter().flatten();
        warnings.extend(predicted.filter_map(|said| said.warning(identifications[preferred].law())));
        let others = identifications.iter().enumerate().filter(|(index, _)| *index != preferred);
        let negative = |warning: &&Warning| matches!(warning, Warning::NegativeDamping { .. });
        warnings.extend(others.flat_map(|(_, found)| found.warnings().iter().filter(negative).cloned()));
        warnings.extend(misled(&identifications, preferred));
        warnings.extend(sensor);
        warnings.extend(quantity);
        let change = Unseen::change(&identifications[preferred], decays);
        let asks = || asks_for_change(&identifications[preferred], decays, SHOWN_CHANGE);
        if change.map_or_else(asks, |change| change.is_shown()) {
            warnings.push(Warning::FrictionChanges { law: identifications[preferred].law().to_owned() });
            judgement.is_decided = false;
        }
        let over_position = Unseen::over_position(&identifications[preferred], decays);
        if over_position.is_some_and(|unseen| unseen.is_shown()) {
            warnings.push(Warning::FrictionOverPosition { law: identifications[preferred].law().to_owned() });
            judgement.is_decided = false;
        }
        let unseen_damping = Unseen::damping(&identifications[preferred], decays);
        Ok(Self {
            records: decays.iter().map(|decay| decay.summary().clone()).collect(),
            identifications,
            judgement,
            score_tests: Vec::new(),
            change,
            over_position,
            unseen_damping,
            excluded: Vec::new(),
            is_complete: true,
            validations,
            warnings,
        })
    }
}

/// Place of the law that predicts best what was not fitted; the one at `preferred` if it predicts as well, or if there
/// is nothing to predict.
fn predicts_best(validations: &[Vec<Validation>], preferred: usize) -> usize {
    let squares: Vec<f64> =
        validations.iter().map(|records| records.iter().map(|record| record.rms * record.rms).sum()).collect();
    let best = (0..squares.len()).min_by(|a, b| squares[*a].total_cmp(&squares[*b]));
    let is_as_good = |best: &usize| squares[preferred] <= squares[*best] * EQUAL_PREDICTION * EQUAL_PREDICTION;
    best.filter(|best| !is_as_good(best)).unwrap_or(preferred)
}

/// Warning about a level and a straight line that misses the record by far and gives less than half of the friction at
/// rest: the result of a fit that tries no further law.
fn misled(identifications: &[Identification], preferred: usize) -> Option<Warning> {
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
        .filter(|(_, ratio)| *ratio < MISLEADING)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    wrong.map(|(found, ratio)| Warning::Misled {
        law: found.law().to_owned(),
        friction: ratio * friction,
        preferred: friction,
        residuals: found.rms_residual() / right.rms_residual(),
    })
}

/// Laws that were not fitted to the end, with the reason.
fn unfinished(candidates: &[Candidate], identifications: &[Identification]) -> Vec<Warning> {
    let of_law = |(place, candidate): (usize, &Candidate)| {
        let law = candidate.name();
        let sentences = shortcomings(place, candidates, identifications).into_iter();
        sentences.map(move |sentence| Warning::OtherLaw { law: law.clone(), sentence })
    };
    candidates.iter().enumerate().flat_map(of_law).collect()
}

/// Widens the uncertainties of the preferred law by the differences to other laws that the record does not exclude;
/// returns a warning for each that matters.
///
/// Preferring a law because the record is too short to show that it is too simple does not make it true. Averaged over
/// all laws that state it, with their weights w, the variance of a finding is
///
/// ```text
/// Σ w_i (u_i² + (θ − θ_i)²) / Σ w_i
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
    let preferred = &identifications[judgement.preferred];
    let weights = judgement.weights(candidates, identifications);
    let mut averages: Vec<Average> = Vec::new();
    for (other, weight) in
        weights.into_iter().enumerate().filter(|(other, weight)| *other != judgement.preferred && *weight > 0.0)
    {
        for (own, theirs) in preferred.common_findings(&identifications[other]) {
            let (Some(u), Some(their_u)) = (own.uncertainty(), theirs.uncertainty()) else { continue };
            // A law that leaves the value open says nothing of it.
            if their_u > theirs.value().abs() && !own.is_of_record() {
                continue;
            }
            let name = own.parameter().name();
            let place = averages.iter().position(|average| average.name == name).unwrap_or_else(|| {
                let start = Average { name: name.to_owned(), weights: 1.0, sum: u * u, largest: 0.0, warning: None };
                averages.push(start);
                averages.len() - 1
            });
            let square = weight * (their_u * their_u + (own.value() - theirs.value()).powi(2));
            let average = &mut averages[place];
            average.weights += weight;
            average.sum += square;
            // What states the damping once more needs no sentence of its own.
            if square > average.largest && !own.is_of_record() && !OF_DAMPING.contains(&name) {
                average.largest = square;
                average.warning = Some(Warning::DependsOnLaw {
                    parameter: name.to_owned(),
                    law: candidates[other].name(),
                    finding: theirs.quantity(),
                });
            }
        }
    }
    let mut warnings: Vec<(f64, Warning)> = Vec::new();
    for Average { name, weights, sum, warning, .. } in averages {
        let preferred = &mut identifications[judgement.preferred];
        let Some(own) = preferred.findings.iter_mut().find(|own| own.parameter().name() == name) else { continue };
        let (narrow, wide) = (own.uncertainty().unwrap_or(0.0), (sum / weights).sqrt());
        own.add(Source::OtherLaws, (wide * wide - narrow * narrow).max(0.0).sqrt());
        warnings.extend(warning.filter(|_| wide > NOTABLE_WIDENING * narrow).map(|warning| (wide / narrow, warning)));
    }
    // Several names of one quantity need one line for each law: the one that is farthest from the fit.
    warnings.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut laws: Vec<String> = Vec::new();
    warnings.retain(|(_, warning)| {
        let Warning::DependsOnLaw { law, .. } = warning else { return true };
        let is_new = !laws.contains(law);
        laws.push(law.clone());
        is_new
    });
    warnings.into_iter().map(|(_, warning)| warning).collect()
}

/// Average of one finding over the laws that state it.
struct Average {
    name: String,
    /// Σ w_i and Σ w_i (u_i² + (θ − θ_i)²).
    weights: f64,
    sum: f64,
    /// Largest term of that sum by another law, and the warning about it.
    largest: f64,
    warning: Option<Warning>,
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

    /// The data decide for the preferred law.
    pub fn is_decided(&self) -> bool {
        self.judgement.is_decided
    }

    /// The data decide for the preferred law, and it leaves nothing but noise of the records.
    pub fn is_conclusive(&self) -> bool {
        self.is_decided() && !self.preferred().structure.is_structured()
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

    /// Score tests of extensions of Coulomb and viscous friction; empty unless a search made them.
    pub fn score_tests(&self) -> &[ScoreTest] {
        &self.score_tests
    }

    /// Change of the friction during the records that the preferred law leaves out; `None` where it has one, or the
    /// records do not tell.
    ///
    /// ```no_run
    /// # fn of(comparison: &fmm_identify::Comparison) {
    /// use fmm_identify::Unseen;
    ///
    /// if let Some(change) = comparison.friction_change().filter(Unseen::is_shown) {
    ///     println!("{:.2} % with each half cycle", 100.0 * change.size);
    /// }
    /// # }
    /// ```
    pub fn friction_change(&self) -> Option<Unseen> {
        self.change
    }

    /// Rise of the friction from the middle to the largest deflection that the preferred law leaves out, likewise.
    pub fn friction_over_position(&self) -> Option<Unseen> {
        self.over_position
    }

    /// Names of the laws that a search did not fit, as the friction over the speed that the records show without a law
    /// is far from all that they can state.
    pub fn excluded(&self) -> &[String] {
        &self.excluded
    }

    /// Agreement of each law, in the order given, with each record of forces that was
    /// [not fitted](crate::Inquiry::validated_by).
    pub fn validations(&self) -> &[Vec<Validation>] {
        &self.validations
    }

    /// All laws of the search were tried; false if a time limit ended it.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Each record of a vibration with its preparation and the observations made in it.
    pub fn records(&self) -> &[RecordSummary] {
        &self.records
    }

    /// Limits of the findings of the preferred law, and of the preference itself.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
