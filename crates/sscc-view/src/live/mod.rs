//! Answers to the requests of a live page, by queries of the core.

mod animation;
mod cancellation;
mod check;
mod collision;
mod intervals;
mod nodes;
mod sweep;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use sscc::{CancelToken, Certificates, Method, Query, ReducedModel};
use sscc_tasks::IntervalRow;

use crate::error::check_certificates;
use crate::{Arrays, Scene, ViewError};
use cancellation::{Cancellation, MAX_SECONDS};
use nodes::ORDER;

pub use animation::AnimationRequest;
pub use check::{CheckAnswer, CheckRequest};
pub use collision::{DirectionAnswer, DirectionRequest};
pub use intervals::IntervalsRequest;
pub use nodes::{BoxesAnswer, BoxesRequest, NodesAnswer};
pub use sweep::{SweepAnswer, SweepRequest};

/// A live page of one model, for any number of threads. Short requests wait only for short ones, long requests only for
/// long ones.
pub struct Live {
    model: ReducedModel,
    certificates: Certificates,
    scene: Scene,
    arrays: Arrays,
    checks: Mutex<Query>,
    long: Mutex<Long>,
    cancel: Option<CancelToken>,
    sweeps: Mutex<Query>,
    intervals: Mutex<Query>,
    searches: Newest,
    newest_sweep: Newest,
    newest_intervals: Newest,
}

/// The number of the newest request of a kind; older ones are cancelled.
#[derive(Default)]
struct Newest(Arc<AtomicU64>);

/// Queries for requests that may take seconds.
struct Long {
    certified: Query,
    /// Created by the first request.
    traditional: Option<Query>,
}

/// A request with one q (r numbers).
#[derive(Clone, Debug, Deserialize)]
pub struct At {
    q: Vec<f64>,
}

/// The result of a query by the traditional method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraditionalAnswer {
    microseconds: f64,
    /// The number of colliding pairs; a lower bound if the answer is not complete.
    count: usize,
    /// Whether the search ended before its limit.
    complete: bool,
}

impl Live {
    /// Returns the live page of a model. `scene` and `arrays` describe the model. The token cancels queries.
    ///
    /// # Errors
    /// If the certificates belong to another model or have a clearance.
    pub fn new(
        model: &ReducedModel,
        certificates: &Certificates,
        scene: Scene,
        mut arrays: Arrays,
        cancel: Option<CancelToken>,
    ) -> Result<Self, ViewError> {
        check_certificates(model, certificates)?;
        arrays.add_u32(ORDER, certificates.parts().hierarchy.order().iter().copied());
        let query = Query::new(model, certificates)?.cancelled_by(cancel.clone());
        let long = Mutex::new(Long { certified: query.clone(), traditional: None });
        let [checks, sweeps, intervals] = [query.clone(), query.clone(), query].map(Mutex::new);
        let [searches, newest_sweep, newest_intervals] = [(); 3].map(|()| Newest::default());
        Ok(Self {
            model: model.clone(),
            certificates: certificates.clone(),
            scene,
            arrays,
            checks,
            long,
            cancel,
            sweeps,
            intervals,
            searches,
            newest_sweep,
            newest_intervals,
        })
    }

    /// Returns the scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the bytes of an array of the scene; `None` if no array has this name.
    pub fn array(&self, name: &str) -> Option<&[u8]> {
        self.arrays.get(name)
    }

    /// Returns the collisions at one q.
    ///
    /// # Errors
    /// If q is not a configuration of the model.
    pub fn check(&self, request: &CheckRequest) -> Result<CheckAnswer, ViewError> {
        check::check(&mut lock(&self.checks), &self.certificates, request)
    }

    /// Returns the time and the number of pairs of the same query by the traditional method.
    ///
    /// # Errors
    /// The errors are those of [`Live::check`].
    pub fn traditional(&self, At { q }: &At) -> Result<TraditionalAnswer, ViewError> {
        let mut long = lock(&self.long);
        let query = match &mut long.traditional {
            Some(query) => query,
            none => none.insert(
                Query::with_method(&self.model, &self.certificates, Method::Traditional)?
                    .cancelled_by(self.cancel.clone()),
            ),
        };
        let (count, microseconds) =
            check::timed(|| query.discrete_at_most(q, check::MAX_PAIRS).map(<[_]>::len));
        let count = count?;
        Ok(TraditionalAnswer { microseconds, count, complete: query.statistics().complete })
    }

