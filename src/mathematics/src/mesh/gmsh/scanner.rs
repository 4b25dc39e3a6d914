//! Words and numbers of a file, one after the other, in text or in bytes.

use super::error::{BYTE_ORDER_MARK, Fault, FilePlace, GmshError};
use std::str::FromStr;

/// Letters of a word that a message shows.
const SHOWN: usize = 24;

/// Letters of the longest name of a section.
const LONGEST_NAME: usize = 127;

/// Form of the numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// 2.0 to 2.2, which have the same columns.
    Two,
    /// 4.0.
    FourZero,
    /// 4.1.
    FourOne,
}

impl Version {
    /// Reads a version, as a number: some programs write 2.000000, or the digits of a number of 32 bits.
    fn read(word: &[u8]) -> Option<Self> {
        const ROUNDING: f64 = 1e-6;
        let number: f64 = str::from_utf8(word).ok()?.parse().ok()?;
        let versions = [
            (2.0, Self::Two),
            (2.1, Self::Two),
            (2.2, Self::Two),
            (4.0, Self::FourZero),
            (4.1, Self::FourOne),
        ];
        let found = versions.into_iter().find(|(read, _)| (read - number).abs() < ROUNDING);
        found.map(|(_, version)| version)
    }
}

/// Reader of words and numbers. Numbers of counts are never trusted: what is read is pushed, so that no allocation is
/// larger than a few times the file.
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    /// Position of the next byte.
    at: usize,
    /// Position of the last word or number, for messages.
    last: usize,
    /// Name of the section.
    section: &'a [u8],
    pub(super) version: Version,
    encoding: Encoding,
}

