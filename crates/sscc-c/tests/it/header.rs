//! The header is that of the code. `SSCC_WRITE=1 cargo test -p sscc-c --test it header` writes it.

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

/// The header without the sections on safety, all of which refer to its head.
fn without_safety(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let is_title = |i: usize| lines.get(i) == Some(&"// # Safety");
    let is_kept = |i: &usize| !(is_title(i + 1) || is_title(*i) || *i > 0 && is_title(i - 1));
    (0..lines.len()).filter(is_kept).flat_map(|i| [lines[i], "\n"]).collect()
}
