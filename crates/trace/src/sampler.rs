//! Low-discrepancy numbers: Owen-scrambled Sobol points, one stream a pixel.

/// Uniform numbers of one sample of one pixel, in pairs of the first two Sobol dimensions; every pair is scrambled and its
/// order shuffled anew [Burley2020]. The same pixel, sample and seed give the same numbers, on any thread.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    /// The index with its bits in reverse.
    index: u32,
    seed: u32,
    /// Pairs taken.
    pub(crate) taken: u32,
    /// What the numbers of later pairs hang on.
    key: u32,
}

impl Sampler {
    /// The numbers of sample `index` of pixel `pixel`.
    #[inline]
    pub fn new(seed: u64, pixel: u32, index: u32) -> Self {
        let seed = hash((seed ^ (seed >> 32)) as u32 ^ hash(pixel.wrapping_mul(0x9e37_79b9)));
        Sampler {
            index: index.reverse_bits(),
            seed,
            taken: 0,
            key: hash(hash(index).wrapping_add(seed)),
        }
    }

    /// Numbers that have nothing to do with those still to come.
    #[inline(always)]
    pub(crate) fn forked(&self) -> Self {
        Sampler {
            seed: hash(self.seed ^ self.taken.wrapping_mul(0xc2b2_ae35)),
            key: hash(self.key ^ self.taken.wrapping_mul(0x27d4_eb2f)),
            ..*self
        }
    }

    /// The next number, in `[0, 1)`: the first of a pair.
    #[inline(always)]
    pub fn one(&mut self) -> f32 {
        self.two()[0]
    }

    /// The next two numbers, stratified together.
    #[inline(always)]
    pub fn two(&mut self) -> [f32; 2] {
        let k = self.taken;
        self.taken += 1;
        self.pair(k)
    }

    /// Pair `k`.
    #[inline(always)]
    pub(crate) fn pair(&self, k: u32) -> [f32; 2] {
        if k < EVEN_PAIRS {
            self.even(k)
        } else {
            self.random(k)
        }
    }

    /// Pair `k` of a scrambled Sobol sequence.
    #[inline(always)]
    pub(crate) fn even(&self, k: u32) -> [f32; 2] {
        let seed = hash(self.seed ^ k.wrapping_mul(0x85eb_ca6b));
        let index = scramble(self.index, seed).reverse_bits();
        [
            unit(scramble(index, seed.wrapping_mul(0x9e37_79b9) ^ 0x1234_5678).reverse_bits()),
            unit(scramble(second(index), seed.wrapping_mul(0x85eb_ca77) ^ 0x9abc_def1).reverse_bits()),
        ]
    }

    /// Pair `k` of numbers that have nothing to do with those of other samples: words that step on evenly, mixed
    /// [SteeleLeaFlood2014, with words of 32 bits].
    #[inline(always)]
    pub(crate) fn random(&self, k: u32) -> [f32; 2] {
        let first = self.key.wrapping_add((2 * k).wrapping_mul(0x9e37_79b9));
        [unit(hash(first)), unit(hash(first.wrapping_add(0x9e37_79b9)))]
    }
}

/// Pairs of dimensions of Sobol points, before random numbers begin, as evenness of later ones does little for the
/// picture: the pixel and the first scattering.
pub(crate) const EVEN_PAIRS: u32 = 4;

/// The second Sobol dimension before its bits are reversed: bit `i` is the sum of the bits of all indices that hold those
/// of `i`, by Pascal's triangle modulo 2 [Sobol1967].
#[inline(always)]
fn second(mut x: u32) -> u32 {
    x ^= x >> 16;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^ ((x >> 1) & 0x5555_5555)
}

/// Owen's scrambling of a number whose bits are in reverse: each bit is changed by those below it only
/// [LaineKarras2011; constants of Burley2020].
#[inline(always)]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// A well mixed word.
#[inline(always)]
pub(crate) fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0x735a_2d97);
    x ^ (x >> 15)
}

#[inline(always)]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_dimensions_has_one_point_in_every_elementary_cell() {
        for pixel in [0, 7] {
            let mut cells = vec![[0_u32; 256]; 9 * EVEN_PAIRS as usize];
            for index in 0..256 {
                let mut s = Sampler::new(3, pixel, index);
                for pair in 0..EVEN_PAIRS as usize {
                    let [x, y] = s.two();
                    for split in 0..9 {
                        let (nx, ny) = (1 << split, 256 >> split);
                        let cell = (x * nx as f32) as usize * ny + (y * ny as f32) as usize;
                        cells[pair * 9 + split][cell] += 1;
                    }
                }
            }
            assert!(cells.iter().all(|c| c.iter().all(|n| *n == 1)));
        }
    }

    #[test]
    fn other_pixels_and_other_pairs_are_not_correlated() {
        let n = 4096;
        let value = |pixel: u32, index: u32, pair: usize| {
            let mut s = Sampler::new(1, pixel, index);
            (0..=pair).map(|_| s.two()[0]).last().unwrap()
        };
        for (a, b) in [((0, 0), (1, 0)), ((0, 0), (0, 1)), ((5, 2), (6, 4))] {
            let sum: f64 = (0..n)
                .map(|k| f64::from((value(a.0, k, a.1) - 0.5) * (value(b.0, k, b.1) - 0.5)))
                .sum();
            let correlation = 12.0 * sum / f64::from(n);
            // standard deviation 1/64 for independent numbers
            assert!(correlation.abs() < 0.06, "{correlation}");
        }
    }
}
