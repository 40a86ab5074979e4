//! Work on several threads, with the feature `parallel`; without it, and in WebAssembly, everything runs on the calling thread.
//! Results are the same.

/// Runs `work` with a number of threads, `None` for all cores.
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    return on_pool(rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build(), work);
    #[cfg(not(all(feature = "parallel", not(target_family = "wasm"))))]
    {
        let _ = threads;
        work()
    }
}

#[cfg(all(feature = "parallel", not(target_family = "wasm")))]
std::thread_local! {
    /// Whether this thread does all work alone, because the system refused it threads.
    static IS_ALONE: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Runs `work` on a pool, or on this thread alone if the system refused the pool's threads.
#[cfg(all(feature = "parallel", not(target_family = "wasm")))]
fn on_pool<T: Send>(
    pool: Result<rayon::ThreadPool, rayon::ThreadPoolBuildError>,
    work: impl FnOnce() -> T + Send,
) -> T {
    /// Restores the state of the thread, also after a panic.
    struct Restore(bool);
    impl Drop for Restore {
        fn drop(&mut self) {
            IS_ALONE.set(self.0);
        }
    }
    match pool {
        Ok(pool) => pool.install(work),
        // Without a pool, rayon would start the threads of its global one, and panic if the system refuses these, too.
        Err(_) => {
            let _restore = Restore(IS_ALONE.replace(true));
            work()
        }
    }
}

/// Maps items on the threads of the current pool. The results are in the order of the items.
pub(crate) fn map<I: Send, R: Send>(
    items: impl IntoIterator<Item = I>,
    f: impl Fn(I) -> R + Sync + Send,
) -> Vec<R> {
    map_with(items, usize::MAX, || (), |(), item| f(item))
}

/// Maps items like [`map`], with scratch. Where there are threads, each piece of at most `grain` items has scratch of its own.
pub(crate) fn map_with<I: Send, S, R: Send>(
    items: impl IntoIterator<Item = I>,
    grain: usize,
    scratch: impl Fn() -> S + Sync + Send,
    f: impl Fn(&mut S, I) -> R + Sync + Send,
) -> Vec<R> {
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    if !IS_ALONE.get() {
        use rayon::prelude::*;
        let items: Vec<I> = items.into_iter().collect();
        return items.into_par_iter().with_max_len(grain).map_init(scratch, f).collect();
    }
    let (_, mut scratch) = (grain, scratch());
    items.into_iter().map(|item| f(&mut scratch, item)).collect()
}

/// Runs two functions, at the same time where there are threads.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    if !IS_ALONE.get() {
        return rayon::join(a, b);
    }
    (a(), b())
}

#[cfg(all(test, feature = "parallel", not(target_family = "wasm")))]
mod tests {
    use std::collections::HashSet;
    use std::io;
    use std::thread::{self, ThreadId};

    use super::*;

    /// Returns the error of a pool whose threads the system refuses.
    fn refused() -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
        let refuse = |_| Err(io::Error::from(io::ErrorKind::OutOfMemory));
        rayon::ThreadPoolBuilder::new().num_threads(3).spawn_handler(refuse).build()
    }

    #[test]
    fn this_thread_does_all_work_if_the_system_refuses_threads() {
        let calls = || {
            assert!(refused().is_err());
            for _ in 0..3 {
                let work = || {
                    let (a, b) = join(|| thread::current().id(), || thread::current().id());
                    let all: Vec<ThreadId> = map(0..1000, |_| thread::current().id());
                    all.into_iter().chain([a, b]).collect::<HashSet<ThreadId>>()
                };
                assert_eq!(on_pool(refused(), work), HashSet::from([thread::current().id()]));
                assert!(!IS_ALONE.get());
                assert_eq!(on_threads(Some(2), || map(0..9, |i| i * i)), [0, 1, 4, 9, 16, 25, 36, 49, 64]);
            }
        };
        thread::spawn(calls).join().unwrap();
    }
}
