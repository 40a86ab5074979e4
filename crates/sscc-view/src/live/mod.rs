//! What a live page asks for, answered by the core.

mod animation;
mod check;
mod collision;
mod nodes;
mod patience;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Method, Progress, Query, ReducedModel};

use crate::{Arrays, Scene, ViewError};
use nodes::ORDER;
use patience::{LONGEST, Patience};

pub use animation::AnimationRequest;
pub use check::{CheckAnswer, CheckRequest};
pub use collision::{DirectionAnswer, DirectionRequest};
pub use nodes::{BoxesAnswer, BoxesRequest, NodesAnswer};

/// One model on show. Many threads may ask at once: short questions wait for short ones only, long ones for long ones.
pub struct Live<'a> {
    model: &'a ReducedModel,
    certificates: &'a Certificates,
    scene: Scene,
    arrays: Arrays,
    checks: Mutex<Query<'a>>,
    long: Mutex<Long<'a>>,
    progress: &'a dyn Progress,
    /// The number of the search along a direction that was asked for last: only its answer is waited for.
    latest: AtomicU64,
}

/// For what may take seconds.
struct Long<'a> {
    certified: Query<'a>,
    /// Made when it is first asked for.
    traditional: Option<Query<'a>>,
}

/// A q.
#[derive(Clone, Debug, Deserialize)]
pub struct At {
    q: Vec<f64>,
}

/// What the traditional method took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraditionalAnswer {
    microseconds: f64,
    count: usize,
}

impl<'a> Live<'a> {
    /// Of a model, with the scene that describes it; queries stop when `progress` cancels.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn new(
        model: &'a ReducedModel,
        certificates: &'a Certificates,
        scene: Scene,
        mut arrays: Arrays,
        progress: &'a dyn Progress,
    ) -> Result<Self, ViewError> {
        arrays.add_u32(ORDER, certificates.hierarchy().order().iter().copied());
        let query = Query::new(model, certificates)?.cancelled_by(progress);
        let long = Mutex::new(Long { certified: query.clone(), traditional: None });
        let (checks, latest) = (Mutex::new(query), AtomicU64::new(0));
        Ok(Self { model, certificates, scene, arrays, checks, long, progress, latest })
    }

    /// What is shown.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// An array of it.
    pub fn array(&self, name: &str) -> Option<&[u8]> {
        self.arrays.get(name)
    }

    /// Collisions at q.
    ///
    /// # Errors
    /// When q is no configuration of the model.
    pub fn check(&self, request: &CheckRequest) -> Result<CheckAnswer, ViewError> {
        check::check(&mut locked(&self.checks), self.certificates, request)
    }

    /// The same number of collisions by the traditional method, to compare times.
    ///
    /// # Errors
    /// As [`Live::check`].
    pub fn traditional(&self, At { q }: &At) -> Result<TraditionalAnswer, ViewError> {
        let mut long = locked(&self.long);
        let query = match &mut long.traditional {
            Some(query) => query,
            none => none.insert(
                Query::with_method(self.model, self.certificates, Method::Traditional)?
                    .cancelled_by(self.progress),
            ),
        };
        let (count, microseconds) =
            check::timed(|| query.discrete_at_most(q, check::MOST_FOUND).map(<[_]>::len));
        Ok(TraditionalAnswer { microseconds, count: count? })
    }

    /// How far the shape is free along a direction from the centre, and where it first collides, as far as that is
    /// found within the time for it. Ends early when nobody waits for the answer any more: when another such question
    /// has come, or `is_gone`.
    ///
    /// # Errors
    /// When the direction has not one finite number for each mode, or the search ended before it found anything.
    pub fn safe_scale(
        &self,
        request: &DirectionRequest,
        is_gone: &(dyn Fn() -> bool + Sync),
    ) -> Result<DirectionAnswer, ViewError> {
        let number = self.latest.fetch_add(1, Ordering::Relaxed) + 1;
        let long = locked(&self.long);
        let is_wanted = || self.latest.load(Ordering::Relaxed) == number && !is_gone();
        let end = Instant::now() + Duration::from_secs(LONGEST);
        let patience =
            Patience { all: self.progress, is_over: &|| Instant::now() >= end, is_wanted: &is_wanted };
        let query = long.certified.clone().cancelled_by(&patience);
        collision::along(query, self.model, self.certificates, request, &patience)
    }

    /// The hierarchy.
    pub fn nodes(&self) -> NodesAnswer {
        nodes::all(self.certificates)
    }

    /// The boxes of a level at q.
    ///
    /// # Errors
    /// As [`Live::check`], and where there is no such level.
    pub fn boxes(&self, request: &BoxesRequest) -> Result<BoxesAnswer, ViewError> {
        nodes::boxes(self.model, self.certificates, request)
    }

    /// A motion as a binary glTF file.
    ///
    /// # Errors
    /// When there are too many frames, times do not ascend, or a q has not one finite number for each mode.
    pub fn animation(&self, request: &AnimationRequest) -> Result<Vec<u8>, ViewError> {
        // One at a time: it may take hundreds of megabytes.
        let _turn = locked(&self.long);
        let name = self.scene.models.first().map_or("model", |model| model.name());
        animation::glb(name, self.model, request)
    }
}

/// What a thread that ended in a panic has left is only scratch: the next query begins anew.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
