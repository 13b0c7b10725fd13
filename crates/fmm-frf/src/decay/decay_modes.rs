//! Modes of a decay: the lines of its spectrum.

use std::f64::consts::PI;

use fmm_record::{Record, Spectrum, Swings};

/// A vibration of which a decay consists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayMode {
    /// f (Hz), about: a backbone finds it better.
    pub frequency: f64,
    /// Its greatest mean amplitude under a window over the record, its half, quarter or eighth, in the unit of the
    /// record.
    pub amplitude: f64,
    /// Its share of the energy of all lines (1), by the squares of the record.
    pub share: f64,
    /// Ratio of its amplitude to the mean of the noise around it (1).
    pub above_noise: f64,
    /// c/m (1/s) by which its mean amplitude falls from one half of the record, or of its first half, quarter or
    /// eighth, to the next; `None` where the second half does not show it, or another mode is too near.
    pub damping: Option<f64>,
    /// Order as a multiple of a stronger mode; friction and nonlinear springs make such multiples.
    pub multiple: Option<u32>,
}

impl DecayMode {
    /// True if its amplitude stays the same through the record, such as that of hum.
    pub fn is_steady(&self, record: &Record) -> bool {
        let lost = |damping: f64| 0.5 * damping * record.duration();
        self.multiple.is_none() && self.damping.is_some_and(|damping| lost(damping).abs() < STEADY)
    }
}

/// Largest loss of amplitude of a steady line over the record (1).
const STEADY: f64 = 0.05;
/// Least energy of a line in both halves of a part, as a multiple of that of the noise, to state its damping.
const SEEN_AGAIN: f64 = 4.0;
/// Least square of a line, as a multiple of the median of the squares around it; noise reaches it once in 10⁷
/// frequencies.
const ABOVE_MEDIAN: f64 = 25.0;
/// The median of the squares of noise over their mean, ln 2.
const MEDIAN: f64 = core::f64::consts::LN_2;
/// Least square of a line, as a multiple of the least square between it and a larger line.
const PROMINENCE: f64 = 4.0;
/// The band of the noise around a line, as a factor of its frequency.
const AROUND: f64 = 1.4;
/// Least distance of a mode from the next, in widths of a window.
const WIDTH: f64 = 4.0;
/// Parts of the record that are looked at: all of it, its half, its quarter and its eighth from the greatest amplitude
/// on.
const PARTS: usize = 4;
/// Fewest samples of a part.
const FEWEST: usize = 64;
/// Highest multiple of a frequency that is taken for its harmonic (1).
const MULTIPLES: f64 = 15.0;
/// Largest distance of a harmonic from a multiple of a steady frequency, over that multiple (1).
const NEAR_MULTIPLE: f64 = 0.01;
/// Largest distance of a harmonic from a multiple of any frequency (1).
const MOST_FROM_MULTIPLE: f64 = 0.3;
/// Largest share of the amplitude in a harmonic (1).
const HARMONIC: f64 = 0.1;
/// Bound of the spectrum of the end of a decay, as a multiple of 1/(π Δf t)².
const LEAKAGE: f64 = 3.0;
/// Reach of a mode beyond its change of frequency, as a multiple of that change (1).
const SWEPT: f64 = 1.5;
/// Least share of the strongest line for a line to belong to the machine (1).
const LEAST: f64 = 1e-4;

