//! Fits: samples, parameters, records and laws.

use fmm_fit::{Derivatives, EvaluationError, Minimizer, Options, Residuals};
use fmm_friction::{AccelerationCoulomb, Berger, Coulomb, CoulombViscous, Hyperbolic, LawFamily};
use fmm_identify::{Experiment, Machine, Preparation, identify};
use fmm_model::{Damping, Oscillator, Parameter};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, RungeKutta, Sampling, Scenario};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::least::Unit::{Microsecond, Millisecond};
use crate::least::{least, print_row};

const NAMES: [&str; 12] = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"];

/// A problem that is linear in its parameters, with its derivatives at hand.
struct Linear {
    parameters: Vec<Parameter>,
    data: Vec<f64>,
    columns: Vec<f64>,
}

impl Linear {
    fn new(samples: usize, count: usize) -> Self {
        let time = |i: usize| i as f64 / samples as f64;
        let column =
            |j: usize| (0..samples).map(move |i| (-3.0 * time(i)).exp() * (9.0 * (j + 1) as f64 * time(i)).cos());
        let columns: Vec<f64> = (0..count).flat_map(column).collect();
        let data = (0..samples).map(|i| columns[i] + 1e-3 * ((i * 7919 % 1009) as f64 / 1009.0 - 0.5)).collect();
        let parameters = (0..count).map(|j| Parameter::new(NAMES[j], "p", "1")).collect();
        Self { parameters, data, columns }
    }
}

impl Residuals for Linear {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (residual, data) in residuals.iter_mut().zip(&self.data) {
            *residual = -data;
        }
        for (column, p) in self.columns.chunks_exact(self.data.len()).zip(p) {
            for (residual, x) in residuals.iter_mut().zip(column) {
                *residual += p * x;
            }
        }
        if let Some(jacobian) = jacobian {
            jacobian.copy_from_slice(&self.columns);
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

fn linear_fit(samples: usize, count: usize) -> f64 {
    let problem = Linear::new(samples, count);
    let mut minimizer = Minimizer::new(Options::default());
    let start = vec![0.5; count];
    least(|| minimizer.minimize(&problem, &start).expect("linear").is_success())
}

/// The thesis' machine released from 20 mm under a law that falls with the speed (`excess` above 0) or does not, 2 s of
/// velocity with 0.3 mm/s of white noise.
fn record(samples: usize, excess: f64) -> Record {
    let damping = Damping::linear(0.275).expect("valid");
    let machine = Oscillator::new(10.391, 1982.0).expect("valid").with_damping(damping);
    let law = Berger::at(&[0.15, excess, 10.0]).expect("valid");
    let scenario =
        Scenario::new(machine, law, 7.2).and_then(|scenario| scenario.starting_at(0.02, 0.0)).expect("valid");
    let interval = 2.0 / samples as f64;
    let sampling = Sampling::uniform(interval, samples).expect("valid");
    let motion = RungeKutta::default().run(&scenario, &sampling).expect("valid");
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut noisy = |v: &f64| v + 3e-4 * Distribution::<f64>::sample(&StandardNormal, &mut generator);
    let values = motion.velocity().values().iter().map(&mut noisy).collect();
    Record::new(0.0, interval, values, Quantity::Velocity, "m/s").expect("finite")
}

fn prepared(record: &Record) -> Experiment {
    Experiment::ring_down(record, &Preparation::default()).expect("a decay")
}

fn identification<F: LawFamily>(samples: usize, records: usize, excess: f64) -> f64 {
    let decays = vec![prepared(&record(samples, excess)); records];
    least(|| identify::<F>(&Machine::per_unit_mass(), &decays).is_ok())
}

pub(crate) fn print_rows() {
    print_row(
        "linear fit with derivatives at hand, 1500 samples, parameters",
        Microsecond,
        &[1, 2, 3, 6, 12],
        |count| linear_fit(1500, count),
    );
    print_row("the same, 3 parameters, samples", Microsecond, &[1500, 15_000, 150_000], |samples| {
        linear_fit(samples, 3)
    });
    let samples = [300, 1500, 15_000, 150_000];
    print_row("preparation of a record, samples", Millisecond, &samples, |samples| {
        let record = record(samples, 0.0);
        least(|| prepared(&record))
    });
    print_row("identification by `Coulomb`, samples", Millisecond, &samples, |samples| {
        identification::<Coulomb>(samples, 1, 0.0)
    });
    print_row("by `CoulombViscous`, samples", Millisecond, &samples, |samples| {
        identification::<CoulombViscous>(samples, 1, 0.0)
    });
    print_row("by `CoulombViscous`, records of 1500 samples", Millisecond, &[1, 2, 4, 8], |records| {
        identification::<CoulombViscous>(1500, records, 0.0)
    });
    let laws = ["AccelerationCoulomb", "Hyperbolic", "Berger"];
    print_row("of 1500 samples by", Millisecond, &laws, |law| match law {
        "AccelerationCoulomb" => identification::<AccelerationCoulomb>(1500, 1, 0.05),
        "Hyperbolic" => identification::<Hyperbolic>(1500, 1, 0.05),
        _ => identification::<Berger>(1500, 1, 0.05),
    });
}
