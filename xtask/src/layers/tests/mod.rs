//! Tests of the tool on small workspaces in temporary folders, and on this one.

mod imports;
mod rules;
mod this_workspace;
mod tree;
