//! A first look at a decay: `fmm backbone FILE`.
//!
//! Lists the modes of a record, takes one of them, and gives out how its frequency and damping go with the amplitude,
//! which terms of damping and spring would explain that, and the command that fits them.

use std::error::Error;
use std::f64::consts::TAU;

use crate::answer::{Answer, Detail, Document};
use crate::figure::{Cells, Panel, Role, drawn, label};
use crate::host::Host;
use crate::input::Given;
use crate::output::{Output, pair};
use clap::Args;
use fmm_frf::{Backbone, BackboneOptions, BackbonePoint, DecayMode, Suggestion, decay_modes};
use fmm_identify::Experiment;
use fmm_model::{Damping, Dual, Estimated, Oscillator, Scalar};
use fmm_record::{Record, Spectrum};
use serde::Serialize;

/// Shows the modes of a decay, and how frequency and damping of one go with its amplitude.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    given: Given,
    /// Cycles in each window; between 3 and 8 by the length of the record unless given, more where another mode is near
    #[arg(long, value_name = "CYCLES")]
    cycles: Option<f64>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Points in the printed table at most.
const ROWS: usize = 12;

/// A decay, its modes, and the backbone of one of them.
pub(crate) struct Found {
    origin: String,
    remarks: Vec<String>,
    decay: Experiment,
    record: Record,
    modes: Vec<DecayMode>,
    backbone: Backbone,
    suggestion: Suggestion,
    /// Relative uncertainty of the clock.
    clock: f64,
}

pub(crate) fn backbone(arguments: &Arguments, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let input = arguments.given.read(host)?;
    let decay = Experiment::ring_down(&input.record, &arguments.given.preparation())?;
    let record = decay.record().equally_spaced().into_owned();
    let mut options = match arguments.given.mode {
        Some(mode) => mode.options(&record)?,
        None => BackboneOptions::default(),
    };
    if let Some(cycles) = arguments.cycles {
        options = options.over(cycles)?;
    }
    let modes = decay_modes(&record);
    let backbone = host.while_busy("backbone", || Backbone::of(&record, &options))??;
    let suggestion = backbone.suggestion();
    let clock = arguments.given.choice.rate_u;
    Ok(Found { origin: input.origin, remarks: input.warnings, decay, record, modes, backbone, suggestion, clock })
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        let summary = self.decay.summary();
        let mut lines = vec![
            self.origin.clone(),
            format!("used from {:.4} s to {:.4} s; --from and --to say otherwise", summary.from, summary.to),
            String::new(),
            text(&self.record, &self.modes, &self.backbone, &self.suggestion, self.clock),
        ];
        let warnings = self.decay.warnings();
        if !warnings.is_empty() {
            lines.extend([String::new(), "Warnings".to_owned()]);
            lines.extend(warnings.iter().map(|warning| format!("  - {warning}")));
        }
        Ok(lines.join("\n"))
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("backbone-1", Content::of(self)).pretty()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        Ok(vec![("backbone.svg".to_owned(), drawn(&panels(&self.record, &self.backbone, &self.suggestion)))])
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
    }
}

fn text(record: &Record, modes: &[DecayMode], backbone: &Backbone, suggestion: &Suggestion, clock: f64) -> String {
    let mut lines = vec!["Modes".to_owned(), "       Hz   amplitude   energy   above noise   c/m / (1/s)".to_owned()];
    for mode in modes {
        let multiple = mode.multiple.map_or_else(String::new, |multiple| format!("  {multiple} times a stronger one"));
        let steady = if mode.is_steady(record) { "  steady through the record" } else { "" };
        let damping = mode.damping.map_or_else(|| "not seen".to_owned(), |damping| format!("{damping:.3}"));
        lines.push(format!(
            "{:9.4}   {:9.3e}   {:5.1} %   {:11.0}   {damping:>11}{multiple}{steady}",
            mode.frequency,
            mode.amplitude,
            100.0 * mode.share,
            mode.above_noise
        ));
    }
    lines.push(format!("amplitudes in {}", record.unit()));
    lines.push(String::new());
    lines.push(format!(
        "Backbone, windows of {:.4} s; none reaches beyond an end of the record or to a stop",
        backbone.window()
    ));
    lines.push(format!("  {:>9}   {:<22}   {:<24}   c/m / (1/s)", "time / s", label("A", backbone.unit()), "f / Hz"));
    let points = backbone.points();
    let shown = || points.iter().step_by(points.len().div_ceil(ROWS));
    for point in shown() {
        let (time, amplitude) = (point.time, point.amplitude.to_string());
        let (frequency, damping) = (clocked(point.frequency, clock).to_string(), clocked(point.damping, clock));
        lines.push(format!("  {time:9.4}   {amplitude:<22}   {frequency:<24}   {damping}"));
    }
    lines.push(String::new());
    lines.push(format!("  {:>9}   {:<22}   {:<20}   {:<22}   τ / s", "time / s", "ζ", "Q", "δ"));
    for point in shown() {
        let [ratio, quality, decrement, time] =
            stated(point, clock).map(|stated| stated.map_or_else(|| "-".to_owned(), |stated| stated.to_string()));
        lines.push(format!("  {:9.4}   {ratio:<22}   {quality:<20}   {decrement:<22}   {time}", point.time));
    }
    lines.push(String::new());
    lines.push(format!("Suggested: {suggestion}"));
    for (term, name) in backbone.spring().iter().zip(["f0 / Hz", "k3", "k5"]) {
        lines.push(format!("  {name} = {term}"));
    }
    if !suggestion.damping.is_empty() {
        lines.push(format!(
            "fit it, and others beside it, by: fmm identify --law \"{}\"; the suggestion does not judge",
            suggestion.model()
        ));
    }
    lines.join("\n")
}

