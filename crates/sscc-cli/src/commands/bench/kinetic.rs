//! The records of the scenario `kinetic` as text.

use sscc_bench::KineticRecord;
use sscc_tasks::CertifiedModel;

use crate::output::grouped;

/// Returns the lines about the model, which all records share.
pub fn head(model: &CertifiedModel) -> Vec<String> {
    let (triangles, rank) = (grouped(model.model.mesh().faces().len() as u64), model.model.rank());
    let head = format!("kinetic: {triangles} triangles, {rank} modes ({})", model.source);
    [head].into_iter().chain(model.note.iter().map(|note| format!("note: {note}"))).collect()
}

/// Returns the lines of one record.
pub fn lines(record: &KineticRecord) -> Vec<String> {
    let per_cent = 100.0 * record.colliding_steps as f64 / record.steps as f64;
    let mut lines = vec![format!(
        "  first mode {:.3} Hz: {} steps of {:.5} |z|, {per_cent:.1}% collide",
        record.frequency,
        grouped(record.steps as u64),
        record.step
    )];
    let kinetic = record.microseconds.get("kinetic").unwrap_or(f64::NAN);
    for (key, time) in &record.microseconds.0 {
        let ratio = if *key == "kinetic" {
            record
                .kinetic_us_colliding
                .map_or(String::new(), |time| format!("{time:>12.2} us in colliding steps"))
        } else {
            format!("{:>11.1} x", time / kinetic)
        };
        lines.push(format!("    {key:<14}{time:>12.2} us{ratio}"));
    }
    lines
}
