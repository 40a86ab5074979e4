//! Makes the model of `sscc modes` by the kind of its modes.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use sscc_io::read_frames;
use sscc_tasks::{
    Fix, ModesKind, NewModel, POLYNOMIAL_MODES_ERROR, SolidSource, elastic_model, is_solid, pca_model,
    polynomial_model, read_surface, scaled,
};

use super::material;
use crate::args;
use crate::load::in_file;
use crate::output::{file_name, note, warn};
use crate::progress::Bar;

/// Makes the model. Errors name the source, or the flags that the kind of modes excludes.
pub fn make(args: &args::Modes) -> Result<NewModel> {
    let kind = match args.kind {
        args::ModesKind::Linear => ModesKind::Linear,
        args::ModesKind::Nonlinear => ModesKind::Nonlinear,
        args::ModesKind::Polynomial if !needs_solid(args) => return surface_polynomials(args),
        args::ModesKind::Polynomial => ModesKind::Polynomial,
        args::ModesKind::Pca => return principal_components(args),
    };
    elastic(args, kind).map_err(|error| in_file(error, &args.source))
}

fn elastic(args: &args::Modes, kind: ModesKind) -> Result<NewModel> {
    let scale = args.factor();
    if kind == ModesKind::Polynomial {
        refuse_rank_and_fix(args)?;
    }
    let material = args.material.as_deref().map(material::parse).transpose()?.unwrap_or_default();
    let fix = args.fix.as_deref().map(|typed| Fix::parse(typed, Path::new(""), "--fix")).transpose()?;
    let fix = fix.map(|fix| fix.scaled(scale));
    let bar = Bar::new("modes");
    let source = match &args.solid {
        Some(solid) => SolidSource::read_within(&args.source, solid, scale, &material, &bar)?,
        None => SolidSource::read(
            &args.source,
            args.resolution.map(|cells| cells as usize),
            scale,
            &material,
            &bar,
        )?,
    };
    source.note().into_iter().for_each(note);
    if let Some(replaced) = &source.material().replaced {
        note(format_args!("--material overrides the file's materials: {replaced}"));
    }
    let typed = args.fix.as_deref().unwrap_or_default();
    let fixed = fix.map(|fix| fix.vertices(&source).map_err(|error| error.at(format!("--fix {typed}"))));
    let fixed = fixed.transpose()?.unwrap_or_default();
    let rank = args.rank.map(|rank| rank as usize);
    let name = match &args.solid {
        Some(solid) => format!("{} in {}", file_name(&args.source), file_name(solid)),
        None => file_name(&args.source),
    };
    Ok(elastic_model(kind, rank, source, &fixed, &name, &bar)?)
}

/// Whether polynomial modes are those of a solid, which has a stiffness.
fn needs_solid(args: &args::Modes) -> bool {
    args.solid.is_some() || args.resolution.is_some() || args.material.is_some() || is_solid(&args.source)
}

fn surface_polynomials(args: &args::Modes) -> Result<NewModel> {
    refuse_rank_and_fix(args)?;
    let (mesh, warnings) = read_surface(&args.source)?;
    warnings.iter().for_each(|warning| warn(&args.source, warning));
    let made = scaled(mesh, args.factor()).and_then(|mesh| polynomial_model(mesh, &file_name(&args.source)));
    made.with_context(|| args.source.display().to_string())
}

fn refuse_rank_and_fix(args: &args::Modes) -> Result<()> {
    if args.rank.is_some() || args.fix.is_some() {
        bail!("--rank and --fix: {POLYNOMIAL_MODES_ERROR}");
    }
    Ok(())
}

fn principal_components(args: &args::Modes) -> Result<NewModel> {
    let shown = args.source.display();
    ensure!(
        args.fix.is_none() && args.material.is_none() && args.resolution.is_none() && args.solid.is_none(),
        "--fix, --material, --resolution and --solid: principal components need no solid; leave these flags out"
    );
    ensure!(!args.source.is_file(), "{shown}: is a file; --kind pca needs a folder of meshes (the frames)");
    let mut frames = read_frames(&args.source)?;
    frames.positions.iter_mut().flatten().for_each(|p| *p *= args.factor());
    frames.warnings.iter().for_each(|warning| warn(&frames.paths[0], warning));
    let rank = args.rank.map(|rank| rank as usize);
    let name = format!("meshes in {}", file_name(&args.source));
    let made = pca_model(&frames.mesh, &frames.positions, rank, &name, &Bar::new("modes"));
    made.with_context(|| shown.to_string())
}
