//! Posteriors of ring-downs: against quadrature at a bound, beside the other intervals, and with predictive checks.

mod at_a_bound;
mod identification;
