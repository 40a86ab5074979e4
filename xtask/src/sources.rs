//! The Rust files of the workspace: their text without comments and without items for tests.

use std::fs;
use std::path::Path;

use toml::{Table, Value};

/// A crate of the workspace.
pub struct Crate {
    pub name: String,
    /// Its folder, relative to the root of the workspace.
    pub folder: String,
    /// The names in its `[dependencies]`.
    pub dependencies: Vec<String>,
    pub files: Vec<Source>,
}

/// A file of a crate.
pub struct Source {
    /// Its path, relative to the root of the workspace.
    pub path: String,
    /// The names of its module; empty for `lib.rs` and `main.rs`.
    pub module: Vec<String>,
    /// The lines of the product with their numbers, counted from 1.
    pub lines: Vec<(usize, String)>,
}

/// Reads all crates, in the order of the workspace.
pub fn read(root: &Path) -> Result<Vec<Crate>, String> {
    let workspace = table(root, "Cargo.toml")?;
    let members = workspace.get("workspace").and_then(|all| all.get("members")).and_then(Value::as_array);
    let members = members.ok_or("Cargo.toml: there is no list of members")?;
    members.iter().filter_map(Value::as_str).map(|folder| read_crate(root, folder)).collect()
}

fn table(root: &Path, path: &str) -> Result<Table, String> {
    text(root, path)?.parse().map_err(|error| format!("{path}: {error}"))
}

/// Returns the text of a file. An error names the file.
pub fn text(root: &Path, path: &str) -> Result<String, String> {
    fs::read_to_string(root.join(path)).map_err(|error| format!("{path}: {error}"))
}

fn read_crate(root: &Path, folder: &str) -> Result<Crate, String> {
    let path = format!("{folder}/Cargo.toml");
    let manifest = table(root, &path)?;
    let name = manifest.get("package").and_then(|package| package.get("name")).and_then(Value::as_str);
    let name = name.ok_or_else(|| format!("{path}: there is no name"))?.to_owned();
    let targets = manifest.get("target").and_then(Value::as_table);
    let tables = targets.into_iter().flat_map(|all| all.values()).filter_map(Value::as_table);
    let dependencies = tables
        .chain([&manifest])
        .filter_map(|table| table.get("dependencies")?.as_table())
        .flat_map(|all| all.keys().cloned())
        .collect();
    let mut files = Vec::new();
    add_files(root, &format!("{folder}/src"), &[], &mut files)?;
    Ok(Crate { name, folder: folder.to_owned(), dependencies, files })
}

/// Adds the files of a folder with the given module, except files for tests.
fn add_files(root: &Path, folder: &str, module: &[String], files: &mut Vec<Source>) -> Result<(), String> {
    let at = |error| format!("{folder}: {error}");
    let mut names = Vec::new();
    for entry in fs::read_dir(root.join(folder)).map_err(at)? {
        names.push(entry.map_err(at)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    for name in names {
        let path = format!("{folder}/{name}");
        let stem = name.strip_suffix(".rs").unwrap_or(&name);
        let own = match stem {
            "lib" | "main" if module.is_empty() => module.to_vec(),
            "mod" => module.to_vec(),
            "tests" => continue,
            _ => [module, &[stem.to_owned()]].concat(),
        };
        if root.join(&path).is_dir() {
            add_files(root, &path, &own, files)?;
        } else if name.ends_with(".rs") {
            files.push(Source { lines: product_lines(&text(root, &path)?), path, module: own });
        }
    }
    // Files that are modules only for tests are skipped.
    let is_declared = |lines: &[(usize, String)], name: &str| {
        lines.iter().any(|(_, line)| line.trim_end().ends_with(&format!("mod {name};")))
    };
    let roots: Vec<Vec<(usize, String)>> =
        files.iter().filter(|file| file.module == module).map(|file| file.lines.clone()).collect();
    if !roots.is_empty() {
        files.retain(|file| {
            let Some(child) = file.module.strip_prefix(module).and_then(|rest| rest.first()) else {
                return true;
            };
            roots.iter().any(|lines| is_declared(lines, child))
        });
    }
    Ok(())
}

/// Returns the lines of formatted code that are part of the product, without comments, blank lines and items for tests.
pub fn product_lines(text: &str) -> Vec<(usize, String)> {
    let is_code = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, line)| is_code(line));
    let mut product = Vec::new();
    while let Some((number, line)) = lines.next() {
        let attribute = line.trim_start();
        if !["#[cfg(test)]", "#[test]", "#[cfg(all(test"].iter().any(|test| attribute.starts_with(test)) {
            product.push((number, line.to_owned()));
            continue;
        }
        // The item ends on the line that closes all of its brackets.
        let mut open = 0;
        for (_, line) in lines.by_ref() {
            if line.trim_start().starts_with("#[") && open == 0 {
                continue;
            }
            let code = without_text(line);
            open +=
                code.matches(['{', '(', '[']).count() as i64 - code.matches(['}', ')', ']']).count() as i64;
            if open == 0 && code.trim_end().ends_with([';', '}', ',']) {
                break;
            }
        }
    }
    product
}

/// Returns a line without the contents of its string and character literals, and without a comment at its end.
pub fn without_text(line: &str) -> String {
    let mut code = String::new();
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' => {
                code.push('"');
                while let Some(next) = characters.next() {
                    match next {
                        '\\' => _ = characters.next(),
                        '"' => break,
                        _ => {}
                    }
                }
                code.push('"');
            }
            '\'' => {
                // This is a character literal or a lifetime.
                let mut ahead = characters.clone();
                let first = ahead.next();
                let is_literal = first == Some('\\') || ahead.next() == Some('\'');
                if is_literal {
                    if first == Some('\\') {
                        characters.next();
                    }
                    characters.next();
                    while characters.next().is_some_and(|next| next != '\'') {}
                }
                code.push('\'');
            }
            '/' if characters.peek() == Some(&'/') => break,
            _ => code.push(character),
        }
    }
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_tests_do_not_count() {
        let text = "//! A file.\n\nuse a::b;\n\n/// A function.\nfn f() {\n    // Nothing.\n    g(\"}\", '{', '\\'', \"\\\"{\"); // {\n}\n\n\
                    mod inner {\n    #[cfg(test)]\n    mod tests {\n        fn t() {}\n    }\n}\n\n\
                    #[cfg(test)]\nuse a::{\n    b,\n    c,\n};\n\n#[cfg(test)]\n#[derive(Clone)]\nmod tests {\n    use super::*;\n    fn t() {}\n}\n";
        // These are the `use`, three lines of the function, and two of the inner module.
        let lines: Vec<usize> = product_lines(text).into_iter().map(|(number, _)| number).collect();
        assert_eq!(lines, [3, 6, 8, 9, 11, 16]);
    }
}
