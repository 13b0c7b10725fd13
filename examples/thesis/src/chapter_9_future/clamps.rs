//! A monolithic machine and an assembled one: what a ring-down tells of damping in the clamps.

use fmm_fit::{StraightLine, Weighting};
use fmm_friction::{Coulomb, MaxwellSlip};
use fmm_identify::{Experiment, Offset, Preparation};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine as _, Exact, Excitation, Sampling, Scenario};

use crate::printed::{EQUATION_5_5, INSTANTANEOUS_SLOPE, MACHINE, TABLE_1};
use crate::ring_down::{INTERVAL, motion, scenario, velocity_record, with_noise};
use crate::windows::{WindowFit, Windows};
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role, label};

/// White noise (m/s), displacement (m), and length (s) of the longest record.
const NOISE: f64 = 5e-4;
const RELEASE: f64 = 0.022;
const LONGEST: u32 = 80;
/// Lengths of the records that are looked at (s).
const LENGTHS: [u32; 3] = [5, 20, LONGEST];
/// How long the slipping clamps are pulled before the release (s), slowly.
const PULL: f64 = 20.0;
/// A slope of so many standard uncertainties is seen.
const SEEN: f64 = 3.0;

/// Two machines that differ in their clamps, and a third that has the damping of the second for another reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Machine {
    /// Linear damping alone.
    Monolithic,
    /// With the damping c₂|v| that Eq. 5.5 needs.
    Assembled,
    /// With clamps whose contact slips a little more the further the springs bend.
    Slipping,
}

impl Machine {
    fn name(self) -> &'static str {
        match self {
            Self::Monolithic => "monolithic, c₁",
            Self::Assembled => "assembled, c₁ + c₂|v|",
            Self::Slipping => "assembled, clamps slip",
        }
    }

    /// Velocity (m/s) from the release on, of a machine with `times` the mass.
    fn velocity(self, times: u32) -> Found<Vec<f64>> {
        let [mass, stiffness, _] = MACHINE;
        let mass = f64::from(times) * mass;
        let linear = EQUATION_5_5[1];
        let quadratic = match self {
            Self::Assembled => INSTANTANEOUS_SLOPE,
            Self::Monolithic | Self::Slipping => 0.0,
        };
        let damping = Damping::new(linear, quadratic)?;
        let samples = (f64::from(LONGEST) / INTERVAL).round() as usize + 1;
        if self == Self::Slipping {
            let (clamps, hold) = slipping_clamps()?;
            let machine = Oscillator::new(mass, stiffness - hold)?.with_damping(damping);
            // Pulled so slowly that it hardly swings, and let go.
            let pull = Excitation::sampled_force(PULL, vec![0.0, stiffness * RELEASE])?;
            let scenario = Scenario::new(machine, clamps, 1.0)?.driven_by(pull);
            let begin = (PULL / INTERVAL).round() as usize;
            let motion = Exact.run(&scenario, &Sampling::uniform(INTERVAL, begin + samples)?)?;
            return Ok(motion.velocity().values()[begin..].to_vec());
        }
        let machine = Oscillator::new(mass, stiffness)?.with_damping(damping);
        let scenario = scenario::<Coulomb>(machine, &[0.0], 1.0, (RELEASE, 0.0))?;
        Ok(motion::<Coulomb>(&scenario, &Sampling::uniform(INTERVAL, samples)?)?.velocity().values().to_vec())
    }
}

