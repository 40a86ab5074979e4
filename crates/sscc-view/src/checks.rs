//! What a report needs to check q itself: the core as WebAssembly, the model and its certificates in double precision.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use sscc::{Certificates, ReducedModel};
use sscc_io::container::{certificates_to_bytes, model_to_bytes};
use sscc_io::{ModelInfo, read_whole};

use crate::error::check_certificates;
use crate::{Arrays, ViewError};

/// The files of the npm package that a report contains.
const SCRIPT: &str = "script/sscc.js";
const MODULE: &str = "sscc_bg.wasm";

/// How the script begins: the page calls that name.
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
    /// If a file of it cannot be read, or is none of the package.
    pub fn read(folder: &Path) -> Result<Self, ViewError> {
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
