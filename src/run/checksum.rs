//! The checksum of checkpoints, a CRC-32.

/// CRC remainders: `REMAINDERS[k][b]` is the remainder of byte b followed by k zero bytes.
static REMAINDERS: [[u32; 256]; 8] = remainders();

const fn remainders() -> [[u32; 256]; 8] {
    let mut of = [[0; 256]; 8];
    let mut entry = 0;
    while entry < 8 * 256 {
        let (zeros, byte) = (entry / 256, entry % 256);
        let mut rest = if zeros == 0 { byte as u32 } else { of[zeros - 1][byte] };
        let mut bit = 0;
        while bit < 8 {
            rest = (rest >> 1) ^ (0xEDB8_8320 * (rest & 1));
            bit += 1;
        }
        of[zeros][byte] = rest;
        entry += 1;
    }
    of
}

/// Returns the CRC-32 of gzip and PNG, eight bytes at a time.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let (words, rest) = bytes.as_chunks::<8>();
    let sum = words.iter().fold(!0, |sum: u32, word| {
        let mixed = u64::from_le_bytes(*word) ^ u64::from(sum);
        let bytes = mixed.to_le_bytes().into_iter().zip(REMAINDERS.iter().rev());
        bytes.fold(0, |sum, (byte, of)| sum ^ of[usize::from(byte)])
    });
    let add = |sum: u32, byte: &u8| (sum >> 8) ^ REMAINDERS[0][usize::from(sum as u8 ^ byte)];
    !rest.iter().fold(sum, add)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_gzip() {
        assert_eq!(crc32(b""), 0);
        assert_eq!(crc32(b"a"), 0xE8B7_BE43);
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(crc32(b"The quick brown fox jumps over the lazy dog"), 0x414F_A339);
        assert_eq!(crc32(&[0; 32]), 0x190A_55AD);
        assert_eq!(crc32(&[0xFF; 32]), 0xFF6C_AB0B);
    }
}
