//! Arrays of vectors, element by element.
//!
//! Kernels must be inlined into the function that enables their instructions, down to the last call. Closures, and with
//! them `array::map` and `array::from_fn`, are inlined only when the compiler feels like it; these macros always are.

/// `[f(0), f(1), ...]` for a literal number of elements: `each!(3, q => expression in q)`.
macro_rules! each {
    (2, $q:ident => $e:expr) => { [{ let $q = 0usize; $e }, { let $q = 1usize; $e }] };
    (3, $q:ident => $e:expr) => { [{ let $q = 0usize; $e }, { let $q = 1usize; $e }, { let $q = 2usize; $e }] };
    (4, $q:ident => $e:expr) => {
        [{ let $q = 0usize; $e }, { let $q = 1usize; $e }, { let $q = 2usize; $e }, { let $q = 3usize; $e }]
    };
    (5, $q:ident => $e:expr) => {
        [{ let $q = 0usize; $e }, { let $q = 1usize; $e }, { let $q = 2usize; $e }, { let $q = 3usize; $e }, { let $q = 4usize; $e }]
    };
}

pub(crate) use each;
