//! `sscc certify`: computes the certificates of a model, and writes them to a file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail};
use serde::Serialize;
use sscc::parts::Prover;
use sscc::{Certificates, Clearance, ReducedModel};
use sscc_io::container::certificates_to_bytes;
use sscc_io::{ProofFile, write_whole};
use sscc_tasks::{CertificateRequest, ZeroRadius};
use sscc_view::Picture;

use super::zero_radius;
use crate::args::Certify;
use crate::interrupt;
use crate::load;
use crate::outcome::Outcome;
use crate::output::{Output, counted, grouped, length, note};
use crate::progress::Bar;

/// The seed of samples of entries.
const PROOF_SEED: u64 = 1;

#[derive(Serialize)]
struct Report {
    triangles: usize,
    vertices: usize,
    rank: usize,
    nodes: usize,
    pairs: usize,
    seconds: f64,
    threads: usize,
    root_radius: f64,
    global_radius: f64,
    bytes: usize,
    rest_collisions: u64,
    exceptions: usize,
    /// The clearance; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<f64>,
    /// The number of rings within which pairs do not count; absent without a clearance.
    #[serde(skip_serializing_if = "Option::is_none")]
    rings: Option<u32>,
    /// Absent without `--proof`.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    proof: Option<ProofReport>,
}

#[derive(Serialize)]
struct ProofReport {
    proof_entries: usize,
    proven_entries: usize,
    proof_bytes: u64,
    proof_seconds: f64,
}

