//! Pages of the book as assistive programs find them, judged by axe-core, in two themes and two widths.

use crate::browser::{browser, dom, unescaped};
use crate::common::skip;
use crate::explore::book;
use std::fs;

/// Script of axe-core, which `.ci/run` puts there where it can be fetched.
const AXE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/axe/package/axe.min.js");

/// Pages of each kind.
const PAGES: [&str; 8] =
    ["introduction", "method", "tables", "stopping", "claims", "gallery", "own-problems", "fields"];

/// Opens the pages one after the other in a frame, and lists what axe-core finds in each.
const JUDGE: &str = r#"
const found = [];
async function judge() {
  for (const page of PAGES) {
    const frame = document.createElement("iframe");
    frame.width = WIDTH;
    frame.height = 900;
    frame.src = `file://${page}`;
    document.body.append(frame);
    await new Promise((done) => { frame.onload = done; });
    const script = frame.contentDocument.createElement("script");
    script.textContent = AXE;
    frame.contentDocument.head.append(script);
    const { violations } = await frame.contentWindow.axe.run(frame.contentDocument, { resultTypes: ["violations"], ...RULES });
    for (const { id, nodes } of violations) found.push(`${page}: ${id}: ${nodes[0].html.slice(0, 200)}`);
    if (frame.contentDocument.documentElement.scrollWidth > WIDTH + 1) found.push(`${page}: wider than the window`);
    frame.remove();
  }
  document.body.dataset.found = JSON.stringify(found);
}
judge();
"#;

#[test]
fn no_page_has_a_violation() {
    judge_all("light", 1280, "{}");
}

#[test]
fn nor_in_the_dark_on_a_phone() {
    // Of the rules, these alone depend on the theme and on the width.
    judge_all("navy", 400, r#"{ runOnly: ["color-contrast", "scrollable-region-focusable"] }"#);
}

/// Asserts that no page has a finding in this theme and in a window of this width, by the rules that axe-core's option
/// `rules` selects.
fn judge_all(theme: &str, width: u32, rules: &str) {
    let Some(browser) = browser() else { return skip("no chromium, so that no page is judged") };
    let Ok(axe) = fs::read_to_string(AXE) else {
        return skip("no axe-core in target/axe, so that no page is judged");
    };
    let axe = serde_json::to_string(&axe).unwrap().replace("</", "<\\/");
    let book = book();
    let pages: Vec<_> = PAGES.iter().map(|name| book.join(format!("{name}.html"))).collect();
    assert!(pages.iter().all(|page| page.is_file()), "{pages:?}");
    let pages = serde_json::to_string(&pages).unwrap();
    let head = format!(
        "localStorage.setItem('mdbook-theme', '{theme}');\n\
        const AXE = {axe}, PAGES = {pages}, WIDTH = {width}, RULES = {rules};"
    );
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("judge.html");
    fs::write(&page, format!("<body><script>{head}{JUDGE}</script></body>")).unwrap();
    let dom = dom(&browser, &page, "", 200_000);
    let found = dom.split("data-found=\"").nth(1).expect("all pages are judged");
    let found: Vec<String> =
        serde_json::from_str(&unescaped(found.split('"').next().unwrap())).unwrap();
    assert!(found.is_empty(), "{theme}, {width} pixels: {found:#?}");
}
