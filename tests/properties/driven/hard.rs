//! Motions that are decided by what is almost nothing: starts from rest without friction, jumps of the force, branches
//! that begin at constant speed, motions without inertia.

use fmm_friction::{AccelerationCoulomb, Coulomb, ExponentialPair, MakkarDixon, MaxwellSlip, SlidingLaw};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, EventKind, Exact, Excitation, Mode, RungeKutta, Sampling, Scenario, Trajectory};

fn kinds(motion: &Trajectory) -> Vec<(EventKind, Mode)> {
    motion.events().iter().map(|event| (event.kind, event.next)).collect()
}

/// Friction that only slides takes energy and never gives any.
fn friction_takes(motion: &Trajectory, count: usize) {
    for index in 1..count {
        let [before, after] = [index - 1, index].map(|index| motion.work(index).unwrap().friction);
        assert!(before <= after, "friction gave {:e} J back at sample {index}", before - after);
    }
}

/// Where nothing holds and nothing acts, the first force moves: x = r/k (τ − sin ωτ/ω) under a ramp of rate r, and the
/// sum of two waves under a pulse.
#[test]
fn a_motion_begins_from_nothing() {
    let (delay, rate, stiffness, angular) = (0.37, 5.0, 4.0, 2.0f64);
    let start = || {
        let machine = Oscillator::new(1.0, stiffness).unwrap();
        Scenario::new(machine, Coulomb::new(0.0).unwrap(), 1.0).unwrap()
    };
    let sampling = Sampling::uniform(0.1, 21).unwrap();
    let pulse = std::f64::consts::PI / 5.0;
    for (excitation, expected) in [
        (Excitation::ramp(rate), (|t: f64| 5.0 / 4.0 * (t - (2.0 * t).sin() / 2.0)) as fn(f64) -> f64),
        (Excitation::half_sine(rate, pulse), |t: f64| {
            // Driven at Ω = 5 rad/s for half a period; then both zero crossings of the force swing on.
            let forced = |t: f64| 5.0 / (4.0 - 25.0) * ((5.0 * t).sin() - 2.5 * (2.0 * t).sin());
            if t < std::f64::consts::PI / 5.0 {
                forced(t)
            } else {
                let end = std::f64::consts::PI / 5.0;
                let speed = 5.0 / (4.0 - 25.0) * (5.0 * (5.0 * end).cos() - 5.0 * (2.0 * end).cos());
                forced(end) * (2.0 * (t - end)).cos() + speed / 2.0 * (2.0 * (t - end)).sin()
            }
        }),
    ] {
        let scenario = start().driven_by(excitation.and_then(|excitation| excitation.delayed(delay)).unwrap());
        let motions = [Exact.run(&scenario, &sampling), RungeKutta::default().run(&scenario, &sampling)];
        for motion in motions.map(Result::unwrap) {
            for index in 0..sampling.count() {
                let time = sampling.time(index) - delay;
                let expected = if time > 0.0 { expected(time) } else { 0.0 };
                let got = motion.position().values()[index];
                // The motion is of the size of 1 m.
                assert!((got - expected).abs() < 1e-13, "{} at {time} s: {got} m, not {expected} m", motion.engine());
            }
        }
    }
    assert_eq!(angular * angular, stiffness);
}

/// A record of a force that ends in the middle of a slip: the branch of the law changes with the jump, on either
/// engine, and whether the lower or the higher level belongs to growing speed.
#[test]
fn the_force_may_jump_while_a_branch_lasts() {
    for (gaining, losing) in [(1.1, 1.6), (1.6, 1.1), (1.1, 1.1)] {
        let machine = Oscillator::new(0.2, 3.0).unwrap();
        let law = AccelerationCoulomb::new(gaining, losing).unwrap();
        for end in [0.03, 0.05, 0.1] {
            let force = Excitation::sampled_force(end, vec![2.0, 1.9]).unwrap();
            let scenario = Scenario::new(machine, law, 1.0).unwrap().driven_by(force);
            let sampling = Sampling::uniform(0.005, 100).unwrap().with_work();
            let exact = Exact.run(&scenario, &sampling).unwrap();
            let stepped = RungeKutta::default().run(&scenario, &sampling).unwrap();
            let event = exact.events()[1];
            assert_eq!((event.time, event.kind), (end, EventKind::BranchChange), "{:?}", exact.events());
            assert!(matches!(event.next, Mode::Losing(_)), "{event:?}");
            assert_eq!(kinds(&stepped), kinds(&exact), "μ₁ = {gaining}, μ₂ = {losing}, until {end} s");
            friction_takes(&exact, sampling.count());
            friction_takes(&stepped, sampling.count());
        }
    }
}

