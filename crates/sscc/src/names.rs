//! Names of the values of enums, on the command line and in files.

/// Names the values of an enum: `Display`, `FromStr`, and the name as a string.
macro_rules! names {
    ($type:ty, $what:literal: $($value:ident = $name:literal),+ $(,)?) => {
        impl From<$type> for &'static str {
            fn from(value: $type) -> Self {
                match value {
                    $(<$type>::$value => $name,)+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad((*self).into())
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::Error;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                match name {
                    $($name => Ok(Self::$value),)+
                    _ => Err(crate::Error::Name {
                        what: $what,
                        name: name.to_owned(),
                        names: [$($name),+].join(", "),
                    }),
                }
            }
        }
    };
}
