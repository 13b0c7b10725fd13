//! Several models of the same data side by side.

use std::collections::HashSet;

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::comparison::contender::{ComparisonOptions, Contender, Criterion, ResidualCount};
use crate::error::FitError;

/// One model of a comparison.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelRow {
    /// Name of the model.
    pub name: String,
    /// Number of parameters that the residuals determine.
    pub parameters: usize,
    /// Sum of squares of the residuals, in the square of their unit.
    pub sum_of_squares: f64,
    /// Root mean square of the residuals, in their unit.
    pub rms: f64,
    /// Akaike's corrected criterion (1); only differences mean anything.
    pub corrected_akaike: f64,
    /// Schwarz' Bayesian criterion (1); only differences mean anything.
    pub bayesian: f64,
    /// By how much the ranking criterion exceeds the least (1).
    pub difference: f64,
    /// Share of the models' total weight, exp(−difference/2) (1).
    pub weight: f64,
}

/// The F-test of a model against one that contains it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NestedComparison {
    /// Index of the special case.
    pub restricted: usize,
    /// Index of the model that contains it.
    pub full: usize,
    /// F, reduction of the sum of squares per parameter added, over the variance of the full fit (1).
    pub f: f64,
    /// Probability of an F at least as large if the special case is right (1).
    pub p_value: f64,
    /// Number of parameters added, and degrees of freedom of the full fit by the residuals that count.
    pub degrees_of_freedom: (usize, f64),
}

/// Models of the same data side by side, and whether the data decide between them.
///
/// ```text
/// AICc = m ln(S/n) + 2 k + 2 k (k + 1)/(m − k − 1),     BIC = m ln(S/n) + k ln m,     k = rank + 1
/// F    = ((S_r − S_f)/(rank_f − rank_r))/(S_f/(m − rank_f))
/// ```
///
/// n is the number of residuals and m the number of those that count, see [`ResidualCount`]: neighbouring residuals of
/// an oversampled record are correlated, so that m is less. An m too small for the correction is taken as k + 2.
///
/// Models within 4 of the best are too close to call; the one with the fewest parameters is preferred. A model
/// declared to contain another, whose further parameters ended without effect, is the other over again and no rival.
/// `Display` gives the table, the best model first.
///
/// ```
/// use fmm_fit::{ComparisonOptions, Contender, ModelTable, Polynomial, ResidualCount, Weighting};
///
/// let x: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
/// let noise = |i: usize| 0.02 * (1.7 * (i * i) as f64).sin();
/// let y: Vec<f64> = x.iter().enumerate().map(|(i, x)| 1.0 + x + 0.2 * x * x + noise(i)).collect();
/// let contender = |name: &str, order: usize| {
///     let fit = Polynomial::fit(&x, &y, order, Weighting::Equal)?;
///     Ok::<_, fmm_fit::FitError>(Contender::of_regression(name, fit.regression()))
/// };
/// let models = [contender("line", 1)?, contender("parabola", 2)?.containing("line")];
/// let table = ModelTable::of(&models, ComparisonOptions::default().counting(ResidualCount::All))?;
/// assert!(table.verdict().is_decided());
/// assert_eq!(table.rows()[table.verdict().preferred()].name, "parabola");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// K. P. Burnham, D. R. Anderson, Model Selection and Multimodel Inference, 2nd ed., Springer 2002, sections 2.4 to
/// 2.9; G. Schwarz, Ann. Stat. 6 (1978) 461, <https://doi.org/10.1214/aos/1176344136>.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelTable {
    pub(crate) rows: Vec<ModelRow>,
    pub(crate) tests: Vec<NestedComparison>,
    pub(crate) verdict: Verdict,
    pub(crate) residuals: usize,
    pub(crate) counted: f64,
    pub(crate) criterion: Criterion,
}

/// Result of a comparison; models are given by their index in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The data decide for one model.
    Decided {
        /// The model.
        winner: usize,
        /// By how much its score is below that of the next; `None` if there is no other.
        lead: Option<f64>,
    },
    /// The data do not decide.
    Undecided {
        /// The simplest of the models that the data leave.
        preferred: usize,
        /// Why they do not decide.
        doubts: Vec<Doubt>,
    },
}

impl Verdict {
    /// True if the data decide.
    pub const fn is_decided(&self) -> bool {
        matches!(self, Self::Decided { .. })
    }

