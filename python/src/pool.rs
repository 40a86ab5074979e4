//! Certificates with their model, and a query for each thread that uses them concurrently.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, ThreadId};

use pyo3::prelude::*;
use sscc::{Certificates, Error, KineticQuery, Query};

use crate::errors::value;
use crate::interrupt::signals;
use crate::model::LoadedModel;

/// A model and its certificates.
pub struct CertifiedModel {
    pub loaded: Arc<LoadedModel>,
    pub certificates: Certificates,
}

/// A model with its certificates, and their queries.
pub struct Pool {
    pub certified: CertifiedModel,
    /// The query from which the others are cloned.
    first: Query,
    /// Queries that are not in use.
    idle: Mutex<Vec<Query>>,
}

impl Pool {
    /// Creates a pool. Refuses certificates of another model.
    pub fn of(certified: CertifiedModel) -> Result<Self, Error> {
        let CertifiedModel { loaded, certificates } = &certified;
        let first = Query::new(&loaded.model, certificates)?.cancelled_by(signals().clone());
        Ok(Self { certified, first, idle: Mutex::default() })
    }

    /// Runs a function on a query that no other thread uses.
    #[inline]
    pub fn with_query<T>(&self, with: impl FnOnce(&mut Query) -> T) -> T {
        let idle = lock(&self.idle).pop();
        let mut query = idle.unwrap_or_else(|| self.first.clone());
        let answer = with(&mut query);
        lock(&self.idle).push(query);
        answer
    }

    /// Returns the query from which the others are cloned.
    pub fn first(&self) -> &Query {
        &self.first
    }
}

/// A kinetic query and its pool.
pub struct Kinetic {
    pub pool: Arc<Pool>,
    query: Mutex<KineticQuery>,
    /// The thread that uses the query now.
    user: Mutex<Option<ThreadId>>,
}

impl Kinetic {
    pub fn of(pool: Arc<Pool>) -> Result<Self, Error> {
        let CertifiedModel { loaded, certificates } = &pool.certified;
        let query = KineticQuery::new(&loaded.model, certificates)?.cancelled_by(signals().clone());
        Ok(Self { pool, query: Mutex::new(query), user: Mutex::default() })
    }

    /// Runs a function on the query; other threads wait meanwhile. Returns `None` if this thread already uses the
    /// query: a signal handler would wait for its own thread. Call it without the GIL, because the thread that uses the
    /// query may wait for the GIL.
    pub fn with_query<T>(&self, with: impl FnOnce(&mut KineticQuery) -> T) -> Option<T> {
        let here = Some(thread::current().id());
        let mut query = match self.query.try_lock() {
            Err(TryLockError::WouldBlock) if *lock(&self.user) == here => return None,
            Err(TryLockError::WouldBlock) => lock(&self.query),
            Ok(query) => query,
            Err(TryLockError::Poisoned(query)) => query.into_inner(),
        };
        *lock(&self.user) = here;
        let answer = with(&mut query);
        *lock(&self.user) = None;
        Some(answer)
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

/// Starts the threads of work that uses rayon (`None` means all cores), because a forked process cannot use the global pool.
///
/// # Errors
/// When the system refuses them.
pub fn start(threads: Option<usize>) -> PyResult<rayon::ThreadPool> {
    let started = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    started.map_err(|error| value(format!("threads: the system refuses so many: {error}; choose fewer")))
}
