//! The least-squares problem of one record in which every number of machine, law and initial state is a parameter.

use std::marker::PhantomData;

use fmm_fit::{Derivatives, EvaluationError, Residuals};
use fmm_friction::{LawFamily, SlidingLaw};
use fmm_model::{Bounds, Damping, Dual, Oscillator, Parameter, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, RungeKutta, Sampling, Scenario, SimulationError, Thesis, Trajectory, simulate_into};

use crate::error::IdentifyError;
use crate::threads::Pool;

/// The residuals "model less record" of one record, as a function of the machine, the law and the initial state.
///
/// Each of these has a value; what is not [`free`](Self::free) keeps it in a fit, and is an input of its
/// [`Sensitivity`](fmm_fit::Sensitivity) and [`Refit`](fmm_fit::Refit). Where [`Problem`](crate::Problem)
/// finds all that a record shows, this one asks what a coefficient of friction becomes if mass, stiffness, damping and
/// load are others: the fit of the thesis' chapter 5.3.
///
/// | parameter | unit | value unless given |
/// |---|---|---|
/// | `mass`, `stiffness` | kg, N/m | must be given |
/// | `damping`, `quadratic_damping` | N s/m, N s²/m² | 0 |
/// | `normal_load` | N | 1, so that coefficients are forces |
/// | those of the law `F`, by its own names | | must be given |
/// | `initial_position`, `initial_velocity` | m, m/s | 0 |
/// | `offset` of the record | unit of the record | 0 |
///
/// The motion begins with the first sample.
///
/// ```
/// use fmm_fit::{Options, Sensitivity, solve};
/// use fmm_friction::Coulomb;
/// use fmm_identify::MachineProblem;
/// # use fmm_model::{Damping, Oscillator};
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// // A velocity record, 1 kHz; here a simulated one.
/// # let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
/// # let scenario = Scenario::new(machine, Coulomb::new(0.15)?, 7.2)?.starting_at(0.0, 0.101)?;
/// # let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501)?)?.velocity().values().to_vec();
/// let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
///
/// let machine = [("mass", 10.391), ("stiffness", 1982.0), ("damping", 0.275), ("normal_load", 7.2)];
/// let start = [("coefficient", 0.16), ("initial_position", 1e-4), ("initial_velocity", 0.101)];
/// let problem = MachineProblem::<Coulomb>::new(&record, &[machine.as_slice(), &start].concat())?
///     .free("coefficient")?
///     .free("initial_position")?;
/// let fit = solve(&problem, problem.values(), &Options::default())?;
/// assert!((fit.estimate("coefficient").unwrap().value() - 0.15).abs() < 1e-12);
///
/// // Only k/m, c/m and μ N/m show: scaling m, k and c together scales μ.
/// let by = |input| Sensitivity::of(&problem, &fit).map(|s| s.coefficient_of("coefficient", input).unwrap());
/// let scaled = 10.391 * by("mass")? + 1982.0 * by("stiffness")? + 0.275 * by("damping")?;
/// assert!((scaled - 0.15).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MachineProblem<F: LawFamily> {
    data: Vec<f64>,
    sampling: Sampling,
    quantity: Quantity,
    parameters: Vec<Parameter>,
    /// The bounds that each parameter has by its nature.
    natural: Vec<Bounds>,
    values: Vec<f64>,
    free: Vec<usize>,
    euler: Option<Euler<F>>,
    tolerance: Option<f64>,
    idle: Pool<Buffers>,
    family: PhantomData<F>,
}

/// A run of an engine that carries no derivatives.
type Euler<F> =
    fn(&Scenario<f64, <F as LawFamily>::At<f64>>, &Sampling, &mut Trajectory<f64>) -> Result<(), SimulationError>;

/// Directions of derivative that one simulation carries, if no more are wanted and if so.
const FEW: usize = 2;
const MANY: usize = 4;

#[derive(Debug, Default)]
struct Buffers {
    plain: Trajectory,
    few: Trajectory<Dual<FEW>>,
    many: Trajectory<Dual<MANY>>,
}

/// The parameters before those of the law.
const MACHINE: [Parameter; 5] = [
    Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE),
    Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE),
    Parameter::new("damping", "c", "N s/m").bounded(Bounds::NOT_NEGATIVE),
    Parameter::new("quadratic_damping", "A", "N s²/m²").bounded(Bounds::NOT_NEGATIVE),
    Parameter::new("normal_load", "N", "N").bounded(Bounds::POSITIVE),
];