/// Maxwell elements that lose as much in a cycle as c₂|v| does at the machine's frequency, and their stiffness (N/m).
///
/// ```text
/// elements of equal stiffness that slide from 0 to X_y one after the other:  f(X) = K X − a X²,  a = K/(2 X_y)
/// loss in a cycle by Masing's rules 4/3 a X³ = π ω c_eq X²:                  c_eq = 4 a V/(3π ω²)
/// the same from c₂|v|:  c_eq = 8 c₂ V/(3π)                                   a = 2 c₂ ω²
/// ```
fn slipping_clamps() -> Found<(MaxwellSlip, f64)> {
    const ELEMENTS: usize = 25;
    /// X_y (m): a little more than the largest displacement.
    const REACH: f64 = 0.025;
    let [mass, stiffness, _] = MACHINE;
    let curvature = 2.0 * INSTANTANEOUS_SLOPE * stiffness / mass;
    let whole = 2.0 * curvature * REACH;
    let each = whole / ELEMENTS as f64;
    let slides_at = |element: usize| REACH * (element as f64 + 0.5) / ELEMENTS as f64;
    let elements: Vec<(f64, f64)> = (0..ELEMENTS).map(|element| (each, each * slides_at(element))).collect();
    Ok((MaxwellSlip::new(&elements)?, whole))
}

/// Results of windows of five cycles of one record.
struct Windowed {
    machine: Machine,
    /// By what the mass is multiplied.
    times: u32,
    /// How much of the record is used (s).
    length: u32,
    windows: Vec<WindowFit>,
    mass: f64,
    /// Damping against V, and frequency against V.
    damping: Option<StraightLine>,
    frequency: Option<StraightLine>,
}

impl Windowed {
    fn of(machine: Machine, times: u32, length: u32, velocity: &[f64]) -> Found<Self> {
        let mass = f64::from(times) * MACHINE[0];
        let preparation = Preparation::default().offset(Offset::Fixed(0.0)).to(f64::from(length));
        let decay = Experiment::ring_down(&velocity_record(velocity.to_vec())?, &preparation)?;
        let windows = Windows::of_cycles(5).fit(&decay)?;
        let speeds: Vec<f64> = windows.iter().map(|window| window.peak_velocity).collect();
        let line = |of: &dyn Fn(&WindowFit) -> (f64, f64)| -> Found<Option<StraightLine>> {
            let (values, u): (Vec<f64>, Vec<f64>) = windows.iter().map(of).unzip();
            if windows.len() < 2 {
                return Ok(None);
            }
            Ok(Some(StraightLine::fit(&speeds, &values, Weighting::Absolute(&u))?))
        };
        let damping = line(&|window| (mass * window.damping.value, mass * window.damping.uncertainty))?;
        let frequency = line(&|window| (window.natural_frequency.value, window.natural_frequency.uncertainty))?;
        Ok(Self { machine, times, length, windows, mass, damping, frequency })
    }

    /// Slope of the damping (N s²/m²) with its uncertainty.
    fn slope(&self) -> Option<(f64, f64)> {
        let line = self.damping.as_ref()?;
        Some((line.slope(), line.slope_uncertainty()?))
    }

    /// Change of the frequency (%) from rest to the velocity of the release, with its uncertainty.
    fn drift(&self) -> Option<(f64, f64)> {
        let line = self.frequency.as_ref()?;
        let [.., stiffness, _] = MACHINE;
        let factor = 100.0 * RELEASE * (stiffness / self.mass).sqrt() / line.intercept();
        Some((factor * line.slope(), factor * line.slope_uncertainty()?))
    }

    fn row(&self) -> Vec<String> {
        let text = |pair: Option<(f64, f64)>| match pair {
            Some((value, u)) => format!("{value:.4} ± {u:.4}"),
            None => "–".to_owned(),
        };
        let verdict = match self.slope() {
            Some((slope, u)) if slope.abs() > SEEN * u => "yes",
            Some(_) => "not seen",
            None => "one window only",
        };
        vec![
            self.machine.name().to_owned(),
            self.times.to_string(),
            self.length.to_string(),
            self.windows.len().to_string(),
            self.damping.as_ref().map_or_else(|| "–".to_owned(), |line| format!("{:.4}", line.intercept())),
            text(self.slope()),
            verdict.to_owned(),
            text(self.drift()),
        ]
    }

    /// V (m/s) and damping (N s/m) of each window.
    fn points(&self) -> Vec<(f64, f64)> {
        self.windows.iter().map(|window| (window.peak_velocity, self.mass * window.damping.value)).collect()
    }

