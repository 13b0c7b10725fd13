//! The referee: small steps of a method of order 5, halved until every corner, stop, reversal and yield is at the end
//! of one.

use fmm_friction::{BristleLaw, Regime, SlidingLaw};
use fmm_model::Restoring;

use crate::draw::Machine;

pub(crate) enum Contact<'a> {
    Sliding(&'a dyn SlidingLaw<f64>),
    Bristle(&'a dyn BristleLaw<f64>),
}

/// Local error of a step, relative to the state (1).
const TOLERANCE: f64 = 3e-14;

/// Angle of a step at the greatest stiffness (rad).
const ANGLE: f64 = 0.05;

type Y = [f64; 6];

/// Smooth piece of the motion.
#[derive(Clone, Copy)]
struct Piece {
    /// Direction of sliding; 0 if the contact holds.
    sign: f64,
    regime: Regime,
    /// 0 between the corners of the spring, else the side.
    side: f64,
}

pub(crate) struct Referee<'a> {
    machine: &'a Machine,
    contact: Contact<'a>,
    states: usize,
    piece: Piece,
    time: f64,
    y: Y,
    length: f64,
    longest: f64,
    /// End of the smooth part of the force (s).
    limit: f64,
}

const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERRORS: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

impl<'a> Referee<'a> {
    pub(crate) fn new(machine: &'a Machine, contact: Contact<'a>) -> Self {
        let states = if let Contact::Bristle(law) = &contact { law.states() } else { 0 };
        let mut y = [0.0; 6];
        (y[0], y[1]) = machine.start;
        let mass = machine.oscillator.mass();
        let mut stiffness = machine.oscillator.stiffness();
        stiffness *= match machine.oscillator.restoring() {
            Restoring::Bilinear { inner, outer, .. } => f64::max(inner, outer),
            Restoring::Polynomial { cubic, quintic } => {
                let square = (2.0 * machine.amplitude).powi(2);
                1.0 + 3.0 * cubic.abs() * square + 5.0 * quintic.abs() * square * square
            }
            _ => 1.0,
        };
        let fast = (stiffness / mass).sqrt().max(machine.angular);
        let longest = ANGLE / fast.max(1.0 / machine.cause.time());
        let piece = Piece { sign: 1.0, regime: Regime::ALL_HOLD, side: 0.0 };
        let mut referee =
            Self { machine, contact, states, piece, time: 0.0, y, length: 1e-7 * longest, longest, limit: 0.0 };
        referee.limit = referee.next_corner();
        let relative = y[1] - machine.cause.belt();
        if relative == 0.0 {
            referee.leave_rest();
        } else {
            referee.slide(relative.signum());
        }
        referee
    }

    fn next_corner(&self) -> f64 {
        let corners = self.machine.cause.corners();
        corners.into_iter().filter(|corner| *corner > self.time).fold(f64::INFINITY, f64::min)
    }

    /// Goes on to `time`; `None` if it takes too many steps.
    pub(crate) fn advance(&mut self, time: f64, budget: &mut usize) -> Option<[f64; 2]> {
        while self.time < time {
            let end = time.min(self.limit);
            self.step(end, budget)?;
            if self.time == self.limit {
                self.limit = self.next_corner();
                self.length = self.length.min(1e-3 * self.longest);
                if self.piece.sign == 0.0 {
                    self.leave_rest();
                }
            }
        }
        Some([self.y[0], self.y[1]])
    }

    fn force(&self, time: f64) -> f64 {
        self.machine.cause.force(time, time >= self.limit)
    }

    /// Force of the spring (N), continued from the present side of its corners.
    fn spring(&self, x: f64) -> f64 {
        let machine = &self.machine.oscillator;
        match machine.restoring() {
            Restoring::Bilinear { corner, inner, outer, .. } => {
                let side = self.piece.side;
                let beyond = if side == 0.0 { 0.0 } else { x - corner * side };
                machine.stiffness() * (inner * x + (outer - inner) * beyond)
            }
            _ => machine.restoring_force(x),
        }
    }

