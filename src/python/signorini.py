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
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

__all__ = ["Refused", "Solution", "picture", "solve", "study"]


class Refused(Exception):
    """What was asked for has no answer; the text names the remedy."""


@dataclass(frozen=True, repr=False)
class Solution:
    """A solution, with N nodes of which C in a cell; if there is a `failure`, what the solver reached without it."""

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
    #: f in each cell, M: on the square its value at the centre, on a mesh its mean.
    f: np.ndarray
    #: Of `at` and `line`, for each point a dictionary of `point`, `v` and `gradient`, both None outside the domain.
    values: list[dict]
    #: Doubts about the solution, a sentence each.
    warnings: list[str]
    #: Reason why this is no solution, or not as accurate as asked; None if it is.
    failure: str | None
    #: All that `signorini solve --json` says.
    answer: dict

    def __repr__(self) -> str:
        end = f", {self.failure}" if self.failure else ""
        return f"<solution, {self.answer['f']}, energy {self.energy:.7g}, {len(self.v)} nodes{end}>"


def solve(f: str, **options) -> Solution:
    """Solves one problem, as `signorini solve --f F` with these options does.

    Raises Refused, with the sentence that the program prints, if there is nothing to show. What the solver reached
    without a solution, or without the accuracy that was asked for, is returned with its `failure`.
    """
    _refuse_out(options)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "solution.npz"
        answer = json.loads(_run(["--f", f, *_words(options), "--json", "--out", str(file)]))
        with np.load(file) as arrays:
            arrays = {name: arrays[name] for name in arrays.files}
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
        values=answer.get("values") or [],
        warnings=answer["warnings"],
        failure=answer["failure"],
        answer=answer,
    )


def study(vary: dict, f: str | None = None, **options) -> dict[str, np.ndarray]:
    """Solves one problem for each combination of values, beside each other; returns the table by its columns.

    `vary` has the values of options, or of names in f: {"R": [0.1, 0.2]} with f="disc(0,0,$R)=4; else=-1"; f may be
    one of the options, and a value of several parts or grids is a list: {"fixed": [["top", "left"], "top"]}. Where a
    member has no solution, `reason` says why, and its numbers are nan, or those where the solver ended; `warnings` has
    a list of sentences for each member.
    """
    _refuse_out(options)
    words = [] if f is None else ["--f", f]
    for name, values in vary.items():
        texts = [_value(name, value) for value in (values if _is_list(values) else [values])]
        words += ["--vary", f"{name}={''.join(text + '|' for text in texts)}"]
    if not vary:
        raise Refused('nothing is varied; give the values of an option, as in study({"friction": [0.2, 0.4]}, f=F)')
    rows = [json.loads(line) for line in _run([*words, *_words(options), "--json"]).splitlines()]
    names = [name.replace("-", "_") for name in vary]
    found = {name: None for row in rows for name in row if name not in [*names, "schema", "varied"]}
    varied = {name: _column([row["varied"][name] for row in rows]) for name in names}
    return varied | {name: _column([row.get(name) for row in rows]) for name in found}


def _value(name: str, value) -> str:
    """A value as `--vary` has it."""
    text = ",".join(map(str, value)) if isinstance(value, (list, tuple, np.ndarray)) else str(value)
    if "|" in text:
        raise Refused(f"{name}: a value with | cannot be varied; solve it alone")
    return text


class Picture(str):
    """An SVG, which notebooks draw; if there is a `failure`, of what the solver reached without a solution."""

    failure: str | None = None

    def _repr_svg_(self) -> str:
        return str(self)

    def __repr__(self) -> str:
        return f"<picture, {self.split('<title>')[1].split('</title>')[0]}>"


#: Kinds of pictures.
_VIEWS = ("map", "surface", "mesh")


def picture(f: str, view: str = "map", **options) -> Picture:
    """Draws a solution: a `view` of "map", "surface" or "mesh"."""
    _refuse_out(options)
    if view not in _VIEWS:
        raise Refused(f"view {view!r}: choose one of {', '.join(_VIEWS)}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.svg"
        answer = json.loads(_run(["--f", f, *_words(options), "--" + view, "--json", "--out", str(file)]))
        drawn = Picture(file.read_text(encoding="utf-8"))
    drawn.failure = answer["failure"]
    return drawn


def _column(values: list) -> np.ndarray:
    """Numbers, with nan where there are none, or texts, or lists of them."""
    if any(isinstance(value, (list, dict)) for value in values):
        column = np.empty(len(values), dtype=object)
        for k, value in enumerate(values):
            column[k] = value
        return column
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


def _refuse_out(options: dict) -> None:
    """Refuses a file for the answer, which is returned."""
    if "out" in options:
        raise Refused("out: the answer is returned; leave it out, and write what is returned")


def _is_list(value: object) -> bool:
    """True for lists, tuples, arrays and the like."""
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes, dict))


def _text(value: object) -> str:
    """A value as an option has it; numbers, as of a point, with commas between them."""
    return ",".join(str(number) for number in value) if _is_list(value) else str(value)


def _words(options: dict) -> list[str]:
    """Options as words; True gives an option without a value.

    A list of texts or lists gives an option several times, and so does a dictionary, as {"hole": (0, 0, 1)} of curves.
    """
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            words += [f"{option}={text}" for text in _texts(value)]
    return words


def _texts(value: object) -> list[str]:
    """Values of an option, one for each time that it is given."""
    if isinstance(value, dict):
        return [f"{part}={_text(numbers)}" for part, numbers in value.items()]
    values = list(value) if _is_list(value) else [value]
    is_one = not any(isinstance(one, str) or _is_list(one) for one in values)
    return [_text(values)] if is_one else [_text(one) for one in values]


def _program() -> str:
    named = os.environ.get("SIGNORINI") or shutil.which("signorini")
    built = Path(__file__).resolve().parents[2] / "target" / "release" / "signorini"
    if not named and not built.exists():
        raise Refused("no program signorini on the path; install it, or name it by the variable SIGNORINI")
    return named or str(built)


#: Exit code of the program for an answer that is not what was asked for.
_NOT_AS_ASKED = 3


def _run(words: list[str]) -> str:
    """Standard output of `solve`."""
    command = [_program(), "solve", *words]
    # The program reads and writes UTF-8, whatever the locale.
    encoded = [word.encode("utf-8", "surrogateescape") for word in command] if os.name == "posix" else command
    try:
        done = subprocess.run(encoded, capture_output=True, encoding="utf-8", check=False)
    except OSError as error:
        reason = error.strerror or error
        raise Refused(f"{command[0]}: {reason}; name the program by the variable SIGNORINI") from error
    has_answer = done.returncode == 0 or (done.returncode == _NOT_AS_ASKED and done.stdout)
    if not has_answer:
        raise Refused(_sentence(done.stderr) or f"exit code {done.returncode}")
    return done.stdout


def _sentence(stderr: str) -> str:
    """The error of the program, with the values to choose from and the tip."""
    _, _, error = ("\n" + stderr).partition("\nerror: ")
    lines = []
    for line in error.splitlines():
        if line.startswith(("Usage:", "For more information")):
            break
        line = line.strip()
        lines += [("; " if line.startswith("tip: ") else " ") + line] if line else []
    return "".join(lines).strip()
