//! The search for the law that a record asks for: it begins simple and widens as the residuals ask.

mod spared;
mod varied;

use std::time::Instant;

use fmm_fit::Options;
use fmm_friction::{CoulombViscous, LawFamily, SearchStage};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, Experiments, reference};
use crate::fit::stages::Begin;
use crate::friction_curve::projection::{Projected, ShownFriction};
use crate::identification::Identification;
use crate::identification::beside::closest;
use crate::identification::drift::drifts_in_vain;
use crate::judgement::Judgement;
use crate::judgement::comparison::{Comparison, explains};
use crate::judgement::filtering::{Filtered, behind_filter};
use crate::judgement::inquiry::Inquiry;
use crate::judgement::rules::{
    ALLOWED, ENOUGH_TO_JUDGE, INEXACT, LEAST_PRESLIDING, MOST_ITERATIONS, MOST_ITERATIONS_OF_CHANGE,
    MOST_ITERATIONS_WITH_STATE, SEEN_PRESLIDING, STEPS_OF_PRESLIDING,
};
use crate::judgement::score_test::{Extension, ScoreTest, score_tests};
use crate::judgement::trials::{CORNERS, Trial, beside_line};
use crate::machine::Terms;
use crate::machine::term::Term;
use crate::problem::Problem;
use crate::problem::parts::thinned;
use crate::problem::starts::Fitted;
use crate::threads::{is_past, on_all_threads};
use crate::warning::Warning;

impl Inquiry<'_> {
    /// The comparison of as many laws as vibrations ask for.
    ///
    /// First viscous damping, Coulomb friction and both. If a score test of these is significant, or their residuals
    /// are correlated: the laws of the catalogue that the friction over the speed allows, which the records show
    /// without a law, each begun where it follows that friction best; springs that harden, soften, meet a stop or
    /// have a gap if there is a sign of one; and laws with presliding if there is a sign of it. The tests are in
    /// [`Comparison::score_tests`], the laws that are excluded without a fit in [`Comparison::excluded`]. Laws that
    /// cannot be fitted to the end, and that are then far from others, are left out; a warning names them, and one
    /// each law that cannot be fitted at all.
    ///
    /// # Errors
    /// Those of [`identify`](crate::identify), for a parameter that no law has, and for forces along motions.
    pub fn search(&self) -> Result<Comparison, IdentifyError> {
        let Experiments::Vibrations(decays) = self.experiments else {
            return Err(IdentifyError::contradiction(
                "a search is for vibrations; compare candidates for a force along a motion",
            ));
        };
        self.on_pool(|| {
            let end = self.end();
            let found = self.search_here(decays, true, end)?;
            if drifts_in_vain(found.preferred()) { self.search_here(decays, false, end) } else { Ok(found) }
        })
    }

    /// The search of laws for `decays` until the `end`, beside a drift where they show one and may.
    pub(crate) fn search_here(
        &self,
        decays: &[Experiment],
        may_drift: bool,
        end: Option<Instant>,
    ) -> Result<Comparison, IdentifyError> {
        let run = Run { inquiry: self, decays, beside: &Terms::NONE, options: &self.options, end };
        if !self.held.is_empty() {
            self.require_known(decays)?;
        }
        let mut found = run.fit(run.candidates(self.at(SearchStage::Simple))?, Start::Records)?;
        run.follow_special_cases(&mut found);
        // A drift of a speed that only falls is friction as well.
        let may_drift = may_drift && !reference(decays).is_run_down();
        let closest = closest(found.identifications.iter()).filter(|_| may_drift);
        let drifting = closest.and_then(|found| found.with_drift(decays));
        let mut decays = decays;
        if let Some(drifting) = &drifting {
            let with_drift =
                Run { decays: drifting, ..run }.fit(run.candidates(self.at(SearchStage::Simple))?, Start::Records)?;
            if explains(&with_drift.identifications) {
                (decays, found) = (drifting, with_drift);
            }
        }
        let run = Run { decays, ..run };
        run.fit_changes(&mut found, Found::simple)?;
        let (mut tests, mut left_out) = run.score_tests(&found);
        let changes = found.changes();
        if changes || found.asks_for_more(&tests) {
            run.fit_further(&mut found, &mut tests, changes)?;
        }
        run.fit_changes(&mut found, Found::preferred)?;
        run.fit_over_position(&mut found)?;
        if self.machine.steadiness().is_some() {
            run.allow_changes(&mut found)?;
        }
        run.follow_special_cases(&mut found);
        run.finish(&mut found);
        run.fit_without_spring(&mut found);
        let dropped = found.drop_unfinished(&self.at(SearchStage::Simple));
        tests.retain(|test| test.uncertainty.is_finite());
        left_out.extend(found.failures());
        let Found { candidates, identifications, filtered, .. } = found;
        let mut comparison = Comparison::of(decays, &candidates, identifications, Vec::new(), filtered)?;
        comparison.score_tests = tests;
        comparison.excluded = found.excluded;
        comparison.warnings.extend(left_out);
        comparison.is_complete = !found.is_cut_short;
        if found.is_cut_short {
            comparison.warnings.push(Warning::TimeLimit);
        }
        if !dropped.is_empty() {
            comparison.warnings.push(Warning::NotFitted { laws: dropped.join(", ") });
        }
        Ok(comparison)
    }
}

