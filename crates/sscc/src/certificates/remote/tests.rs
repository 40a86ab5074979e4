//! Tests sharded certificates against those of one process.

use sscc_testing::cases;

use super::job::{Job, JobWriter};
use super::job_result::{JobResult, ResultLayout};
use super::seal::HASH;
use super::*;
use crate::certificates::build::{SplitTask, Task};
use crate::certificates::test_models::ring;
use crate::hierarchy::Hierarchy;
use crate::{
    CancelToken, Certificates, CertifyOptions, ContactFilter, Error, Metric, MetricKind, ReducedModel,
};

fn sharded(model: &ReducedModel, options: &CertifyOptions, shards: usize) -> Result<Certificates, Error> {
    let worker = ShardWorker::new(model, options, &()).unwrap();
    let mut run = |jobs: Vec<Vec<u8>>| jobs.iter().map(|job| worker.run(job, &())).collect();
    compute_in_shards(model, options, shards, &mut run, &())
}

/// Returns all jobs of a model, and their results.
fn jobs(model: &ReducedModel, options: &CertifyOptions, shards: usize) -> Vec<(Vec<u8>, Vec<u8>)> {
    let worker = ShardWorker::new(model, options, &()).unwrap();
    let mut all = Vec::new();
    let mut run = |jobs: Vec<Vec<u8>>| {
        let results = jobs.iter().map(|job| worker.run(job, &())).collect::<Result<Vec<_>, _>>()?;
        all.extend(jobs.into_iter().zip(results.clone()));
        Ok(results)
    };
    compute_in_shards(model, options, shards, &mut run, &()).unwrap();
    all
}

/// This test fails if a result depends on the tasks before it in the same job, or comes in another order.
#[test]
fn any_number_of_shards_gives_the_same_certificates() {
    let center = Some(vec![0.01, -0.02, 0.0, 0.01]);
    for (case, options) in [
        CertifyOptions::default(),
        CertifyOptions::default().budget(0),
        CertifyOptions::default().budget(400).local_budget(64).epsilon(0.03),
        CertifyOptions::default()
            .budget(4)
            .center(center)
            .filter(ContactFilter::new(Default::default()).weld(true)),
    ]
    .into_iter()
    .enumerate()
    {
        let model = ring(150, 4, 0.9 + case as f64);
        let local = Certificates::compute(&model, &options, &()).unwrap();
        assert!(local.parts().node_radii.len() > 20);
        for shards in [7, 1, 2, 1000].into_iter().take(cases(4)) {
            assert!(sharded(&model, &options, shards).unwrap() == local, "case {case}, {shards} shards");
        }
    }
}

/// Models of a few triangles, whose root is a leaf, fits in a bucket, or is slightly larger.
#[test]
fn small_models_can_be_sharded() {
    for quads in [2, 4, 9, 40] {
        let model = ring(quads, 2, 0.4);
        let options = CertifyOptions::default();
        let local = Certificates::compute(&model, &options, &()).unwrap();
        assert!(sharded(&model, &options, 3).unwrap() == local, "{quads} quads");
    }
}

#[test]
fn results_of_other_models_options_and_jobs_are_refused() {
    let model = ring(200, 3, 0.9);
    let options = CertifyOptions::default();
    let refusal = |worker: &ShardWorker| {
        let mut run = |jobs: Vec<Vec<u8>>| jobs.iter().map(|job| worker.run(job, &())).collect();
        compute_in_shards(&model, &options, 4, &mut run, &()).unwrap_err().to_string()
    };
    let mut scales = model.metric().scales();
    scales[0] *= 2.0;
    let weights: Vec<f64> = scales.iter().map(|s| s * s).collect();
    let metric = Some(Metric::from_weights(MetricKind::Given, &weights).unwrap());
    for (model, options) in [
        (ring(200, 3, 0.901), options.clone()),
        (ring(202, 3, 0.9), options.clone()),
        (ring(200, 3, 0.9), options.clone().epsilon(0.11)),
        (ring(200, 3, 0.9), options.clone().metric(metric)),
    ] {
        let worker = ShardWorker::new(&model, &options, &()).unwrap();
        assert!(refusal(&worker).contains("a job belongs to another model"), "{}", refusal(&worker));
    }
    // Results of the right model are refused if they are swapped.
    let worker = ShardWorker::new(&model, &options, &()).unwrap();
    let mut swapped = |jobs: Vec<Vec<u8>>| jobs.iter().rev().map(|job| worker.run(job, &())).collect();
    let error = compute_in_shards(&model, &options, 4, &mut swapped, &()).unwrap_err();
    assert_eq!(error.to_string(), "shards: a result is of another job");
    let mut fewer = |_: Vec<Vec<u8>>| Ok(Vec::new());
    let error = compute_in_shards(&model, &options, 4, &mut fewer, &()).unwrap_err();
    assert_eq!(error.to_string(), "shards: 0 results were returned for 4 jobs");
    let error = compute_in_shards(&model, &options, 0, &mut fewer, &()).unwrap_err();
    assert_eq!(error.to_string(), "shards is 0: it must be at least 1");
}

