//! Template filters for numbers in the book, which write LaTeX between dollars.

use super::data::{as_shown, with_digits};
use super::text::in_markdown;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use tera::{Kwargs, State, Tera, TeraResult, Value};

pub(super) fn register(tera: &mut Tera) {
    tera.register_filter("sci", |x: f64, kwargs: Kwargs, _: &State| -> TeraResult<String> {
        Ok(number(scientific(x, precision(&kwargs, "digits", 2)?), x))
    });
    // A number in words with the digits that it has.
    tera.register_filter("decimal", |text: String, _: Kwargs, _: &State| {
        with_digits(&math(&decimal(&text)), &text)
    });
    tera.register_filter("num", |x: f64, kwargs: Kwargs, _: &State| equation(kwargs, plain(x), x));
    tera.register_filter("times", |x: f64, _: Kwargs, _: &State| number(factor(x), x));
    tera.register_filter("ratio", |x: f64, _: Kwargs, _: &State| number(ratio(x), x));
    tera.register_filter("two", |x: f64, _: Kwargs, _: &State| number(plain(two_digits(x)), x));
    tera.register_filter("fix", |x: f64, kwargs: Kwargs, _: &State| -> TeraResult<String> {
        let places = precision(&kwargs, "to", 1)?;
        Ok(number(format!("{x:.places$}"), x))
    });
    tera.register_filter("int", |n: usize, _: Kwargs, _: &State| {
        with_digits(&grouped(n), &n.to_string())
    });
    tera.register_filter("word", |n: usize, _: Kwargs, _: &State| word(n));
    tera.register_filter("step", |cells: f64, kwargs: Kwargs, _: &State| {
        equation(kwargs, format!("1/{cells}"), 1.0 / cells)
    });
    // For the scripts of a page: text, lists and numbers as JSON; numbers in the form of JavaScript.
    tera.register_filter("json", |value: Value, _: Kwargs, _: &State| json(&value));
    // Numbers of a picture, to four decimals.
    tera.register_filter("decimals", |values: Vec<f64>, _: Kwargs, _: &State| {
        let texts: Vec<String> = values.iter().map(|v| plain((1e4 * v).round() / 1e4)).collect();
        format!("[{}]", texts.join(","))
    });
    tera.register_filter("plain", |x: f64, _: Kwargs, _: &State| x.to_string());
    tera.register_function("require", require);
    tera.register_filter("cell", |text: String, _: Kwargs, _: &State| text.replace('|', r"\|"));
    // Two numbers that are shown alike are compared as they are shown.
    tera.register_filter("shown", |text: String, _: Kwargs, _: &State| as_shown(&text));
    // Of a file in a link, and of a part of a page.
    tera.register_filter("address", |text: String, _: Kwargs, _: &State| address(&text));
    tera.register_filter("text", |text: String, _: Kwargs, _: &State| in_markdown(&text));
}

/// Returns a name of the user as a part of an address, which has no sign with a meaning in Markdown or in tags.
fn address(name: &str) -> String {
    const KEPT: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'/');
    utf8_percent_encode(name, KEPT).to_string()
}

/// Returns the number of digits that a page asks for under this name, or the usual one.
fn precision(kwargs: &Kwargs, name: &str, usual: usize) -> TeraResult<usize> {
    /// Digits of a number in binary that a decimal has at most, behind the point.
    const MOST: usize = 1074;
    match kwargs.get::<usize>(name)?.unwrap_or(usual) {
        many if many > MOST => Err(tera::Error::message(format!(
            "`{name}` is {many}; no number has more than {MOST} digits"
        ))),
        digits => Ok(digits),
    }
}

/// Function `{{ require(that=CONDITION, what="...") }}`: nothing, or an error that stops the build.
fn require(kwargs: Kwargs, _: &State) -> TeraResult<String> {
    match kwargs.must_get::<bool>("that")? {
        true => Ok(String::new()),
        false => {
            let what = kwargs.must_get::<String>("what")?;
            Err(tera::Error::message(format!("no longer holds: {what}; rewrite what rests on it")))
        }
    }
}

fn math(latex: &str) -> String {
    format!("${latex}$")
}

/// Returns a number as it is shown, with its digits for the data of the table in which it may stand.
fn number(latex: String, x: f64) -> String {
    with_digits(&math(&latex), &format!("{x:?}"))
}

/// Returns JSON for a `<script>`, in which `</` is escaped because it could end the script.
fn json(value: &Value) -> String {
    serde_json::to_string(value).expect("plain data").replace("</", r"<\/")
}

