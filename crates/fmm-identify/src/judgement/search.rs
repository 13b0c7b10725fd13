//! The search for the law that a record asks for: it begins simple and widens as the residuals ask.

use std::time::Instant;

use fmm_fit::Options;
use fmm_friction::{Coulomb, CoulombViscous, LawFamily, SearchStage};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, Experiments};
use crate::fit::stages::{Begin, Near};
use crate::identification::Identification;
use crate::identification::beside::closest;
use crate::judgement::change::{asks_for_change, with_change};
use crate::judgement::comparison::{Comparison, explains};
use crate::judgement::filtering::behind_filter;
use crate::judgement::inquiry::{Inquiry, is_past};
use crate::judgement::rules::{
    ASKED_CHANGE, LEAST_PRESLIDING, MOST_ITERATIONS, MOST_ITERATIONS_WITH_STATE, SEEN_PRESLIDING, STEPS_OF_PRESLIDING,
};
use crate::judgement::score_test::{Extension, ScoreTest, score_tests};
use crate::judgement::trials::{CORNERS, SPRINGS, Trial, beside};
use crate::judgement::{Judgement, shortcomings};
use crate::machine::term::Term;
use crate::problem::starts::Fall;
use crate::threads::on_all_threads;
use crate::warning::Warning;

impl Inquiry<'_> {
    /// The comparison of as many laws as vibrations ask for.
    ///
    /// First viscous damping, Coulomb friction and both. If a score test of these is significant, or their residuals
    /// are correlated: laws whose friction changes with speed, and springs that harden, soften, meet a stop or have a
    /// gap if there is a sign of one; then, unless such a spring explains the records, further families, each begun
    /// where its friction over the speed follows that of the best law so far; and laws with presliding if there is a
    /// sign of it. The tests are in [`Comparison::score_tests`]. Laws that cannot be fitted to the end, and that are
    /// then far from others, are left out; a warning names them, and one each law that cannot be fitted at all.
    ///
    /// # Errors
    /// Those of [`identify`](crate::identify), for a parameter that no law has, and for forces along motions.
    pub fn search(&self) -> Result<Comparison, IdentifyError> {
        let Experiments::Vibrations(decays) = self.experiments else {
            return Err(IdentifyError::contradiction(
                "a search is for vibrations; compare candidates for a force along a motion",
            ));
        };
        self.on_pool(|| self.search_here(decays))
    }

    fn search_here(&self, decays: &[Experiment]) -> Result<Comparison, IdentifyError> {
        let run = Run { inquiry: self, decays, options: &self.options, end: self.end() };
        if !self.held.is_empty() {
            self.require_known(decays)?;
        }
        let mut found = run.fit(run.candidates(self.at(SearchStage::Simple))?, None)?;
        let drifting = closest(found.identifications.iter()).and_then(|found| found.with_drift(decays));
        let mut decays = decays;
        if let Some(drifting) = &drifting {
            let with_drift =
                Run { decays: drifting, ..run }.fit(run.candidates(self.at(SearchStage::Simple))?, None)?;
            if explains(&with_drift.identifications) {
                (decays, found) = (drifting, with_drift);
            }
        }
        let run = Run { decays, ..run };
        run.fit_changes(&mut found, Found::simple)?;
        let (mut tests, mut left_out) = run.score_tests(&found);
        let falls: Vec<Fall> = tests.iter().filter_map(ScoreTest::fall).collect();
        let changes = found.changes();
        if changes {
            // A fit with a change may take what a law that falls with the speed would explain.
            let unknown =
                |trial: &Trial| found.candidates.iter().all(|known| known.law_name() != trial.candidate.law_name());
            let falling = self.at(SearchStage::Stribeck).into_iter().filter(unknown);
            let falling = run.fit(run.candidates(falling)?, found.near(&falls, &[], 0).as_ref())?;
            found.add(falling);
        }
        if found.asks_for_more(&tests) || changes && !found.changes() {
            let falling = run.fit(run.candidates(self.of_speed())?, found.near(&falls, &[], 0).as_ref())?;
            found.add(falling);
            let is_bent = |test: &ScoreTest| test.extension == Extension::SofteningSpring && test.is_significant();
            // A filter in the sensor looks like a bent spring as well. A fit behind it that fails is reported by the
            // comparison.
            let is_filtered = || {
                let behind = behind_filter(decays, &found.identifications).ok().flatten();
                behind.is_some_and(|(found, _)| !found.structure.is_correlated())
            };
            if found.is_structured() && tests.iter().any(is_bent) && !is_filtered() {
                let bent = run.fit(run.candidates(beside(&SPRINGS))?, found.near(&falls, &[], 0).as_ref())?;
                found.add(bent);
                if found.is_structured() {
                    let with_corners = run.fit(run.candidates(beside(&CORNERS))?, None)?;
                    found.add(with_corners);
                }
            }
            let limited =
                |most: usize| self.options.clone().with_max_iterations(most.min(self.options.max_iterations()));
            let (of_speed, limited_more) = (limited(MOST_ITERATIONS), limited(MOST_ITERATIONS_WITH_STATE));
            let run = Run { options: &of_speed, ..run };
            // If a spring explains the records, no friction of the speed does.
            if found.is_structured() || !(found.is_bent() || found.changes()) {
                let further = found.unfinished().chain(run.candidates(self.at(SearchStage::FurtherOfSpeed))?).collect();
                let further = run.fit(further, found.near(&falls, &[|_| true], 1).as_ref())?;
                found.add(further);
            }
            // A converter hides presliding shorter than a few of its steps, and its steps look like presliding: neither
            // moves where the machine turns.
            let steps = decays.iter().map(|decay| {
                let summary = decay.summary();
                summary.resolution.filter(|_| summary.is_rounded()).unwrap_or(0.0) / summary.amplitudes.0
            });
            let least = steps.map(|step| STEPS_OF_PRESLIDING * step).fold(LEAST_PRESLIDING, f64::max);
            let is_seen = |test: &ScoreTest| {
                test.extension == Extension::Presliding && test.significance() > SEEN_PRESLIDING && test.size > least
            };
            if tests.iter().any(is_seen) {
                let run = Run { options: &limited_more, ..run };
                let with_state =
                    run.fit(run.candidates(self.at(SearchStage::Presliding))?, found.near(&falls, &[], 0).as_ref())?;
                found.add(with_state);
                let with_state = run.fit(
                    run.candidates(self.at(SearchStage::FurtherPresliding))?,
                    found.near(&falls, &[preslides], 2).as_ref(),
                )?;
                found.add(with_state);
            }
        }
        run.fit_changes(&mut found, Found::preferred)?;
        if self.machine.steadiness().is_some() {
            run.allow_changes(&mut found)?;
        }
        let dropped = found.drop_unfinished(&self.at(SearchStage::Simple));
        tests.retain(|test| test.uncertainty.is_finite());
        left_out.extend(found.failures());
        let mut comparison = Comparison::of(decays, &found.candidates, found.identifications)?;
        comparison.score_tests = tests;
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
    is_cut_short: bool,
}

