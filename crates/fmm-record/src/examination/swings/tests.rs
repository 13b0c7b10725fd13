//! Swings of synthetic and measured records against what is known of them.

use super::*;
use crate::record::Record;
use crate::tests::synthetic::{CoulombDecay, pendulum, pendulum_velocity, quantised, sampled, wheel};
use crate::tests::synthetic::{Decay, Noise, Recorded, measured_records};

const DECAY: CoulombDecay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.13, release: 0.3 };

/// Turning points of the displacement: ±(A − 2kd) at k half cycles after the release.
#[test]
fn displacement_with_friction_has_its_peaks() {
    for noise in [0.0, 1e-3, 0.05] {
        let record = sampled(1000.0, 20.0, Quantity::Displacement, noise, |t| 15.0 + DECAY.state(t).0);
        let swings = Swings::of(&record);
        // 38 half cycles; the one at the release has no extremum, the one at the stop does not turn.
        assert!((36..=37).contains(&swings.peaks().len()), "{} peaks", swings.peaks().len());
        for (k, peak) in swings.peaks().iter().enumerate().map(|(i, peak)| (i as f64 + 1.0, peak)) {
            let side = if peak.is_maximum { 1.0 } else { -1.0 };
            let (time, height) = (0.3 + k / 4.4, 10.0 - 2.0 * k * 0.13);
            // The curvature jumps at the turn by 2d: 3 w d/(8 A) of phase with w = π/6, to the second order in
            // value. A fit over 77 samples averages noise to 1.5/√77 in value and some 2.5/(w √77 A) in phase.
            let phase = 0.22 * 0.13 / height + 5.0 * noise * 0.55 / height;
            let error = (peak.time - time).abs() * 13.8;
            assert!(error < phase + 1e-3, "peak {k}, noise {noise}: {error} rad of {phase} rad");
            let error = (side * (peak.value - 15.0) - height).abs();
            assert!(error < 3e-3 + 5.0 * 0.17 * noise, "peak {k}, noise {noise}: {error}");
        }
    }
}

#[test]
fn velocity_with_friction_crosses_its_offset_at_the_turns_and_rests_without_peaks() {
    let scale = 13.823 * 10.0;
    for (noise, step) in [(0.0, None), (1e-3, None), (0.02, None), (1e-3, Some(5e-3)), (1e-5, Some(5e-3))] {
        let clean = sampled(1000.0, 45.0, Quantity::Velocity, noise, |t| 1.5 + DECAY.state(t).1 / scale);
        let record = step.map_or(clean.clone(), |step| quantised(&clean, step));
        let swings = Swings::of(&record);
        let (noise, count) = (noise + step.unwrap_or(0.0) / 3.0, swings.peaks().len());
        assert!((35..=38).contains(&count), "noise {noise}: {count} peaks");
        assert!(swings.peaks().iter().all(|peak| peak.time < DECAY.stop()), "a peak after the stop");
        for (k, crossing) in swings.crossings().iter().enumerate() {
            let height = 1.0 - 0.026 * (k as f64 + 1.0);
            let error = (crossing.time - (0.3 + (k as f64 + 1.0) / 4.4)).abs() * 13.8;
            // 2/√77 for the fit, and as much for the centre, from peaks with 1.5/√77 each.
            let allowed = 5.0 * noise * 0.3 / height + 2e-4 / height;
            assert!(error < allowed, "noise {noise}, crossing {k}: {error} rad of {allowed} rad");
            assert_eq!(crossing.is_rising, k % 2 == 0, "the first swing is negative");
        }
        let frequency = swings.frequency().unwrap();
        assert!((frequency - 2.2).abs() < 1e-3, "{frequency} Hz");
    }
}

#[test]
fn four_samples_per_half_cycle_are_enough() {
    let record =
        sampled(8.0 * 2.2 + 0.1, 60.0, Quantity::Velocity, 0.0, |t| 1.5 + (-0.02 * t).exp() * (13.823 * t).cos());
    let swings = Swings::of(&record);
    assert!((262..=264).contains(&swings.peaks().len()), "{} peaks", swings.peaks().len());
    assert!((swings.frequency().unwrap() - 2.2).abs() < 1e-4, "{:?} Hz", swings.frequency());
    for peak in swings.peaks() {
        let height = (peak.value - 1.5).abs() / (-0.02 * peak.time).exp();
        // The local half cycle is known to the sample only, which shows in second order.
        assert!((height - 1.0).abs() < 0.02, "{height} at {} s", peak.time);
    }
}

