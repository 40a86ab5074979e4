//! Tests that this workspace has no violation.

use std::path::Path;

use super::super::order::Order;
use super::super::read::Workspace;
use super::super::rules::check;

#[test]
fn this_workspace_keeps_its_layers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let violations = check(&Workspace::read(&root).unwrap(), &Order::read(&root).unwrap());
    let messages: Vec<&str> = violations.iter().map(|violation| violation.message.as_str()).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}
