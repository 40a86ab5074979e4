//! `sscc.Detector` and `sscc.self_intersections`: exact collisions of any mesh at given positions.

use std::sync::Arc;

use glam::DVec3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use sscc::parts::GroupTable;
use sscc::parts::body_penetration;
use sscc::{Answer, Error, TriMesh};
use sscc_tasks::text::{counted, grouped};

use crate::answer::Reduction;
use crate::arguments::{count, switch};
use crate::arrays::{floats, line, pairs, table};
use crate::clearance::{self, Enclosed, NearArrays, Nearest, near_arrays};
use crate::contacts::Contacts;
use crate::detector_answer::{DetectorAnswer, DetectorImpacts, FoundFrame};
use crate::detector_batch::DetectorBatch;
use crate::detector_pool::{Built, DetectorMesh, DetectorPool, detector};
use crate::errors::{kind, refused, value};
use crate::groups::{ignored_pairs, with_groups};
use crate::interrupt::{answer, run_borrowing, signals};
use crate::model::{face_corners, points};
use crate::pool;
use crate::positions::{Frames, NamedPositions, Weld, contact_filter, fault};

/// The arguments of a pickled detector: faces, rest, weld, neighbours, ignored, groups, ignore_groups.
type PickledDetector<'py> = (
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Bound<'py, PyAny>,
    &'static str,
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, PyAny>>,
);

#[pyclass(frozen, module = "sscc", name = "Detector")]
pub struct Detector {
    pool: DetectorPool,
    /// Whether the argument `rest` was given.
    has_rest: bool,
}

impl Detector {
    /// Returns the hierarchy. Builds it from these positions if they are the first.
    fn built(&self, positions: &NamedPositions) -> PyResult<Arc<Built>> {
        self.pool.built(&positions.points, positions.name)
    }

    /// Returns the answer with the triangles of its pairs at these positions.
    fn found(&self, frame: Answer, positions: &[DVec3]) -> FoundFrame {
        FoundFrame::of(frame, |pairs| Contacts::within((&self.pool.mesh.faces, positions), pairs))
    }

    /// Runs a query. `work` runs without the GIL, after the hierarchy exists.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        given: &[&NamedPositions],
        work: impl FnOnce(&mut sscc::Detector) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        answer(py, || {
            let built = self.built(given[0])?;
            let found = self.pool.with_detector(&built, work);
            found.map_err(|error| at_fault(&error, &[(given, built.rest.len())]))
        })?
    }

    /// Runs a query of two detectors, each with its positions.
    fn ask_both<T: Send>(
        &self,
        py: Python<'_>,
        given: &[&NamedPositions],
        other: &Self,
        others: &[&NamedPositions],
        work: impl FnOnce(&mut sscc::Detector, &mut sscc::Detector) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        answer(py, || {
            let built = [self.built(given[0])?, other.built(others[0])?];
            let found = self.pool.with_detector(&built[0], |detector| {
                other.pool.with_detector(&built[1], |other| work(detector, other))
            });
            let vertices = built.map(|built| built.rest.len());
            found.map_err(|error| at_fault(&error, &[(given, vertices[0]), (others, vertices[1])]))
        })?
    }
}

/// Returns the exception for an error of the core, which names the first argument that the core refuses.
fn at_fault(error: &Error, given: &[(&[&NamedPositions], usize)]) -> PyErr {
    let fault = given
        .iter()
        .find_map(|(positions, vertices)| positions.iter().find_map(|positions| positions.fault(*vertices)));
    fault.unwrap_or_else(|| refused(error, ""))
}

/// Returns the arguments `positions` and `other_positions`.
fn named_both(positions: &Bound<'_, PyAny>, other: &Bound<'_, PyAny>) -> PyResult<[NamedPositions; 2]> {
    Ok([NamedPositions::of(positions, "positions")?, NamedPositions::of(other, "other_positions")?])
}

/// Returns the detector in the argument `other`.
fn as_detector<'a>(other: &'a Bound<'_, PyAny>) -> PyResult<&'a Detector> {
    match other.cast::<Detector>() {
        Ok(detector) => Ok(detector.get()),
        Err(_) => Err(kind(format!("other is a {}: a sscc.Detector was expected", other.get_type().name()?))),
    }
}

