//! Levels of friction at fixed speeds, as a law of the sliding speed.

use fmm_friction::{LawError, LawFamily, LawParameter, LawVisitor, Role, SlidingLaw};
use fmm_model::{Bounds, Parameter, Scalar};

/// Number of levels. With frequency, initial position and velocity they are three groups of derivatives.
pub(super) const LEVELS: usize = 15;

/// Speeds of the levels over the top speed (1): 0.05 (21^(i/14) − 1), equal steps of ln(1 + s/0.05), rounded.
pub(super) const KNOTS: [f64; LEVELS] =
    [0.0, 0.012, 0.027, 0.046, 0.069, 0.098, 0.134, 0.179, 0.235, 0.304, 0.390, 0.497, 0.630, 0.795, 1.0];

/// Name of the parameter that fixes the top speed.
pub(super) const TOP_SPEED: &str = "top_speed";

/// Place of the static level among the parameters, behind the levels and the top speed.
pub(super) const STATIC: usize = LEVELS + 1;

/// Friction over the speed through [`LEVELS`] levels: a cubic between each two knots, with the slope at a knot that the
/// parabola through its neighbours has. At rest a static level holds the contact, which lies at level 0 or above. Above
/// the top speed the last slope goes on.
///
/// ```text
/// F(v) = c₀ + c₁ h + c₂ h² + c₃ h³,   h = v − v_i,   v_i = s_i v_top
/// ```
///
/// All coefficients are linear in the levels.
#[derive(Debug, Clone)]
pub(super) struct Levels<D = f64> {
    /// c₀ to c₃ from each knot on.
    pieces: [[D; 4]; LEVELS],
    top: f64,
    breakaway: D,
}

impl<D: Scalar> Levels<D> {
    /// The curve through `levels`, of which the last belongs to the speed `top`.
    pub(super) fn new(levels: &[D; LEVELS], top: f64) -> Self {
        let chord = |i: usize| -> (D, f64) {
            ((levels[i + 1] - levels[i]) / (top * (KNOTS[i + 1] - KNOTS[i])), KNOTS[i + 1] - KNOTS[i])
        };
        let slope = |i: usize| -> D {
            match i {
                0 => chord(0).0,
                _ if i == LEVELS - 1 => chord(i - 1).0,
                _ => {
                    let ((below, a), (above, b)) = (chord(i - 1), chord(i));
                    below * (b / (a + b)) + above * (a / (a + b))
                }
            }
        };
        let pieces = std::array::from_fn(|i| {
            if i == LEVELS - 1 {
                return [levels[i], slope(i), D::from(0.0), D::from(0.0)];
            }
            let ((chord, width), first, last) = (chord(i), slope(i), slope(i + 1));
            let h = width * top;
            [levels[i], first, (chord * 3.0 - first * 2.0 - last) / h, (first + last - chord * 2.0) / (h * h)]
        });
        Self { pieces, top, breakaway: levels[0] }
    }
}

/// The weight of each level in the friction at `speed` over the top speed (1).
pub(super) fn weights(speed: f64) -> [f64; LEVELS] {
    std::array::from_fn(|i| {
        let unit: [f64; LEVELS] = std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 });
        Levels::new(&unit, 1.0).coefficient(speed)
    })
}

impl<D: Scalar> SlidingLaw<D> for Levels<D> {
    fn coefficient(&self, speed: D) -> D {
        let relative = speed.value() / self.top;
        let piece = KNOTS[1..].iter().take_while(|knot| relative > **knot).count();
        let h = speed - KNOTS[piece] * self.top;
        let [c0, c1, c2, c3] = self.pieces[piece];
        ((c3 * h + c2) * h + c1) * h + c0
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

macro_rules! level {
    ($($name:literal),*) => {
        [$(LawParameter::new(Parameter::new($name, $name, "1").bounded(Bounds::NOT_NEGATIVE), Role::Level),)*
         LawParameter::new(Parameter::new(TOP_SPEED, "v_top", "m/s").bounded(Bounds::POSITIVE), Role::Shape),
         LawParameter::new(
             Parameter::new("static_level", "static_level", "1").bounded(Bounds::NOT_NEGATIVE),
             Role::Breakaway,
         )]
    };
}

impl LawFamily for Levels {
    const NAME: &'static str = "friction_curve";
    const PARAMETERS: &'static [LawParameter] = &level!(
        "level_0", "level_1", "level_2", "level_3", "level_4", "level_5", "level_6", "level_7", "level_8", "level_9",
        "level_10", "level_11", "level_12", "level_13", "level_14"
    );
    type At<D: Scalar> = Levels<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Levels<D>, LawError> {
        let values: [D; STATIC + 1] = Self::checked(values)?;
        let levels = Levels::new(&std::array::from_fn(|i| values[i]), values[LEVELS].value());
        Ok(Levels { breakaway: values[STATIC], ..levels })
    }

    fn visit<D: Scalar, V: LawVisitor<D, Levels<D>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight lines are followed exactly, above the top speed as well, and parabolas but for the ends.
    #[test]
    fn lines_are_followed_exactly_and_smooth_curves_closely() {
        let of = |curve: &dyn Fn(f64) -> f64| Levels::new(&KNOTS.map(|s| curve(2.0 * s)), 2.0);
        let line = of(&|v| 3.0 - 0.4 * v);
        for speed in [0.0, 0.01, 0.3, 1.0, 1.9, 2.3] {
            assert!((line.coefficient(speed) - (3.0 - 0.4 * speed)).abs() < 1e-14);
        }
        let parabola = of(&|v| 1.0 + v * v);
        for speed in [0.03, 0.3, 0.8, 1.4] {
            assert!((parabola.coefficient(speed) - (1.0 + speed * speed)).abs() < 1e-13);
        }
        assert_eq!(line.breakaway(), 3.0);
    }

    #[test]
    fn weights_of_a_speed_sum_to_one() {
        for speed in [0.0, 0.02, 0.5, 0.77, 1.0, 1.1] {
            assert!((weights(speed).iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert!((weights(KNOTS[4])[4] - 1.0).abs() < 1e-14);
    }
}
