//! Time of queries in WebAssembly against native ones on one thread, interleaved, on the spring of the demo: `cargo xtask wasm`, `sscc demo
//! --out DIR`, then `cargo bench -p sscc-wasm -- DIR PACKAGE [REPETITIONS]` (absolute paths). Prints the record `docs/records/webassembly.csv`.
//!
//! In each repetition every frame is queried natively and in Node (`tests/time.mjs`); the sides alternate in being first. A time is the
//! mean over the frames of a kind of the median over the repetitions. Certificates are computed twice, and measured in processor time.
#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::error::Error;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use cpu_time::ProcessTime;
use sscc::{Certificates, CertifyOptions, Proof, Query, ReducedModel};
use sscc_io::{read_certificates, read_model, read_rows};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Nanoseconds by kind of query: for each frame of a kind, or for certificates.
type Times = BTreeMap<String, Vec<f64>>;

/// Queries in one measurement of a frame that the root's radius answers.
const REPETITIONS: usize = 1000;

/// Warm-up repetitions, which are not counted, in which engines compile.
const WARM_UP: usize = 5;

/// Rows of the record: name, and the kinds of query that are measured natively and in Node.
const ROWS: [(&str, &str, &str); 6] = [
    ("free by the root's radius, one of a batch", "radius", "radius, batch"),
    ("free by the root's radius, `isColliding`", "radius", "radius, isColliding"),
    ("free by the root's radius, `discrete`", "radius", "radius"),
    ("free, root's radius reached", "free", "free"),
    ("colliding", "colliding", "colliding"),
    ("certificates, once", "certificates", "certificates"),
];

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let [folder, package, rest @ ..] = &arguments[..] else {
        println!("no folders of the demo and of the package: cargo bench -p sscc-wasm -- DIR PACKAGE");
        return Ok(());
    };
    let rounds = rest.first().map_or(Ok(41), |number| number.parse::<usize>())?;
    let (mut native, mut node) = (Native::read(Path::new(folder))?, Node::start(folder, package)?);
    let mut sides: [Vec<Times>; 2] = Default::default();
    for round in 0..rounds + WARM_UP {
        for side in [round % 2, 1 - round % 2] {
            let times = if side == 0 { native.frames()? } else { node.ask("frames")? };
            if round >= WARM_UP {
                sides[side].push(times);
            }
        }
    }
    let mut certificates = [Vec::new(), Vec::new()];
    for _ in 0..2 {
        certificates[0].push(native.certify()?);
        certificates[1].push(node.ask("certificates")?);
    }
    println!("queries of the spring,native,WebAssembly,ratio");
    for (name, own, other) in ROWS {
        let [own, other] = match own {
            "certificates" => [0, 1].map(|side| typical(&certificates[side], own)),
            _ => [typical(&sides[0], own), typical(&sides[1], other)],
        };
        println!("\"{name}\",{},{},{:.2}", shown(own), shown(other), other / own);
    }
    Ok(())
}

/// Formats a time with its unit.
fn shown(nanoseconds: f64) -> String {
    let units = [("s", 1e9), ("ms", 1e6), ("us", 1e3)];
    let (unit, size) = units.into_iter().find(|(_, size)| nanoseconds >= *size).unwrap_or(("ns", 1.0));
    format!("{:.1} {unit}", nanoseconds / size)
}

/// Returns the mean over the frames of the lower median over the repetitions.
fn typical(rounds: &[Times], name: &str) -> f64 {
    let frames = rounds[0][name].len();
    let median = |frame: usize| {
        let mut times: Vec<f64> = rounds.iter().map(|round| round[name][frame]).collect();
        times.sort_by(f64::total_cmp);
        times[(times.len() - 1) / 2]
    };
    (0..frames).map(median).sum::<f64>() / frames as f64
}

/// The native side.
struct Native {
    model: ReducedModel,
    query: Query,
    frames: Vec<Vec<f64>>,
}

impl Native {
    fn read(folder: &Path) -> Outcome<Self> {
        let (model, _) = read_model(&folder.join("spring.model.safetensors"))?;
        let certificates = read_certificates(&folder.join("spring.sscc.safetensors"))?;
        let frames = read_rows(&folder.join("spring.npy"))?.iter().map(<[f64]>::to_vec).collect();
        Ok(Self { query: Query::new(&model, &certificates)?, model, frames })
    }

    /// Queries the frames in their order, as in an animation.
    fn frames(&mut self) -> Outcome<Times> {
        let mut times = Times::new();
        for q in &self.frames {
            let mut time = self.query.time(q, 1)?;
            let kind = match (self.query.statistics().proof, self.query.pairs()) {
                (Proof::Radius, _) => "radius",
                (_, []) => "free",
                _ => "colliding",
            };
            if kind == "radius" {
                time = self.query.time(q, REPETITIONS)?;
            }
            times.entry(kind.to_owned()).or_default().push(time);
        }
        Ok(times)
    }

    /// Computes certificates on one thread.
    fn certify(&self) -> Outcome<Times> {
        let start = ProcessTime::now();
        Certificates::compute(&self.model, &CertifyOptions::default().threads(1), &())?;
        let time = start.elapsed().as_nanos() as f64;
        Ok(Times::from([("certificates".to_owned(), vec![time])]))
    }
}

/// A query whose answers are timed, in nanoseconds.
trait Timed {
    fn time(&mut self, q: &[f64], repetitions: usize) -> Outcome<f64>;
}

impl Timed for Query {
    fn time(&mut self, q: &[f64], repetitions: usize) -> Outcome<f64> {
        let start = Instant::now();
        for _ in 0..repetitions {
            black_box(self.discrete(black_box(q))?);
        }
        Ok(start.elapsed().as_nanos() as f64 / repetitions as f64)
    }
}

/// The process of Node.
struct Node {
    _child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Node {
    fn start(folder: &str, package: &str) -> Outcome<Self> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/time.mjs");
        let mut node = Command::new("node");
        node.arg(script).args([package, folder, &REPETITIONS.to_string()]);
        let mut child = node.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let questions = child.stdin.take().ok_or("no input of node")?;
        let answers = BufReader::new(child.stdout.take().ok_or("no output of node")?);
        Ok(Self { _child: child, questions, answers })
    }

    /// Writes a line with a question, and reads the line of its answer.
    fn ask(&mut self, question: &str) -> Outcome<Times> {
        writeln!(self.questions, "{question}")?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        Ok(serde_json::from_str(&line)?)
    }
}
