//! Whether this workspace keeps its layers.

use std::path::Path;

use super::super::order::Order;
use super::super::read::Workspace;
use super::super::rules::{Violation, check};

/// Crates that do not keep their layers yet.
const NOT_YET: &[&str] = &["sscc", "sscc-cli", "sscc-dynamics", "sscc-io", "sscc-modes"];

#[test]
fn this_workspace_keeps_its_layers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let violations = check(&Workspace::read(&root).unwrap(), &Order::read(&root).unwrap());
    let is_expected = |violation: &&Violation| match &violation.krate {
        Some(krate) => NOT_YET.contains(&krate.as_str()),
        None => false,
    };
    let (expected, broken): (Vec<&Violation>, Vec<&Violation>) = violations.iter().partition(is_expected);
    let messages: Vec<&str> = broken.iter().map(|violation| violation.message.as_str()).collect();
    assert!(broken.is_empty(), "{}", messages.join("\n"));
    for name in NOT_YET {
        let still = expected.iter().any(|violation| violation.krate.as_deref() == Some(name));
        assert!(still, "{name} keeps its layers: take it out of NOT_YET");
    }
}
