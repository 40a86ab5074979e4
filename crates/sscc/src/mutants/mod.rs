//! Mutations: wrong variants of single terms of the core, each of which some test must catch.
//!
//! `list.rs` lists them, and `cargo xtask mutants` runs the test named for each. The macro has the right code first, then
//! the wrong one:
//!
//! ```text
//! let norm = with_mutant!(self.region.norm, KineticRegionAtCenter, start.norm);
//! ```
//!
//! Without the feature `mutants`, and in every build without debug assertions, the macro expands to its first argument
//! alone. With it the environment variable `SSCC_MUTANT` names the mutation of a process, so that one build serves all
//! mutations.

#[cfg(not(all(feature = "mutants", debug_assertions)))]
macro_rules! with_mutant {
    ($right:expr, $($mutant:ident, $wrong:expr),+ $(,)?) => {
        $right
    };
}

#[cfg(all(feature = "mutants", debug_assertions))]
macro_rules! with_mutant {
    ($right:expr, $($mutant:ident, $wrong:expr),+ $(,)?) => {
        match $crate::mutants::active() {
            $(Some($crate::mutants::Mutant::$mutant) => {
                $crate::mutants::reached();
                $wrong
            })+
            _ => $right,
        }
    };
}

#[cfg(all(feature = "mutants", debug_assertions))]
mod switch {
    use std::io::Write;
    use std::sync::{Once, OnceLock};

    macro_rules! mutants {
        ($($(#[doc = $wrong:literal])+ $name:ident: $fate:ident($text:literal);)+) => {
            /// A mutation.
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub(crate) enum Mutant {
                $($(#[doc = $wrong])+ $name,)+
            }

            impl Mutant {
                /// Returns the mutation of that name.
                fn from_name(name: &str) -> Option<Self> {
                    match name {
                        $(stringify!($name) => Some(Self::$name),)+
                        _ => None,
                    }
                }
            }
        };
    }

    include!("list.rs");

    /// Returns the mutation of this process, which is read once.
    pub(crate) fn active() -> Option<Mutant> {
        static ACTIVE: OnceLock<Option<Mutant>> = OnceLock::new();
        *ACTIVE.get_or_init(|| {
            let name = std::env::var("SSCC_MUTANT").ok()?;
            let mutant = Mutant::from_name(&name);
            assert!(mutant.is_some(), "SSCC_MUTANT={name}: there is no such mutation");
            mutant
        })
    }

    /// Writes once to standard error that wrong code ran. (The test harness captures `eprintln!`, but not this output.)
    pub(crate) fn reached() {
        static REACHED: Once = Once::new();
        REACHED.call_once(|| {
            let _ = std::io::stderr().write_all(b"mutant reached\n");
        });
    }
}

#[cfg(all(feature = "mutants", debug_assertions))]
pub(crate) use switch::{Mutant, active, reached};
