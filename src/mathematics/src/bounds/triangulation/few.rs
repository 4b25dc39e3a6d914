//! Numbers of few nodes or cells, found faster than in a list.

/// No key.
const NONE: u32 = u32::MAX;

/// Numbers with keys, each near the place that the last bits of the key say.
#[derive(Default)]
pub(super) struct FewNumbers {
    /// Keys with their numbers, and [`NONE`]; a power of two, more than half of which are free.
    entries: Vec<[u32; 2]>,
}

impl FewNumbers {
    /// Forgets all, and makes room for so many.
    pub(super) fn clear(&mut self, most: usize) {
        self.entries.clear();
        self.entries.resize((2 * most + 2).next_power_of_two(), [NONE; 2]);
    }

    /// Number of a key, which is this one if the key is new.
    #[inline(always)]
    pub(super) fn number_or(&mut self, key: u32, new: u32) -> u32 {
        let last = self.entries.len() - 1;
        let mut place = key as usize & last;
        loop {
            let entry = &mut self.entries[place & last];
            if entry[0] == NONE {
                *entry = [key, new];
            }
            if entry[0] == key {
                return entry[1];
            }
            place += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_the_same_last_bits_keep_their_numbers() {
        let mut numbers = FewNumbers::default();
        for _ in 0..2 {
            numbers.clear(5);
            let keys = [7, 23, 39, 55, 71];
            keys.iter()
                .zip(0..)
                .for_each(|(&key, new)| assert_eq!(numbers.number_or(key, new), new));
            keys.iter().zip(0..).for_each(|(&key, old)| assert_eq!(numbers.number_or(key, 9), old));
        }
    }
}
