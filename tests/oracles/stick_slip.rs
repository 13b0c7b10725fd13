//! Motions under every kind of law and force, event by event, sample by sample, with the work done.

use fmm_friction::{
    AccelerationCoulomb, Berger, CoulombStatic, MakkarDixon, MaxwellSlip, PowerLaw, ShiftedMakkarDixon, SlidingLaw,
    Stribeck, Viscous,
};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, Event, EventKind, Exact, Excitation, Mode, RungeKutta, Sampling, Scenario, Trajectory};
use serde_json::Value;

use crate::oracle::{number, numbers, read};

/// A file and the machine it describes.
struct Case {
    file: Value,
    /// The reference's own tolerances (s, m, m/s).
    tolerance: [f64; 3],
}

impl Case {
    fn read(name: &str) -> Self {
        let file = read(name);
        let tolerance = ["abs_t_s", "abs_x_m", "abs_v_m_s"].map(|key| number(&file["tolerance"][key]));
        Self { file, tolerance }
    }

    fn parameter(&self, name: &str) -> f64 {
        number(&self.file["params"][name])
    }

    fn scenario<L>(&self, law: L, normal_load: f64) -> Scenario<f64, L> {
        let linear = self.parameter("c1") + 2.0 * self.parameter("zeta");
        let damping = Damping::new(linear, self.parameter("c2")).unwrap();
        let machine = Oscillator::new(self.parameter("m"), self.parameter("k")).unwrap().with_damping(damping);
        let start = &self.file["initial"];
        Scenario::new(machine, law, normal_load).unwrap().starting_at(number(&start["x"]), number(&start["v"])).unwrap()
    }

    fn run<L>(&self, engine: &impl Engine<f64, L>, scenario: &Scenario<f64, L>) -> Trajectory {
        let mut times = numbers(&self.file["samples"]["t"]);
        times.push(number(&self.file["t_end"]).max(times[times.len() - 1]));
        engine.run(scenario, &Sampling::at(times).unwrap().with_work()).unwrap()
    }

    fn check<L>(&self, engine: &impl Engine<f64, L>, scenario: &Scenario<f64, L>) {
        let motion = self.run(engine, scenario);
        let [time, position, velocity] = self.tolerance;
        let expected = self.file["events"].as_array().unwrap();
        let list = || motion.events().iter().map(|event| (event.time, event.kind)).collect::<Vec<_>>();
        assert_eq!(motion.events().len(), expected.len(), "number of events: {:?}", list());
        for (index, (event, expected)) in motion.events().iter().zip(expected).enumerate() {
            let off = (event.time - number(&expected["t"]), event.position - number(&expected["x"]));
            let velocity_off = event.velocity - number(&expected["v"]);
            assert!(off.0.abs() <= time, "event {index} at {} s is {:e} s off", event.time, off.0);
            assert!(off.1.abs() <= position, "event {index} at {} s is {:e} m off", event.time, off.1);
            assert!(velocity_off.abs() <= velocity, "event {index} at {} s is {velocity_off:e} m/s off", event.time);
            assert!(is_kind(event, expected), "event {index} at {} s is {:?}, not {expected}", event.time, event.kind);
        }
        let samples = &self.file["samples"];
        for (state, got) in motion.states().iter().enumerate() {
            for (got, expected) in got.values().iter().zip(numbers(&samples[format!("z{state}")])) {
                assert!((got - expected).abs() <= position, "deflection {state} is {got:e} m, not {expected:e} m");
            }
        }
        let column = |name: &str| numbers(&samples[name]);
        let (times, x, v) = (column("t"), column("x"), column("v"));
        let works = [column("W_friction"), column("W_viscous"), column("W_external")];
        // Powers are integrated over the same motion; energies of these machines are below 10 J.
        for (index, at) in times.iter().enumerate() {
            let off = motion.position().values()[index] - x[index];
            assert!(off.abs() <= position, "at {at} s the position is {off:e} m off");
            let off = motion.velocity().values()[index] - v[index];
            assert!(off.abs() <= velocity, "at {at} s the velocity is {off:e} m/s off");
            let work = motion.work(index).unwrap();
            for (name, got, expected) in [
                ("friction", work.friction, works[0][index]),
                ("viscous", work.viscous, works[1][index]),
                ("external", work.external, works[2][index]),
            ] {
                let off = got - expected;
                assert!(
                    off.abs() <= 20.0 * velocity * (1.0 + expected.abs()),
                    "at {at} s the {name} work is {off:e} J off"
                );
            }
        }
    }
}

/// True if a name of a mode is that of sliding in the event's direction.
fn is_along(event: &Event, name: &str) -> bool {
    match event.next.direction().map(|direction| direction.sign() > 0.0) {
        Some(true) => name == "slip+",
        Some(false) => name == "slip-",
        None => name == "stick",
    }
}

