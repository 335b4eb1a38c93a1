//! Where band jobs run: in the caller's thread, or on a pool that the program owns. Never the global pool.

use crate::error::{Error, Result};

/// A number of threads, and the pool if there is more than one.
pub struct Workers {
    threads: usize,
    #[cfg(feature = "parallel")]
    pool: Option<rayon::ThreadPool>,
}

impl Workers {
    /// Workers for `threads` threads, 1 to 256.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the number is out of range, when threads cannot be started, or when more than one is asked of a
    /// build without the feature `parallel`.
    pub fn new(threads: usize) -> Result<Workers> {
        let fail = |reason: String| Error::parameter("threads", threads, reason);
        if !(1..=256).contains(&threads) {
            return Err(fail("1 to 256".into()));
        }
        #[cfg(feature = "parallel")]
        {
            let build =
                || rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| fail(e.to_string()));
            Ok(Workers { threads, pool: if threads > 1 { Some(build()?) } else { None } })
        }
        #[cfg(not(feature = "parallel"))]
        if threads == 1 {
            Ok(Workers { threads })
        } else {
            Err(fail("1 in a build without the feature 'parallel'".into()))
        }
    }

    /// How many threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// How many bands to cut a screen into: more than threads, so that uneven ones even out; one for one thread.
    pub fn bands(&self) -> usize {
        if self.threads == 1 { 1 } else { 3 * self.threads }
    }

    /// Runs every job.
    pub fn run<J: Send>(&self, jobs: &mut [J], run: impl Fn(&mut J) + Sync + Send) {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            use rayon::prelude::*;
            return pool.install(|| jobs.par_iter_mut().with_max_len(1).for_each(run));
        }
        jobs.iter_mut().for_each(run);
    }
}
