//! Reads the crates of the workspace from their manifests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::toml_file::TomlFile;

/// A crate of the workspace. All paths are relative to the root of the workspace.
pub struct Crate {
    pub name: String,
    pub folder: PathBuf,
    /// The path of its `Cargo.toml`.
    pub manifest: String,
    pub library: Option<Library>,
    /// The first file of each program.
    pub programs: Vec<PathBuf>,
    /// The crates of the workspace in `[dependencies]`.
    pub dependencies: Vec<Dependency>,
}

/// The library of a crate.
pub struct Library {
    /// The name in paths, such as `sscc_io`.
    pub ident: String,
    pub root: PathBuf,
}

/// A dependency on a crate.
pub struct Dependency {
    /// The name in paths.
    pub ident: String,
    /// The name of the crate.
    pub name: String,
    /// The line in the manifest.
    pub line: usize,
}

/// Reads all members of the workspace, in the order in which they are listed.
pub fn read(root: &Path) -> Result<Vec<Crate>, String> {
    let file = TomlFile::read(root, "Cargo.toml")?;
    let manifest = file.parse()?;
    let workspace = table(&manifest, "workspace").ok_or("Cargo.toml: there is no [workspace]")?;
    let mut folders = Vec::new();
    for member in strings(workspace, "members") {
        match member.strip_suffix("/*") {
            Some(parent) => folders.extend(manifests_below(root, parent)?),
            None => folders.push(member),
        }
    }
    let shared = table(workspace, "dependencies");
    let mut crates =
        folders.iter().map(|folder| read_crate(root, folder, shared)).collect::<Result<Vec<_>, _>>()?;
    let names: BTreeSet<String> = crates.iter().map(|krate| krate.name.clone()).collect();
    for krate in &mut crates {
        krate.dependencies.retain(|dependency| names.contains(&dependency.name));
    }
    Ok(crates)
}

fn manifests_below(root: &Path, parent: &str) -> Result<Vec<String>, String> {
    let entries = fs::read_dir(root.join(parent)).map_err(|error| format!("{parent}: {error}"))?;
    let names = entries.flatten().filter(|entry| entry.path().join("Cargo.toml").is_file());
    let mut folders: Vec<String> =
        names.map(|entry| format!("{parent}/{}", entry.file_name().to_string_lossy())).collect();
    folders.sort();
    Ok(folders)
}

/// Reads one crate, with all its dependencies.
fn read_crate(root: &Path, folder: &str, shared: Option<&DeTable<'_>>) -> Result<Crate, String> {
    let file = TomlFile::read(root, &format!("{folder}/Cargo.toml"))?;
    let manifest = file.parse()?;
    let name = table(&manifest, "package").and_then(|package| string(package, "name"));
    let name = name.ok_or_else(|| format!("{}: there is no name in [package]", file.path))?;
    let folder = PathBuf::from(folder);
    let exists = |path: &PathBuf| root.join(path).is_file();

    let described = table(&manifest, "lib");
    let path = described.and_then(|lib| string(lib, "path")).unwrap_or_else(|| "src/lib.rs".to_owned());
    let ident = described.and_then(|lib| string(lib, "name")).unwrap_or_else(|| name.clone());
    let library = Some(Library { ident: ident.replace('-', "_"), root: folder.join(path) });

    let mut programs = BTreeSet::from([folder.join("src/main.rs")]);
    if let Some(DeValue::Array(described)) = manifest.get("bin").map(toml::Spanned::get_ref) {
        for program in described.iter().filter_map(|program| program.get_ref().as_table()) {
            let path = string(program, "path");
            let of_name = || format!("src/bin/{}.rs", string(program, "name").unwrap_or_default());
            programs.insert(folder.join(path.unwrap_or_else(of_name)));
        }
    }
    let others = fs::read_dir(root.join(&folder).join("src/bin")).into_iter().flatten().flatten();
    programs.extend(others.map(|entry| folder.join("src/bin").join(entry.file_name())));

    let mut dependencies = Vec::new();
    let mut add = |table: &DeTable<'_>| {
        for (key, value) in table {
            let shared = shared.and_then(|shared| shared.get(key.get_ref().as_ref()));
            let renamed = [Some(value), shared].into_iter().flatten();
            let renamed = renamed.filter_map(|value| string(value.get_ref().as_table()?, "package")).next();
            dependencies.push(Dependency {
                ident: key.get_ref().replace('-', "_"),
                name: renamed.unwrap_or_else(|| key.get_ref().to_string()),
                line: file.line(key.span()),
            });
        }
    };
    table(&manifest, "dependencies").into_iter().for_each(&mut add);
    for (_, target) in table(&manifest, "target").into_iter().flatten() {
        let target = target.get_ref().as_table().and_then(|target| table(target, "dependencies"));
        target.into_iter().for_each(&mut add);
    }
    Ok(Crate {
        name,
        manifest: file.path.clone(),
        library: library.filter(|library| exists(&library.root)),
        programs: programs
            .into_iter()
            .filter(exists)
            .filter(|path| path.extension().is_some_and(|e| e == "rs"))
            .collect(),
        dependencies,
        folder,
    })
}

fn table<'a, 'text>(table: &'a DeTable<'text>, key: &str) -> Option<&'a DeTable<'text>> {
    table.get(key)?.get_ref().as_table()
}

fn string(table: &DeTable<'_>, key: &str) -> Option<String> {
    table.get(key)?.get_ref().as_str().map(str::to_owned)
}

fn strings(table: &DeTable<'_>, key: &str) -> Vec<String> {
    let Some(DeValue::Array(array)) = table.get(key).map(toml::Spanned::get_ref) else { return Vec::new() };
    array.iter().filter_map(|value| value.get_ref().as_str().map(str::to_owned)).collect()
}
