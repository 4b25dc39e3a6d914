#!/usr/bin/env python3
"""Breaks proofs of guaranteed bounds, one place at a time, and lists the changes that no unit test sees.

    python3 tests/broken/run.py LIST.toml [FILTER ...] [--only NUMBER,...] [--seconds SECONDS]

Each `[[change]]` of a list names a `file` below src/mathematics/src, a `text` that stands there once, and what stands
in its place, `by`; a text that stands more than once is looked for in a longer one, `within`. The texts are
expressions, or statements that end with `;`. All changes are compiled at once, each behind a switch that the
environment variable BROKEN turns on; then the unit tests whose names contain a FILTER run once for each change. A test
that fails, or does not end, has seen it.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import threading
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
SWITCH = """
/// Switch of the change that is tried.
pub(crate) fn is_broken(number: usize) -> bool {
    static NUMBER: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    let chosen = NUMBER.get_or_init(|| std::env::var("BROKEN").map_or(0, |text| text.parse().expect("a number")));
    *chosen == number
}
"""


def place(change, text):
    """Span of the text of a change in the text of its file."""
    within = change.get("within", change["text"])
    for part, whole in [(within, text), (change["text"], within)]:
        if whole.count(part) != 1:
            sys.exit(f"{change['file']}: stands {whole.count(part)} times: {part!r}")
    start = text.index(within) + within.index(change["text"])
    return start, start + len(change["text"])


def switched(text, spans, start, end):
    """Text from start to end with the changes of these spans, outer ones first, behind their switches."""
    parts = []
    while spans:
        (first, last), number, by = spans[0]
        inner = [span for span in spans[1:] if span[0][1] <= last]
        spans = [span for span in spans[1:] if span[0][1] > last]
        if spans and spans[0][0][0] < last:
            sys.exit(f"changes overlap: {text[first:last]!r}")
        parts.append(text[start:first])
        other = switched(text, inner, first, last)
        choice = f"if crate::is_broken({number}) {{ {by} }} else {{ {other} }}"
        parts.append(choice if text[first:last].rstrip().endswith(";") else f"({choice})")
        start = last
    return "".join(parts) + text[start:end]


def prepare(changes, folder):
    """Copies the mathematics with all changes behind their switches."""
    shutil.rmtree(folder / "src", ignore_errors=True)
    shutil.copytree(ROOT / "src/mathematics", folder / "src/mathematics", dirs_exist_ok=True)
    for needed in ["benches", "pipeline", "tests"]:
        (folder / needed).unlink(missing_ok=True)
        (folder / needed).symlink_to(ROOT / needed)
    shutil.copy(ROOT / "Cargo.lock", folder)
    manifest = (ROOT / "Cargo.toml").read_text()
    workspace = manifest[: manifest.index("# The program.")]
    workspace = re.sub(r"(?m)^(default-)?members = .*\n", "", workspace)
    workspace = workspace.replace("[workspace]", '[workspace]\nresolver = "3"\nmembers = ["src/mathematics"]', 1)
    (folder / "Cargo.toml").write_text(workspace + '[profile.release]\nlto = "off"\nincremental = true\n')
    by_file = {}
    for number, change in enumerate(changes, 1):
        by_file.setdefault(change["file"], []).append((number, change))
    sources = folder / "src/mathematics/src"
    for file, numbered in by_file.items():
        text = (sources / file).read_text()
        spans = [(place(change, text), number, change["by"]) for number, change in numbered]
        spans.sort(key=lambda span: (span[0][0], -span[0][1]))
        (sources / file).write_text(switched(text, spans, 0, len(text)))
    with open(sources / "lib.rs", "a") as lib:
        lib.write(SWITCH)


def tests_of(folder):
    """Program of the unit tests."""
    command = ["cargo", "test", "--release", "--lib", "--no-run", "--message-format=json-render-diagnostics"]
    environment = dict(os.environ, CARGO_TARGET_DIR=str(folder / "target"), RUSTFLAGS="-Awarnings")
    built = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    messages = map(json.loads, built.stdout.splitlines())
    return next(m["executable"] for m in messages if m.get("executable"))


def outcome(program, filters, number, seconds):
    """Name of the first test that fails with a change, or the words that it does not end; None if all pass."""
    environment = dict(os.environ, BROKEN=str(number), PROPTEST_MAX_SHRINK_ITERS="0")
    # In the copy: tests leave files beside their sources.
    package = pathlib.Path(program).parents[3] / "src/mathematics"
    run = subprocess.Popen([program, *filters], cwd=package, env=environment, text=True, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL)
    timer = threading.Timer(seconds, run.kill)
    timer.start()
    with run, run.stdout:
        for line in run.stdout:
            if failed := re.match(r"test (\S+).* FAILED$", line):
                run.kill()
                return failed[1]
    is_over = timer.is_alive()
    timer.cancel()
    return None if run.returncode == 0 else "the program" if is_over else "time: it does not end"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("list", type=pathlib.Path)
    parser.add_argument("filters", nargs="*")
    parser.add_argument("--only", help="numbers of changes")
    parser.add_argument("--seconds", type=float, default=300.0, help="most seconds of a run")
    options = parser.parse_args()
    changes = tomllib.loads(options.list.read_text())["change"]
    folder = ROOT / "target/broken" / options.list.stem
    prepare(changes, folder)
    program = tests_of(folder)
    if outcome(program, options.filters, 0, options.seconds) is not None:
        sys.exit("the tests fail without a change")
    numbers = [int(n) for n in options.only.split(",")] if options.only else range(1, len(changes) + 1)
    survived = 0
    for number in numbers:
        change = changes[number - 1]
        seen = outcome(program, options.filters, number, options.seconds)
        survived += seen is None
        verdict = f"seen by {seen}" if seen else "SURVIVES"
        print(f"{number:3} {change['file']}: {change['text']!r} -> {change['by']!r}: {verdict}", flush=True)
    print(f"{survived} of {len(numbers)} survive")


main()
