//! Frequency response of impact tests: impulse, receptance, mobility and accelerance.
