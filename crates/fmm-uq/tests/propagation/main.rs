//! Budgets and Monte Carlo against the guides' own examples, certified data and exact figures, and what they refuse.

mod adaptive;
mod annex_h;
mod clause9;
mod dependence;
mod distributions;
mod limits;
mod more_distributions;
mod nist;
mod polar;
mod print;
mod sensitivity;
mod streams;
mod thesis;
mod wrong_input;
