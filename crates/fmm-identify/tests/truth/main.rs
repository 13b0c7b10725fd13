//! Records of known truth: every law comes back, intervals cover it, and no hysteresis is found where there is none.

mod budget;
mod coverage;
mod hysteresis;
mod impacts;
mod minima;
mod profiles;
mod records;
mod recovery;
mod units;