/// True if an event is what the file says it is.
fn is_kind(event: &Event, expected: &Value) -> bool {
    let next = &expected["next_mode"];
    let name = next.as_str().or(next[1].as_str()).or(next[0].as_str()).unwrap();
    let branch = next[1].as_str().and(next[0].as_str()).is_none_or(|branch| match branch {
        "acc" => matches!(event.next, Mode::Gaining(_)),
        "const" => matches!(event.next, Mode::Steady(_)),
        "dec" => matches!(event.next, Mode::Losing(_)),
        _ => false,
    });
    let kind = match expected["kind"].as_str().unwrap() {
        "start" => event.kind == EventKind::Start,
        "zero_velocity" => matches!(event.kind, EventKind::Reversal | EventKind::Stop),
        "breakaway+" | "breakaway-" => event.kind == EventKind::Breakaway,
        "acc_end" | "const_to_dec" => event.kind == EventKind::BranchChange,
        kind => matches!(event.kind, EventKind::Yield(index) if kind == format!("yield{index}")),
    };
    is_along(event, name) && branch && kind
}

/// The file's motion under a law of the sliding speed, by the Runge-Kutta engine.
fn integrated<L: SlidingLaw<f64>>(name: &str, law: impl Fn(&Case) -> L, normal_load: &str) {
    let case = Case::read(name);
    let load = if normal_load.is_empty() { 1.0 } else { case.parameter(normal_load) };
    case.check(&RungeKutta::default(), &case.scenario(law(&case), load));
}

#[test]
fn berger() {
    let law = |case: &Case| Berger::new(case.parameter("mu0"), case.parameter("mu1"), case.parameter("alpha")).unwrap();
    integrated("berger_free_decay_16mm", law, "N");
}

#[test]
fn stribeck() {
    let parameters = |case: &Case| ["Fc", "Fs", "vs", "F2"].map(|name| case.parameter(name));
    integrated(
        "stribeck_gauss_free_decay",
        |case| {
            let [sliding, breakaway, speed, viscous] = parameters(case);
            Stribeck::new(sliding, breakaway, speed, 2.0, viscous).unwrap()
        },
        "",
    );
}

#[test]
fn quadratic_drag() {
    integrated("quadratic_drag_free_decay", |_| Viscous::new(0.0).unwrap(), "");
}

fn makkar_dixon(case: &Case) -> MakkarDixon {
    let [g1, g2, g3, g4, g5] = numbers(&case.file["params"]["gamma"])[..] else { panic!("five parameters") };
    MakkarDixon::five(g1, g2, g3, g4, g5).unwrap()
}

#[test]
fn makkar_dixon_with_a_shift_sticks() {
    integrated("makkar_dixon_shifted_free_decay", |case| ShiftedMakkarDixon::new(makkar_dixon(case)), "N");
}

#[test]
fn makkar_dixon_as_printed_creeps() {
    let mut case = Case::read("makkar_dixon_raw_free_decay");
    // The file allows its last reversals, of motions below 1e-12 m, this much; the first are held to the others' 1e-11
    // s.
    case.tolerance[0] = number(&case.file["tolerance"]["last_events_abs_t_s"]);
    let scenario = case.scenario(makkar_dixon(&case), case.parameter("N"));
    case.check(&RungeKutta::default(), &scenario);
    let motion = case.run(&RungeKutta::default(), &scenario);
    for (event, expected) in motion.events().iter().zip(case.file["events"].as_array().unwrap()).take(10) {
        let off = event.time - number(&expected["t"]);
        assert!(off.abs() <= number(&case.file["tolerance"]["abs_t_s"]), "at {} s: {off:e} s", event.time);
    }
}

#[test]
fn power_law() {
    let case = Case::read("power_law_free_decay");
    let law = PowerLaw::new(case.parameter("a"), case.parameter("p"), case.parameter("b")).unwrap();
    let scenario = case.scenario(law, case.parameter("N")).starting_at(0.0, case.parameter("v0")).unwrap();
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(1.1, 2).unwrap()).unwrap();
    let turns = case.file["turning_points"].as_array().unwrap();
    assert!(motion.events().len() > turns.len());
    for (event, turn) in motion.events()[1..].iter().zip(turns) {
        let off = (event.time - number(&turn["t"]), event.position - number(&turn["x"]));
        assert!(off.0.abs() <= case.tolerance[0] && off.1.abs() <= case.tolerance[1], "{off:?} off");
    }
}

#[test]
fn friction_that_depends_on_the_acceleration() {
    let case = Case::read("accel_hysteretic_free_decay");
    let law = AccelerationCoulomb::new(case.parameter("mu1"), case.parameter("mu2")).unwrap();
    let scenario = case.scenario(law, case.parameter("N"));
    case.check(&Exact, &scenario);
    Case { tolerance: [1e-11, 1e-12, 1e-11], ..case }.check(&RungeKutta::default(), &scenario);
}

