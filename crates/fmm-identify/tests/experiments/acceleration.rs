//! Accelerations.
