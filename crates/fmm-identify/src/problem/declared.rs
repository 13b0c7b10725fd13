//! Problem of one record on a machine of which each number is declared.

use std::borrow::Cow;

use fmm_friction::{LawFamily, SlidingLaw};
use fmm_model::{Bounds, Parameter};
use fmm_record::{Quantity, Record};
use fmm_sim::RungeKutta;

use super::Problem;
use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::law::Motion;
use crate::law::naming::Form;
use crate::machine::{Known, Machine};
use crate::quantities::rows::Place;
use crate::quantities::table::Table;

impl Problem<'static> {
    /// The residuals of a `record`, a velocity (m/s) or a displacement (m), as a function of the whole machine: each
    /// number has a value by its name, and keeps it unless it is [`free`](Self::free). The motion begins with the first
    /// sample.
    ///
    /// [`of`](Self::of) finds all that a record shows; this asks for the coefficient of friction if mass,
    /// stiffness, damping and load are others: the fit of the thesis' chapter 5.3. Fixed numbers are inputs of its
    /// [`Sensitivity`](fmm_fit::Sensitivity) and [`Refit`](fmm_fit::Refit).
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
    /// ```
    /// use fmm_fit::{Options, Sensitivity, solve};
    /// use fmm_friction::Coulomb;
    /// use fmm_identify::Problem;
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
    /// let problem = Problem::declared::<Coulomb>(&record, &[machine.as_slice(), &start].concat())?
    ///     .free("coefficient")?
    ///     .free("initial_position")?;
    /// let fit = solve(&problem, problem.values(), &Options::default())?;
    /// assert!((fit.estimate("coefficient").unwrap().value() - 0.15).abs() < 1e-12);
    /// // A mass, a stiffness and a damping that are 1 % too large together make the coefficient 1 % too large.
    /// let by = |input| Sensitivity::of(&problem, &fit).map(|s| s.coefficient_of("coefficient", input).unwrap());
    /// let scaled = 10.391 * by("mass")? + 1982.0 * by("stiffness")? + 0.275 * by("damping")?;
    /// assert!((scaled - 0.15).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a record of another quantity, [`IdentifyError::UnknownName`],
    /// [`IdentifyError::Missing`], and [`IdentifyError::OutOfRange`] for a value that its parameter cannot have.
    pub fn declared<F: LawFamily>(record: &Record, values: &[(&str, f64)]) -> Result<Self, IdentifyError> {
        let quantity = record.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
            let (subject, needed) = ("the record of a declared machine", "a displacement or a velocity");
            return Err(IdentifyError::wrong_quantity(subject, needed, quantity));
        }
        let one = Known::exact(1.0)?;
        let machine = Machine::of_mass_and_stiffness(one, one)?.with_damping(Known::NOTHING)?;
        // Nothing is searched for in the record, which is used as it is.
        let experiments = vec![Experiment::planned(record.clone(), None, false, 1.0, 0.0, None)];
        let (table, mut parameters) = Table::by(Form::Coefficient, &Candidate::of::<F>(), &machine, &experiments)?;
        let default = |place: Place| match place {
            Place::Mass | Place::Stiffness | Place::Law(_) => None,
            Place::NormalLoad => Some(1.0),
            _ => Some(0.0),
        };
        let mut given: Vec<Option<f64>> = table.rows.iter().map(|row| default(row.place)).collect();
        for (name, value) in values {
            given[index(&parameters, name)?] = Some(*value);
        }
        let mut declared = Vec::with_capacity(given.len());
        for ((parameter, natural), value) in parameters.iter_mut().zip(&table.natural).zip(given) {
            let value =
                value.ok_or_else(|| IdentifyError::missing(format!("{} must be given a value", parameter.name())))?;
            let fixed = Bounds::new(value, value).ok().filter(|_| natural.contains(value));
            let (name, lower, upper) = (parameter.name(), natural.lower(), natural.upper());
            let fixed = fixed.ok_or_else(|| IdentifyError::held_out_of_bounds(name, value, lower, upper))?;
            *parameter = parameter.clone().bounded(fixed);
            declared.push(value);
        }
        let problem = Self::by(machine, Cow::Owned(experiments), table, parameters);
        Ok(Self { declared, ..problem })
    }
}

impl Problem<'_> {
    /// The same with a parameter to be found, from its value and within the bounds of its nature.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`].
    pub fn free(self, name: &str) -> Result<Self, IdentifyError> {
        self.free_within(name, Bounds::UNBOUNDED)
    }

    /// The same with a parameter to be found, from its value and within `bounds` and those of its nature.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], and [`IdentifyError::OutOfRange`] if its value is not within them.
    pub fn free_within(mut self, name: &str, bounds: Bounds) -> Result<Self, IdentifyError> {
        let index = index(&self.parameters, name)?;
        let (natural, value) = (self.table.natural[index], self.declared[index]);
        let (lower, upper) = (bounds.lower().max(natural.lower()), bounds.upper().min(natural.upper()));
        let parameter = &mut self.parameters[index];
        let narrowed = Bounds::new(lower, upper).ok().filter(|bounds| bounds.contains(value));
        let bounds = narrowed.ok_or_else(|| IdentifyError::held_out_of_bounds(name, value, lower, upper))?;
        *parameter = parameter.clone().bounded(bounds);
        Ok(self)
    }

    /// The same simulated as in the thesis, by an Euler method that looks for a stop once a step. Its sum of squares
    /// jumps wherever a stop moves to another sample, and it has no derivatives. `F` is the family of the problem.
    #[must_use]
    pub fn by_thesis<F: LawFamily>(mut self) -> Self
    where
        F::At<f64>: SlidingLaw<f64>,
    {
        self.euler = Some(Motion::simulate_by_thesis::<F>);
        self
    }

    /// The same simulated to a relative `tolerance` (1), where the law has no closed form: with 1e-9 instead of the
    /// engine's own a fit takes less than half as long, and refits of the Berger law on other machines were found to
    /// move by less than 1e-5 of their standard uncertainty.
    ///
    /// # Errors
    /// [`IdentifyError::Simulation`] for a tolerance outside the engine's.
    pub fn with_tolerance(mut self, tolerance: f64) -> Result<Self, IdentifyError> {
        RungeKutta::new(tolerance).map_err(|error| IdentifyError::simulation(self.name(), error))?;
        self.tolerance = Some(tolerance);
        Ok(self)
    }

    /// The value of each parameter, with which a fit begins.
    pub fn values(&self) -> &[f64] {
        &self.declared
    }
}

/// The place of the parameter of this name.
fn index(parameters: &[Parameter], name: &str) -> Result<usize, IdentifyError> {
    parameters.iter().position(|parameter| parameter.name() == name).ok_or_else(|| {
        let known: Vec<&str> = parameters.iter().map(Parameter::name).collect();
        IdentifyError::unknown_parameter(name, &known.join(", "))
    })
}
