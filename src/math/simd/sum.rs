//! Sums numbers: reads memory as the kernels do with next to no arithmetic, to measure the
//! bandwidth that they can reach.

use super::Simd;
use super::lanes::{InstructionSet, Lanes, N_LANES, SimdKernel};

/// Independent sums: no addition waits for the one before.
const N_SUMS: usize = 8;

impl Simd {
    /// Returns the sum of the numbers, in unspecified order. Ignores the numbers after the last
    /// multiple of 64.
    ///
    /// ```
    /// # use raycost_math::simd::Simd;
    /// assert_eq!(Simd::best().sum(&[0.5; 640]), 320.0);
    /// ```
    pub fn sum(self, numbers: &[f32]) -> f32 {
        self.run(Sum(numbers))
    }
}

struct Sum<'a>(&'a [f32]);

impl SimdKernel for Sum<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> f32 {
        let mut sums = [set.splat(0.0); N_SUMS];
        for numbers in self.0.as_chunks::<{ N_SUMS * N_LANES }>().0 {
            for (sum, eight) in sums.iter_mut().zip(numbers.as_chunks().0) {
                *sum = *sum + set.load(eight);
            }
        }
        // A tree, not a chain of 64 additions: callers sum many short blocks.
        let [a, b, c, d, e, f, g, h] = sums;
        let sum = ((a + b) + (c + d)) + ((e + f) + (g + h));
        sum.to_array().iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sets_read_every_number() {
        let numbers: Vec<f32> = (0..1000).map(|i| (i % 37) as f32).collect();
        let whole = 1000 / 64 * 64;
        let plain: f32 = numbers[..whole].iter().sum();
        for simd in Simd::available() {
            assert_eq!(simd.sum(&numbers), plain, "{simd}");
        }
    }
}
