//! Properties of every bristle law, at random parameters.

use fmm_model::Scalar;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::sliding::{log_uniform, random, rounding, values};
use crate::law::{BristleLaw, FeedForward, LawError, LawFamily, Regime, SlidingLaw};
use crate::laws::{BoucWen, Dahl, Gms, LuGre, MaxwellSlip, Stribeck};

fn rate<L: BristleLaw<f64>>(law: &L, velocity: f64, state: &[f64], regime: Regime) -> Vec<f64> {
    let mut rate = vec![0.0; law.states()];
    law.rate(velocity, state, regime, &mut rate);
    rate
}

fn is_odd<L: BristleLaw<f64>>(law: &L, velocity: f64, state: &[f64], regime: Regime) {
    let mirrored: Vec<f64> = state.iter().map(|z| -z).collect();
    let (one, other) = (rate(law, velocity, state, regime), rate(law, -velocity, &mirrored, regime));
    for (one, other) in one.iter().zip(&other) {
        assert!(one.is_finite());
        assert_eq!(*one, -other, "at {velocity} m/s, {state:?}");
    }
    let coefficient = law.coefficient(velocity, state, &one);
    assert_eq!(coefficient, -law.coefficient(-velocity, &mirrored, &other), "at {velocity} m/s, {state:?}");
}

fn random_state<L: BristleLaw<f64>>(random: &mut ChaCha8Rng, law: &L) -> Vec<f64> {
    (0..law.states()).map(|i| random.random_range(-0.99..0.99) * law.bound(i)).collect()
}

/// At the walls of the box the state moves inwards or along them; a rounding of the bound is left to it.
fn one_state<F>()
where
    F: LawFamily,
    F::At<f64>: BristleLaw<f64>,
{
    let mut random = random(11);
    for _ in 0..400 {
        let values = values::<F>(&mut random);
        let law = F::at(&values).unwrap();
        let velocity = log_uniform(&mut random, -6.0, 1.0);
        let state = random_state(&mut random, &law);
        is_odd(&law, velocity, &state, Regime::ALL_HOLD);
        let bound = law.bound(0);
        let free = rate(&law, velocity, &[0.0], Regime::ALL_HOLD)[0];
        let at_wall = rate(&law, velocity, &[bound], Regime::ALL_HOLD)[0];
        let beyond = rate(&law, velocity, &[1.01 * bound], Regime::ALL_HOLD)[0];
        let what = format!("{} {values:?} at {velocity} m/s", F::NAME);
        assert!(free > 0.0 && beyond < 0.0, "{what}: {free} at no deflection, {beyond} beyond the bound");
        // Powers magnify the rounding of the bound by their exponent, and by 1/exponent if it is below 1.
        assert!(at_wall <= 1e-6 * free, "{what}: {at_wall} m/s outwards at the bound");
        assert!(rate(&law, -velocity, &[bound], Regime::ALL_HOLD)[0] < 0.0, "{what}");
    }
}

#[test]
fn one_state_laws_are_odd_and_stay_in_their_box() {
    one_state::<LuGre>();
    one_state::<BoucWen>();
}

/// Dahl's exponent may be any positive number; those below 0.3 bend later than f64 can tell from the bound.
#[test]
fn dahl_is_odd_and_stays_in_its_box() {
    let mut random = random(12);
    for _ in 0..400 {
        let (mu, sigma) = (log_uniform(&mut random, -3.0, 0.5), log_uniform(&mut random, 2.0, 6.0));
        let law = Dahl::new(mu, sigma, random.random_range(0.3..4.0)).unwrap();
        let velocity = log_uniform(&mut random, -6.0, 1.0);
        let state = random_state(&mut random, &law);
        is_odd(&law, velocity, &state, Regime::ALL_HOLD);
        assert!(rate(&law, velocity, &[1.001 * law.bound(0)], Regime::ALL_HOLD)[0] < 0.0, "{law:?}");
        assert!(rate(&law, velocity, &state, Regime::ALL_HOLD)[0] > 0.0, "{law:?}");
    }
}