#[test]
fn spikes_ripple_and_drift_do_not_upset_the_swings() {
    let ripple = |t: f64| 0.05 * t + 0.3 * (std::f64::consts::TAU * 50.0 * t).sin();
    let record = sampled(1000.0, 12.0, Quantity::Velocity, 0.05, |t| DECAY.state(t).1 / 13.823 + ripple(t));
    let mut values = record.into_values();
    for i in [900, 901, 4500, 7002] {
        values[i] += 100.0;
    }
    let record = Record::sampled(1000.0, values, Quantity::Velocity, "mm/s").unwrap();
    let swings = Swings::of(&record);
    assert!((33..=38).contains(&swings.peaks().len()), "{} peaks", swings.peaks().len());
    assert!((swings.frequency().unwrap() - 2.2).abs() < 0.01, "{:?} Hz", swings.frequency());
}

#[cfg(feature = "mat")]
#[test]
fn fork_swings_as_others_found() {
    let swings = Swings::of(&crate::tests::synthetic::fork());
    assert_eq!(swings.peaks().len(), 37);
    // 0.62885 Hz from fits of the whole record by others.
    assert!((swings.frequency().unwrap() - 0.6288).abs() < 1e-3, "{:?} Hz", swings.frequency());
    for crossing in swings.crossings() {
        assert!((crossing.centre - 1.356).abs() < 0.01, "{} V at {} s", crossing.centre, crossing.time);
    }
}

#[test]
fn wheel_and_pendulum_swing_as_others_found() {
    let wheel = Swings::of(&wheel());
    // The record begins at the first of them.
    assert_eq!(wheel.peaks().len(), 10);
    // ω² = 222.4 1/s² (2.3735 Hz) from fits of the whole record by others.
    assert!((wheel.frequency().unwrap() - 2.3735).abs() < 0.01, "{:?} Hz", wheel.frequency());
    for record in [pendulum(), pendulum_velocity()] {
        let swings = Swings::of(&record);
        assert_eq!(swings.peaks().len(), 133);
        // Small swings have √64.08/2π = 1.2740 Hz; the first ones, of 1.6 rad, are 18 % longer.
        let periods: Vec<f64> = swings.crossings().windows(3).map(|c| c[2].time - c[0].time).collect();
        let last = periods.iter().rev().take(20).sum::<f64>() / 20.0;
        assert!((1.0 / last - 1.270).abs() < 0.005, "{} Hz", 1.0 / last);
        assert!((periods[0] * 1.274 - 1.18).abs() < 0.02, "{} s", periods[0]);
    }
}

#[test]
fn what_does_not_oscillate_has_no_swings() {
    for noise in [0.0, 1.0] {
        for f in [|_| 1.0, |t: f64| t, |t: f64| (-t).exp(), |t: f64| if t < 5.0 { 0.0 } else { 50.0 }] {
            let record = sampled(1000.0, 10.0, Quantity::Velocity, noise, f);
            assert!(Swings::of(&record).peaks().is_empty(), "{:?}", Swings::of(&record).peaks());
        }
    }
    for length in 1..8 {
        let record = Record::sampled(1.0, vec![1.0; length], Quantity::Velocity, "m/s").unwrap();
        assert_eq!(Swings::of(&record), Swings::default());
    }
}

/// A displacement that begins at its peak, turns once more, and stops: noise moves the first peak out of it.
#[test]
fn a_record_that_begins_at_its_peak_has_it() {
    let decay = CoulombDecay { frequency: 3.8, amplitude: 10.0, deadband: 2.5, release: 0.0 };
    let mut noise = Noise::new(5);
    for _ in 0..100 {
        let position = |i: i32| decay.state(f64::from(i) * 1e-3).0 + 0.02 * noise.normal();
        let record = Record::sampled(1000.0, (0..500).map(position).collect(), Quantity::Displacement, "mm").unwrap();
        let swings = Swings::of(&record);
        let [first, second] = swings.peaks() else { panic!("{:?}", swings.peaks()) };
        assert!(first.time.abs() < 4e-3 && (first.value - 10.0).abs() < 0.1, "{first:?}");
        assert!((second.value + 5.0).abs() < 0.1, "{second:?}");
    }
}