/// Two waves by which the first engine once went from constant to growing speed and back for ever, by rounding.
#[test]
fn a_branch_that_begins_at_constant_speed_ends() {
    let damping = Damping::linear(0.001_578_833_990_106_543_6).unwrap();
    let machine = Oscillator::new(0.002_650_279_694_124_586, 5_365.845_768_545_583).unwrap().with_damping(damping);
    let law = AccelerationCoulomb::new(0.000_756_802_141_198_357_5, 0.000_404_539_634_122_678_83).unwrap();
    let scenario = Scenario::new(machine, law, 119.158_935_195_980_26)
        .and_then(|scenario| scenario.starting_at(1.507_968_410_055_262e-6, 0.0))
        .unwrap()
        .driven_by(
            Excitation::harmonic(-0.190_731_305_190_741_66, 293.546_647_720_034, -3.165_293_157_995_491).unwrap(),
        )
        .driven_by(
            Excitation::harmonic(0.022_065_893_061_864_673, 6_983.171_251_750_328, 0.109_101_242_750_054_62).unwrap(),
        );
    let sampling = Sampling::uniform(1e-3, 10).unwrap().with_work();
    let exact = Exact.run(&scenario, &sampling).unwrap();
    let stepped = RungeKutta::default().run(&scenario, &sampling).unwrap();
    assert_eq!(kinds(&exact), kinds(&stepped));
    friction_takes(&exact, sampling.count());
}

/// The branches of an exponential pair meet at large speed, where the phase of constant speed between them lasts no
/// time.
#[test]
fn branches_that_meet_leave_no_speed_to_keep() {
    let machine = Oscillator::new(0.0056, 4.6).unwrap();
    let law = ExponentialPair::new(0.02, 0.02, 1.1, 2.1).unwrap();
    let scenario = Scenario::new(machine, law, 4.6)
        .and_then(|scenario| scenario.starting_at(-0.416, 8.09))
        .unwrap()
        .driven_by(Excitation::ramp(-40.4).unwrap())
        .driven_by(Excitation::belt(-0.88).unwrap());
    let sampling = Sampling::uniform(0.36 / 24.0, 25).unwrap().with_work();
    friction_takes(&RungeKutta::default().run(&scenario, &sampling).unwrap(), sampling.count());
}

/// A contact that creeps, its friction being that of a stiff damper, comes to no stop and turns round nowhere: the
/// first step of a machine a hundred times slower must not see one.
#[test]
fn a_creeping_contact_has_no_events() {
    let machine = Oscillator::new(0.094, 0.116).unwrap();
    let law = MakkarDixon::five(2.7e-7, 1.05e7, 2.5e6, 2.3e-7, 1.05e7).unwrap();
    let (load, start) = (2.8, 4e-6);
    let scenario = Scenario::new(machine, law, load).unwrap().starting_at(start, 0.0).unwrap();
    let sampling = Sampling::uniform(0.25, 25).unwrap();
    let motion = RungeKutta::default().run(&scenario, &sampling).unwrap();
    assert_eq!(motion.events().len(), 1, "{:?}", motion.events());
    // Without inertia k x = N μ(v), with a slope of N μ′(0): slower than that while μ bends, to first order in v γ.
    let slope = load * law.coefficient(1e-12) / 1e-12;
    let expected = start * (-0.116 / slope * sampling.end()).exp();
    let got = motion.position().values()[24];
    assert!((got / expected - 1.0).abs() < 0.02, "{got} m, not {expected} m");
}

/// Pulses that begin together at rest cancel in part: the elements follow what is left.
#[test]
fn elements_follow_the_stronger_of_two_pulses() {
    let machine = Oscillator::new(0.138, 321.0).unwrap().with_damping(Damping::linear(15.4).unwrap());
    let law = || MaxwellSlip::new(&[(7.56, 1.34e-5), (17.8, 1.02e-5), (0.675, 1.23e-5)]).unwrap();
    for (first, second, sign) in [(-0.27, 0.19, 1.0), (0.27, -0.19, -1.0)] {
        let scenario = Scenario::new(machine, law(), 515.0)
            .unwrap()
            .driven_by(Excitation::half_sine(first, 0.08).unwrap())
            .driven_by(Excitation::half_sine(second, 0.0238).unwrap());
        let motion = Exact.run(&scenario, &Sampling::uniform(1e-4, 2).unwrap()).unwrap();
        // The slopes, 0.27/80 ms against 0.19/23.8 ms, decide: the shorter pulse wins.
        let got = motion.position().values()[1];
        assert!(got * sign > 0.0 && motion.events().len() < 20, "{got} m, {} events", motion.events().len());
    }
}
