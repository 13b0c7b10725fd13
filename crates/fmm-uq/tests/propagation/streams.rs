//! The same bits for any number of threads and any division of the trials, and every way in which a run can go wrong.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use fmm_uq::{
    Adaptive, Distribution, FailureKind, Input, Inputs, MonteCarlo, OutputSample, PartialRun, UncertaintyError,
};

fn inputs() -> Inputs {
    Inputs::new([
        Input::new("a", 1.0, 0.1, "m").unwrap(),
        Input::of("b", Distribution::student_t(2.0, 0.2, 5.0).unwrap(), "m").unwrap(),
        Input::of("c", Distribution::rectangular(0.0, 1.0).unwrap(), "m").unwrap(),
    ])
    .unwrap()
    .with_correlations(&[("a", "b", 0.5)])
    .unwrap()
}

fn model(x: &[f64]) -> [f64; 2] {
    [x[0] * x[1] + x[2], x[0] / x[1].abs().max(0.1)]
}

fn bits(sample: &OutputSample) -> Vec<u64> {
    let values = (0..sample.outputs()).flat_map(|j| sample.values(j).unwrap());
    let figures = (0..sample.outputs())
        .flat_map(|j| [sample.estimate(j).unwrap(), sample.moments(j).unwrap().standard_deviation().unwrap()])
        .collect::<Vec<_>>();
    values.chain(&figures).map(|x| x.to_bits()).collect()
}

#[cfg(feature = "rayon")]
#[test]
fn threads_do_not_change_a_bit() {
    let inputs = inputs();
    let fixed = MonteCarlo::new(&inputs, 54_321).unwrap().with_seed(3);
    let rule = Adaptive::to_tolerance(0.01).unwrap();
    let adaptive = MonteCarlo::adaptive(&inputs, rule).with_seed(3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (bits(&fixed.run(model).unwrap()), bits(&adaptive.run(|x| x[0] + x[2]).unwrap())))
    };
    let one = on(1);
    for threads in [2, 4] {
        assert!(on(threads) == one, "{threads} threads");
    }
}

#[test]
fn shards_do_not_change_a_bit() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 54_321).unwrap().with_seed(3);
    let whole = bits(&run.run(model).unwrap());
    for parts in [1, 2, 7, 100] {
        let shards: Vec<PartialRun> = (0..parts).map(|k| run.run_blocks(run.shard(k, parts), model).unwrap()).collect();
        assert_eq!(shards.iter().map(PartialRun::trials).sum::<u64>(), 54_321);
        let merged = shards.into_iter().rev().reduce(|a, b| a.merge(b).unwrap()).unwrap();
        assert!(bits(&run.finish(merged).unwrap()) == whole, "{parts} shards");
    }
}

#[test]
fn an_adaptive_run_stops_at_the_same_block_in_shards() {
    let inputs = inputs();
    let run = MonteCarlo::adaptive(&inputs, Adaptive::to_digits(1).unwrap());
    let whole = run.run(model).unwrap();
    let first = run.run_blocks(0..57, model).unwrap();
    let missing = run.finish(first.clone());
    assert!(matches!(missing, Err(UncertaintyError::PartialRun { block: Some(57), .. })), "{missing:?}");
    let merged = run.run_blocks(57..400, model).unwrap().merge(first).unwrap();
    assert_eq!(run.finish(merged).unwrap(), whole);
}

#[cfg(feature = "serde")]
#[test]
fn parts_travel_as_text() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 5500).unwrap().with_allowed_failures(0.5).unwrap();
    let sometimes = |x: &[f64]| if x[2] < 0.9 { Ok(model(x)) } else { Err("too large") };
    let parts = (0..3).map(|k| serde_json::to_string(&run.run_blocks(run.shard(k, 3), sometimes).unwrap()).unwrap());
    let read = parts.map(|text| serde_json::from_str::<PartialRun>(&text).unwrap());
    let merged = read.reduce(|a, b| b.merge(a).unwrap()).unwrap();
    assert_eq!(run.finish(merged).unwrap(), run.run(sometimes).unwrap());

    let text = serde_json::to_string(&run.run_blocks(0..1, sometimes).unwrap()).unwrap();
    let start = text.find("\"values\":\"").unwrap() + 10;
    let with_values = |digits: &str| format!("{}{digits}{}", &text[..start], &text[start + 3..]);
    for (damage, damaged) in [
        ("its number of trials", text.replacen("\"trials\":1000", "\"trials\":1001", 1)),
        ("its number of values", text.replacen("\"trials\":1000", "\"trials\":999", 1)),
        ("hexadecimal digits", with_values("xyz")),
        ("no whole number of values", with_values("")),
        ("a value that is not finite", with_values("7ff")),
        ("unknown field", text.replacen("\"seed\":", "\"sead\":1,\"seed\":", 1)),
    ] {
        let error = serde_json::from_str::<PartialRun>(&damaged).unwrap_err().to_string();
        assert!(error.contains(damage), "{damage}: {error}");
    }
}

