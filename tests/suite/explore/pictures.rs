//! The pictures of the page with the live iteration: axes with ticks, and words that are neither cut nor overlap.

use super::{book, notes};
use crate::browser::browser;
use crate::common::skip;

/// Draws the pictures of right-hand sides of several sizes, and notes the words in them with their boxes.
const LOOK: &str = r#"
const canvas = document.querySelector(".explore canvas"), write = CanvasRenderingContext2D.prototype.fillText;
let surface = [];
CanvasRenderingContext2D.prototype.fillText = function (content, x, y) {
  const width = this.measureText(content).width;
  const left = { left: x, center: x - width / 2, right: x - width }[this.textAlign];
  surface.push({ content, left, right: left + width, top: y - 5, bottom: y + 5 });
  write.call(this, content, x, y);
};
const boxes = (svg) => [...svg.querySelectorAll("text")].map((text) => {
  const { x, y, width, height } = text.getBBox();
  return { content: text.textContent, left: x, right: x + width, top: y + 2, bottom: y + height - 2 };
});
const turn = (key) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const look = (what, words, picture) =>
  log.push({ what, words: [...words], width: picture.clientWidth, height: picture.clientHeight });

choose("finest", "16");
for (const width of ["", "362px", "282px"]) {
  document.querySelector(".explore").style.width = width;
  choose("problem", "2");
  for (const f of ["", "else=-1e-8", "disc(0,0,1/4)=40000; else=-10000", "disc(0,0,1/4)=2e100; else=-1e100"]) {
    if (f) choose("problem", "own");
    if (f) choose("f", f);
    await sleep(300);
    const charts = [...document.querySelectorAll(".explore svg[data-chart]")];
    for (const svg of charts) look(`${svg.dataset.chart} ${f}`, boxes(svg), svg);
    for (let k = 0; k < 48; k++) {
      surface = [];
      turn("ArrowLeft");
      look(`surface ${k === 47 ? "opened" : "turned"} ${f}`, surface, canvas);
    }
  }
}
"#;

#[test]
fn pictures_have_axes_with_ticks_and_no_word_is_cut_or_covered() {
    let Some(browser) = browser() else {
        skip("no chromium; nobody has looked at the pictures of tables.html");
        return;
    };
    let pictures = notes(&browser, book(), "", LOOK);
    assert_eq!(pictures.len(), 3 * 4 * (2 + 48), "{:?}", pictures.last());
    let mut wrong = Vec::new();
    for picture in &pictures {
        let words: Vec<Word> =
            serde_json::from_value(picture["words"].clone()).expect("words with boxes");
        let size = ["width", "height"].map(|side| picture[side].as_f64().unwrap());
        let what = format!("{} at {} px", picture["what"].as_str().unwrap(), size[0]);
        wrong.extend(without_axes(&what, &words));
        for (k, word) in words.iter().enumerate() {
            if word.is_cut(size) {
                wrong.push(format!("{what}: {word:?} is cut"));
            }
            // While the surface is turned, labels of two axes may pass one another.
            if let Some(other) = words[..k].iter().find(|other| other.covers(word))
                && !what.starts_with("surface turned")
            {
                wrong.push(format!("{what}: {word:?} over {other:?}"));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {}: {:#?}",
        wrong.len(),
        pictures.len(),
        &wrong[..wrong.len().min(12)]
    );
}

/// A word in a picture, with its box in pixels.
#[derive(Debug, serde::Deserialize)]
struct Word {
    content: String,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Word {
    fn is_cut(&self, [width, height]: [f64; 2]) -> bool {
        self.left < 0.0 || width < self.right || self.top < 0.0 || height < self.bottom
    }

    fn covers(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// Says which names of axes and how many ticks a picture lacks.
fn without_axes(what: &str, words: &[Word]) -> Option<String> {
    let has = |name: &&str| words.iter().any(|word| word.content == *name);
    let (names, ticks): (&[&str], _) = match what.split(' ').next().unwrap() {
        "history" => (
            &[
                "iterations, all grids",
                "largest component of the gradient",
                "largest absolute value",
                "tolerance",
            ],
            6,
        ),
        "boundary" => (&["y", "a", "arc length, anticlockwise", "bottom", "left", "0", "4"], 8),
        _ => (&["x", "y", "v", "−0.5", "0", "0.5"], 8),
    };
    let is_number = |word: &&Word| {
        word.content.trim_start_matches(['−', '≤']).starts_with(|c: char| c.is_ascii_digit())
    };
    let found = words.iter().filter(is_number).count();
    let missing: Vec<_> = names.iter().filter(|name| !has(name)).collect();
    (found < ticks || !missing.is_empty())
        .then(|| format!("{what}: {found} ticks, without {missing:?}"))
}
