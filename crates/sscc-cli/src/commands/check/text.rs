//! The answers of `sscc check` as text.

use std::collections::BTreeSet;

use sscc_tasks::{FreeProof, LeftOut, free_sentence};

use super::answer::{Answer, InsideAnswer};
use super::data_set::FileError;
use crate::output::{counted, duration, grouped, length, one_line};

/// Maximum number of pairs in the text; `--json` lists more.
const MAX_LISTED: usize = 10;

impl Answer<'_> {
    /// Returns the number of pairs, marked as a lower bound if a limit stopped the query.
    fn counted(&self) -> String {
        let pairs = counted(self.count as u64, "pair");
        if self.complete { pairs } else { format!("at least {pairs}") }
    }

    /// Returns the earliest pair with its time. Without times: the first pair of the list, with the largest depth of
    /// all pairs.
    fn first(&self) -> Option<String> {
        let Some(times) = self.times else {
            let deepest = self.depths.iter().flatten().copied().reduce(f64::max);
            let deepest = deepest.map(|depth| format!(", deepest {}", length(depth))).unwrap_or_default();
            return self.pairs.first().map(|(i, j)| format!("{i} {j}{deepest}"));
        };
        let first = times.iter().zip(self.pairs).min_by(|a, b| a.0.total_cmp(b.0));
        first.map(|(time, (i, j))| format!("{i} {j} at t = {time:.4}"))
    }

    /// Returns the place of the query: file, node, number, time and norm. `noun` names a query.
    fn place(&self, noun: &str) -> String {
        let file = self.file.as_ref().map(|file| format!("{}  ", one_line(file))).unwrap_or_default();
        let node = named(self.node, self.names[0]).map(|node| format!("{node:<9} ")).unwrap_or_default();
        let against = named(self.against_node, self.names[1]);
        let against = against.map(|node| format!("against {node:<9} ")).unwrap_or_default();
        let time = self.time.map(|time| format!("  {time:.4} s")).unwrap_or_default();
        let norm = self.norm.map(|norm| format!("  |z| {:<10}", length(norm))).unwrap_or_default();
        let number = numbered(noun).map(|label| format!("{label} {:>5}", self.index)).unwrap_or_default();
        format!("{file}{node}{against}{number}{time}{norm}")
    }

    /// Returns the line of one of several queries. `noun` names a query.
    pub fn line(&self, noun: &str) -> String {
        let result = match self.first() {
            first if self.near.is_some() => self.near_result(first.is_some()),
            Some(first) => format!("COLLIDING  {}, first {first}", self.counted()),
            None if self.is_root_certified() => "free       by the root's certificate".to_owned(),
            None => "free".to_owned(),
        };
        let more = self.inside() + &self.penetration();
        format!("{} {:>9}  {result}{more}", self.place(noun), duration(self.microseconds))
    }

    /// Returns the volume that both meshes share, and their penetration depth.
    fn penetration(&self) -> String {
        let Some(found) = &self.penetration else { return String::new() };
        let (volume, depth) = (length(found.penetration_volume), length(found.penetration_depth));
        format!("; shared volume {volume}, penetration depth {depth}")
    }

    /// Returns the clause about parts of a mesh inside the other one; empty if there are none.
    fn inside(&self) -> String {
        let Some(InsideAnswer { inside, components }) = &self.inside else { return String::new() };
        let part = |n: usize, [own, other]: [&str; 2]| match (inside[n], components[n]) {
            (0, _) => None,
            (1, 1) => Some(format!("the {own} mesh is inside the {other} one")),
            (some, all) => {
                Some(format!("{some} of {all} parts of the {own} mesh are inside the {other} one"))
            }
        };
        let parts = [part(0, ["first", "second"]), part(1, ["second", "first"])];
        format!("; {}", parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }

    /// Returns the number of pairs nearer than the clearance, and the nearest pair.
    fn near_result(&self, is_near: bool) -> String {
        let word = if is_near { format!("NEAR       {}", self.counted()) } else { "clear".to_owned() };
        let nearest = self.near.as_ref().and_then(|near| near.nearest.zip(near.distance));
        let nearest = nearest.map(|((i, j), distance)| format!("nearest {i} {j} at {}", length(distance)));
        let nearest = nearest.unwrap_or_else(|| match &self.near {
            Some(near) if near.is_open => self.near_proof().to_owned(),
            _ => "no pair counts".to_owned(),
        });
        if is_near { format!("{word}, {nearest}") } else { format!("{word:<10} {nearest}") }
    }

    /// Returns the kind of proof that no pair is near, if the smallest distance is unknown.
    fn near_proof(&self) -> &'static str {
        if self.is_root_certified() { "by the root's certificate" } else { "by a search" }
    }

    /// Returns the time, the depth or the distance of a pair; empty if it has none.
    fn of_pair(&self, at: usize) -> String {
        if let Some(near) = &self.near {
            return format!("  distance {}", length(near.distances[at]));
        }
        match (self.times, &self.depths) {
            (Some(times), _) => format!("  at t = {:.4}", times[at]),
            (None, Some(depths)) => format!("  depth {}", length(depths[at])),
            (None, None) => String::new(),
        }
    }

    fn is_root_certified(&self) -> bool {
        self.root_certified == Some(true)
    }
}

