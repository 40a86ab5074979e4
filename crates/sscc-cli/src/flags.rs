//! Messages of libraries, with their settings as flags.

use std::error::Error;

use sscc_io::{IoError, Setting};
use sscc_sim::SimError;
use sscc_tasks::TaskError;
use sscc_view::ViewError;

/// Returns the flag of a setting.
pub fn flag(setting: Setting) -> String {
    format!("--{}", setting.name().replace('_', "-"))
}

/// Returns the message of an error, without those of its sources.
pub fn message(error: &(dyn Error + 'static)) -> String {
    if let Some(error) = error.downcast_ref::<TaskError>() {
        error.message().with_names(flag)
    } else if let Some(error) = error.downcast_ref::<SimError>() {
        error.message().with_names(flag)
    } else if let Some(sscc_bench::Error::Task(error)) = error.downcast_ref() {
        error.message().with_names(flag)
    } else if let Some(sscc_bench::Error::Sim(error)) = error.downcast_ref() {
        error.message().with_names(flag)
    } else if let Some(error) = error.downcast_ref::<IoError>() {
        error.message().with_names(flag)
    } else if let Some(ViewError::TooLarge) = error.downcast_ref() {
        format!("{error} (of an animation by --fps or --times)")
    } else {
        error.to_string()
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn every_setting_is_a_flag() {
        let cli = crate::args::Cli::command();
        let flags: Vec<&str> =
            cli.get_subcommands().flat_map(|c| c.get_arguments()).filter_map(|a| a.get_long()).collect();
        for setting in Setting::ALL {
            assert!(flags.contains(&&flag(*setting)[2..]), "{setting:?}");
        }
    }
}
