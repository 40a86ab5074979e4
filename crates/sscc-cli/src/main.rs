//! The program `sscc`; the library `sscc_cli` implements it.

fn main() -> std::process::ExitCode {
    sscc_cli::main()
}