/// Ten samples a period, from the first peak on.
#[test]
fn few_samples_show_every_peak() {
    let decay = CoulombDecay { frequency: 10.0, amplitude: 10.0, deadband: 0.7, release: 0.0 };
    for rate in [80.0, 100.0, 140.0, 400.0] {
        let count = (rate * 0.36) as i32;
        let position = |i: i32| decay.state(f64::from(i) / rate).0;
        let record = Record::sampled(rate, (0..count).map(position).collect(), Quantity::Displacement, "mm").unwrap();
        let swings = Swings::of(&record);
        assert!((7..=8).contains(&swings.peaks().len()), "{rate} Hz: {:?}", swings.peaks());
        assert!((swings.peaks()[0].value - 10.0).abs() < 0.5, "{rate} Hz: {:?}", swings.peaks()[0]);
    }
}

/// Rest with noise before a release or before a blow; what turns in it is no swing.
#[test]
fn rest_before_a_motion_has_no_peaks() {
    type Motion<'a> = (&'a str, Quantity, &'a dyn Fn(f64) -> f64);
    const TRIALS: u32 = 500;
    let mut random = crate::tests::synthetic::Noise::new(17);
    let mut early = Vec::new();
    for trial in 0..TRIALS {
        let frequency = 0.5 + 6.0 * random.uniform();
        let begin = 0.3 + 2.0 * random.uniform();
        let decay =
            CoulombDecay { frequency, amplitude: 1.0, deadband: 0.01 + 0.03 * random.uniform(), release: begin };
        let (w, damping) = (std::f64::consts::TAU * frequency, 0.005 + 0.02 * random.uniform());
        let rate = frequency * 10f64.powf(1.2 + 1.3 * random.uniform());
        let noise = 10f64.powf(-3.5 + 3.0 * random.uniform());
        let step = (noise * 10f64.powf(-1.0 + 2.0 * random.uniform())).min(0.2);
        let ringing = |t: f64| if t < begin { 0.0 } else { (-damping * w * (t - begin)).exp() };
        let motions: [Motion<'_>; 4] = [
            ("displacement after a release", Quantity::Displacement, &|t| decay.state(t).0),
            ("velocity after a release", Quantity::Velocity, &|t| decay.state(t).1 / w),
            ("displacement after a blow", Quantity::Displacement, &|t| ringing(t) * (w * (t - begin)).sin()),
            ("velocity after a blow", Quantity::Velocity, &|t| ringing(t) * (w * (t - begin)).cos()),
        ];
        for (name, quantity, motion) in motions {
            let duration = begin + 20.0 / frequency;
            let record = crate::tests::synthetic::sampled_by(&mut random, rate, duration, quantity, noise, motion);
            let record = if trial % 2 == 0 { record } else { quantised(&record, step) };
            let swings = Swings::of(&record);
            let Some(first) = swings.peaks().first().map(|peak| peak.time) else { continue };
            // What jumps at the blow may be the first turning point, a sample early.
            if first < begin - 0.05 / frequency - 1.5 / rate {
                early.push(format!(
                    "trial {trial}, {name}: {first} s for {begin} s, {frequency} Hz at {rate} Hz, noise {noise}, \
                     step {step}"
                ));
            }
        }
    }
    assert!(early.is_empty(), "{} of {}:\n{}", early.len(), 4 * TRIALS, early.join("\n"));
}

fn of(record: &Record) -> Option<f64> {
    let (times, heights) = Swings::of(record).turns(record.quantity());
    Swings::period_change(&times, &heights)
}

