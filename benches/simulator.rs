//! Each engine against the thesis' Euler loop on the same motion, and gradients against plain runs, in one run.
//!
//! `cargo bench --bench simulator` prints criterion's estimates and then the ratios of their medians. The package
//! `peers` beside this file compares with a general solver.

#[path = "common/floor.rs"]
mod floor;
#[path = "common/ratio.rs"]
mod ratio;

use std::hint::black_box;

use criterion::{Criterion, criterion_group};
use fmm_friction::{Berger, Coulomb, Dahl, LawFamily, LuGre, MaxwellSlip, SlidingLaw};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{
    Bristle, Channels, Engine, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, Thesis, Trajectory,
};
use ratio::print_ratio;

/// The Monte Carlo case of the thesis, 1501 velocity samples at 1 kHz.
fn thesis_case<D: Scalar>(coefficient: D, position: D) -> (Scenario<D, Coulomb<D>>, Sampling) {
    let number = |value: f64| D::from(value);
    let damping = Damping::linear(number(0.275)).expect("valid");
    let machine = Oscillator::new(number(10.391), number(1982.0)).expect("valid").with_damping(damping);
    let law = Coulomb::at(&[coefficient]).expect("valid");
    let scenario = Scenario::new(machine, law, number(7.2)).expect("valid");
    let sampling = Sampling::uniform(1e-3, 1501).expect("valid").keeping(Channels::Velocity);
    (scenario.starting_at(position, number(0.101)).expect("valid"), sampling)
}

/// The Berger law of the thesis' Table 5, released from 16 mm, 1751 velocity samples at 1 kHz.
fn berger_case<D: Scalar>(mu0: D, mu1: D) -> (Scenario<D, Berger<D>>, Sampling) {
    let number = |value: f64| D::from(value);
    let damping = Damping::new(number(0.2005), number(0.437)).expect("valid");
    let machine = Oscillator::new(number(10.391), number(1982.0)).expect("valid").with_damping(damping);
    let law = Berger::at(&[mu0, mu1, number(2.852)]).expect("valid");
    let scenario = Scenario::new(machine, law, number(14.0)).expect("valid");
    let sampling = Sampling::uniform(1e-3, 1751).expect("valid").keeping(Channels::Velocity);
    (scenario.starting_at(number(0.016), number(0.0)).expect("valid"), sampling)
}

/// A law as a user writes it: one formula and a level.
#[derive(Debug, Clone, Copy)]
struct Own<D>(D, D, D);

impl<D: Scalar> SlidingLaw<D> for Own<D> {
    fn coefficient(&self, speed: D) -> D {
        self.0 + self.1 * (-(self.2 * speed)).exp()
    }
    fn breakaway(&self) -> D {
        self.0 + self.1
    }
}