/// A frequency or a rate with the relative uncertainty of the clock.
fn clocked(value: Estimated, clock: f64) -> Estimated {
    Estimated::new(value.value, value.uncertainty.hypot(clock * value.value))
}

/// ζ, Q, δ and τ of the equivalent damping at a point; none for damping that is not positive or is critical.
fn stated(point: &BackbonePoint, clock: f64) -> [Option<Estimated>; 4] {
    let (frequency, damping) = (point.frequency, point.damping);
    let variable = |value: Estimated, direction| Dual::<2>::variable(value.value, direction);
    let oscillator = Oscillator::per_unit_mass(variable(frequency, 0))
        .and_then(|machine| Ok(machine.with_damping(Damping::new(variable(damping, 1), Dual::from(0.0))?)));
    let Ok(oscillator) = oscillator else { return [None; 4] };
    let [quality, decrement, time] =
        [oscillator.quality_factor(), oscillator.logarithmic_decrement(), oscillator.time_constant()];
    let ratio = quality.map(|_| oscillator.damping_ratio());
    // A clock moves both together: ratios of them stay, a time goes with it.
    [(ratio, 0.0), (quality, 0.0), (decrement, 0.0), (time, clock)].map(|(value, clock)| {
        let value = value.filter(|value| value.value().is_finite())?;
        let u = (value.partial(0) * frequency.uncertainty).hypot(value.partial(1) * damping.uncertainty);
        Some(clocked(Estimated::new(value.value(), u), clock))
    })
}

/// Modes and backbone for programs; a list that ends in `_u` is a value and its standard uncertainty.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    /// The file, the channel, what it was taken for, and how its sampling rate was found.
    origin: &'a str,
    /// Faults of the file.
    remarks: &'a [String],
    /// Unit of the record.
    unit: &'a str,
    /// Beginning of the part that was used (s).
    from: f64,
    /// End of the part that was used (s).
    to: f64,
    warnings: Vec<String>,
    modes: Vec<Mode>,
    /// Length of a window (s).
    window: f64,
    unit_of_amplitude: &'a str,
    points: Vec<Point>,
    suggestion: Suggested,
}

/// A mode of the decay, the strongest first.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Mode {
    /// Frequency of the line (Hz).
    frequency: f64,
    /// Amplitude in the unit of the record.
    amplitude: f64,
    share_of_energy: f64,
    /// Peak over the noise beside it (1).
    above_noise: f64,
    /// Damping per mass (1/s); none if it is not seen.
    damping: Option<f64>,
    /// True for a mode that does not decay.
    steady: bool,
    /// Number of times the frequency of a stronger mode, if it is a multiple of one.
    multiple: Option<u32>,
}

/// One window along the decay.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Point {
    /// Middle of the window (s).
    time: f64,
    /// Amplitude and its standard uncertainty, in `unit_of_amplitude`.
    amplitude_u: [f64; 2],
    /// Frequency (Hz).
    frequency_u: [f64; 2],
    /// Equivalent damping per mass (1/s).
    damping_u: [f64; 2],
    damping_ratio_u: Option<[f64; 2]>,
    quality_factor_u: Option<[f64; 2]>,
    logarithmic_decrement_u: Option<[f64; 2]>,
    /// Time constant (s).
    time_constant_u: Option<[f64; 2]>,
}

