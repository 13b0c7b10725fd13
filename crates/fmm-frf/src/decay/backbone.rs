//! Backbone of a decay: frequency and damping against the amplitude.

use std::f64::consts::TAU;

use fmm_model::{Estimated, ModelError, Unit};
use fmm_record::{Quantity, Record, Swings};

use crate::decay::decay_modes::{DecayMode, decay_modes};
use crate::decay::half_cycles::{FEWEST_HALF_CYCLES, half_cycle_points};
use crate::decay::local::{Carrier, LocalRegression, LocalVibration};
use crate::decay::point::{BackbonePoint, Row};
use crate::decay::spring::spring_terms;
use crate::decay::suggestion::{Explanation, Suggestion};
use crate::error::FrfError;

/// Options of a backbone.
///
/// ```
/// use fmm_frf::BackboneOptions;
///
/// let options = BackboneOptions::default().at(150.0)?.over(12.0)?;
/// assert!(BackboneOptions::default().over(1.0).is_err());
/// # let _ = options;
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BackboneOptions {
    frequency: Option<f64>,
    cycles: Option<f64>,
}

impl BackboneOptions {
    /// Takes the mode nearest to `frequency` (Hz), within a fifth of it. Without it, the strongest mode that decays is
    /// taken.
    ///
    /// # Errors
    /// [`FrfError::OutOfRange`] if it is not positive.
    pub fn at(mut self, frequency: f64) -> Result<Self, FrfError> {
        self.frequency = Some(ModelError::require_positive("frequency of the mode", frequency, "Hz")?);
        Ok(self)
    }

    /// Sets windows of a number of `cycles`, two at least. Without it, a window is a sixteenth of the record, between 3
    /// and 8 cycles; it is shorter in a record of few cycles, and longer where another mode is near.
    ///
    /// # Errors
    /// [`FrfError::Outside`] if they are fewer than two.
    pub fn over(mut self, cycles: f64) -> Result<Self, FrfError> {
        if !(cycles >= FEWEST_CYCLES && cycles.is_finite()) {
            return Err(FrfError::Outside {
                what: format!(
                    "a window of a backbone holds {FEWEST_CYCLES} cycles at least, but {cycles} were asked for"
                ),
            });
        }
        self.cycles = Some(cycles);
        Ok(self)
    }
}

/// Frequency and equivalent damping of one mode against its amplitude, with standard uncertainties.
///
/// Around each of many times, vibrations of slowly changing amplitude and phase are fitted to the samples under a
/// window: the mode, its second and third multiple, and other modes within reach. Its amplitude X in the record, decay
/// rate and frequency are those of the envelope a₀ + a₁ u + a₂ u². For a velocity or an acceleration, A = X/ω or X/ω².
///
/// ```text
/// c_eq/m = −J'/J = −2 A'/A − ω'/ω,     J = ω A²/2
/// ```
///
/// J is the action, which viscous damping lets decay with c/m on any spring. The dependence of ω on A is that of a
/// spring k (x + k₃ x³ + k₅ x⁵) fitted to the points; on a linear spring ω' is zero. A is the amplitude of the first
/// harmonic.
///
/// In a displacement or velocity of fewer than seven cycles before its stop, half cycles make the points instead,
/// unless a mode or a window is asked for. Sines are then fitted to turning points and passages through the centre.
/// Windows are left out if they reach to a stop or to the last cycle before it.
///
/// The effect of a loss c_eq ~ Aⁿ on a window is taken out, with n from the sums of terms that the points do not
/// exclude: damping as measured is larger by n² c³ t²/12 at a reach t, and the frequency smaller by (1 + λ n)/8 (c/ω)²,
/// λ = −2 for a displacement, 0 for a velocity. Uncertainties contain white noise, the uncertainty of n and higher
/// orders; where neighbouring points scatter more about the best terms, as by coloured noise, they are raised to this.
///
/// In 280 simulated records of 8 to 40 half cycles with noise of 0.05 % to 2 %, viscous, dry, falling, quadratic and on
/// curved springs, 1.9 % of the frequencies and 2.8 % of the dampings were off by more than twice their uncertainty.
///
/// Errors without noise: in simulated decays by Coulomb friction, quadratic damping, a spring that hardens by 20 % and
/// a pendulum of 0.6 rad, frequency and damping are within 6e-4 of the closed forms. For two modes 5 % apart, one with
/// a tenth of the amplitude of the other, the frequency of each is within 1e-4, and the damping within 2 %.
///
/// ```
/// use fmm_frf::{Backbone, BackboneOptions};
/// use fmm_record::{Quantity, Record};
///
/// // 20 Hz with c/m = 0.8 1/s; without damping, the spring would swing slightly faster.
/// let at = |t: f64| 1e-3 * (-0.4 * t).exp() * (125.663_706 * t).cos();
/// let positions = (0..8000).map(|i| at(f64::from(i) / 2000.0)).collect();
/// let record = Record::sampled(2000.0, positions, Quantity::Displacement, "m")?;
/// let backbone = Backbone::of(&record, &BackboneOptions::default())?;
/// let spring = 125.663_706_f64.hypot(0.4) / std::f64::consts::TAU;
/// for point in backbone.points() {
///     assert!((point.frequency.value - spring).abs() < 1e-4 && (point.damping.value - 0.8).abs() < 1e-3);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// A. H. Nayfeh, D. T. Mook, *Nonlinear Oscillations*, Wiley 1979, chapter 2 (ω over A).
#[derive(Debug, Clone)]
pub struct Backbone {
    points: Vec<BackbonePoint>,
    window: f64,
    unit: String,
    spring: Vec<Estimated>,
    /// Number of times that the displacement was differentiated to give the record.
    orders: i32,
}

