//! Friction along motions that are given.

use fmm_friction::{Dahl, LuGre, MaxwellSlip};
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_sim::{
    Bristle, Engine, FrictionPoint, PrescribedMotion, Sampling, Scenario, SimulationError, State, friction_along,
};

const LEVEL: f64 = 2.0;
const STIFFNESS: f64 = 4e4;

/// Dahl's law with i = 1 under 10 N: μ N = 2 N, σ N = 40 kN/m.
fn dahl<D: Scalar>() -> Dahl<D> {
    Dahl::new(D::from(0.1 * LEVEL), D::from(0.1 * STIFFNESS), D::from(1.0)).unwrap()
}

/// Force (N) after a way of `distance` (m) in direction `sign` from the force `before`.
fn after(before: f64, sign: f64, distance: f64) -> f64 {
    let end = sign * LEVEL;
    end + (before - end) * (-STIFFNESS * distance / LEVEL).exp()
}

/// x = (t − t²) · 0.4 mm turns at 0.1 mm, within the only leg; a rest and a jump of the velocity follow.
#[test]
fn a_motion_may_turn_rest_and_jump() {
    let state = |position: f64, velocity: f64| State { position, velocity };
    let states =
        [state(0.0, 4e-4), state(0.0, -4e-4), state(0.0, 0.0), state(0.0, 0.0), state(0.0, 1e-3), state(1e-4, 1e-3)];
    let path = PrescribedMotion::through(&[0.0, 1.0, 1.0, 2.0, 2.0, 2.1], &states).unwrap();
    let points = friction_along(&dahl(), 10.0, &path).unwrap();
    let back = after(after(0.0, 1.0, 1e-4), -1.0, 1e-4);
    let expected = [0.0, back, back, back, back, after(back, 1.0, 1e-4)];
    for ((point, force), state) in points.iter().zip(expected).zip(states) {
        assert!((point.force - force).abs() < 1e-11, "{} instead of {force} N", point.force);
        assert_eq!(point.position, state.position);
    }
}

/// A motion that begins from rest goes where its acceleration says, and one at constant speed is a straight line.
#[test]
fn starts_from_rest_and_straight_lines() {
    let state = |position: f64, velocity: f64| State { position, velocity };
    let path = PrescribedMotion::through(&[0.0, 1.0], &[state(0.0, 0.0), state(-1e-4, -2e-4)]).unwrap();
    let force = friction_along(&dahl(), 10.0, &path).unwrap()[1].force;
    assert!((force - after(0.0, -1.0, 1e-4)).abs() < 1e-11, "{force} N");
    let line = PrescribedMotion::at_speed(&[0.0, 1e-4, 1e-4, -1e-4], 1e-3).unwrap();
    let forces: Vec<f64> = friction_along(&dahl(), 10.0, &line).unwrap().iter().map(|point| point.force).collect();
    let out = after(0.0, 1.0, 1e-4);
    for (got, expected) in forces.iter().zip([0.0, out, out, after(out, -1.0, 2e-4)]) {
        assert!((got - expected).abs() < 1e-12, "{got} instead of {expected} N");
    }
}

/// A contact does along a simulated motion what it has done in that motion.
#[test]
fn a_simulated_motion_has_its_own_bristles() {
    let law = LuGre::new(0.2, 0.3, 0.02, 2.0, 2e3, 1.0, 0.1).unwrap();
    let scenario = Scenario::new(Oscillator::new(10.0, 2000.0).unwrap(), law, 10.0).unwrap();
    let scenario = scenario.starting_at(0.01, 0.0).unwrap();
    let off = |interval: f64| {
        let motion =
            Bristle::default().run(&scenario, &Sampling::uniform(interval, (0.6 / interval) as usize).unwrap());
        let motion = motion.unwrap();
        let states = motion.position().values().iter().zip(motion.velocity().values());
        let states: Vec<_> = states.map(|(&position, &velocity)| State { position, velocity }).collect();
        let times: Vec<f64> = (0..states.len()).map(|index| index as f64 * interval).collect();
        let points = friction_along(&law, 10.0, &PrescribedMotion::through(&times, &states).unwrap()).unwrap();
        let off = |(point, z): (&fmm_sim::FrictionPoint, &f64)| (point.states[0] - z).abs();
        points.iter().zip(motion.states()[0].values()).map(off).fold(0.0, f64::max)
    };
    // Deflections of 0.15 mm; a kink of the acceleration at each reversal, which a cubic does not see.
    let offs = [1e-3, 1e-4].map(off);
    assert!(offs[1] < 1e-9 && offs[1] < 0.1 * offs[0], "{offs:?} m");
}

/// The derivative in the time scale of the motion, and in where it turns.
#[test]
fn motions_have_derivatives() {
    let run = |scale: Dual<2>, reach: Dual<2>| {
        let number = |value: f64| Dual::<2>::from(value);
        let law =
            LuGre::new(number(0.2), number(0.3), number(0.02), number(2.0), number(2e3), number(1.0), number(0.1));
        let state = |x: f64, v: f64| State { position: reach * x, velocity: reach / scale * v };
        let path = PrescribedMotion::through(
            &[number(0.0), scale, scale * 1.5],
            &[state(0.0, 4.0), state(0.0, -4.0), state(0.3, 1.0)],
        );
        friction_along(&law.unwrap(), number(10.0), &path.unwrap()).unwrap()[2].force
    };
    let at = |scale: f64, reach: f64| run(scale.into(), reach.into()).value();
    let force = run(Dual::variable(0.05, 0), Dual::variable(2e-4, 1));
    assert_eq!(force.value(), at(0.05, 2e-4));
    let quotients = [
        (at(0.05 + 1e-6, 2e-4) - at(0.05 - 1e-6, 2e-4)) / 2e-6,
        (at(0.05, 2e-4 + 1e-9) - at(0.05, 2e-4 - 1e-9)) / 2e-9,
    ];
    for (direction, quotient) in quotients.into_iter().enumerate() {
        let slope = force.partial(direction);
        assert!((slope / quotient - 1.0).abs() < 1e-5, "direction {direction}: {slope} against {quotient}");
    }
}

