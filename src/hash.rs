//! A 64-bit hash of words in order: for comparing pictures, sets and states across levels, threads and machines.

/// The hash so far. Not for adversaries: a multiply-rotate chain whose only purpose is that different sequences differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Hash(0x243F_6A88_85A3_08D3)
    }
}

impl Hash {
    /// Takes the next word.
    #[inline]
    pub fn add(&mut self, word: u64) {
        let x = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = x ^ x >> 29;
    }

    /// The value after all words.
    pub fn value(self) -> u64 {
        self.0
    }
}
