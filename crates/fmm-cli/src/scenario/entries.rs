//! A JSON object of which the program, and not serde, knows the keys.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// The keys and values of an object in the order of the file, each key once.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entries(pub(crate) Vec<(String, Field)>);

/// Value of a key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Field {
    /// A number.
    Number(f64),
    /// A list of numbers.
    List(Vec<f64>),
    /// An object.
    Object(Entries),
}

struct Shape;

impl<'de> Visitor<'de> for Shape {
    type Value = Field;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a list of numbers or an object")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Field, E> {
        Ok(Field::Number(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Field, E> {
        Ok(Field::Number(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Field, E> {
        Ok(Field::Number(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Field, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = list.next_element()? {
            numbers.push(number);
        }
        Ok(Field::List(numbers))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Field, A::Error> {
        let mut entries: Vec<(String, Field)> = Vec::new();
        while let Some((key, field)) = map.next_entry::<String, Field>()? {
            if entries.iter().any(|(other, _)| *other == key) {
                return Err(A::Error::custom(format_args!("duplicate field `{key}`")));
            }
            entries.push((key, field));
        }
        Ok(Field::Object(Entries(entries)))
    }
}

impl<'de> Deserialize<'de> for Field {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Shape)
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Field::deserialize(deserializer)? {
            Field::Object(entries) => Ok(entries),
            _ => Err(D::Error::custom("a law is an object with one key, its name")),
        }
    }
}