/// Returns a node in words: its number, which selects it, and its name.
fn named(node: Option<usize>, name: Option<&str>) -> Option<String> {
    let name = name.map(|name| format!(" {}", one_line(name))).unwrap_or_default();
    node.map(|node| format!("node {node}{name}"))
}

/// Returns the word before the number of a query, which counts from 0. Files and comparisons of nodes have names
/// instead.
fn numbered(noun: &str) -> Option<&str> {
    match noun {
        "configuration" => Some("row"),
        "file" | "comparison" => None,
        other => Some(other),
    }
}

/// Returns the lines of the only query of a run.
pub fn single(answer: &Answer<'_>, root_radius: Option<f64>) -> Vec<String> {
    let root = root_radius.map(|r| format!(", root radius {}", length(r))).unwrap_or_default();
    let norm = answer.norm.map(|norm| format!(" (|z| = {}{root})", length(norm))).unwrap_or_default();
    let cost = format!(
        "{}: {} AABB tests, {} tested exactly",
        duration(answer.microseconds),
        grouped(answer.box_tests),
        counted(answer.triangle_tests, "triangle pair")
    );
    if let Some(near) = &answer.near {
        let clearance = length(near.clearance);
        let rings = (near.rings > 1).then(|| format!(", and within {} rings", near.rings));
        let apart = answer.left_out.apart() + &rings.unwrap_or_default();
        let nearest = near.nearest.zip(near.distance);
        let nearest = nearest.map(|((i, j), distance)| format!("; nearest: {i} {j} at {}", length(distance)));
        let nearest = nearest.unwrap_or_else(|| match near.is_open {
            true => format!(", {}", answer.near_proof()),
            false => "; no pair counts".to_owned(),
        });
        let inside = answer.inside();
        if !answer.is_finding() {
            return vec![
                format!("clear: no triangles are nearer than {clearance}{nearest}{apart}{inside}"),
                cost,
            ];
        }
        let pairs = answer.counted();
        let first = format!("NEAR: {pairs} of triangles nearer than {clearance}{nearest}{inside}");
        return listed_below(first, cost, answer);
    }
    if !answer.is_finding() {
        let (proof, cost) = match answer.is_root_certified() {
            true => (FreeProof::Root { exceptions: answer.exceptions }, duration(answer.microseconds)),
            false => (FreeProof::Tests, cost),
        };
        return vec![
            free_sentence(proof, &norm, answer.left_out) + &answer.inside() + &answer.penetration(),
            cost,
        ];
    }
    listed_below(
        format!("COLLIDING: {} of triangles{norm}{}", answer.counted(), answer.penetration()),
        cost,
        answer,
    )
}

/// Returns these two lines, and the lines of the first pairs.
fn listed_below(first: String, cost: String, answer: &Answer<'_>) -> Vec<String> {
    let mut lines = vec![first, cost];
    let listed = answer.pairs.iter().take(MAX_LISTED).enumerate();
    lines.extend(listed.map(|(at, (i, j))| format!("{i:>8} {j:>8}{}", answer.of_pair(at))));
    if answer.count > MAX_LISTED {
        lines.push(format!(
            "     ... and {} more; --json lists them",
            grouped((answer.count - MAX_LISTED) as u64)
        ));
    }
    lines
}

/// Returns the line of a file that could not be checked, beside those of the answers.
pub fn failure(failed: &FileError) -> String {
    format!("{}   {:>9}  ERROR      {}", one_line(&failed.file), "", failed.error)
}

/// Counts and times of all queries of a run, and the worst one.
pub struct Summary {
    /// The noun for a query: `step`, `configuration`, ...
    pub noun: &'static str,
    root_certified: Option<usize>,
    pub findings: usize,
    /// Whether the answers are about a clearance.
    is_near: bool,
    /// Files that could not be checked.
    pub failures: usize,
    /// Whether an answer does not have all of its pairs. Then there is no worst answer.
    is_limited: bool,
    worst: Option<Worst>,
    microseconds: Vec<f64>,
    /// The pairs that the answers leave out, added once for each mesh.
    left_out: LeftOut,
    /// The file and the node of each of these meshes.
    seen: BTreeSet<(Option<String>, Option<usize>)>,
}

