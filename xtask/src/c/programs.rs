//! The programs of `crates/sscc-c/tests/programs`: compilers, sanitizers, valgrind, installed package.

use std::fs;
use std::path::Path;

use super::checks::Checks;
use super::packages::BUILD_PROGRAMS;

const SOURCE: &str = "crates/sscc-c/tests/programs";
const NAMES: [&str; 4] = ["from_c", "from_c_static", "from_cpp", "no_exceptions"];

/// Compilers of C and of C++.
const COMPILERS: [[&str; 2]; 2] = [["gcc", "g++"], ["clang", "clang++"]];

/// The commands of `docs/c.md` that install the library.
const INSTALL: [&str; 3] =
    ["cmake -S crates/sscc-c -B build", "cmake --build build", "cmake --install build --prefix DIR"];

/// Runs all checks.
pub fn run(checks: &mut Checks) {
    for [c, cpp] in COMPILERS {
        let options = [format!("-DCMAKE_C_COMPILER={c}"), format!("-DCMAKE_CXX_COMPILER={cpp}")];
        for (kind, sanitize) in [("", "-DSSCC_SANITIZE=OFF"), (", sanitized", "-DSSCC_SANITIZE=ON")] {
            let name = format!("programs by {c}{kind}");
            let build = checks.folder.join(name.replace([' ', ','], "-"));
            checks.check(&name, &["cmake", "make", c, cpp], |checks| {
                checks.cmake(SOURCE, &build, &[&options[0], &options[1], sanitize])?;
                all_pass(checks, &build)
            });
        }
    }
    let build = checks.folder.join("programs-by-gcc");
    for name in ["from_c", "from_cpp"] {
        let needed = [&BUILD_PROGRAMS[..], &["valgrind"]].concat();
        let check = |checks: &Checks| under_valgrind(checks, &build.join(name));
        checks.check(&format!("{name} under valgrind"), &needed, check);
    }
    checks.check("the package, installed as docs/c.md says", &BUILD_PROGRAMS, install);
    checks.check("the installed package, found by CMake", &BUILD_PROGRAMS, found_by_cmake);
    let needed = [&BUILD_PROGRAMS[..], &["pkg-config"]].concat();
    checks.check("the installed package, found by pkg-config", &needed, found_by_pkg_config);
    checks.check("a package with a folder of its own", &needed, absolute_folder);
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

/// Runs a program under valgrind. Any error and any lost memory fail. Memory that is possibly lost does not fail: it belongs
/// to threads of the library, which end a moment after their computation.
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

/// Installs the package by the commands of the document. The prefix is given only to the last command, after the configuration.
fn install(checks: &Checks) -> Result<(), String> {
    let text = fs::read_to_string(checks.root.join("docs/c.md")).map_err(|e| format!("docs/c.md: {e}"))?;
    let [package, prefix] =
        ["package", "prefix"].map(|name| checks.folder.join(name).to_string_lossy().into_owned());
    for command in INSTALL {
        if !text.contains(&format!("`{command}`")) {
            return Err(format!("docs/c.md does not show `{command}`"));
        }
        let words = command.split(' ').map(|word| match word {
            "build" => &package,
            "DIR" => &prefix,
            _ => word,
        });
        let words: Vec<&str> = words.collect();
        checks.succeed(&checks.root, Path::new(words[0]), &words[1..])?;
    }
    Ok(())
}

/// Builds and runs the programs with the installed package.
fn found_by_cmake(checks: &Checks) -> Result<(), String> {
    let (prefix, build) = (checks.folder.join("prefix"), checks.folder.join("found"));
    let find = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    checks.cmake(SOURCE, &build, &[&find, "-DSSCC_STATIC=ON"])?;
    if build.join("sscc").exists() {
        return Err(format!("the package in {} was not found: another one was built", prefix.display()));
    }
    all_pass(checks, &build)
}

/// Builds and runs a program with pkg-config only.
fn found_by_pkg_config(checks: &Checks) -> Result<(), String> {
    let prefix = checks.folder.join("prefix");
    let prefix = prefix.display();
    let find = format!("PKG_CONFIG_PATH={prefix}/lib/pkgconfig:{prefix}/lib64/pkgconfig pkg-config sscc");
    let program = checks.folder.join("by_pkg_config");
    let compile = format!(
        "gcc -std=c11 {SOURCE}/from_c.c -o {} $({find} --cflags --libs) -lpthread -lm -Wl,-rpath,$({find} --variable=libdir)",
        program.display()
    );
    checks.succeed(&checks.root, Path::new("sh"), &["-c", &compile])?;
    let text = checks.succeed(&checks.folder, &program, &[])?;
    if text == "passed\n" { Ok(()) } else { Err(format!("by pkg-config: {text}")) }
}

/// Checks that a library folder with an absolute path is kept, and that pkg-config reports it.
fn absolute_folder(checks: &Checks) -> Result<(), String> {
    let build = checks.folder.join("absolute");
    let text = build.to_string_lossy();
    let options = ["-S", "crates/sscc-c", "-B", &text, "-DCMAKE_INSTALL_LIBDIR=/opt/sscc/lib"];
    checks.succeed(&checks.root, Path::new("cmake"), &options)?;
    let file = build.join("sscc.pc");
    let arguments = ["--variable=libdir", &file.to_string_lossy()];
    let found = checks.succeed(&checks.root, Path::new("pkg-config"), &arguments)?;
    if found == "/opt/sscc/lib\n" { Ok(()) } else { Err(format!("pkg-config reports {found:?}")) }
}