    /// V (m/s) and frequency (Hz) of each window.
    fn frequencies(&self) -> Vec<(f64, f64)> {
        self.windows.iter().map(|window| (window.peak_velocity, window.natural_frequency.value)).collect()
    }
}

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let mut found = Vec::new();
    for (index, machine) in [Machine::Monolithic, Machine::Assembled, Machine::Slipping].into_iter().enumerate() {
        for times in [1, 2] {
            let seed =
                settings.seed().wrapping_mul(1_000_003).wrapping_add(90_000 + 10 * index as u64 + u64::from(times));
            let velocity = with_noise(&machine.velocity(times)?, NOISE, seed)?;
            for length in LENGTHS.into_iter().filter(|length| times == 1 || *length == LONGEST) {
                found.push(Windowed::of(machine, times, length, &velocity)?);
            }
        }
    }
    let of = |machine: Machine, times: u32, length: u32| -> Found<&Windowed> {
        let found = found.iter().find(|one| (one.machine, one.times, one.length) == (machine, times, length));
        Ok(found.ok_or("no such record")?)
    };
    targets(chapter, &of)?;
    chapter.table(
        format!(
            "Ring-downs from 22 mm without contact, simulated with {} mm/s of noise and fitted in windows of five cycles: c = c₁ + slope V",
            1e3 * NOISE
        ),
        &[
            "machine",
            "mass, times",
            "record / s",
            "windows",
            "c₁ / (N s/m)",
            "slope / (N s²/m²)",
            "does c grow with V?",
            "change of f₀ to 22 mm / %",
        ],
        found.iter().map(Windowed::row).collect(),
    );
    findings(chapter, &of)?;
    figure(chapter, &of)
}

type Of<'a> = &'a dyn Fn(Machine, u32, u32) -> Found<&'a Windowed>;

/// The slope of a record's damping, which must be there.
fn slope(of: &Windowed) -> Found<(f64, f64)> {
    Ok(of.slope().ok_or("the record has one window only")?)
}

fn drift(of: &Windowed) -> Found<(f64, f64)> {
    Ok(of.drift().ok_or("the record has one window only")?)
}

fn targets(chapter: &mut Chapter, of: Of<'_>) -> Found<()> {
    let expected = EQUATION_5_5[0];
    for (machine, times, reference, tolerance, note) in [
        (Machine::Monolithic, 1, 0.0, 0.0, "none is there"),
        (Machine::Assembled, 1, expected, 0.01, "8/(3π) c₂; 1 % as windows are long"),
        (Machine::Assembled, 2, expected, 0.01, "does not know of the mass"),
        (Machine::Slipping, 1, expected, 0.02, "by Masing's rules; 2 % as the elements are counted"),
        (Machine::Slipping, 2, 2.0 * expected, 0.02, "grows with the mass: c_eq = 4 a V/(3π ω²)"),
    ] {
        let (ours, u) = slope(of(machine, times, LONGEST)?)?;
        let quantity = format!("slope of c over V, {}, {times} times the mass, {LONGEST} s", machine.name());
        let criterion = Criterion::near(reference, tolerance * reference + 4.0 * u);
        chapter.target(
            Target::new("F2", quantity, "N s²/m²", ours, criterion).note(format!("{note}; u = {u:.1e}, and 4 u")),
        );
    }
    let (ours, u) = drift(of(Machine::Assembled, 1, LONGEST)?)?;
    let criterion = Criterion::near(0.0, 4.0 * u + 2e-3);
    let quantity = "change of f₀ from rest to 22 mm, damping c₂|v|";
    chapter.target(Target::new("F3", quantity, "%", ours, criterion).note(format!("none; u = {u:.1e}")));
    let (ours, u) = drift(of(Machine::Slipping, 1, LONGEST)?)?;
    let quantity = "change of f₀ from rest to 22 mm, clamps that slip";
    chapter.target(
        Target::new("F3", quantity, "%", ours, Criterion::AtMost(-0.05))
            .note(format!("they soften by about a X = 4.3 N/m, 0.1 % of f₀; u = {u:.1e}")),
    );
    Ok(())
}

