//! Friction over the speed that motions show, with a band and without a law.

pub(crate) mod expected;
mod fit;
mod level;
mod levels;
mod likelihood;
mod mixture;
pub(crate) mod path;
pub(crate) mod projection;
mod report;
mod rules;
mod sources;

use std::time::{Duration, Instant};

use fmm_model::{Rounded, Unit};

pub use level::FrictionLevel;

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::experiment::clock::Clock;
use crate::finding::Source;
use crate::friction_curve::fit::CurveFit;
use crate::friction_curve::levels::{KNOTS, LEVELS, weights};
use crate::friction_curve::mixture::{Posterior, moments};
use crate::friction_curve::projection::friction;
use crate::friction_curve::rules::{APART, DRAWS};
use crate::friction_curve::sources::Sources;
use crate::identification::Identification;
use crate::law::naming::{Form, Units};
use crate::machine::{Known, Machine, Scale, Terms};
use crate::quantities::table::{Table, mass_of_stiffness};

/// Friction over the speed as motions show it, without a law: the whole resistance to the motion, of the contact and of
/// the machine. Damping of the machine that is declared is not part of it.
///
/// ```text
/// m x″ + k x + R(|x′|) sgn x′ = f,     R(v) = N μ(v) + c v + …
/// ```
///
/// Ring-downs, run-downs, impacts and driven motions show it, one or several under one load. A contact that holds more
/// than it slides with has a static level, which is fitted beside the curve where a drive goes on. Of a free motion the part
/// before its rest is taken, which no static level changes.
///
/// The curve is fifteen levels at fixed speeds with cubics between them, fitted through every reversal and stop. Before
/// the record it is a constant, a straight line, perhaps one of the falling shapes of the laws of the catalogue, and a
/// smooth remainder, of unknown sizes; the record weighs them. Intervals average over what is left.
///
/// What is not a function of the speed alone (a spring that is not linear, friction that changes during the record or
/// with the position) is taken for friction over the speed as far as it looks like it; [`limits`](Self::limits) says if
/// the residuals show it.
///
/// `Display` gives a table. With the feature `serde` it serialises.
///
/// ```
/// use fmm_friction::CoulombViscous;
/// use fmm_identify::{Experiment, FrictionCurve, Known, Machine, Preparation};
/// # use fmm_model::Oscillator;
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// // A velocity record; here a simulated one: 10 kg, 2 Hz, 0.02 of a load of 140 N, 500 Hz, noise of 0.3 mm/s.
/// # let scenario = Scenario::new(Oscillator::new(10.0, 1579.0)?, CoulombViscous::new(0.02, 0.01)?, 140.0)?;
/// # let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(2e-3, 1000)?)?;
/// # let noise = |i: usize| 1e-3 * (((i * i * 7919) % 10_007) as f64 / 10_007.0 - 0.5);
/// # let velocity = motion.velocity().values().iter().enumerate().map(|(i, v)| v + noise(i)).collect();
/// let record = Record::new(0.0, 2e-3, velocity, Quantity::Velocity, "m/s")?;
///
/// let machine = Machine::of_mass(Known::exact(10.0)?)?.with_normal_load(Known::new(140.0, 0.1)?)?;
/// let curve = FrictionCurve::of(&machine, &[Experiment::ring_down(&record, &Preparation::default())?])?;
/// assert_eq!(curve.unit(), "1");
/// let mean = curve.mean_over_path();
/// let (low, high) = mean.interval(0.95).unwrap();
/// assert!(low < mean.value() && mean.value() < high && mean.uncertainty() < 0.01 * mean.value());
/// println!("{curve}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FrictionCurve {
    /// Speeds of the levels, in `speed_unit`.
    speeds: [f64; LEVELS],
    speed_unit: String,
    posterior: Posterior,
    /// Unit of the curve over that of the fit, and over that of the posterior.
    unit_factor: f64,
    factor: f64,
    /// Relative standard uncertainty of the factor by each source (1).
    of_factor: Vec<(Source, f64)>,
    sources: Sources,
    freedom: f64,
    path: [f64; LEVELS],
    slowest: f64,
    /// Form of the forces of the fit.
    form: Form,
    meaning: Meaning,
    unit: String,
    is_whole: bool,
    limits: Vec<String>,
    /// The law beside which it was found, where that lies far from it.
    contradiction: Option<String>,
}

