//! Question to a record: the machine, the laws, the sensor.

use std::error::Error;
use std::ops::ControlFlow;
use std::str::FromStr;
use std::time::{Duration, Instant};

use clap::Args;
use fmm_fit::Minimizer;
use fmm_identify::{
    Candidate, Comparison, Experiment, FrictionCurve, Identification, Inquiry, Known, Machine, Preparation, Sensor,
    Source,
};
use fmm_model::Restoring;
use fmm_record::{Quantity, Record};

use crate::host::Host;
use crate::refusal::{Kind, OfKind};

/// The machine, the laws and the sensor.
#[derive(Debug, Clone, Args)]
pub(crate) struct Question {
    /// Relative standard uncertainty of that factor, or of the gain of the instrument
    #[arg(long, value_name = "RELATIVE", default_value_t = 0.0)]
    pub(crate) scale_u: f64,
    /// The laws to compare, such as coulomb,berger+quadratic: names with terms of the machine beside them (linear,
    /// quadratic, cubic, power, any sign; cubic spring, quintic spring, stop, gap), or all (viscous, coulomb and both);
    /// without it, as many as the record asks for. An unknown name is answered with the list of laws
    #[arg(long, value_name = "NAME,..|all", value_delimiter = ',')]
    pub(crate) law: Vec<String>,
    /// Begin no further law after this time
    #[arg(long, value_name = "S", conflicts_with = "law")]
    time_limit: Option<f64>,
    /// Hold a fitted parameter of the laws at a value, as in exponent=2; of one law alone as in stribeck.exponent=2
    #[arg(long, value_name = "[LAW.]NAME=VALUE")]
    hold: Vec<String>,
    /// The machine is a pendulum; for a record that is no angle in radians, with the length of the arc that makes one
    /// radian
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, default_missing_value = "")]
    pendulum: Option<Radian>,
    /// The machine has no spring: the record is a run-down, such as the coast-down of a vehicle or the spin-down of a
    /// rotor, by its velocity or position
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", default_value_t = false,
        hide_default_value = true, value_name = "YES", conflicts_with_all = ["pendulum", "stiffness"])]
    run_down: bool,
    /// The moving mass; about an axis, with angles in rad, the moment of inertia (kg m²)
    #[arg(long, value_name = "KG")]
    mass: Option<f64>,
    /// Standard uncertainty of the mass
    #[arg(long, value_name = "KG", requires = "mass", default_value_t = 0.0)]
    mass_u: f64,
    /// The stiffness
    #[arg(long, value_name = "N/M")]
    stiffness: Option<f64>,
    /// Standard uncertainty of the stiffness
    #[arg(long, value_name = "N/M", requires = "stiffness", default_value_t = 0.0)]
    stiffness_u: f64,
    /// The machine's own linear damping (N s/m; 1/s if neither mass nor stiffness is given)
    #[arg(long, value_name = "N S/M")]
    damping: Option<f64>,
    /// Standard uncertainty of the damping
    #[arg(long, value_name = "N S/M", requires = "damping", default_value_t = 0.0)]
    damping_u: f64,
    /// Standard uncertainty of the change of the friction with each half cycle, relative to itself: how steady it is
    /// known to be. Without it, a change is looked for, and what would not show is stated
    #[arg(long, value_name = "RELATIVE")]
    steady: Option<f64>,
    /// The normal load on the contact
    #[arg(long, value_name = "N")]
    pub(crate) normal_load: Option<f64>,
    /// Standard uncertainty of the normal load
    #[arg(long, value_name = "N", requires = "normal_load", default_value_t = 0.0)]
    normal_load_u: f64,
    /// The sensor filters by a Butterworth low-pass filter of this order, with its corner frequency or, without it, one
    /// that is fitted
    #[arg(long, value_name = "ORDER[:HZ]", value_parser = low_pass)]
    low_pass: Option<(usize, Option<f64>)>,
    /// The sensor is late by this time
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    delay: f64,
}

/// Order and corner frequency (Hz) of a filter.
fn low_pass(text: &str) -> Result<(usize, Option<f64>), String> {
    let (order, corner) = text.split_once(':').map_or((text, None), |(order, corner)| (order, Some(corner)));
    let order =
        order.trim().parse().map_err(|_| format!("{order:?} is no order; give ORDER or ORDER:HZ, such as 2:44"))?;
    let corner = corner.map(|corner| corner.trim().parse().map_err(|_| format!("{corner:?} is no frequency in Hz")));
    Ok((order, corner.transpose()?))
}

