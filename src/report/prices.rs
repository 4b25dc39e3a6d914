//! Prices in the text of a page, which Markdown with formulas would read as the ends of a formula.

use std::ops::Range;

/// Refuses an inline formula between two dollars that are signs of money, as in "US$5 and US$10" or "5$, 6$".
///
/// `range` is that of the formula in the page, dollars included. As in pandoc, no digit may follow the closing dollar;
/// and a formula has no words, whose spaces would be lost, but in a command such as `\text{ if }`.
pub(super) fn refuse(markdown: &str, range: &Range<usize>, latex: &str) -> Result<(), String> {
    let before = markdown[..range.start].chars().next_back().unwrap_or(' ');
    let after = markdown[range.end..].chars().next().unwrap_or(' ');
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let (first, last) = (latex.chars().next(), latex.chars().next_back());
    let is_price = after.is_ascii_digit()
        || before.is_alphabetic() && is_digit(first)
        || before.is_ascii_digit()
            && is_digit(last)
            && first.is_some_and(|c| ",.;:/-–".contains(c))
        || is_digit(first) && has_word(latex);
    match is_price {
        false => Ok(()),
        true => Err(format!(
            "`${latex}$` would be set as a formula, but looks like prices; write `\\$` for the sign of a dollar, or \
             put a space beside the formula"
        )),
    }
}

/// True if a word of at least two letters stands between spaces, outside of braces.
fn has_word(latex: &str) -> bool {
    let mut depth = 0;
    let outside: String = latex
        .chars()
        .map(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if depth > 0 { '{' } else { c }
        })
        .collect();
    let mut words =
        outside.split_whitespace().skip(1).map(|word| word.trim_end_matches([',', ';', '.']));
    words.any(|word| word.len() > 1 && word.chars().all(char::is_alphabetic))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the formula between the first two dollars of a page.
    fn checked(page: &str) -> Result<(), String> {
        let dollars: Vec<usize> = page.match_indices('$').map(|(at, _)| at).collect();
        let [start, end] = [dollars[0], dollars[1]];
        refuse(page, &(start..end + 1), &page[start + 1..end])
    }

    #[test]
    fn prices_are_no_formulas() {
        for page in [
            "US$5 and US$10",
            "US$5 in the US and CA$",
            "5$, 6$",
            "from 5$-10$",
            "5$/6$",
            "$5 now, or 10$ later",
            "$5 to 10$",
            "a$5$",
            "$x$2",
        ] {
            assert!(checked(page).unwrap_err().contains("write `\\$`"), "{page}");
        }
        for page in [
            "$5$",
            "$x_1$, $y$",
            "2$n$ nodes",
            "P$_2$ elements",
            "the L$^2$ norm",
            "2$(n+1)$",
            "5$-x$",
            "$0 \\text{ if all } x$",
            "$2 \\le n < 5$",
            "$10^{-3} h$",
            "$1 : 2$",
        ] {
            assert_eq!(checked(page), Ok(()), "{page}");
        }
    }
}