/// Cycles of a record below which half cycles make its points (1).
const FEW_CYCLES: f64 = 7.0;
/// Half cycles of a point (cycles).
const HALF_CYCLES: f64 = 1.5;
/// Fewest cycles of a window.
const FEWEST_CYCLES: f64 = 2.0;
/// Cycles of a window in a short and in a long record.
const CYCLES: (f64, f64) = (3.0, 8.0);
/// Windows in the record, if cycles allow.
const WINDOWS: f64 = 16.0;
/// Windows that a short record holds at least.
const FEWEST_WINDOWS: f64 = 2.2;
/// Other modes within this relative distance of the frequency are fitted beside.
const NEAR: f64 = 0.5;
/// Cycles of the beat with another mode that a window holds.
const BEATS: f64 = 2.0;
/// Least share of the amplitude for a mode to count beside the first (1).
const LEAST_OTHER: f64 = 1e-3;
/// Share of the amplitude above which a mode at any higher frequency is fitted beside (1).
const LOUD: f64 = 0.02;
/// Most modes that are fitted beside, the strongest first.
const MOST_OTHERS: usize = 8;
/// Least amplitude that counts, over its uncertainty (1).
const SEEN: f64 = 10.0;
/// The phase that may be gained in half a window against the carrier before it is moved (rad).
const SLIP: f64 = 0.3;
/// Largest relative distance of a mode from the wanted frequency (1).
const WANTED: f64 = 0.2;
/// The share of the greatest amplitude from which on a decay has begun (1).
const GREATEST: f64 = 0.99;
/// Rounds until loss, spring and points agree.
const ROUNDS: usize = 3;
/// Regressions until the carrier of a window is where its vibration is.
const SETTLING: usize = 2;

impl Backbone {
    /// The backbone of the decay in `record`.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] if the record shows too few half cycles, [`FrfError::NoFit`] if it shows no line, too few
    /// cycles for two windows, or, if the `options` ask for a frequency, no mode within a fifth of it.
    pub fn of(record: &Record, options: &BackboneOptions) -> Result<Self, FrfError> {
        let record = &*record.equally_spaced();
        let orders = match record.quantity() {
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
            _ => 0,
        };
        let prepared = Prepared::of(record, options);
        let is_free = *options == BackboneOptions::default();
        let stop = if options.frequency.is_none() { stop(record) } else { f64::INFINITY };
        let moving = record.duration().min(stop - record.start());
        let is_long = prepared.as_ref().is_ok_and(|prepared| prepared.frequency * moving >= FEW_CYCLES);
        let by_half_cycles = || {
            let rows = half_cycle_points(record);
            let [first, .., last] = rows.as_slice() else { return None };
            let window = HALF_CYCLES / f64::midpoint(first.point.frequency.value, last.point.frequency.value);
            Some(Self::corrected(&rows, window, record, orders))
        };
        if is_free
            && !is_long
            && let Some(found) = by_half_cycles()
        {
            return Ok(found);
        }
        prepared.and_then(|prepared| Self::by_windows(record, prepared, orders, stop)).or_else(|error| {
            // A machine that rests after a few cycles has a long record all the same.
            let found = if is_free && is_long { by_half_cycles() } else { None };
            found.ok_or_else(|| too_few_half_cycles(record, options).unwrap_or(error))
        })
    }

