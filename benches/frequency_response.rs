//! H1, H2 and coherence of an impact test against the bare transforms of its channels, in one run.
//!
//! `cargo bench --bench frequency_response` prints criterion's estimates and then the ratios of their medians: 1.10 on
//! two quiet cores of a Xeon at 2.8 GHz, 1.08 and 1.16 while others built there. What is beyond the transforms waits
//! for memory, so that single runs scatter up to 1.4; H1, H2 and coherence themselves, after all trials, are 1 % of the
//! time.

#[path = "common/ratio.rs"]
mod ratio;

use std::hint::black_box;

use criterion::{Criterion, criterion_group};
use fmm_frf::{
    AverageOptions, Backbone, BackboneOptions, Complex64, Estimator, ForceWindow, ResponseForm, TrialAverage,
    decay_modes,
};
use fmm_record::{Quantity, Record};
use ratio::print_ratio;
use realfft::RealFftPlanner;

const RATE: f64 = 10_000.0;
/// 33 s as in the thesis' chapter 8; 2⁴ · 3 · 5⁴ · 11, no power of two.
const SAMPLES: usize = 330_000;
const TRIALS: usize = 10;

/// Half-sine blows of different length with a trace of noise, and a decay at 2.2 Hz.
fn trials() -> Vec<(Vec<f64>, Vec<f64>)> {
    let noise = |i: usize, seed: usize| {
        let hash = (i + 1).wrapping_mul(2_654_435_761).wrapping_add(seed.wrapping_mul(40_503)) >> 7;
        (hash % 65_536) as f64 / 65_536.0 - 0.5
    };
    let trial = |k: usize| {
        let length = 18 + k;
        let pulse = |i: usize| if i < length { (std::f64::consts::PI * i as f64 / length as f64).sin() } else { 0.0 };
        let force = (0..SAMPLES).map(|i| 1000.0 * pulse(i.saturating_sub(100)) + noise(i, k)).collect();
        let velocity = |i: usize| {
            let t = i as f64 / RATE;
            0.1 * (-0.5 * t).exp() * (13.8 * t).cos() + 1e-4 * noise(i, k + TRIALS)
        };
        (force, (0..SAMPLES).map(velocity).collect())
    };
    (0..TRIALS).map(trial).collect()
}

fn frequency_response(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("impact_test");
    group.sample_size(20);
    let trials = trials();

    // A transform destroys its input, so that whoever needs the record again has to copy it.
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(SAMPLES);
    let (mut input, mut scratch) = (plan.make_input_vec(), plan.make_scratch_vec());
    let (mut force_lines, mut velocity_lines) = (plan.make_output_vec(), plan.make_output_vec());
    let mut transform = |samples: &[f64], lines: &mut [Complex64]| {
        input.copy_from_slice(samples);
        plan.process_with_scratch(&mut input, lines, &mut scratch).expect("lengths fit");
    };
    group.bench_function("bare_realfft", |bencher| {
        bencher.iter(|| {
            for (force, velocity) in black_box(&trials) {
                transform(force, &mut force_lines);
                transform(velocity, &mut velocity_lines);
                black_box((&force_lines, &velocity_lines));
            }
        });
    });

    let average =
        |options: &AverageOptions| TrialAverage::new(ResponseForm::Mobility, RATE, SAMPLES, options).expect("valid");
    let add_all = |average: &mut TrialAverage| {
        average.clear();
        for (force, velocity) in black_box(&trials) {
            average.add(force, velocity).expect("valid");
        }
    };
    let mut plain = average(&AverageOptions::default());
    group.bench_function("h1_h2_coherence", |bencher| {
        bencher.iter(|| {
            add_all(&mut plain);
            let h1 = plain.estimate(Estimator::H1).expect("force everywhere");
            let h2 = plain.estimate(Estimator::H2).expect("force everywhere");
            (h1, h2, plain.coherence().expect("force everywhere"))
        });
    });
    let window = ForceWindow::new(0.009, 0.014).expect("valid");
    let options = AverageOptions::default().force_window(window).within(0.5, 20.0).expect("valid");
    let mut band = average(&options.keeping_ratios());
    group.bench_function("band_to_20_hz", |bencher| {
        bencher.iter(|| {
            add_all(&mut band);
            let ratios = band.estimate(Estimator::MeanOfRatios).expect("force in the band");
            (ratios, band.estimate(Estimator::H1).expect("force in the band"), band.coherence().expect("as before"))
        });
    });
    group.finish();
}

/// Three modes in noise, 131 072 samples: the search for modes, and the backbone of the strongest, which begins with
/// that search.
fn decay(criterion: &mut Criterion) {
    const SAMPLES: usize = 131_072;
    const RATE: f64 = 12_800.0;
    let mode = |t: f64, amplitude: f64, rate: f64, angular: f64| amplitude * (-rate * t).exp() * (angular * t).cos();
    let hash = |i: usize| ((i + 1).wrapping_mul(2_654_435_761) >> 7) % 65_536;
    let value = |i: usize| {
        let t = i as f64 / RATE;
        let modes = mode(t, 1.0, 0.8, 942.5) + mode(t, 0.3, 2.0, 3493.0) + mode(t, 0.1, 1.0, 2100.0);
        modes + 1e-3 * (hash(i) as f64 / 65_536.0 - 0.5)
    };
    let values: Vec<f64> = (0..SAMPLES).map(value).collect();
    let record = Record::sampled(RATE, values, Quantity::Acceleration, "m/s²").expect("finite");
    let mut group = criterion.benchmark_group("decay");
    group.sample_size(20);
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(SAMPLES);
    let (mut input, mut lines, mut scratch) = (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
    group.bench_function("bare_realfft", |bencher| {
        bencher.iter(|| {
            input.copy_from_slice(black_box(&record).values());
            plan.process_with_scratch(&mut input, &mut lines, &mut scratch).expect("lengths fit");
            black_box(&lines);
        });
    });
    group.bench_function("modes", |bencher| bencher.iter(|| decay_modes(black_box(&record))));
    let options = BackboneOptions::default();
    group.bench_function("modes_and_backbone", |bencher| {
        bencher.iter(|| Backbone::of(black_box(&record), &options).expect("a decay"));
    });
    group.finish();
}

criterion_group!(benches, frequency_response, decay);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratio("impact_test/h1_h2_coherence", "impact_test/bare_realfft", ..=1.15);
    print_ratio("impact_test/band_to_20_hz", "impact_test/bare_realfft", ..);
    print_ratio("decay/modes", "decay/bare_realfft", ..);
    print_ratio("decay/modes_and_backbone", "decay/modes", ..);
}
