//! Measurement uncertainty after the GUM: inputs, propagation with exact sensitivities, budgets.
