//! The `sscc` command.

fn main() -> std::process::ExitCode {
    sscc_cli::main()
}