#[test]
fn what_is_no_motion_is_refused() {
    let state = |position: f64| State { position, velocity: 0.0 };
    let times = |times: &[f64], states: &[State]| PrescribedMotion::through(times, states).map(|_| ());
    let second =
        |refused| matches!(refused, Err(SimulationError::OutOfRange { what, .. }) if what.contains("time 1 is"));
    assert!(second(times(&[0.0, 1.0], &[state(0.0)])));
    assert!(matches!(times(&[0.0], &[state(0.0), state(1.0)]), Err(SimulationError::OutOfRange { .. })));
    assert!(second(times(&[0.0, -1.0], &[state(0.0); 2])));
    assert!(times(&[0.0, 0.0], &[state(0.0), state(1.0)]).is_err());
    assert!(times(&[0.0], &[state(f64::NAN)]).is_err());
    assert!(second(PrescribedMotion::lines(&[0.0, 0.0], &[0.0, 1.0]).map(|_| ())));
    assert!(
        PrescribedMotion::at_speed(&[0.0], 0.0).is_err() && PrescribedMotion::at_speed(&[f64::INFINITY], 1.0).is_err()
    );
    let nothing = PrescribedMotion::<f64>::through(&[], &[]).unwrap();
    assert_eq!(friction_along(&dahl(), 1.0, &nothing), Ok(vec![]));
}

/// In closed form or by steps, a motion of straight lines is the same: a path of cubics whose velocities are those of
/// the lines has the same motion and no closed form where a velocity changes a little.
#[test]
fn closed_forms_are_what_steps_find() {
    let times: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i) + 1e-3 * f64::from(i % 3)).collect();
    let positions: Vec<f64> = times.iter().map(|t| 2e-4 * (7.0 * t).sin() + 5e-5 * (31.0 * t).cos()).collect();
    let lines = PrescribedMotion::lines(&times, &positions).unwrap();
    let mut stepped = (vec![0.0], vec![]);
    for (index, (times, positions)) in times.windows(2).zip(positions.windows(2)).enumerate() {
        let velocity = (positions[1] - positions[0]) / (times[1] - times[0]);
        if index == 0 {
            stepped.1.push(State { position: positions[0], velocity });
        } else {
            stepped.0.push(times[0]);
            stepped.1.push(State { position: positions[0], velocity });
        }
        // A point on the line that is off by rounding, so that no leg is one of constant velocity.
        let middle = 0.5 * (times[0] + times[1]);
        let state = State { position: 0.5 * (positions[0] + positions[1]), velocity: velocity * (1.0 + 1e-12) };
        stepped.0.push(middle);
        stepped.1.push(state);
        stepped.0.push(times[1]);
        stepped.1.push(State { position: positions[1], velocity });
    }
    let stepped = PrescribedMotion::through(&stepped.0, &stepped.1).unwrap();
    let same = |one: Vec<FrictionPoint>, other: Vec<FrictionPoint>| {
        let size = one.iter().fold(0.0f64, |size, point| size.max(point.force.abs()));
        let others =
            other.iter().enumerate().filter(|(index, _)| *index == 0 || index % 3 == 2).map(|(_, point)| point);
        for (index, (one, other)) in one.iter().zip(others).enumerate() {
            assert_eq!(one.position, other.position, "{index}");
            assert!((one.force - other.force).abs() < 1e-9 * size, "{index}: {} N, {} N", one.force, other.force);
        }
        assert!(size > 0.1, "{size} N");
    };
    for exponent in [0.6, 1.0, 2.0] {
        let law = Dahl::new(0.2, 2e3, exponent).unwrap();
        same(friction_along(&law, 3.0, &lines).unwrap(), friction_along(&law, 3.0, &stepped).unwrap());
    }
    let law = LuGre::new(0.2, 0.3, 1e-3, 2.0, 2e3, 1.0, 0.1).unwrap();
    same(friction_along(&law, 3.0, &lines).unwrap(), friction_along(&law, 3.0, &stepped).unwrap());
    let law = MaxwellSlip::new(&[(2e3, 0.1), (500.0, 0.1)]).unwrap();
    same(friction_along(&law, 3.0, &lines).unwrap(), friction_along(&law, 3.0, &stepped).unwrap());
}

/// A closed form that leaves the range of numbers is refused as steps are.
#[test]
fn a_force_that_is_not_finite_is_refused() {
    let path = PrescribedMotion::lines(&[0.0, 1.0], &[0.0, 1.0]).unwrap();
    let refused = friction_along(&Dahl::new(1e3, 1e5, 1.0).unwrap(), 1e307, &path);
    assert!(matches!(refused, Err(SimulationError::NotFinite { .. })), "{refused:?}");
}
