//! Closed forms about energies and damping that laws, damping and engines must agree with.

use fmm_friction::{Berger, Coulomb, SlidingLaw};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, Excitation, RungeKutta, Sampling, Scenario, Trajectory, simulate_into};
use serde_json::Value;

use crate::oracle::{number, read};

/// Relative tolerance of the file.
const RELATIVE: f64 = 1e-12;

fn identity(name: &str) -> Value {
    let file = read("identities");
    let entries = file["identities"].as_array().unwrap();
    entries.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("no {name}")).clone()
}

/// Energy (J) that friction takes from one cycle of a harmonic motion of velocity amplitude `peak` (m/s): Simpson's
/// rule on a quarter of the cycle, within which the integrand is smooth.
fn energy_per_cycle(law: &impl SlidingLaw<f64>, load: f64, peak: f64, angular: f64) -> f64 {
    const STEPS: usize = 4000;
    let power = |i: usize| {
        let speed = peak * (std::f64::consts::FRAC_PI_2 * i as f64 / STEPS as f64).cos().max(0.0);
        load * law.coefficient(speed) * speed
    };
    let inner: f64 = (1..STEPS).map(|i| power(i) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    let quarter = std::f64::consts::FRAC_PI_2 / angular;
    4.0 * (power(0) + inner + power(STEPS)) * quarter / STEPS as f64 / 3.0
}

#[test]
fn friction_takes_its_energy_from_each_cycle() {
    let entry = identity("coulomb_equivalent_damping");
    let [force, amplitude, angular] = ["F", "A", "omega"].map(|name| number(&entry["inputs"][name]));
    let work = energy_per_cycle(&Coulomb::new(force).unwrap(), 1.0, amplitude * angular, angular);
    let equivalent = work / (std::f64::consts::PI * angular * amplitude * amplitude);
    assert!((equivalent / number(&entry["value"]) - 1.0).abs() < RELATIVE, "{equivalent} N s/m");

    let entry = identity("berger_energy_per_cycle");
    let input = |name: &str| number(&entry["inputs"][name]);
    let law = Berger::new(input("mu0"), input("mu1"), input("alpha")).unwrap();
    let work = energy_per_cycle(&law, input("N"), input("V"), input("omega"));
    assert!((work / number(&entry["value"]) - 1.0).abs() < RELATIVE, "{work} J");
}

#[test]
fn quadratic_damping_has_its_equivalent() {
    let entry = identity("quadratic_equivalent_damping");
    let [linear, quadratic] = ["c1", "c2"].map(|name| number(&entry["inputs"][name]));
    let damping = Damping::new(linear, quadratic).unwrap();
    for point in entry["value"].as_array().unwrap() {
        let equivalent = damping.cycle_equivalent(number(&point["V"]));
        assert!((equivalent / number(&point["c_eq"]) - 1.0).abs() < RELATIVE, "{equivalent} N s/m");
    }
    let instantaneous = Damping::<f64>::from_peak_velocity_line(linear, quadratic).unwrap().quadratic_coefficient();
    let expected = number(&entry["c2_needed_for_thesis_eq_5_5"]);
    assert!((instantaneous / expected - 1.0).abs() < RELATIVE, "{instantaneous} N s²/m²");
}

/// A block on a floor; the spring of 1e-12 N/m takes 5e-14 of the friction force.
#[test]
fn a_block_slides_to_rest_without_a_spring() {
    let entry = identity("spring_free_slide");
    let [mass, speed, force] = ["m", "v0", "F"].map(|name| number(&entry["inputs"][name]));
    let block = Scenario::new(Oscillator::new(mass, 1e-12).unwrap(), Coulomb::new(force).unwrap(), 1.0).unwrap();
    let block = block.starting_at(0.0, speed).unwrap();
    let sampling = Sampling::uniform(0.5, 5).unwrap();
    let mut automatic = Trajectory::new();
    simulate_into::<Coulomb, _>(&block, &sampling, None, &mut automatic).unwrap();
    for motion in [automatic, RungeKutta::default().run(&block, &sampling).unwrap()] {
        let rest = motion.rest().unwrap_or_else(|| panic!("{}: no rest", motion.engine()));
        let (time, distance) = (number(&entry["value"]["time"]), number(&entry["value"]["distance"]));
        assert!((rest.time / time - 1.0).abs() < RELATIVE, "{}: {} s", motion.engine(), rest.time);
        assert!((rest.position / distance - 1.0).abs() < RELATIVE, "{}: {} m", motion.engine(), rest.position);
    }
}

/// Under a ramp the acceleration grows from nothing, v = R t²/(2m), less what the spring takes.
#[test]
fn a_ramp_starts_a_motion_gently() {
    let entry = identity("coulomb_initial_curvature_breakaway_delay");
    let [rate, mass, after] = ["R", "m", "t"].map(|name| number(&entry["inputs"][name]));
    let block = Scenario::new(Oscillator::new(mass, 1e-6).unwrap(), Coulomb::new(0.3).unwrap(), 1.0).unwrap();
    let block = block.driven_by(Excitation::ramp(rate).unwrap());
    let sampling = Sampling::at(vec![0.0, 0.1 + after]).unwrap();
    let mut automatic = Trajectory::new();
    simulate_into::<Coulomb, _>(&block, &sampling, None, &mut automatic).unwrap();
    for motion in [automatic, RungeKutta::default().run(&block, &sampling).unwrap()] {
        assert!((motion.events()[1].time - 0.1).abs() < 1e-15, "{}", motion.engine());
        let velocity = motion.velocity().values()[1];
        // The time since breakaway is a difference of times near 0.1 s, rounded to 1e-17 s of 0.01 s, squared; and 1e-6
        // N/m of spring has its turn only after minutes.
        assert!((velocity / number(&entry["value"]) - 1.0).abs() < 1e-9, "{}: {velocity} m/s", motion.engine());
    }
}