/// Every bit of every value survives the way through text, also of values that decimal digits are hard on, and parts
/// give the bits of one run whatever the order they are merged in.
#[cfg(feature = "serde")]
#[test]
fn parts_travel_as_text_to_the_last_bit_and_merge_in_any_order() {
    let run = MonteCarlo::new(&inputs(), 5500).unwrap().with_seed(9);
    let awkward = |x: &[f64]| {
        let tiny = if x[2] < 0.1 { -0.0 } else { f64::from_bits(x[2].to_bits() >> 12) };
        [x[0] / 3.0, tiny, x[1].powi(40) * 1e100]
    };
    let whole = run.run(awkward).unwrap();
    let parts: Vec<PartialRun> = (0..4).map(|k| run.run_blocks(run.shard(k, 4), awkward).unwrap()).collect();
    let texts: Vec<String> = parts.iter().map(|part| serde_json::to_string(part).unwrap()).collect();
    let read: Vec<PartialRun> = texts.iter().map(|text| serde_json::from_str(text).unwrap()).collect();
    assert_eq!(read, parts);
    assert_eq!(read.iter().map(|part| serde_json::to_string(part).unwrap()).collect::<Vec<_>>(), texts);
    for a in 0..4 {
        for b in (0..4).filter(|&b| b != a) {
            for c in (0..4).filter(|&c| c != a && c != b) {
                let d = 6 - a - b - c;
                let merge = |i: usize, j: usize| read[i].clone().merge(read[j].clone()).unwrap();
                // One by one, and pair by pair.
                let chain = merge(a, b).merge(read[c].clone()).unwrap().merge(read[d].clone()).unwrap();
                for merged in [chain, merge(a, b).merge(merge(c, d)).unwrap()] {
                    assert!(bits(&run.finish(merged).unwrap()) == bits(&whole), "order {a} {b} {c} {d}");
                }
            }
        }
    }
    let mut twice: serde_json::Value = serde_json::from_str(&texts[0]).unwrap();
    let blocks = twice["blocks"].as_array_mut().unwrap();
    blocks.push(blocks[0].clone());
    let error = serde_json::from_value::<PartialRun>(twice).unwrap_err().to_string();
    assert!(error.contains("block 0 is in both partial results"), "{error}");
}

#[test]
fn parts_must_belong_together() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 4000).unwrap();
    let part = run.run_blocks(0..2, model).unwrap();
    let twice = part.clone().merge(run.run_blocks(1..3, model).unwrap());
    assert!(matches!(twice, Err(UncertaintyError::PartialRun { block: Some(1), .. })), "{twice:?}");
    let seed = part.clone().merge(run.clone().with_seed(1).run_blocks(2..4, model).unwrap()).unwrap_err();
    assert_eq!(
        seed.to_string(),
        "partial results belong together only if their seeds agree, but one has 0 and another 1"
    );
    let other = inputs.clone().with_correlations(&[("a", "b", 0.6)]).unwrap();
    let other = MonteCarlo::new(&other, 4000).unwrap().run_blocks(2..4, model).unwrap();
    assert!(matches!(part.clone().merge(other.clone()), Err(UncertaintyError::PartialRun { block: None, .. })));
    assert!(matches!(run.finish(other), Err(UncertaintyError::PartialRun { block: None, .. })));
    let single = run.run_blocks(2..4, |x| x[0]).unwrap();
    assert!(matches!(part.clone().merge(single), Err(UncertaintyError::PartialRun { block: None, .. })));
    assert!(matches!(run.finish(part), Err(UncertaintyError::PartialRun { block: Some(2), .. })));
}

#[test]
fn a_single_failure_is_an_error_and_can_be_replayed() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 100_000).unwrap();
    let limited = |x: &[f64]| if x[0] < 1.35 { Ok(x[0]) } else { Err("out of reach") };
    let error = run.run(limited).unwrap_err();
    let UncertaintyError::TooManyFailures { failed: 1, first, .. } = &error else { panic!("{error}") };
    assert_eq!(first.kind, FailureKind::Error("out of reach".to_owned()));
    let x = run.trial_inputs(first.block, first.trial).unwrap();
    assert!(limited(&x).is_err(), "{x:?}");
    assert_eq!(run.trial_inputs(0, 1000), None);
    // Twice the same failure, whatever the threads met first.
    assert_eq!(error.to_string(), run.run(limited).unwrap_err().to_string());
}

