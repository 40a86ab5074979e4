//! Checks meshes without modes: as they are, in frames, in an animation, or against another mesh.

use std::iter;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use sscc::TriMesh;
use sscc_io::gltf::SkinWeights;
use sscc_io::{is_collection, split_mesh_name, write_whole};
use sscc_tasks::{
    AnimationMotion, Detection, DetectionAnswer, MeshMotion, OtherMesh, TaskError, Times, detect,
};
use sscc_view::MeshReport;

use super::data_set::DataSet;
use super::frames_out::FramesOut;
use super::printer::Printer;
use super::shapes;
use super::soup_hint::SoupHint;
use crate::args::{Check, Switch, Weights};
use crate::load;
use crate::stages::Stages;

/// Answers every query. Returns whether any of them found a collision.
pub fn check(args: &Check) -> Result<bool> {
    check_flags(args)?;
    let mut data_set = DataSet::of(args)?;
    shapes::check(args, &data_set.files)?;
    let request = request(args, data_set.files.clone())?;
    let noun = match (&request.motion, args.continuous) {
        (_, true) => "step",
        (MeshMotion::Rest, _) if request.against.as_ref().is_some_and(|other| other.frames.is_none()) => {
            "comparison"
        }
        (MeshMotion::Rest, _) if request.against.as_ref().is_none_or(|other| other.frames.is_none()) => {
            "file"
        }
        _ => "frame",
    };
    let mut printer = Printer::new(noun, args.json.json, None);
    printer.has_files = data_set.has_several();
    printer.has_folder = data_set.has_folder;
    printer.only_colliding = args.only.is_colliding();
    printer.needs_last = args.curves.is_some() || args.pose.is_some();
    let mut report = MeshReport::default();
    let mut frames_out = args.frames_out.as_deref().map(FramesOut::new);
    let mut answers = 0;
    let mut hint = SoupHint::default();
    let watch = Stages::default();
    let take = |file: &Path, found: Result<&DetectionAnswer<'_>, TaskError>| {
        let found = match found {
            Ok(found) => found,
            Err(error) if data_set.has_several() => return printer.fail(&data_set.fail(file, &error)),
            Err(error) => return Err(error.into()),
        };
        answers += 1;
        if let Some(path) = &args.curves
            && data_set.files.last().is_some_and(|last| last == file)
        {
            check_curves(path, &request, found)?;
        }
        if found.node.is_some() && matches!(request.motion, MeshMotion::Rest) {
            printer.set_noun("comparison");
        }
        // Pairs of two meshes are never neighbours, and the meshes of nodes are welded.
        if request.against.is_none() && found.node.is_none() && !is_welded(&request, found.mesh) {
            hint.add(found);
        }
        if let (Some(path), Some(shape)) = (&args.pose, found.shape)
            && answers == found.queries
        {
            shapes::write_pose(path, found.mesh, shape.x_t0, found.pairs)?;
        }
        if let Some(frames) = &mut frames_out {
            frames.add(found)?;
        }
        if let Some(path) = &args.report {
            let is_between_nodes = request.against.is_none() && found.other_node.is_some();
            let added = if is_between_nodes { report.add_between_nodes(found) } else { report.add(found) };
            added.with_context(|| path.display().to_string())?;
        }
        shapes::write_curves(args.curves.as_deref(), found)?;
        // Files have all frames, even if the output has no reader.
        let go_on = args.report.is_some() || args.frames_out.is_some();
        printer.answer(found).map(|next| if go_on { ControlFlow::Continue(()) } else { next })
    };
    detect(&request, &watch, take)?;
    frames_out.map_or(Ok(()), FramesOut::finish)?;
    if let Some(path) = &args.report {
        write_whole(path, report.html().with_context(|| path.display().to_string())?.as_bytes())?;
    }
    let colliding = printer.finish()?;
    hint.print(&args.model.path);
    data_set.finish()?;
    Ok(colliding)
}

/// Refuses the curves of a scene whose nodes are compared with each other: the file would lack those between two nodes.
fn check_curves(path: &Path, request: &Detection, found: &DetectionAnswer<'_>) -> Result<()> {
    let is_at_rest = matches!(request.motion, MeshMotion::Rest);
    let is_scene = request.against.is_none() && found.node.is_some() && (is_at_rest || request.between_nodes);
    let way_out = match is_at_rest {
        true => "name one as FILE#NODE, and a second one by --against FILE#NODE",
        false => "name one by --node",
    };
    ensure!(
        !is_scene || found.queries == found.frames,
        "{}: contact curves are those of one mesh or between two, but {} shows several nodes: {way_out}",
        path.display(),
        found.file.display()
    );
    Ok(())
}

/// Whether equal vertices of a mesh are welded, or the user has decided.
fn is_welded(request: &Detection, mesh: &TriMesh) -> bool {
    request.weld.is_some() || mesh.has_split_vertices()
}