/// Terms that explain the backbone.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Suggested {
    /// Model for `--law` of identify.
    model: String,
    damping: Vec<DampingTerm>,
    /// Models that the backbone does not exclude.
    not_excluded: Vec<String>,
    /// True if the damping falls with the amplitude, as under friction.
    falls: bool,
    /// Frequency at small amplitudes (Hz), and cubic and quintic part of the spring.
    spring_u: Vec<[f64; 2]>,
}

/// A term of the damping.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct DampingTerm {
    /// Name of the term.
    term: String,
    /// Coefficient per mass, in SI units.
    per_mass_u: [f64; 2],
    /// Share of the energy that is lost by it (1).
    share_of_energy_u: [f64; 2],
}

impl<'a> Content<'a> {
    fn of(found: &'a Found) -> Self {
        let Found { decay, backbone, suggestion, clock, .. } = found;
        let mode = |mode: &DecayMode| Mode {
            frequency: mode.frequency,
            amplitude: mode.amplitude,
            share_of_energy: mode.share,
            above_noise: mode.above_noise,
            damping: mode.damping,
            steady: mode.is_steady(decay.record()),
            multiple: mode.multiple,
        };
        let point = |point: &BackbonePoint| {
            let [ratio, quality, decrement, time] = stated(point, *clock).map(|stated| stated.map(pair));
            Point {
                time: point.time,
                amplitude_u: pair(point.amplitude),
                frequency_u: pair(clocked(point.frequency, *clock)),
                damping_u: pair(clocked(point.damping, *clock)),
                damping_ratio_u: ratio,
                quality_factor_u: quality,
                logarithmic_decrement_u: decrement,
                time_constant_u: time,
            }
        };
        let damping = suggestion.damping.iter().map(|term| DampingTerm {
            term: format!("{:?}", term.kind).to_lowercase(),
            per_mass_u: pair(term.coefficient),
            share_of_energy_u: pair(term.share),
        });
        Self {
            origin: &found.origin,
            remarks: &found.remarks,
            unit: decay.record().unit(),
            from: decay.summary().from,
            to: decay.summary().to,
            warnings: decay.warnings().iter().map(ToString::to_string).collect(),
            modes: found.modes.iter().map(mode).collect(),
            window: backbone.window(),
            unit_of_amplitude: backbone.unit(),
            points: backbone.points().iter().map(point).collect(),
            suggestion: Suggested {
                model: suggestion.model(),
                damping: damping.collect(),
                not_excluded: suggestion.others.clone(),
                falls: suggestion.falls,
                spring_u: suggestion.spring.iter().map(|term| pair(*term)).collect(),
            },
        }
    }
}

/// Spectrum, record with its envelope, spectrogram if there are several modes, frequency and damping against the
/// amplitude with what is suggested.
pub(crate) fn panels(record: &Record, backbone: &Backbone, suggestion: &Suggestion) -> Vec<Panel> {
    let count = record.len();
    let spectrum = Spectrum::of(record.values());
    let per_line = spectrum.spacing * record.rate() / count as f64;
    let decibels = |square: &f64| 10.0 * square.max(f64::MIN_POSITIVE).log10();
    let points = backbone.points();
    let lines = spectrum.squares.iter().enumerate().skip(1).map(|(k, square)| (k as f64 * per_line, decibels(square)));
    let lines: Vec<(f64, f64)> = lines.collect();
    // Up to what is within 40 dB of the strongest line; beyond, a wide band of noise would hide it.
    let mode = points.iter().map(|point| point.frequency.value).fold(0.0, f64::max);
    let strongest = lines.iter().map(|(_, level)| *level).fold(f64::NEG_INFINITY, f64::max);
    let seen = lines.iter().filter(|(_, level)| *level > strongest - 40.0).map(|(frequency, _)| *frequency);
    let highest = 1.2 * seen.fold(5.0 * mode, f64::max);
    let lines = lines.into_iter().filter(|(frequency, _)| *frequency <= highest);
    // An offset of the sensor is no part of the mode.
    let middle = record.values().iter().sum::<f64>() / count as f64;
    let envelope =
        |sign: f64| backbone.envelope().map(move |(time, seen)| (time, middle + sign * seen)).collect::<Vec<_>>();
    let velocity = |point: &BackbonePoint| TAU * point.frequency.value * point.amplitude.value;
    let said = |point: &BackbonePoint| suggestion.damping_at(velocity(point));
    let sprung = |point: &BackbonePoint| suggestion.frequency_at(point.amplitude.value).unwrap_or(f64::NAN);
    let against = |value: &dyn Fn(&BackbonePoint) -> f64| -> Vec<(f64, f64)> {
        points.iter().map(|point| (point.amplitude.value, value(point))).collect()
    };
    let amplitude = label("amplitude", backbone.unit());
    let measured = record.times().zip(record.values().iter().copied());
    let with_band = |axis: String, name: &str, of: fn(&BackbonePoint) -> Estimated| {
        let name = format!("{name}, lines at two standard uncertainties");
        let panel = Panel::new(amplitude.clone(), axis, 300.0);
        let panel = panel.with(Role::Points, name, against(&|point| of(point).value));
        [-1.0, 1.0].into_iter().fold(panel, |panel, sign| {
            let edge = |point: &BackbonePoint| of(point).value + sign * 2.0 * of(point).uncertainty;
            panel.with(Role::Measured, "", against(&edge))
        })
    };
    let mut panels = vec![
        Panel::new("frequency / Hz", "level / dB", 300.0).with(Role::Residual, "spectrum", lines),
        Panel::new("time / s", label("record", record.unit()), 300.0)
            .with(Role::Measured, "measured", measured)
            .with(Role::Fitted, "envelope of the mode", envelope(1.0))
            .with(Role::Fitted, "", envelope(-1.0)),
        with_band("f / Hz".to_owned(), "frequency", |point| point.frequency).with(
            Role::Fitted,
            suggestion.model(),
            against(&sprung).into_iter().filter(|(_, f)| f.is_finite()),
        ),
        with_band(label("c/m", "1/s"), "equivalent damping", |point| point.damping).with(
            Role::Fitted,
            suggestion.model(),
            against(&said),
        ),
    ];
    // One mode alone has nothing to interact with.
    let own: Vec<DecayMode> = decay_modes(record).into_iter().filter(|mode| mode.multiple.is_none()).collect();
    if let (true, Some((cells, range))) = (own.len() > 1, spectrogram(record, &own)) {
        let path = points.iter().map(|point| (point.time, point.frequency.value));
        let panel = Panel::new("time / s", "frequency / Hz", 340.0).over(cells);
        let scale = format!("frequency of the mode; black is the strongest, white {range:.0} dB less or weaker");
        panels.insert(2, panel.with(Role::Fitted, scale, path));
    }
    panels
}

