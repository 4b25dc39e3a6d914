"""Runs the cells of a notebook and compares their outputs with those that it keeps; with --write, keeps them.

Needs nothing but what the cells need.
"""

import ast
import contextlib
import io
import json
import sys
from pathlib import Path


def outputs(source: str, names: dict) -> list[dict]:
    """Runs a cell; returns what a notebook keeps of it: what it prints, and the value of its last line."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with contextlib.redirect_stdout(printed):
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    made = []
    if printed.getvalue():
        made.append({"name": "stdout", "output_type": "stream", "text": lines(printed.getvalue())})
    if value is not None:
        data = {"text/plain": lines(repr(value))}
        if hasattr(value, "_repr_svg_"):
            data["image/svg+xml"] = lines(value._repr_svg_())
        made.append({"data": data, "metadata": {}, "output_type": "execute_result"})
    return made


def lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def main(path: Path, write: bool) -> int:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    sys.path.insert(0, str(path.parent))
    names, count = {}, 0
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        count += 1
        source = "".join(cell["source"])
        made = outputs(source, names)
        for output in made:
            if output["output_type"] == "execute_result":
                output["execution_count"] = count
        if write:
            cell["outputs"], cell["execution_count"] = made, count
        elif made != cell["outputs"]:
            print(f"cell {count}:\n{source}\nkeeps {cell['outputs']}\nbut has {made}", file=sys.stderr)
            return 1
    if write:
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{count} cells")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), "--write" in sys.argv))
