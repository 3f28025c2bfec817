//! Binary decisions as bytes: range coding \[Martin1979\] with probabilities that adapt \[WittenNealCleary1987\].

/// Bits of a probability.
const BITS: u32 = 16;
/// Below this the range takes up another byte.
const TOP: u32 = 1 << 24;

/// The probability of a 0 after what was seen: the mean of one that follows quickly and one that follows slowly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance {
    quick: u16,
    slow: u16,
}

impl Chance {
    pub(super) const EVEN: Chance = Chance {
        quick: 1 << (BITS - 1),
        slow: 1 << (BITS - 1),
    };

    /// Probability of a 0 of `1 << BITS`, never 0 or 1.
    fn of_zero(self) -> u32 {
        ((u32::from(self.quick) + u32::from(self.slow)) >> 1).clamp(64, (1 << BITS) - 64)
    }

    fn learn(&mut self, bit: bool) {
        for (value, rate) in [(&mut self.quick, 4), (&mut self.slow, 7)] {
            if bit {
                *value -= *value >> rate;
            } else {
                *value += (u16::MAX - *value) >> rate;
            }
        }
    }
}

/// What codes or decodes decisions, so that one description of a stream serves both.
pub(super) trait Coder {
    /// Codes `bit`, or decodes one (`bit` does not count then), with a probability that learns from it.
    fn bit(&mut self, chance: &mut Chance, bit: bool) -> bool;
}

/// Decisions to bytes.
pub(super) struct Encoder {
    low: u64,
    range: u32,
    /// Byte that a carry may still change, and how many of 255 follow it.
    held: u8,
    full: usize,
    first: bool,
    bytes: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Encoder {
            low: 0,
            range: u32::MAX,
            held: 0,
            full: 0,
            first: true,
            bytes: Vec::new(),
        }
    }

    fn shift(&mut self) {
        let carry = (self.low >> 32) as u8;
        if self.low < 0xFF00_0000 || carry == 1 {
            if !self.first {
                self.bytes.push(self.held.wrapping_add(carry));
            }
            self.bytes
                .extend(std::iter::repeat_n(0xFF_u8.wrapping_add(carry), self.full));
            self.full = 0;
            self.first = false;
            self.held = (self.low >> 24) as u8;
        } else {
            self.full += 1;
        }
        self.low = (self.low & 0x00FF_FFFF) << 8;
    }

    /// The bytes, zeros at the end left off.
    pub(super) fn finish(mut self) -> Vec<u8> {
        for _ in 0..5 {
            self.shift();
        }
        while self.bytes.last() == Some(&0) {
            self.bytes.pop();
        }
        self.bytes
    }
}

impl Coder for Encoder {
    fn bit(&mut self, chance: &mut Chance, bit: bool) -> bool {
        let bound = (self.range >> BITS) * chance.of_zero();
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        chance.learn(bit);
        while self.range < TOP {
            self.range <<= 8;
            self.shift();
        }
        bit
    }
}

/// Bytes to decisions; past the end of the bytes there are zeros.
pub(super) struct Decoder<'a> {
    bytes: &'a [u8],
    at: usize,
    code: u32,
    range: u32,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Decoder {
            bytes,
            at: 0,
            code: 0,
            range: u32::MAX,
        };
        for _ in 0..4 {
            decoder.take();
        }
        decoder
    }

    fn take(&mut self) {
        let byte = self.bytes.get(self.at).copied().unwrap_or(0);
        self.code = (self.code << 8) | u32::from(byte);
        self.at += 1;
    }

    /// Whether all bytes were read.
    pub(super) fn is_whole(&self) -> bool {
        self.at >= self.bytes.len()
    }
}

impl Coder for Decoder<'_> {
    fn bit(&mut self, chance: &mut Chance, _bit: bool) -> bool {
        let bound = (self.range >> BITS) * chance.of_zero();
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        chance.learn(bit);
        while self.range < TOP {
            self.range <<= 8;
            self.take();
        }
        bit
    }
}
