//! Captions of the figures and tables of this project's book: numbers, links to the data, words in all header cells;
//! and its length.

use crate::book::{attribute, files, html, tags};

/// The text of each page of chapters between `<main>` and `</main>`, by name.
fn pages() -> Vec<(String, String)> {
    let book = files();
    let pages =
        html(&book).into_iter().filter(|(name, _)| !["print.html", "toc.html"].contains(name));
    pages.map(|(name, page)| (name.to_owned(), main_part(&page).to_owned())).collect()
}

fn main_part(page: &str) -> &str {
    let (_, rest) = page.split_once("<main>").expect("a page of mdBook");
    rest.split_once("</main>").expect("a page of mdBook").0
}

/// Text between tags, and between elements of this kind, without either.
fn without(html: &str, element: &str) -> String {
    let opening = format!("<{element}");
    let mut parts = html.split(&opening);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        text += part.split_once(&format!("</{element}>")).map_or("", |(_, rest)| rest);
    }
    text
}

/// Words outside tags.
fn words(html: &str) -> usize {
    let text: String =
        html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect();
    text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// Number of the chapter of a page in the table of contents, the letter of an appendix, or 0.
fn chapter(contents: &str, page: &str) -> String {
    let entry = contents.split(&format!("href=\"{page}\"")).nth(1).expect("every page is listed");
    let entry = entry.split("</a>").next().unwrap();
    let number = entry.split("<strong aria-hidden=\"true\">").nth(1);
    let title = entry.rsplit('>').next().unwrap();
    let number = number.or(title.contains(". ").then_some(title));
    number.map_or("0", |number| number.split('.').next().unwrap()).to_owned()
}

#[test]
fn figures_and_tables_are_numbered_by_the_chapters_of_the_contents() {
    let book = files();
    let contents = String::from_utf8_lossy(&book["toc.html"]).into_owned();
    for (kind, word, least) in [("figure", "Figure", 20), ("table", "Table", 20)] {
        let (opening, mut count) = (format!("<figure id=\"{kind}-"), 0);
        // The first page is there twice.
        for (name, main) in pages().iter().filter(|(name, _)| name != "index.html") {
            for (k, element) in (1..).zip(main.split(&opening).skip(1)) {
                count += 1;
                let caption = element.split_once("<figcaption>").unwrap().1;
                let caption = caption.split_once("</figcaption>").unwrap().0;
                let label = format!(">{word} {}.{k}</a>.</strong>", chapter(&contents, name));
                assert!(caption.contains(&label), "{label}: {caption}");
                assert!(words(caption) > 3, "{caption}");
            }
        }
        assert!(count >= least, "{count} of {kind}");
    }
}

#[test]
fn every_table_has_a_caption_and_every_header_cell_a_word() {
    for (name, main) in pages() {
        // The live page makes its table itself.
        let tables = main.matches("<table>").count();
        assert_eq!(main.matches("<figure id=\"table-").count(), tables, "{name}");
        for cell in main.split("<th").skip(1).filter(|cell| !cell.starts_with("ead")) {
            let cell = cell.split_once('>').unwrap().1.split_once("</th>").unwrap().0;
            assert!(words(cell) > 0 || cell.contains("<math"), "{name}: an empty header cell");
        }
    }
}

const DRAWINGS: [&str; 4] =
    ["figure-membrane\"", "figure-grid\"", "figure-meshes\"", "figure-adapted-mesh\""];

#[test]
fn every_table_of_numbers_and_every_figure_leads_to_its_data() {
    let (mut figures, mut tables) = (0, 0);
    for (name, main) in pages() {
        let mut links = 0;
        for element in main.split("<figure id=\"").skip(1) {
            let element = element.split_once("</figure>").unwrap().0;
            let is_figure = element.starts_with("figure-");
            // Drawings of the problem, of the grid and of meshes show no numbers.
            if DRAWINGS.iter().any(|id| element.starts_with(id)) {
                continue;
            }
            let has_numbers =
                element.contains("text-align: right") || element.contains("text-align: center");
            if !is_figure && !has_numbers {
                continue;
            }
            let is_data = |tag: &str| {
                attribute(tag, "href").is_some_and(|to| {
                    ["data/", "figures/", "tables/"].iter().any(|folder| to.starts_with(folder))
                        || ["results.csv", "fields.html"].contains(&to)
                })
            };
            let source =
                if is_figure { element.split_once("<figcaption>").unwrap().1 } else { element };
            assert!(tags(source).any(is_data), "{name}: {element}");
            figures += usize::from(is_figure);
            tables += usize::from(!is_figure);
            links += source.matches("class=\"csv\"").count();
        }
        let sources = main.matches("made by <code>signorini run").count();
        assert_eq!(sources, usize::from(links > 0), "{name}");
    }
    assert!(figures >= 20 && tables >= 20, "{figures} figures, {tables} tables");
}

#[test]
fn the_book_is_short() {
    let mut total = 0;
    for (_, page) in pages().into_iter().filter(|(name, _)| name != "index.html") {
        // A formula counts as a word, code as none.
        let page = without(&without(&page, "pre"), "script").replace("<math", " x <math");
        total += words(&without(&page, "math"));
    }
    assert!(total > 10_000 && total <= 20_000, "{total} words");
}
