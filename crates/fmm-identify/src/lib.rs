//! Friction parameters out of measured ring-downs, with their uncertainty and what the record could not tell.
