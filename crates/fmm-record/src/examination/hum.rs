//! Lines that go on unchanged through a record, as the mains make them.

use std::f64::consts::TAU;

use crate::examination::Examination;
use crate::examination::steadiness::steady;
use crate::numerics::line_search::{Candidate, fundamental, lines};
use crate::numerics::range;
use crate::record::Record;

/// A line that goes on unchanged while the motion of a record decays, and after it has stopped: hum of the mains at
/// 50 Hz or 60 Hz, their multiples, or any other constant line.
///
/// ```text
/// y = A cos(2π f (t − t₀) + φ)
/// ```
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | f | `frequency` | Hz | where the line is in the record: a line above half the rate appears mirrored below it |
/// | A | `amplitude` | unit of the record | half of its height |
/// | φ | `phase` | rad | of the cosine, at t₀, from 0 to 2π |
/// | t₀ | `start` | s | first sample of the record in which it was found |
///
/// A line counts if
///
/// * it stands out of the noise around it, in the whole record, its first or last half, quarter or eighth. Noise alone
///   does so in less than one record of a hundred (in tests in about one of a thousand);
/// * it is twice as large as all that lies within 2.6 frequencies of the motion, as harmonics of friction would be
///   alike. In a rest that is noise, so that smaller lines are found in a record with a rest;
/// * its amplitude is the same, within a tenth and the noise, wherever in the record it would be seen above motion
///   and noise, the last quarter included, and its phase goes on. What decays or stops with the motion fails this;
/// * its amplitude is less than 0.45 of half the range of the record, and more than 0.3 steps of the converter.
///
/// The record must contain 28 periods of the line, and if it has more than 262 144 samples the line must lie below half
/// of the rate that so many would have. A line below some four frequencies of the motion is found in a rest
/// only, of 16 of its periods or more, and a line within 4/T of half the rate not at all. The frequency is uncertain by
/// about 0.5/(T SNR) for a line that is seen for a time T at an amplitude of SNR standard deviations of the spectrum
/// there, 5 at least: by less than 1/(20 T) from SNR = 10 on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Hum {
    /// f, frequency as it appears in the record (Hz).
    pub frequency: f64,
    /// A, amplitude, in the unit of the record.
    pub amplitude: f64,
    /// φ, phase of the cosine at `start`, from 0 to 2π (rad).
    pub phase: f64,
    /// t₀, the time to which the phase belongs (s).
    pub start: f64,
}

impl Hum {
    /// Contribution of the line to the record at `time` (s), in the unit of the record.
    pub fn at(&self, time: f64) -> f64 {
        self.amplitude * (TAU * self.frequency * (time - self.start) + self.phase).cos()
    }
}

/// Most lines that are looked for.
const MOST: usize = 16;
/// Most candidates of one part of a record that are looked at closely.
const MOST_CANDIDATES: usize = 12;
/// Largest amplitude of a hum, as a share of half the range of the record (1); what is larger is the motion.
const LARGEST: f64 = 0.45;
/// Smallest amplitude, in steps of the converter.
const SMALLEST: f64 = 0.3;
/// Number of samples above which neighbours are averaged to look for lines: 10 million would take half a minute.
pub(crate) const MOST_SAMPLES: usize = 1 << 18;

