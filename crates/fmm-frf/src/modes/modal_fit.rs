//! Modes of a structure from its frequency responses.

use std::f64::consts::TAU;

use fmm_model::Estimated;
use fmm_record::Complex64;

use super::band::Band;
use super::diagram::{StabilisationDiagram, by_frequency};
use super::estimation::Estimation;
use super::measured::MeasuredResponse;
use super::mode::{Mode, Residue, shape};
use super::options::ModalOptions;
use super::partial_fractions::Lines;
use super::pole::Pole;
use super::table::{Column, places, table};
use super::windows::Search;
use crate::error::FrfError;
use crate::response::FrequencyResponse;

/// Modes fitted to all lines of one or several responses at once.
///
/// ```text
/// H(s) = sᵖ (Σ A/(s − λ) + A*/(s − λ*) + U + L/s²)                                                      (1)
/// ```
///
/// p is 0, 1 or 2 for receptance, mobility and accelerance; s is iω, or σ + iω behind an exponential window, whose
/// damping is thus in no result. The poles λ are common to all responses; residues A, the flexibility U of modes above
/// the band and the inertia L of those below are not.
///
/// 1. The least-squares complex frequency method gives the poles of the orders 1 to N: [`StabilisationDiagram`].
/// 2. Poles that stay where they are over a fifth of the orders are candidates.
/// 3. Poles, residues and rest are fitted by least squares, lines weighed by their uncertainties if all responses have
///    them, else each response by what the fit leaves of it. Candidates whose residues are within their uncertainties
///    are left out.
///
/// Uncertainties are those of the third step to first order, with noise that is independent from line to line and from
/// response to response; where the residuals are larger than the uncertainties of the lines say, they grow in
/// proportion. Errors that lines share are in none: leakage, delays, mass of sensors.
///
/// ```
/// use fmm_frf::{MeasuredResponse, ModalFit, ModalOptions, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..200).map(|i| f64::from(i) / 16.0).collect();
/// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
/// let response = machine.frequency_response(ResponseForm::Mobility, &lines)?;
/// let fit = ModalFit::of(&[MeasuredResponse::new(response)], &ModalOptions::default())?;
/// assert_eq!(fit.modes().len(), 1);
/// assert!((fit.modes()[0].damping_ratio.value - 0.027_872_73).abs() < 1e-8);
/// // 1/(2 i m ω_d), the residue of a single mass.
/// let damped = fit.modes()[0].pole.value().im;
/// assert!((fit.modes()[0].residues[0].value.im + 0.5 / (10.391 * damped)).abs() < 1e-9);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # References
/// W. Heylen, S. Lammens, P. Sas, *Modal Analysis Theory and Testing*, KU Leuven 1997 (residues by least squares in the
/// frequency domain); for the poles see [`StabilisationDiagram`].
#[derive(Debug, Clone, PartialEq)]
pub struct ModalFit {
    diagram: StabilisationDiagram,
    modes: Vec<Mode>,
    fitted: Vec<FrequencyResponse>,
    misfits: Vec<f64>,
    upper: Vec<Complex64>,
    lower: Vec<Complex64>,
    chi_square: Option<f64>,
}

impl ModalFit {
    /// The modes of `responses` at the same lines.
    ///
    /// Several responses of one reference or several are used as a matrix if each response place has each reference
    /// once, so that modes of one frequency can be told apart; else all have one denominator.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without a response or with fewer lines than the order needs, [`FrfError::Mismatch`] for
    /// responses of other lines, form or window, [`FrfError::Values`] for one that is zero throughout,
    /// [`FrfError::Outside`] for a band without lines, and [`FrfError::NoFit`] if no pole is stable or none is needed.
    pub fn of(responses: &[MeasuredResponse], options: &ModalOptions) -> Result<Self, FrfError> {
        let band = Band::of(responses, options)?;
        let order = order(&band, options)?;
        let (table, along) = table(responses);
        let search = Search::of(&band, &table, order)?;
        let candidates = candidates(&search, options)?;
        let none = || FrfError::no_mode("modal fit", band.ends().0, band.ends().1);
        let (unit, lines) = (band.unit(), Lines::of(&band));
        // Each response has more numbers than unknowns.
        let most = (band.len() - 1).saturating_sub(2);
        if candidates.len() > most {
            return Err(FrfError::too_few_points(candidates.len() + 3, band.len()));
        }
        let candidates = candidates.into_iter().map(|pole| pole.value() / unit).collect();
        let found = Estimation::of(&band, &lines, candidates, options.near.is_some()).ok_or_else(none)?;
        Ok(Self::stated(search.diagram, &band, &lines, &found, &places(responses, &table, along)))
    }