#[pymethods]
impl Detector {
    #[new]
    #[pyo3(signature = (faces, rest=None, *, weld=None, neighbours=None, ignored=None, groups=None,
        ignore_groups=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        faces: &Bound<'_, PyAny>,
        rest: Option<&Bound<'_, PyAny>>,
        weld: Option<&Bound<'_, PyAny>>,
        neighbours: Option<&Bound<'_, PyAny>>,
        ignored: Option<&Bound<'_, PyAny>>,
        groups: Option<&Bound<'_, PyAny>>,
        ignore_groups: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let rest = rest.map(|rest| NamedPositions::of(rest, "rest")).transpose()?;
        let faces = face_corners(faces, rest.as_ref().map(|rest| (rest.points.len(), rest.name)))?;
        if faces.is_empty() {
            return Err(refused(&Error::NoFaces, "faces"));
        }
        let weld = Weld::of(weld)?;
        if rest.is_none() && matches!(weld, Weld::ByPosition) {
            return Err(value("weld is True, but rest is missing: it defines which vertices are equal"));
        }
        let filter = contact_filter(neighbours, &weld, ignored, faces.len())?;
        let filter = with_groups(filter, faces.len(), groups, ignore_groups)?;
        let detector =
            Self { pool: DetectorPool::of(DetectorMesh { faces, weld, filter }), has_rest: rest.is_some() };
        if let Some(rest) = rest {
            answer(py, || detector.built(&rest).map(drop))??;
        }
        Ok(detector)
    }

    #[pyo3(signature = (positions, limit=None, *, first=None))]
    fn check(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        limit: Option<&Bound<'_, PyAny>>,
        first: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<DetectorAnswer> {
        let positions = NamedPositions::of(positions, "positions")?;
        let limit = match (count(limit, "limit", 1..=usize::MAX)?, switch(first, "first")?) {
            (Some(limit), Some(true)) if limit > 1 => {
                return Err(value(format!("first is True and limit is {limit}: leave one of them out")));
            }
            (_, Some(true)) => 1,
            (limit, _) => limit.unwrap_or(usize::MAX),
        };
        self.ask(py, &[&positions], |detector| {
            let pairs = detector.discrete_at_most(&positions.points, limit)?.to_vec();
            let frame = Answer { pairs, statistics: detector.statistics() };
            Ok(DetectorAnswer::of(self.found(frame, &positions.points)))
        })
    }

    #[pyo3(signature = (frames, limit=None, *, threads=None, progress=None))]
    fn check_many(
        &self,
        py: Python<'_>,
        frames: &Bound<'_, PyAny>,
        limit: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<DetectorBatch> {
        let limit = count(limit, "limit", 1..=usize::MAX)?.unwrap_or(usize::MAX);
        let threads = pool::threads(threads)?;
        let frames = Frames::of(frames, self.pool.known(py).map(|built| built.rest.len()))?;
        let slices = frames.slices()?;
        let Some(first) = slices.first() else { return Ok(DetectorBatch::of(Vec::new())) };
        let answers = run_borrowing(py, progress, "checking", |progress| {
            let built = self.pool.built(first, "frames[0]")?;
            let answers = built.first.batch_at_most(&slices, limit, threads, progress);
            let found = |(frame, x): (Answer, &&[DVec3])| self.found(frame, x);
            let answers = answers.map(|answers| answers.into_iter().zip(&slices).map(found).collect());
            answers.map_err(|error| {
                let fault = |(frame, x): (usize, &&[DVec3])| Some((frame, fault(x, built.rest.len())?));
                match slices.iter().enumerate().find_map(fault) {
                    Some((frame, error)) => refused(&error, &format!("frames[{frame}]")),
                    None => refused(&error, ""),
                }
            })
        })?;
        Ok(DetectorBatch::of(answers?))
    }

    fn continuous(
        &self,
        py: Python<'_>,
        x0: &Bound<'_, PyAny>,
        x1: &Bound<'_, PyAny>,
    ) -> PyResult<DetectorImpacts> {
        let [x0, x1] = [NamedPositions::of(x0, "x0")?, NamedPositions::of(x1, "x1")?];
        self.ask(py, &[&x0, &x1], |detector| {
            let impacts = detector.continuous(&x0.points, &x1.points)?.to_vec();
            Ok(DetectorImpacts::of(&impacts, detector.statistics()))
        })
    }

    fn against(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        other: &Bound<'_, PyAny>,
        other_positions: &Bound<'_, PyAny>,
    ) -> PyResult<DetectorAnswer> {
        let other = as_detector(other)?;
        let [x, y] = named_both(positions, other_positions)?;
        let faces = [self, other].map(|detector| detector.pool.mesh.faces.as_slice());
        self.ask_both(py, &[&x], other, &[&y], |detector, other| {
            let pairs = detector.against(&x.points, other, &y.points)?.to_vec();
            let frame = Answer { pairs, statistics: detector.statistics() };
            let [x, y] = [(faces[0], x.points.as_slice()), (faces[1], y.points.as_slice())];
            Ok(DetectorAnswer::of(FoundFrame::of(frame, |pairs| Contacts::between(x, y, pairs))))
        })
    }

    fn against_continuous(
        &self,
        py: Python<'_>,
        x0: &Bound<'_, PyAny>,
        x1: &Bound<'_, PyAny>,
        other: &Bound<'_, PyAny>,
        y0: &Bound<'_, PyAny>,
        y1: &Bound<'_, PyAny>,
    ) -> PyResult<DetectorImpacts> {
        let other = as_detector(other)?;
        let [x0, x1] = [NamedPositions::of(x0, "x0")?, NamedPositions::of(x1, "x1")?];
        let [y0, y1] = [NamedPositions::of(y0, "y0")?, NamedPositions::of(y1, "y1")?];
        self.ask_both(py, &[&x0, &x1], other, &[&y0, &y1], |detector, other| {
            let [x, y] = [[&x0, &x1], [&y0, &y1]].map(|ends| ends.map(|x| x.points.as_slice()));
            let impacts = detector.continuous_against(x, other, y)?.to_vec();
            Ok(DetectorImpacts::of(&impacts, detector.statistics()))
        })
    }

    #[pyo3(signature = (positions, clearance, *, rings=None))]
    fn within<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        clearance: &Bound<'py, PyAny>,
        rings: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<NearArrays<'py>> {
        let clearance = clearance::clearance(clearance, rings)?;
        let x = NamedPositions::of(positions, "positions")?;
        let near = self.ask(py, &[&x], |detector| Ok(detector.within(&x.points, &clearance)?.to_vec()))?;
        near_arrays(py, &near)
    }

    fn within_against<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        other: &Bound<'py, PyAny>,
        other_positions: &Bound<'py, PyAny>,
        clearance: &Bound<'py, PyAny>,
    ) -> PyResult<NearArrays<'py>> {
        let (other, clearance) = (as_detector(other)?, clearance::clearance(clearance, None)?);
        let [x, y] = named_both(positions, other_positions)?;
        let near = self.ask_both(py, &[&x], other, &[&y], |detector, other| {
            Ok(detector.within_against(&x.points, other, &y.points, &clearance)?.to_vec())
        })?;
        near_arrays(py, &near)
    }

    #[pyo3(signature = (positions, *, rings=None))]
    fn nearest(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        rings: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Nearest> {
        let rings = clearance::rings_of(rings)?;
        let x = NamedPositions::of(positions, "positions")?;
        self.ask(py, &[&x], |detector| detector.nearest(&x.points, rings)).map(clearance::nearest)
    }

    fn nearest_against(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        other: &Bound<'_, PyAny>,
        other_positions: &Bound<'_, PyAny>,
    ) -> PyResult<Nearest> {
        let other = as_detector(other)?;
        let [x, y] = named_both(positions, other_positions)?;
        let ask = |detector: &mut sscc::Detector, other: &mut sscc::Detector| {
            detector.nearest_against(&x.points, other, &y.points)
        };
        self.ask_both(py, &[&x], other, &[&y], ask).map(clearance::nearest)
    }

    fn enclosed(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        other: &Bound<'_, PyAny>,
        other_positions: &Bound<'_, PyAny>,
    ) -> PyResult<(Enclosed, Enclosed)> {
        let other = as_detector(other)?;
        let [x, y] = named_both(positions, other_positions)?;
        let ask = |detector: &mut sscc::Detector, other: &mut sscc::Detector| {
            detector.enclosed(&x.points, other, &y.points)
        };
        let [one, two] = self.ask_both(py, &[&x], other, &[&y], ask)?;
        Ok(((one.inside, one.components), (two.inside, two.components)))
    }

    fn penetration<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        other: &Bound<'py, PyAny>,
        other_positions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let other = as_detector(other)?;
        let [x, y] = named_both(positions, other_positions)?;
        let ask = |detector: &mut sscc::Detector, other: &mut sscc::Detector| {
            body_penetration([detector, other], [&x.points, &y.points])
        };
        let found = self.ask_both(py, &[&x], other, &[&y], ask)?;
        let class = py.import("sscc._penetration")?.getattr("BodyPenetration")?;
        class.call1((found.volume, found.volume_error, found.depth, found.depth_error))
    }

    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        table(py, 3, self.pool.mesh.faces.as_flattened().to_vec())
    }

    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let built = self.pool.known(py).filter(|_| self.has_rest);
        built.map(|built| coordinates(py, &built.rest)).transpose()
    }

    #[getter]
    fn neighbours(&self) -> &'static str {
        self.pool.mesh.filter.neighbours.into()
    }

    #[getter]
    fn weld<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.pool.mesh.weld {
            Weld::Classes(classes) => Ok(line(py, classes.clone())),
            weld => Ok(matches!(weld, Weld::ByPosition).into_pyobject(py)?.to_owned().into_any()),
        }
    }

    #[getter]
    fn ignored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pairs(py, self.pool.mesh.filter.ignored())
    }

    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let groups = self.pool.mesh.filter.groups()?;
        Some(line::<u32>(
            py,
            GroupTable::from(&**groups).of_triangles.iter().map(|group| u32::from(*group)).collect(),
        ))
    }

    #[getter]
    fn ignored_groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let groups = self.pool.mesh.filter.groups();
        pairs(py, &groups.map_or_else(Vec::new, |groups| ignored_pairs(groups)))
    }

    /// Returns the pickled form. The copy builds its own hierarchy, from `rest` or the first positions that it checks.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, PickledDetector<'py>>> {
        let groups = self.groups(py);
        let ignore_groups = groups.as_ref().map(|_| self.ignored_groups(py)).transpose()?;
        let (faces, rest, ignored) = (self.faces(py)?, self.rest(py)?, self.ignored(py)?);
        let arguments = (faces, rest, self.weld(py)?, self.neighbours(), ignored, groups, ignore_groups);
        Ok((py.import("sscc._sscc")?.getattr("_detector")?, arguments))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let triangles = counted(self.pool.mesh.faces.len() as u64, "triangle");
        match self.pool.known(py) {
            Some(built) => {
                format!("<sscc.Detector: {triangles}, {} vertices>", grouped(built.rest.len() as u64))
            }
            None => format!("<sscc.Detector: {triangles}, positions not yet known>"),
        }
    }
}

