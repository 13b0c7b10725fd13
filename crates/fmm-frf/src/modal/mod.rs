//! Natural frequency and damping of single modes.

mod band;
mod circle;
mod mode;
mod parabola;
mod rational;

pub use circle::CircleFit;
pub use mode::Mode;
pub use parabola::PeakFit;
pub use rational::{Background, RationalFit};
