//! Terms that are fitted beside the law, and parameters that are fixed.

use std::fmt::Write as _;

use fmm_model::{Bounds, ModelError, Parameter, Restoring, Scalar, Unit};

use crate::error::IdentifyError;
use crate::machine::term::Term;

/// Terms that are fitted beside the law, and parameters that are fixed.
///
/// Linear, quadratic and cubic damping belong to every experiment; damping with a free power, the terms of the spring
/// and friction that changes during the record or over the position to vibrations; zero, inertia, stiffness, gravity, asymmetry, load
/// offset, channels and delay to a [force along a motion](crate::ForceRecord):
///
/// ```text
/// F(t + τ) = (N + N₀) (µ + a |µ|) + c v + c₂ |v| v + c₃ v³ + m v' + k x + A sin x + B cos x + F₀ + Σ κᵢ yᵢ(t + τ)
/// ```
///
/// µ is the law, with the sign of the velocity; N is 1 without a measured load, so that levels are forces. A force
/// along a motion separates the levels of the two directions, a = (F₊ − F₋)/(F₊ + F₋); in a ring-down these are a level
/// and a force that moves the rest position. yᵢ are the [channels](crate::ForceRecord::with_channel) that were measured
/// beside the force. [`Candidate::named`](crate::Candidate::named) has a word for each term.
///
/// ```
/// use fmm_identify::Terms;
///
/// // A pendulum: air drag beside whatever the law is, and the exponent of a Stribeck curve held at 2.
/// let terms = Terms::default().with_quadratic_damping().holding("exponent", 2.0)?;
/// assert_eq!(terms.held().collect::<Vec<_>>(), [("exponent", 2.0)]);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Terms {
    has: [bool; Term::ALL.len()],
    any_sign: bool,
    /// The longest delay of a force behind its motion (s); `None` for twenty samples.
    pub(crate) longest_delay: Option<f64>,
    held: Vec<(String, f64)>,
}

impl Terms {
    /// No term but the law, and nothing fixed.
    pub(crate) const NONE: Self =
        Self { has: [false; Term::ALL.len()], any_sign: false, longest_delay: None, held: Vec::new() };

    /// The same with `term`.
    pub(crate) fn with(mut self, term: Term) -> Self {
        self.has[term as usize] = true;
        if let Some(second) = term.second() {
            self.has[second as usize] = true;
        }
        self
    }

    /// The same with a linear damping of the machine, c/m, not negative. Not for laws that have a viscous part.
    #[must_use]
    pub fn with_linear_damping(self) -> Self {
        self.with(Term::LinearDamping)
    }

    /// The same with a quadratic damping of the machine, such as the drag of air, not negative.
    #[must_use]
    pub fn with_quadratic_damping(self) -> Self {
        self.with(Term::QuadraticDamping)
    }

    /// The same with a damping that grows with the cube of the velocity, not negative.
    #[must_use]
    pub fn with_cubic_damping(self) -> Self {
        self.with(Term::CubicDamping)
    }

    /// The same with a damping that grows with a power of the velocity between 1 and 5, not negative.
    #[must_use]
    pub fn with_power_damping(self) -> Self {
        self.with(Term::PowerDamping)
    }

    /// The same with a stop on both sides, at a distance and of a stiffness that are fitted
    /// ([`Restoring::stop`](fmm_model::Restoring::stop)); a preloaded joint that opens is one that is softer beyond.
    #[must_use]
    pub fn with_stop(self) -> Self {
        self.with(Term::Stop)
    }

    /// The same with backlash: no restoring force within a gap about the rest position
    /// ([`Restoring::gap`](fmm_model::Restoring::gap)).
    #[must_use]
    pub fn with_gap(self) -> Self {
        self.with(Term::Gap)
    }

    /// The same with a spring that hardens or softens, F = k (x + k₃ x³)
    /// ([`Restoring::Polynomial`](fmm_model::Restoring)).
    #[must_use]
    pub fn with_cubic_spring(self) -> Self {
        self.with(Term::CubicSpring)
    }

    /// The same with a term k₅ x⁵ in the spring.
    #[must_use]
    pub fn with_quintic_spring(self) -> Self {
        self.with(Term::QuinticSpring)
    }