/// Laws that a search has fitted so far.
#[derive(Default)]
struct Found {
    candidates: Vec<Candidate>,
    identifications: Vec<Identification>,
    /// Names of the laws that could not be fitted, with a warning each.
    failures: Vec<(String, Warning)>,
    /// Names of the laws that the friction over the speed excludes without a fit.
    excluded: Vec<String>,
    /// Terms that the records ask for beside any friction over the speed.
    beside: Terms,
    /// The fit behind a filter in the sensor, if one was made.
    filtered: Option<Filtered>,
    is_cut_short: bool,
}

impl Found {
    /// Adds further fits; of two fits by one law the better stays.
    fn add(&mut self, further: Self) {
        self.is_cut_short |= further.is_cut_short;
        self.excluded.extend(further.excluded);
        self.failures.extend(further.failures);
        for (candidate, found) in further.candidates.into_iter().zip(further.identifications) {
            match self.identifications.iter_mut().find(|known| known.law() == found.law()) {
                Some(known) if found.fit().sum_of_squares() < known.fit().sum_of_squares() => *known = found,
                Some(_) => {}
                None => {
                    self.candidates.push(candidate);
                    self.identifications.push(found);
                }
            }
        }
    }

    /// Warnings about the laws that could not be fitted in any try.
    fn failures(&mut self) -> impl Iterator<Item = Warning> + '_ {
        let failures = std::mem::take(&mut self.failures).into_iter();
        failures.filter(|(law, _)| self.candidates.iter().all(|known| known.name() != *law)).map(|(_, warning)| warning)
    }

    /// Leaves out the laws whose fits have not ended in their lowest minimum and are far from what other laws reach;
    /// returns their names.
    fn drop_unfinished(&mut self, simple: &[Trial]) -> Vec<String> {
        let simple: Vec<&str> = simple.iter().map(|trial| trial.candidate.law_name()).collect();
        let Some(judgement) = Judgement::of(&self.candidates, &self.identifications) else { return Vec::new() };
        let all = std::mem::take(&mut self.candidates).into_iter().zip(std::mem::take(&mut self.identifications));
        let mut dropped = Vec::new();
        for (place, (candidate, found)) in all.enumerate() {
            let is_simple = simple.contains(&candidate.law_name());
            if !is_simple && !judgement.is_left(place) && !judgement.is_finished[place] {
                dropped.push(candidate.name());
            } else {
                self.candidates.push(candidate);
                self.identifications.push(found);
            }
        }
        dropped
    }

    /// The simple laws leave something in the residuals.
    fn asks_for_more(&self, tests: &[ScoreTest]) -> bool {
        let held_back = |found: &Identification| found.damping_would_be_negative();
        tests.iter().any(ScoreTest::is_significant) || self.is_structured() || self.base().is_some_and(held_back)
    }

    /// The residuals of the best law are correlated.
    fn is_structured(&self) -> bool {
        self.preferred().is_some_and(|preferred| preferred.structure.is_correlated())
    }

    /// The best law is one of friction that changes during the record.
    fn changes(&self) -> bool {
        self.preferred().is_some_and(|preferred| preferred.fitted.model.terms.has(Term::Change))
    }

    fn preferred(&self) -> Option<&Identification> {
        let judgement = Judgement::of(&self.candidates, &self.identifications)?;
        Some(&self.identifications[judgement.preferred])
    }

    /// The fit whose residuals are asked for more: by Coulomb and viscous friction, with a change of it if that is
    /// best.
    fn base(&self) -> Option<&Identification> {
        self.preferred().filter(|preferred| preferred.fitted.model.terms.has(Term::Change)).or_else(|| self.simple())
    }

    /// The fit by Coulomb and viscous friction, whatever is held of it, with what else acts if there is one.
    fn simple(&self) -> Option<&Identification> {
        let all = || self.identifications.iter().filter(|found| found.family().name == CoulombViscous::NAME);
        all().find(|found| found.fitted.model.terms.iter().eq(self.beside.iter())).or_else(|| all().next())
    }
}

