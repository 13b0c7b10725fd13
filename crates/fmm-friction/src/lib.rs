//! Friction laws as one formula each, generic in the number type, with named and bounded parameters.
