//! Friction, damping and stiffness from the weak form of the equation of motion.

use std::f64::consts::PI;

use fmm_fit::{Derivatives, EvaluationError, Fit, Options, Residuals, solve};
use fmm_model::{Bounds, ModelError, Parameter};
use fmm_record::{Quantity, Record, noise, quantisation_step};

use crate::error::IdentifyError;
use crate::estimators::half_swings::{bridged, check_reversals, reversals};
use crate::estimators::weak_equations::{Equations, Motion};
use crate::experiment::Experiment;
use crate::law::naming::Units;
use fmm_model::Estimated;

/// Friction and damping without a derivative of the record, without smoothing and without a simulation.
///
/// The equation of motion is multiplied by test functions w and integrated by parts, so that all derivatives and
/// integrals of the record turn into derivatives and integrals of w:
///
/// ```text
/// x″ + (c/m) x′ + (c₂/m)|x′|x′ + (k/m)(x − x₀) + (F/m) sgn x′ = 0
///
/// ∫w x″ + (c/m) ∫w x′ + (c₂/m) ∫w|x′|x′ + (k/m)(∫w x − x₀) ± F/m = 0        w = 2/L sin² πτ over each half swing
/// ∫w x″ + (c/m) ∫w x′ + (c₂/m) ∫w|x′|x′ + (k/m) ∫w x             = 0        w = 4/L sin² πτ cos πτ
/// ```
///
/// In it k/m, c/m, F/m and x₀ are linear. w vanishes where the velocity changes its sign, so that the times of
/// reversals need not be known well, and the stop of the motion not at all. Of a velocity record the differences
/// of neighbouring half swings are taken: x₀ drops out, and what noise adds to the position does not add up. The
/// equations are weighted by their covariance under white noise. An offset of a velocity drifts the position and is
/// found as that.
///
/// It needs no start values, and its result is a good start for [`identify`](crate::identify), which uses every sample,
/// the stop among them.
///
/// | limit | effect |
/// |---|---|
/// | samples per period n | relative error of about (2π/n)²/24 in F/m: 8e-6 at 450 |
/// | noise in the regressors | relative error of about the square of noise over amplitude |
/// | few half swings | five unknowns need at least that many; hold those that are known |
///
/// ```
/// use fmm_identify::{Preparation, Experiment, WeakForm};
/// # use fmm_friction::CoulombViscous;
/// # use fmm_model::Oscillator;
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// // A velocity record; here a simulated one: 2 Hz, c/m = 0.05 1/s, F/m = 0.1 m/s², 1 kHz.
/// # let scenario = Scenario::new(Oscillator::per_unit_mass(2.0)?, CoulombViscous::new(0.1, 0.05)?, 1.0)?;
/// # let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 4000)?)?;
/// # let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
/// let decay = Experiment::ring_down(&record, &Preparation::default())?;
/// let found = WeakForm::default().estimate(&decay)?;
/// assert!((found.friction.value / 0.1 - 1.0).abs() < 1e-3);
/// assert!((found.damping.value / 0.05 - 1.0).abs() < 1e-2);
/// assert!((found.natural_frequency.value / 2.0 - 1.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// M. Shinbrot, "On the analysis of linear and nonlinear systems", Trans. ASME 79 (1957) 547 (method of modulating
/// functions).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct WeakForm {
    frequency: Option<f64>,
    damping: Option<f64>,
    quadratic: Quadratic,
}

/// What is done about quadratic damping.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum Quadratic {
    #[default]
    None,
    Held(f64),
    Free,
}

/// What the weak form found.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct WeakFormEstimate {
    /// F/m, friction per mass (unit of acceleration); its uncertainty is 0 where a value was held, here and below.
    pub friction: Estimated,
    /// c/m (1/s).
    pub damping: Estimated,
    /// c₂/m, quadratic damping per mass (1 per unit of length).
    pub quadratic_damping: Estimated,
    /// f₀, natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// Offset of the record, in its unit; of a displacement the position in which the spring is free of force.
    pub offset: Estimated,
    /// Half swings used, pieces at the ends included.
    pub half_swings: usize,
    /// White noise (unit of the record) that would explain the misfit of the equations; well above the noise of the
    /// record it says that the law misses something. `None` without more equations than unknowns.
    pub explained_noise: Option<f64>,
    /// The fit of the equations: covariance, correlations, rank.
    pub fit: Fit,
}

impl WeakFormEstimate {
    /// ω₀ (rad/s).
    pub fn angular_frequency(&self) -> Estimated {
        self.natural_frequency.scaled(2.0 * PI)
    }
}

