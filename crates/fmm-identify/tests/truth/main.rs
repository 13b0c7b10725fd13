//! Records of known truth: every law comes back, intervals cover it, and no hysteresis is found where there is none.

mod blows;
mod coverage;
mod hysteresis;
mod records;
mod recovery;
