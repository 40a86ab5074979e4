//! The tool on small workspaces, each in a folder of its own, and on this one.

mod imports;
mod rules;
mod this_workspace;
mod tree;
