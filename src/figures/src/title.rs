//! Titles of panels, in as many lines as their width asks for.

use super::picture::{LARGE, Picture, Place, TextStyle};

/// Height of a line of a title.
const LINE: f64 = 17.0;
/// Most lines of a title.
const MOST: usize = 5;
/// Widest letter of a title that is allowed for, over the size of the font: fonts are not measured.
const LETTER: f64 = 0.66;

/// Title, broken between words so that no number is cut.
#[derive(Clone, Debug)]
pub(super) struct Title {
    lines: Vec<String>,
}

impl Title {
    /// Breaks a text where it has line ends, and where a line would be wider in bold letters than `width`; the end of a
    /// text of more than [`MOST`] lines is left out, which dots say.
    pub(super) fn new(text: &str, width: f64) -> Self {
        let letters = ((width / (LETTER * LARGE)) as usize).max(2);
        let mut lines = Vec::new();
        for given in text.split('\n') {
            let mut line = String::new();
            for word in words(given, letters) {
                if !line.is_empty() && length(&line) + length(word.trim_end()) > letters {
                    lines.push(std::mem::take(&mut line).trim_end().to_owned());
                }
                line += word;
            }
            lines.push(line.trim_end().to_owned());
        }
        if lines.len() > MOST {
            lines.truncate(MOST);
            if let Some(last) = lines.last_mut() {
                while length(last) + 2 > letters {
                    let shorter =
                        &last[..last.len() - last.chars().last().map_or(0, char::len_utf8)];
                    let kept = shorter.rfind(is_break).map_or(0, |at| at + 1);
                    last.truncate(kept);
                }
                *last += " …";
            }
        }
        Self { lines }
    }

    /// Height of all lines but one.
    pub(super) fn more(&self) -> f64 {
        LINE * (self.lines.len() - 1) as f64
    }

    /// Writes the title; the place is that of its last line.
    pub(super) fn draw(&self, picture: &mut Picture, (x, y): Place, style: &TextStyle<'static>) {
        for (k, line) in self.lines.iter().enumerate().filter(|(_, line)| !line.is_empty()) {
            picture.text(line, (x, y - self.more() + LINE * k as f64), style.clone());
        }
    }
}

/// Returns the words of a text, each with the space behind it; one longer than a line is broken where an f may be, and
/// one that offers no such place anywhere.
fn words(text: &str, letters: usize) -> Vec<&str> {
    let mut words = Vec::new();
    for word in text.split_inclusive(' ') {
        if length(word.trim_end()) <= letters {
            words.push(word);
            continue;
        }
        for mut part in word.split_inclusive(is_break) {
            while let Some((end, _)) = part.char_indices().nth(letters) {
                words.push(&part[..end]);
                part = &part[end..];
            }
            words.push(part);
        }
    }
    words
}

/// True for a character behind which a line may end: not a sign, which may be that of an exponent.
fn is_break(character: char) -> bool {
    " ,;()*/".contains(character)
}

fn length(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, letters: f64) -> Vec<String> {
        Title::new(text, letters * LETTER * LARGE + 1.0).lines
    }

    #[test]
    fn titles_are_broken_between_words_and_no_number_is_cut() {
        assert_eq!(lines("short", 10.0), ["short"]);
        assert_eq!(
            lines("Pushed up, error\nat most 4.31 %", 12.0),
            ["Pushed up,", "error", "at most 4.31", "%"]
        );
        let f = "disc(0.125,-0.25,0.5)=3; else=-1.25e-3";
        assert_eq!(lines(f, 24.0), ["disc(0.125,-0.25,0.5)=3;", "else=-1.25e-3"]);
        assert_eq!(lines(f, 14.0), ["disc(0.125,", "-0.25,0.5)=3;", "else=-1.25e-3"]);
        assert_eq!(
            lines("formula(x*y*1.25-sin(1e-5*x))", 12.0),
            ["formula(x*y*", "1.25-sin(", "1e-5*x))"]
        );
        assert_eq!(lines("abcdefghij", 4.0), ["abcd", "efgh", "ij"]);
        assert_eq!(lines("", 4.0), [""]);
    }

    #[test]
    fn a_title_of_too_many_lines_says_that_it_goes_on() {
        let long = lines(&"disc(0,0,0.25)=1.125; ".repeat(9), 24.0);
        assert_eq!(long.len(), MOST);
        assert_eq!(long[3], "disc(0,0,0.25)=1.125;");
        assert_eq!(long[4], "disc(0,0,0.25)=1.125; …");
        let cut = lines(&"disc(0,0,0.25)=1.125; ".repeat(9), 21.0);
        assert_eq!(cut[4], "disc(0,0,0.25) …");
        assert!(cut.iter().all(|line| length(line) <= 21));
    }
}