impl Question {
    /// The free motion of the machine in a record, as its sensor sees it: a ring-down, or a run-down without a spring.
    pub(crate) fn free(&self, record: &Record, preparation: &Preparation) -> Result<Experiment, Box<dyn Error>> {
        let experiment = if self.run_down { Experiment::run_down } else { Experiment::ring_down };
        self.seen(experiment(record, preparation)?)
    }

    /// The same question under each of these normal loads (N) in place of its own, or as it is for none.
    pub(crate) fn under(&self, loads: &[f64], records: usize) -> Result<Vec<Self>, OfKind> {
        if loads.is_empty() {
            return Ok(vec![self.clone(); records]);
        }
        if loads.len() != records {
            let given = loads.len();
            return Err(Kind::Contradiction.refusal(format!(
                "--normal-loads has {given} load(s) for {records} record(s); give one for each record"
            )));
        }
        Ok(loads.iter().map(|load| Self { normal_load: Some(*load), ..self.clone() }).collect())
    }

    /// The experiment as its sensor sees it.
    pub(crate) fn seen(&self, experiment: Experiment) -> Result<Experiment, Box<dyn Error>> {
        let sensor = Sensor::default().with_delay(self.delay)?;
        let sensor = match self.low_pass {
            Some((order, Some(corner))) => sensor.with_low_pass(order, corner)?,
            Some((order, None)) => sensor.with_free_low_pass(order)?,
            None => sensor,
        };
        Ok(experiment.seen_by(sensor)?)
    }

    /// Length of the arc that makes one radian of a pendulum (unit of the position of `decays`), if the machine is one: 1
    /// for angles in radians.
    fn pendulum(&self, decays: &[Experiment]) -> Result<Option<f64>, OfKind> {
        let Some(radian) = self.pendulum else { return Ok(None) };
        let no_angle = decays.iter().map(|decay| decay.record().unit()).find(|unit| !unit.starts_with("rad"));
        match (radian.length, no_angle) {
            (None, Some(unit)) => Err(Kind::Contradiction.refusal(format!(
                "--pendulum: the record is in {unit} and not in radians; give the length of the arc that makes one \
                 radian, such as --pendulum 0.3 for 0.3 m"
            ))),
            _ => Ok(Some(radian.arc())),
        }
    }

    /// The machine behind `decays`; of one whose driving force is measured, mass and stiffness may be unknown.
    fn machine(&self, decays: &[Experiment]) -> Result<Machine, Box<dyn Error>> {
        let is_force =
            |decay: &Experiment| decay.drive().is_some_and(|drive| drive.record().quantity() == Quantity::Force);
        let force_is_measured = decays.iter().any(is_force);
        let mut machine = match (self.mass, self.stiffness) {
            (Some(_), Some(_)) if !force_is_measured => {
                let what = "give --mass or --stiffness: a vibration shows the other one";
                return Err(Kind::Contradiction.refusal(what).into());
            }
            (Some(mass), Some(stiffness)) => Machine::of_mass_and_stiffness(
                known("--mass", mass, self.mass_u)?,
                known("--stiffness", stiffness, self.stiffness_u)?,
            )?,
            (Some(mass), None) => Machine::of_mass(known("--mass", mass, self.mass_u)?)?,
            (None, Some(stiffness)) => Machine::of_stiffness(known("--stiffness", stiffness, self.stiffness_u)?)?,
            (None, None) if force_is_measured => Machine::unknown(),
            (None, None) => Machine::per_unit_mass(),
        };
        if let Some(damping) = self.damping {
            machine = machine.with_damping(known("--damping", damping, self.damping_u)?)?;
        }
        if let Some(load) = self.normal_load {
            machine = machine.with_normal_load(known("--normal-load", load, self.normal_load_u)?)?;
        }
        if let Some(steady) = self.steady {
            machine = machine.with_steady_friction(steady)?;
        }
        if let Some(length) = self.pendulum(decays)? {
            machine = machine.with_restoring(Restoring::sine(length)?);
        }
        Ok(machine)
    }

    /// The laws that are named, those of the host among them.
    pub(crate) fn candidates(&self, host: &Host<'_>) -> Result<Vec<Candidate>, Box<dyn Error>> {
        let mut candidates = Vec::new();
        for law in &self.law {
            if law == "all" {
                candidates.extend(Candidate::standard());
            } else {
                candidates.push(host.candidate(law)?);
            }
        }
        for Held { law, name, value } in self.held()? {
            let mut is_meant = false;
            for candidate in &mut candidates {
                if law.as_ref().is_none_or(|law| law == candidate.law_name()) {
                    *candidate = candidate.clone().holding(&name, value)?;
                    is_meant = true;
                }
            }
            if let (false, Some(law)) = (is_meant, law) {
                let what = format!("--hold {law}.{name}: {law} is none of the laws to compare");
                return Err(Kind::Name.refusal(what).into());
            }
        }
        Ok(candidates)
    }

