//! Arguments that have an effect only with another one.
//!
//! They are not declared by clap's `requires`, because clap waives that if an argument is given which excludes the required one.

use clap::ArgMatches;
use clap::parser::ValueSource;

/// Names of a command, of its argument, and of the argument that this one needs.
const NEEDED: [[&str; 3]; 12] = [
    ["certify", "proof-sample", "proof"],
    ["certify", "rings", "clearance"],
    ["check", "against-frames", "against"],
    ["check", "against-mesh", "against"],
    ["check", "fps", "animation"],
    ["check", "node", "animation"],
    ["check", "penetration", "against"],
    ["check", "rings", "clearance"],
    ["check", "times", "animation"],
    ["check", "weights", "animation"],
    ["sweep", "report", "intervals"],
    ["view", "wasm", "report"],
];

/// Checks that each argument has the one that it needs.
///
/// # Errors
/// The cause, if an argument has none.
pub fn check(matches: &ArgMatches) -> Result<(), String> {
    let Some((command, arguments)) = matches.subcommand() else { return Ok(()) };
    let is_given = |name: &str| {
        let source = arguments.value_source(&name.replace('-', "_"));
        source == Some(ValueSource::CommandLine)
    };
    match NEEDED.iter().find(|[of, name, needed]| *of == command && is_given(name) && !is_given(needed)) {
        Some([_, name, needed]) => {
            Err(format!("--{name} has an effect only with --{needed}: add --{needed}, or leave --{name} out"))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn all_names_are_those_of_arguments() {
        let cli = crate::args::Cli::command();
        for [command, name, needed] in NEEDED {
            let command = cli.find_subcommand(command).unwrap();
            for name in [name, needed] {
                let argument = command.get_arguments().find(|argument| argument.get_long() == Some(name));
                let id = argument.unwrap_or_else(|| panic!("{name}")).get_id();
                assert_eq!(id.as_str().replace('_', "-"), name);
            }
        }
    }

    /// Each of these lines has an argument that excludes the one needed.
    #[test]
    fn arguments_without_the_one_they_need_are_refused() {
        for line in [
            "sscc sweep M --pose D --report r.html",
            "sscc sweep M --combinations --report r.html",
            "sscc check a.obj b.obj --penetration",
            "sscc check M --q=0 --penetration",
            "sscc check M --q=0 --rings 3 --first",
            "sscc check M --q=0 --rings 3 --depths",
            "sscc check M --q=0 --fps 30",
            "sscc check M --trajectory q.npy --times 1",
            "sscc check M --q=0 --node x",
            "sscc check M --q=0 --weights as-stored",
            "sscc check M --q=0 --against-mesh N",
            "sscc check a.obj b.obj --against-frames f.npy",
            "sscc check c.glb --animation 0 --against-mesh B",
            "sscc certify M -o X --proof P --rings 3",
            "sscc certify M -o X --clearance 0.1 --proof-sample 10",
            "sscc view M --no-open --wasm DIR",
        ] {
            let error = crate::args::parse(line.split(' ').map(Into::into)).unwrap_err().to_string();
            assert!(error.contains(" has an effect only with --"), "{line}: {error}");
        }
        let valid = "sscc check M --animation 0 --fps 30";
        assert!(crate::args::parse(valid.split(' ').map(Into::into)).is_ok());
    }
}
