//! Stick-slip oscillators simulated exactly through every event, with exact gradients.
