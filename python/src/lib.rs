//! The extension module of the Python package `sscc`. `sscc/_sscc.pyi` documents its contents.

mod answer;
mod arguments;
mod arrays;
mod batch;
mod certificates;
mod certify;
mod clearance;
mod colliding_triangles;
mod contacts;
mod core_seconds;
mod detector;
mod detector_answer;
mod detector_batch;
mod detector_pool;
mod errors;
mod groups;
mod hierarchy;
mod impacts;
mod interrupt;
mod kinetic;
mod metric;
mod model;
mod model_methods;
mod modes;
mod polygons;
mod pool;
mod positions;
mod resolve;
mod scene;
mod shards;
mod simulate;
mod sweeps;
mod watching;

use pyo3::prelude::*;

// Free-threaded Python is untested.
#[pymodule(gil_used = true)]
mod _sscc {
    #[pymodule_export]
    use super::answer::{_answer, Answer};
    #[pymodule_export]
    use super::arrays::{_integers, _numbers};
    #[pymodule_export]
    use super::batch::{_batch, Batch};
    #[pymodule_export]
    use super::certificates::{_certificates, Certificates};
    #[pymodule_export]
    use super::core_seconds::_core_seconds;
    #[pymodule_export]
    use super::detector::{_detector, Detector, self_intersections};
    #[pymodule_export]
    use super::detector_answer::{_detector_answer, _detector_impacts, DetectorAnswer, DetectorImpacts};
    #[pymodule_export]
    use super::detector_batch::{_detector_batch, DetectorBatch};
    #[pymodule_export]
    use super::hierarchy::Hierarchy;
    #[pymodule_export]
    use super::impacts::{_impacts, Impacts};
    #[pymodule_export]
    use super::kinetic::KineticQuery;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::model_methods::_model;
    #[pymodule_export]
    use super::shards::{_build, _certify_in_shards, _check_options, _configurations, _joined, ShardWorker};

    #[pymodule_export]
    use super::modes::{_elastic, _pca, _polynomial};
    #[pymodule_export]
    use super::polygons::_triangulated;
    #[pymodule_export]
    use super::scene::{_check_scene, _scene_contents, _scene_positions};
    #[pymodule_export]
    use super::simulate::_simulate;

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