    /// The same where laws are compared and not searched: viscous, dry and both unless others are named.
    pub(crate) fn compared(&self, host: &Host<'_>) -> Result<Vec<Candidate>, Box<dyn Error>> {
        if let Some(seconds) = self.time_limit {
            let what = format!(
                "--time-limit {seconds} is for the search of `fmm identify` without --law; a comparison fits all its \
                 laws"
            );
            return Err(Kind::Contradiction.refusal(what).into());
        }
        if self.law.is_empty() {
            return Self { law: vec!["all".to_owned()], ..self.clone() }.candidates(host);
        }
        self.candidates(host)
    }

    /// Time that is left of the limit of a search that has `begun` then; `None` without a limit.
    fn time_left(&self, begun: Instant) -> Option<Duration> {
        let left = self.time_limit? - begun.elapsed().as_secs_f64();
        Some(Duration::try_from_secs_f64(left.max(0.0)).unwrap_or(Duration::MAX))
    }

    /// Friction over the speed, no law assumed, of the `decays` that `found` explains, in what is left of the time limit
    /// of a search that has `begun` then; or the reason why there is none.
    pub(crate) fn friction_curve(
        &self,
        found: &Identification,
        decays: &[Experiment],
        begun: Instant,
    ) -> Result<FrictionCurve, String> {
        let curve = match self.time_left(begun) {
            Some(limit) => FrictionCurve::beside_within(found, decays, limit),
            None => FrictionCurve::beside(found, decays),
        };
        let is_over = || self.time_left(begun).is_some_and(|left| left.is_zero());
        curve.map_err(|error| if is_over() { "the time limit is over".to_owned() } else { error.to_string() })
    }

    fn held(&self) -> Result<Vec<Held>, Box<dyn Error>> {
        let mut all: Vec<Held> = Vec::with_capacity(self.hold.len());
        for text in &self.hold {
            let refused = |error| Kind::Option.refusal(format!("--hold {text}: {error}"));
            let held: Held = text.parse().map_err(refused)?;
            if let Some(other) = all.iter().find(|other| (&other.law, &other.name) == (&held.law, &held.name)) {
                let what = format!("--hold {text}: {} is held at {} already", held.name, other.value);
                return Err(Kind::Contradiction.refusal(what).into());
            }
            all.push(held);
        }
        Ok(all)
    }

    /// The one of the laws that are named, or that a search knows, which is called so.
    pub(crate) fn candidate(&self, law: &str, host: &Host<'_>) -> Result<Candidate, Box<dyn Error>> {
        if let Some(candidate) = self.candidates(host)?.into_iter().find(|candidate| candidate.name() == law) {
            return Ok(candidate);
        }
        let named = Self { law: vec![law.replace(" of any sign", " + any sign")], ..self.clone() };
        named.candidates(host)?.pop().ok_or_else(|| Kind::Name.refusal(format!("there is no law called {law}")).into())
    }

    /// Inputs of the machine that are declared, by their names, with value and standard uncertainty in their units.
    pub(crate) fn declared(&self) -> impl Iterator<Item = (String, (f64, f64))> {
        let declared = [
            ("mass", self.mass, self.mass_u),
            ("stiffness", self.stiffness, self.stiffness_u),
            ("damping", self.damping, self.damping_u),
            ("normal_load", self.normal_load, self.normal_load_u),
        ];
        declared.into_iter().filter_map(|(name, value, u)| Some((name.to_owned(), (value?, u))))
    }

    /// Inputs of the machine with an uncertainty: source, value and standard uncertainty in their units.
    pub(crate) fn stated(&self) -> impl Iterator<Item = (Source, f64, f64)> {
        let stated = [
            (Source::Mass, self.mass, self.mass_u),
            (Source::Stiffness, self.stiffness, self.stiffness_u),
            (Source::Damping, self.damping, self.damping_u),
            (Source::NormalLoad, self.normal_load, self.normal_load_u),
        ];
        stated.into_iter().filter_map(|(source, value, u)| Some((source, value?, u))).filter(|(_, _, u)| *u > 0.0)
    }

