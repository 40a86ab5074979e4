//! `sscc certify`: the certificates of a model, computed once.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use serde::Serialize;
use sscc::{Certificates, CertifyOptions};
use sscc_io::container::certificates_to_bytes;
use sscc_io::write_whole;

use crate::args::Certify;
use crate::output::{Output, counted, grouped, length};
use crate::{Outcome, interrupt, load, picture};

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
}

pub fn run(args: &Certify) -> anyhow::Result<Outcome> {
    let inputs: Vec<&Path> =
        [Some(args.model.path.as_path()), args.model.modes.as_deref(), args.options.metric.as_deref()]
            .into_iter()
            .flatten()
            .collect();
    load::check_output(&args.output, ".sscc.safetensors", &inputs)?;
    if let Some(path) = &args.picture {
        picture::check(path, &inputs)?;
    }
    let model = load::model(&args.model)?.model;
    let options = load::options(&model, &args.model, &args.options)?;
    let start = Instant::now();
    let certificates = load::certify(&model, &args.model.path, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let bytes = certificates_to_bytes(&certificates).context("certificates")?;
    let picture = args
        .picture
        .as_ref()
        .map(|path| picture::draw(&model, &certificates).with_context(|| path.display().to_string()));
    let picture = picture.transpose()?;
    interrupt::check()?;
    if let (Some(path), Some(picture)) = (&args.picture, &picture) {
        write_whole(path, &picture.png)?;
    }
    write_whole(&args.output, &bytes)?;

    let tree = &certificates.parts().pair_tree;
    let report = Report {
        triangles: model.mesh().faces().len(),
        vertices: model.mesh().rest_positions().len(),
        rank: model.rank(),
        nodes: certificates.hierarchy().nodes().len(),
        pairs: certificates.parts().root_pair_radii.len() + tree.len(),
        seconds,
        threads: load::threads(&args.options.threads),
        root_radius: certificates.root_radius(),
        global_radius: certificates.global_radius(),
        bytes: bytes.len(),
        rest_collisions: certificates.rest_collisions(),
        exceptions: certificates.exceptions().len(),
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let metric = certificates.metric().kind().name();
        for line in report.lines(metric, tree.limit(), &args.output) {
            out.line(line)?;
        }
        if let Some(path) = &args.picture {
            out.line(format_args!("picture        {}", path.display()))?;
        }
    }
    out.finish()?;
    let notes = [note(&certificates, args.options.max_exceptions), picture.and_then(|drawn| drawn.note)];
    for note in notes.into_iter().flatten() {
        eprintln!("note: {note}");
    }
    Ok(Outcome::Done)
}

/// What to do about radii that promise nothing.
fn note(certificates: &Certificates, most: Option<usize>) -> Option<String> {
    let unresolved = certificates.root_radius() <= 0.0 && certificates.exceptions().is_empty();
    let most = most.unwrap_or(CertifyOptions::default_exceptions(certificates.hierarchy().order().len()));
    unresolved.then(|| {
        format!(
            "more pairs collide at the centre than may be exceptions ({most}): radii of parts that contain one are 0; \
             raise --max-exceptions, or leave out for good what collides at rest with --ignore-rest"
        )
    })
}

/// Up to where pairs are resolved, if they are.
fn pairs_up_to(limit: f64) -> String {
    if limit > 0.0 { format!(", pairs up to {}", length(limit)) } else { String::new() }
}

impl Report {
    fn lines(&self, metric: &str, pair_limit: f64, output: &Path) -> Vec<String> {
        let promise = match (self.root_radius > 0.0, self.exceptions) {
            (true, 0) => "below it the whole shape is free",
            (true, _) => "below it the whole shape is free, exceptions apart",
            (false, _) => "the shape collides with itself at the centre; the parts that do not are certified",
        };
        let promise = format!("root radius    {}: {promise}", length(self.root_radius));
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
                "certificates   {} nodes, {} pairs",
                grouped(self.nodes as u64),
                grouped(self.pairs as u64)
            ),
            format!("time           {:.2} s on {}", self.seconds, counted(self.threads as u64, "thread")),
            format!("metric         {metric}"),
            format!("at rest        {} collide", counted(self.rest_collisions, "pair")),
            format!("exceptions     {exceptions}"),
            promise,
            format!("resolved up to {}{}", length(self.global_radius), pairs_up_to(pair_limit)),
            format!("written        {} ({} bytes)", output.display(), grouped(self.bytes as u64)),
        ]
    }
}