/// Returns `$name = latex$` if the filter is called with `eq="name"`, else the number.
fn equation(kwargs: Kwargs, latex: String, x: f64) -> TeraResult<String> {
    Ok(match kwargs.get::<String>("eq")? {
        Some(name) => math(&format!("{name} = {latex}")),
        None => number(latex, x),
    })
}

/// Returns a decimal such as `-1.5e-7` in LaTeX.
fn decimal(text: &str) -> String {
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!(r"{mantissa} \cdot 10^{{{exponent}}}"),
        None => text.into(),
    }
}

/// Returns x with this number of significant digits, with a power of ten where that is shorter, as in the paper's last
/// column.
///
/// A power of ten itself has no factor: such values were chosen, not measured.
fn scientific(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return plain(x);
    }
    let places = digits.saturating_sub(1);
    let text = format!("{x:.places$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    match exponent {
        "-1" => format!("{x:.digits$}"),
        "0" => mantissa.to_string(),
        "1" | "2" | "3" => {
            let places = places.saturating_sub(exponent.parse().unwrap_or(0));
            format!("{x:.places$}")
        }
        _ if format!("1e{exponent}").parse() == Ok(x) => format!("10^{{{exponent}}}"),
        _ => decimal(&text),
    }
}

/// Returns the shortest decimal that is right to ten places; a power of ten from a million up as such.
fn plain(x: f64) -> String {
    if x.is_nan() {
        return r"\text{not a number}".into();
    }
    if x.is_infinite() {
        return if x > 0.0 { r"\infty" } else { r"-\infty" }.into();
    }
    let exponent = libm::log10(x.abs());
    if exponent >= 6.0 && exponent.fract() == 0.0 && x > 0.0 {
        return format!("10^{{{exponent}}}");
    }
    let text = format!("{x:.10}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_string()
}

/// Returns a ratio: a whole number from ten up, one decimal below, a power of ten from 1e5 up and for small ones.
fn factor(x: f64) -> String {
    match x.abs() {
        size if size >= 1e5 || !x.is_finite() => scientific(x, 2),
        size if size >= 9.95 => format!("{x:.0}"),
        size if size >= 0.095 => format!("{x:.1}"),
        _ => scientific(x, 2),
    }
}

fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// Returns a ratio that may be close to one: two decimals below ten, else as [`factor`].
fn ratio(x: f64) -> String {
    if (0.095..9.95).contains(&x.abs()) { format!("{x:.2}") } else { factor(x) }
}

/// Returns the digits of a number, from five digits up in groups of three with narrow spaces.
fn grouped(n: usize) -> String {
    let digits = n.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// Returns a number up to twelve in words.
fn word(n: usize) -> String {
    const WORDS: [&str; 13] = [
        "none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
        "eleven", "twelve",
    ];
    WORDS.get(n).map_or_else(|| grouped(n), |word| (*word).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_in_the_paper() {
        assert_eq!(scientific(1.6e-4, 2), r"1.6 \cdot 10^{-4}");
        assert_eq!(scientific(9.96e-4, 2), r"1.0 \cdot 10^{-3}");
        assert_eq!(scientific(1e-5, 2), "10^{-5}");
        assert_eq!(scientific(4.208e-2, 4), r"4.208 \cdot 10^{-2}");
        assert_eq!([decimal("-1.50"), decimal("-2.0e-7")], ["-1.50", r"-2.0 \cdot 10^{-7}"]);
        assert_eq!((scientific(0.0, 2).as_str(), scientific(4.2, 2).as_str()), ("0", "4.2"));
        assert_eq!((plain(1e6).as_str(), plain(0.5).as_str()), ("10^{6}", "0.5"));
        assert_eq!(plain(0.03750000000003612), "0.0375");
        assert_eq!((plain(-1.05).as_str(), plain(-1e-14).as_str()), ("-1.05", "0"));
        assert_eq!(
            (plain(two_digits(562.3)), plain(two_digits(1e6))),
            ("560".into(), "10^{6}".into())
        );
        assert_eq!((ratio(1.004).as_str(), ratio(12.3).as_str()), ("1.00", "12"));
        assert_eq!((factor(89.7).as_str(), factor(2.34).as_str()), ("90", "2.3"));
        assert_eq!(
            (grouped(9999).as_str(), grouped(1234567).as_str()),
            ("9999", "1\u{202f}234\u{202f}567")
        );
        assert_eq!(scientific(0.5369, 2), "0.54");
        assert_eq!(scientific(-29.6, 2), "-30");
        assert_eq!((scientific(12.61, 3), scientific(1234.0, 3)), ("12.6".into(), "1234".into()));
        assert_eq!(plain(f64::NAN), r"\text{not a number}");
    }
}
