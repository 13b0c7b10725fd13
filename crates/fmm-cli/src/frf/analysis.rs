//! Analysis of a set of trials: impulses, response, coherence, resonances, and what is doubtful.

use std::error::Error;
use std::ops::Range;

use clap::ValueEnum;
use fmm_frf::{
    AverageOptions, Background, Baseline, Coherence, Estimator, ExponentialWindow, ForceWindow, FrequencyResponse,
    Pulse, RationalFit, Resonance, ResponseForm, Taper, TrialAverage, impulse,
};
use fmm_record::{Record, saturation};

use super::trials::Trial;
use crate::refusal::placed;

/// Samples before and after the highest one over which the force is integrated, if the pulse itself is not longer.
const AROUND: (usize, usize) = (40, 60);
/// Largest fall of the force below its best line for a line to count (dB); ISO 7626-5 asks for 10 to 20.
const USABLE: f64 = 20.0;
/// Least height of a resonance above its surroundings (dB).
const PROMINENCE: f64 = 20.0;
/// Fall of the magnitude on either side of a resonance within which lines are fitted, and are fitted again (dB).
/// Origin: chosen; half of the lines of a mode alone lie within the narrower band.
const WIDE: f64 = 10.0;
const NARROW: f64 = 6.0;
/// Root mean square that one mode leaves of its lines, over its peak, above which it is no description (1). Origin:
/// chosen; modes apart of a measured hammer leave 0.006 to 0.03, those beside another mode 0.06 and 0.09.
const MISFIT: f64 = 0.05;

/// Weights on the samples of each trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Window {
    /// None: the response has died out within the record
    None,
    /// Nothing of the force but its pulse
    Force,
    /// A decaying exponential on both channels, its damping taken out of the results again
    Exponential,
    /// Force and exponential
    Impact,
    /// Periodic Hann, for random force
    Hann,
    /// Symmetric Hann
    SymmetricHann,
}

/// A resonance with its mode, if a fit finds one.
pub(crate) struct Peak {
    pub(crate) line: Resonance,
    pub(crate) coherence: f64,
    pub(crate) fit: Option<RationalFit>,
    /// Lines of the fit (Hz).
    pub(crate) band: (f64, f64),
}

/// Everything found.
pub(crate) struct Analysis {
    pub(crate) pulses: Vec<Pulse>,
    /// N s
    pub(crate) impulses: Vec<f64>,
    pub(crate) h1: FrequencyResponse,
    pub(crate) h2: FrequencyResponse,
    /// Standard uncertainty of the real and of the imaginary part of H1; none for a single trial.
    pub(crate) uncertainty: Option<Vec<f64>>,
    pub(crate) coherence: Coherence,
    pub(crate) peaks: Vec<Peak>,
    /// The highest frequency (Hz) that the force reaches.
    pub(crate) usable: f64,
    pub(crate) window: String,
    pub(crate) warnings: Vec<String>,
}

