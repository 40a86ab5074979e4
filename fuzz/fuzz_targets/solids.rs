//! Volumetric meshes of Medit, gmsh, VTK and VegaFEM.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::solid::medit::parse_any(bytes));
    one_line(sscc_io::solid::gmsh::parse_any(bytes));
    one_line(sscc_io::solid::vtk::parse_any(bytes));
    one_line(sscc_io::solid::vega::parse(bytes));
}
