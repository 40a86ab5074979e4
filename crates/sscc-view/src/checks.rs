//! Data with which a report checks q itself: the core as WebAssembly, the model and its certificates in double precision.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use serde_json::Value;
use sscc::{Certificates, ReducedModel};
use sscc_io::container::{certificates_to_bytes, model_to_bytes};
use sscc_io::{ModelInfo, read_whole};

use crate::error::check_certificates;
use crate::{Arrays, ViewError};

/// The script of the npm package that a report contains.
const SCRIPT: &str = "script/sscc.js";

/// The WebAssembly module of the npm package that a report contains.
const MODULE: &str = "sscc_bg.wasm";

/// The file of the package with its version.
const MANIFEST: &str = "package.json";

/// Beginning of the script: the page uses this name.
const START: &str = "let ssccPackage";

/// The core as WebAssembly, from the folder of the npm package, with its script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WasmPackage {
    script: String,
    module: Vec<u8>,
}

impl WasmPackage {
    /// Reads the package.
    ///
    /// # Errors
    /// If one of its files cannot be read or is not of the package, or if the package has another version than this crate.
    pub fn read(folder: &Path) -> Result<Self, ViewError> {
        check_version(&folder.join(MANIFEST))?;
        let (script, module) = (folder.join(SCRIPT), folder.join(MODULE));
        let text = String::from_utf8(read_whole(&script)?).ok().filter(|text| text.starts_with(START));
        let bytes = read_whole(&module)?;
        let text = text.ok_or(ViewError::Package(script))?;
        match bytes.starts_with(b"\0asm") {
            true => Ok(Self { script: text, module: bytes }),
            false => Err(ViewError::Package(module)),
        }
    }
}

/// Refuses a package of another version: its answers may differ from those of this program.
fn check_version(manifest: &Path) -> Result<(), ViewError> {
    let refused = || ViewError::Package(manifest.to_path_buf());
    let value: Value = serde_json::from_slice(&read_whole(manifest)?).map_err(|_| refused())?;
    match value["version"].as_str().filter(|_| value["name"] == "sscc") {
        Some(env!("CARGO_PKG_VERSION")) => Ok(()),
        Some(found) => Err(ViewError::PackageVersion {
            path: manifest.to_path_buf(),
            found: found.escape_debug().to_string(),
        }),
        None => Err(refused()),
    }
}

/// The script, and the names of arrays that zlib has compressed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Checks {
    script: String,
    module: String,
    model: String,
    certificates: String,
}

impl Checks {
    /// Adds the package, the model and the certificates to the arrays of a report.
    ///
    /// # Errors
    /// If the certificates belong to another model or have a clearance.
    pub fn new(
        package: &WasmPackage,
        model: &ReducedModel,
        certificates: &Certificates,
        arrays: &mut Arrays,
    ) -> Result<Self, ViewError> {
        check_certificates(model, certificates)?;
        let model = model_to_bytes(model, &ModelInfo::new("", ""))?;
        let certificates = certificates_to_bytes(certificates)?;
        let mut add =
            |name: &str, bytes: &[u8]| Ok::<_, io::Error>(arrays.add_bytes(name, compressed(bytes)?));
        Ok(Self {
            script: package.script.clone(),
            module: add("module", &package.module)?,
            model: add("model", &model)?,
            certificates: add("certificates", &certificates)?,
        })
    }
}

fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}
