//! Compares certificates without and with exceptions on a face whose lips and lids touch at rest:
//! `cargo bench -p sscc-bench --bench exceptions` (needs `ict_face` in `SSCC_MODELS`, else in `../shared/models`).
//!
//! For the 12 published configurations of the face and for the jaw alone, the bench prints the number of configurations
//! that the root certifies, apart from exceptions, and the nodes and node pairs that a query opens. All answers must be
//! equal.
#![allow(clippy::print_stdout)]

mod models;

use models::Result;
use sscc::{Certificates, CertifyOptions, Proof, Query};

fn main() -> Result<()> {
    let Some((model, cases)) = models::face()? else {
        println!("ict_face not found: set SSCC_MODELS to the folder of models");
        return Ok(());
    };
    let certify = |max_exceptions| {
        let options = CertifyOptions::default().max_exceptions(max_exceptions);
        Certificates::compute(&model, &options, &())
    };
    let (without, with) = (certify(0)?, certify(model.mesh().faces().len())?);
    let jaw = [0.0, 1e-6, 1e-3, 0.01, 0.1, 0.3, 1.0].map(|x| {
        let mut q = vec![0.0; model.rank()];
        q[0] = x;
        q
    });
    let nodes = with.parts().hierarchy.nodes().len();
    println!(
        "root radius: {:e} without, {:e} with {} exceptions; {nodes} nodes",
        without.root_radius(),
        with.root_radius(),
        with.exceptions().len()
    );
    println!(
        "| q | pairs | root certified, without | with | nodes open, without | with | opened, without | with |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut queries = [Query::new(&model, &without)?, Query::new(&model, &with)?];
    let mut certified = [0, 0];
    let all = cases.iter().enumerate().map(|(i, q)| (format!("case {i}"), q));
    for (name, q) in all.chain(jaw.iter().map(|q| (format!("jawOpen {}", q[0]), q))) {
        let mut row = [(Vec::new(), false, 0, 0), (Vec::new(), false, 0, 0)];
        for ((query, certificates), row) in queries.iter_mut().zip([&without, &with]).zip(&mut row) {
            row.0 = query.discrete(q)?.to_vec();
            let statistics = query.statistics();
            let open =
                certificates.parts().node_radii.iter().filter(|r| **r <= query.statistics().norm).count();
            (row.1, row.2, row.3) = (statistics.proof == Proof::Radius, open, statistics.opened);
        }
        assert!(row[0].0 == row[1].0, "{name}: the answers differ");
        if name.starts_with("case") {
            (0..2).for_each(|i| certified[i] += usize::from(row[i].1));
        }
        let [a, b] = row;
        println!("| {name} | {} | {} | {} | {} | {} | {} | {} |", a.0.len(), a.1, b.1, a.2, b.2, a.3, b.3);
    }
    let [without, with] = certified;
    println!("root certified among the {} cases: {without} without, {with} with exceptions", cases.len());
    assert!(!cases.is_empty(), "the file has no cases");
    Ok(())
}