#[test]
fn steady_states_are_reached_and_are_steady() {
    let mut random = random(13);
    for _ in 0..400 {
        let lugre = LuGre::at(&values::<LuGre>(&mut random)).unwrap();
        let speed = log_uniform(&mut random, -6.0, 1.0);
        let level = lugre.steady().dry_coefficient(speed);
        let deflection = level / lugre.values()[4];
        let still = rate(&lugre, speed, &[deflection], Regime::ALL_HOLD);
        assert!(still[0].abs() <= rounding(speed), "{lugre:?}: {} m/s", still[0]);
        let coefficient = lugre.coefficient(speed, &[deflection], &[0.0]);
        let steady = lugre.steady_coefficient(speed).unwrap();
        assert!((coefficient - steady).abs() <= rounding(steady), "{lugre:?}: {coefficient} against {steady}");
    }
}

/// With equal levels and no damping LuGre is Dahl with i = 1; Dahl is Bouc-Wen with n = A = 1, γ = 0, β = σ/μ.
#[test]
fn limits_between_the_bristles() {
    let mut random = random(14);
    for _ in 0..400 {
        let (mu, sigma) = (log_uniform(&mut random, -3.0, 0.5), log_uniform(&mut random, 2.0, 6.0));
        let dahl = Dahl::new(mu, sigma, 1.0).unwrap();
        let lugre = LuGre::new(mu, mu, 0.01, 2.0, sigma, 0.0, 0.0).unwrap();
        let bouc_wen = BoucWen::new(sigma, 1.0, sigma / mu, 0.0, 1.0).unwrap();
        let steady = [dahl.steady_coefficient(1.0), lugre.steady_coefficient(1.0), bouc_wen.steady_coefficient(1.0)];
        assert!(steady.iter().flatten().all(|steady| (steady - mu).abs() <= 1e-15 * mu), "{steady:?} of {mu}");
        let velocity = log_uniform(&mut random, -6.0, 1.0) * if random.random_range(0..2) == 0 { -1.0 } else { 1.0 };
        let state = random_state(&mut random, &dahl);
        let expected = rate(&dahl, velocity, &state, Regime::ALL_HOLD)[0];
        assert_eq!(rate(&lugre, velocity, &state, Regime::ALL_HOLD)[0], expected, "{lugre:?}");
        let got = rate(&bouc_wen, velocity, &state, Regime::ALL_HOLD)[0];
        assert!((got - expected).abs() <= rounding(velocity.abs()), "{bouc_wen:?}: {got} against {expected} m/s");
        for coefficient in [lugre.coefficient(velocity, &state, &[0.0]), bouc_wen.coefficient(velocity, &state, &[0.0])]
        {
            assert_eq!(coefficient, dahl.coefficient(velocity, &state, &[0.0]));
        }
        let bounds = [dahl.bound(0), lugre.bound(0), bouc_wen.bound(0)];
        assert!((bounds[2] - bounds[0]).abs() <= rounding(bounds[0]) && bounds[1] == bounds[0], "{bounds:?} m");
    }
}

/// Carries a law with elements along a path at constant speed by small steps, switching as its trait says.
fn march<L: BristleLaw<f64>>(law: &L, state: &mut [f64], velocity: f64, duration: f64, steps: u32) -> Regime {
    let mut regime = Regime::ALL_HOLD;
    let step = duration / f64::from(steps);
    for _ in 0..steps {
        for index in 0..law.states() {
            if law.reserve(index, velocity, state).unwrap() <= 0.0 {
                regime = regime.sliding(index);
            }
        }
        let rate = rate(law, velocity, state, regime);
        for (state, rate) in state.iter_mut().zip(rate) {
            *state += step * rate;
        }
    }
    regime
}