    /// The points of windows on a record, which end a cycle before its `stop` (s).
    fn by_windows(record: &Record, prepared: Prepared<'_>, orders: i32, stop: f64) -> Result<Self, FrfError> {
        let Prepared { taken, frequency, fixed } = prepared;
        let (half, values) = (taken.half, taken.values);
        let centres = (half..values.len() - half).step_by((half / 2).max(1));
        let mut locals: Vec<Local> = centres.map(|centre| taken.local(centre, frequency, &fixed)).collect();
        // A frequency that moves far within the record is followed.
        let slips =
            |local: &Local| ((local.frequency.value - frequency) * half as f64 / record.rate() * TAU).abs() > SLIP;
        if locals.iter().any(slips) {
            // A window without a vibration gives any frequency.
            let within = |found: f64| {
                let is_near = (found / frequency - 1.0).abs() < NEAR;
                if is_near { found } else { frequency }
            };
            let mut at = within(locals[0].frequency.value);
            for local in &mut locals {
                for _ in 0..SETTLING {
                    let Some(moved) = taken.regression(at) else { break };
                    *local = taken.local(local.centre, at, &moved);
                    at = within(local.frequency.value);
                }
            }
        }
        // On a straight spring.
        let row = |local: Local| Row {
            point: BackbonePoint {
                time: record.time(local.centre),
                amplitude: local.amplitude.scaled(1.0 / (TAU * local.frequency.value).powi(orders)),
                frequency: local.frequency,
                damping: local.rate.scaled(2.0),
            },
            reach: fixed.third_in_first * (half as f64 * record.interval()).powi(2),
            lag: f64::from(2 * orders - 2),
            orders: f64::from(orders),
            harmonic: 0.0,
        };
        let before = |row: &Row| row.point.time + half as f64 * record.interval() < stop - 1.0 / frequency;
        let rows: Vec<Row> = decaying(&locals, half).into_iter().map(row).filter(before).collect();
        if rows.is_empty() {
            return Err(no_fit("no window lies between the greatest amplitude and the end of the decay"));
        }
        Ok(Self::corrected(&rows, 2.0 * half as f64 * record.interval(), record, orders))
    }

    /// Points of `rows` without the bias of their windows, with the spring that they show.
    fn corrected(rows: &[Row], window: f64, record: &Record, orders: i32) -> Self {
        let mut points: Vec<BackbonePoint> = rows.iter().map(|row| row.point).collect();
        let (mut spring, mut scales) = (Vec::new(), [1.0; 2]);
        for _ in 0..ROUNDS {
            let (explanations, of_damping) = Explanation::all(&points);
            for (point, row) in points.iter_mut().zip(rows) {
                *point = row.unbiased(Explanation::powers(&explanations, point), &spring);
            }
            let (found, of_frequency) = spring_terms(&points);
            (spring, scales) = (found, [of_damping, of_frequency]);
        }
        for point in &mut points {
            point.damping.uncertainty *= scales[0].sqrt();
            point.frequency.uncertainty *= scales[1].sqrt();
        }
        let power = Unit::of(record.unit()).times(&Unit::of("s").power(orders));
        Self { points, window, unit: power.to_string(), spring, orders }
    }

    /// The points, in the order of time; neighbours share three quarters of their windows, or two of three half cycles.
    pub fn points(&self) -> &[BackbonePoint] {
        &self.points
    }

