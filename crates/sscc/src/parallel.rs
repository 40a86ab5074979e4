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

/// Whether work of this thread may use a pool: the pool to which the thread belongs, or the global one if the system allowed its
/// threads.
#[cfg(all(feature = "parallel", not(target_family = "wasm")))]
fn has_threads() -> bool {
    use std::error::Error;
    /// Whether the global pool has threads, which is asked once. Otherwise rayon panics when it is used.
    static HAS_GLOBAL: std::sync::LazyLock<bool> = std::sync::LazyLock::new(|| {
        let built = rayon::ThreadPoolBuilder::new().build_global();
        // An error without a source says that the pool was asked for before: it works, unless the system refused it then.
        built.err().is_none_or(|error| error.source().is_none())
    });
    !IS_ALONE.get() && (rayon::current_thread_index().is_some() || *HAS_GLOBAL)
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
    if has_threads() {
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
    if has_threads() {
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

    /// A process whose address space does not suffice for the stacks of the global pool.
    #[cfg(target_os = "linux")]
    #[test]
    fn this_thread_does_all_work_if_the_system_refuses_the_global_pool() {
        const IS_LIMITED: &str = "SSCC_TEST_OF_A_REFUSED_POOL";
        if std::env::var_os(IS_LIMITED).is_some() {
            let all: HashSet<ThreadId> = map(0..1000, |_| thread::current().id()).into_iter().collect();
            assert_eq!(all, HashSet::from([thread::current().id()]));
            assert_eq!(join(|| 1, || 2), (1, 2));
            return;
        }
        let name = "parallel::tests::this_thread_does_all_work_if_the_system_refuses_the_global_pool";
        let output = std::process::Command::new("sh")
            .args(["-c", "ulimit -v 500000; exec \"$0\" --exact \"$1\""])
            .args([std::env::current_exe().unwrap().as_os_str(), name.as_ref()])
            .env_remove("RUST_MIN_STACK")
            .envs([(IS_LIMITED, "1"), ("RAYON_NUM_THREADS", "600")])
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains("1 passed"), "{text}");
    }
}
