//! The crates together: real records, synthetic ones of known truth, and records that should be refused.

mod backbone;
mod backbone_coverage;
mod bad_input;
mod brake;
mod change;
mod document;
mod every_law;
mod hammer;
mod identifiability;
mod impact;
mod judgement;
mod measurement;
mod own_law;
mod pendulum;
mod real_records;
mod roll;
mod synthetic;
mod table_3;
