//! Properties of every machine: laws of mechanics and of arithmetic on random parameters, with fixed seeds.

mod case;
mod catalogue;
mod driven;
mod energy;
mod engines;
mod extremes;
mod gradient;
mod laws;
mod motion;
mod restart;
mod sampling;
mod series;
mod symmetry;
mod thesis;