    /// The length of a window (s). Nearer than half of it to the beginning and the end of the record there is no point.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// Times (s) and amplitudes in the unit of the record itself: its envelope.
    pub fn envelope(&self) -> impl Iterator<Item = (f64, f64)> {
        let seen = |point: &BackbonePoint| point.amplitude.value * (TAU * point.frequency.value).powi(self.orders);
        self.points.iter().map(move |point| (point.time, seen(point)))
    }

    /// The unit of the amplitudes.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// f₀ (Hz), k₃ and k₅ (per square and fourth power of the unit of amplitude) that the frequencies show, without
    /// those that they do not.
    pub fn spring(&self) -> &[Estimated] {
        &self.spring
    }

    /// The terms of damping and spring that explain these points.
    pub fn suggestion(&self) -> Suggestion {
        Suggestion::of(&self.points, &self.spring)
    }
}

/// Time at which the motion ends, if each half cycle loses as much as the last ones; infinity if they lose nothing.
fn stop(record: &Record) -> f64 {
    let swings = Swings::of(record);
    let [.., first, second, third, last] = swings.peaks() else { return f64::INFINITY };
    let (before, after) = ((second.value - first.value).abs(), (last.value - third.value).abs());
    let per_second = (before - after) / (third.time - first.time);
    if per_second > 0.0 { 0.5 * (third.time + last.time) + after / per_second } else { f64::INFINITY }
}

fn no_fit(what: impl Into<String>) -> FrfError {
    FrfError::NoFit { what: what.into() }
}

/// Error of a record of too few half cycles, if no mode was asked for and it vibrates at all.
fn too_few_half_cycles(record: &Record, options: &BackboneOptions) -> Option<FrfError> {
    let needed = match (record.quantity(), options.cycles) {
        (Quantity::Displacement | Quantity::Velocity, None) => FEWEST_HALF_CYCLES,
        // Two windows.
        (_, cycles) => (4.0 * cycles.unwrap_or(FEWEST_CYCLES)).ceil() as usize,
    };
    let found = Swings::of(record).peaks().len();
    (options.frequency.is_none() && (1..needed).contains(&found)).then(|| FrfError::TooFew {
        what: format!("the record shows {found} half cycles above its noise; a backbone needs at least {needed}"),
    })
}

/// Data that all windows share.
pub(crate) struct Taken<'a> {
    pub(crate) values: &'a [f64],
    rate: f64,
    pub(crate) half: usize,
    others: Vec<f64>,
}

/// A mode of a record, and the regression on it.
pub(crate) struct Prepared<'a> {
    pub(crate) taken: Taken<'a>,
    /// Hz.
    pub(crate) frequency: f64,
    pub(crate) fixed: LocalRegression,
}

impl<'a> Prepared<'a> {
    /// The mode that the `options` ask for, with windows that separate it from the others.
    pub(crate) fn of(record: &'a Record, options: &BackboneOptions) -> Result<Self, FrfError> {
        let modes = decay_modes(record);
        let decays = |mode: &&DecayMode| !mode.is_steady(record);
        let strongest = modes
            .iter()
            .find(decays)
            .or(modes.first())
            .ok_or_else(|| no_fit("the record shows no vibration above its noise"))?;
        let wanted = options.frequency.unwrap_or(strongest.frequency);
        let away = |mode: &DecayMode| (mode.frequency / wanted - 1.0).abs();
        let mode = modes.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(strongest);
        let frequency = mode.frequency;
        if away(mode) > WANTED {
            return Err(no_fit(format!(
                "the record shows no mode near {wanted} Hz; the nearest is at {frequency:.4} Hz"
            )));
        }
        let others: Vec<f64> = modes
            .iter()
            .filter(|other| other.frequency != frequency && other.amplitude > LEAST_OTHER * mode.amplitude)
            .filter(|other| {
                let is_near = (other.frequency / frequency - 1.0).abs() < NEAR;
                // Farther away it would be taken for noise.
                let is_loud = other.frequency > frequency && other.amplitude > LOUD * mode.amplitude;
                is_near || (is_loud && other.multiple.is_none())
            })
            .map(|other| other.frequency)
            .take(MOST_OTHERS)
            .collect();
        let cycles_in_all = frequency * record.duration();
        let nearest = others.iter().map(|other| (other / frequency - 1.0).abs()).fold(1.0, f64::min);
        let usual = (cycles_in_all / WINDOWS).clamp(CYCLES.0, CYCLES.1);
        let fitting = usual.min(cycles_in_all / FEWEST_WINDOWS).max(FEWEST_CYCLES);
        let cycles = options.cycles.unwrap_or(fitting.max(BEATS / nearest));
        let half = (0.5 * cycles / frequency * record.rate()).round() as usize;
        let values = record.values();
        if values.len() / 4 < half || half < 4 {
            return Err(no_fit(format!(
                "two windows of {cycles:.1} cycles at {frequency:.4} Hz are needed, of four samples a half at least, but the record has \
                 {cycles_in_all:.1} cycles at {:.4} Hz",
                record.rate()
            )));
        }
        let taken = Taken { values, rate: record.rate(), half, others };
        let fixed = taken.regression(frequency).ok_or_else(|| {
            no_fit(format!("a window of {cycles:.1} cycles does not separate the modes near {frequency:.4} Hz"))
        })?;
        Ok(Self { taken, frequency, fixed })
    }
}

