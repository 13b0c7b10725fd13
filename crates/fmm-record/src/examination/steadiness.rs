//! The steadiness of a line through a record.

use std::f64::consts::{LN_2, PI, TAU};

use crate::numerics::least_squares::LeastSquares;
use crate::numerics::line_search::Candidate;
use crate::numerics::median;
use crate::numerics::spectrum::{LOBE, blackman_harris, component};

/// Fewest periods of the line in a segment: its lobe stays clear of the offset.
const PERIODS: f64 = 7.0;
/// Most and fewest segments side by side.
const SEGMENTS: (f64, f64) = (4.0, 8.0);
/// A line of so many standard deviations of the background of a segment would be seen there.
const VISIBLE: f64 = 5.0;
/// Change from the start to the end, and departure of one segment, that a steady line may show (1). The mains are no
/// better.
const CHANGE: f64 = 0.1;
const DEPARTURE: f64 = 0.25;
/// Departure of the phase of one segment from that of a steady line (rad).
const PHASE: f64 = 1.0;
/// Standard deviations within which noise stays.
const SCATTER: f64 = 4.0;

/// One segment: what it shows at the frequency, and the noise and motion around it.
#[derive(Clone, Copy)]
struct Segment {
    /// Its middle (samples).
    time: f64,
    amplitude: f64,
    /// Phase of a cosine at the first sample of the record, if the frequency is right (rad).
    phase: f64,
    /// Standard deviation of the amplitude.
    scatter: f64,
}

/// The line of `candidate` in `values`, sharper, and its phase as a cosine at the first sample (rad); `None` unless it
/// is as large and in phase wherever it can be seen.
///
/// Segments that overlap by a half are looked at. Their background is the median of what they show beside the line.
/// Wherever that would let the line be seen, it must be there with the same amplitude and in phase, in three segments
/// at least, one of which lies in the last quarter. What decays, or stops with the motion, fails this. The frequency
/// is that of the straight line through the phases, which is sharper than 1/duration by about the number of standard
/// deviations by which the line stands out.
pub(crate) fn steady(values: &[f64], candidate: Candidate) -> Option<(Candidate, f64)> {
    let segments = segments(values, candidate.frequency)?;
    let visible: Vec<Segment> =
        segments.into_iter().filter(|segment| candidate.amplitude > VISIBLE * segment.scatter).collect();
    let last = visible.last()?.time;
    if visible.len() < 3 || last < 0.75 * values.len() as f64 {
        return None;
    }
    let amplitude = level(&visible);
    let agrees =
        |segment: &Segment| (segment.amplitude - amplitude).abs() <= DEPARTURE * amplitude + SCATTER * segment.scatter;
    if !visible.iter().all(agrees) || !is_level(&visible, amplitude) {
        return None;
    }
    let (slope, phase) = in_phase(&visible)?;
    // The amplitude of a segment is that of a line with noise, which is a little more than that of the line.
    Some((Candidate { frequency: candidate.frequency + slope / TAU, amplitude }, phase.rem_euclid(TAU)))
}

