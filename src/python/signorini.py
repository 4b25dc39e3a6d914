"""Solutions and studies of the program `signorini` as NumPy arrays.

One file, which needs Python 3.9 and NumPy; copy it beside your own.

    import signorini
    disc = signorini.solve(f="halfplane(0,1,0)=-3; else=1.5", domain="disc", refine=4)
    disc.energy, disc.bounds, disc.v.max()
    table = signorini.study({"friction": [0.8, 1.6], "refine": [2, 3]}, f=..., domain="disc")

Keywords are the options of `signorini solve`, with _ in place of -. The program is the one that the variable SIGNORINI
of the environment names, or else the one on the path, or else the one that this clone has built.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

__all__ = ["Refused", "Solution", "picture", "solve", "study"]


class Refused(Exception):
    """What was asked for has no answer; the text names the remedy."""


@dataclass(frozen=True)
class Solution:
    """A solution, with N nodes of which C in a cell."""

    energy: float
    #: Guaranteed bracket of the energy, and bounds of the error in the energy norm; None where there are none.
    bounds: tuple[float, float] | None
    error: tuple[float, float] | None
    #: Flux through the boundary where the law holds.
    force: float
    #: Arcs in contact, as the JSON has them; None in space.
    contact: list[dict] | None
    #: Coordinates of the nodes, N x 2 or N x 3.
    points: np.ndarray
    #: Numbers of the nodes of each cell, M x C, anticlockwise.
    cells: np.ndarray
    #: Nodal values, N.
    v: np.ndarray
    #: Flux over the boundary at the nodes, N; 0 inside.
    multiplier: np.ndarray
    #: Mean of f on each cell, M.
    f: np.ndarray
    #: All that `signorini solve --json` says.
    answer: dict


def solve(f: str, **options) -> Solution:
    """Solves one problem, as `signorini solve --f F` with these options does.

    Raises Refused, with the line that the program prints.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "solution.npz"
        text = _run(["--f", f, *_words(options), "--json", "--out", str(file)])
        with np.load(file) as arrays:
            arrays = {name: arrays[name] for name in arrays.files}
    answer = json.loads(text)
    if "points" not in arrays:
        arrays.update(_square(arrays["v"].shape[0] - 1))
    bound = answer.get("bound") or {}
    return Solution(
        energy=answer["energy"],
        bounds=tuple(bound["energy"]) if bound else None,
        error=tuple(bound["error"]) if bound else None,
        force=answer["force"],
        contact=answer["contact"],
        points=arrays["points"],
        cells=arrays["cells"],
        v=arrays["v"].ravel(),
        multiplier=arrays["multiplier"].ravel(),
        f=arrays["f"].ravel(),
        answer=answer,
    )


def study(vary: dict[str, list], f: str | None = None, **options) -> dict[str, np.ndarray]:
    """Solves one problem for each combination of values, beside each other; returns the table by its columns.

    `vary` has the values of options, or of names in f: {"R": [0.1, 0.2]} with f="disc(0,0,$R)=4; else=-1", and of f
    itself if f is not given. A value of several parts or grids is a list: {"fixed": [["top", "left"], "top"]}. Where a
    member has no solution, its numbers are nan, and `reason` says why.
    """
    if not vary:
        raise Refused("nothing is varied; give the values of an option, as in study({\"friction\": [0.2, 0.4]}, f=F)")
    words = [] if f is None else ["--f", f]
    for name, values in vary.items():
        texts = [_value(name, value) for value in ([values] if np.isscalar(values) else values)]
        words += ["--vary", f"{name}={''.join(text + '|' for text in texts)}"]
    lines = _run([*words, *_words(options), "--json"], may_fail=True).splitlines()
    rows = [json.loads(line) for line in lines]
    names = [name.replace("-", "_") for name in vary]
    found = [name for name in rows[0] if name not in [*names, "schema"]]
    return {name: _column([row[name] for row in rows]) for name in [*names, *found]}


def _value(name: str, value) -> str:
    """A value as `--vary` has it."""
    text = ",".join(map(str, value)) if isinstance(value, (list, tuple, np.ndarray)) else str(value)
    if "|" in text:
        raise Refused(f"{name}: a value with | cannot be varied; solve it alone")
    return text


class Picture(str):
    """An SVG, which notebooks draw."""

    def _repr_svg_(self) -> str:
        return str(self)

    def __repr__(self) -> str:
        return f"<picture, {self.split('<title>')[1].split('</title>')[0]}>"


def picture(f: str, view: str = "map", **options) -> Picture:
    """Draws a solution: a `view` of "map", "surface" or "mesh"."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.svg"
        _run(["--f", f, *_words(options), "--" + view, "--out", str(file)])
        return Picture(file.read_text(encoding="utf-8"))


def _column(values: list) -> np.ndarray:
    """Numbers, with nan where there are none, or texts."""
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else str(value) for value in values])
    if all(isinstance(value, int) for value in values):
        return np.array(values)
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _square(n: int) -> dict[str, np.ndarray]:
    """Nodes and cells of the square with n cells per side, in the order of its arrays."""
    side = np.linspace(-0.5, 0.5, n + 1)
    x, y = np.meshgrid(side, side)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = corner[:, None] + np.array([0, 1, n + 2, n + 1])
    return {"points": np.column_stack([x.ravel(), y.ravel()]), "cells": cells}


def _words(options: dict) -> list[str]:
    """Options as words; a list gives an option several times, and True gives one without a value."""
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            several = value if isinstance(value, (list, tuple)) else [value]
            words += [f"{option}={one}" for one in several]
    return words


def _program() -> str:
    named = os.environ.get("SIGNORINI") or shutil.which("signorini")
    built = Path(__file__).resolve().parents[2] / "target" / "release" / "signorini"
    if not named and not built.exists():
        raise Refused("no program signorini on the path; install it, or name it by the variable SIGNORINI")
    return named or str(built)


def _run(words: list[str], may_fail: bool = False) -> str:
    """Standard output of `solve`. A study with members, but without a solution, may fail."""
    done = subprocess.run([_program(), "solve", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0 and not (may_fail and done.stdout):
        last = done.stderr.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
        raise Refused(last[0].removeprefix("error: "))
    return done.stdout