impl Analysis {
    /// Analyses `trials` of one rate and length with a `window`; an exponential falls to `end` at the end of the
    /// record.
    pub(crate) fn of(trials: &[Trial], form: ResponseForm, window: Window, end: f64) -> Result<Self, Box<dyn Error>> {
        let first = trials.first().ok_or("there is no trial")?;
        let (rate, length) = (first.force.rate(), first.force.len());
        let mut warnings = Vec::new();
        let (mut pulses, mut impulses) = (Vec::new(), Vec::new());
        for trial in trials {
            let (pulse, impulse) = blow(&trial.force).map_err(placed(&trial.name))?;
            doubts(trial, &pulse, window, &mut warnings);
            pulses.push(pulse);
            impulses.push(impulse);
        }
        let (options, window) = options(&pulses, &first.force, window, end)?;
        let mut average = TrialAverage::new(form, rate, length, &options)?;
        for trial in trials {
            average.add_records(&trial.force, &trial.response).map_err(placed(&trial.name))?;
        }
        let (h1, h2) = (average.estimate(Estimator::H1)?, average.estimate(Estimator::H2)?);
        let coherence = average.coherence()?;
        let usable = usable(&average)?;
        let peaks = peaks(&h1, &coherence, usable);
        if coherence.is_meaningful() {
            for peak in peaks.iter().filter(|peak| peak.coherence < 0.9) {
                let frequency = peak.line.frequency;
                warnings.push(format!("the coherence at {frequency} Hz is only {:.3}", peak.coherence));
            }
        } else {
            warnings.push("one trial has no coherence and no uncertainty: it is 1 by construction".to_owned());
        }
        for peak in &peaks {
            let share = peak.fit.map_or(0.0, |fit| fit.residual / peak.line.magnitude);
            if share > MISFIT {
                warnings.push(format!(
                    "the fit at {} Hz by one mode leaves {:.0} % of the peak: another mode may be near, or the lines \
                     are too few",
                    peak.line.frequency,
                    100.0 * share
                ));
            }
        }
        if usable < 0.999 * h1.frequencies().last().copied().unwrap_or(0.0) {
            warnings.push(format!(
                "above {usable:.4} Hz the force is more than {USABLE} dB below its best; resonances there are not \
                 listed"
            ));
        }
        let uncertainty = average.uncertainty(Estimator::H1).ok();
        Ok(Self { pulses, impulses, h1, h2, uncertainty, coherence, peaks, usable, window, warnings })
    }
}

/// The pulse of a force and its impulse (N s), over a few samples more than the pulse; the baseline is the mean of the
/// fifth of the record that is farthest from it.
fn blow(force: &Record) -> Result<(Pulse, f64), Box<dyn Error>> {
    let (values, interval) = (force.values(), force.interval());
    let length = values.len();
    let highest = values.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i);
    let quiet = quiet(highest, length);
    let pulse = Pulse::of(values, interval, Baseline::MeanOf(quiet.clone()))?;
    let peak = (pulse.time / interval).round() as usize;
    let begin = peak.saturating_sub(AROUND.0).min(pulse.samples.start);
    let end = (peak + AROUND.1).min(length).max(pulse.samples.end);
    let offset = values[quiet.clone()].iter().sum::<f64>() / quiet.len() as f64;
    let area = impulse(&values[begin..end], interval, Baseline::Offset(offset))?;
    Ok((pulse, area))
}

/// The fifth of a record of `length` samples that is farthest from `peak`.
fn quiet(peak: usize, length: usize) -> Range<usize> {
    let fifth = (length / 5).max(1);
    if peak < length / 2 { length - fifth..length } else { 0..fifth }
}

/// Adds the faults of a trial to the warnings.
fn doubts(trial: &Trial, pulse: &Pulse, window: Window, warnings: &mut Vec<String>) {
    let name = &trial.name;
    warnings.extend(trial.warnings.iter().map(|warning| format!("{name}: {warning}")));
    for hit in &pulse.further_hits {
        warnings.push(format!("{name}: the hammer hit again at {:.5} s with {:.3} N", hit.time, hit.level));
    }
    if let Some(overload) = pulse.overload {
        warnings.push(format!("{name}: {} samples of the force are cut off at its limits", overload.samples));
    }
    if let Some(overload) = saturation(trial.response.values()) {
        warnings.push(format!("{name}: {} samples of the response are cut off at its limits", overload.samples));
    }
    let values = trial.response.values();
    let tail = &values[values.len() - (values.len() / 20).max(1)..];
    let mean = tail.iter().sum::<f64>() / tail.len() as f64;
    let largest = |samples: &[f64]| samples.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
    let left = largest(tail) / largest(values);
    let fades = !matches!(window, Window::None | Window::Force);
    if left > 0.02 && !fades {
        warnings.push(format!(
            "{name}: {:.1} % of the response is left at the end, which makes peaks too low; record longer, or use \
             --window exponential",
            100.0 * left
        ));
    }
}

