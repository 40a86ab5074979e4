//! The packages of the workspace, from `cargo metadata`.

use std::path::PathBuf;

use serde_json::Value;

use crate::program::{cargo, output, root};

/// A package.
pub struct Package {
    pub name: String,
    pub version: String,
    /// Its folder.
    pub folder: PathBuf,
    /// Whether it may be published.
    pub is_published: bool,
    /// The oldest version of Rust that compiles the package, as its manifest states.
    pub rust_version: Option<String>,
    /// Required properties that the manifest lacks.
    pub missing: Vec<&'static str>,
}

/// Reads all packages.
pub fn read() -> Result<Vec<Package>, String> {
    let mut metadata = cargo();
    metadata.args(["metadata", "--format-version", "1", "--no-deps"]).current_dir(root());
    let text = output(&mut metadata, "cargo metadata failed")?;
    let json: Value = serde_json::from_str(&text).map_err(|error| format!("cargo metadata: {error}"))?;
    json["packages"].as_array().into_iter().flatten().map(package).collect()
}

fn package(json: &Value) -> Result<Package, String> {
    let text = |key: &str| json[key].as_str().map(str::to_owned);
    let required = |key: &str| text(key).ok_or_else(|| format!("cargo metadata: a package has no {key}"));
    let is_empty = |key: &str| match &json[key] {
        Value::String(text) => text.is_empty(),
        Value::Array(list) => list.is_empty(),
        _ => true,
    };
    let wanted = ["description", "license", "readme", "keywords", "categories", "rust_version", "authors"];
    Ok(Package {
        name: required("name")?,
        version: required("version")?,
        folder: PathBuf::from(required("manifest_path")?).parent().map(PathBuf::from).unwrap_or_default(),
        is_published: json["publish"].as_array().is_none_or(|registries| !registries.is_empty()),
        rust_version: text("rust_version"),
        missing: wanted.into_iter().filter(|key| is_empty(key)).collect(),
    })
}