/// Returns the frames of the mesh: those of `--frames`, or of the mesh itself if it is a collection.
fn frames(args: &Check) -> Option<PathBuf> {
    let own = || is_own_frames(&args.model.path).then(|| args.model.path.clone());
    args.motion.frames.clone().or_else(own)
}

/// Returns the frames of the other mesh, as [`frames`].
fn against_frames(args: &Check, other: &Path) -> Option<PathBuf> {
    args.motion.against_frames.clone().or_else(|| is_own_frames(other).then(|| other.to_owned()))
}

/// Whether a mesh is a collection, which has frames of its own.
fn is_own_frames(path: &Path) -> bool {
    is_collection(&split_mesh_name(path).0)
}

/// Refuses flags for models, and flags that have no effect together.
fn check_flags(args: &Check) -> Result<()> {
    let (options, motion) = (&args.options, &args.motion);
    let is_model = |path: &&PathBuf| {
        path.extension()
            .is_some_and(|e| ["safetensors", "npz"].iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    let model = iter::once(&args.model.path).chain(&args.meshes).find(is_model);
    let as_mesh = motion.frames.is_some() || motion.against.is_some();
    if let Some(path) = args.model.modes.is_some().then_some(&args.model.path).or(model.filter(|_| !as_mesh))
    {
        bail!("{}: a model deforms by modes: add --q or --trajectory", path.display());
    }
    for (flag, is_given) in [
        ("certificates", args.certificates.is_some()),
        ("method", args.method.is_some()),
        ("epsilon", options.epsilon.is_some()),
        ("metric", options.metric.is_some()),
        ("center", options.center.is_some()),
        ("max-exceptions", options.max_exceptions.is_some()),
        ("scheme", options.scheme.is_some()),
        ("budget", options.budget.is_some()),
        ("local-budget", options.local_budget.is_some()),
        ("reach", options.reach.is_some()),
    ] {
        ensure!(!is_given, "--{flag} is for models with modes: add --q or --trajectory, or leave it out");
    }
    if motion.against.is_some() {
        let is_filtered =
            options.neighbours.is_some() || options.weld.is_some() || options.ignore_rest.is_some();
        ensure!(
            !is_filtered,
            "--against: neighbours are those of one mesh: leave out --neighbours, --weld and --ignore-rest"
        );
    }
    let moves = frames(args).is_some()
        || motion.animation.is_some()
        || motion.against.as_deref().is_some_and(|other| against_frames(args, other).is_some());
    ensure!(
        moves || options.ignore_rest.is_none(),
        "--ignore-rest: the mesh is at rest: add --frames or --animation"
    );
    ensure!(
        moves || !args.continuous,
        "--continuous: a mesh at rest has no motion: add --frames, --animation or --trajectory"
    );
    Ok(())
}

fn request(args: &Check, meshes: Vec<PathBuf>) -> Result<Detection> {
    let (options, motion) = (&args.options, &args.motion);
    let animated = motion.animation.as_ref().map(|animation| AnimationMotion {
        animation: Some(animation.clone()),
        times: match &motion.times {
            Some(times) => Times::List(times.clone()),
            None => motion.fps.map_or_else(Times::default, Times::PerSecond),
        },
        node: motion.node.clone(),
        weights: match motion.weights {
            Some(Weights::AsStored) => SkinWeights::AsStored,
            _ => SkinWeights::Normalized,
        },
    });
    if let [first, _, ..] = &meshes[..]
        && let Some(file) = meshes.iter().find(|file| is_own_frames(file))
    {
        let other = if first == file { &meshes[1] } else { first };
        bail!("{}: a collection is checked by itself: leave out {}", file.display(), other.display());
    }
    let frames = frames(args).map(MeshMotion::Frames);
    let other = |mesh: &Path| OtherMesh {
        mesh: mesh.to_owned(),
        mesh_name: motion.against_mesh.clone(),
        frames: against_frames(args, mesh),
    };
    Ok(Detection {
        meshes,
        mesh_name: args.model.mesh_name.clone(),
        motion: frames.or(animated.map(MeshMotion::Animation)).unwrap_or(MeshMotion::Rest),
        against: motion.against.as_deref().map(other),
        neighbours: options.neighbours.unwrap_or_default(),
        weld: options.weld.map(|weld| weld == Switch::On),
        ignore_rest: options.ignore_rest,
        between_nodes: motion.between_nodes,
        groups: load::groups(&options.groups),
        is_continuous: args.continuous,
        limit: args.max_pairs(),
        clearance: args.clearance()?,
        penetration: args.penetration,
        contacts: shapes::contacts(args),
        has_positions: args.report.is_some() || args.pose.is_some() || args.frames_out.is_some(),
        threads: Some(load::threads(&options.threads)),
    })
}
