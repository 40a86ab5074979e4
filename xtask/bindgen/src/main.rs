//! `bindgen INPUT.wasm FOLDER`: writes a package of JavaScript modules, with types, to FOLDER, and the same package as a
//! script without modules to FOLDER/script.

use std::env;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [input, folder] = &arguments[..] else {
        eprintln!("Usage: bindgen INPUT.wasm FOLDER");
        return ExitCode::from(2);
    };
    let written = write(input, folder, false).and_then(|()| write(input, &folder.join("script"), true));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}: {error}", input.display());
            ExitCode::FAILURE
        }
    }
}

fn write(input: &Path, folder: &Path, is_script: bool) -> Result<(), Box<dyn Error>> {
    let mut bindgen = Bindgen::new();
    bindgen
        .input_path(input)
        .out_name("sscc")
        .omit_default_module_path(is_script)
        .remove_name_section(true)
        .remove_producers_section(true);
    match is_script {
        true => bindgen.no_modules(true)?.no_modules_global("ssccPackage")?.typescript(false),
        false => bindgen.web(true)?.typescript(true),
    };
    Ok(bindgen.generate(folder)?)
}