fn velocity_laws(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("berger");
    let (scenario, sampling) = berger_case(0.228, 0.261);
    let mut trajectory = Trajectory::new();
    group.bench_function("thesis", |bencher| {
        bencher.iter(|| Thesis::A3.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("runge_kutta", |bencher| {
        bencher.iter(|| RungeKutta::default().run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let loose = RungeKutta::new(1e-10).expect("valid");
    group.bench_function("runge_kutta_1e-10", |bencher| {
        bencher.iter(|| loose.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let own = Scenario::new(*scenario.oscillator(), Own(0.228, 0.261, 2.852), 14.0).expect("valid");
    let own = own.starting_at(0.016, 0.0).expect("valid");
    group.bench_function("own_law", |bencher| {
        bencher.iter(|| RungeKutta::default().run_into(black_box(&own), &sampling, &mut trajectory));
    });
    let (scenario, sampling) = berger_case(Dual::<2>::variable(0.228, 0), Dual::variable(0.261, 1));
    let mut trajectory = Trajectory::new();
    group.bench_function("runge_kutta_gradient", |bencher| {
        bencher.iter(|| RungeKutta::default().run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.finish();
}

/// A half-sine blow of 1.42 N s on the resting machine of the thesis' chapter 8, 330 000 samples at 10 kHz; and
/// the same blow sampled at 10 kHz.
fn impact_case(blow: Excitation) -> (Scenario<f64, Coulomb>, Sampling) {
    let damping = Damping::linear(0.275).expect("valid");
    let machine = Oscillator::new(10.391, 1982.0).expect("valid").with_damping(damping);
    let scenario = Scenario::new(machine, Coulomb::new(0.113).expect("valid"), 6.67).expect("valid").driven_by(blow);
    (scenario, Sampling::uniform(1e-4, 330_000).expect("valid").keeping(Channels::Velocity))
}

fn impact(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("impact");
    group.sample_size(20);
    let duration = std::f64::consts::PI * 1.42 / 2000.0;
    let (scenario, sampling) = impact_case(Excitation::half_sine(1000.0, duration).expect("valid"));
    let mut trajectory = Trajectory::new();
    group.bench_function("thesis", |bencher| {
        bencher.iter(|| Thesis::A3.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("exact", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let force = |i: usize| 1000.0 * (std::f64::consts::PI * i as f64 * 1e-4 / duration).sin();
    let values: Vec<f64> = (0..330_000).map(|i| if (i as f64) * 1e-4 < duration { force(i) } else { 0.0 }).collect();
    let (scenario, sampling) = impact_case(Excitation::sampled_force(1e-4, values).expect("valid"));
    group.bench_function("thesis_sampled", |bencher| {
        bencher.iter(|| Thesis::A3.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("exact_sampled", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.finish();
}

fn ring_down(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ring_down");
    let (scenario, sampling) = thesis_case(0.15, 0.0);
    let mut trajectory = Trajectory::new();
    group.bench_function("thesis", |bencher| {
        bencher.iter(|| Thesis::A3.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("moreau", |bencher| {
        bencher.iter(|| Moreau::default().run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("exact", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let plain = floor::RingDown {
        mass: 10.391,
        stiffness: 1982.0,
        damping: 0.275,
        friction: 7.2 * 0.15,
        position: 0.0,
        velocity: 0.101,
    };
    let (mut velocities, mut room) = (vec![0.0; sampling.count()], floor::Room::new());
    plain.run(1e-3, &mut velocities, &mut room);
    Exact.run_into(&scenario, &sampling, &mut trajectory).expect("valid");
    let apart = trajectory.velocity().values().iter().zip(&velocities).map(|(exact, plain)| (exact - plain).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-14 && room.zeros.len() == trajectory.half_cycles(), "{apart} m/s apart");
    group.bench_function("floor", |bencher| {
        bencher.iter(|| {
            black_box(&plain).run(1e-3, &mut velocities, &mut room);
            black_box(&mut velocities);
        });
    });
    group.bench_function("runge_kutta", |bencher| {
        bencher.iter(|| RungeKutta::default().run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    // The same levels with an elastic contact of 1e4/m, a thousandth of the swing.
    let dahl = Dahl::new(0.15, 1e4, 1.0).expect("valid");
    let dahl = Scenario::new(*scenario.oscillator(), dahl, 7.2).and_then(|case| case.starting_at(0.0, 0.101));
    let dahl = dahl.expect("valid");
    group.bench_function("bristle", |bencher| {
        bencher.iter(|| Bristle::default().run_into(black_box(&dahl), &sampling, &mut trajectory));
    });
    // Bristles ten times as stiff, of rates up to 7e4/s, under a level that falls within a tenth of the greatest speed.
    let lugre = LuGre::new(0.15, 0.2, 0.01, 2.0, 1e5, 1.0, 0.02).expect("valid");
    let lugre = Scenario::new(*scenario.oscillator(), lugre, 7.2).and_then(|case| case.starting_at(0.0, 0.101));
    let lugre = lugre.expect("valid");
    group.bench_function("bristle_lugre", |bencher| {
        bencher.iter(|| Bristle::default().run_into(black_box(&lugre), &sampling, &mut trajectory));
    });
    let elements = MaxwellSlip::new(&[(6e3, 0.05), (4e3, 0.1)]).expect("valid");
    let maxwell = Scenario::new(*scenario.oscillator(), elements, 7.2).and_then(|case| case.starting_at(0.0, 0.101));
    let maxwell = maxwell.expect("valid");
    group.bench_function("exact_elements", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&maxwell), &sampling, &mut trajectory));
    });
    let (scenario, sampling) = thesis_case(Dual::<2>::variable(0.15, 0), Dual::variable(0.0, 1));
    let mut trajectory = Trajectory::new();
    group.bench_function("exact_gradient", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let dahl = Dahl::new(Dual::<2>::variable(0.15, 0), Dual::variable(1e4, 1), Dual::from(1.0)).expect("valid");
    let dahl = Scenario::new(*scenario.oscillator(), dahl, Dual::from(7.2)).expect("valid");
    let dahl = dahl.starting_at(Dual::from(0.0), Dual::from(0.101)).expect("valid");
    group.bench_function("bristle_gradient", |bencher| {
        bencher.iter(|| Bristle::default().run_into(black_box(&dahl), &sampling, &mut trajectory));
    });
    group.finish();
}

fn print_ratios() {
    print_ratio("ring_down/thesis", "ring_down/exact", 13.0..);
    print_ratio("ring_down/exact", "ring_down/floor", ..=1.2);
    // Gradients of two columns.
    print_ratio("ring_down/exact_gradient", "ring_down/exact", ..=2.5);
    print_ratio("ring_down/thesis", "ring_down/moreau", ..);
    print_ratio("ring_down/thesis", "ring_down/runge_kutta", ..);
    print_ratio("ring_down/thesis", "ring_down/exact_elements", ..);
    print_ratio("ring_down/bristle", "ring_down/thesis", ..=4.0);
    print_ratio("ring_down/bristle_lugre", "ring_down/thesis", ..=15.0);
    print_ratio("ring_down/bristle_gradient", "ring_down/bristle", ..);
    print_ratio("berger/thesis", "berger/runge_kutta_1e-10", 1.0..);
    print_ratio("berger/thesis", "berger/runge_kutta", ..);
    print_ratio("berger/own_law", "berger/runge_kutta", ..=2.0);
    print_ratio("berger/runge_kutta_gradient", "berger/runge_kutta", ..=2.5);
    print_ratio("impact/thesis", "impact/exact", 10.0..);
    print_ratio("impact/thesis_sampled", "impact/exact_sampled", 1.0..);
}

criterion_group!(benches, ring_down, velocity_laws, impact);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