    /// Returns the safe scale of a direction from the centre, and the first collision along it. The search ends early
    /// at the time limit, after a newer search was requested, and when the token is cancelled because the client has left.
    ///
    /// # Errors
    /// If the direction has not one finite number for each mode, or the search ended before its first result.
    pub fn safe_scale(
        &self,
        request: &DirectionRequest,
        client: &CancelToken,
    ) -> Result<DirectionAnswer, ViewError> {
        self.newest(&self.searches, &self.long, client, |long, cancellation| {
            let query = long.certified.clone().cancelled_by(cancellation.token.clone());
            collision::along(query, &self.model, &self.certificates, request, cancellation)
        })
    }

    /// Returns the ranges of the weight of one mode, upwards and downwards, in which the shape does not touch itself. The
    /// sweep is cancelled like [`Live::safe_scale`], but then has no result; searches along directions do not end it.
    ///
    /// # Errors
    /// If q is not a configuration of the model, the mode does not exist, or the range is empty; if the sweep ended
    /// before its result.
    pub fn sweep(&self, request: &SweepRequest, client: &CancelToken) -> Result<Vec<SweepAnswer>, ViewError> {
        self.newest(&self.newest_sweep, &self.sweeps, client, |query, cancellation| {
            sweep::sweep(query, request, cancellation)
        })
    }

    /// Returns the intervals of one mode's weight over which the shape collides. The search is cancelled like [`Live::sweep`].
    ///
    /// # Errors
    /// The errors are those of [`Live::sweep`].
    pub fn intervals(
        &self,
        request: &IntervalsRequest,
        client: &CancelToken,
    ) -> Result<IntervalRow, ViewError> {
        self.newest(&self.newest_intervals, &self.intervals, client, |query, cancellation| {
            intervals::intervals(query, request, cancellation)
        })
    }

    /// Runs work that is cancelled at the time limit, after a newer request of its kind, and when the client has left.
    fn newest<Q, T>(
        &self,
        Newest(newest): &Newest,
        queries: &Mutex<Q>,
        client: &CancelToken,
        work: impl FnOnce(&Q, &Cancellation) -> Result<T, ViewError>,
    ) -> Result<T, ViewError> {
        let number = newest.fetch_add(1, Ordering::Relaxed) + 1;
        let queries = lock(queries);
        let (newest, client) = (Arc::clone(newest), client.clone());
        let is_wanted = move || newest.load(Ordering::Relaxed) == number && !client.is_cancelled();
        let end = Instant::now() + Duration::from_secs(MAX_SECONDS);
        work(&queries, &Cancellation::new(self.cancel.clone(), move || Instant::now() >= end, is_wanted))
    }

    /// Returns the hierarchy.
    pub fn nodes(&self) -> NodesAnswer {
        nodes::all(&self.certificates)
    }

    /// Returns the AABBs of one level of the hierarchy at q.
    ///
    /// # Errors
    /// The errors of [`Live::check`]; also if the level does not exist.
    pub fn boxes(&self, request: &BoxesRequest) -> Result<BoxesAnswer, ViewError> {
        nodes::boxes(&self.model, &self.certificates, request)
    }

    /// Returns a motion as a binary glTF file.
    ///
    /// # Errors
    /// If there are too many frames, times do not ascend, or a q has not one finite number for each mode.
    pub fn animation(&self, request: &AnimationRequest) -> Result<Vec<u8>, ViewError> {
        // One motion at a time, since each may need hundreds of megabytes.
        let _turn = lock(&self.long);
        let name = self.scene.models.first().map_or("model", |model| model.name());
        animation::glb(name, &self.model, request)
    }
}

/// Locks a mutex, also after a panic of another thread: queries hold only scratch, which each query initialises.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
