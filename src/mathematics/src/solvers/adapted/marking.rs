//! Choice of the cells to be refined, after Dörfler: those with the largest parts of the error, until they have a
//! fraction of its square.

/// Bits of a positive number by which numbers are sorted into bins: the exponent and some of the mantissa. Numbers of
/// one bin differ by less than one part in 64.
const SHIFT: u32 = 46;
const BINS: usize = 1 << (63 - SHIFT);

/// Returns the least number of cells, by increasing numbers, whose squares sum to at least a fraction of all; of equal
/// squares those of the cells with lower numbers. A square that is no positive number counts as zero.
pub(super) fn largest_parts(squares: &[f64], fraction: f64) -> Vec<u32> {
    let bin = |square: f64| if square > 0.0 { (square.to_bits() >> SHIFT) as usize } else { 0 };
    let mut sums = vec![0.0; BINS];
    squares.iter().filter(|square| **square > 0.0).for_each(|&square| sums[bin(square)] += square);
    let wanted = fraction * sums.iter().sum::<f64>();
    let (mut sum, mut last) = (0.0, BINS - 1);
    while last > 0 && sum + sums[last] < wanted {
        sum += sums[last];
        last -= 1;
    }
    let mut marked = Vec::new();
    let mut open = Vec::new();
    for (cell, &square) in (0..).zip(squares) {
        let of_cell = bin(square);
        if of_cell > last {
            marked.push(cell);
        } else if of_cell == last && square > 0.0 {
            open.push(cell);
        }
    }
    open.sort_by(|&a: &u32, &b: &u32| squares[b as usize].total_cmp(&squares[a as usize]));
    for cell in open {
        if sum >= wanted {
            break;
        }
        sum += squares[cell as usize];
        marked.push(cell);
    }
    marked.sort_unstable();
    marked
}

/// Squares to be expected in the pieces of cells, from the squares in the cells; `origins` has the number of the cell
/// of each piece, increasing. Where the solution is smooth, the square in a cell falls like the square of its area.
pub(super) fn expected_squares(squares: &[f64], origins: &[u32]) -> Vec<f64> {
    let mut expected = Vec::with_capacity(origins.len());
    for pieces in origins.chunk_by(|a, b| a == b) {
        let count = pieces.len() as f64;
        let square = squares[pieces[0] as usize] / (count * count);
        expected.extend(pieces.iter().map(|_| square));
    }
    expected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_squares_are_marked_and_ties_go_to_low_numbers() {
        let squares = [1.0, 4.0, f64::NAN, 0.0, 4.0, 1.0, 2.0];
        assert_eq!(largest_parts(&squares, 0.3), [1]);
        assert_eq!(largest_parts(&squares, 0.6), [1, 4]);
        assert_eq!(largest_parts(&squares, 0.9), [0, 1, 4, 6]);
        assert_eq!(largest_parts(&squares, 1.0), [0, 1, 4, 5, 6]);
        assert_eq!(largest_parts(&[0.0, 0.0], 0.5), [0; 0]);
    }

    #[test]
    fn a_part_of_a_bin_is_sorted() {
        let squares: Vec<f64> = (0..100).map(|k| 1.0 + f64::from(k * 37 % 100) * 1e-5).collect();
        let marked = largest_parts(&squares, 0.1);
        assert_eq!(marked.len(), 10);
        assert!(marked.iter().all(|&cell| squares[cell as usize] > 1.000_89));
    }
}
