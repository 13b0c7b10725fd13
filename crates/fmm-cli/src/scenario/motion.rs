//! The motion as it is given out.

use fmm_sim::{Direction, Event, EventKind, Mode, Trajectory};
use serde::Serialize;

use super::Plan;
use super::contact::Setting;

/// A motion: engine, events, samples and energies. Serialised, it is the document of `--json`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Motion {
    /// Name of the engine that made it.
    pub(crate) engine: &'static str,
    pub(crate) events: Vec<Incident>,
    pub(crate) samples: Series,
    pub(crate) energy: Energy,
}

/// An event.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Incident {
    /// Time (s).
    pub(crate) t: f64,
    /// Kind of the event.
    pub(crate) kind: String,
    /// m.
    pub(crate) x: f64,
    /// m/s, right after the event.
    pub(crate) v: f64,
    /// `slip+`, `slip-` or `stick` from here on.
    pub(crate) next: &'static str,
    /// `acc`, `const` or `dec` from here on, under a law that depends on the acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) phase: Option<&'static str>,
    /// Excess of the load over the static level, relative to it.
    #[serde(skip)]
    pub(crate) margin: f64,
    /// N.
    #[serde(skip)]
    pub(crate) static_level: f64,
}

/// The samples, one array a quantity.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Series {
    /// Times (s).
    pub(crate) t: Vec<f64>,
    /// m.
    pub(crate) x: Vec<f64>,
    /// m/s.
    pub(crate) v: Vec<f64>,
    /// One array for each internal state of a bristle law.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) z: Vec<Vec<f64>>,
}

/// Energies and works at the samples (J).
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Energy {
    pub(crate) kinetic: Vec<f64>,
    pub(crate) potential: Vec<f64>,
    pub(crate) total: Vec<f64>,
    /// Work; none for an engine that does not keep account of it.
    #[serde(flatten)]
    pub(crate) work: Option<Account>,
}

/// Works up to the samples (J).
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Account {
    pub(crate) friction: Vec<f64>,
    pub(crate) viscous: Vec<f64>,
    pub(crate) external: Vec<f64>,
    /// total + friction + viscous − external − initial total, which is zero but for errors.
    pub(crate) balance: Vec<f64>,
}

impl Motion {
    /// The part of `trajectory` that `plan` keeps, with its energies.
    pub(crate) fn new(trajectory: &Trajectory, plan: &Plan, setting: &Setting) -> Self {
        let kept = |values: &[f64]| values.iter().take(plan.kept).copied().collect::<Vec<f64>>();
        let samples = Series {
            t: (0..plan.kept).map(|index| plan.sampling.time(index)).collect(),
            x: kept(trajectory.position().values()),
            v: kept(trajectory.velocity().values()),
            z: trajectory.states().iter().map(|state| kept(state.values())).collect(),
        };
        let mut before = None;
        let events = trajectory.events().iter().filter(|event| event.time <= plan.end);
        let events = events
            .map(|event| {
                let incident = Incident::new(event, before);
                before = Some(event.next);
                incident
            })
            .collect();
        let energy = Energy::new(trajectory, &samples, setting);
        Self { engine: trajectory.engine(), events, samples, energy }
    }
}

impl Incident {
    /// `event`, which the mode `before` led to.
    fn new(event: &Event, before: Option<Mode>) -> Self {
        let phase = |mode| match mode {
            Mode::Gaining(_) => Some("acc"),
            Mode::Steady(_) => Some("const"),
            Mode::Losing(_) => Some("dec"),
            _ => None,
        };
        let next = match event.next.direction() {
            Some(Direction::Positive) => "slip+",
            Some(Direction::Negative) => "slip-",
            None => "stick",
        };
        let kind = match event.kind {
            EventKind::Start => "start".to_owned(),
            EventKind::Reversal | EventKind::Stop => "zero_velocity".to_owned(),
            EventKind::Breakaway => format!("breakaway{}", next.trim_start_matches("slip")),
            EventKind::BranchChange => match (before.and_then(phase), phase(event.next)) {
                (Some("const"), Some(to)) => format!("const_to_{to}"),
                (Some(from), _) => format!("{from}_end"),
                (None, _) => "branch_change".to_owned(),
            },
            EventKind::Yield(element) => format!("yield{element}"),
            other => format!("{other:?}").to_lowercase(),
        };
        Self {
            t: event.time,
            kind,
            x: event.position,
            v: event.velocity,
            next,
            phase: phase(event.next),
            margin: event.margin(),
            static_level: event.static_level,
        }
    }
}

impl Energy {
    fn new(trajectory: &Trajectory, samples: &Series, setting: &Setting) -> Self {
        let oscillator = setting.oscillator;
        let kinetic: Vec<f64> = samples.v.iter().map(|v| oscillator.kinetic_energy(*v)).collect();
        let potential: Vec<f64> = samples.x.iter().map(|x| oscillator.potential_energy(*x)).collect();
        let total: Vec<f64> = kinetic.iter().zip(&potential).map(|(kinetic, potential)| kinetic + potential).collect();
        let initial = setting.initial;
        let before = oscillator.kinetic_energy(initial.velocity) + oscillator.potential_energy(initial.position);
        let account = |works: Vec<fmm_sim::Work>| Account {
            friction: works.iter().map(|work| work.friction).collect(),
            viscous: works.iter().map(|work| work.viscous).collect(),
            external: works.iter().map(|work| work.external).collect(),
            balance: (works.iter().zip(&total))
                .map(|(work, total)| total + work.friction + work.viscous - work.external - before)
                .collect(),
        };
        let works: Option<Vec<_>> = (0..total.len()).map(|index| trajectory.work(index)).collect();
        let work = works.map(account);
        Self { kinetic, potential, total, work }
    }
}