    /// Friction coefficient, and the rates of the states in `rates`.
    fn friction(&self, piece: Piece, y: &Y, rates: &mut Y) -> f64 {
        let speed = ((y[1] - self.machine.cause.belt()) * piece.sign).max(0.0);
        match &self.contact {
            Contact::Sliding(law) => law.coefficient(speed) * piece.sign,
            Contact::Bristle(law) => {
                let mut mirrored = [0.0; 4];
                for (mirrored, z) in mirrored.iter_mut().zip(&y[2..]) {
                    *mirrored = z * piece.sign;
                }
                let mut rate = [0.0; 4];
                let (mirrored, rate) = (&mirrored[..self.states], &mut rate[..self.states]);
                // At zero speed the side is that of the motion.
                let speed = speed.max(f64::MIN_POSITIVE);
                law.rate(speed, mirrored, piece.regime, rate);
                let coefficient = law.coefficient(speed, mirrored, rate);
                for (rates, rate) in rates[2..].iter_mut().zip(rate) {
                    *rates = *rate * piece.sign;
                }
                coefficient * piece.sign
            }
        }
    }

    fn rates(&self, time: f64, y: &Y) -> Y {
        let mut rates = [0.0; 6];
        let machine = &self.machine.oscillator;
        if self.piece.sign == 0.0 {
            rates[0] = y[1];
            return rates;
        }
        let friction = self.friction(self.piece, y, &mut rates) * self.machine.load;
        rates[0] = y[1];
        let sum = self.force(time) - friction - machine.damping_force(y[1]) - self.spring(y[0]);
        rates[1] = sum / machine.mass();
        rates
    }

    /// The state after `length`, and its error relative to the state.
    fn take(&self, length: f64) -> (Y, f64) {
        let mut rates = [[0.0; 6]; 7];
        let mut y = self.y;
        for stage in 0..7 {
            y = self.y;
            for (weight, rates) in STAGES[stage].iter().zip(&rates).take(stage) {
                for (y, rate) in y.iter_mut().zip(rates) {
                    *y += length * weight * rate;
                }
            }
            rates[stage] = self.rates(self.time + NODES[stage] * length, &y);
        }
        let mut worst = 0.0f64;
        for component in 0..2 + self.states {
            let error: f64 = ERRORS.iter().zip(&rates).map(|(weight, rates)| weight * rates[component]).sum();
            let scale = match component {
                0 => self.machine.amplitude,
                1 => self.machine.amplitude * self.machine.angular,
                _ => match &self.contact {
                    Contact::Bristle(law) => law.bound(component - 2).abs().min(1e3 * self.machine.amplitude),
                    Contact::Sliding(_) => 1.0,
                },
            };
            worst = worst.max((length * error / scale).abs());
        }
        (y, worst / TOLERANCE)
    }

    /// Quantities that are positive until the piece ends.
    fn guards(&self, time: f64, y: &Y) -> [f64; 7] {
        let mut guards = [f64::INFINITY; 7];
        if self.piece.sign == 0.0 {
            if let Contact::Sliding(law) = &self.contact {
                guards[0] = law.breakaway() * self.machine.load - self.held(time, y).abs();
            }
        } else {
            guards[0] = (y[1] - self.machine.cause.belt()) * self.piece.sign;
            if let Contact::Bristle(law) = &self.contact {
                let mirrored: Vec<f64> = y[2..2 + self.states].iter().map(|z| z * self.piece.sign).collect();
                let speed = guards[0].max(0.0);
                for (index, guard) in guards[3..3 + self.states].iter_mut().enumerate() {
                    if !self.piece.regime.slides(index)
                        && let Some(reserve) = law.reserve(index, speed, &mirrored)
                    {
                        *guard = reserve;
                    }
                }
            }
        }
        if let Some(corner) = self.machine.oscillator.restoring().corner() {
            if self.piece.side == 0.0 {
                (guards[1], guards[2]) = (corner - y[0], corner + y[0]);
            } else {
                guards[1] = y[0] * self.piece.side - corner;
            }
        }
        guards
    }