fn elements(random: &mut ChaCha8Rng, count: usize) -> Vec<(f64, f64)> {
    (0..count).map(|_| (log_uniform(random, 3.0, 5.0), log_uniform(random, -2.0, 0.0))).collect()
}

#[test]
fn elements_slide_at_their_own_level_and_stay_in_their_box() {
    let mut random = random(15);
    for count in [1, 2, 5, 64] {
        let pairs = elements(&mut random, count);
        let law = MaxwellSlip::new(&pairs).unwrap();
        let mut marched = vec![0.0; count];
        let mut exact = marched.clone();
        for _ in 0..20 {
            // Steps of 1e-4 of the path overshoot a level by as much.
            let (path, velocity) = (log_uniform(&mut random, -6.0, -3.0), log_uniform(&mut random, -4.0, 0.0));
            let velocity = if random.random_range(0..2) == 0 { -velocity } else { velocity };
            march(&law, &mut marched, velocity, path / velocity.abs(), 10_000);
            law.deflect(&mut exact, path * velocity.signum());
            is_odd(&law, velocity, &exact, Regime::ALL_HOLD.sliding(0));
            for (index, (one, other)) in marched.iter().zip(&exact).enumerate() {
                assert!((one - other).abs() < 2e-3 * 1e-3, "element {index}: {one} m against {other} m");
                assert!(other.abs() <= law.bound(index), "element {index} at {other} m");
            }
            marched.clone_from(&exact);
        }
    }
}

#[test]
fn monotone_paths_of_elements_add_up() {
    let mut random = random(16);
    let law = MaxwellSlip::new(&elements(&mut random, 7)).unwrap();
    for _ in 0..500 {
        let mut once = random_state(&mut random, &law);
        let mut twice = once.clone();
        let (one, other) = (random.random_range(0.0..1e-4), random.random_range(0.0..1e-4));
        law.deflect(&mut once, one + other);
        law.deflect(&mut twice, one);
        law.deflect(&mut twice, other);
        for (index, (one, other)) in once.iter().zip(&twice).enumerate() {
            assert!((one - other).abs() <= rounding(law.bound(index) + 2e-4), "{one} m against {other} m");
        }
    }
}

#[test]
fn generalised_elements_share_the_stribeck_curve() {
    let mut random = random(17);
    for _ in 0..20 {
        let curve = Stribeck::at(&values::<Stribeck>(&mut random)).unwrap();
        let mut pairs = elements(&mut random, 4);
        let sum: f64 = pairs.iter().map(|(_, share)| share).sum();
        for pair in &mut pairs {
            pair.1 /= sum;
        }
        let attraction = log_uniform(&mut random, 0.0, 2.0);
        let law = Gms::new(curve, attraction, &pairs).unwrap();
        let mut state = random_state(&mut random, &law);
        let velocity = log_uniform(&mut random, -3.0, 0.0);
        is_odd(&law, velocity, &state, Regime::ALL_HOLD.sliding(2));
        // Long enough to slide in all elements by any path, and then for 40 time constants s/C of the approach.
        let level = law.steady().dry_coefficient(velocity);
        let least = pairs.iter().map(|pair| pair.0).fold(f64::INFINITY, f64::min);
        march(&law, &mut state, velocity, 2.0 * curve.breakaway() / (least * velocity), 100_000);
        for (index, part) in state.iter().enumerate() {
            assert!(part.abs() <= law.bound(index) * 1.01, "element {index} at {part}");
        }
        let regime = march(&law, &mut state, velocity, 40.0 * level / attraction, 1000);
        for (index, (_, share)) in pairs.iter().enumerate() {
            assert!((state[index] - share * level).abs() < 1e-9 * level, "element {index} at {}", state[index]);
            assert!(regime.slides(index) || law.reserve(index, velocity, &state).unwrap() > -rounding(level));
        }
        let (coefficient, steady) = (law.coefficient(velocity, &state, &[0.0; 4]), curve.coefficient(velocity));
        assert!((coefficient - steady).abs() < 1e-8 * steady, "{coefficient} against {steady}");
        let held = rate(&law, -velocity, &state, Regime::ALL_HOLD);
        assert!(held.iter().zip(&pairs).all(|(rate, (stiffness, _))| *rate == -stiffness * velocity), "{held:?}");
    }
}

