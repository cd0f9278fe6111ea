//! Filters of rows: differences, which compress better.

/// Differences to the pixel on the left.
const SUB: u8 = 1;
/// Differences to the row above.
const UP: u8 = 2;

/// The filtered rows, each after the number of its filter: the one whose differences
/// are smaller. The first row of a picture has zeros above.
pub(super) fn filtered(above: Option<&[u8]>, rows: &[&[u8]], pixel_bytes: usize) -> Vec<u8> {
    let width = rows.first().map_or(0, |row| row.len());
    let zeros = vec![0; width];
    let mut above = above.unwrap_or(&zeros);
    let mut filtered = Vec::with_capacity(rows.len() * (width + 1));
    for &row in rows {
        if row == above {
            // Rows of a magnified picture repeat.
            filtered.push(UP);
            filtered.resize(filtered.len() + width, 0);
            continue;
        }
        let (first, others) = row.split_at(pixel_bytes.min(width));
        if size_of_differences(others, row) < size_of_differences(row, above) {
            filtered.push(SUB);
            filtered.extend_from_slice(first);
            filtered.extend(differences(others, row));
        } else {
            filtered.push(UP);
            filtered.extend(differences(row, above));
        }
        above = row;
    }
    filtered
}

fn differences(bytes: &[u8], others: &[u8]) -> impl Iterator<Item = u8> {
    let pairs = bytes.iter().zip(others);
    pairs.map(|(byte, other)| byte.wrapping_sub(*other))
}

/// The sum of all differences, as signed bytes without their signs.
fn size_of_differences(bytes: &[u8], others: &[u8]) -> u64 {
    // Sums of 255 bytes fit into 16 bits, of which a register has many.
    let parts = bytes.chunks(255).zip(others.chunks(255));
    let sizes = parts.map(|(bytes, others)| {
        let sizes = differences(bytes, others).map(|difference| (difference as i8).unsigned_abs());
        u64::from(sizes.map(u16::from).sum::<u16>())
    });
    sizes.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_differences_are_kept() {
        let rows: [&[u8]; 3] = [
            &[9, 9, 9, 9, 9, 9],
            &[9, 9, 9, 9, 9, 8],
            &[90, 0, 7, 90, 0, 7],
        ];
        let expected = [
            [1, 9, 9, 9, 0, 0, 0],
            [2, 0, 0, 0, 0, 0, 255],
            [1, 90, 0, 7, 0, 0, 0],
        ];
        assert_eq!(filtered(None, &rows, 3), expected.concat());
        assert_eq!(filtered(Some(rows[0]), &rows[1..2], 3), expected[1]);
    }

    #[test]
    fn differences_are_summed_without_their_signs() {
        let size = |bytes| size_of_differences(bytes, &[0; 1000]);
        assert_eq!(size(&[0, 1, 255, 128, 127]), 1 + 1 + 128 + 127);
        assert_eq!(size(&[128; 1000]), 128_000);
    }
}
