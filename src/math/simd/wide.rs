//! Registers for packets: sixteen lanes where the CPU has them, else eight.

use super::real::Arithmetic;

/// The numbers of a packet of sixteen rays, in two halves.
pub type Sixteen = [[f32; 8]; 2];

/// The numbers of a part of a packet, in one register.
pub trait Wide: Arithmetic {
    /// Number of parts of a packet.
    const N_PARTS: usize;
    /// Returns the bits: bit `i` for lane `i`.
    fn bits(mask: Self::Mask) -> u16;
    /// Returns the next greater number of each; they must be finite and not negative.
    fn next_up(self) -> Self;
    /// Returns the numbers; eight fill the first half.
    fn to_arrays(self) -> Sixteen;
    /// Stores this part of a packet's numbers.
    #[inline(always)]
    fn store(self, numbers: &mut Sixteen, part: usize) {
        if Self::N_PARTS == 1 {
            *numbers = self.to_arrays();
        } else {
            numbers[part] = self.to_arrays()[0];
        }
    }
}
