//! Certificates with their model and the queries by them, one for each thread that asks at the same time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, ThreadId};

use pyo3::prelude::*;
use self_cell::self_cell;
use sscc::{Certificates, Error, KineticQuery, Query};

use crate::interrupt::Signals;
use crate::model::Loaded;

/// What queries are asked of.
pub struct Certified {
    pub loaded: Arc<Loaded>,
    pub certificates: Certificates,
}

pub struct Queries<'a> {
    /// What the others are cloned from.
    first: Query<'a>,
    /// Those that nobody uses now.
    idle: Mutex<Vec<Query<'a>>>,
}

self_cell!(
    /// Certificates, and queries that borrow them.
    pub struct Pool {
        owner: Certified,

        #[not_covariant]
        dependent: Queries,
    }
);

impl Pool {
    /// Refuses certificates of another model.
    pub fn of(certified: Certified) -> Result<Self, Error> {
        Self::try_new(certified, |certified| {
            let first = Query::new(&certified.loaded.model, &certified.certificates)?.cancelled_by(&Signals);
            Ok(Queries { first, idle: Mutex::default() })
        })
    }

    /// Asks a query that nobody else uses meanwhile.
    #[inline]
    pub fn ask<T>(&self, ask: impl FnOnce(&mut Query<'_>) -> T) -> T {
        self.with_dependent(|_, queries| {
            let idle = lock(&queries.idle).pop();
            let mut query = idle.unwrap_or_else(|| queries.first.clone());
            let answer = ask(&mut query);
            lock(&queries.idle).push(query);
            answer
        })
    }

    /// Hands out the query that the others are cloned from.
    pub fn with_first<T>(&self, with: impl FnOnce(&Query<'_>) -> T) -> T {
        self.with_dependent(|_, queries| with(&queries.first))
    }
}

self_cell!(
    /// A query for small steps, and what it borrows.
    pub struct Kinetic {
        owner: Arc<Pool>,

        #[not_covariant]
        dependent: Steps,
    }
);

pub struct Steps<'a> {
    query: Mutex<KineticQuery<'a>>,
    /// The thread that asks it now.
    asker: Mutex<Option<ThreadId>>,
}

impl Kinetic {
    pub fn of(pool: Arc<Pool>) -> Result<Self, Error> {
        Self::try_new(pool, |pool| {
            let Certified { loaded, certificates } = pool.borrow_owner();
            let query = KineticQuery::new(&loaded.model, certificates)?.cancelled_by(&Signals);
            Ok(Steps { query: Mutex::new(query), asker: Mutex::default() })
        })
    }

    /// Asks it; who comes meanwhile waits. Not to be called with the GIL: who holds the query may wait for that. None
    /// if this thread is asking it already: what handles a signal would wait for itself.
    pub fn ask<T>(&self, ask: impl FnOnce(&mut KineticQuery<'_>) -> T) -> Option<T> {
        let here = Some(thread::current().id());
        self.with_dependent(|_, steps| {
            let mut query = match steps.query.try_lock() {
                Err(TryLockError::WouldBlock) if *lock(&steps.asker) == here => return None,
                Err(TryLockError::WouldBlock) => lock(&steps.query),
                Ok(query) => query,
                Err(TryLockError::Poisoned(query)) => query.into_inner(),
            };
            *lock(&steps.asker) = here;
            let answer = ask(&mut query);
            *lock(&steps.asker) = None;
            Some(answer)
        })
    }
}

/// A query that panicked begins anew with the next question.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How many threads, if anything was said.
pub fn threads(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    crate::arguments::count(threads, "threads", 1..=1024)
}

/// Works on so many threads (none: all cores), in a pool of its own, which a forked process can make anew.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}