impl Found {
    /// Adds further fits; of two fits by one law the better stays.
    fn add(&mut self, further: Self) {
        self.is_cut_short |= further.is_cut_short;
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

    /// Fits near which another one begins: that by Coulomb and viscous friction, and the closest to the records of each
    /// of `kinds`, with the number of `tries`.
    fn near<'a>(&'a self, falls: &'a [Fall], kinds: &[fn(&Identification) -> bool], tries: usize) -> Option<Near<'a>> {
        let simple = self.simple()?;
        let others =
            kinds.iter().filter_map(|is_kind| closest(self.identifications.iter().filter(|found| is_kind(found))));
        Some(Near { simple: &simple.fitted, falls, others: others.map(|other| &other.fitted).collect(), tries })
    }

    /// Warnings about the laws that could not be fitted in any try.
    fn failures(&mut self) -> impl Iterator<Item = Warning> + '_ {
        let failures = std::mem::take(&mut self.failures).into_iter();
        failures.filter(|(law, _)| self.candidates.iter().all(|known| known.name() != *law)).map(|(_, warning)| warning)
    }

    /// Laws whose fits have not ended in their lowest minimum.
    fn unfinished(&self) -> impl Iterator<Item = Candidate> {
        let all = self.candidates.iter().enumerate();
        all.filter(|(place, _)| !shortcomings(*place, &self.candidates, &self.identifications).is_empty())
            .map(|(_, candidate)| candidate.clone())
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

    /// The best law is one on a spring that is not linear.
    fn is_bent(&self) -> bool {
        self.preferred().is_some_and(|preferred| preferred.fitted.model.terms.has_spring())
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

    /// The fit by Coulomb and viscous friction, whatever is held of it; it is among the first.
    fn simple(&self) -> Option<&Identification> {
        self.identifications.iter().find(|found| found.family().name == CoulombViscous::NAME)
    }
}

/// The law has presliding.
fn preslides(found: &Identification) -> bool {
    found.finding("contact_stiffness_per_mass").is_some()
}

/// A part of a search: with drift or without, by some options.
#[derive(Clone, Copy)]
struct Run<'a, 'i> {
    inquiry: &'a Inquiry<'i>,
    decays: &'a [Experiment],
    options: &'a Options,
    end: Option<Instant>,
}

impl Run<'_, '_> {
    /// The candidates of these trials, with the parameters that are held.
    fn candidates(&self, trials: impl IntoIterator<Item = Trial>) -> Result<Vec<Candidate>, IdentifyError> {
        trials.into_iter().map(|trial| self.inquiry.tried(&trial, self.decays)).collect()
    }

    /// Fits the `candidates`. Those that do not begin near others are fitted after the time limit too.
    fn fit(&self, candidates: Vec<Candidate>, near: Option<&Near<'_>>) -> Result<Found, IdentifyError> {
        let must = near.is_none();
        let end = self.end.filter(|_| !must);
        let mut found = Found::default();
        let fit = |candidate: &Candidate| {
            if is_past(end) {
                return None;
            }
            let begin = near.map_or(Begin::Anywhere, Begin::Near);
            Some(self.inquiry.fit(candidate, self.decays.into(), begin, self.options, end))
        };
        let results = on_all_threads(candidates.iter().collect(), fit);
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

    /// Adds a fit with friction that changes during the records, if the residuals of one of `found` show a change.
    fn fit_changes(&self, found: &mut Found, base: fn(&Found) -> Option<&Identification>) -> Result<(), IdentifyError> {
        if is_past(self.end) {
            return Ok(());
        }
        let is_shown = |base: &&Identification| asks_for_change(base, self.decays, ASKED_CHANGE);
        // Where the damping of the machine is known, a change of the friction may be all that is left of it.
        let has_damping = self.inquiry.machine.damping().is_some();
        let is_dry = |known: &&Identification| has_damping && known.family().name == Coulomb::NAME;
        let dry = found.identifications.iter().find(is_dry);
        let Some(base) = base(found).filter(is_shown).or(dry.filter(is_shown)) else { return Ok(()) };
        // A law that falls with the speed may have taken a part of the change: the simple law is asked as well.
        let bases: Vec<Identification> = std::iter::once(base).chain(found.simple()).cloned().collect();
        for base in &bases {
            let changed =
                self.fit_change(found, base)?.filter(|changed| asks_for_change(changed, self.decays, ASKED_CHANGE));
            if let Some(changed) = changed {
                self.fit_change(found, &changed)?;
            }
        }
        Ok(())
    }

    /// Replaces the laws that are left by the same with friction that changes, where it is known how little it does.
    fn allow_changes(&self, found: &mut Found) -> Result<(), IdentifyError> {
        let Some(judgement) = Judgement::of(&found.candidates, &found.identifications) else { return Ok(()) };
        let left = (0..found.candidates.len()).filter(|place| judgement.is_left(*place));
        let bases: Vec<Identification> = left.map(|place| found.identifications[place].clone()).collect();
        let can_change = |base: &&Identification| with_change(&Candidate::fitted(base)).is_some();
        for base in bases.iter().filter(|base| !base.fitted.model.terms.has(Term::Change)).filter(can_change) {
            let place = found.identifications.iter().position(|known| known.law() == base.law());
            if let Some(place) = place {
                found.candidates.remove(place);
                found.identifications.remove(place);
            }
            self.fit_change(found, base)?;
        }
        Ok(())
    }

    /// Adds the fit by the law of `base` with the next term of a change, begun at the end of `base`, and gives it.
    fn fit_change(&self, found: &mut Found, base: &Identification) -> Result<Option<Identification>, IdentifyError> {
        let Some(candidate) = with_change(&Candidate::fitted(base)) else { return Ok(None) };
        let begin = Begin::Extended(&base.fitted);
        let changed = self.inquiry.fit(&candidate, self.decays.into(), begin, self.options, None)?;
        found.add(Found { candidates: vec![candidate], identifications: vec![changed.clone()], ..Found::default() });
        Ok(Some(changed))
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
