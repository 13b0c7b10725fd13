//! Options of a fit of blows.

use fmm_fit::Options;
use fmm_model::ModelError;

/// What of a blow is fitted.
///
/// All three compare the simulated velocity with the measured one, sample by sample or line by line of the discrete
/// transform over the whole record:
///
/// ```text
/// samples:   r_n = v_model(t_n) − v(t_n)                                                               (1)
/// lines:     r_k = √(2/n) (V_model(f_k) − V(f_k)) = √(2/n) F(f_k) (H_model(f_k) − H(f_k))              (2)
/// ```
///
/// (2) is the complex mobility, weighted with the force: white noise σ of the velocity then gives real and imaginary
/// part of every line the variance σ², as it does every sample, while the mobility itself is noisy where there is
/// little force. With the sum over all lines (2) is (1) by Parseval's theorem, so that a band is the part of the time
/// record that lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ImpactDomain {
    /// The complex mobility in a band, (2). What lies outside the band does not count: an offset, drift, hum, other
    /// modes.
    #[default]
    Mobility,
    /// The velocity from the end of the blow until a while after rest, (1). While the hammer is in contact the velocity
    /// follows a force of which only the samples are known, so that these few samples count as zero.
    Time,
    /// Both, as they are: what lies in the band counts twice for the estimate, once for its uncertainty.
    Both,
}

/// How blows are fitted; the default takes the mobility from half to twice the natural frequency, finds the parameters
/// of the law and holds everything else at what is known.
///
/// What can be set free or held, beside the parameters of the law by its own names:
///
/// | parameter | unit | is |
/// |---|---|---|
/// | `mass`, `stiffness`, `damping`, `normal_load` | kg, N/m, N s/m, N | that of the machine |
/// | `force_gain` of each trial | 1 | what the force channel reads, by what acts; free, the friction follows from the decay alone |
/// | `response_gain` | 1 | what the velocity channel reads, by what moves |
/// | `offset` of each trial | m/s | offset that is left on the velocity; has no effect on a band |
/// | `impulse_error` of each trial | 1 | by how much straight lines between the samples of the force have too large an impulse |
/// | `pulse_delay` of each trial | s | how much later the blow acts than these straight lines |
///
/// The last two are found like the friction, but near zero, as far as [`ImpactSummary`](crate::ImpactSummary) says that
/// they are known; free, they are not known at all, and held they are an uncertain input. A free `force_gain` takes the
/// error of the impulse in.
///
/// ```
/// use fmm_identify::{ImpactDomain, ImpactOptions};
///
/// let options = ImpactOptions::default()
///     .fitting(ImpactDomain::Both)
///     .within(1.0, 4.0)?
///     .free("damping")
///     .with_force_gain_uncertainty(0.02)?;
/// assert_eq!(options.band(), Some((1.0, 4.0)));
/// assert!(ImpactOptions::default().within(4.0, 1.0).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ImpactOptions {
    pub(crate) domain: ImpactDomain,
    pub(crate) band: Option<(f64, f64)>,
    pub(crate) free: Vec<String>,
    pub(crate) held: Vec<(String, f64)>,
    pub(crate) force_gain_uncertainty: f64,
    pub(crate) response_gain_uncertainty: f64,
    pub(crate) solver: Options,
}

impl ImpactOptions {
    /// The same with another domain.
    #[must_use]
    pub fn fitting(mut self, domain: ImpactDomain) -> Self {
        self.domain = domain;
        self
    }

    /// The same with the band from `low` to `high` (Hz), both ends included.
    ///
    /// # Errors
    /// [`ModelError`] if an end is negative or not finite, or if they are not in order.
    pub fn within(mut self, low: f64, high: f64) -> Result<Self, ModelError> {
        ModelError::require_not_negative("low end of the band", low, "Hz")?;
        ModelError::require_finite("high end of the band", high, "Hz")?;
        ModelError::require_positive("width of the band", high - low, "Hz")?;
        self.band = Some((low, high));
        Ok(self)
    }

    /// The same with one more parameter to be found.
    #[must_use]
    pub fn free(mut self, parameter: impl Into<String>) -> Self {
        self.free.push(parameter.into());
        self
    }

    /// The same with one more parameter held at `value`, in its unit. Its uncertainty stays that of what is known of
    /// it; a parameter of the law has none then.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`]. Whether there is such a parameter shows when the law is known.
    pub fn holding(mut self, parameter: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((parameter.into(), value));
        Ok(self)
    }

    /// The same with a relative standard uncertainty (1) of the calibration of the hammer, which all trials share. That
    /// of each impulse is added by itself. The fit takes both for what is known before: where the motion tells the
    /// impulse better, it counts.
    ///
    /// # Errors
    /// [`ModelError`] if it is negative or not finite.
    pub fn with_force_gain_uncertainty(mut self, uncertainty: f64) -> Result<Self, ModelError> {
        self.force_gain_uncertainty =
            ModelError::require_not_negative("uncertainty of the force gain", uncertainty, "1")?;
        Ok(self)
    }

    /// The same with a relative standard uncertainty (1) of the calibration of the velocity channel, which all trials
    /// share.
    ///
    /// # Errors
    /// [`ModelError`] if it is negative or not finite.
    pub fn with_response_gain_uncertainty(mut self, uncertainty: f64) -> Result<Self, ModelError> {
        self.response_gain_uncertainty =
            ModelError::require_not_negative("uncertainty of the response gain", uncertainty, "1")?;
        Ok(self)
    }

    /// The same with other options of the solver.
    #[must_use]
    pub fn solving(mut self, solver: Options) -> Self {
        self.solver = solver;
        self
    }

    /// What is fitted.
    pub const fn domain(&self) -> ImpactDomain {
        self.domain
    }

    /// The band (Hz), if one was given.
    pub const fn band(&self) -> Option<(f64, f64)> {
        self.band
    }
}
