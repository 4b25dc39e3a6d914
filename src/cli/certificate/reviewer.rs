//! Texts of the user for the records: who checked, and where the code is published.

use super::CertificateArgs;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::refuse_forbidden;
use regex::Regex;
use serde::Serialize;

/// Name of a codechecker who gives none.
pub(super) const NOBODY: &str = "(name of the codechecker)";

/// Texts of the user, checked.
///
/// None of them is the `@id` of an entity as it stands: what may be any text could be that of another entity.
#[derive(Serialize)]
pub(super) struct Reviewer {
    /// Name, or [`NOBODY`].
    name: String,
    is_named: bool,
    /// The 16 digits of the ORCID, without its address.
    orcid: Option<String>,
    /// Place of the code, as the user says it.
    repository: String,
    /// Address of the code, if programs can follow it.
    address: Option<String>,
}

impl Reviewer {
    /// Checks the texts of the user.
    ///
    /// # Errors
    /// [`Error::Input`] for an ORCID or an address that is none, and for a text that is no single line.
    pub(super) fn read(args: &CertificateArgs) -> Result<Self> {
        let orcid = args.orcid.as_deref().map(orcid).transpose()?;
        let name = line("--name", &args.name)?;
        let repository = line("--repository", &args.repository)?;
        let address = is_web(repository).then(|| check_address(repository)).transpose()?;
        Ok(Self {
            is_named: name != NOBODY,
            name: name.to_owned(),
            orcid,
            repository: repository.to_owned(),
            address: address.map(str::to_owned),
        })
    }

    /// Returns the `@id` of whoever checked in an RO-Crate; `None` if nobody says who.
    pub(super) fn id(&self) -> Option<String> {
        match &self.orcid {
            Some(orcid) => Some(format!("https://orcid.org/{orcid}")),
            None => self.is_named.then(|| "#codechecker".into()),
        }
    }
}

/// Returns the text without space around it; refuses one that is empty or has a character that no line of text may
/// have.
fn line<'a>(option: &str, text: &'a str) -> Result<&'a str> {
    let text = text.trim();
    if text.is_empty() {
        return Err(Error::input(format!("{option} is empty; give it some text, or leave it out")));
    }
    refuse_forbidden(option, text)?;
    Ok(text)
}

/// Returns the digits of an ORCID, which may be written as its address.
fn orcid(text: &str) -> Result<String> {
    let form = r"(?i)^(?:(?:https?://)?(?:www\.)?orcid\.org/)?((?:[0-9]{4}-){3}[0-9]{3}[0-9X])/?$";
    let form = Regex::new(form).expect("the form is tested");
    let Some(found) = form.captures(text.trim()) else {
        return Err(Error::input(format!(
            "--orcid {text}: no ORCID; write it as 0000-0002-1825-0097, or as https://orcid.org/0000-0002-1825-0097"
        )));
    };
    let id = found[1].to_ascii_uppercase();
    if check_sum(&id.replace('-', "")) != Some(1) {
        return Err(Error::input(format!(
            "--orcid {text}: no ORCID, for its last digit does not fit the others; look for a digit that is mistyped"
        )));
    }
    Ok(id)
}

/// Returns the check sum of an ORCID by ISO 7064 MOD 11-2, which is 1 for a valid one: sum of the digits, each times
/// two to the number of digits after it, modulo 11. The last digit may be X for ten; `None` if another is no digit.
fn check_sum(digits: &str) -> Option<u32> {
    let mut sum = 0;
    for (place, digit) in digits.chars().enumerate() {
        let value = if (place, digit) == (15, 'X') { 10 } else { digit.to_digit(10)? };
        sum = (2 * sum + value) % 11;
    }
    Some(sum)
}

/// True if the text is meant as an address on the web.
fn is_web(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    text.starts_with("http:") || text.starts_with("https:")
}

/// Returns an absolute address on the web (RFC 3987); refuses a text that is none, and one with a name or a password,
/// which would be published.
fn check_address(text: &str) -> Result<&str> {
    let letter = r"[\p{L}\p{N}\p{M}._~!$&'()*+,;=-]|%[0-9A-Fa-f]{2}";
    let host = format!(r"(?:\[[0-9A-Fa-f:.]+\]|(?:{letter})+)(?::[0-9]+)?");
    let form =
        format!(r"^(?i:https?)://{host}(?:[/?](?:{letter}|[:@/?])*)?(?:#(?:{letter}|[:@/?])*)?$");
    match Regex::new(&form).expect("the form is tested").is_match(text) {
        true => Ok(text),
        false => Err(Error::input(format!(
            "--repository {text}: no address; write spaces and the like as %20, and leave out names and passwords"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orcid_may_be_an_address() {
        for text in [
            "0000-0002-1694-233X",
            "0000-0002-1694-233x",
            "https://orcid.org/0000-0002-1694-233X",
            "http://www.orcid.org/0000-0002-1694-233X/",
            "orcid.org/0000-0002-1694-233X",
        ] {
            assert_eq!(orcid(text).unwrap(), "0000-0002-1694-233X", "{text}");
        }
        for text in [
            "https://example.org/0000-0002-1694-233X",
            "https://0000-0002-1694-233X",
            "0000-0002-1694-2330",
            "٠000-0002-1694-233X",
        ] {
            assert!(orcid(text).is_err(), "{text}");
        }
    }

    #[test]
    fn addresses_can_be_followed() {
        for text in [
            "https://example.org",
            "HTTPS://example.org:8080/a_(b)/%20?q=1&r=@/:#part",
            "http://[::1]/x",
            "https://приме\u{440}.рф/папка",
        ] {
            assert!(is_web(text) && check_address(text).is_ok(), "{text}");
        }
        for text in [
            "https://example.org/my repo",
            "https://",
            "http:example.org",
            "https:///x",
            "https://example.org/\"x\"",
            "https://example.org/50%",
            "https://example.org/a#b#c",
            "https://example.org/[x]",
            "https://example.org/\u{202e}x",
            "https://me:secret@example.org/x",
        ] {
            assert!(is_web(text) && check_address(text).is_err(), "{text}");
        }
        for text in ["example.org/x", "git@github.com:a/b.git", "javascript:x", "./", "#run"] {
            assert!(!is_web(text), "{text}");
        }
    }
}