#[test]
fn pendulums_have_one_and_others_have_none() {
    let all: Vec<Option<f64>> = measured_records().iter().map(of).collect();
    let [wheel, angle, velocity, small, ..] = all[..] else { panic!("{} records", all.len()) };
    // The half period of the small one falls from 0.391 s to 0.343 s, most of it in the last swings.
    let small = small.unwrap();
    assert!((-0.12..-0.04).contains(&small), "{small}");
    // Averages over 9 s each; the first period is 18 % longer than that of small swings.
    for change in [angle.unwrap(), velocity.unwrap()] {
        assert!((-0.18..-0.1).contains(&change), "{change}");
    }
    assert_eq!(wheel, None);
    assert!(all[4..].iter().all(Option::is_none), "the fork");
}

#[test]
fn decays_with_friction_and_noise_have_none() {
    let recorded = (0..600).map(Recorded::random).filter(|recorded| recorded.decay.creep.is_none());
    let alarms = recorded.filter(|recorded| of(&recorded.record).is_some()).count();
    assert_eq!(alarms, 0);
}

/// A half period that falls by 12 % over 8 to 15 half cycles, whose times have noise.
#[test]
fn a_fall_is_found_in_few_half_cycles() {
    for count in [9, 12, 16] {
        for seed in 0..20 {
            let random = &mut Noise::new(seed);
            let mut time = 0.0;
            let (mut times, mut swings) = (Vec::new(), Vec::new());
            for k in 0..count {
                let part = f64::from(k) / f64::from(count);
                let swing = 1.05 - part;
                // Noise of 1 % of the largest swing, averaged over some fifty samples.
                times.push(time + 0.4 / 3.1 * 0.003 * random.normal() / swing);
                swings.push(swing);
                time += 0.4 * (1.0 - 0.12 * part);
            }
            let change = Swings::period_change(&times, &swings);
            assert!(change.is_some_and(|change| (-0.14..-0.05).contains(&change)), "{count}: {change:?}");
        }
    }
}

/// A decay of constant period with noise, and with drift, a walk of the offset or hum beside it.
fn disturbed(seed: u64) -> Record {
    let random = &mut Noise::new(seed);
    let half_cycles = 8.0 + 30.0 * random.uniform();
    let decay = Decay { creep: None, ..Decay::random(random, half_cycles) };
    let noise = 1e-3 * 20f64.powf(random.uniform());
    let rate = 100.0 * 10f64.powf(random.uniform());
    let count = (half_cycles / 4.4 * (0.4 + 1.5 * random.uniform()) * rate) as usize;
    let (is_displacement, kind) = (random.uniform() < 0.5, random.next() % 4);
    let (mut drift, slowness, phase) = (0.0, 1.0 - 2.0 / rate, random.uniform());
    let values = decay.states(rate.recip(), count).into_iter().enumerate().map(|(i, (x, v))| {
        let beside = match kind {
            0 => 0.0,
            1 => {
                drift = slowness * drift + (1.0 - slowness * slowness).sqrt() * random.normal();
                drift
            }
            2 => {
                drift += random.normal() / rate.sqrt();
                drift
            }
            _ => (2.0 * PI * (50.0 * i as f64 / rate + phase)).sin(),
        };
        0.3 + if is_displacement { x } else { v } + noise * (beside + random.normal())
    });
    let quantity = if is_displacement { Quantity::Displacement } else { Quantity::Velocity };
    Record::sampled(rate, values.collect(), quantity, "1").unwrap()
}

/// At most one alarm in a thousand. A curve that merely differs from zero, with ends that are apart by chance,
/// raised seven here.
#[test]
fn records_without_a_change_raise_no_alarm() {
    let alarms = (0..2000).filter(|seed| of(&disturbed(*seed)).is_some()).count();
    assert!(alarms <= 2, "{alarms} alarms in 2000 records");
}

#[test]
fn few_turns_or_nonsense_have_none() {
    assert_eq!(Swings::period_change(&[], &[]), None);
    assert_eq!(Swings::period_change(&[1.0; 20], &[1.0; 20]), None);
    assert_eq!(Swings::period_change(&[f64::NAN; 20], &[0.0; 20]), None);
    let times: Vec<f64> = (0..7).map(|k| f64::from(k * k)).collect();
    assert_eq!(Swings::period_change(&times, &[1.0; 7]), None);
}