impl<F: LawFamily> MachineProblem<F> {
    /// The problem of `record`, a velocity (m/s) or a displacement (m), with the value of each parameter by its name.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a record of another quantity, [`IdentifyError::UnknownName`],
    /// [`IdentifyError::Missing`], and [`IdentifyError::OutOfRange`] for a value that its parameter cannot have.
    pub fn new(record: &Record, values: &[(&str, f64)]) -> Result<Self, IdentifyError> {
        let quantity = record.quantity();
        let channels = match quantity {
            Quantity::Displacement => Channels::Position,
            Quantity::Velocity => Channels::Velocity,
            _ => {
                return Err(IdentifyError::wrong_quantity(
                    "the record of a machine problem",
                    "a displacement or a velocity",
                    quantity,
                ));
            }
        };
        let sampling = Sampling::uniform(record.interval(), record.len())
            .map_err(|error| IdentifyError::simulation(F::NAME, error))?
            .keeping(channels);
        let mut parameters = MACHINE.to_vec();
        parameters.extend(F::PARAMETERS.iter().map(|parameter| parameter.parameter().clone()));
        parameters.extend([
            Parameter::new("initial_position", "x₀", "m"),
            Parameter::new("initial_velocity", "v₀", "m/s"),
            Parameter::named("offset", "b", record.unit().to_owned()),
        ]);
        let natural: Vec<Bounds> = parameters.iter().map(Parameter::bounds).collect();
        let law = MACHINE.len()..MACHINE.len() + F::PARAMETERS.len();
        let default = |j: usize| match j {
            0 | 1 => None,
            4 => Some(1.0),
            _ if law.contains(&j) => None,
            _ => Some(0.0),
        };
        let mut given: Vec<Option<f64>> = (0..parameters.len()).map(default).collect();
        for (name, value) in values {
            given[index(&parameters, name)?] = Some(*value);
        }
        let mut held = Vec::with_capacity(given.len());
        for (parameter, value) in parameters.iter_mut().zip(given) {
            let value =
                value.ok_or_else(|| IdentifyError::missing(format!("{} must be given a value", parameter.name())))?;
            let (bounds, fixed) = (parameter.bounds(), Bounds::new(value, value));
            match fixed {
                Ok(fixed) if bounds.contains(value) => *parameter = parameter.clone().bounded(fixed),
                _ => {
                    let (lower, upper) = (bounds.lower(), bounds.upper());
                    let name = parameter.name().to_owned();
                    return Err(IdentifyError::held_out_of_bounds(&name, value, lower, upper));
                }
            }
            held.push(value);
        }
        Ok(Self {
            data: record.values().to_vec(),
            sampling,
            quantity,
            parameters,
            natural,
            values: held,
            free: Vec::new(),
            euler: None,
            tolerance: None,
            idle: Pool::default(),
            family: PhantomData,
        })
    }

    /// The same with a parameter to be found, from its value and within the bounds of its nature.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`].
    pub fn free(self, name: &str) -> Result<Self, IdentifyError> {
        let natural = self.natural[index(&self.parameters, name)?];
        self.free_within(name, natural)
    }

    /// The same with a parameter to be found, from its value and within `bounds` and those of its nature.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], and [`IdentifyError::OutOfRange`] if its value is not within them.
    pub fn free_within(mut self, name: &str, bounds: Bounds) -> Result<Self, IdentifyError> {
        let j = index(&self.parameters, name)?;
        let (natural, value) = (self.natural[j], self.values[j]);
        let (lower, upper) = (bounds.lower().max(natural.lower()), bounds.upper().min(natural.upper()));
        let bounds = Bounds::new(lower, upper).ok().filter(|bounds| bounds.contains(value));
        let name = name.to_owned();
        let bounds = bounds.ok_or(IdentifyError::held_out_of_bounds(&name, value, lower, upper))?;
        self.parameters[j] = self.parameters[j].clone().bounded(bounds);
        if let Err(place) = self.free.binary_search(&j) {
            self.free.insert(place, j);
        }
        Ok(self)
    }

    /// The same simulated as in the thesis, by an Euler method that looks for a stop once a step. Its sum of squares
    /// jumps wherever a stop moves to another sample, and it has no derivatives.
    #[must_use]
    pub fn by_thesis(mut self) -> Self
    where
        F::At<f64>: SlidingLaw<f64>,
    {
        self.euler = Some(|scenario, sampling, trajectory| Thesis::A3.run_into(scenario, sampling, trajectory));
        self
    }