    /// The same with friction that changes during the record:
    ///
    /// ```text
    /// N exp(w τ) / ⟨exp(w τ)⟩ in the place of N,     τ = t − ⟨t⟩
    /// ```
    ///
    /// with ⟨ ⟩ the mean over the path slid, so that the levels are those in that mean. It changes all that the law
    /// gives; a viscous part that shall stay is a linear damping beside the law. For laws of the sliding speed.
    #[must_use]
    pub fn with_change(self) -> Self {
        self.with(Term::Change)
    }

    /// The same with friction whose change slows down at a rate r, such as while a contact warms: w (1 − exp(−r τ))/r
    /// in the exponent.
    #[must_use]
    pub fn with_curved_change(self) -> Self {
        self.with(Term::CurvedChange)
    }

    /// The same with friction that depends on the position, as where a flexure presses the contact while it deflects:
    ///
    /// ```text
    /// N (1 + β (x² − ⟨x²⟩)) in the place of N
    /// ```
    ///
    /// with ⟨ ⟩ the mean over the path slid, so that the levels are those in that mean. For laws of the sliding speed.
    #[must_use]
    pub fn with_friction_over_position(self) -> Self {
        self.with(Term::Position)
    }

    /// The same with damping that may come out negative. A negative damper is no damper; it says that the law lacks
    /// friction that falls with speed.
    #[must_use]
    pub fn with_damping_of_any_sign(self) -> Self {
        Self { any_sign: true, ..self }
    }

    /// The same with a delay of a force behind its motion of at most `longest` (s), positive or negative.
    pub(crate) fn with_delay_up_to(self, longest: f64) -> Self {
        Self { longest_delay: Some(longest), ..self.with(Term::Delay) }
    }

    /// Refuses a term that a vibration does not have.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`].
    pub(crate) fn require_vibration(&self) -> Result<(), IdentifyError> {
        match self.iter().filter(|term| term.is_of_forces_alone()).find_map(Term::name) {
            None => Ok(()),
            Some(name) => Err(IdentifyError::contradiction(format!(
                "{name} is a term of a force along a motion; leave it out of a law of vibrations"
            ))),
        }
    }

    /// Refuses a term that a force along a motion does not have.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`].
    pub(crate) fn require_force(&self) -> Result<(), IdentifyError> {
        if self.has_spring() {
            return Err(IdentifyError::contradiction(
                "a spring that is not linear is a term of free vibrations; a force along a motion takes the term \
                 stiffness",
            ));
        }
        if self.has(Term::Change) || self.has(Term::Position) {
            return Err(IdentifyError::contradiction(
                "a friction that changes during the record or over the position is a term of vibrations; cut a force \
                 along a motion into parts",
            ));
        }
        if self.has(Term::PowerDamping) {
            return Err(IdentifyError::contradiction(
                "damping with a free power is a term of free vibrations; a force along a motion takes the law \
                 power_law",
            ));
        }
        Ok(())
    }

    /// The same with the fitted parameter called `name` fixed at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the value is not finite. A name that no parameter has is refused by the fit.
    pub fn holding(mut self, name: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((name.into(), value));
        Ok(self)
    }

