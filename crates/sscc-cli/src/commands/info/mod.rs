//! `sscc info`: shows the contents of a file.

mod certificates;
mod gltf;
mod model;
mod solid;
mod surface;
mod table;
mod text;

use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use sscc::TriMesh;
use sscc_io::{
    IoError, LoadOptions, LoadedMesh, LoadedModel, VolumeOrSurface, load_mesh_with_warnings, load_model_with,
    read_certificates, read_model, read_volume_or_surface,
};
use sscc_tasks::is_solid;

use crate::args::Info;
use crate::outcome::Outcome;
use crate::output::{Output, note, warn};
use certificates::CertificatesInfo;
use gltf::Gltf;
use model::Model;
use solid::Solid;
use surface::Surface;

/// The contents of a file, by kind.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Report {
    Mesh(Surface),
    Solid(Solid),
    Model(Model),
    Certificates(CertificatesInfo),
    Gltf(Gltf),
}

pub fn run(args: &Info) -> Result<Outcome> {
    let report = Report::of(&args.file)?;
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        report.lines().into_iter().try_for_each(|line| out.line(line))?;
    }
    out.finish()?;
    Ok(Outcome::Done)
}

impl Report {
    fn of(path: &Path) -> Result<Self, IoError> {
        match path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase().as_str() {
            "safetensors" => {}
            "glb" | "gltf" | "vrm" => return Ok(Self::Gltf(Gltf::of(path)?)),
            "npz" => {
                let LoadedModel { model, info, mode_weights, .. } =
                    load_model_with(path, &LoadOptions::default())?;
                return Ok(Self::Model(Model::of(&model, info).with_weights(mode_weights)));
            }
            _ if is_solid(path) => match read_volume_or_surface(path)? {
                VolumeOrSurface::Volume { mesh, faces } => {
                    faces.left_out(&mesh).into_iter().for_each(note);
                    return Ok(Self::Solid(Solid::of(&mesh)));
                }
                VolumeOrSurface::Surface { mesh, warnings } => {
                    return Ok(Self::surface(path, &mesh, &warnings));
                }
            },
            _ => {
                let LoadedMesh { mesh, warnings, .. } = load_mesh_with_warnings(path, None)?;
                return Ok(Self::surface(path, &mesh, &warnings));
            }
        }
        // The content decides. The name only selects the error for a file that is neither.
        let by_name = path.file_name().is_some_and(|n| n.to_string_lossy().ends_with(".sscc.safetensors"));
        Self::read(path, by_name).or_else(|error| Self::read(path, !by_name).or(Err(error)))
    }

    fn surface(path: &Path, mesh: &TriMesh, warnings: &[String]) -> Self {
        warnings.iter().for_each(|warning| warn(path, warning));
        Self::Mesh(Surface::of(mesh))
    }

    fn read(path: &Path, as_certificates: bool) -> Result<Self, IoError> {
        if as_certificates {
            return Ok(Self::Certificates(CertificatesInfo::of(&read_certificates(path)?)));
        }
        let (model, info) = read_model(path)?;
        Ok(Self::Model(Model::of(&model, info)))
    }

    fn lines(&self) -> Vec<String> {
        match self {
            Self::Mesh(surface) => surface.lines(),
            Self::Solid(solid) => solid.lines(),
            Self::Model(model) => model.lines(),
            Self::Certificates(certificates) => certificates.lines(),
            Self::Gltf(gltf) => gltf.lines(),
        }
    }
}
