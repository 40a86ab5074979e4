//! Work on several threads, with the feature `parallel`; without it, and in WebAssembly, everything runs on the calling thread.
//! Results are the same.

/// Runs `work` with a number of threads, `None` for all cores.
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        return pool.install(work);
    }
    // There are no threads, or the system grants no more.
    let _ = threads;
    work()
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
    let items: Vec<I> = items.into_iter().collect();
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    {
        use rayon::prelude::*;
        items.into_par_iter().with_max_len(grain).map_init(scratch, f).collect()
    }
    #[cfg(not(all(feature = "parallel", not(target_family = "wasm"))))]
    {
        let (_, mut scratch) = (grain, scratch());
        items.into_iter().map(|item| f(&mut scratch, item)).collect()
    }
}

/// Runs two functions, at the same time where there are threads.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(all(feature = "parallel", not(target_family = "wasm")))]
    return rayon::join(a, b);
    #[cfg(not(all(feature = "parallel", not(target_family = "wasm"))))]
    (a(), b())
}