pub fn run(args: &Certify) -> anyhow::Result<Outcome> {
    let inputs: Vec<&Path> =
        [Some(args.model.path.as_path()), args.model.modes.as_deref(), args.options.metric.as_deref()]
            .into_iter()
            .flatten()
            .collect();
    load::check_output(&args.output, ".sscc.safetensors", &inputs)?;
    if let Some(path) = &args.picture {
        load::check_output(path, ".png", &inputs)?;
    }
    if let Some(path) = &args.proof {
        load::check_output(path, ".proof", &inputs)?;
    }
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let clearance = args.clearance.of()?;
    if let (Some(_), Some(path)) = (clearance, &args.picture) {
        bail!("{}: --picture draws shapes that are free: leave it out with --clearance", path.display());
    }
    let request = CertificateRequest { clearance, ..load::request(&loaded, &args.model, &args.options)? };
    let options = request.options(model)?;
    let start = Instant::now();
    let certificates = load::certify(model, &args.model.path, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let bytes = certificates_to_bytes(&certificates).context("certificates")?;
    let draw = |path: &PathBuf| {
        let drawn = Picture::draw_until(model, &certificates, &loaded.mode_names, interrupt::token());
        interrupt::check()?;
        drawn.with_context(|| path.display().to_string())
    };
    // Work that may be interrupted comes before the first file is written.
    let zero_radius = ZeroRadius::find(model, &certificates, &request, interrupt::token())?;
    let picture = args.picture.as_ref().map(draw).transpose()?;
    let proof = args.proof.as_ref().map(|path| write_proof(args, path, model, &certificates)).transpose()?;
    interrupt::check()?;
    if let (Some(path), Some(picture)) = (&args.picture, &picture) {
        write_whole(path, &picture.png)?;
    }
    write_whole(&args.output, &bytes)?;
    // The proof is written last, because it is useless without its certificates.
    let proof = proof
        .map(|(file, report)| file.finish().map(|proof_bytes| ProofReport { proof_bytes, ..report }))
        .transpose()?;

    let tree = &certificates.parts().pair_tree;
    let report = Report {
        triangles: model.mesh().faces().len(),
        vertices: model.mesh().rest_positions().len(),
        rank: model.rank(),
        nodes: certificates.parts().hierarchy.nodes().len(),
        pairs: certificates.parts().root_pair_radii.len() + tree.len(),
        seconds,
        threads: load::threads(&args.options.threads),
        root_radius: certificates.root_radius(),
        global_radius: certificates.global_radius(),
        bytes: bytes.len(),
        rest_collisions: certificates.rest_collisions(),
        exceptions: certificates.exceptions().len(),
        clearance: clearance.map(|clearance| clearance.distance()),
        rings: clearance.map(|clearance| clearance.rings()),
        proof,
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let metric: &str = certificates.metric().kind().into();
        let promise = promise(&certificates, zero_radius.as_ref());
        for line in report.lines(metric, &promise, tree.limit(), &args.output) {
            out.line(line)?;
        }
        if let (Some(path), Some(proof)) = (&args.proof, &report.proof) {
            out.line(proof.line(path))?;
        }
        if let Some(path) = &args.picture {
            out.line(format_args!("picture        {}", path.display()))?;
        }
    }
    out.finish()?;
    let notes = [zero_radius.map(|reason| zero_radius::note(&reason)), picture.and_then(|drawn| drawn.note)];
    notes.into_iter().flatten().for_each(note);
    Ok(Outcome::Done)
}

/// Writes the proof of the certificates, or of a sample of their entries, to a file beside its target. The returned
/// report has 0 bytes: their number is known when that file replaces the target.
fn write_proof(
    args: &Certify,
    path: &Path,
    model: &ReducedModel,
    certificates: &Certificates,
) -> anyhow::Result<(ProofFile, ProofReport)> {
    let start = Instant::now();
    let prover = Prover::new(model, certificates).with_context(|| path.display().to_string())?;
    let numbers = prover.sample(args.proof_sample.map_or(usize::MAX, |count| count as usize), PROOF_SEED);
    let threads = Some(load::threads(&args.options.threads));
    let written = sscc_io::write_proof(path, &prover, &numbers, threads, &Bar::new("proving"));
    interrupt::check()?;
    let file = written?;
    let report = ProofReport {
        proof_entries: prover.entries(),
        proven_entries: numbers.len(),
        proof_bytes: 0,
        proof_seconds: start.elapsed().as_secs_f64(),
    };
    Ok((file, report))
}

impl ProofReport {
    fn line(&self, path: &Path) -> String {
        let [all, proven] = [self.proof_entries, self.proven_entries].map(|count| grouped(count as u64));
        let entries =
            if all == proven { format!("all {all} entries") } else { format!("{proven} of {all} entries") };
        let (bytes, seconds) = (grouped(self.proof_bytes), self.proof_seconds);
        format!("proof          {}: {entries} ({bytes} bytes, {seconds:.2} s)", path.display())
    }
}

/// Returns the meaning of the root's radius as text.
fn promise(certificates: &Certificates, zero_radius: Option<&ZeroRadius>) -> String {
    if let Some(clearance) = certificates.clearance() {
        return near_promise(certificates, &clearance, zero_radius);
    }
    let exceptions = !certificates.exceptions().is_empty();
    let filter = certificates.filter();
    let ignored = !filter.ignored().is_empty() || filter.groups().is_some();
    match (zero_radius, exceptions, ignored) {
        (Some(ZeroRadius::Colliding { .. }), ..) => {
            "the shape collides with itself at the centre; the parts that do not are certified".into()
        }
        (Some(ZeroRadius::Near { .. } | ZeroRadius::TooClose { .. }), ..) => {
            "two triangles nearly touch at the centre; the parts without both are certified".into()
        }
        (None, false, false) => "below it the whole shape is free".into(),
        (None, true, false) => "below it the whole shape is free, apart from exceptions".into(),
        (None, false, true) => "below it the whole shape is free, apart from ignored pairs".into(),
        (None, true, true) => {
            "below it the whole shape is free, apart from exceptions and ignored pairs".into()
        }
    }
}

/// Returns the meaning of the root's radius with a clearance as text.
fn near_promise(
    certificates: &Certificates,
    clearance: &Clearance,
    zero_radius: Option<&ZeroRadius>,
) -> String {
    let distance = length(clearance.distance());
    match zero_radius {
        None => {}
        Some(ZeroRadius::TooClose { .. }) => {
            return format!(
                "two triangles are so little farther apart than {distance} at the centre that no radius above 0 is proven; the \
                 parts without both are certified"
            );
        }
        Some(ZeroRadius::Near { .. } | ZeroRadius::Colliding { .. }) => {
            return format!(
                "triangles are nearer than {distance} at the centre; the parts without them are certified"
            );
        }
    }
    let exceptions = if certificates.exceptions().is_empty() { "" } else { ", apart from exceptions" };
    let rings = counted(u64::from(clearance.rings().max(1)), "ring");
    format!("below it no triangles more than {rings} apart are nearer than {distance}{exceptions}")
}

/// Returns the limit of the pair tree as text; empty without a pair tree.
fn pair_tree_limit(limit: f64) -> String {
    if limit > 0.0 { format!(", pair tree up to {}", length(limit)) } else { String::new() }
}

impl Report {
    fn lines(&self, metric: &str, promise: &str, pair_limit: f64, output: &Path) -> Vec<String> {
        let exceptions = match self.exceptions {
            0 => "none".to_owned(),
            n => format!("{}, tested in every query", counted(n as u64, "pair")),
        };
        vec![
            format!(
                "model          {} triangles, {} vertices, {} modes",
                grouped(self.triangles as u64),
                grouped(self.vertices as u64),
                self.rank
            ),
            format!(
                "certificates   {} nodes, {} node pairs",
                grouped(self.nodes as u64),
                grouped(self.pairs as u64)
            ),
            format!("time           {:.2} s on {}", self.seconds, counted(self.threads as u64, "thread")),
            format!("metric         {metric}"),
            format!("at rest        {} collide", counted(self.rest_collisions, "pair")),
            format!("exceptions     {exceptions}"),
            format!("root radius    {}: {promise}", length(self.root_radius)),
            format!("global radius  {}{}", length(self.global_radius), pair_tree_limit(pair_limit)),
            format!("written        {} ({} bytes)", output.display(), grouped(self.bytes as u64)),
        ]
    }
}
