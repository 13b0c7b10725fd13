//! Scenarios as a user writes them: what each promises, and what is refused.

mod limits;
mod rest;