/// Cells of a spectrogram along time and along frequency.
const CELLS: (usize, usize) = (80, 48);
/// Levels lower than this below the highest are white (dB), and at least half of all.
const RANGE: f64 = 60.0;
/// Modes below this share of the largest amplitude do not widen a spectrogram (1).
const SHOWN: f64 = 0.01;

/// Levels over time and frequency, up to above the highest of these `modes`, and the range (dB) from white to black;
/// `None` for a record that is too short.
fn spectrogram(record: &Record, modes: &[DecayMode]) -> Option<(Cells, f64)> {
    let largest = modes.iter().map(|mode| mode.amplitude).fold(0.0, f64::max);
    let seen = modes.iter().filter(|mode| mode.amplitude > SHOWN * largest);
    let highest = (1.3 * seen.map(|mode| mode.frequency).fold(0.0, f64::max)).min(0.5 * record.rate());
    let values = record.values();
    // Windows of Blackman and Harris that overlap by nine tenths.
    let window = values.len() / 8;
    let step = (values.len().checked_sub(window)? / CELLS.0).max(1);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for begin in (0..=values.len() - window).step_by(step).take_while(|_| window >= CELLS.1) {
        let spectrum = Spectrum::of(&values[begin..begin + window]);
        let lines_per_cell = highest / CELLS.1 as f64 * window as f64 / (spectrum.spacing * record.rate());
        let line = |cell: usize| (cell as f64 * lines_per_cell).round() as usize;
        let level = |cell: usize| {
            let lines = line(cell)..(line(cell + 1)).max(line(cell) + 1);
            let largest = spectrum.squares.get(lines).unwrap_or(&[]).iter().copied().fold(0.0, f64::max);
            10.0 * largest.max(f64::MIN_POSITIVE).log10()
        };
        columns.push((0..CELLS.1).map(level).collect());
    }
    let top = columns.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut levels: Vec<f64> = columns.iter().flatten().copied().collect();
    levels.sort_by(f64::total_cmp);
    // The noise of the record is most of the plane, and is not shown.
    let range = (top - levels.get(levels.len() / 2)?).clamp(1.0, RANGE);
    let row = |cell: usize| columns.iter().map(|column| column[cell].max(top - range)).collect();
    let rows: Vec<Vec<f64>> = (0..CELLS.1).map(row).collect();
    let half = 0.5 * window as f64 * record.interval();
    let ends = (record.start() + half, record.end() - half);
    (ends.0 < ends.1).then_some((Cells { rows, x: ends, y: (0.0, highest) }, range))
}