/// The lines of a record, the largest first.
pub(crate) fn hum(examination: &Examination) -> Vec<Hum> {
    let record = examination.record();
    let survey = record.in_at_most(MOST_SAMPLES);
    let group = (survey.interval() / record.interval()).round();
    let mut values = survey.values().to_vec();
    let (low, high) = range(&values);
    let largest = LARGEST * 0.5 * (high - low);
    let smallest = SMALLEST * examination.step();
    let fundamental = fundamental(&values);
    let count = values.len();
    let parts = [
        0..count,
        count / 2..count,
        count / 4 * 3..count,
        count / 8 * 7..count,
        0..count / 2,
        0..count / 4,
        0..count / 8,
    ];
    let mut known = Vec::new();
    let mut found: Vec<Hum> = Vec::new();
    // Each line is taken out before the next is looked for, so that the largest do not hide smaller ones.
    for _ in 0..MOST {
        let candidates = parts
            .iter()
            .flat_map(|part| lines(&values, part.clone(), fundamental, &known).into_iter().take(MOST_CANDIDATES));
        let mut candidates: Vec<_> = candidates.filter(|candidate| candidate.amplitude < 2.0 * largest).collect();
        candidates.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let allowed = smallest..largest;
        let is_allowed = |(line, _): &(Candidate, f64)| line.amplitude > 0.0 && allowed.contains(&line.amplitude);
        let line = candidates.into_iter().find_map(|candidate| steady(&values, candidate).filter(is_allowed));
        let Some((mut line, mut phase)) = line else { break };
        known.push(line.frequency);
        if group > 1.0 {
            // Averages show faster lines at the wrong frequency, where the samples themselves have none.
            let candidate = Candidate { frequency: line.frequency / group, ..line };
            let Some(sharper) = steady(record.values(), candidate).filter(is_allowed) else { continue };
            (line, phase) = sharper;
        }
        let (frequency, amplitude) = (line.frequency / record.interval(), line.amplitude);
        let hum = Hum { frequency, amplitude, phase, start: record.start() };
        found.push(hum);
        for (i, value) in values.iter_mut().enumerate() {
            *value -= hum.at(survey.time(i));
        }
    }
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    found
}

