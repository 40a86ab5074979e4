//! Reports invalid command lines, on one line like every other error.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;

use crate::outcome::EXIT_ERROR;
use crate::output::{is_written, one_line, write_stderr};

/// Prints help and version as they are, and an invalid command line as one line. Returns the exit code.
pub fn report(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            match is_written(error.print().and_then(|()| io::stdout().flush())) {
                Ok(_) => ExitCode::SUCCESS,
                Err(error) => {
                    write_stderr(one_line(&format!("error: {error:#}")));
                    ExitCode::from(EXIT_ERROR)
                }
            }
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            ExitCode::from(EXIT_ERROR)
        }
        _ => {
            write_stderr(one_line(&shortened(&error.to_string())));
            ExitCode::from(EXIT_ERROR)
        }
    }
}

/// Returns the cause and the tips of a clap error, without usage.
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
