//! A value that somebody will be called back with, once.

#[cfg(target_arch = "wasm32")]
pub(super) use awaited::Answer;
#[cfg(not(target_arch = "wasm32"))]
pub(super) use blocking::Answer;

/// Between threads.
#[cfg(not(target_arch = "wasm32"))]
mod blocking {
    use std::sync::{Arc, Condvar, Mutex, PoisonError};
    use std::time::Duration;

    #[derive(Debug)]
    pub(in super::super) struct Answer<T>(Arc<(Mutex<Option<T>>, Condvar)>);

    impl<T> Default for Answer<T> {
        fn default() -> Self {
            Self(Arc::default())
        }
    }

    impl<T> Clone for Answer<T> {
        fn clone(&self) -> Self {
            Self(Arc::clone(&self.0))
        }
    }

    impl<T> Answer<T> {
        pub(in super::super) fn give(&self, value: T) {
            *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(value);
            self.0.1.notify_all();
        }

        /// Waits for it, but no longer than `timeout`.
        pub(in super::super) fn within(&self, timeout: Duration) -> Option<T> {
            let value = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
            let waited = self.0.1.wait_timeout_while(value, timeout, |value| value.is_none());
            waited.unwrap_or_else(PoisonError::into_inner).0.take()
        }
    }
}

/// On one thread, which must go back to the browser for it.
#[cfg(target_arch = "wasm32")]
mod awaited {
    use std::pin::Pin;
    use std::sync::{Arc, Mutex, PoisonError};
    use std::task::{Context, Poll, Waker};

    #[derive(Debug)]
    pub(in super::super) struct Answer<T>(Arc<Mutex<(Option<T>, Option<Waker>)>>);

    impl<T> Default for Answer<T> {
        fn default() -> Self {
            Self(Arc::new(Mutex::new((None, None))))
        }
    }

    impl<T> Clone for Answer<T> {
        fn clone(&self) -> Self {
            Self(Arc::clone(&self.0))
        }
    }

    impl<T> Answer<T> {
        pub(in super::super) fn give(&self, value: T) {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            state.0 = Some(value);
            let waker = state.1.take();
            drop(state);
            if let Some(waker) = waker {
                waker.wake();
            }
        }
    }

    impl<T> Future for Answer<T> {
        type Output = T;

        fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<T> {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            match state.0.take() {
                Some(value) => Poll::Ready(value),
                None => {
                    state.1 = Some(context.waker().clone());
                    Poll::Pending
                }
            }
        }
    }
}