/// `record` less the `lines`.
pub(crate) fn without_lines(record: &Record, lines: &[Hum]) -> Record {
    let less = |(time, value): (f64, &f64)| value - lines.iter().map(|line| line.at(time)).sum::<f64>();
    let values = record.times().zip(record.values()).map(less).collect();
    // Only a line that is not finite can make a record of it that is none.
    Record::new(record.start(), record.interval(), values, record.quantity(), record.unit())
        .unwrap_or_else(|_| record.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examination::swings::Swings;
    use crate::tests::synthetic::{CoulombDecay, Noise, Recorded, measured_records, released_twice, sampled, with_hum};
    use crate::units::Quantity;

    fn hum(record: &Record) -> Vec<Hum> {
        Examination::of(record).hum().to_vec()
    }

    /// `record` and lines of these frequencies (Hz), amplitudes and phases.
    fn humming(record: &Record, lines: &[(f64, f64, f64)]) -> Record {
        let turned = |(frequency, amplitude, phase): &(f64, f64, f64)| Hum {
            frequency: *frequency,
            amplitude: -amplitude,
            phase: *phase,
            start: record.start(),
        };
        without_lines(record, &lines.iter().map(turned).collect::<Vec<_>>())
    }

    #[test]
    fn measured_records_have_none() {
        for record in measured_records() {
            assert_eq!(hum(&record), []);
        }
        assert_eq!(hum(&released_twice()), []);
    }

    #[test]
    fn decays_with_friction_and_noise_seldom_have_one() {
        // In 4000 such records there were 5.
        let alarms = (0..300).filter(|seed| !hum(&Recorded::random(*seed).record).is_empty()).count();
        assert!(alarms <= 3, "{alarms} of 300");
    }

    #[test]
    fn noise_alone_and_short_records_have_none() {
        for noise in [0.0, 1.0] {
            let record = sampled(1000.0, 10.0, Quantity::Velocity, noise, |_| 3.0);
            assert_eq!(hum(&record), []);
        }
        for length in 1..80 {
            let values = (0..length).map(|i| (2.0 * f64::from(i)).sin()).collect();
            assert_eq!(hum(&Record::sampled(100.0, values, Quantity::Velocity, "1").unwrap()), []);
        }
    }

    #[test]
    fn a_short_decay_is_found_below_hum() {
        let record = with_hum();
        let lines = hum(&record);
        assert_eq!(lines.len(), 1, "{lines:?}");
        // A twentieth of 1/3 s would be 0.017 Hz.
        assert!((lines[0].frequency - 50.0).abs() < 2e-3, "{} Hz", lines[0].frequency);
        let swings = Swings::of(&without_lines(&record, &lines));
        assert!((swings.frequency().unwrap() - 2.198).abs() < 0.02, "{:?} Hz", swings.frequency());
        assert!((4..=6).contains(&swings.peaks().len()), "{} peaks", swings.peaks().len());
    }

    /// The swings below a hum of any size and frequency are those without it.
    #[test]
    fn hum_of_the_mains_is_found_and_leaves_the_swings() {
        for (rate, frequency) in [(1000.0, 50.0), (500.0, 60.0), (1000.0, 100.0), (90.0, 60.0), (110.0, 150.0)] {
            for share in [0.01, 0.1, 0.3] {
                for (deadband, duration) in [(0.9, 4.0), (0.9, 1.3), (0.25, 4.0), (0.25, 8.0)] {
                    let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband, release: 0.2 };
                    let clean = sampled(rate, duration, Quantity::Velocity, 0.005, |t| decay.state(t).1 / 138.0);
                    let record = humming(&clean, &[(frequency, share, 2.0)]);
                    let aliased = (frequency - (frequency / rate).round() * rate).abs();
                    let case = format!("{frequency} Hz at {rate} Hz, {share}, {deadband}, {duration} s");
                    let lines = hum(&record);
                    // A hundred samples with noise do not show so little; the swings are right all the same.
                    let hopeless = share < 0.02 && rate * duration < 150.0;
                    assert!(lines.len() == 1 || hopeless, "{case}: {lines:?}");
                    let Some(line) = lines.first() else { continue };
                    let error = (line.frequency - aliased).abs();
                    // √(6/N) σ/(π A T) is what noise leaves, twice that for the window.
                    let scatter = (6.0 / (rate * duration)).sqrt() * 0.005 / (3.1 * share * duration);
                    assert!(error < 0.02 / duration + 5.0 * scatter, "{case}: {error} Hz");
                    // Of the noise, 0.005 √2/√N or so, with a window that uses half of the samples.
                    let allowed = 0.03 * share + 0.02 / (rate * duration).sqrt();
                    assert!((line.amplitude - share).abs() < allowed, "{case}: {}", line.amplitude);
                    let (expected, found) = (Swings::of(&clean), Swings::of(&without_lines(&record, &lines)));
                    let (expected_count, count) = (expected.peaks().len(), found.peaks().len());
                    assert!(expected_count.abs_diff(count) <= 1, "{case}: {count} against {expected_count}");
                    assert!((found.frequency().unwrap() - 2.2).abs() < 0.05, "{case}: {:?} Hz", found.frequency());
                }
            }
        }
    }

    #[test]
    fn several_lines_are_found_and_unsteady_ones_are_not() {
        let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.25, release: 0.2 };
        let clean = sampled(1000.0, 8.0, Quantity::Displacement, 0.002, |t| decay.state(t).0 / 10.0);
        let record = humming(&clean, &[(50.01, 0.05, 1.0), (150.03, 0.01, 2.0), (100.02, 0.002, 3.0)]);
        let found: Vec<f64> = hum(&record).iter().map(|line| (line.frequency * 100.0).round() / 100.0).collect();
        assert_eq!(found, [50.01, 150.03, 100.02]);
        // A line that decays, one that stops with the motion, and one whose frequency runs away.
        for unsteady in [
            |t: f64| (-0.1 * t).exp() * (TAU * 50.0 * t).sin(),
            |t: f64| if t < 4.0 { (TAU * 50.0 * t).sin() } else { 0.0 },
            |t: f64| (TAU * (50.0 + t) * t).sin(),
        ] {
            let values = clean.times().zip(clean.values()).map(|(t, value)| value + 0.05 * unsteady(t)).collect();
            let record = Record::sampled(1000.0, values, Quantity::Displacement, "1").unwrap();
            assert_eq!(hum(&record), []);
        }
    }

    /// Harmonics of Coulomb friction are as large at the end of a motion as at its start.
    #[test]
    fn harmonics_of_friction_without_rest_are_no_hum() {
        for seed in 0..20 {
            let random = &mut Noise::new(seed);
            let decay = CoulombDecay {
                frequency: 1.0 + 20.0 * random.uniform(),
                amplitude: 10.0,
                deadband: 0.02 + 0.3 * random.uniform(),
                release: -0.1,
            };
            for quantity in [Quantity::Displacement, Quantity::Velocity] {
                let record = sampled(2000.0, 0.95 * decay.stop(), quantity, 0.0, |t| {
                    let (displacement, velocity) = decay.state(t);
                    if quantity == Quantity::Velocity { velocity } else { displacement }
                });
                assert_eq!(hum(&record), [], "{} Hz, {}", decay.frequency, decay.deadband);
            }
        }
    }
}
