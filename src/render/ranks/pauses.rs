//! Exponential back-off while polling.

use std::time::Duration;

const FIRST: Duration = Duration::from_micros(10);
const LONGEST: Duration = Duration::from_millis(1);

/// Sleeps of a thread that waits for something: each is twice as long as the one before, up to a
/// millisecond, so that short waits end soon and long ones take no time from other threads.
pub(super) struct Pauses(Duration);

impl Pauses {
    pub(super) fn new() -> Self {
        Self(FIRST)
    }

    pub(super) fn sleep(&mut self) {
        std::thread::sleep(self.0);
        self.0 = LONGEST.min(2 * self.0);
    }
}