    /// No term is fitted, and nothing is fixed.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::NONE
    }

    /// The terms that are fitted, in the order of their parameters.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Term> + '_ {
        Term::ALL.into_iter().filter(|term| self.has(*term))
    }

    /// True if `term` is fitted.
    pub(crate) const fn has(&self, term: Term) -> bool {
        self.has[term as usize]
    }

    /// The place of `term` among those that are fitted; `None` if it is not.
    pub(crate) fn place(&self, term: Term) -> Option<usize> {
        self.iter().position(|fitted| fitted == term)
    }

    /// The terms that are no friction over the speed, the spring and a change during the record, without fixed
    /// parameters.
    pub(crate) fn beside_friction(&self) -> Self {
        let is_beside =
            |term: &Term| term.is_spring() || matches!(term, Term::Change | Term::CurvedChange | Term::Position);
        self.iter().filter(is_beside).fold(Self::NONE, Self::with)
    }

    /// The same without the terms of the spring.
    pub(crate) fn without_spring(mut self) -> Self {
        Term::ALL.into_iter().filter(|term| term.is_spring()).for_each(|term| self.has[term as usize] = false);
        self
    }

    /// The terms of the spring alone.
    pub(crate) fn of_spring(&self) -> Self {
        self.iter().filter(|term| term.is_spring()).fold(Self::NONE, Self::with)
    }

    /// True if a term of the spring is fitted.
    pub(crate) fn has_spring(&self) -> bool {
        self.iter().any(Term::is_spring)
    }

    /// The restoring force that the terms of the spring make of the one that is `known`, by their values.
    ///
    /// # Errors
    /// [`ModelError`] for a value that cannot be.
    pub(crate) fn spring<D: Scalar>(
        &self,
        known: Restoring,
        value: impl Fn(Term) -> Option<D>,
    ) -> Result<Restoring<D>, ModelError> {
        let added = |term: Term, known: f64| value(term).map_or(D::from(known), |fitted| fitted + known);
        let polynomial = |cubic: f64, quintic: f64| {
            Restoring::polynomial(added(Term::CubicSpring, cubic), added(Term::QuinticSpring, quintic))
        };
        match (known, value(Term::Stop), value(Term::StopRatio), value(Term::Gap)) {
            (Restoring::Linear, Some(distance), Some(ratio), _) => Restoring::stop(distance, ratio),
            (Restoring::Linear, _, _, Some(gap)) => Restoring::gap(gap),
            (Restoring::Polynomial { cubic, quintic }, ..) => polynomial(cubic, quintic),
            (Restoring::Linear, ..) if self.has_spring() => polynomial(0.0, 0.0),
            (known, ..) => Ok(known.map(D::from)),
        }
    }

    /// Why the terms of the spring do not go together, or not with the restoring force that is `known`; `None` if they
    /// do.
    pub(crate) fn spring_contradiction(&self, known: Restoring) -> Option<&'static str> {
        let is_bent = self.has(Term::CubicSpring) || self.has(Term::QuinticSpring);
        let kinds = [is_bent, self.has(Term::Stop), self.has(Term::Gap)].into_iter().filter(|has| *has).count();
        match known {
            Restoring::Sine { .. } if kinds > 0 => Some(
                "a pendulum has the sine for its restoring force; leave out the pendulum, or the terms of the spring",
            ),
            Restoring::Polynomial { .. } if self.has(Term::Stop) || self.has(Term::Gap) => {
                Some("the machine has a spring that hardens or softens; leave it out, or the stop or the gap")
            }
            Restoring::Bilinear { .. } if kinds > 0 => {
                Some("the machine has a spring with a stop or a gap; leave it out, or the terms of the spring")
            }
            _ if kinds > 1 => Some("a spring bends, has a stop or has a gap: fit one of these at a time"),
            _ => None,
        }
    }

    /// True if a linear damping is fitted.
    pub const fn has_linear_damping(&self) -> bool {
        self.has(Term::LinearDamping)
    }

    /// Names and values of the parameters that are held.
    pub fn held(&self) -> impl Iterator<Item = (&str, f64)> {
        self.held.iter().map(|(name, value)| (name.as_str(), *value))
    }

    /// Bounds of the damping.
    pub(crate) const fn damping_bounds(&self) -> Bounds {
        if self.any_sign { Bounds::UNBOUNDED } else { Bounds::NOT_NEGATIVE }
    }

    /// The parameters of the terms of a vibration, for positions in units of `position`.
    pub(crate) fn parameters(&self, position: &Unit) -> impl Iterator<Item = Parameter> {
        self.iter().filter_map(move |term| term.parameter(position, self.damping_bounds()))
    }

    /// The name of `law` with these terms.
    pub(crate) fn name(&self, law: &str) -> String {
        let (of_forces, of_all): (Vec<Term>, Vec<Term>) = self.iter().partition(|term| term.is_of_forces_alone());
        let words = |terms: &[Term]| -> String {
            terms.iter().filter_map(|term| term.name()).flat_map(|word| [" + ", word]).collect()
        };
        let any_sign = self.any_sign && of_all.iter().any(|term| term.is_damping());
        let any_sign = if any_sign { " of any sign" } else { "" };
        let mut name = format!("{law}{}{any_sign}{}", words(&of_all), words(&of_forces));
        for (index, (held, value)) in self.held.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(name, "{} {held} = {value}", if index == 0 { "," } else { " and" });
        }
        name
    }
}