/// A window's vibration, with its uncertainties.
#[derive(Debug, Clone, Copy)]
struct Local {
    centre: usize,
    amplitude: Estimated,
    frequency: Estimated,
    rate: Estimated,
}

impl Taken<'_> {
    /// The regression on a mode of `frequency` (Hz), its multiples and the other modes.
    fn regression(&self, frequency: f64) -> Option<LocalRegression> {
        let carrier = |frequency: f64, order: i32| Carrier { frequency: frequency / self.rate, order };
        let mut carriers = vec![carrier(frequency, 2), carrier(0.0, 0)];
        for multiple in [2.0, 3.0] {
            let far = |other: &f64| (other / frequency - multiple).abs() > 0.2;
            if multiple * frequency < 0.45 * self.rate && self.others.iter().all(far) {
                carriers.push(carrier(multiple * frequency, 1));
            }
        }
        carriers.extend(self.others.iter().map(|other| carrier(*other, 2)));
        LocalRegression::new(self.half, &carriers)
    }

    /// The vibration around sample `centre`, by a `regression` on `frequency` (Hz).
    fn local(&self, centre: usize, frequency: f64, regression: &LocalRegression) -> Local {
        let LocalVibration { amplitude, slope, noise } = regression.at(self.values, centre);
        let size = amplitude.norm();
        let turn = slope / amplitude;
        let per_second = self.rate / self.half as f64;
        // d(a₁/a₀) = da₁/a₀ − (a₁/a₀) da₀/a₀, and d|a₀| = Re(da₀ ā₀)/|a₀|.
        let by_first = -turn / amplitude;
        let by_second = amplitude.inv();
        let deviation = |gradient: [f64; 4]| noise * regression.variance(gradient).sqrt();
        Local {
            centre,
            amplitude: Estimated::new(size, deviation([amplitude.re / size, amplitude.im / size, 0.0, 0.0])),
            frequency: Estimated::new(
                frequency + turn.im * per_second / TAU,
                deviation([by_first.im, by_first.re, by_second.im, by_second.re]) * per_second / TAU,
            ),
            rate: Estimated::new(
                -turn.re * per_second,
                deviation([by_first.re, -by_first.im, by_second.re, -by_second.im]) * per_second,
            ),
        }
    }
}

/// Those of `locals` between the greatest amplitude and the end of the decay, whose windows lie within the decay.
fn decaying(locals: &[Local], half: usize) -> Vec<Local> {
    let size = |local: &Local| local.amplitude.value;
    let largest = locals.iter().map(size).fold(0.0, f64::max);
    let first = locals.iter().position(|local| size(local) >= GREATEST * largest).unwrap_or(0);
    let is_seen = |local: &Local| size(local) > SEEN * local.amplitude.uncertainty;
    let last = locals[first..].iter().position(|local| !is_seen(local)).map_or(locals.len(), |count| first + count);
    let begin = if first == 0 { 0 } else { locals[first].centre + half };
    let end = locals.get(last).map_or(usize::MAX, |local| local.centre.saturating_sub(2 * half));
    locals[first..last].iter().filter(|local| local.centre >= begin && local.centre <= end).copied().collect()
}
