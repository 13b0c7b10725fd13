//! Uncertainties cover the truth as often as they say: chains with noise, fitted many times. The seeds are not those
//! with which thresholds were chosen.

use fmm_frf::{Complex64, Estimated, FrequencyResponse, MeasuredResponse, ModalFit, ModalOptions, ResponseForm};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::chain::{Chain, lines};

/// The responses as means of so many trials, with noise of a share of the root mean square, and their scatter.
fn noisy(truth: &[MeasuredResponse], share: f64, trials: u32, rng: &mut ChaCha8Rng) -> Vec<MeasuredResponse> {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let n = f64::from(trials);
    let of = |measured: &MeasuredResponse| {
        let exact = measured.values();
        let mean = exact.values().iter().map(Complex64::norm_sqr).sum::<f64>() / exact.values().len() as f64;
        let noise = share * (mean * n).sqrt();
        let (mut values, mut u) = (Vec::new(), Vec::new());
        for value in exact.values() {
            let errors: Vec<Complex64> = (0..trials).map(|_| Complex64::new(normal(), normal()) * noise).collect();
            let mean = errors.iter().sum::<Complex64>() / n;
            let scatter: f64 = errors.iter().map(|error| (error - mean).norm_sqr()).sum();
            values.push(value + mean);
            u.push((scatter / (2.0 * n * (n - 1.0))).sqrt());
        }
        let response = FrequencyResponse::new(exact.form(), exact.frequencies().to_vec(), values).unwrap();
        let measured =
            MeasuredResponse::new(response).between(measured.response().clone(), measured.reference().clone());
        measured.with_uncertainty(u, n).unwrap()
    };
    truth.iter().map(of).collect()
}

/// The same without what is known of the noise.
fn bare(measured: &[MeasuredResponse]) -> Vec<MeasuredResponse> {
    let of = |one: &MeasuredResponse| {
        MeasuredResponse::new(one.values().clone()).between(one.response().clone(), one.reference().clone())
    };
    measured.iter().map(of).collect()
}

/// Share of intervals of ±1.96 u that hold the truth.
#[derive(Default)]
struct Count {
    inside: u32,
    all: u32,
}

impl Count {
    fn add(&mut self, found: Estimated, truth: f64) {
        self.all += 1;
        self.inside += u32::from((found.value - truth).abs() < 1.96 * found.uncertainty);
    }

    /// Three standard deviations of a share of so many independent cases around 95 of 100.
    fn require(&self, what: &str) {
        let (all, share) = (f64::from(self.all), f64::from(self.inside) / f64::from(self.all));
        let limit = 3.0 * (0.95 * 0.05 / all).sqrt();
        assert!((share - 0.95).abs() < limit, "{what}: {share:.3} of {all} intervals of 95 % cover, ± {limit:.3}");
        println!("{what}: {share:.3} of {all}");
    }
}

/// Fits `seeds` of a chain; the counts are of frequencies, damping ratios, imaginary parts of residues.
fn covers(name: &str, high: f64, share: f64, seeds: std::ops::Range<u64>, is_known: bool) {
    let chain = Chain::read(name);
    let truth = chain.responses(ResponseForm::Accelerance, &lines(5.0, high, 400), 0);
    let mut counts: [Count; 3] = Default::default();
    let mut chi_square = 0.0;
    for seed in seeds.clone() {
        let mut measured = noisy(&truth, share, 8, &mut ChaCha8Rng::seed_from_u64(seed));
        if !is_known {
            measured = bare(&measured);
        }
        let found = ModalFit::of(&measured, &ModalOptions::default()).unwrap();
        assert_eq!(found.modes().len(), chain.modes.len(), "{name}, seed {seed}: number of modes");
        chi_square += found.reduced_chi_square().unwrap_or(1.0);
        for (mode, truth) in found.modes().iter().zip(&chain.modes) {
            counts[0].add(mode.natural_frequency, truth.frequency);
            counts[1].add(mode.damping_ratio, truth.ratio);
            // One residue of each mode, as those of a mode share the error of its pole.
            let last = mode.residues.len() - 1;
            let (found, u) = (mode.residues[last].value.im, mode.residues[last].imaginary_uncertainty);
            counts[2].add(Estimated::new(found, u), truth.residues[last].im);
        }
    }
    let chi_square = chi_square / (seeds.end - seeds.start) as f64;
    assert!((chi_square - 1.0).abs() < 0.05, "{name}: χ²/ν = {chi_square} in the mean");
    for (count, what) in counts.iter().zip(["natural frequency", "damping ratio", "residue"]) {
        count.require(&format!("{name}, {what}"));
    }
}

#[test]
fn with_the_scatter_of_eight_trials() {
    covers("three", 250.0, 0.02, 70_000..70_100, true);
    covers("four_not_proportional", 200.0, 0.02, 71_000..71_060, true);
}

#[test]
fn with_the_scatter_about_the_fit() {
    covers("three", 250.0, 0.05, 72_000..72_100, false);
    covers("six", 250.0, 0.02, 73_000..73_040, false);
}

/// Two modes 0.3 of their bandwidth apart are told apart, and each is stated with an uncertainty that holds.
#[test]
fn two_close_modes() {
    covers("close", 80.0, 0.005, 74_000..74_060, true);
}

#[test]
fn noise_alone_has_no_modes() {
    let chain = Chain::read("two");
    let silent = chain.responses(ResponseForm::Receptance, &lines(200.0, 400.0, 600), 0);
    for seed in 75_000..75_040 {
        let measured = bare(&noisy(&silent, 100.0, 2, &mut ChaCha8Rng::seed_from_u64(seed)));
        let found = ModalFit::of(&measured, &ModalOptions::default());
        assert!(found.is_err(), "seed {seed}: {:?}", found.map(|fit| fit.modes()[0].to_string()));
    }
}
