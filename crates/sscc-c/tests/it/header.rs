//! Tests that the header is that of the code. `SSCC_WRITE=1 cargo test -p sscc-c --test it header` writes it.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_code() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = package.join("../../include/sscc/sscc.h");
    let config = cbindgen::Config::from_file(package.join("cbindgen.toml")).unwrap();
    let bindings =
        cbindgen::Builder::new().with_src(package.join("src/lib.rs")).with_config(config).generate();
    let mut text = Vec::new();
    bindings.unwrap().write(&mut text);
    let text = without_safety(&String::from_utf8(text).unwrap());
    if std::env::var_os("SSCC_WRITE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let is_same = std::fs::read_to_string(&path).unwrap() == text;
    assert!(
        is_same,
        "sscc.h differs from the code: SSCC_WRITE=1 cargo test -p sscc-c --test it header writes it"
    );
}

/// The ABI version of the code is that of the header, of the names of the shared library, and of its documentation.
#[test]
fn all_places_have_the_same_abi() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let abi = sscc_c::SSCC_ABI_VERSION;
    assert_eq!(sscc_c::sscc_abi_version(), abi);
    let names = [("libsscc.so.", ""), ("libsscc.", ".dylib")];
    let places: [(&str, &[(&str, &str)]); 4] = [
        ("include/sscc/sscc.h", &[("#define SSCC_ABI_VERSION ", "\n")]),
        ("crates/sscc-c/build.rs", &names),
        ("crates/sscc-c/CMakeLists.txt", &names),
        ("docs/c.md", &names[..1]),
    ];
    for (path, texts) in places {
        let text = std::fs::read_to_string(root.join(path)).unwrap();
        for (before, after) in texts {
            let numbers = text.split(before).skip(1).filter_map(|rest| {
                let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
                (end > 0 && rest[end..].starts_with(after)).then(|| rest[..end].parse::<u32>().unwrap())
            });
            let numbers: Vec<u32> = numbers.collect();
            assert!(!numbers.is_empty(), "{path} has no {before}");
            assert!(numbers.iter().all(|number| *number == abi), "{path}: {before}{numbers:?}, not {abi}");
        }
    }
}

/// Returns the header without the sections on safety, which all refer to its head.
fn without_safety(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let is_title = |i: usize| lines.get(i) == Some(&"// # Safety");
    let is_kept = |i: &usize| !(is_title(i + 1) || is_title(*i) || *i > 0 && is_title(i - 1));
    (0..lines.len()).filter(is_kept).flat_map(|i| [lines[i], "\n"]).collect()
}
