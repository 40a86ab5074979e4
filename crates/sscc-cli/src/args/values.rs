//! Values that are typed by name, and the format of answers.

use std::str::FromStr;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use sscc::Method;

/// Parses a value of the core by its name. Each name has a help text.
pub(super) fn named<T, const N: usize>(
    names: [(&'static str, &'static str); N],
) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = sscc::Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names.map(|(name, help)| PossibleValue::new(name).help(help)))
        .try_map(|name| name.parse::<T>())
}

/// The form of the result.
#[derive(Clone, Copy, Debug, Args)]
pub struct Json {
    /// Print the result only, as JSON
    #[arg(long)]
    pub json: bool,
}

/// Parses a method of a query.
pub(super) fn method() -> impl TypedValueParser<Value = Method> {
    named([
        ("certified", "Certificates; where they fail, a traversal with BD-tree AABBs"),
        ("bdtree", "A traversal with BD-tree AABBs, without certificates"),
        ("traditional", "A refit of all AABBs, then a traversal"),
        ("normal-cones", "As traditional, with normal cones and the contour test"),
        ("brute-force", "A test of every triangle pair"),
    ])
}