/// The options of an average, and the window in words.
fn options(
    pulses: &[Pulse],
    force: &Record,
    window: Window,
    end: f64,
) -> Result<(AverageOptions, String), Box<dyn Error>> {
    let interval = force.interval();
    let mut options = AverageOptions::default();
    let mut words = Vec::new();
    if matches!(window, Window::Force | Window::Impact) {
        // A pulse length more on either side of all pulses.
        let begin = pulses.iter().map(|pulse| pulse.samples.start).min().unwrap_or(0);
        let stop = pulses.iter().map(|pulse| pulse.samples.end).max().unwrap_or(0);
        let longest = pulses.iter().map(|pulse| pulse.samples.len()).max().unwrap_or(0);
        let (from, to) = (begin.saturating_sub(longest) as f64 * interval, (stop + longest) as f64 * interval);
        let peak = begin.midpoint(stop);
        options = options
            .force_window(ForceWindow::new(from, to)?)
            .force_baseline(Baseline::MeanOf(quiet(peak, force.len())));
        words.push(format!("force from {from:.5} s to {to:.5} s"));
    }
    if matches!(window, Window::Exponential | Window::Impact) {
        let exponential = ExponentialWindow::reaching(end, interval * force.len() as f64)?;
        words.push(format!("exponential with {:.5} 1/s", exponential.decay_rate()));
        options = options.exponential_window(exponential);
    }
    match window {
        Window::Hann => (options, words) = (options.taper(Taper::Hann), vec!["periodic Hann".to_owned()]),
        Window::SymmetricHann => {
            (options, words) = (options.taper(Taper::SymmetricHann), vec!["symmetric Hann".to_owned()]);
        }
        _ => {}
    }
    Ok((options, if words.is_empty() { "none".to_owned() } else { words.join(", ") }))
}

/// The highest frequency (Hz) up to which the force stays near its best.
fn usable(average: &TrialAverage) -> Result<f64, Box<dyn Error>> {
    let density = average.force_density()?;
    // Single lines may have little force; the best line must not be one of the offset.
    let best = density.iter().skip(1).copied().fold(0.0, f64::max);
    let last = density.iter().rposition(|line| *line >= best * 10f64.powf(-USABLE / 10.0)).unwrap_or(0);
    Ok(average.frequencies()[last])
}

/// Resonances up to `usable` (Hz), each with a fit to the lines within 10 dB of it. The change of frequency and damping
/// with the lines, beside a fit to those within 6 dB, is part of their uncertainties: another mode between the lines
/// moves them, and lines scatter about a fit by less.
fn peaks(h1: &FrequencyResponse, coherence: &Coherence, usable: f64) -> Vec<Peak> {
    let found = h1.resonances(PROMINENCE).into_iter().filter(|peak| peak.frequency <= usable);
    let lines = h1.frequencies();
    let magnitude = |line: usize| h1.values()[line].norm();
    let peak = |line: Resonance| {
        let at = lines.partition_point(|frequency| *frequency < line.frequency);
        let within = |decibels: f64| {
            let near = |i: &usize| magnitude(*i) > 10f64.powf(-decibels / 20.0) * line.magnitude;
            let below = (0..at).rev().take_while(near).count().max(3);
            let above = (at + 1..lines.len()).take_while(near).count().max(3);
            let band = (lines[at.saturating_sub(below)], lines[(at + above).min(lines.len() - 1)]);
            let fit = RationalFit::of(h1, band.0, band.1, Background::OtherModes).ok();
            // A fit that puts its mode elsewhere, or has none that is damped, is no fit of this peak.
            let is_here = |fit: &RationalFit| {
                (band.0..=band.1).contains(&fit.natural_frequency.value) && fit.damping_ratio.value > 0.0
            };
            (band, fit.filter(is_here))
        };
        let ((band, mut fit), (_, narrow)) = (within(WIDE), within(NARROW));
        if let Some((fit, narrow)) = fit.as_mut().zip(narrow) {
            for (own, other) in
                [(&mut fit.natural_frequency, narrow.natural_frequency), (&mut fit.damping_ratio, narrow.damping_ratio)]
            {
                own.uncertainty = own.uncertainty.hypot(other.value - own.value);
            }
        }
        Peak { line, coherence: coherence.values()[at], fit, band }
    };
    found.map(peak).collect()
}
