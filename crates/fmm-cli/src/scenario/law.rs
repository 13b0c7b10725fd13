//! The object of a law in a scenario, read against the parameters that the law has.

use super::entries::{Entries, Field};
use super::keys::{Shape, Slot};

/// The values given for a law, each under its parameter.
pub(crate) struct Given {
    pub(crate) law: &'static str,
    slots: Vec<Slot>,
    fields: Vec<Option<Field>>,
}

impl Given {
    /// Sorts `entries` into `slots`.
    pub(crate) fn sort(law: &'static str, slots: Vec<Slot>, entries: Entries) -> Result<Self, String> {
        let known = || slots.iter().map(Slot::description).collect::<Vec<_>>().join(", ");
        let mut fields: Vec<Option<Field>> = slots.iter().map(|slot| slot.default.map(Field::Number)).collect();
        let mut seen = vec![false; slots.len()];
        for (key, field) in entries.0 {
            let Some(index) = slots.iter().position(|slot| slot.is(&key)) else {
                return Err(format!("the law {law} has no parameter \"{key}\"; its parameters are {}", known()));
            };
            if std::mem::replace(&mut seen[index], true) {
                return Err(given_twice(law, &slots[index], &key));
            }
            fields[index] = Some(field);
        }
        if let Some(index) = fields.iter().position(Option::is_none) {
            let missing = slots[index].description();
            return Err(format!("the law {law} needs {missing}; its parameters are {}", known()));
        }
        Ok(Self { law, slots, fields })
    }

    /// The numbers, in the order of the slots, lists and laws left out.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>, String> {
        let numbers = self.slots.iter().zip(&self.fields).filter(|(slot, _)| slot.shape == Shape::Number);
        numbers
            .map(|(slot, field)| match field {
                Some(Field::Number(number)) => Ok(*number),
                _ => Err(self.wrong(slot, "a number")),
            })
            .collect()
    }

    /// Pairs of the two lists.
    pub(crate) fn pairs(&self) -> Result<Vec<(f64, f64)>, String> {
        let mut lists = Vec::new();
        for (slot, field) in self.slots.iter().zip(&self.fields).filter(|(slot, _)| slot.shape == Shape::List) {
            match field {
                Some(Field::List(list)) => lists.push(list.as_slice()),
                _ => return Err(self.wrong(slot, "a list of numbers")),
            }
        }
        let [first, second] = lists[..] else { return Ok(Vec::new()) };
        if first.len() != second.len() {
            let (law, stiffnesses, others) = (self.law, first.len(), second.len());
            return Err(format!(
                "the law {law} needs two numbers for each element, but {stiffnesses} stiffnesses and {others} others \
                 were given"
            ));
        }
        Ok(first.iter().copied().zip(second.iter().copied()).collect())
    }

    /// The law inside.
    pub(crate) fn inner(&mut self) -> Result<Entries, String> {
        let Some(index) = self.slots.iter().position(|slot| slot.shape == Shape::Law) else {
            return Ok(Entries(Vec::new()));
        };
        match self.fields[index].take() {
            Some(Field::Object(entries)) => Ok(entries),
            _ => Err(self.wrong(&self.slots[index], "a law")),
        }
    }

    fn wrong(&self, slot: &Slot, expected: &str) -> String {
        format!("{} of the law {} must be {expected}", slot.description(), self.law)
    }
}

/// The refusal of a second `key` for one parameter.
pub(crate) fn given_twice(law: &str, slot: &Slot, key: &str) -> String {
    format!("the law {law} has its parameter {} twice, once as \"{key}\"", slot.name)
}