/// Unpickles detectors.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn _detector(
    py: Python<'_>,
    faces: &Bound<'_, PyAny>,
    rest: Option<&Bound<'_, PyAny>>,
    weld: &Bound<'_, PyAny>,
    neighbours: &Bound<'_, PyAny>,
    ignored: &Bound<'_, PyAny>,
    groups: Option<&Bound<'_, PyAny>>,
    ignore_groups: Option<&Bound<'_, PyAny>>,
) -> PyResult<Detector> {
    Detector::new(py, faces, rest, Some(weld), Some(neighbours), Some(ignored), groups, ignore_groups)
}

/// Returns the exact self-intersections of a mesh, as an array (n, 2).
#[pyfunction]
#[pyo3(signature = (vertices, faces, *, weld=None, neighbours=None))]
pub fn self_intersections<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    weld: Option<&Bound<'py, PyAny>>,
    neighbours: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = floats(vertices, "vertices")?;
    let positions = if array.shape() == [0] { Vec::new() } else { points(&array, "vertices")? };
    let weld = Weld::of(weld)?;
    let filter = contact_filter(neighbours, &weld, None, 0)?;
    let faces = face_corners(faces, Some((positions.len(), "vertices")))?;
    if faces.is_empty() {
        return match fault(&positions, positions.len()) {
            Some(error) => Err(refused(&error, "vertices")),
            None => pairs(py, &[]),
        };
    }
    let found = answer(py, || -> PyResult<_> {
        let mesh = TriMesh::new(positions, faces).map_err(|error| refused(&error, "vertices"))?;
        let options = DetectorMesh { faces: Vec::new(), weld, filter };
        let mut detector = detector(&mesh, &options, "vertices")?.cancelled_by(signals().clone());
        let found = detector.discrete(mesh.rest_positions()).map(<[_]>::to_vec);
        found.map_err(|error| refused(&error, "vertices"))
    })?;
    pairs(py, &found?)
}

/// Returns positions as an array (V, 3).
fn coordinates<'py>(py: Python<'py>, positions: &[DVec3]) -> PyResult<Bound<'py, PyAny>> {
    table(py, 3, positions.iter().flat_map(|x| x.to_array()).collect())
}