    fn stated(
        diagram: StabilisationDiagram,
        band: &Band,
        lines: &Lines,
        found: &Estimation,
        places: &[Column<'_>],
    ) -> Self {
        let (unit, form) = (band.unit(), i32::from(band.form.derivatives()));
        let mut modes: Vec<Mode> = (0..found.poles.len())
            .map(|index| {
                let residues = found.linear.iter().zip(&band.channels).map(|(response, channel)| {
                    let factor = channel.size * unit.powi(1 - form);
                    let (i, j) = (2 * index, 2 * index + 1);
                    let covariance = |a, b| found.variance * factor * factor * response.covariance[(a, b)];
                    Residue {
                        value: Complex64::new(response.unknowns[i], response.unknowns[j]) * factor,
                        real_uncertainty: covariance(i, i).sqrt(),
                        imaginary_uncertainty: covariance(j, j).sqrt(),
                        covariance: covariance(i, j),
                    }
                });
                mode(found, index, unit, residues.collect(), places)
            })
            .collect();
        modes.sort_by(|a, b| a.natural_frequency.value.total_cmp(&b.natural_frequency.value));
        let (mut fitted, mut misfits) = (Vec::new(), Vec::new());
        let (mut chi_square, mut stated) = (0.0, true);
        for (index, (channel, linear)) in band.channels.iter().zip(&found.linear).enumerate() {
            let values: Vec<Complex64> =
                (0..lines.len()).map(|line| lines.value(line, &found.poles, &linear.unknowns)).collect();
            let squares = values.iter().zip(&channel.values).map(|(one, other)| (one - other).norm_sqr());
            misfits.push((squares.clone().sum::<f64>() / lines.len() as f64).sqrt());
            let weights = &found.weights[index];
            chi_square += squares.enumerate().map(|(line, square)| square * weights.at(line).powi(2)).sum::<f64>();
            stated &= channel.uncertainty.is_some();
            let values = values.into_iter().map(|value| value * channel.size).collect();
            fitted.push(FrequencyResponse::at_lines(band.form, &band.frequencies, values, band.decay_rate));
        }
        let rest = |first: usize, power: i32| {
            let of = |(response, channel): (&super::refinement::Linear, &super::band::Channel)| {
                let parts = &response.unknowns[2 * found.poles.len() + first..];
                Complex64::new(parts[0], parts[1]) * channel.size * unit.powi(power - form)
            };
            found.linear.iter().zip(&band.channels).map(of).collect()
        };
        let unknowns = 2 * found.poles.len() + band.channels.len() * Lines::unknowns(found.poles.len());
        let freedom = (2 * lines.len() * band.channels.len()).saturating_sub(unknowns).max(1);
        let chi_square = stated.then(|| chi_square / freedom as f64);
        Self { diagram, modes, fitted, misfits, upper: rest(0, 0), lower: rest(2, 2), chi_square }
    }

    /// Poles of all orders.
    pub fn diagram(&self) -> &StabilisationDiagram {
        &self.diagram
    }

    /// The modes, in the order of their natural frequencies.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// The response that the modes and the rest have at the lines of the band, one for each response given.
    pub fn fitted(&self) -> &[FrequencyResponse] {
        &self.fitted
    }

    /// Root mean square of the deviation from the fit by that of the response (1), one for each response given.
    pub fn misfits(&self) -> &[f64] {
        &self.misfits
    }

    /// U, the receptance of modes above the band (m/N), one for each response given.
    pub fn upper_residuals(&self) -> &[Complex64] {
        &self.upper
    }

    /// L, the accelerance of modes below the band (1/kg), one for each response given.
    pub fn lower_residuals(&self) -> &[Complex64] {
        &self.lower
    }

    /// χ² by its degrees of freedom, of the residuals by the uncertainties of the lines: about 1 if those are right and
    /// the modes are all; `None` without uncertainties.
    pub fn reduced_chi_square(&self) -> Option<f64> {
        self.chi_square
    }
}

/// A mode by its number in the fit.
fn mode(found: &Estimation, index: usize, unit: f64, residues: Vec<Residue>, places: &[Column<'_>]) -> Mode {
    let pole = found.poles[index];
    let (decay, frequency, norm) = (-pole.re, pole.im, pole.norm());
    let covariance = |i: usize, j: usize| {
        found.variance * found.fit.unit_covariance(2 * index + i, 2 * index + j).unwrap_or(f64::NAN)
    };
    let measured = |value: f64, slopes: [f64; 2]| {
        let [a, b] = slopes;
        let variance = a * a * covariance(0, 0) + 2.0 * a * b * covariance(0, 1) + b * b * covariance(1, 1);
        Estimated::new(value, variance.max(0.0).sqrt())
    };
    let hertz = unit / TAU;
    let cube = norm.powi(3);
    // The reference that moves the mode most shows its shape best.
    let strength = |column: &Column<'_>| column.0.iter().map(|at| residues[*at].value.norm_sqr()).sum::<f64>();
    let best = places.iter().max_by(|a, b| strength(a).total_cmp(&strength(b)));
    let (shape, phase_collinearity) = best.map_or((Vec::new(), 0.0), |(positions, places)| {
        let residues: Vec<Residue> = positions.iter().map(|at| residues[*at]).collect();
        shape(places, &residues)
    });
    Mode {
        pole: Pole(pole * unit),
        natural_frequency: measured(hertz * norm, [hertz * decay / norm, hertz * frequency / norm]),
        damping_ratio: measured(decay / norm, [frequency * frequency / cube, -decay * frequency / cube]),
        residues,
        shape,
        phase_collinearity,
    }
}

/// The highest order that is asked for, or that the lines allow.
fn order(band: &Band, options: &ModalOptions) -> Result<usize, FrfError> {
    let most = (band.len() / 2).saturating_sub(1);
    let order = options.order.unwrap_or(ModalOptions::DEFAULT_ORDER.min(most).max(1));
    if order == 0 {
        return Err(FrfError::too_few("a modal fit needs at least order 1, but order 0 was asked for"));
    }
    if order > most {
        let (needed, found) = (2 * (order + 1), band.len());
        let what = format!("poles of order {order} need at least {needed} lines in the band, but there are {found}");
        return Err(FrfError::too_few(format!("{what}; take a lower order or a wider band")));
    }
    Ok(order)
}

/// The poles that are stable, or that are nearest to the frequencies asked for.
fn candidates(search: &Search, options: &ModalOptions) -> Result<Vec<Pole>, FrfError> {
    let Search { diagram, stable } = search;
    let Some(frequencies) = &options.near else {
        if stable.is_empty() {
            let what = "no pole is stable over a fifth of the orders; ask for more orders, or name the frequencies";
            return Err(FrfError::NoFit { what: what.into() });
        }
        return Ok(stable.clone());
    };
    let single: Vec<Pole> = diagram.poles().iter().filter(|pole| pole.is_stable()).map(|pole| pole.pole).collect();
    let mut chosen: Vec<Pole> = Vec::new();
    for frequency in frequencies {
        let distance = |pole: &&Pole| (pole.natural_frequency() - frequency).abs();
        let nearest = |poles: &[Pole]| {
            let free = poles.iter().filter(|pole| !chosen.contains(pole));
            free.min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
        };
        // A pole more than a tenth away is another one.
        let near = |pole: &Pole| (pole.natural_frequency() / frequency - 1.0).abs() < 0.1;
        let pole = nearest(stable).filter(near).or_else(|| nearest(&single).filter(near)).ok_or_else(|| {
            let what = format!("no stable pole lies within a tenth of {frequency} Hz");
            FrfError::NoFit { what: format!("{what}; look at the stabilisation diagram") }
        })?;
        chosen.push(pole);
    }
    chosen.sort_by(by_frequency);
    Ok(chosen)
}
