//! `sscc certify`: computes the certificates of a model, and writes them to a file.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use serde::Serialize;
use sscc::{Certificates, CertifyOptions, Query, ReducedModel};
use sscc_io::container::certificates_to_bytes;
use sscc_io::write_whole;
use sscc_view::Picture;

use crate::args::Certify;
use crate::interrupt::{self, Interrupt};
use crate::load;
use crate::outcome::Outcome;
use crate::output::{Output, counted, grouped, length, note};

/// Maximum number of triangles in a note.
const MAX_LISTED: usize = 8;

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
        load::check_output(path, ".png", &inputs)?;
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
        .map(|path| Picture::draw(&model, &certificates).with_context(|| path.display().to_string()));
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
    let zero_radius = ZeroRadius::find(&model, &certificates, &options)?;
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let metric = certificates.metric().kind().name();
        let promise = promise(&certificates, zero_radius.as_ref());
        for line in report.lines(metric, &promise, tree.limit(), &args.output) {
            out.line(line)?;
        }
        if let Some(path) = &args.picture {
            out.line(format_args!("picture        {}", path.display()))?;
        }
    }
    out.finish()?;
    let notes = [zero_radius.map(|reason| reason.note()), picture.and_then(|drawn| drawn.note)];
    notes.into_iter().flatten().for_each(note);
    Ok(Outcome::Done)
}

/// The reason for a root's radius of 0, found by queries at the centre and at rest.
enum ZeroRadius {
    /// More pairs collide at the centre than may be exceptions.
    Colliding {
        max_exceptions: usize,
        /// Whether `--ignore-rest` is absent, and would reduce the pairs to at most `max_exceptions`.
        can_ignore_rest: bool,
    },
    /// Only exceptions collide at the centre, but two of these triangles are too close for a bound above 0.
    TooClose { triangles: Vec<u32> },
}

impl ZeroRadius {
    /// Finds the reason; none if the root's radius is not 0. Costs up to two discrete queries.
    fn find(
        model: &ReducedModel,
        certificates: &Certificates,
        options: &CertifyOptions,
    ) -> Result<Option<Self>> {
        if certificates.root_radius() > 0.0 {
            return Ok(None);
        }
        let mut query = Query::new(model, certificates)?.cancelled_by(&Interrupt);
        let center = certificates.center();
        let mut others = query.discrete(center)?.to_vec();
        others.retain(|pair| certificates.exceptions().binary_search(pair).is_err());
        if others.is_empty() {
            return Ok(Some(Self::TooClose { triangles: smallest_zero_node(certificates) }));
        }
        let default = CertifyOptions::default_exceptions(model.mesh().faces().len());
        let max_exceptions = options.max_exceptions.unwrap_or(default);
        let at_rest = query.discrete(&vec![0.0; model.rank()])?;
        let left = others.iter().filter(|pair| at_rest.binary_search(pair).is_err()).count();
        let can_ignore_rest = !options.ignore_rest && left <= max_exceptions;
        Ok(Some(Self::Colliding { max_exceptions, can_ignore_rest }))
    }

    /// Returns a note with the remedy.
    fn note(&self) -> String {
        match self {
            Self::Colliding { max_exceptions, can_ignore_rest } => {
                let ignore = if *can_ignore_rest {
                    ", or ignore the pairs that collide at rest with --ignore-rest"
                } else {
                    ""
                };
                format!(
                    "more pairs collide at the centre than may be exceptions ({max_exceptions}): parts that contain \
                     one have radius 0; raise --max-exceptions{ignore}"
                )
            }
            Self::TooClose { triangles } => format!(
                "no other pair collides at the centre, but two of the triangles {} (counted from 0) are so close that no \
                 radius above 0 could be proven: parts that contain both have radius 0; move them apart, or choose \
                 another --center",
                listed(triangles)
            ),
        }
    }
}

/// Returns the triangles of the smallest node with radius 0. Nodes within a bucket are skipped, because they repeat the
/// bucket's radius.
fn smallest_zero_node(certificates: &Certificates) -> Vec<u32> {
    let hierarchy = certificates.hierarchy();
    let nodes = hierarchy.nodes();
    let mut is_own = vec![true; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        let has_own_children = is_own[n] && (n == 0 || !node.fits_in_bucket());
        node.children().for_each(|child| is_own[child as usize] = has_own_children);
    }
    let has_zero_radius = |n: &usize| is_own[*n] && certificates.node_radius(*n as u32) <= 0.0;
    let smallest = (0..nodes.len()).filter(has_zero_radius).min_by_key(|n| nodes[*n].triangle_count);
    let mut triangles = smallest.map(|n| hierarchy.triangles(&nodes[n]).to_vec()).unwrap_or_default();
    triangles.sort_unstable();
    triangles
}

/// Returns the numbers of triangles as text, at most [`MAX_LISTED`] of them.
fn listed(triangles: &[u32]) -> String {
    let shown: Vec<String> = triangles.iter().take(MAX_LISTED).map(u32::to_string).collect();
    let more = if triangles.len() > MAX_LISTED {
        format!(", ... ({} in all)", triangles.len())
    } else {
        String::new()
    };
    shown.join(", ") + &more
}

/// Returns the meaning of the root's radius as text.
fn promise(certificates: &Certificates, zero_radius: Option<&ZeroRadius>) -> String {
    let exceptions = !certificates.exceptions().is_empty();
    let filter = certificates.filter();
    let ignored = !filter.ignored().is_empty() || filter.groups().is_some();
    match (zero_radius, exceptions, ignored) {
        (Some(ZeroRadius::Colliding { .. }), ..) => {
            "the shape collides with itself at the centre; the parts that do not are certified".into()
        }
        (Some(ZeroRadius::TooClose { .. }), ..) => {
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