/// The modes of the decay in `record`, the strongest first; empty if nothing rises above its noise.
///
/// A mode is a line of the spectrum of the record, or of its first half, quarter or eighth. It rises above the noise,
/// and above the spread of another line by the end or the changing frequency of a decay. Steady lines, such as hum, are
/// listed as well and [marked](DecayMode::is_steady).
///
/// ```
/// use fmm_frf::decay_modes;
/// use fmm_record::{Quantity, Record};
/// use std::f64::consts::TAU;
///
/// let at = |t: f64| (-2.0 * t).exp() * (TAU * 150.0 * t).cos() + 0.2 * (-5.0 * t).exp() * (TAU * 556.0 * t).cos();
/// let record = Record::sampled(5000.0, (0..10_000).map(|i| at(f64::from(i) / 5000.0)).collect(), Quantity::Acceleration, "m/s²")?;
/// let modes = decay_modes(&record);
/// assert!((modes[0].frequency - 150.0).abs() < 0.1 && (modes[1].frequency - 556.0).abs() < 0.3);
/// assert_eq!(modes.len(), 2);
/// assert!((modes[0].damping.unwrap() - 4.0).abs() < 0.01 && (modes[1].damping.unwrap() - 10.0).abs() < 0.1);
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
pub fn decay_modes(record: &Record) -> Vec<DecayMode> {
    let record = &*record.equally_spaced();
    let values = record.values();
    let mean = record.mean();
    let size = |i: &usize| (values[*i] - mean).abs();
    let Some(first) = (0..values.len()).max_by(|a, b| size(a).total_cmp(&size(b))) else { return Vec::new() };
    // The greatest sample of a record that hums or is noise may be its last.
    let first = if values.len() - first < FEWEST.max(values.len() / 4) { 0 } else { first };
    let mut found: Vec<DecayMode> = Vec::new();
    for part in 0..PARTS {
        let count = (values.len() - first) >> part;
        if count < FEWEST {
            break;
        }
        let width = WIDTH * record.rate() / count as f64;
        for line in lines(&values[first..first + count], record.rate()) {
            let near = found.iter_mut().filter(|mode| (mode.frequency - line.frequency).abs() < width);
            match near.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude)) {
                Some(mode) if mode.amplitude < line.amplitude => {
                    mode.amplitude = line.amplitude;
                    mode.above_noise = mode.above_noise.max(line.above_noise);
                }
                Some(_) => {}
                None => found.push(line),
            }
        }
    }
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let strongest = found.first().map_or(0.0, |mode| mode.amplitude);
    found.retain(|mode| mode.amplitude > LEAST * strongest);
    let length = effective_length(record, mean);
    let (times, heights) = Swings::of(record).turns(record.quantity());
    let change = Swings::period_change(&times, &heights).map_or(0.0, f64::abs);
    let mut modes: Vec<DecayMode> = Vec::new();
    for mut mode in found {
        let is_own = modes.iter().all(|stronger| {
            let away = (mode.frequency - stronger.frequency).abs();
            let spread = stronger.amplitude * LEAKAGE / (PI * away * length).powi(2);
            mode.amplitude > spread && away > SWEPT * change * stronger.frequency
        });
        if is_own {
            mode.multiple = modes.iter().filter(|stronger| stronger.multiple.is_none()).find_map(|stronger| {
                let ratio = mode.frequency / stronger.frequency;
                // A frequency that changes is another one in another part of the record.
                let reach = ((NEAR_MULTIPLE + change) * ratio).min(MOST_FROM_MULTIPLE);
                let near = (ratio - ratio.round()).abs() < reach;
                let is_harmonic =
                    near && (1.5..MULTIPLES).contains(&ratio) && mode.amplitude < HARMONIC * stronger.amplitude;
                is_harmonic.then_some(ratio.round() as u32)
            });
            modes.push(mode);
        }
    }
    let frequencies: Vec<f64> = modes.iter().map(|mode| mode.frequency).collect();
    for part in 0..PARTS {
        let count = (values.len() - first) >> part;
        let Some(halves) = Halves::of(&values[first..first + count]) else { break };
        for mode in modes.iter_mut().filter(|mode| mode.damping.is_none()) {
            let others = frequencies.iter().filter(|other| **other != mode.frequency);
            let far = others.map(|other| (other - mode.frequency).abs()).fold(mode.frequency, f64::min);
            mode.damping = halves.damping(record.rate(), mode.frequency, change * mode.frequency, far);
        }
    }
    let energy: f64 = modes.iter().map(|mode| mode.amplitude * mode.amplitude).sum();
    for mode in &mut modes {
        mode.share = mode.amplitude * mode.amplitude / energy;
    }
    modes
}

/// Lines of the spectrum of `values` at this `rate` (Hz).
fn lines(values: &[f64], rate: f64) -> Vec<DecayMode> {
    let spectrum = Spectrum::of(values);
    let squares = &spectrum.squares;
    let lobe = (WIDTH / spectrum.spacing).ceil() as usize;
    let floor = Floor::of(squares, lobe);
    let mut found = Vec::new();
    for k in lobe..squares.len().saturating_sub(1) {
        if !(squares[k] > squares[k - 1] && squares[k] >= squares[k + 1]) {
            continue;
        }
        let median = floor.at(k);
        if squares[k] > ABOVE_MEDIAN * median && squares[k] > PROMINENCE * saddle(squares, k) {
            found.push(DecayMode {
                frequency: spectrum.refined(k) * rate / values.len() as f64,
                amplitude: squares[k].sqrt(),
                share: 0.0,
                above_noise: (squares[k] * MEDIAN / median.max(f64::MIN_POSITIVE)).sqrt(),
                damping: None,
                multiple: None,
            });
        }
    }
    found
}