    /// The same simulated to a relative `tolerance` (1), where the law has no closed form: with 1e-9 instead of the
    /// engine's own a fit takes less than half as long, and refits of the Berger law on other machines were found to
    /// move by less than 1e-5 of their standard uncertainty.
    ///
    /// # Errors
    /// [`IdentifyError::Simulation`] for a tolerance outside the engine's.
    pub fn with_tolerance(mut self, tolerance: f64) -> Result<Self, IdentifyError> {
        RungeKutta::new(tolerance).map_err(|error| IdentifyError::simulation(F::NAME, error))?;
        self.tolerance = Some(tolerance);
        Ok(self)
    }

    /// The value of each parameter, where a fit begins.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    fn scenario<D: Scalar>(p: &[D]) -> Result<Scenario<D, F::At<D>>, EvaluationError> {
        let [mass, stiffness, linear, quadratic, load] = [p[0], p[1], p[2], p[3], p[4]];
        let oscillator = Oscillator::new(mass, stiffness)?.with_damping(Damping::new(linear, quadratic)?);
        let (law, initial) = p[MACHINE.len()..].split_at(F::PARAMETERS.len());
        let scenario = Scenario::new(oscillator, F::at(law)?, load)?;
        Ok(scenario.starting_at(initial[0], initial[1])?)
    }

    fn simulate<D: Scalar>(
        &self,
        scenario: &Scenario<D, F::At<D>>,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        simulate_into::<F, _>(scenario, &self.sampling, self.tolerance, trajectory)
    }

    fn write_residuals<D: Scalar>(&self, p: &[f64], trajectory: &Trajectory<D>, residuals: &mut [f64]) {
        let offset = p[p.len() - 1];
        for ((out, model), data) in residuals.iter_mut().zip(self.simulated(trajectory).values()).zip(&self.data) {
            *out = model + offset - data;
        }
    }

    fn simulated<'t, D: Scalar>(&self, trajectory: &'t Trajectory<D>) -> &'t fmm_sim::Samples<D> {
        if self.quantity == Quantity::Displacement { trajectory.position() } else { trajectory.velocity() }
    }

    /// Runs with derivatives in the directions of `columns`, at most `N`.
    fn differentiate<const N: usize>(
        &self,
        p: &[f64],
        columns: &[usize],
        trajectory: &mut Trajectory<Dual<N>>,
        jacobian: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let direction = |j: usize| columns.iter().position(|column| *column == j);
        // A parameter without a direction gets one that no number carries, which makes it a constant.
        let variables = p.iter().enumerate().map(|(j, value)| Dual::variable(*value, direction(j).unwrap_or(N)));
        self.simulate(&Self::scenario(&variables.collect::<Vec<_>>())?, trajectory)?;
        for (direction, &j) in columns.iter().enumerate() {
            let column = &mut jacobian[j * self.data.len()..][..self.data.len()];
            match self.simulated(trajectory).partial(direction) {
                _ if j + 1 == p.len() => column.fill(1.0),
                Some(partial) => column.copy_from_slice(partial),
                None => column.fill(0.0),
            }
        }
        Ok(())
    }
}

/// The place of the parameter of this name.
fn index(parameters: &[Parameter], name: &str) -> Result<usize, IdentifyError> {
    parameters.iter().position(|parameter| parameter.name() == name).ok_or_else(|| {
        IdentifyError::unknown_parameter(name, &parameters.iter().map(Parameter::name).collect::<Vec<_>>().join(", "))
    })
}

impl<F: LawFamily> Residuals for MachineProblem<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.data.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian.filter(|_| !self.free.is_empty()) else {
            let scenario = Self::scenario(p)?;
            return self.idle.lend(|buffers| {
                match self.euler {
                    Some(run) => run(&scenario, &self.sampling, &mut buffers.plain)?,
                    None => self.simulate(&scenario, &mut buffers.plain)?,
                }
                self.write_residuals(p, &buffers.plain, residuals);
                Ok(())
            });
        };
        self.idle.lend(|buffers| {
            if self.free.len() <= FEW {
                self.differentiate(p, &self.free, &mut buffers.few, jacobian)?;
                self.write_residuals(p, &buffers.few, residuals);
                return Ok(());
            }
            for columns in self.free.chunks(MANY) {
                self.differentiate(p, columns, &mut buffers.many, jacobian)?;
            }
            self.write_residuals(p, &buffers.many, residuals);
            Ok(())
        })
    }

    fn derivatives(&self) -> Derivatives {
        if self.euler.is_none() { Derivatives::Free } else { Derivatives::None }
    }

    fn is_cheaper_combined(&self) -> bool {
        // Two directions cost about as much as none, four several times as much.
        self.euler.is_none() && self.free.len() <= FEW
    }
}