impl WeakForm {
    /// Holds the natural frequency (Hz) instead of finding it.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`].
    pub fn holding_natural_frequency(mut self, frequency: f64) -> Result<Self, ModelError> {
        self.frequency = Some(ModelError::require_positive("natural frequency", frequency, "Hz")?);
        Ok(self)
    }

    /// Holds c/m (1/s) instead of finding it.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`].
    pub fn holding_damping(mut self, damping_per_mass: f64) -> Result<Self, ModelError> {
        self.damping = Some(ModelError::require_finite("damping per mass", damping_per_mass, "1/s")?);
        Ok(self)
    }

    /// Holds c₂/m (1 per unit of length) instead of taking it as zero; velocity records only.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`].
    pub fn holding_quadratic_damping(mut self, quadratic_per_mass: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("quadratic damping per mass", quadratic_per_mass, "1/m")?;
        self.quadratic = Quadratic::Held(value);
        Ok(self)
    }

    /// Finds c₂/m as well; velocity records only.
    #[must_use]
    pub fn with_quadratic_damping(mut self) -> Self {
        self.quadratic = Quadratic::Free;
        self
    }

    /// The estimate from `decay`, whose half swings are found by their crossings. An offset that the preparation holds
    /// is held here.
    ///
    /// # Errors
    /// [`IdentifyError::TooFew`] if there are fewer equations than unknowns, [`IdentifyError::Undetermined`] if
    /// they do not tell them apart, [`IdentifyError::WrongRecord`] for quadratic damping of a displacement.
    pub fn estimate(&self, decay: &Experiment) -> Result<WeakFormEstimate, IdentifyError> {
        decay.require_free("the weak form")?;
        self.solve(decay.record(), &bridged(decay), &reversals(decay), decay.fixed_offset(), decay.white_noise())
    }

    /// The estimate from `record` between known `reversals`, times of zero velocity (s); `offset` (unit of the record)
    /// is held if it is given.
    ///
    /// # Errors
    /// As for [`estimate`](Self::estimate), and [`IdentifyError::WrongRecord`], [`IdentifyError::OutOfRange`].
    pub fn estimate_between(
        &self,
        record: &Record,
        reversals: &[f64],
        offset: Option<f64>,
    ) -> Result<WeakFormEstimate, IdentifyError> {
        let quantity = record.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
            let needed = "a displacement or a velocity";
            return Err(IdentifyError::wrong_quantity("a record for the weak form", needed, quantity));
        }
        check_reversals(record, reversals)?;
        let offset = offset.map(|offset| ModelError::require_finite("offset", offset, "in the unit of the record"));
        let step = quantisation_step(record.values()).unwrap_or(0.0);
        let noise = noise(record.values()).hypot(step / 12f64.sqrt());
        self.solve(record, record.values(), reversals, offset.transpose()?, noise)
    }

    fn solve(
        &self,
        record: &Record,
        values: &[f64],
        reversals: &[f64],
        offset: Option<f64>,
        noise: f64,
    ) -> Result<WeakFormEstimate, IdentifyError> {
        const FEWEST: usize = 2;
        let half_swings = reversals.len().saturating_sub(1);
        if half_swings < FEWEST {
            return Err(IdentifyError::too_few_half_swings(half_swings, FEWEST));
        }
        let quantity = record.quantity();
        if self.quadratic != Quadratic::None && quantity == Quantity::Displacement {
            return Err(IdentifyError::velocity_needed("quadratic damping by the weak form", quantity));
        }
        let span = reversals[half_swings] - reversals[0];
        let guess = self.frequency.unwrap_or(0.5 * half_swings as f64 / span);
        let times: Vec<f64> = reversals.iter().map(|time| time - record.start()).collect();
        let motion = Motion { values, interval: record.interval(), quantity, reversals: &times };
        let parameters = self.parameters(record, offset);
        let mut start = [self.damping.unwrap_or(0.0), (2.0 * PI * guess).powi(2), 0.0, 0.0, offset.unwrap_or(0.0)];
        if let Quadratic::Held(value) = self.quadratic {
            start[QUADRATIC] = value;
        }
        // |x′|x′ needs the offset, which the first pass finds; the error then falls by its square.
        let passes = if self.quadratic == Quadratic::None { 1 } else { 3 };
        let mut fit = None;
        for _ in 0..passes {
            let equations = Equations::of(&motion, start[DAMPING], start[STIFFNESS], start[OFFSET]);
            let equations = equations.ok_or_else(|| undetermined(&parameters))?;
            let system = WeakSystem { equations, parameters: parameters.clone() };
            let free = parameters.iter().filter(|parameter| !parameter.bounds().is_fixed()).count();
            if system.len() < free {
                // Two equations for each half swing, one less for differences.
                return Err(IdentifyError::too_few_half_swings(half_swings, free.div_ceil(2) + 1));
            }
            let found = solve(&system, &start, &Options::default())
                .map_err(|source| IdentifyError::Fit { law: "the weak form", source })?;
            start.copy_from_slice(found.values());
            fit = Some(found);
        }
        let fit = fit.ok_or_else(|| undetermined(&parameters))?;
        estimate(fit, half_swings, noise)
    }

    fn parameters(&self, record: &Record, offset: Option<f64>) -> [Parameter; COUNT] {
        let held =
            |value: Option<f64>| value.and_then(|value| Bounds::new(value, value).ok()).unwrap_or(Bounds::UNBOUNDED);
        let quadratic = match self.quadratic {
            Quadratic::None => Some(0.0),
            Quadratic::Held(value) => Some(value),
            Quadratic::Free => None,
        };
        let stiffness = match self.frequency {
            Some(frequency) => held(Some((2.0 * PI * frequency).powi(2))),
            None => Bounds::POSITIVE,
        };
        let units = Units::of(record);
        [
            Parameter::new("damping_per_mass", "c/m", "1/s").bounded(held(self.damping)),
            Parameter::new("stiffness_per_mass", "k/m", "1/s²").bounded(stiffness),
            Parameter::named("friction_per_mass", "F/m", units.acceleration().to_string()),
            Parameter::named("quadratic_damping_per_mass", "c₂/m", units.position.power(-1).to_string())
                .bounded(held(quadratic)),
            Parameter::named("offset", "b", record.unit().to_owned()).bounded(held(offset)),
        ]
    }
}

