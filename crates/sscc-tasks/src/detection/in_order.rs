//! Work on several threads whose results are taken in order.

use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;
use std::thread;

/// Maximum number of results of a thread that wait for `take`, beside one that the thread itself holds. It bounds
/// memory.
const AHEAD: usize = 2;

/// Calls `work` for 0 to `count - 1` on threads, each with its own state, and `take` with each result in order, on the thread
/// of the caller. Thread t computes the items t, t + threads, ... If the system refuses a thread, the caller computes its items. Ends
/// early when `take` breaks or fails.
pub(super) fn in_order<S, T: Send, E>(
    count: usize,
    threads: usize,
    state: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> T + Sync,
    mut take: impl FnMut(usize, T) -> Result<ControlFlow<()>, E>,
) -> Result<ControlFlow<()>, E> {
    let threads = threads.min(count);
    if threads <= 1 {
        let mut state = state();
        for item in 0..count {
            if take(item, work(&mut state, item))?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        return Ok(ControlFlow::Continue(()));
    }
    thread::scope(|scope| {
        let start = |first: usize| {
            let (sender, receiver) = sync_channel(AHEAD);
            let (state, work) = (&state, &work);
            let items = move || {
                let mut state = state();
                // Without a receiver no further results are needed.
                (first..count).step_by(threads).all(|item| sender.send(work(&mut state, item)).is_ok())
            };
            thread::Builder::new().spawn_scoped(scope, items).ok().map(|_| receiver)
        };
        // The receivers are dropped at the end, before the scope waits for its threads.
        let receivers: Vec<_> = (0..threads).map(start).collect();
        let mut own = None;
        for item in 0..count {
            let result = match &receivers[item % threads] {
                Some(receiver) => receiver.recv(),
                None => Ok(work(own.get_or_insert_with(&state), item)),
            };
            // A thread that panicked sends nothing. The scope passes its panic on.
            let Ok(result) = result else { break };
            if take(item, result)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(count: usize, threads: usize, end: usize) -> (Vec<usize>, Result<ControlFlow<()>, usize>) {
        let mut taken = Vec::new();
        let result = in_order(
            count,
            threads,
            || 0,
            |calls, item| {
                *calls += 1;
                (item * item, *calls)
            },
            |item, (square, calls)| {
                assert_eq!(calls, item / threads.clamp(1, count) + 1);
                taken.push(square);
                if square >= 10 * end {
                    return Err(item);
                }
                Ok(if item == end { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
            },
        );
        (taken, result)
    }

    #[test]
    fn results_come_in_order_until_take_breaks_or_fails() {
        for threads in [0, 1, 2, 3, 7, 50] {
            let (taken, result) = squares(20, threads, 100);
            assert_eq!(taken, (0..20).map(|item| item * item).collect::<Vec<_>>());
            assert_eq!(result, Ok(ControlFlow::Continue(())));
            assert!(squares(0, threads, 100).0.is_empty());
            let (taken, result) = squares(1000, threads, 4);
            assert_eq!((taken.len(), result), (5, Ok(ControlFlow::Break(()))));
            assert_eq!(squares(1000, threads, 40).1, Err(20));
        }
    }
}