/// Derivatives of the rate in state and velocity, against central differences: 1e-10 of the size of the terms.
#[test]
fn rates_have_their_derivatives() {
    type Gradient = fmm_model::Dual<2>;
    fn check<F: LawFamily>()
    where
        F::At<f64>: BristleLaw<f64>,
        F::At<Gradient>: BristleLaw<Gradient>,
    {
        let mut random = random(18);
        for _ in 0..200 {
            let values = values::<F>(&mut random);
            let law = F::at(&values).unwrap();
            let dual = F::at(&values.iter().map(|value| Gradient::from(*value)).collect::<Vec<_>>()).unwrap();
            let (velocity, state) = (log_uniform(&mut random, -3.0, 0.0), random_state(&mut random, &law)[0] * 0.9);
            let mut gradient = [Gradient::from(0.0)];
            let (v, z) = (Gradient::variable(velocity, 0), Gradient::variable(state, 1));
            dual.rate(v, &[z], Regime::ALL_HOLD, &mut gradient);
            let at = |velocity: f64, state: f64| rate(&law, velocity, &[state], Regime::ALL_HOLD)[0];
            assert_eq!(gradient[0].value(), at(velocity, state), "{} {values:?}", F::NAME);
            for (direction, (dv, dz)) in [(1e-5 * velocity, 0.0), (0.0, 1e-5 * state.abs())].into_iter().enumerate() {
                let step = dv + dz;
                let slope = (at(velocity + dv, state + dz) - at(velocity - dv, state - dz)) / (2.0 * step);
                let exact = gradient[0].partial(direction);
                let bound = 1e-5 * exact.abs() + 1e-8 * velocity / step * 1e-5;
                assert!((slope - exact).abs() <= bound, "{} {values:?}: {slope} against {exact}", F::NAME);
            }
        }
    }
    check::<LuGre>();
    check::<BoucWen>();
    check::<Dahl>();
}

/// Velocities (m/s) of a motion to and fro that rests at times, each held for 1 ms.
fn velocities() -> impl Iterator<Item = f64> {
    (0..60).map(|step| {
        let velocity = 3e-3 * (0.4 * f64::from(step)).sin() + 1e-3 * (1.7 * f64::from(step)).cos();
        if step % 7 == 3 { 0.0 } else { velocity }
    })
}

/// Steps in closed form against marching in small ones, which see an element slide too late by up to one of 2000; and a
/// step in two parts.
fn is_followed<L: BristleLaw<f64> + Clone, const N: usize>(law: &L, what: &str) {
    let mut followed = FeedForward::new(law.clone(), [0.0; N]).unwrap();
    let mut halved = FeedForward::new(law.clone(), [0.0; N]).unwrap();
    let (mut marched, mut regime, mut before) = ([0.0; N], Regime::ALL_HOLD, 0.0);
    let most: f64 = (0..N).map(|index| law.bound(index)).sum();
    for velocity in velocities() {
        let coefficient = followed.step(velocity, 1e-3).unwrap();
        halved.step(velocity, 3e-4).unwrap();
        let twice = halved.step(velocity, 7e-4).unwrap();
        assert!((coefficient - twice).abs() < 1e-13, "{what}: {coefficient} and {twice} at {velocity} m/s");
        if velocity * before <= 0.0 {
            regime = Regime::ALL_HOLD;
        }
        before = velocity;
        for _ in 0..2000 {
            for index in 0..N {
                if velocity != 0.0 && law.reserve(index, velocity, &marched).is_some_and(|reserve| reserve <= 0.0) {
                    regime = regime.sliding(index);
                }
            }
            let rates = rate(law, velocity, &marched, regime);
            // The midpoint, which is of second order.
            let middle: Vec<f64> = marched.iter().zip(&rates).map(|(state, rate)| state + 0.25e-6 * rate).collect();
            let rates = rate(law, velocity, &middle, regime);
            marched.iter_mut().zip(rates).for_each(|(state, rate)| *state += 0.5e-6 * rate);
        }
        for (index, (state, expected)) in followed.state().iter().zip(marched).enumerate() {
            let off = (state - expected).abs();
            assert!(off < 1e-3 * most, "{what}, state {index}: {state} instead of {expected} at {velocity} m/s");
        }
        let rates = rate(law, velocity, followed.state(), followed.regime());
        assert_eq!(coefficient, law.coefficient(velocity, followed.state(), &rates), "{what}");
    }
}

