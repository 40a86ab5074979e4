//! The programs of `crates/sscc-c/tests/programs`: compilers, sanitizers, valgrind, installed package.

use std::path::{Path, PathBuf};

use super::checks::Checks;

const SOURCE: &str = "crates/sscc-c/tests/programs";
const NAMES: [&str; 4] = ["from_c", "from_c_static", "from_cpp", "no_exceptions"];

/// The option of CMake that names a compiler.
const COMPILERS: [(&str, [&str; 2]); 2] = [
    ("gcc", ["-DCMAKE_C_COMPILER=gcc", "-DCMAKE_CXX_COMPILER=g++"]),
    ("clang", ["-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++"]),
];

/// Runs all.
pub fn run(checks: &mut Checks) {
    for (compiler, options) in COMPILERS {
        for (kind, sanitize) in [("", "-DSSCC_SANITIZE=OFF"), (", sanitized", "-DSSCC_SANITIZE=ON")] {
            let name = format!("programs by {compiler}{kind}");
            let build = checks.folder.join(name.replace([' ', ','], "-"));
            checks.check(&name, |checks| {
                checks.cmake(SOURCE, &build, &[options[0], options[1], sanitize])?;
                all_pass(checks, &build)
            });
        }
    }
    let build = checks.folder.join("programs-by-gcc");
    for name in ["from_c", "from_cpp"] {
        checks.check(&format!("{name} under valgrind"), |checks| under_valgrind(checks, &build.join(name)));
    }
    checks.check("the installed package", |checks| installed(checks, &build));
}

/// Runs the programs of a build.
fn all_pass(checks: &Checks, build: &Path) -> Result<(), String> {
    for name in NAMES {
        let text = checks.succeed(build, &build.join(name), &[])?;
        if text != "passed\n" {
            return Err(format!("{name} printed {text:?}"));
        }
    }
    Ok(())
}

/// Any error fails, and so does any memory that is lost. Memory that is possibly lost is that of threads of the library, which
/// end a moment after their computation.
fn under_valgrind(checks: &Checks, program: &Path) -> Result<(), String> {
    let program = program.to_string_lossy();
    let arguments = [
        "-q",
        "--error-exitcode=9",
        "--leak-check=full",
        "--errors-for-leak-kinds=definite,indirect",
        &program,
    ];
    checks.succeed(&checks.folder, Path::new("valgrind"), &arguments).map(drop)
}

/// Installs the package, and builds programs with it: by CMake, and by pkg-config alone.
fn installed(checks: &Checks, build: &Path) -> Result<(), String> {
    let prefix = checks.folder.join("prefix");
    let own = build.join("sscc").to_string_lossy().into_owned();
    let prefix_text = prefix.to_string_lossy().into_owned();
    let package = checks.folder.join("package");
    let prefix_option = format!("-DCMAKE_INSTALL_PREFIX={prefix_text}");
    checks.cmake("crates/sscc-c", &package, &[&prefix_option, "-DCMAKE_INSTALL_LIBDIR=lib"])?;
    checks.succeed(&checks.root, Path::new("cmake"), &["--install", &package.to_string_lossy()])?;

    let found = checks.folder.join("found");
    let find = format!("-DCMAKE_PREFIX_PATH={prefix_text}");
    checks.cmake(SOURCE, &found, &[&find, "-DSSCC_STATIC=ON"])?;
    if found.join("sscc").exists() {
        return Err(format!("the package in {prefix_text} was not found: {own} was built"));
    }
    all_pass(checks, &found)?;

    let program = checks.folder.join("by_pkg_config");
    let flags = ["PKG_CONFIG_PATH=", &prefix_text, "/lib/pkgconfig pkg-config --cflags --libs sscc"].concat();
    let compile = format!(
        "gcc -std=c11 {SOURCE}/from_c.c -o '{}' $({flags}) -lpthread -lm -Wl,-rpath,'{prefix_text}/lib'",
        program.display()
    );
    checks.succeed(&checks.root, Path::new("sh"), &["-c", &compile])?;
    let text = checks.succeed(&checks.folder, &PathBuf::from(&program), &[])?;
    if text == "passed\n" { Ok(()) } else { Err(format!("by pkg-config: {text}")) }
}
