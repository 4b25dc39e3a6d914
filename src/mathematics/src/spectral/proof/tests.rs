//! Tests of the proof: brackets of solutions whose energy is known, and setups that must be refused.

mod brackets;
mod ends;
mod refused;
