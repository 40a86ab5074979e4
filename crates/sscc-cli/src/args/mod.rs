//! Command-line arguments as typed, and the help texts, in one file for each command. [`commands`](crate::commands)
//! interprets the arguments.

/// The template of a help page with examples, one command a line. The examples are part of the template because clap
/// wraps all other text at the terminal's width, and a wrapped command cannot be pasted into a shell.
macro_rules! with_examples {
    ($($example:literal)+) => {
        concat!(
            "{before-help}{about-with-newline}\n{usage-heading} {usage}\n\n{all-args}\n\nExamples:",
            $("\n  ", $example,)+
            "{after-help}"
        )
    };
}

mod audit;
mod bench;
mod certify;
mod check;
mod demo;
mod fit;
mod info;
mod load;
mod model;
mod modes;
mod motion;
mod requirements;
mod resolve;
mod simulate;
mod sweep;
mod values;
mod view;

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub use audit::Audit;
pub use bench::Bench;
pub use certify::Certify;
pub use check::{At, Check};
pub use demo::Demo;
pub use fit::Fit;
pub use info::Info;
pub use load::Load;
pub use model::{Groups, Model, Options, Scheme, Switch, Threads};
pub use modes::{Modes, ModesKind};
pub use motion::Weights;
pub use resolve::Resolve;
pub use simulate::Simulate;
pub use sweep::Sweep;
pub use view::View;

/// Exact self-collision detection for deformable triangle meshes.
///
/// A mesh deforms by modes: at q its shape is x = p + U q. `sscc certify` computes certificates once. `sscc check` then
/// answers whether the shape collides with itself at q. For the guarantee see docs/guarantees.md in the repository.
#[derive(Debug, Parser)]
#[command(
    name = "sscc",
    version,
    propagate_version = true,
    max_term_width = 100,
    help_template = with_examples!(
        "sscc demo --out demo"
        "sscc certify demo/spring.model.safetensors -o spring.sscc.safetensors"
        "sscc check demo/spring.model.safetensors --certificates spring.sscc.safetensors --trajectory demo/spring.npy"
    ),
    after_help = "Exit codes: 0 done (check: every q is free), 1 finding of check, sweep, resolve or audit (see the \
        help of the command), 2 error, 130 interrupted."
)]
pub struct Cli {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Certify and animate an embedded spring, and check every frame by three methods
    Demo(Demo),
    /// Compute deformation modes of a surface, a solid or an animation, and write a model file
    Modes(Modes),
    /// Compute the certificates of a model, and write them to a file
    Certify(Certify),
    /// Check whether a model collides with itself at q, or a mesh as it is, in frames, in an animation or against another
    /// mesh, and list the colliding triangle pairs
    Check(Box<Check>),
    /// Find for each mode or morph target the first weight at which the shape touches itself
    Sweep(Box<Sweep>),
    /// Find a free q near each colliding q of a model
    Resolve(Box<Resolve>),
    /// Compute the q of a load: the linear static answer of a model with stiffness
    Load(Load),
    /// Compute the q whose shape is nearest to given positions of all vertices
    Fit(Fit),
    /// Search for collisions that refute certificates, and measure how tight their radii are
    Audit(Audit),
    /// Show the contents of a model, certificate, mesh, solid or glTF file
    Info(Info),
    /// Simulate the bodies of a scene with contact and friction, and write their motion
    Simulate(Simulate),
    /// Measure queries by every method, and by another library for comparison
    Bench(Bench),
    /// Show a model in the browser (modes, collisions and certified radii, live), or the report of a folder
    View(View),
}

/// Parses a command line.
///
/// # Errors
/// When it is invalid, or asks for help or the version.
pub fn parse(typed: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let mut command = Cli::command();
    let matches = command.try_get_matches_from_mut(with_joined_values(typed))?;
    let refused = |cause| command.error(ErrorKind::MissingRequiredArgument, cause);
    requirements::check(&matches).map_err(refused)?;
    Cli::from_arg_matches(&matches)
}

/// Joins flags whose value is optional, such as `--weld`, with a value in the next word, such as `off`: the parser would take the
/// word for the name of a file. A word that is the name of a file remains one, except after `--weld`.
fn with_joined_values(typed: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut has_ended = false;
    for word in typed {
        match joined.last_mut() {
            Some(last)
                if !has_ended
                    && is_value_of(last, &word)
                    && (last == "--weld" || !Path::new(&word).exists()) =>
            {
                last.push("=");
                last.push(word);
            }
            _ => {
                has_ended |= word == "--";
                joined.push(word);
            }
        }
    }
    joined
}

/// Whether a word can only be the value of a flag whose value is optional.
fn is_value_of(flag: &OsStr, word: &OsStr) -> bool {
    let (Some(flag), Some(word)) = (flag.to_str(), word.to_str()) else { return false };
    match flag {
        "--weld" => word == "on" || word == "off",
        "--ignore-rest" | "--intervals" => word.parse::<u32>().is_ok(),
        "--gravity" => {
            word.split(',').count() == 3 && word.split(',').all(|part| part.parse::<f64>().is_ok())
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn optional_values_may_follow_a_blank() {
        let weld = |words: &str| {
            let words = with_joined_values(words.split(' ').map(OsString::from));
            match Cli::try_parse_from(words).map(|cli| cli.command) {
                Ok(Command::Check(check)) => Some((check.options.weld, check.meshes)),
                _ => None,
            }
        };
        assert_eq!(weld("sscc check a.obj --weld off"), Some((Some(Switch::Off), vec![])));
        assert_eq!(weld("sscc check --weld on a.obj"), Some((Some(Switch::On), vec![])));
        assert_eq!(weld("sscc check --weld=off a.obj"), Some((Some(Switch::Off), vec![])));
        assert_eq!(weld("sscc check a.obj --weld b.obj"), Some((Some(Switch::On), vec!["b.obj".into()])));
        assert_eq!(weld("sscc check a.obj -- off"), Some((None, vec!["off".into()])));
        for (typed, expected) in [
            ("check a.obj --ignore-rest 1", "check a.obj --ignore-rest=1"),
            ("check --ignore-rest a.obj", "check --ignore-rest a.obj"),
            ("check --ignore-rest -- 1", "check --ignore-rest -- 1"),
            ("sweep a.glb --intervals 11 --json", "sweep a.glb --intervals=11 --json"),
            ("load a.npz --gravity 0,-9.81,0 -o q.npy", "load a.npz --gravity=0,-9.81,0 -o q.npy"),
            ("load a.npz --gravity 0,1 -o q.npy", "load a.npz --gravity 0,1 -o q.npy"),
            ("check a.obj --weld 1", "check a.obj --weld 1"),
        ] {
            let joined = with_joined_values(typed.split(' ').map(OsString::from));
            assert_eq!(joined, expected.split(' ').map(OsString::from).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