/// Amplitudes of the segments at `frequency` (cycles per sample).
fn segments(values: &[f64], frequency: f64) -> Option<Vec<Segment>> {
    let count = (frequency * values.len() as f64 / PERIODS).floor().min(SEGMENTS.1);
    if count < SEGMENTS.0 {
        return None;
    }
    let length = (values.len() as f64 / count) as usize;
    let window = blackman_harris(length);
    let sum: f64 = window.iter().sum();
    let half = length / 2;
    let starts = (0..).map(|i| i * half).take_while(|start| start + length <= values.len());
    let segments = starts.map(|start| {
        let piece = &values[start..start + length];
        let mean = piece.iter().zip(&window).map(|(y, w)| y * w).sum::<f64>() / sum;
        let windowed: Vec<f64> = piece.iter().zip(&window).map(|(y, w)| (y - mean) * w / sum).collect();
        let bin = 1.0 / length as f64;
        let beside = [1.0, 1.5, 2.0, 2.5, 3.0].into_iter().flat_map(|lobes| {
            let distance = lobes * LOBE * bin;
            [frequency - distance, frequency + distance]
        });
        let mut beside: Vec<f64> = beside
            .filter(|other| *other > LOBE * bin && *other < 0.5 - LOBE * bin)
            .map(|other| {
                let (cosine, sine) = component(&windowed, other);
                cosine * cosine + sine * sine
            })
            .collect();
        let (cosine, sine) = component(&windowed, frequency);
        let phase = sine.atan2(cosine) - TAU * (frequency * start as f64).fract();
        // Of both parts together; the amplitude has half of it.
        let square = 0.5 * median(&mut beside) / LN_2;
        // What a constant or exact record shows beside a line is rounding.
        let rounding = 1e-9 * cosine.hypot(sine);
        Segment {
            time: start as f64 + 0.5 * length as f64,
            amplitude: cosine.hypot(sine),
            phase,
            scatter: square.sqrt().max(rounding).max(f64::MIN_POSITIVE),
        }
    });
    Some(segments.collect())
}

/// The mean amplitude, each weighted by its inverse variance; a segment cannot weigh more than ten times the median, so
/// that one does not speak for all.
fn level(segments: &[Segment]) -> f64 {
    let (sum, weight) = weights(segments)
        .zip(segments)
        .fold((0.0, 0.0), |sum, (weight, segment)| (sum.0 + weight * segment.amplitude, sum.1 + weight));
    sum / weight
}

fn weights(segments: &[Segment]) -> impl Iterator<Item = f64> + '_ {
    let weights = segments.iter().map(|segment| segment.scatter.powi(-2));
    let most = 10.0 * median(&mut weights.clone().collect::<Vec<_>>());
    weights.map(move |weight| weight.min(most))
}

/// True if the amplitudes neither rise nor fall.
fn is_level(segments: &[Segment], amplitude: f64) -> bool {
    let points =
        weights(segments).zip(segments).map(|(weight, segment)| (weight, segment.amplitude, [1.0, segment.time]));
    let Some(fit) = LeastSquares::of(&points.collect::<Vec<_>>()) else { return false };
    let span = segments[segments.len() - 1].time - segments[0].time;
    // Neighbours share half of their samples. The weights are inverse variances.
    let scatter = fit.inverse[1].sqrt();
    (fit.coefficients[1] * span).abs() <= CHANGE * amplitude + SCATTER * 1.2 * scatter * span
}

/// Slope (rad per sample) and intercept (rad) of the straight line through the phases; `None` if they do not lie on
/// one.
fn in_phase(segments: &[Segment]) -> Option<(f64, f64)> {
    // From the end, where the motion is smallest, each phase is taken by the whole turn that comes nearest to the
    // line through those after it.
    let weights: Vec<f64> = weights(segments).collect();
    let mut points: Vec<(f64, f64, [f64; 2])> = Vec::new();
    for (segment, weight) in segments.iter().zip(&weights).rev() {
        let expected = match points.as_slice() {
            [] => segment.phase,
            [(_, phase, _)] | [_, (_, phase, _)] => *phase,
            _ => LeastSquares::of(&points)?.at(&[1.0, segment.time]),
        };
        let turns = ((expected - segment.phase) / TAU).round();
        points.push((*weight, segment.phase + TAU * turns, [1.0, segment.time]));
    }
    let fit = LeastSquares::of(&points)?;
    let on_line = points.iter().zip(segments.iter().rev()).all(|((_, phase, functions), segment)| {
        (phase - fit.at(functions)).abs() <= PHASE + SCATTER * (segment.scatter / segment.amplitude).min(PI / SCATTER)
    });
    on_line.then_some((fit.coefficients[1], fit.coefficients[0]))
}
