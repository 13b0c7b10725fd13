//! A column of a table of force and motion: what does not belong to the measurement is mended or named.

use std::f64::consts::TAU;

use fmm_model::Rounded;
use fmm_record::{Examination, Quantity, Record, WrittenUnit};

/// A column in SI units, as far as its unit is known.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) values: Vec<f64>,
    pub(super) unit: Option<WrittenUnit>,
}

impl Series {
    /// The values where a unit that is not known is of this `factor`.
    pub(super) fn or_by(&self, factor: f64) -> Vec<f64> {
        let factor = if self.unit.is_some() { 1.0 } else { factor };
        self.values.iter().map(|value| factor * value).collect()
    }

    /// Sentences about samples at the `times` that do not belong to what was measured.
    pub(super) fn doubts(&self, times: &[f64]) -> Vec<String> {
        let Some(record) = self.record(times) else { return Vec::new() };
        let (examination, name) = (Examination::of(&record), &self.name);
        let saturation = examination.saturation().map(|found| {
            let levels: Vec<String> =
                [found.lower, found.upper].into_iter().flatten().map(|at| at.to_string()).collect();
            format!(
                "\"{name}\" lies on {} in {} samples: if the range of the instrument ends there, what is beyond is \
                 lost",
                levels.join(" and "),
                found.samples
            )
        });
        let spike = self.jumps(&examination, times).map(|jumps| {
            format!("{jumps}, and these are used as they are: mend them, or leave them out by --from and --to")
        });
        saturation.into_iter().chain(spike).collect()
    }

    /// The samples at the `times`, as if they were equally spaced.
    fn record(&self, times: &[f64]) -> Option<Record> {
        let (first, last) = (times.first()?, times.last()?);
        let interval = (last - first) / times.len().saturating_sub(1).max(1) as f64;
        Record::new(*first, interval, self.values.clone(), Quantity::Displacement, "m").ok()
    }

    /// The beginning of a sentence about samples that are far off their neighbours.
    fn jumps(&self, examination: &Examination, times: &[f64]) -> Option<String> {
        let spike = examination.spikes().first()?;
        let count: usize = examination.spikes().iter().map(|spike| spike.count).sum();
        let at = Rounded::new(times.get(spike.index).copied().unwrap_or(spike.time), None);
        Some(format!("\"{}\" jumps to and fro in {count} samples, first at {at} s", self.name))
    }

    /// Puts straight lines over the `times` between their neighbours in place of samples that are far off both, where a
    /// position cannot have been; the sentence about them.
    fn mended(&mut self, times: &[f64]) -> Option<String> {
        let record = self.record(times)?;
        let examination = Examination::of(&record);
        let mut is_any = false;
        for spike in examination.spikes() {
            let end = spike.index + spike.count;
            let Some(before) = spike.index.checked_sub(1).filter(|_| end < self.values.len()) else { continue };
            let [from, to] = [before, end].map(|at| (times[at], self.values[at]));
            for (time, value) in times[spike.index..end].iter().zip(&mut self.values[spike.index..end]) {
                *value = from.1 + (to.1 - from.1) * (time - from.0) / (to.0 - from.0);
            }
            is_any = true;
        }
        let jumps = self.jumps(&examination, times).filter(|_| is_any)?;
        Some(format!("{jumps}: straight lines between their neighbours stand for these"))
    }

    /// Makes an angle that begins anew after a turn go on; the sentence about it.
    fn unwound(&mut self) -> Option<String> {
        let is_angle = self.unit.as_ref().is_some_and(|unit| unit.si() == "rad");
        let turns = |step: f64| (step / TAU).round();
        let steps = || self.values.windows(2).map(|pair| pair[1] - pair[0]);
        let anew = steps().filter(|step| turns(*step) != 0.0).count();
        // A step that is no whole turn, but for a part that is small as all others are, is something else.
        let are_small = steps().all(|step| (step - TAU * turns(step)).abs() < 0.25 * TAU);
        if !is_angle || anew == 0 || !are_small {
            return None;
        }
        let (mut added, mut previous) = (0.0, *self.values.first()?);
        for value in &mut self.values {
            added -= TAU * turns(*value - previous);
            previous = *value;
            *value += added;
        }
        Some(format!("\"{}\" begins anew after each turn, {anew} times, and was taken to go on", self.name))
    }

    /// Positions at the `times` as they were without what an instrument did to them; the sentences about it go to
    /// `remarks`.
    pub(super) fn going_on(mut self, times: &[f64], remarks: &mut Vec<String>) -> Self {
        remarks.extend(self.unwound());
        remarks.extend(self.mended(times));
        self
    }

    /// A load without its `tare`, which is in its unit, and with its sign turned if it is negative throughout; the
    /// sentence about that goes to `remarks`.
    pub(super) fn pressing(mut self, tare: f64, remarks: &mut Vec<String>) -> Self {
        let tare = tare * self.unit.as_ref().map_or(1.0, WrittenUnit::factor);
        self.values.iter_mut().for_each(|value| *value -= tare);
        if !self.values.is_empty() && self.values.iter().all(|value| *value < 0.0) {
            self.values.iter_mut().for_each(|value| *value = -*value);
            remarks.push(format!("\"{}\" is negative throughout: its sign was turned, so that it presses", self.name));
        }
        self
    }
}