/// Spectra of the two halves of a part of a record, with their noise.
struct Halves {
    /// Samples of each.
    count: usize,
    spectra: [Spectrum; 2],
    floors: [Floor; 2],
}

impl Halves {
    fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() / 2;
        if count < FEWEST / 2 {
            return None;
        }
        let spectra = [0, count].map(|begin| Spectrum::of(&values[begin..begin + count]));
        let lobe = (WIDTH / spectra[0].spacing).ceil() as usize;
        let floors = [0, 1].map(|half| Floor::of(&spectra[half].squares, lobe));
        Some(Self { count, spectra, floors })
    }

    /// c/m (1/s) of the line at `frequency` (Hz), which sweeps over `swept` (Hz), from its energies in the two halves;
    /// `None` if the second does not show it, or the next line is not `far` (Hz).
    fn damping(&self, rate: f64, frequency: f64, swept: f64, far: f64) -> Option<f64> {
        let reach = WIDTH * rate / self.count as f64 + swept;
        if far < 2.0 * reach {
            return None;
        }
        let per_line = self.spectra[0].spacing * rate / self.count as f64;
        let line = |frequency: f64| (frequency / per_line).round().max(0.0) as usize;
        let band = line(frequency - reach).max(1)..(line(frequency + reach) + 1).min(self.spectra[0].squares.len());
        let [before, after] = [0, 1].map(|half| {
            let noise = self.floors[half].at(line(frequency)) / MEDIAN * band.len() as f64;
            let energy = self.spectra[half].squares[band.clone()].iter().sum::<f64>() - noise;
            (energy > SEEN_AGAIN * noise).then_some(energy)
        });
        Some((before? / after?).ln() * rate / self.count as f64)
    }
}

/// Median squares around the lines of a spectrum.
struct Floor {
    /// The middle of each band, and the median in it.
    bands: Vec<(f64, f64)>,
}

impl Floor {
    /// Of bands that are as wide as [`AROUND`] says, or as several lines of this half width `lobe`.
    fn of(squares: &[f64], lobe: usize) -> Self {
        let mut bands = Vec::new();
        let mut middle = lobe.max(1) as f64;
        while middle < squares.len() as f64 {
            let reach = (4 * lobe) as f64;
            let low = (middle / AROUND).min(middle - reach).max(1.0) as usize;
            let high = ((middle * AROUND).max(middle + reach) as usize).min(squares.len());
            if low < high {
                let mut around = squares[low..high].to_vec();
                let half = around.len() / 2;
                bands.push((middle, *around.select_nth_unstable_by(half, f64::total_cmp).1));
            }
            middle = (middle * AROUND.sqrt()).max(middle + lobe as f64);
        }
        Self { bands }
    }

    /// The median around line `k`.
    fn at(&self, k: usize) -> f64 {
        let next = self.bands.partition_point(|(middle, _)| *middle < k as f64);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|place| self.bands.get(place));
        let nearest = near.min_by(|a, b| (a.0 - k as f64).abs().total_cmp(&(b.0 - k as f64).abs()));
        nearest.map_or(0.0, |(_, median)| *median)
    }
}

/// The least square on the way from `k` to a larger one, on the side where that is greater.
fn saddle(squares: &[f64], k: usize) -> f64 {
    let least = |side: &mut dyn Iterator<Item = f64>| {
        let mut least = squares[k];
        for square in side {
            if square > squares[k] {
                return Some(least);
            }
            least = least.min(square);
        }
        None
    };
    let left = least(&mut squares[..k].iter().rev().copied());
    let right = least(&mut squares[k + 1..].iter().copied());
    left.into_iter().chain(right).fold(0.0, f64::max)
}

/// Twice the mean time (s) of the squares of `record` about its `mean`, counted from its start: its effective length.
fn effective_length(record: &Record, mean: f64) -> f64 {
    let (mut squares, mut moments) = (0.0, 0.0);
    for (i, value) in record.values().iter().enumerate() {
        let square = (value - mean).powi(2);
        squares += square;
        moments += square * i as f64;
    }
    if squares > 0.0 { 2.0 * moments / squares * record.interval() } else { 0.0 }
}
