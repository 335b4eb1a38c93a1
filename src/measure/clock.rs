//! The core's clock, measured beside every timed figure, so that times can be turned into cycles.
//!
//! A virtual machine's nominal frequency is rarely the one it runs at, and turbo moves it from
//! minute to minute. One measurement is a chain of dependent operations of known latency: a step is
//! an addition and an exclusive or, both on registers, each of which takes **one cycle** on every
//! x86-64 and 64-bit ARM core and cannot start before the other is done; a step costs **two
//! cycles**. The two operands are hidden from the optimizer, and neither operation distributes over
//! the other, so the chain cannot be shortened; immediates are avoided because recent cores
//! resolve their addition for nothing at renaming. The loop's own counter runs beside the chain.
//!
//! Checked on a Sapphire Rapids server against chains of `imul` (three cycles each) timed beside
//! it: within 2 percent.
//!
//! The fastest of forty short runs is taken: whatever disturbs a run makes it look slower, never
//! faster. One call takes about a millisecond. Meaningful only in optimized builds.

use std::hint::black_box;
use std::time::Instant;

/// Steps of one run: about 20 microseconds at 3 GHz.
const STEPS_PER_RUN: u32 = 30_000;
/// Runs, of which the fastest counts.
const RUNS: u32 = 40;
/// An addition and an exclusive or, one cycle each.
const CYCLES_PER_STEP: f64 = 2.0;

/// The frequency in GHz at which this core works through dependent operations now.
///
/// Of no use to decide anything: it is written beside times and nothing else. Zero if the system's
/// clock did not advance during any run.
pub fn clock_ghz() -> f64 {
    let fastest_s = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            black_box(chain(black_box(1), STEPS_PER_RUN));
            start.elapsed().as_secs_f64()
        })
        .filter(|&seconds| seconds > 0.0)
        .min_by(f64::total_cmp);
    fastest_s.map_or(0.0, |seconds| f64::from(STEPS_PER_RUN) * CYCLES_PER_STEP / seconds / 1e9)
}

/// `steps` steps, each of which needs the result of the one before.
#[inline(never)]
fn chain(start: u64, steps: u32) -> u64 {
    let addend = black_box(0x9e37_79b9_7f4a_7c15u64);
    let mask = black_box(0xd1b5_4a32_d192_ed03u64);
    let (mut x, mut left) = (start, steps);
    // An iterator's steps would be calls where optimization is low.
    while left > 0 {
        x = x.wrapping_add(addend) ^ mask;
        left -= 1;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_takes_time_in_proportion_to_its_length() {
        let fastest = |steps| {
            (0..50)
                .map(|_| {
                    let start = Instant::now();
                    black_box(chain(black_box(1), steps));
                    start.elapsed().as_secs_f64()
                })
                .fold(f64::INFINITY, f64::min)
        };
        let ratio = fastest(40_000) / fastest(10_000);
        assert!((3.0..5.0).contains(&ratio), "four times the steps took {ratio} times as long");
    }

    #[test]
    fn the_clock_is_one_that_exists() {
        let ghz = clock_ghz();
        if cfg!(miri) {
            return;
        }
        assert!((0.3..8.0).contains(&ghz), "{ghz} GHz");
    }
}
