//! The methods that are compared: a line for each.

use anyhow::{Context, Result};
use parry3d_f64::partitioning::BvhBuildStrategy;
use sscc::{Error, Impact, Method, Pair, Query};

use super::peer::Peer;
use sscc_sim::CertifiedModel;

/// One column of the tables. Where several have the same key, the one with the smallest mean counts.
pub struct Column {
    /// Its name in tables and JSON.
    pub key: &'static str,
    pub role: Role,
    make: for<'a> fn(&'a CertifiedModel) -> Result<Box<dyn Engine + 'a>>,
}

/// Where a method takes part.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Ours: runs on all steps.
    Certified,
    /// What it is compared to: on some of the steps, where these are many.
    Comparator,
    /// The same, but its pairs may be too few.
    Approximate,
}

use Role::{Approximate, Certified, Comparator};

/// All of them, in the order in which they take turns.
pub const COLUMNS: &[Column] = &[
    Column { key: "traditional", role: Comparator, make: |case| plain(case, Method::Traditional) },
    Column { key: "bdtree", role: Comparator, make: |case| plain(case, Method::BdTree) },
    Column { key: "normal_cones", role: Comparator, make: |case| plain(case, Method::NormalCones) },
    Column {
        key: "normal_cones_approx",
        role: Approximate,
        make: |case| plain(case, Method::NormalConesApprox),
    },
    Column { key: "paper", role: Certified, make: paper },
    Column { key: "full", role: Certified, make: full },
    Column { key: "parry", role: Comparator, make: |case| peer(case, BvhBuildStrategy::Binned) },
    Column { key: "parry", role: Comparator, make: |case| peer(case, BvhBuildStrategy::Ploc) },
];

impl Column {
    pub fn engine<'a>(&self, case: &'a CertifiedModel) -> Result<Box<dyn Engine + 'a>> {
        (self.make)(case)
    }
}

fn plain(case: &CertifiedModel, method: Method) -> Result<Box<dyn Engine + '_>> {
    Ok(Box::new(Query::with_method(&case.model, &case.full.certificates, method)?))
}

fn paper(case: &CertifiedModel) -> Result<Box<dyn Engine + '_>> {
    let paper = case.paper.as_ref().context("certificates as in the paper were not computed")?;
    Ok(Box::new(Query::new(&case.model, &paper.certificates)?))
}

fn full(case: &CertifiedModel) -> Result<Box<dyn Engine + '_>> {
    Ok(Box::new(Query::new(&case.model, &case.full.certificates)?))
}

fn peer(case: &CertifiedModel, how: BvhBuildStrategy) -> Result<Box<dyn Engine + '_>> {
    Ok(Box::new(Peer::new(&case.model, how)))
}

/// A method at work: everything that it needs for an answer is done within the call.
pub trait Engine {
    /// The pairs that collide at q, sorted.
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error>;
    /// The pairs that meet on the way, sorted.
    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error>;
}

impl Engine for Query<'_> {
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete(q)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.continuous(q_t0, q_t1)
    }
}

impl Engine for Peer<'_> {
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete(q)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.continuous(q_t0, q_t1)
    }
}