    /// The winner, or the model that is preferred without having won.
    pub const fn preferred(&self) -> usize {
        match self {
            Self::Decided { winner, .. } => *winner,
            Self::Undecided { preferred, .. } => *preferred,
        }
    }
}

/// A reason why data do not decide between models.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Another model scores nearly as well, or better with more parameters.
    TooClose {
        /// The other model.
        rival: usize,
        /// Its score less that of the preferred one.
        difference: f64,
    },
    /// The fit of a model did not end at a minimum, so it may be better than it looks.
    Unfinished {
        /// The model.
        contender: usize,
    },
    /// A model fits worse than a special case of it, so its fit missed the lowest minimum.
    MissedMinimum {
        /// The model.
        contender: usize,
        /// The special case.
        special: usize,
    },
    /// The preferred model has a special case that the F-test does not reject.
    NotRejected {
        /// The special case.
        special: usize,
        /// Probability of the improvement by chance.
        p_value: f64,
    },
}

/// Two fits at the same minimum differ by rounding and by the tolerance of the search.
const SAME: f64 = 1e-9;

/// By how much the score of the winner must be below all others (1): Burnham and Anderson call the support for a model
/// substantial within 2 of the best, considerably less from 4 on, and none beyond 10.
const MARGIN: f64 = 4.0;

/// The probability above which an F-test does not reject the special case (1).
const SIGNIFICANCE: f64 = 0.05;

impl ModelTable {
    /// Compares models of the same data.
    ///
    /// # Errors
    /// [`FitError`] if there is no model, if their data differ, a name is used twice or not known, or a setting
    /// makes no sense.
    pub fn of(contenders: &[Contender], comparing: ComparisonOptions) -> Result<Self, FitError> {
        check(contenders, &comparing)?;
        let residuals = contenders[0].count;
        let best = contenders.iter().min_by(|a, b| a.sum_of_squares.total_cmp(&b.sum_of_squares));
        let counted = match comparing.count {
            ResidualCount::All => residuals as f64,
            ResidualCount::OfBest => residuals as f64 / best.map_or(1.0, |best| best.autocorrelation_time),
            ResidualCount::Given(count) => count.min(residuals as f64),
        };
        let mut rows: Vec<ModelRow> = contenders.iter().map(|contender| row(contender, counted)).collect();
        let scores: Vec<f64> = rows
            .iter()
            .map(|row| match comparing.criterion {
                Criterion::CorrectedAkaike => row.corrected_akaike,
                Criterion::Bayesian => row.bayesian,
            })
            .collect();
        let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
        let total: f64 = scores.iter().map(|score| (0.5 * (least - score)).exp()).sum();
        for (row, score) in rows.iter_mut().zip(&scores) {
            row.difference = score - least;
            row.weight = (0.5 * (least - score)).exp() / total;
        }
        let tests = tests(contenders, counted);
        let verdict = verdict(contenders, &scores, &tests);
        Ok(Self { rows, tests, verdict, residuals, counted, criterion: comparing.criterion })
    }

    /// One row per model, in the order given.
    pub fn rows(&self) -> &[ModelRow] {
        &self.rows
    }

    /// F-tests of every model against those that contain it and determine more.
    pub fn tests(&self) -> &[NestedComparison] {
        &self.tests
    }

    /// The verdict: decided for a model or not.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// m, the number of residuals that count.
    pub fn counted(&self) -> f64 {
        self.counted
    }
}

fn check(contenders: &[Contender], comparing: &ComparisonOptions) -> Result<(), FitError> {
    let first = contenders.first().ok_or_else(|| FitError::count("there is no model to compare"))?;
    let names: HashSet<&str> = contenders.iter().map(|contender| contender.name.as_str()).collect();
    let mut seen = HashSet::new();
    for contender in contenders {
        let name = contender.name.clone();
        let (residuals, parameters) = (contender.count, contender.rank);
        if !seen.insert(contender.name.as_str()) {
            return Err(FitError::problem(format!("two models are called {name}")));
        }
        if let Some(special) = contender.contains.iter().find(|special| !names.contains(special.as_str())) {
            return Err(FitError::unknown_name(format!(
                "{name} is said to contain {special}, which does not take part"
            )));
        }
        if residuals != first.count {
            let expected = first.count;
            return Err(FitError::count(format!(
                "{name} has {residuals} residuals instead of {expected}; models must be of the same data"
            )));
        }
        if residuals < parameters.saturating_add(3) {
            return Err(FitError::undetermined(format!(
                "{name} has {parameters} parameters for {residuals} residuals; at least two more residuals are needed"
            )));
        }
        if !contender.sum_of_squares.is_finite() {
            let what = format!("the residuals of {name} are not finite");
            return Err(FitError::out_of_range(what, contender.sum_of_squares));
        }
    }
    match comparing.count {
        ResidualCount::Given(count) if !(count > 0.0) => {
            Err(FitError::option("the number of residuals that count", "positive", count))
        }
        _ => Ok(()),
    }
}