/// Kind of number in which friction is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Coefficient,
    Force,
    PerMass,
}

impl FrictionCurve {
    /// The curve that `experiments` on `machine` share, all under the same load.
    ///
    /// Values are coefficients if mass, stiffness or a measured force and the load are known, forces if the load is not,
    /// and forces per mass otherwise; the uncertainties of all of them are part of those of the curve.
    ///
    /// # Errors
    /// [`IdentifyError::Missing`] without an experiment, [`IdentifyError::WrongRecord`] for the mobility of an impact,
    /// [`IdentifyError::Contradiction`] for different loads, [`IdentifyError::NotSeen`] where the fit does
    /// not end, and those of a fit that cannot begin.
    pub fn of(machine: &Machine, experiments: &[Experiment]) -> Result<Self, IdentifyError> {
        Self::with_terms(machine, Terms::NONE, experiments, None)
    }

    /// The curve of the machine and the records of `found`, with the terms of its spring, its change of the friction
    /// during the record and the drifts of its records beside it. Friction that changes has the curve of its mean over
    /// the path.
    ///
    /// # Errors
    /// As for [`of`](Self::of), and [`IdentifyError::Contradiction`] for other `experiments` than those of `found`.
    pub fn beside(found: &Identification, experiments: &[Experiment]) -> Result<Self, IdentifyError> {
        Self::beside_until(found, experiments, None)
    }

    /// The same, given up where it takes longer than `limit`.
    ///
    /// # Errors
    /// As for [`beside`](Self::beside), and [`IdentifyError::Fit`] or [`IdentifyError::NotSeen`] at the limit.
    pub fn beside_within(
        found: &Identification,
        experiments: &[Experiment],
        limit: Duration,
    ) -> Result<Self, IdentifyError> {
        Self::beside_until(found, experiments, Instant::now().checked_add(limit))
    }

    fn beside_until(
        found: &Identification,
        experiments: &[Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let terms = found.fitted.model.terms.beside_friction();
        let mut curve = Self::with_terms(found.machine(), terms, &found.experiments(experiments)?, end)?;
        curve.contradiction = curve.apart_from(found, experiments);
        Ok(curve)
    }

    /// The end of the speeds of the record at which the law of `found`, which explains the records, lies farther from the
    /// curve, in a sentence, if that is far.
    fn apart_from(&self, found: &Identification, experiments: &[Experiment]) -> Option<String> {
        if found.structure.is_structured() {
            return None;
        }
        let by_law = self.by_law(found, experiments)?;
        let lowest = by_law.iter().find(|(speed, _)| *speed >= self.slowest)?;
        let ends = [lowest, by_law.last()?].into_iter().filter_map(|(speed, by_law)| {
            let level = self.at(*speed)?;
            Some(((level.value() - by_law).abs() / level.uncertainty(), speed, by_law))
        });
        let (apart, speed, by_law) = ends.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(apart, ..)| *apart > APART)?;
        let [speed, by_law] = [*speed, *by_law].map(|value| Rounded::significant(value, 3));
        Some(format!(
            "at {speed} {}, {} has {by_law} {}, {apart:.1} standard uncertainties from the curve: one of the two is wrong there",
            self.speed_unit,
            found.law(),
            self.unit,
        ))
    }