impl<'a> Scanner<'a> {
    /// Scanner after the section `$MeshFormat`.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, GmshError> {
        let (version, encoding) = (Version::FourOne, Encoding::Text);
        let at = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let mut scanner = Self { bytes, at, last: at, section: b"MeshFormat", version, encoding };
        loop {
            match scanner.section() {
                Ok(Some("MeshFormat")) => break,
                Ok(Some("Comments")) => scanner.skip()?,
                _ => return Err(GmshError::NoMeshFormat),
            }
        }
        let version = scanner.word()?;
        scanner.version =
            Version::read(version).ok_or_else(|| scanner.fault(Fault::Version(shown(version))))?;
        let is_binary = match scanner.word()? {
            b"0" => false,
            b"1" => true,
            other => return Err(scanner.unexpected(other, "0 for text or 1 for a binary file")),
        };
        let size: i64 = scanner.number("a whole number")?;
        if is_binary {
            if size != 8 {
                return Err(scanner.fault(Fault::NumberSize(size)));
            }
            scanner.end_line()?;
            scanner.encoding = match scanner.take()? {
                [1, 0, 0, 0] => Encoding::LittleEndian,
                [0, 0, 0, 1] => Encoding::BigEndian,
                _ => return Err(scanner.fault(Fault::ByteOrder)),
            };
        }
        scanner.end()?;
        Ok(scanner)
    }

    /// Name of the next section without $; none at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<&'a str>, GmshError> {
        if self.bytes[self.at..].trim_ascii_start().is_empty() {
            return Ok(None);
        }
        let word = self.word()?;
        let name = word.strip_prefix(b"$").filter(|name| name.len() <= LONGEST_NAME);
        let Some(name) = name else {
            return Err(self.unexpected(word, "$ and the name of a section"));
        };
        self.section = name;
        // A name of other bytes is that of no section that is read.
        Ok(Some(str::from_utf8(name).unwrap_or("")))
    }

    /// Reads the end of the section.
    pub(super) fn end(&mut self) -> Result<(), GmshError> {
        let word = self.word()?;
        if word.strip_prefix(b"$End") == Some(self.section) {
            return Ok(());
        }
        Err(self.unexpected(word, &format!("$End{}", shown(self.section))))
    }

    /// Passes over the section and its end.
    pub(super) fn skip(&mut self) -> Result<(), GmshError> {
        while let Some(next) = self.bytes[self.at..].iter().position(|&byte| byte == b'$') {
            self.at += next + 1;
            let rest = self.bytes[self.at..].strip_prefix(b"End");
            let after = rest.and_then(|rest| rest.strip_prefix(self.section));
            if let Some(after) = after
                && after.first().is_none_or(u8::is_ascii_whitespace)
            {
                self.at = self.bytes.len() - after.len();
                return Ok(());
            }
        }
        Err(self.fault(Fault::FileEnd))
    }

    /// Next word of a text.
    pub(super) fn word(&mut self) -> Result<&'a [u8], GmshError> {
        let rest = &self.bytes[self.at..];
        let Some(start) = rest.iter().position(|byte| !byte.is_ascii_whitespace()) else {
            (self.at, self.last) = (self.bytes.len(), self.bytes.len());
            return Err(self.fault(Fault::FileEnd));
        };
        let rest = &rest[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.last = self.at + start;
        self.at = self.last + length;
        Ok(&rest[..length])
    }

    /// Number of words before a quote in the next line of a text that is not blank, if there is a quote.
    pub(super) fn words_before_quote(&self) -> Option<usize> {
        let line = self.bytes[self.at..].trim_ascii_start().split(|&byte| byte == b'\n').next()?;
        let quote = line.iter().position(|&byte| byte == b'"')?;
        let words = line[..quote].split(u8::is_ascii_whitespace);
        Some(words.filter(|word| !word.is_empty()).count())
    }

    /// Rest of the line of a text, without blanks at both ends.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let line = rest.split(|&byte| byte == b'\n').next().unwrap_or_default();
        self.at += line.len();
        line.trim_ascii()
    }

    /// Next word of a text as a number; `expected` says of what kind.
    pub(super) fn number<T: FromStr>(&mut self, expected: &str) -> Result<T, GmshError> {
        let word = self.word()?;
        if word.starts_with(b"$") {
            return Err(self.fault(Fault::SectionEnd(shown(word))));
        }
        let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.unexpected(word, expected))
    }

    /// Reads the end of the line after which a binary file has bytes; in a text there is nothing to read.
    pub(super) fn begin_bytes(&mut self) -> Result<(), GmshError> {
        if self.is_text() { Ok(()) } else { self.end_line() }
    }

    fn end_line(&mut self) -> Result<(), GmshError> {
        self.last = self.at;
        match self.rest_of_line() {
            [] if self.at < self.bytes.len() => {
                self.at += 1;
                Ok(())
            }
            [] => Err(self.fault(Fault::FileEnd)),
            more => Err(self.unexpected(more, "the end of the line")),
        }
    }

    /// Next whole number: a word, or four bytes.
    pub(super) fn whole(&mut self) -> Result<i64, GmshError> {
        match self.encoding {
            Encoding::Text => self.number("a whole number"),
            Encoding::LittleEndian => Ok(i32::from_le_bytes(self.take()?).into()),
            Encoding::BigEndian => Ok(i32::from_be_bytes(self.take()?).into()),
        }
    }

    /// Next count: a word, or eight bytes.
    pub(super) fn count(&mut self) -> Result<u64, GmshError> {
        match self.encoding {
            Encoding::Text => self.number("a whole number from 0 on"),
            Encoding::LittleEndian => Ok(u64::from_le_bytes(self.take()?)),
            Encoding::BigEndian => Ok(u64::from_be_bytes(self.take()?)),
        }
    }

    /// Next number of a node or element: as a count in version 4.1, else as a whole number.
    pub(super) fn tag(&mut self) -> Result<u64, GmshError> {
        if self.version == Version::FourOne || self.is_text() {
            return self.count();
        }
        let tag = self.whole()?;
        u64::try_from(tag)
            .map_err(|_| self.unexpected(tag.to_string().as_bytes(), "a whole number from 0 on"))
    }

    /// Next finite number: a word, or eight bytes.
    pub(super) fn real(&mut self) -> Result<f64, GmshError> {
        let number: f64 = match self.encoding {
            Encoding::Text => self.number("a number")?,
            Encoding::LittleEndian => f64::from_le_bytes(self.take()?),
            Encoding::BigEndian => f64::from_be_bytes(self.take()?),
        };
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.unexpected(number.to_string().as_bytes(), "a finite number"))
    }

    fn take<const K: usize>(&mut self) -> Result<[u8; K], GmshError> {
        self.last = self.at;
        let Some(bytes) = self.bytes[self.at..].first_chunk() else {
            return Err(self.fault(Fault::FileEnd));
        };
        self.at += K;
        Ok(*bytes)
    }

    /// True if numbers are words.
    pub(super) fn is_text(&self) -> bool {
        self.encoding == Encoding::Text
    }

    /// Fault at the last word or number.
    pub(super) fn fault(&self, fault: Fault) -> GmshError {
        let before = &self.bytes[..self.last];
        let place = if self.is_text() {
            FilePlace::Line(before.split(|&byte| byte == b'\n').count())
        } else {
            FilePlace::Byte(self.last)
        };
        GmshError::Section { section: shown(self.section), place, fault }
    }

    fn unexpected(&self, found: &[u8], expected: &str) -> GmshError {
        self.fault(Fault::Unexpected { found: shown(found), expected: expected.into() })
    }
}

/// Returns the beginning of a word in printed letters.
fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(SHOWN)]).escape_debug().to_string();
    if word.len() > SHOWN { text + "..." } else { text }
}
