//! The traditional and the BD-tree query beside parry3d: `cargo bench -p sscc-cli --bench peer`.
//!
//! parry moves the vertices, refits its tree as its own `TriMesh` does (each leaf, then `refit_without_opt`, by its
//! documentation the faster one), traverses it against itself, leaves out triangles that share a vertex, and asks our exact test
//! about the rest. Of its two ways to build a tree the better one counts. All run by turns in one process on one
//! thread and must give the same pairs; the times are processor times, the fastest ones, the ratios medians of the rounds. Moving the vertices is in every time, and
//! in a column of its own. Real models are taken from `SSCC_MODELS`, else from `../shared/models`.
#![allow(clippy::print_stdout)]

mod models;

use std::hint::black_box;

use anyhow::{Result, ensure};
use cpu_time::ThreadTime;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use sscc::{Method, Pair, Query, ReducedModel, Scope, intersect_triangle_triangle};

const ROUNDS: usize = 41;

/// Largest vertex displacements, as shares of half the diagonal of the box.
const SHARES: [f64; 4] = [0.0, 0.02, 0.1, 0.3];

fn main() -> Result<()> {
    println!(
        "| model | displaced | pairs | moving, ms | parry, ms | traditional, ms | / parry | BD-tree / parry |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let only = std::env::args().nth(1).filter(|name| !name.starts_with('-'));
    for case in models::polynomial()? {
        if only.as_ref().is_none_or(|name| name == case.name) {
            measure(case.name, &case.model)?;
        }
    }
    Ok(())
}

fn measure(name: &str, model: &ReducedModel) -> Result<()> {
    let query = |method| Query::without_certificates(model, Scope::of(model), method);
    let (mut traditional, mut bd_tree) = (query(Method::Traditional)?, query(Method::BdTree)?);
    let mut peers = [BvhBuildStrategy::Binned, BvhBuildStrategy::Ploc].map(|how| Peer::new(model, how));
    for q in cases(model) {
        let expected = traditional.discrete(&q)?.to_vec();
        let mut times: [Vec<f64>; 5] = Default::default();
        for _ in 0..ROUNDS {
            let mut timed = |at: usize, work: &mut dyn FnMut() -> Result<usize>| -> Result<()> {
                let start = ThreadTime::now();
                let found = work()?;
                times[at].push(start.elapsed().as_secs_f64() * 1e3);
                ensure!(at == 0 || found == expected.len(), "{name}: {found} pairs, not {}", expected.len());
                Ok(())
            };
            timed(0, &mut || {
                peers[0].deform(model, &q)?;
                Ok(black_box(&peers[0].positions).len())
            })?;
            timed(1, &mut || Ok(traditional.discrete(&q)?.len()))?;
            timed(2, &mut || peers[0].query(model, &q))?;
            timed(3, &mut || Ok(bd_tree.discrete(&q)?.len()))?;
            timed(4, &mut || peers[1].query(model, &q))?;
        }
        let same = peers.iter().all(|peer| peer.pairs == expected) && bd_tree.pairs() == expected;
        ensure!(same && traditional.pairs() == expected, "{name}: the answers differ");
        // The better of parry's two trees.
        let parry = if median(times[2].clone()) <= median(times[4].clone()) { 2 } else { 4 };
        let ratio = |at: usize| median(times[at].iter().zip(&times[parry]).map(|(a, b)| a / b).collect());
        let displaced = largest_displacement(model, &q) / half_diagonal(model);
        let (moving, peer) = (fastest(&times[0]), fastest(&times[parry]));
        println!(
            "| {name} | {:.0}% | {} | {moving:.3} | {peer:.2} | {:.2} | {:.2} | {:.2} |",
            displaced * 100.0,
            expected.len(),
            fastest(&times[1]),
            ratio(1),
            ratio(3)
        );
    }
    Ok(())
}

/// Rest, and a fixed random direction (`z_i = N(0,1) / i`) at each of the shares.
fn cases(model: &ReducedModel) -> Vec<Vec<f64>> {
    let mut random = models::Random(7);
    let z: Vec<f64> = (0..model.rank()).map(|k| random.normal() / (1.0 + k as f64)).collect();
    let way = model.metric().unscaled(&z);
    let unit = half_diagonal(model) / largest_displacement(model, &way);
    SHARES.map(|share| way.iter().map(|x| x * unit * share).collect()).to_vec()
}

fn half_diagonal(model: &ReducedModel) -> f64 {
    let p = model.mesh().rest_positions();
    let (lower, upper) = p.iter().fold((p[0], p[0]), |(lower, upper), p| (lower.min(*p), upper.max(*p)));
    (upper - lower).length() / 2.0
}

fn largest_displacement(model: &ReducedModel, q: &[f64]) -> f64 {
    let rest = model.mesh().rest_positions();
    let moved = |v: usize| (model.position(v as u32, q) - rest[v]).length();
    (0..rest.len()).map(moved).fold(0.0, f64::max)
}

fn fastest(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// parry's tree over the triangles of a model.
struct Peer {
    tree: Bvh,
    workspace: BvhWorkspace,
    positions: Vec<DVec3>,
    pairs: Vec<Pair>,
}

impl Peer {
    fn new(model: &ReducedModel, how: BvhBuildStrategy) -> Self {
        let positions = model.mesh().rest_positions().to_vec();
        let leaves: Vec<Aabb> = model.mesh().faces().iter().map(|face| leaf(face, &positions)).collect();
        let mut this = Self {
            tree: Bvh::from_leaves(how, &leaves),
            workspace: BvhWorkspace::default(),
            positions,
            pairs: Vec::new(),
        };
        // Once, for the order in memory.
        this.tree.refit(&mut this.workspace);
        this
    }

    fn deform(&mut self, model: &ReducedModel, q: &[f64]) -> Result<()> {
        model.check_coordinates(q)?;
        for (v, x) in self.positions.iter_mut().enumerate() {
            *x = model.position(v as u32, q);
        }
        Ok(())
    }

    fn query(&mut self, model: &ReducedModel, q: &[f64]) -> Result<usize> {
        self.deform(model, q)?;
        let (faces, positions) = (model.mesh().faces(), &self.positions);
        for (i, face) in faces.iter().enumerate() {
            let _ = self.tree.insert_or_update_partially(leaf(face, positions), i as u32, 0.0);
        }
        self.tree.refit_without_opt();
        self.pairs.clear();
        let pairs = &mut self.pairs;
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |i, j| {
            let (a, b) = (faces[i as usize], faces[j as usize]);
            if a.iter().any(|v| b.contains(v)) {
                return;
            }
            let [x, y] = [a, b].map(|face| face.map(|v| positions[v as usize]));
            if intersect_triangle_triangle(&x, &y) {
                pairs.push((i.min(j), i.max(j)));
            }
        });
        self.pairs.sort_unstable();
        Ok(self.pairs.len())
    }
}

fn leaf(face: &[u32; 3], positions: &[DVec3]) -> Aabb {
    let [a, b, c] = face.map(|v| positions[v as usize]);
    let vector = |x: DVec3| Vector::from_array(x.to_array());
    Aabb::new(vector(a.min(b).min(c)), vector(a.max(b).max(c)))
}