fn undetermined(parameters: &[Parameter]) -> IdentifyError {
    let free = parameters.iter().filter(|parameter| !parameter.bounds().is_fixed());
    let parameters = free.map(|parameter| parameter.symbol().to_owned()).collect::<Vec<_>>().join(", ");
    IdentifyError::undetermined("the weak form", parameters)
}

/// Reads the estimates off a fit whose residuals have a variance of 1 where the record has one of 1.
fn estimate(fit: Fit, half_swings: usize, noise: f64) -> Result<WeakFormEstimate, IdentifyError> {
    let explained = fit.residual_standard_deviation();
    // Few equations tell little of the noise; the samples tell it better, unless the law misses something.
    let noise = explained.map_or(noise, |explained| noise.max(explained));
    let mut all = [Estimated { value: 0.0, uncertainty: 0.0 }; COUNT];
    for (j, (out, parameter)) in all.iter_mut().zip(fit.estimates()).enumerate() {
        out.value = parameter.value();
        if !parameter.parameter().bounds().is_fixed() {
            let symbol = || parameter.parameter().symbol().to_owned();
            let variance =
                fit.unit_covariance(j, j).ok_or_else(|| IdentifyError::undetermined("the weak form", symbol()))?;
            out.uncertainty = noise * variance.sqrt();
        }
    }
    let angular = all[STIFFNESS].value.sqrt();
    let angular = Estimated { value: angular, uncertainty: 0.5 * all[STIFFNESS].uncertainty / angular };
    Ok(WeakFormEstimate {
        friction: all[FRICTION],
        damping: all[DAMPING],
        quadratic_damping: all[QUADRATIC],
        natural_frequency: angular.scaled(0.5 / PI),
        offset: all[OFFSET],
        half_swings,
        explained_noise: explained,
        fit,
    })
}

/// Indices of the parameters.
const DAMPING: usize = 0;
const STIFFNESS: usize = 1;
const FRICTION: usize = 2;
const QUADRATIC: usize = 3;
const OFFSET: usize = 4;
const COUNT: usize = 5;

/// The equations as residuals; all is linear but the product of stiffness and offset.
struct WeakSystem {
    equations: Equations,
    parameters: [Parameter; COUNT],
}

impl Residuals for WeakSystem {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.equations.inertia.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let e = &self.equations;
        for (i, out) in residuals.iter_mut().enumerate() {
            *out = e.inertia[i]
                + p[DAMPING] * e.damping[i]
                + p[STIFFNESS] * (e.position[i] - p[OFFSET] * e.constant[i])
                + p[FRICTION] * e.friction[i]
                + p[QUADRATIC] * e.quadratic[i];
        }
        if let Some(jacobian) = jacobian {
            let e = &self.equations;
            let rows = self.len();
            for i in 0..rows {
                jacobian[DAMPING * rows + i] = e.damping[i];
                jacobian[STIFFNESS * rows + i] = e.position[i] - p[OFFSET] * e.constant[i];
                jacobian[FRICTION * rows + i] = e.friction[i];
                jacobian[QUADRATIC * rows + i] = e.quadratic[i];
                jacobian[OFFSET * rows + i] = -p[STIFFNESS] * e.constant[i];
            }
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}