#[test]
fn laws_are_followed_step_by_step() {
    let curve = Stribeck::new(0.2, 0.3, 2e-3, 2.0, 0.5).unwrap();
    is_followed::<_, 1>(&LuGre::new(0.2, 0.3, 2e-3, 2.0, 1e5, 300.0, 0.5).unwrap(), "LuGre");
    for exponent in [0.5, 1.0, 2.0] {
        is_followed::<_, 1>(&Dahl::new(0.3, 1e5, exponent).unwrap(), "Dahl");
    }
    is_followed::<_, 2>(&MaxwellSlip::new(&[(1e5, 0.1), (4e4, 0.2)]).unwrap(), "Maxwell slip");
    is_followed::<_, 3>(&Gms::new(curve, 50.0, &[(2e5, 0.2), (1e5, 0.3), (3e4, 0.5)]).unwrap(), "GMS");
}

/// An element of GMS that slides goes on although the level has risen above it; its state alone does not say so.
#[test]
fn elements_that_slide_are_remembered() {
    let curve = Stribeck::new(0.1, 0.3, 1e-3, 2.0, 0.0).unwrap();
    let mut friction = FeedForward::new(Gms::new(curve, 10.0, &[(1e5, 1.0)]).unwrap(), [0.0]).unwrap();
    assert!((friction.step(0.1, 1.0).unwrap() - 0.1).abs() < 1e-15);
    // Towards 0.3 with the time constant s/C = 0.03 s, where one that holds would reach it after 2 µm.
    let slow = friction.step(1e-9, 0.03).unwrap();
    assert!((slow - (0.3 - 0.2 * f64::exp(-1.0))).abs() < 1e-12, "{slow}");
    assert!(friction.regime().slides(0));
    friction.step(0.0, 1.0).unwrap();
    assert!(!friction.regime().slides(0));
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let dahl = Dahl::new(0.3, 1e5, 1.0).unwrap();
    assert!(matches!(FeedForward::new(dahl, [0.0, 0.0]), Err(LawError::WrongCount { got: 2, .. })));
    for state in [4e-6, f64::NAN] {
        assert!(matches!(FeedForward::new(dahl, [state]), Err(LawError::OutOfBounds { .. })));
    }
    let loops = BoucWen::new(1e5, 1.0, 1e5, 0.0, 1.0).unwrap();
    assert!(matches!(FeedForward::new(loops, [0.0]), Err(LawError::Contradiction { .. })));
    let mut friction = FeedForward::new(dahl, [1e-6]).unwrap();
    for (velocity, duration) in [(f64::NAN, 1e-3), (f64::INFINITY, 1e-3), (1e-3, f64::NAN), (1e-3, -1e-3)] {
        assert_eq!(friction.step(velocity, duration), None, "{velocity} m/s, {duration} s");
    }
    assert_eq!(friction.state(), &[1e-6]);
    assert_eq!(friction.step(0.0, 1.0), Some(1e5 * 1e-6));
}
