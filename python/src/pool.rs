//! Certificates with their model, and a query for each thread that uses them concurrently.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, ThreadId};

use pyo3::prelude::*;
use self_cell::self_cell;
use sscc::{Certificates, Error, KineticQuery, Query};

use crate::interrupt::Signals;
use crate::model::LoadedModel;

/// A model and its certificates, which queries borrow.
pub struct CertifiedModel {
    pub loaded: Arc<LoadedModel>,
    pub certificates: Certificates,
}

pub struct Queries<'a> {
    /// The query from which the others are cloned.
    first: Query<'a>,
    /// Queries that are not in use.
    idle: Mutex<Vec<Query<'a>>>,
}

self_cell!(
    /// Certificates, and queries that borrow them.
    pub struct Pool {
        owner: CertifiedModel,

        #[not_covariant]
        dependent: Queries,
    }
);

impl Pool {
    /// Refuses certificates of another model.
    pub fn of(certified: CertifiedModel) -> Result<Self, Error> {
        Self::try_new(certified, |certified| {
            let first = Query::new(&certified.loaded.model, &certified.certificates)?.cancelled_by(&Signals);
            Ok(Queries { first, idle: Mutex::default() })
        })
    }

    /// Runs a function on a query that no other thread uses.
    #[inline]
    pub fn with_query<T>(&self, with: impl FnOnce(&mut Query<'_>) -> T) -> T {
        self.with_dependent(|_, queries| {
            let idle = lock(&queries.idle).pop();
            let mut query = idle.unwrap_or_else(|| queries.first.clone());
            let answer = with(&mut query);
            lock(&queries.idle).push(query);
            answer
        })
    }

    /// Runs a function on the query from which the others are cloned.
    pub fn with_first<T>(&self, with: impl FnOnce(&Query<'_>) -> T) -> T {
        self.with_dependent(|_, queries| with(&queries.first))
    }
}

self_cell!(
    /// A kinetic query and its pool.
    pub struct Kinetic {
        owner: Arc<Pool>,

        #[not_covariant]
        dependent: KineticState,
    }
);

pub struct KineticState<'a> {
    query: Mutex<KineticQuery<'a>>,
    /// The thread that uses the query now.
    user: Mutex<Option<ThreadId>>,
}

impl Kinetic {
    pub fn of(pool: Arc<Pool>) -> Result<Self, Error> {
        Self::try_new(pool, |pool| {
            let CertifiedModel { loaded, certificates } = pool.borrow_owner();
            let query = KineticQuery::new(&loaded.model, certificates)?.cancelled_by(&Signals);
            Ok(KineticState { query: Mutex::new(query), user: Mutex::default() })
        })
    }

    /// Runs a function on the query; other threads wait meanwhile. Returns `None` if this thread already uses the
    /// query: a signal handler would wait for its own thread. Call it without the GIL, because the thread that uses the
    /// query may wait for the GIL.
    pub fn with_query<T>(&self, with: impl FnOnce(&mut KineticQuery<'_>) -> T) -> Option<T> {
        let here = Some(thread::current().id());
        self.with_dependent(|_, state| {
            let mut query = match state.query.try_lock() {
                Err(TryLockError::WouldBlock) if *lock(&state.user) == here => return None,
                Err(TryLockError::WouldBlock) => lock(&state.query),
                Ok(query) => query,
                Err(TryLockError::Poisoned(query)) => query.into_inner(),
            };
            *lock(&state.user) = here;
            let answer = with(&mut query);
            *lock(&state.user) = None;
            Some(answer)
        })
    }
}

/// Locks a mutex, also after a panic: each query initialises its state.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the number of threads; `None` for an absent argument.
pub fn threads(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    crate::arguments::count(threads, "threads", 1..=1024)
}

/// Runs work on this number of threads (`None`: all cores), in a pool of its own: a forked process cannot use the
/// global pool.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}