fn row(contender: &Contender, counted: f64) -> ModelRow {
    let (n, k) = (contender.count as f64, contender.rank as f64 + 1.0);
    let m = counted.max(k + 2.0);
    // Exact data leave nothing; the logarithm of next to nothing ranks them first.
    let deviance = m * (contender.sum_of_squares.max(f64::MIN_POSITIVE) / n).ln();
    ModelRow {
        name: contender.name.clone(),
        parameters: contender.rank,
        sum_of_squares: contender.sum_of_squares,
        rms: (contender.sum_of_squares / n).sqrt(),
        corrected_akaike: deviance + 2.0 * k + 2.0 * k * (k + 1.0) / (m - k - 1.0),
        bayesian: deviance + k * m.ln(),
        difference: 0.0,
        weight: 0.0,
    }
}

/// Pairs of a special case and a model that contains it.
fn nested(contenders: &[Contender]) -> impl Iterator<Item = (usize, usize)> {
    let pairs = (0..contenders.len()).flat_map(move |special| (0..contenders.len()).map(move |full| (special, full)));
    pairs.filter(|&(special, full)| contenders[full].contains.contains(&contenders[special].name))
}

fn tests(contenders: &[Contender], counted: f64) -> Vec<NestedComparison> {
    let test = |(restricted, full): (usize, usize)| {
        let (small, large) = (&contenders[restricted], &contenders[full]);
        let added = large.rank.checked_sub(small.rank).filter(|added| *added > 0)?;
        let freedom = counted - large.rank as f64;
        let is_possible =
            freedom > 0.0 && large.sum_of_squares > 0.0 && large.sum_of_squares <= small.sum_of_squares * (1.0 + SAME);
        if !is_possible {
            return None;
        }
        let reduction = (small.sum_of_squares - large.sum_of_squares).max(0.0);
        let f = (reduction / added as f64) / (large.sum_of_squares / freedom);
        let p_value = FisherSnedecor::new(added as f64, freedom).ok()?.sf(f);
        Some(NestedComparison { restricted, full, f, p_value, degrees_of_freedom: (added, freedom) })
    };
    nested(contenders).filter_map(test).collect()
}

fn verdict(contenders: &[Contender], scores: &[f64], tests: &[NestedComparison]) -> Verdict {
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    let close = (0..scores.len()).filter(|&i| scores[i] - least <= MARGIN);
    let simpler =
        |a: &usize, b: &usize| contenders[*a].rank.cmp(&contenders[*b].rank).then(scores[*a].total_cmp(&scores[*b]));
    let preferred = close.min_by(simpler).unwrap_or(0);
    let is_same = |i: usize| {
        contenders[i].rank == contenders[preferred].rank
            && nested(contenders).any(|pair| pair == (i, preferred) || pair == (preferred, i))
    };
    let rivals: Vec<usize> = (0..scores.len()).filter(|&i| i != preferred && !is_same(i)).collect();
    let mut doubts = Vec::new();
    for &rival in &rivals {
        let difference = scores[rival] - scores[preferred];
        if difference <= MARGIN {
            doubts.push(Doubt::TooClose { rival, difference });
        }
    }
    doubts.extend(
        (0..contenders.len()).filter(|&i| !contenders[i].is_finished).map(|i| Doubt::Unfinished { contender: i }),
    );
    for (special, contender) in nested(contenders) {
        let (lower, higher) = (contenders[special].sum_of_squares, contenders[contender].sum_of_squares);
        if lower < higher * (1.0 - SAME) {
            doubts.push(Doubt::MissedMinimum { contender, special });
        }
    }
    for test in tests.iter().filter(|test| test.full == preferred && test.p_value > SIGNIFICANCE) {
        doubts.push(Doubt::NotRejected { special: test.restricted, p_value: test.p_value });
    }
    if doubts.is_empty() {
        let lead = rivals.iter().map(|&i| scores[i] - scores[preferred]).min_by(f64::total_cmp);
        Verdict::Decided { winner: preferred, lead }
    } else {
        Verdict::Undecided { preferred, doubts }
    }
}