#[test]
fn failures_are_counted_by_kind() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 20_000).unwrap().with_allowed_failures(0.4).unwrap();
    let fragile = |x: &[f64]| match x[2] {
        c if c < 0.1 => Err("low"),
        c if c < 0.3 => Ok([f64::NAN]),
        _ => Ok([x[2]]),
    };
    let sample = run.run(fragile).unwrap();
    let failures = sample.failures();
    assert_eq!(sample.values(0).unwrap().len() as u64 + failures.count(), 20_000);
    let of = |kind: &FailureKind| failures.by_kind().iter().find(|(k, _)| k == kind).unwrap().1 as f64;
    // Binomial: standard deviations 42 and 57.
    assert!((of(&FailureKind::Error("low".to_owned())) - 2000.0).abs() < 210.0);
    assert!((of(&FailureKind::NotFinite { output: 0 }) - 4000.0).abs() < 285.0);
    for failure in failures.first() {
        let x = run.trial_inputs(failure.block, failure.trial).unwrap();
        assert_eq!(fragile(&x).is_err(), failure.kind == FailureKind::Error("low".to_owned()), "{failure}");
    }
    let refused = run.clone().with_allowed_failures(0.2).unwrap().run(fragile).unwrap_err();
    assert!(matches!(refused, UncertaintyError::TooManyFailures { trials: 20_000, .. }), "{refused}");
    // A message of its own for each failure must not fill the memory.
    let wordy = run.run(|x: &[f64]| if x[2] < 0.1 { Err(format!("{x:?}")) } else { Ok(x[0]) }).unwrap();
    assert!(wordy.failures().by_kind().len() <= 33 && wordy.failures().count() > 1500);
    let never = run.run(|_: &[f64]| Err::<f64, _>("never"));
    assert!(matches!(never, Err(UncertaintyError::TooManyFailures { .. })));
}

#[test]
fn a_changing_number_of_outputs_is_a_failure() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 2000).unwrap();
    let error = run.run(|x: &[f64]| vec![1.0; if x[2] < 0.5 { 1 } else { 2 }]).unwrap_err();
    assert!(error.to_string().contains("the number of outputs changed"), "{error}");
    assert!(run.run(|_: &[f64]| Vec::new()).is_err());
}

#[test]
fn progress_is_told_and_can_end_a_run() {
    let inputs = inputs();
    let most = AtomicU64::new(0);
    let watch = |progress: fmm_uq::Progress| {
        assert_eq!(progress.planned, Some(10_050));
        most.fetch_max(progress.done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let run = MonteCarlo::new(&inputs, 10_050).unwrap();
    let told = run.clone().with_progress(&watch).run(model).unwrap();
    assert_eq!((most.load(Ordering::Relaxed), told), (10_050, run.run(model).unwrap()));
    let stop = |progress: fmm_uq::Progress| {
        if progress.done < 500 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let error = run.clone().with_progress(&stop).run(model).unwrap_err();
    let UncertaintyError::Cancelled { trials } = error else { panic!("{error}") };
    assert!((500..10_050).contains(&trials), "{trials}");
}

#[test]
fn impossible_runs_are_refused() {
    let inputs = inputs();
    assert!(matches!(MonteCarlo::new(&inputs, 0), Err(UncertaintyError::Invalid { .. })));
    assert!(matches!(MonteCarlo::new(&inputs, u64::MAX), Err(UncertaintyError::Invalid { .. })));
    let run = MonteCarlo::new(&inputs, 100).unwrap();
    for share in [-0.1, 1.0, f64::NAN] {
        assert!(run.clone().with_allowed_failures(share).is_err(), "{share}");
    }
    let sample = run.run(model).unwrap();
    for level in [0.0, 1.0, -1.0, f64::NAN] {
        let error = sample.symmetric_interval(0, level).unwrap_err();
        assert!(matches!(error, UncertaintyError::Invalid { .. }), "{error}");
        assert!(sample.shortest_interval(0, level).is_err() && sample.ellipsoid(level).is_err());
    }
    assert!(matches!(
        sample.symmetric_interval(0, 0.99),
        Err(UncertaintyError::TooFewTrials { ref what, trials: 100 }) if what.ends_with("at least 200 are needed")
    ));
    assert!(
        matches!(sample.estimate(2), Err(UncertaintyError::Invalid { what }) if what.starts_with("there is no output 2;"))
    );
    assert!(Adaptive::to_digits(0).is_err() && Adaptive::to_tolerance(f64::NAN).is_err());
    assert!(MonteCarlo::new(&inputs, 1).unwrap().run(model).unwrap().standard_uncertainty(0).is_err());
    assert!(run.run(|_| [1e300, 0.0]).is_ok());
    assert!(run.run(|x| x[0] * 1e200).is_err(), "squares overflow");
}
