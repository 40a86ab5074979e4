//! Tests of small files made by hand.

mod bad_input;
mod damaged;
mod file;
mod lists;
mod number_types;
mod positions;