/// The law has presliding.
fn preslides(found: &Identification) -> bool {
    found.finding("contact_stiffness_per_mass").is_some()
}

/// Values from which the fits by one candidate begin.
type StartValues = Vec<Vec<f64>>;

/// Start of the fits of a search.
#[derive(Clone, Copy)]
enum Start<'a> {
    /// Values that the records show, of the fits without which there is no search.
    Records,
    /// The same of further fits.
    Further,
    /// Starts on the friction over the speed that the records show, and where `others` have ended.
    Friction { shown: &'a ShownFriction, others: &'a [&'a Fitted] },
    /// These of each candidate, projected on that friction; for other parameters of the same law they are found anew.
    Projected { shown: &'a ShownFriction, starts: &'a [StartValues] },
}

impl<'a> Start<'a> {
    fn of(shown: Option<&'a ShownFriction>, others: &'a [&'a Fitted]) -> Self {
        shown.map_or(Self::Further, |shown| Self::Friction { shown, others })
    }
}

/// A part of a search: with drift or without, by some options.
#[derive(Clone, Copy)]
struct Run<'a, 'i> {
    inquiry: &'a Inquiry<'i>,
    decays: &'a [Experiment],
    /// Terms beside every law.
    beside: &'a Terms,
    options: &'a Options,
    end: Option<Instant>,
}

impl Run<'_, '_> {
    /// The candidates of these trials, with the parameters that are held.
    fn candidates(&self, trials: impl IntoIterator<Item = Trial>) -> Result<Vec<Candidate>, IdentifyError> {
        trials.into_iter().map(|trial| self.inquiry.tried(&trial.beside(self.beside), self.decays)).collect()
    }

    /// Fits the `candidates`. Those that begin where the records say are fitted after the time limit too.
    fn fit(&self, candidates: Vec<Candidate>, start: Start<'_>) -> Result<Found, IdentifyError> {
        let must = matches!(start, Start::Records);
        let end = self.end.filter(|_| !must);
        let mut found = Found::default();
        let fit = |(place, candidate): (usize, &Candidate)| {
            if is_past(end) {
                return None;
            }
            let starts = |problem: &Problem<'_>| match start {
                Start::Friction { shown, others } => shown.starts(problem, others),
                Start::Projected { starts, .. } if problem.name() == candidate.law_name() => starts[place].clone(),
                Start::Projected { shown, .. } => shown.starts(problem, &[]),
                Start::Records | Start::Further => problem.starts(),
            };
            let begin = match start {
                Start::Records | Start::Further => Begin::Anywhere,
                Start::Friction { .. } | Start::Projected { .. } => Begin::From(&starts),
            };
            Some(self.inquiry.fit(candidate, self.decays.into(), begin, self.options, end))
        };
        let results = on_all_threads(candidates.iter().enumerate().collect(), fit);
        for (candidate, result) in candidates.into_iter().zip(results) {
            match result {
                Some(Ok(identification)) if !is_past(end) || identification.fit().outcome().is_success() => {
                    found.candidates.push(candidate);
                    found.identifications.push(identification);
                }
                Some(Err(error)) if must => return Err(error),
                Some(Err(error)) => {
                    let law = candidate.name();
                    let warning = Warning::left_out(&format!("the law {law}"), &error);
                    found.failures.push((law, warning));
                }
                _ => found.is_cut_short = true,
            }
        }
        Ok(found)
    }

    /// Options of a fit that is compared with others, beside the noise that the residuals `found` so far show.
    pub(super) fn limited(&self, found: &Found, most: usize) -> Options {
        let rows: usize = self.decays.iter().map(Experiment::rows).sum();
        // Of residuals that are alike over a time, so many are one independent one.
        let time = found.preferred().map_or(1.0, |preferred| preferred.structure.autocorrelation_time).max(1.0);
        let options = self.inquiry.options.clone().with_cost_tolerance(ENOUGH_TO_JUDGE * time / rows as f64);
        let most = most.min(options.max_iterations());
        options.with_polish_steps(0).with_restarts(0).with_max_iterations(most)
    }

    /// Fits the laws again that a special case fits better.
    fn follow_special_cases(&self, found: &mut Found) {
        let options = self.limited(found, MOST_ITERATIONS_OF_CHANGE);
        let Found { candidates, identifications, .. } = found;
        self.inquiry.follow_special_cases(candidates, identifications, self.decays.into(), &options, self.end);
    }

    /// Follows the preferred law to its end: fits of a search end where their misfits are known well enough. One that
    /// creeps is left where it is, as the records hardly tell its parameters.
    fn finish(&self, found: &mut Found) {
        let Some(judgement) = Judgement::of(&found.candidates, &found.identifications) else { return };
        if is_past(self.end) {
            return;
        }
        let place = judgement.preferred;
        let own = &mut found.identifications[place];
        if let Some(end) = self.fit_to_end(&found.candidates[place], &own.fitted)
            && end.fit().sum_of_squares() <= own.fit().sum_of_squares()
        {
            *own = end;
        }
    }

    /// The fit by `candidate` from where another has ended, if it comes to an end.
    fn fit_to_end(&self, candidate: &Candidate, from: &Fitted) -> Option<Identification> {
        let options = self.options.clone().with_max_iterations(self.options.max_iterations().min(MOST_ITERATIONS));
        let end = self.inquiry.fit(candidate, self.decays.into(), Begin::Extended(from), &options, self.end);
        end.ok().filter(|end| end.fit().outcome().is_success())
    }

    /// Adds fits by the laws that the friction over the speed allows, beside a spring that bends and a change of the
    /// friction where the records ask for these whatever the friction; then, where more is asked for, by laws with
    /// presliding. A simple law `changes` if its friction changes during the records.
    fn fit_further(&self, found: &mut Found, tests: &mut Vec<ScoreTest>, changes: bool) -> Result<(), IdentifyError> {
        let limited = [MOST_ITERATIONS, MOST_ITERATIONS_WITH_STATE, self.options.max_iterations()];
        let [of_speed, of_state, of_corners] = limited.map(|most| self.limited(found, most));
        // A contact that yields is a spring that softens: it may be what another spring explains as well.
        let preslides_alone = self.shows_presliding(tests);
        let few = thinned(self.decays);
        let few = few.as_deref().unwrap_or(self.decays);
        let plain = ShownFriction::of(&self.inquiry.machine, Terms::NONE, few, self.end).ok();
        // A filter in the sensor looks like a bent spring as well. A fit behind it that fails is reported by the
        // comparison.
        let mut is_filtered = || {
            found.filtered = behind_filter(self.decays, &found.identifications, None).ok().flatten();
            found.filtered.as_ref().is_some_and(|behind| !behind.found.structure.is_correlated())
        };
        let has_spring = !reference(self.decays).is_run_down();
        let structured = plain.as_ref().filter(|plain| has_spring && plain.is_structured && !is_filtered());
        let further = structured.and_then(|plain| plain.beside(&self.inquiry.machine, few, self.end));
        let shown = further.as_ref().or(plain.as_ref());
        let beside = shown.map_or(Terms::NONE, |shown| shown.terms.clone());
        let of_speed = Run { options: &of_speed, beside: &beside, ..*self };
        if !beside.is_empty() {
            found.beside = beside.clone();
            let simple = of_speed.candidates(self.inquiry.at(SearchStage::Simple))?;
            found.add(of_speed.fit(simple, Start::Further)?);
            let spring = std::mem::take(tests).into_iter().filter(|test| test.extension == Extension::SofteningSpring);
            *tests = of_speed.score_tests(found).0.into_iter().chain(spring).collect();
        }
        let corners = if found.is_structured() && beside.has_spring() {
            self.candidates(beside_line(&CORNERS))?
        } else {
            Vec::new()
        };
        let (allowed, starts) = of_speed.allowed(found, shown)?;
        let projected = shown.map_or(Start::Further, |shown| Start::Projected { shown, starts: &starts });
        let [of_state, of_corners] = [&of_state, &of_corners].map(|options| Run { options, ..*self });
        let preslides = self.shows_presliding(tests);
        let with_state = || of_state.fit_presliding(Found::default(), plain.as_ref());
        // No law of one group begins where one of another has ended. Where friction changes, a contact that yields may
        // be asked for no more after that.
        let is_next = preslides || preslides_alone;
        let is_now = is_next && !changes;
        let parts: [&(dyn Fn() -> Result<Found, IdentifyError> + Sync); 3] = [
            &|| of_corners.fit(corners.clone(), Start::Further),
            &|| of_speed.fit(allowed.clone(), projected),
            &|| if is_now { with_state() } else { Ok(Found::default()) },
        ];
        for part in on_all_threads(parts.to_vec(), |part| part()) {
            found.add(part?);
        }
        if changes {
            if found.changes() && !found.asks_for_more(tests) {
                return Ok(());
            }
            if is_next {
                found.add(with_state()?);
            }
        }
        if preslides && found.is_structured() && !beside.is_empty() {
            let earlier = std::mem::take(found);
            *found = Run { beside: &beside, ..of_state }.fit_presliding(earlier, shown)?;
        }
        Ok(())
    }

    /// The `tests` have a sign of presliding that the records can show. A converter hides presliding shorter than a few
    /// of its steps, and its steps look like presliding: neither moves where the machine turns.
    fn shows_presliding(&self, tests: &[ScoreTest]) -> bool {
        let steps = self.decays.iter().map(|decay| {
            let summary = decay.summary();
            summary.resolution.filter(|_| summary.is_rounded()).unwrap_or(0.0) / summary.amplitudes.0
        });
        let least = steps.map(|step| STEPS_OF_PRESLIDING * step).fold(LEAST_PRESLIDING, f64::max);
        let is_seen = |test: &ScoreTest| {
            test.extension == Extension::Presliding && test.significance() > SEEN_PRESLIDING && test.size > least
        };
        tests.iter().any(is_seen)
    }

    /// The fits `found` so far and those by the laws with presliding; the further ones begin where the first ended.
    fn fit_presliding(&self, mut found: Found, shown: Option<&ShownFriction>) -> Result<Found, IdentifyError> {
        let first = self.candidates(self.inquiry.at(SearchStage::Presliding))?;
        found.add(self.fit(first, Start::of(shown, &[]))?);
        let further = self.candidates(self.inquiry.at(SearchStage::FurtherPresliding))?;
        let nearest = closest(found.identifications.iter().filter(|found| preslides(found)));
        let nearest: Vec<&Fitted> = nearest.iter().map(|found| &found.fitted).collect();
        let further = self.fit(further, Start::of(shown, &nearest))?;
        found.add(further);
        Ok(found)
    }

    /// The laws of the speed that the friction over the speed allows beside the best of them, and those that state
    /// none, with the starts of their fits. Those that it excludes are kept by name.
    fn allowed(
        &self,
        found: &mut Found,
        shown: Option<&ShownFriction>,
    ) -> Result<(Vec<Candidate>, Vec<StartValues>), IdentifyError> {
        let candidates = self.candidates(self.inquiry.of_speed())?;
        let Some(shown) = shown else { return Ok((candidates, Vec::new())) };
        let is_exact = self.decays.windows(2).all(|pair| pair[0].load_factor() == pair[1].load_factor());
        // A law without a problem is not fitted either.
        let project = |candidate: &Candidate| {
            let Ok(problem) = Problem::of(candidate, self.inquiry.machine, self.decays) else {
                return (None, Vec::new());
            };
            let problem = problem.bending_in_sight();
            let projected = shown.projected(&problem, &[]);
            let score = |best: &Projected| best.misfit + 2.0 * candidate.parameter_count() as f64;
            let of_speed = projected.first().filter(|best| best.shows_all && is_exact && candidate.law.is_of_speed());
            (of_speed.map(score), shown.starts_at(&projected, &problem, &[]))
        };
        let projected = on_all_threads(candidates.iter().collect(), project);
        let simple = found.simple().map(Candidate::fitted).and_then(|simple| project(&simple).0);
        let best = projected.iter().filter_map(|(score, _)| *score).fold(f64::INFINITY, f64::min);
        let most = best + ALLOWED + INEXACT * (simple.unwrap_or(best) - best).max(0.0);
        let (mut allowed, mut starts) = (Vec::new(), Vec::new());
        for (candidate, (score, begun)) in candidates.into_iter().zip(projected) {
            if score.is_some_and(|score| score > most) {
                found.excluded.push(candidate.name());
            } else {
                allowed.push(candidate);
                starts.push(begun);
            }
        }
        Ok((allowed, starts))
    }

    fn score_tests(&self, found: &Found) -> (Vec<ScoreTest>, Vec<Warning>) {
        let tests = |base| {
            score_tests(base, self.decays)
                .unwrap_or_else(|error| (Vec::new(), vec![Warning::left_out("the score tests", &error)]))
        };
        let (Some(base), Some(simple)) = (found.base(), found.simple()) else { return (Vec::new(), Vec::new()) };
        let (mut of_base, warnings) = tests(base);
        if found.changes() {
            let is_presliding = |test: &ScoreTest| test.extension == Extension::Presliding;
            of_base.extend(tests(simple).0.into_iter().filter(is_presliding));
        }
        (of_base, warnings)
    }
}
