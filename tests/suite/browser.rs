//! Pages and their scripts, opened in a browser, or in node where there is none.

use crate::common::skip;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The browser in which pages are opened, if there is one.
pub(crate) fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let path = std::env::var_os("PATH")?;
    let folders: Vec<_> = std::env::split_paths(&path).collect();
    names.iter().flat_map(|name| folders.iter().map(move |f| f.join(name))).find(|p| p.is_file())
}

/// The elements of a page, opened with a query, after its scripts have run for so many milliseconds of their own time.
pub(crate) fn dom(browser: &Path, page: &Path, query: &str, budget: u32) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--hide-scrollbars", "--window-size=900,1600", "--dump-dom"])
        .arg("--allow-file-access-from-files")
        .arg(format!("--virtual-time-budget={budget}"))
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}{query}", page.display()))
        .stdin(Stdio::null())
        .output()
        .expect("the browser starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The value of an attribute as it was before it was written into a page.
pub(crate) fn unescaped(text: &str) -> String {
    let pairs = [("&quot;", "\""), ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")];
    pairs.into_iter().fold(text.into(), |text: String, (from, to)| text.replace(from, to))
}

/// The text that a script calls `answer`; nothing without a browser and without node.
pub(crate) fn run_script(script: &str) -> Option<String> {
    let Some(browser) = browser() else {
        return by_node(&format!("{script}console.log(answer);"));
    };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let script = format!("{script}document.body.dataset.answer = answer;");
    fs::write(&page, format!("<meta charset=utf-8><body><script>{script}</script>")).unwrap();
    let dom = dom(&browser, &page, "", 60_000);
    let text = dom.split("data-answer=\"").nth(1).unwrap_or_else(|| panic!("{dom}"));
    Some(unescaped(text.split('"').next().unwrap()))
}

fn by_node(script: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("script.js");
    fs::write(&file, script).unwrap();
    let Ok(output) = Command::new("node").arg(&file).output() else {
        skip("neither chromium nor node; nobody has read f as the page does");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}