/// Jobs and results with a flipped bit in any byte, and all their truncations, are refused. Bytes under a valid seal
/// that are no job or result are refused, too.
#[test]
fn damaged_bytes_are_answered_with_an_error() {
    let model = ring(100, 3, 0.9);
    let options = CertifyOptions::default();
    let worker = ShardWorker::new(&model, &options, &()).unwrap();
    let all = jobs(&model, &options, 3);
    for (job, result) in [&all[0], &all[all.len() - 1]] {
        for (what, bytes) in [("a job", job), ("a result", result)] {
            for at in 0..bytes.len() {
                let mut flipped = bytes.clone();
                flipped[at] ^= 1 << (at % 8);
                assert!(worker.key.open(what, &flipped).is_err());
                assert!(worker.key.open(what, &bytes[..at]).is_err());
            }
        }
    }
    let mut refused = 0;
    let hierarchy = &worker.preparation.hierarchy;
    for (job, result) in &all {
        let body = worker.key.open("a job", job).unwrap();
        for at in (0..body.len()).step_by(1 + body.len() / 97) {
            let mut changed = body.to_vec();
            changed[at] ^= 0x80;
            // The changed bytes may be another job; reading them must not panic.
            refused += usize::from(Job::read(hierarchy, &changed).is_none());
            let _ = Job::read(hierarchy, &body[..at]);
        }
        let job = Job::read(hierarchy, body).unwrap();
        let mut writer = JobWriter::new(job.max_added_pairs);
        job.tasks.iter().for_each(|task| writer.add(task));
        assert_eq!(writer.into_bytes(), body);
        let layouts: Vec<ResultLayout> = job.tasks.iter().map(ResultLayout::of).collect();
        let result = &worker.key.open("a result", result).unwrap()[HASH..];
        let read = |bytes: &[u8]| JobResult::read(hierarchy, &layouts, bytes);
        assert_eq!(read(result).unwrap().to_bytes(), result);
        for at in 0..result.len() {
            let mut changed = result.to_vec();
            changed[at] ^= 0x83;
            refused += usize::from(read(&changed).is_none());
            assert!(read(&result[..at]).is_none());
        }
        assert!(read(&[result, &[0]].concat()).is_none());
        if let Task::NodeRadius(_) = job.tasks[0] {
            // Sets the sign of the first radius, which follows the first byte.
            let mut negative = result.to_vec();
            negative[8] |= 0x80;
            refused += usize::from(read(&negative).is_none());
            negative[1..9].copy_from_slice(&f64::NAN.to_le_bytes());
            assert!(read(&negative).is_none());
        }
    }
    assert!(refused > 100, "{refused}");
}

/// A cancelled job ends with the error.
#[test]
fn shards_can_be_cancelled() {
    let model = ring(200, 3, 0.9);
    let options = CertifyOptions::default();
    let worker = ShardWorker::new(&model, &options, &()).unwrap();
    let (job, _) = &jobs(&model, &options, 2)[0];
    assert_eq!(worker.run(job, &CancelToken::when(|| true)), Err(Error::Cancelled));
}

#[test]
fn jobs_of_nodes_that_do_not_exist_are_refused() {
    let model = ring(20, 2, 0.4);
    let hierarchy = Hierarchy::build(&model, model.metric());
    let count = hierarchy.nodes().len() as u32;
    let is_job = |nodes| {
        let mut writer = JobWriter::new(1);
        writer.add(&Task::Split(SplitTask { nodes, lower: 0.0, limit: 1.0, is_outer: false }));
        Job::read(&hierarchy, &writer.into_bytes()).is_some()
    };
    assert!(is_job((0, count - 1)) && is_job((count - 1, 0)));
    for bad in [(0, count), (count, 0), (1, 1), (count, count), (0, u32::MAX)] {
        assert!(!is_job(bad), "{bad:?}");
    }
}
