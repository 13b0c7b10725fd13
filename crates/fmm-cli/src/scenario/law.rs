//! The object of a law in a scenario, read against the parameters that the law has.

use super::ScenarioError;
use super::entries::{Entries, Field};
use super::keys::{Shape, Slot};

/// The values given for a law, each under its parameter.
pub(crate) struct Given {
    law: &'static str,
    slots: Vec<Slot>,
    fields: Vec<Option<Field>>,
}

impl Given {
    /// Sorts `entries` into `slots`.
    ///
    /// # Errors
    /// [`ScenarioError::UnknownParameter`] for a key that none of them has, [`ScenarioError::GivenTwice`] for two keys
    /// of one, [`ScenarioError::MissingParameter`] for one that has neither a value nor a default.
    pub(crate) fn sort(law: &'static str, slots: Vec<Slot>, entries: Entries) -> Result<Self, ScenarioError> {
        let known = || {
            let texts: Vec<String> = slots.iter().map(Slot::description).collect();
            texts.join(", ")
        };
        let mut fields: Vec<Option<Field>> = slots.iter().map(|slot| slot.default.map(Field::Number)).collect();
        let mut seen = vec![false; slots.len()];
        for (key, field) in entries.0 {
            let Some(index) = slots.iter().position(|slot| slot.is(&key)) else {
                return Err(ScenarioError::UnknownParameter { law, key, known: known() });
            };
            if std::mem::replace(&mut seen[index], true) {
                return Err(ScenarioError::GivenTwice { law, parameter: slots[index].name.to_owned(), key });
            }
            fields[index] = Some(field);
        }
        if let Some(index) = fields.iter().position(Option::is_none) {
            return Err(ScenarioError::MissingParameter { law, missing: slots[index].description(), known: known() });
        }
        Ok(Self { law, slots, fields })
    }

    /// Name of the law.
    pub(crate) const fn law(&self) -> &'static str {
        self.law
    }

    /// The numbers, in the order of the slots, lists and laws left out.
    ///
    /// # Errors
    /// [`ScenarioError::WrongShape`] if one is something else.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>, ScenarioError> {
        let numbers = self.slots.iter().zip(&self.fields).filter(|(slot, _)| slot.shape == Shape::Number);
        numbers
            .map(|(slot, field)| match field {
                Some(Field::Number(number)) => Ok(*number),
                _ => Err(self.wrong(slot, "a number")),
            })
            .collect()
    }

    /// Pairs of the two lists.
    ///
    /// # Errors
    /// [`ScenarioError::WrongShape`] if one is no list, [`ScenarioError::ElementLists`] if they differ in length.
    pub(crate) fn pairs(&self) -> Result<Vec<(f64, f64)>, ScenarioError> {
        let mut lists = Vec::new();
        for (slot, field) in self.slots.iter().zip(&self.fields).filter(|(slot, _)| slot.shape == Shape::List) {
            match field {
                Some(Field::List(list)) => lists.push(list.as_slice()),
                _ => return Err(self.wrong(slot, "a list of numbers")),
            }
        }
        let [first, second] = lists[..] else { return Ok(Vec::new()) };
        if first.len() != second.len() {
            return Err(ScenarioError::ElementLists { law: self.law, stiffnesses: first.len(), others: second.len() });
        }
        Ok(first.iter().copied().zip(second.iter().copied()).collect())
    }

    /// The law inside.
    ///
    /// # Errors
    /// [`ScenarioError::WrongShape`] if it is no object.
    pub(crate) fn inner(&mut self) -> Result<Entries, ScenarioError> {
        for index in 0..self.slots.len() {
            if self.slots[index].shape == Shape::Law {
                return match self.fields[index].take() {
                    Some(Field::Object(entries)) => Ok(entries),
                    _ => Err(self.wrong(&self.slots[index], "a law")),
                };
            }
        }
        Ok(Entries(Vec::new()))
    }

    fn wrong(&self, slot: &Slot, expected: &'static str) -> ScenarioError {
        ScenarioError::WrongShape { law: self.law, parameter: slot.description(), expected }
    }
}
