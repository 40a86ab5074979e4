//! OBJ: the mesh, and the groups of its triangles.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};
use sscc_io::GroupsBy;

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::mesh::obj::parse(bytes));
    for by in [GroupsBy::Group, GroupsBy::Object, GroupsBy::Mesh, GroupsBy::Material] {
        one_line(sscc_io::mesh::obj::groups(bytes, by));
    }
}