/// The answer with the deepest pair, for a clearance with the nearest pair; among equal ones that with most pairs.
struct Worst {
    /// The largest depth (0 without depths; for a clearance the negative smallest distance), and the number of pairs.
    size: (f64, usize),
    text: String,
}

impl Summary {
    pub fn new(noun: &'static str) -> Self {
        Self {
            noun,
            root_certified: None,
            findings: 0,
            is_near: false,
            failures: 0,
            is_limited: false,
            worst: None,
            microseconds: Vec::new(),
            left_out: LeftOut::default(),
            seen: BTreeSet::new(),
        }
    }

    pub fn add(&mut self, answer: &Answer<'_>) {
        if let Some(is_certified) = answer.root_certified {
            *self.root_certified.get_or_insert(0) += usize::from(is_certified && !answer.is_finding());
        }
        // The frames of one mesh leave out the same pairs.
        if self.seen.insert((answer.file.clone(), answer.node)) {
            self.left_out = std::mem::take(&mut self.left_out).and(answer.left_out);
        }
        self.findings += usize::from(answer.is_finding());
        self.is_near |= answer.near.is_some();
        self.is_limited |= !answer.complete;
        self.microseconds.push(answer.microseconds);
        let deepest = answer.depths.iter().flatten().copied().fold(0.0, f64::max);
        let nearest = answer.near.as_ref().and_then(|near| near.distance);
        let size = (nearest.map_or(deepest, |distance| -distance), answer.count);
        if answer.is_finding() && self.worst.as_ref().is_none_or(|worst| worst.size < size) {
            self.worst = Some(Worst { size, text: self.describe(answer, size.0) });
        }
    }

    /// Returns an answer's place, its number of pairs, and the largest depth or the smallest distance. `depth` is as in
    /// [`Worst::size`].
    fn describe(&self, answer: &Answer<'_>, depth: f64) -> String {
        let number = numbered(self.noun).map(|label| format!("{label} {}", answer.index));
        let node = named(answer.node, answer.names[0]);
        let query: Vec<String> = number.into_iter().chain(node).collect();
        let against = named(answer.against_node, answer.names[1]);
        let against = against.map(|node| format!("against {node}"));
        let nodes: Vec<String> = [query.join(" of ")].into_iter().chain(against).collect();
        let file = answer.file.iter().map(|file| one_line(file));
        let place = file.chain([nodes.join(" ").trim().to_owned()]);
        let place: Vec<String> = place.filter(|part| !part.is_empty()).collect();
        let depth = match (&answer.depths, &answer.near) {
            (Some(_), _) => Some(format!(", deepest {}", length(depth))),
            (None, Some(_)) => Some(format!(", nearest {}", length(-depth))),
            (None, None) => None,
        };
        format!("{} ({}{})", place.join(", "), answer.counted(), depth.unwrap_or_default())
    }

    pub fn line(&mut self) -> String {
        let all = self.microseconds.len();
        self.microseconds.sort_by(f64::total_cmp);
        let is_free = self.findings < all && self.left_out != LeftOut::default();
        let apart = if is_free {
            format!("; {}{}", if self.is_near { "clear" } else { "free" }, self.left_out.apart())
        } else {
            String::new()
        };
        let certified = self.root_certified.map(|n| format!(" ({n} by the root's certificate alone)"));
        let worst = self.worst.as_ref().filter(|_| !self.is_limited);
        let worst = worst.map(|worst| format!("; worst: {}", worst.text));
        let failures = match self.failures {
            0 => String::new(),
            n => format!(", {} not checked", counted(n as u64, "file")),
        };
        let median = self.microseconds.get(all / 2).map(|median| format!("; median {}", duration(*median)));
        let counts = numbered(self.noun).map(|label| format!("; {label}s are counted from 0"));
        format!(
            "{}: {} {}{}, {} {}{}{}{}{}{}",
            counted(all as u64, self.noun),
            all - self.findings,
            if self.is_near { "clear" } else { "free" },
            certified.unwrap_or_default(),
            self.findings,
            if self.is_near { "near" } else { "colliding" },
            failures,
            median.unwrap_or_default(),
            worst.unwrap_or_default(),
            counts.unwrap_or_default(),
            apart
        )
    }
}