    /// Question to several records as one problem: that of the first record, and the normal load of each over that of
    /// the first. Refused where they state more than one machine.
    pub(crate) fn together(questions: &[(Self, String)]) -> Result<(Self, Vec<f64>), OfKind> {
        let contradiction = |what: String| Kind::Contradiction.refusal(what);
        let (first, name) = questions.first().ok_or_else(|| contradiction("there is no record".to_owned()))?;
        let mut factors = Vec::with_capacity(questions.len());
        let mut relative = 0.0_f64;
        for (question, other) in questions {
            let of_machine = |question: &Self| {
                [
                    ("--pendulum", question.pendulum.map(Radian::arc)),
                    ("--run-down", question.run_down.then_some(1.0)),
                    ("--mass", question.mass),
                    ("--mass-u", Some(question.mass_u)),
                    ("--stiffness", question.stiffness),
                    ("--stiffness-u", Some(question.stiffness_u)),
                    ("--damping", question.damping),
                    ("--damping-u", Some(question.damping_u)),
                    ("--steady", question.steady),
                ]
            };
            let words = |value: Option<f64>| value.map_or_else(|| "none".to_owned(), |value| value.to_string());
            let differs =
                of_machine(first).into_iter().zip(of_machine(question)).find(|(own, theirs)| own.1 != theirs.1);
            if let Some(((option, own), (_, theirs))) = differs {
                return Err(contradiction(format!(
                    "one machine is fitted to all, but {option} is {} for {name} and {} for {other}",
                    words(own),
                    words(theirs)
                )));
            }
            factors.push(match (first.normal_load, question.normal_load) {
                (None, None) => 1.0,
                (Some(own), Some(theirs)) => {
                    relative = relative.max(question.normal_load_u / theirs);
                    theirs / own
                }
                (own, theirs) => {
                    return Err(contradiction(format!(
                        "a joint fit needs the normal load of all records or of none, but it is {} for {name} and {} \
                         for {other}",
                        words(own),
                        words(theirs)
                    )));
                }
            });
        }
        // The loads may be wrong together, and the worst known of them counts.
        let normal_load_u = first.normal_load.map_or(0.0, |load| relative * load);
        Ok((Self { normal_load_u, ..first.clone() }, factors))
    }

    /// Comparison of the `candidates`, or of a search if there are none, by records of one machine; `show` sees each
    /// trial step.
    pub(crate) fn answer(
        &self,
        decays: &[Experiment],
        candidates: &[Candidate],
        show: impl FnMut(&str, &Minimizer) -> ControlFlow<()> + Send,
    ) -> Result<Comparison, Box<dyn Error>> {
        let machine = self.machine(decays).map_err(|error| Kind::Option.unless_known(error))?;
        let mut inquiry = Inquiry::of(&machine, decays).observed_by(show);
        if !candidates.is_empty() {
            return Ok(inquiry.among(candidates)?);
        }
        for Held { law, name, value } in self.held()? {
            inquiry = inquiry.holding(law.as_deref(), &name, value);
        }
        if let Some(seconds) = self.time_limit {
            inquiry = inquiry.within(limit(seconds)?);
        }
        Ok(inquiry.search()?)
    }
}

/// Time of a --time-limit.
pub(crate) fn limit(seconds: f64) -> Result<Duration, OfKind> {
    let refused = |_| Kind::Option.refusal(format!("--time-limit {seconds}: give seconds"));
    Duration::try_from_secs_f64(seconds).map_err(refused)
}

/// Value of an option with its uncertainty.
fn known(option: &str, value: f64, uncertainty: f64) -> Result<Known, OfKind> {
    Known::new(value, uncertainty).map_err(|error| Kind::Option.refusal(format!("{option}: {error}")))
}

/// Length of the arc that makes one radian of a pendulum; `None` for records in radians.
#[derive(Debug, Clone, Copy)]
struct Radian {
    length: Option<f64>,
}

impl Radian {
    /// The length, in radians for angles.
    fn arc(self) -> f64 {
        self.length.unwrap_or(1.0)
    }
}

impl FromStr for Radian {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let length = (!text.is_empty()).then(|| text.parse().map_err(|_| format!("{text:?} is no length")));
        Ok(Self { length: length.transpose()? })
    }
}

/// A parameter that is held, of one law or of all.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub(crate) law: Option<String>,
    pub(crate) name: String,
    pub(crate) value: f64,
}

impl FromStr for Held {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("give NAME=VALUE or LAW.NAME=VALUE, such as exponent=2")?;
        let value = value.trim().parse().map_err(|_| format!("{value:?} is no number"))?;
        let (law, name) = match name.split_once('.') {
            Some((law, name)) => (Some(law.trim().to_owned()), name),
            None => (None, name),
        };
        Ok(Self { law, name: name.trim().to_owned(), value })
    }
}