fn findings(chapter: &mut Chapter, of: Of<'_>) -> Found<()> {
    let text = |(value, u): (f64, f64)| format!("{value:.3} ± {u:.3}");
    let at = |machine: Machine, length: u32| -> Found<String> {
        let one = of(machine, 1, length)?;
        Ok(one.slope().map_or_else(|| "no slope".to_owned(), text))
    };
    chapter.finding(
        "Whether the damping grows with velocity, one ring-down of each machine decides, if it is long enough.",
        format!(
            "Slopes of c over V from one record with {} mm/s of noise: after 5 s {} (assembled) against {} (monolithic), after 20 s {} against \
             {}, after 80 s {} against {} N s²/m². More initial displacements are not needed: a ring-down passes through all smaller ones.",
            1e3 * NOISE,
            at(Machine::Assembled, 5)?,
            at(Machine::Monolithic, 5)?,
            at(Machine::Assembled, 20)?,
            at(Machine::Monolithic, 20)?,
            at(Machine::Assembled, LONGEST)?,
            at(Machine::Monolithic, LONGEST)?
        ),
        &[],
    );
    let [first, .., last] = TABLE_1;
    let printed = 50.0 * (last.stiffness / last.mass / (first.stiffness / first.mass)).ln();
    let (viscous, slipping) = (of(Machine::Assembled, 1, LONGEST)?, of(Machine::Slipping, 1, LONGEST)?);
    chapter.finding(
        "Why it grows, the damping of one machine cannot say: clamps that slip a little give the same line as a damping c₂|v|.",
        format!(
            "Slipping clamps lose as the cube of the displacement in a cycle, and so does c₂|v|: slopes {} and {} N s²/m². Nor can it tell clamps \
             from air, both c₂|v|: that needs the monolithic machine, or a vacuum. Two things do tell slip from a damping that depends on \
             velocity. The frequency: slip lowers it by {:.3} % to 22 mm, where c₂|v| leaves it ({:+.3} %); Table 1's f₀ rises by {printed:.2} %, \
             which slip alone would not do. And the mass: with twice of it the slope is {} for slip and {} for c₂|v|.",
            text(slope(slipping)?),
            text(slope(viscous)?),
            -drift(slipping)?.0,
            drift(viscous)?.0,
            text(slope(of(Machine::Slipping, 2, LONGEST)?)?),
            text(slope(of(Machine::Assembled, 2, LONGEST)?)?)
        ),
        &[],
    );
    Ok(())
}

fn figure(chapter: &mut Chapter, of: Of<'_>) -> Found<()> {
    let [monolithic, assembled, slipping] =
        [Machine::Monolithic, Machine::Assembled, Machine::Slipping].map(|machine| of(machine, 1, LONGEST));
    let (monolithic, assembled, slipping) = (monolithic?, assembled?, slipping?);
    let panel = |x: &str, y: String, values: fn(&Windowed) -> Vec<(f64, f64)>| {
        Panel::new(x, y, 320.0)
            .with(Role::Points, monolithic.machine.name(), values(monolithic))
            .with(Role::FittedPoints, assembled.machine.name(), values(assembled))
            .with(Role::ResidualPoints, slipping.machine.name(), values(slipping))
    };
    let damping = panel("", label("damping c", "N s/m"), Windowed::points);
    let frequency = panel("amplitude of the velocity V / (m/s)", label("f₀", "Hz"), Windowed::frequencies);
    chapter.figure(
        "clamps",
        format!(
            "Damping and natural frequency against velocity, from windows of five cycles of one ring-down of {LONGEST} s for each machine. All \
             simulated, with white noise of {} mm/s.",
            1e3 * NOISE
        ),
        &[damping, frequency],
    );
    Ok(())
}
