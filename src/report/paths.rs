//! Paths that users write, in `book.toml` and in the list of the pages.

use std::path::{Component, Path};

/// True if a path cannot lead out of the folder where it begins.
pub(super) fn is_inside(path: &str) -> bool {
    let is_down = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
    !path.is_empty() && !path.contains('\\') && Path::new(path).components().all(is_down)
}

/// Returns a path that leads nowhere upwards, without its steps `.`.
pub(super) fn plain(path: &str) -> String {
    let steps = path.split('/').filter(|step| !["", "."].contains(step));
    steps.collect::<Vec<_>>().join("/")
}

/// Returns the path without steps upwards; `None` for one that leads out of the folder where it begins.
pub(super) fn below(path: &str) -> Option<String> {
    let mut steps = Vec::new();
    for step in path.split('/') {
        match step {
            "" if steps.is_empty() => return None,
            "" | "." => (),
            ".." => _ = steps.pop()?,
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leads_out_is_told_from_what_stays_inside() {
        for path in ["a", "./a/b", "a//b", "a/./b"] {
            assert!(is_inside(path), "{path}");
        }
        for path in ["", "/a", "..", "a/../b", "a\\b"] {
            assert!(!is_inside(path), "{path}");
        }
        assert_eq!(plain("./a//b/."), "a/b");
        assert_eq!(below("./a/../b.md").as_deref(), Some("b.md"));
        assert_eq!([below("/a"), below("../a"), below("a/../../b")], [const { None }; 3]);
    }
}