    fn with_terms(
        machine: &Machine,
        terms: Terms,
        experiments: &[Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let reference = experiments.first().ok_or(IdentifyError::no_record())?;
        require_in_time(experiments)?;
        // A measured force tells the scale, and how well it tells it goes with the friction.
        let is_forced = experiments.iter().any(Experiment::is_forced);
        let form = if is_forced { Form::Force } else { Table::form(machine) };
        if experiments.iter().any(|experiment| experiment.load_factor() != reference.load_factor()) {
            let what = "friction over speed without a law takes motions under one load: the whole resistance does \
                        not follow the load";
            return Err(IdentifyError::contradiction(what));
        }
        if machine.scale() == Scale::Unknown && !is_forced {
            let what = "ring-downs do not show the mass: give a mass or a stiffness, or take everything per unit mass";
            return Err(IdentifyError::contradiction(what));
        }
        let terms = if machine.steadiness().is_some() { terms.with_change() } else { terms };
        // The levels near rest decide about the rest by leaps, and nothing is lost before it.
        let moving = |one: &Experiment| one.before_rest().unwrap_or_else(|| one.clone());
        let moving: Vec<Experiment> = experiments.iter().map(moving).collect();
        let fit = CurveFit::of(form, machine, &terms, &moving, end)?;
        let units = Units::of(reference.record());
        let gain = experiments.iter().map(|one| one.summary().gain_uncertainty).fold(0.0, f64::max);
        let clock = Clock::of(experiments);
        // A mass that follows from a stiffness goes with the square of a period.
        let by_clock = match machine.scale() {
            Scale::Stiffness(_) => clock.order,
            _ => clock.order - 2.0,
        } * clock.uncertainty;
        // Friction beside a measured force is as wrong as that is, whatever the response reads.
        let further = [(Source::Gain, gain), (Source::Clock, by_clock)];
        Ok(Self::of_fit(fit, form, machine, &units, if is_forced { &[] } else { &further }))
    }

    /// The curve of a `fit` with forces in this `form`, in the units in which it is stated, with further relative
    /// standard uncertainties of all levels (1).
    fn of_fit(fit: CurveFit, form: Form, machine: &Machine, units: &Units, further: &[(Source, f64)]) -> Self {
        let (meaning, factor, mut of_factor) = scale(machine, form, units, fit.frequency);
        of_factor.extend(further);
        let unit = match meaning {
            Meaning::Coefficient => Unit::default().to_string(),
            Meaning::Force => units.with_forces().map_or_else(|| "N".to_owned(), |units| units.force.to_string()),
            Meaning::PerMass => units.acceleration().to_string(),
        };
        let mut limits = Vec::new();
        if let Some(ratio) = fit.excess {
            limits.push(format!(
                "residuals are {ratio:.1} times the noise and alike from sample to sample: something beside \
                 friction over speed acts, such as a spring that is not linear or friction that changes in time"
            ));
        }
        limits.extend(fit.limit_near_rest.map(str::to_owned));
        Self {
            speeds: KNOTS.map(|s| s * fit.top),
            speed_unit: units.velocity().to_string(),
            unit_factor: factor,
            factor: factor * fit.scale,
            of_factor,
            sources: fit.sources,
            posterior: fit.posterior,
            freedom: fit.freedom,
            path: fit.path,
            slowest: fit.slowest,
            form,
            meaning,
            unit,
            is_whole: machine.damping().is_none(),
            limits,
            contradiction: None,
        }
    }

    /// Speeds of the levels, from rest to the top speed, in the [unit of speeds](Self::speed_unit).
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// Unit of the speeds.
    pub fn speed_unit(&self) -> &str {
        &self.speed_unit
    }

    /// Friction at the [speeds](Self::speeds), in the [unit](Self::unit).
    pub fn levels(&self) -> Vec<FrictionLevel> {
        (0..LEVELS).map(|i| self.level(&unit_weights(i))).collect()
    }

    /// Unit of the friction: `"1"` for a coefficient, N for a force, else that of a force per mass.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Friction at `speed`; `None` above the top speed, where nothing was recorded.
    pub fn at(&self, speed: f64) -> Option<FrictionLevel> {
        let top = self.speeds[LEVELS - 1];
        (0.0..=top).contains(&speed).then(|| self.level(&weights(speed / top)))
    }

    /// Value at `speed` of a curve that was kept as `values` at its [speeds](Self::speeds), by the same cubics; `None`
    /// above the top speed, or for another number of values than of levels.
    ///
    /// Speeds and values have the units of the curve; it is for who keeps curves in files.
    ///
    /// ```
    /// use fmm_identify::FrictionCurve;
    ///
    /// // Fifteen levels of a constant friction.
    /// let speeds: Vec<f64> = (0..15).map(|i| f64::from(i) / 14.0).collect();
    /// assert_eq!(FrictionCurve::through(&speeds, &[0.2; 15], 1.1), None);
    /// assert!((FrictionCurve::through(&speeds, &[0.2; 15], 0.3).unwrap() - 0.2).abs() < 1e-12);
    /// ```
    pub fn through(speeds: &[f64], values: &[f64], speed: f64) -> Option<f64> {
        let top = *speeds.last().filter(|_| values.len() == LEVELS)?;
        let weighted = || weights(speed / top).iter().zip(values).map(|(weight, value)| weight * value).sum();
        (0.0..=top).contains(&speed).then(weighted)
    }

    /// Friction at rest, as the lowest speeds tell it.
    pub fn at_rest(&self) -> FrictionLevel {
        self.level(&unit_weights(0))
    }

    /// Mean friction over the path: the energy that is missing, over the path and, for a coefficient, the load.
    pub fn mean_over_path(&self) -> FrictionLevel {
        self.level(&self.path)
    }

    /// Friction at the top speed.
    pub fn at_top_speed(&self) -> FrictionLevel {
        self.level(&unit_weights(LEVELS - 1))
    }

    /// Intervals at all [speeds](Self::speeds) at once: they hold the whole curve with probability `level`. `None` for
    /// a level outside (0, 1).
    ///
    /// Each is the value ± c u, with one c for all speeds, the quantile of the largest deviation in draws from the
    /// curve's distribution (the same draws each time).
    pub fn band(&self, level: f64) -> Option<Vec<(f64, f64)>> {
        if !(level > 0.0 && level < 1.0) {
            return None;
        }
        let levels = self.levels();
        let by_factor = self.square_of_factor();
        let (mean, mut spread) = (self.posterior.mean(), self.posterior.deviations());
        let floor = |value: f64| value.max(0.0);
        for deviation in &mut spread {
            *deviation = deviation.max(f64::MIN_POSITIVE);
        }
        let mut largest: Vec<f64> = self
            .posterior
            .draws(DRAWS)
            .iter()
            .map(|draw| {
                let deviation = |i: usize| (floor(draw[i]) - floor(mean[i])).abs() / spread[i];
                (0..LEVELS).map(deviation).fold(0.0, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        let reach = *largest.get((level * largest.len() as f64) as usize).or(largest.last())?;
        // As much wider as Student's t is.
        let student =
            fmm_model::coverage_factor(level, self.freedom)? / fmm_model::coverage_factor(level, f64::INFINITY)?;
        let interval = |(i, one): (usize, &FrictionLevel)| {
            let deviation = (spread[i].powi(2) + by_factor * mean[i].powi(2)).sqrt() * self.factor;
            let center = floor(mean[i]) * self.factor;
            let (low, high) = one.interval(level).unwrap_or((center, center));
            (floor(center - reach * student * deviation).min(low), (center + reach * student * deviation).max(high))
        };
        Some(levels.iter().enumerate().map(interval).collect())
    }

    /// Speed down to which the record has samples: half of the half cycles have one at or below it. The curve below
    /// follows from the times of the reversals and from its smoothness.
    pub fn slowest(&self) -> f64 {
        self.slowest
    }

    /// True if the curve is the whole resistance; false if damping of the machine is declared and not part of it.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Reasons not to take the curve for friction over the speed, one sentence each; empty if nothing speaks against
    /// it.
    pub fn limits(&self) -> &[String] {
        &self.limits
    }

    /// The [`limits`](Self::limits), and the law [beside](Self::beside) which the curve was found where that explains the
    /// records and lies far from the curve: one of the two is wrong there, and which, the records do not tell.
    pub fn doubts(&self) -> impl Iterator<Item = &str> {
        self.limits.iter().chain(&self.contradiction).map(String::as_str)
    }

    /// Speeds and friction by the law of `found`, an identification of the same `experiments`, with the damping beside
    /// it: what of the curve the law explains. `None` for a law that states no friction over the speed.
    pub fn by_law(&self, found: &Identification, experiments: &[Experiment]) -> Option<Vec<(f64, f64)>> {
        /// Speeds, closer near rest.
        const POINTS: u32 = 100;
        let (model, values) = (&found.fitted.model, found.fit().values());
        let (table, _) = Table::of(model, found.machine(), experiments).ok()?;
        // The law may be fitted per mass where the curve is one of forces.
        let mass = (self.form == Form::Force && table.is_per_mass()).then(|| table.mass(found.machine(), values));
        let factor = self.unit_factor * mass.flatten().unwrap_or(1.0);
        let at = |step: u32| {
            let speed = self.speeds[LEVELS - 1] * (f64::from(step) / f64::from(POINTS)).powi(2);
            Some((speed, factor * friction(&table, values, speed, false)?))
        };
        (1..=POINTS).map(at).collect()
    }

    fn level(&self, weights: &[f64; LEVELS]) -> FrictionLevel {
        let own = self.posterior.marginal(weights);
        let (mean, deviation) = moments(&own);
        let parts = factored(own, self.factor, self.square_of_factor());
        let of_factor = self.of_factor.iter().map(|(source, relative)| (*source, (relative * mean).powi(2)));
        let variances = self.sources.parts(weights, deviation * deviation).into_iter().chain(of_factor);
        let contributions = variances.map(|(source, variance)| (source, self.factor * variance.sqrt()));
        FrictionLevel::new(&parts, self.freedom, self.unit.clone()).with_sources(contributions)
    }

    /// Square of the relative standard uncertainty of the factor (1).
    fn square_of_factor(&self) -> f64 {
        self.of_factor.iter().map(|(_, relative)| relative * relative).sum()
    }
}

/// Parts of a mixture times a `factor` of which the relative standard uncertainty has this `square` (1).
fn factored(parts: Vec<(f64, f64, f64)>, factor: f64, square: f64) -> Vec<(f64, f64, f64)> {
    let part = |(weight, mean, variance): (f64, f64, f64)| {
        let mean = mean * factor;
        (weight, mean, variance * factor * factor + square * mean * mean)
    };
    parts.into_iter().map(part).collect()
}

/// Refuses experiments that are not motions in time.
fn require_in_time(experiments: &[Experiment]) -> Result<(), IdentifyError> {
    if experiments.iter().any(|experiment| experiment.lines().is_some()) {
        let what = "friction over speed without a law is found from motions in time, not from their mobility";
        return Err(IdentifyError::wrong_record(what.to_owned()));
    }
    Ok(())
}

/// Weights of the level at place `i` alone.
fn unit_weights(i: usize) -> [f64; LEVELS] {
    std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 })
}

/// Meaning of the curve, its unit over that of the problem, and the relative standard uncertainties of that factor.
fn scale(machine: &Machine, form: Form, units: &Units, frequency: f64) -> (Meaning, f64, Vec<(Source, f64)>) {
    let relative = |source: Source, known: Known| (source, known.uncertainty() / known.value());
    let mass = match machine.scale() {
        // The problem has forces, with mass and stiffness among its own quantities.
        _ if form == Form::Force => Some((1.0, Vec::new())),
        Scale::Mass(mass) => Some((mass.value(), vec![relative(Source::Mass, mass)])),
        Scale::Stiffness(stiffness) => {
            let mass = mass_of_stiffness(stiffness.value(), frequency);
            Some((mass, vec![relative(Source::Stiffness, stiffness)]))
        }
        _ => None,
    };
    let Some((force, mut of_factor)) = mass.filter(|_| units.with_forces().is_some()) else {
        return (Meaning::PerMass, 1.0, Vec::new());
    };
    match machine.normal_load().filter(|_| units.is_metric()) {
        Some(load) => {
            of_factor.push(relative(Source::NormalLoad, load));
            (Meaning::Coefficient, force / load.value(), of_factor)
        }
        None => (Meaning::Force, force, of_factor),
    }
}