/// The motion of a linear machine with two levels by both engines, the second to the tolerance of a numerical one.
fn both(case: Case, scenario: &Scenario<f64, CoulombStatic>) {
    case.check(&Exact, scenario);
    let numerical = [1e-11, 1e-12, 1e-11];
    let tolerance = [0, 1, 2].map(|i| case.tolerance[i].max(numerical[i] * (1.0 + number(&case.file["t_end"]))));
    Case { tolerance, ..case }.check(&RungeKutta::default(), scenario);
}

#[test]
fn half_sine_impacts() {
    for name in ["impact_half_sine_low", "impact_half_sine_medium"] {
        let case = Case::read(name);
        let law = CoulombStatic::new(case.parameter("F"), case.parameter("F")).unwrap();
        let blow = Excitation::half_sine(case.parameter("P"), case.parameter("T_pulse")).unwrap();
        let scenario = case.scenario(law, 1.0).driven_by(blow);
        both(case, &scenario);
    }
}

#[test]
fn stick_slip_under_a_ramp() {
    let case = Case::read("breakaway_ramp");
    let law = CoulombStatic::new(case.parameter("Fd"), case.parameter("Fs")).unwrap();
    let scenario = case.scenario(law, 1.0).driven_by(Excitation::ramp(case.parameter("ramp_rate")).unwrap());
    both(case, &scenario);
}

#[test]
fn stick_slip_under_a_wave() {
    for name in ["forced_stick_slip_r03", "forced_stick_slip_r05", "forced_non_stop"] {
        let case = Case::read(name);
        let law = CoulombStatic::new(case.parameter("F"), case.parameter("F")).unwrap();
        let wave = Excitation::harmonic(case.parameter("P"), case.parameter("Omega"), case.parameter("phi")).unwrap();
        let scenario = case.scenario(law, 1.0).driven_by(wave);
        both(case, &scenario);
    }
}

#[test]
fn a_block_on_a_belt() {
    let case = Case::read("belt_static_kinetic");
    let law = CoulombStatic::new(case.parameter("Fk"), case.parameter("Fs")).unwrap();
    let scenario = case.scenario(law, 1.0).driven_by(Excitation::belt(case.parameter("vb")).unwrap());
    both(case, &scenario);
}

#[test]
fn elements_that_yield() {
    let case = Case::read("maxwell_slip_free_decay");
    let list = |name: &str| numbers(&case.file["params"][name]);
    let elements: Vec<_> = list("k_i").into_iter().zip(list("W_i")).collect();
    let scenario = case.scenario(MaxwellSlip::new(&elements).unwrap(), 1.0);
    case.check(&Exact, &scenario);
}

/// Every cell of the table for which a symmetric motion without stops exists: from its start, the first zero velocity
/// comes half a period later at the mirror image.
#[test]
fn den_hartog() {
    let file = read("den_hartog_non_stop");
    let cells = file["amplitude"].as_array().unwrap().iter().filter(|cell| cell["non_stop_solution"] == true);
    let mut count = 0;
    for cell in cells {
        let [ratio, friction, zeta] = ["r", "F_over_P", "zeta"].map(|name| number(&cell[name]));
        let [amplitude, phase] = ["X_k_over_P", "phi_rad"].map(|name| number(&cell[name]));
        let damping = Damping::linear(2.0 * zeta).unwrap();
        let machine = Oscillator::new(1.0, 1.0).unwrap().with_damping(damping);
        let law = CoulombStatic::new(friction, friction).unwrap();
        let wave = Excitation::harmonic(1.0, ratio, phase).unwrap();
        let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(amplitude, 0.0).unwrap().driven_by(wave);
        let half_period = std::f64::consts::PI / ratio;
        let sampling = Sampling::uniform(1.01 * half_period, 2).unwrap();
        let exact = Exact.run(&scenario, &sampling).unwrap();
        let stepped = RungeKutta::default().run(&scenario, &sampling).unwrap();
        // The table's own 1e-12; the engines start from its values, and a turn near rest magnifies their rounding.
        for (engine, motion, tolerance) in [("exact", exact, 1e-11), ("stepped", stepped, 1e-10)] {
            let case = format!("{engine}, r = {ratio}, F/P = {friction}, ζ = {zeta}");
            let event = motion.events().get(1).unwrap_or_else(|| panic!("{case}: no turn"));
            assert!((event.time / half_period - 1.0).abs() < tolerance, "{case}: turns at {} s", event.time);
            assert!((event.position / amplitude + 1.0).abs() < tolerance, "{case}: turns at {} m", event.position);
        }
        count += 1;
    }
    assert!(count > 100, "{count} cells");
}
