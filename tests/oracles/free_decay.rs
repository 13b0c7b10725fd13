//! Free decay with Coulomb friction, with and without viscous damping, and exact ties.

use fmm_sim::{Direction, Engine, Event, EventKind, Exact, Mode, Sampling};
use serde_json::Value;

use crate::oracle::{number, numbers, read, scenario};

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Slip(Direction::Negative) => "slip-",
        Mode::Slip(Direction::Positive) => "slip+",
        Mode::Stick => "stick",
        _ => "other",
    }
}

fn events_agree(events: &[Event], expected: &Value, tolerance: &Value) {
    let expected = expected.as_array().unwrap();
    assert_eq!(events.len(), expected.len(), "number of events");
    for (event, expected) in events.iter().zip(expected) {
        let time = event.time - number(&expected["t"]);
        let position = event.position - number(&expected["x"]);
        assert!(time.abs() <= number(&tolerance["abs_t_s"]), "event at {} s is {time:e} s off", event.time);
        assert!(position.abs() <= number(&tolerance["abs_x_m"]), "event at {} s is {position:e} m off", event.time);
        assert_eq!(mode_name(event.next), expected["next_mode"].as_str().unwrap(), "mode after {} s", event.time);
        let kind = match (expected["kind"].as_str().unwrap(), event.next) {
            ("start", _) => EventKind::Start,
            (_, Mode::Stick) => EventKind::Stop,
            _ => EventKind::Reversal,
        };
        assert_eq!(event.kind, kind, "kind at {} s", event.time);
    }
}

fn file_agrees(name: &str) {
    let file = read(name);
    let (tolerance, samples) = (&file["tolerance"], &file["samples"]);
    let scenario = scenario::<f64>(&file["params"]);
    let end = number(&file["t_end"]);

    // The sample times of the files are multiples of 0.1 ms.
    let interval = 1e-4;
    let motion = Exact.run(&scenario, &Sampling::uniform(interval, (end / interval) as usize + 2).unwrap()).unwrap();
    events_agree(motion.events(), &file["events"], tolerance);
    assert_eq!(motion.half_cycles() as f64, number(&file["n_half_swings"]));

    let (times, positions, velocities) = (numbers(&samples["t"]), numbers(&samples["x"]), numbers(&samples["v"]));
    for ((time, x), v) in times.iter().zip(&positions).zip(&velocities) {
        let index = (time / interval).round() as usize;
        assert!((index as f64 * interval - time).abs() < 1e-15, "sample time {time} s is not on the grid");
        let position = motion.position().values()[index] - x;
        let velocity = motion.velocity().values()[index] - v;
        assert!(position.abs() <= number(&tolerance["abs_x_m"]), "at {time} s the position is {position:e} m off");
        assert!(velocity.abs() <= number(&tolerance["abs_v_m_s"]), "at {time} s the velocity is {velocity:e} m/s off");
    }
}

#[test]
fn coulomb() {
    file_agrees("coulomb_free_decay");
}

#[test]
fn coulomb_and_viscous() {
    file_agrees("coulomb_viscous_free_decay_mc");
}

#[test]
fn exact_ties() {
    let file = read("coulomb_ties");
    for case in file["cases"].as_array().unwrap() {
        let label = case["label"].as_str().unwrap();
        let scenario = scenario::<f64>(&case["params"]);
        let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 1000).unwrap()).unwrap();
        let rest = motion.rest().unwrap_or_else(|| panic!("{label}: no stop"));
        assert_eq!(rest.position, number(&case["x_stop"]), "{label}");
        assert!((rest.time - number(&case["t_stop"])).abs() <= number(&file["tolerance"]["abs_t_s"]), "{label}");
        assert_eq!(motion.half_cycles() as f64, number(&case["n_half_swings"]), "{label}");
        assert_eq!(rest.margin(), 0.0, "{label}: the load equals the static level");
    }
}