    fn step(&mut self, end: f64, budget: &mut usize) -> Option<()> {
        let from = self.guards(self.time, &self.y);
        // A law may begin to act at any speed, however small: no step takes more than a part of the way to a turn.
        let speed = (self.y[1] - self.machine.cause.belt()).abs();
        let is_slow = speed < 1e-8 * self.machine.amplitude * self.machine.angular;
        let least = if is_slow { 1e-3 } else { 1e-7 };
        let to_turn = 0.3 * speed / self.rates(self.time, &self.y)[1].abs();
        let to_turn = if self.piece.sign == 0.0 { f64::INFINITY } else { to_turn.max(least * self.longest) };
        let mut length = self.length.min(self.longest).min(to_turn).min(end - self.time);
        loop {
            *budget = budget.checked_sub(1)?;
            let (y, error) = self.take(length);
            if error > 1.0 && length > 1e-14 * self.machine.end {
                length *= (0.9 * error.powf(-0.2)).clamp(0.1, 0.9);
                continue;
            }
            let whole = length >= end - self.time;
            let time = if whole { end } else { self.time + length };
            let fallen = |time: f64, y: &Y| {
                let guards = self.guards(time, y);
                (0..guards.len()).find(|&index| guards[index] < 0.0 && from[index] >= 0.0)
            };
            if fallen(time, &y).is_none() {
                self.length = length * (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 4.0);
                (self.time, self.y) = (time, y);
                return Some(());
            }
            // The last length without and the first one with an event.
            let (mut without, mut with) = (0.0, length);
            while with - without > 2e-16 * (self.time + with) && with - without > 1e-15 * with {
                let middle = 0.5 * (without + with);
                *budget = budget.checked_sub(1)?;
                let (y, _) = self.take(middle);
                if fallen(self.time + middle, &y).is_some() { with = middle } else { without = middle }
            }
            let (y, _) = self.take(with);
            let Some(guard) = fallen(self.time + with, &y) else { continue };
            (self.time, self.y) = (self.time + with, y);
            self.length = self.length.min(1e-7 * self.longest);
            self.arrive(guard);
            return Some(());
        }
    }

    fn arrive(&mut self, guard: usize) {
        let corner = self.machine.oscillator.restoring().corner().unwrap_or(0.0);
        match guard {
            0 if self.piece.sign == 0.0 => self.slide(self.held(self.time, &self.y).signum()),
            0 => self.leave_rest(),
            1 if self.piece.side == 0.0 => (self.piece.side, self.y[0]) = (1.0, corner),
            2 => (self.piece.side, self.y[0]) = (-1.0, -corner),
            1 => (self.piece.side, self.y[0]) = (0.0, corner * self.piece.side),
            _ => self.piece.regime = self.piece.regime.sliding(guard - 3),
        }
    }

    /// Load on a contact that holds (N).
    fn held(&self, time: f64, y: &Y) -> f64 {
        let machine = &self.machine.oscillator;
        let x = y[0];
        self.force(time) - machine.restoring_force(x) - machine.damping_force(self.machine.cause.belt())
    }

    /// Goes on from zero relative velocity.
    fn leave_rest(&mut self) {
        self.y[1] = self.machine.cause.belt();
        let load = self.held(self.time, &self.y);
        match &self.contact {
            Contact::Sliding(law) => {
                let holds = load.abs() <= law.breakaway() * self.machine.load;
                self.slide(if holds { 0.0 } else { load.signum() });
            }
            Contact::Bristle(_) => {
                let piece = Piece { sign: 1.0, regime: Regime::ALL_HOLD, side: 0.0 };
                let friction = self.friction(piece, &self.y, &mut [0.0; 6]) * self.machine.load;
                let mut left = load - friction;
                if left == 0.0 {
                    let later = self.time + 1e-6 * self.longest;
                    left = self.held(later, &self.y) - load;
                }
                self.slide(if left == 0.0 { 0.0 } else { left.signum() });
            }
        }
    }

    /// Begins to slide in this direction.
    fn slide(&mut self, sign: f64) {
        (self.piece.sign, self.piece.regime) = (sign, Regime::ALL_HOLD);
        let (x, v) = (self.y[0], if self.y[1] == 0.0 { sign } else { self.y[1] });
        let corner = self.machine.oscillator.restoring().corner().unwrap_or(f64::INFINITY);
        let is_beyond = x.abs() > corner || x.abs() == corner && v * x > 0.0;
        self.piece.side = if is_beyond { x.signum() } else { 0.0 };
    }
}
