//! Tests of small files made by hand.

mod accuracy;
mod bad_input;
mod contents;
mod damaged;
mod file;
mod lists;
mod number_types;
mod places;
mod poses;
mod positions;
