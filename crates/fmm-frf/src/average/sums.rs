//! Sums over trials, line by line.

use std::iter::Zip;
use std::slice::Iter;

use fmm_record::Complex64;
use pulp::Arch;

use crate::average::estimator::Spectra;

/// Sums of F*F, V*V and F*V.
#[derive(Debug, Clone)]
pub(crate) struct SpectralSums {
    force: Vec<f64>,
    response: Vec<f64>,
    /// Real and imaginary parts, in vectors of their own for the processor.
    cross: [Vec<f64>; 2],
}

impl SpectralSums {
    pub(crate) fn new(lines: usize) -> Self {
        let zeros = || vec![0.0; lines];
        Self { force: zeros(), response: zeros(), cross: [zeros(), zeros()] }
    }

    /// Adds two trials, one after the other.
    pub(crate) fn add(&mut self, first: Trial<'_>, second: Trial<'_>) {
        let [real, imaginary] = &mut self.cross;
        let powers = self.force.iter_mut().zip(&mut self.response);
        let sums = powers.zip(real.iter_mut().zip(imaginary));
        let lines = sums.zip(first.lines().zip(second.lines()));
        Arch::new().dispatch(
            #[inline(always)]
            || {
                lines.for_each(|(((ff, vv), (re, im)), (one, two))| {
                    let sums = added([*ff, *vv, *re, *im], one);
                    [*ff, *vv, *re, *im] = added(sums, two);
                });
            },
        );
    }

    pub(crate) fn clear(&mut self) {
        let [real, imaginary] = &mut self.cross;
        for sums in [&mut self.force, &mut self.response, real, imaginary] {
            sums.fill(0.0);
        }
    }

    /// Values of `rule` for the sums at each line with the trials that are `waiting`.
    pub(crate) fn map<'a, T>(
        &self,
        waiting: &(impl Iterator<Item = Trial<'a>> + Clone),
        rule: impl Fn(Spectra) -> T,
    ) -> Vec<T> {
        if waiting.clone().next().is_some() {
            return (0..self.force.len()).map(|line| rule(self.line(line, waiting.clone()))).collect();
        }
        let [real, imaginary] = &self.cross;
        let sums = self.force.iter().zip(&self.response).zip(real.iter().zip(imaginary));
        Arch::new().dispatch(
            #[inline(always)]
            || {
                let spectra = sums.map(|((&force, &response), (&re, &im))| Spectra {
                    force,
                    response,
                    cross: Complex64::new(re, im),
                });
                spectra.map(rule).collect()
            },
        )
    }

    /// The sums at `line` with the trials that are `waiting`.
    pub(crate) fn line<'a>(&self, line: usize, waiting: impl Iterator<Item = Trial<'a>>) -> Spectra {
        let [real, imaginary] = &self.cross;
        let sums = [self.force[line], self.response[line], real[line], imaginary[line]];
        let [force, response, re, im] =
            waiting.fold(sums, |sums, trial| added(sums, (&trial.force[line], &trial.response[line])));
        Spectra { force, response, cross: Complex64::new(re, im) }
    }
}

/// The spectra of a trial.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial<'a> {
    pub(crate) force: &'a [Complex64],
    pub(crate) response: &'a [Complex64],
}

impl<'a> Trial<'a> {
    /// Force and response, line by line.
    fn lines(self) -> Zip<Iter<'a, Complex64>, Iter<'a, Complex64>> {
        self.force.iter().zip(self.response)
    }
}

/// Sums of F*F, V*V and the two parts of F*V at one line, after a trial more.
#[expect(clippy::inline_always, reason = "only what is inlined is compiled for the wide vectors")]
#[inline(always)]
fn added([ff, vv, re, im]: [f64; 4], (f, v): (&Complex64, &Complex64)) -> [f64; 4] {
    [
        ff + (f.re * f.re + f.im * f.im),
        vv + (v.re * v.re + v.im * v.im),
        re + (f.re * v.re + f.im * v.im),
        im + (f.re * v.im - f.im * v.re),
    ]
}

/// Sums of V/F and of |V/F|².
#[derive(Debug, Clone)]
pub(crate) struct RatioSums {
    ratio: Vec<Complex64>,
    square: Vec<f64>,
}

impl RatioSums {
    pub(crate) fn new(lines: usize) -> Self {
        Self { ratio: vec![Complex64::ZERO; lines], square: vec![0.0; lines] }
    }

    /// Adds a trial, whose force is nowhere zero.
    pub(crate) fn add(&mut self, force: &[Complex64], response: &[Complex64]) {
        for ((sum, square), (force, response)) in
            self.ratio.iter_mut().zip(&mut self.square).zip(force.iter().zip(response))
        {
            let ratio = response / force;
            *sum += ratio;
            *square += ratio.norm_sqr();
        }
    }

    pub(crate) fn clear(&mut self) {
        self.ratio.fill(Complex64::ZERO);
        self.square.fill(0.0);
    }

    /// The mean ratio at each line of this number of trials.
    pub(crate) fn means(&self, trials: f64) -> Vec<Complex64> {
        self.ratio.iter().map(|ratio| ratio / trials).collect()
    }

    /// The mean squared distance of the ratios at `line` from their mean.
    pub(crate) fn variance(&self, line: usize, trials: f64) -> f64 {
        (self.square[line] / trials - (self.ratio[line] / trials).norm_sqr()).max(0.0)
    }
}
