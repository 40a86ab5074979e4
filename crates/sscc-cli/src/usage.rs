//! Refusals of the command line itself, in one line like every other error.

use std::process::ExitCode;

use clap::error::ErrorKind;

use crate::outcome::EXIT_ERROR;
use crate::output::{one_line, say};

/// Prints help and version as they are, and anything wrong with the command line as one line.
pub fn report(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // Whoever closed the pipe has seen enough.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            ExitCode::from(EXIT_ERROR)
        }
        _ => {
            say(one_line(&shortened(&error.to_string())));
            ExitCode::from(EXIT_ERROR)
        }
    }
}

/// The cause and the tips, without the pages around them.
fn shortened(text: &str) -> String {
    let kept: Vec<String> = text
        .split("\n\n")
        .map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|p| {
            let noise = ["Usage:", "For more information", "tip: to pass"];
            !p.is_empty() && !noise.iter().any(|start| p.starts_with(start))
        })
        .collect();
    format!("{} (see --help)", kept.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_one_line() {
        let text = "error: the following required arguments were not provided:\n  --output <FILE>\n\n\
            Usage: sscc certify --output <FILE> <MODEL>\n\nFor more information, try '--help'.\n";
        assert_eq!(
            shortened(text),
            "error: the following required arguments were not provided: --output <FILE> (see --help)"
        );
    }
}
