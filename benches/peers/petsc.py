"""PETSc's two best configurations beside ours, on the same load vectors, one thread, one machine, one run.

SNES vinewtonrsls, started by nested iteration from h = 1/16 as a user would do it by hand, with CG and either
hypre or geometric multigrid on a DMDA. Needs Debian's python3-petsc4py, which this script installs if it may;
not needed to build or test.

    python3 benches/peers/petsc.py [N ...]        finest grids, default 64 256 1024

Ours stops at the residual that PETSc has reached. Timed twice: the solution of assembled systems, repeated in one
process; and from f to the solution vector, with memory, load vector and matrix. Of the latter, PETSc's side
counts what PETSc does (matrices and vectors from arrays that are there), ours everything.

What it prints last can be put at the end of pipeline/timings.toml, if that was recorded on the same
machine; the book then shows it.
"""

import glob
import json
import os
import statistics
import subprocess
import sys
import time

if "OMP_NUM_THREADS" not in os.environ:
    os.environ["OMP_NUM_THREADS"] = "1"
    os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])

DEBIAN = "/usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages"
if not glob.glob(DEBIAN):
    subprocess.run(["apt-get", "install", "-y", "python3-petsc4py"], check=True, stdout=subprocess.DEVNULL)
sys.path[:0] = glob.glob(DEBIAN)
import petsc4py  # noqa: E402

petsc4py.init()
import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

REPEATS = 5
COMMON = {"snes_type": "vinewtonrsls", "ksp_type": "cg"}
CONFIGURATIONS = {
    "hypre": {"pc_type": "hypre"},
    "DMDA": {
        "pc_type": "mg",
        "pc_mg_galerkin": "both",
        "mg_levels_ksp_type": "richardson",
        "mg_levels_ksp_max_it": 1,
        "mg_levels_pc_type": "sor",
    },
}
# Of the inner solver on the finest grid: what makes each the faster.
INNER = {"hypre": 1e-8, "DMDA": 1e-4}
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def load(n, values):
    """f at the nodes (axes to the lower left) times the integral of the hat function, rising diagonals."""
    t = np.arange(n + 1) / n - 0.5
    x, y = np.meshgrid(t, t)
    ll, elsewhere = values
    f = np.where((x <= 0) & (y <= 0), ll, elsewhere)
    w = np.ones((n + 1, n + 1))
    w[0, :] = w[-1, :] = w[:, 0] = w[:, -1] = 0.5
    w[0, 0] = w[-1, -1] = 1 / 3
    w[0, -1] = w[-1, 0] = 1 / 6
    return (w * f / n**2).ravel()


def stiffness(n):
    """The five-point stiffness matrix with its half edges: its size, and its compressed rows."""
    index = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    rows, cols, entries = [], [], []
    across = np.ones((n + 1, n))
    across[0], across[-1] = 0.5, 0.5
    for a, b, weight in [
        (index[:, :-1], index[:, 1:], across),
        (index[:-1, :], index[1:, :], across.T),
    ]:
        for p, q in [(a, b), (b, a)]:
            rows += [p.ravel(), p.ravel()]
            cols += [q.ravel(), p.ravel()]
            entries += [-weight.ravel(), weight.ravel()]
    size = (n + 1) ** 2
    key = np.concatenate(rows) * size + np.concatenate(cols)
    key, position = np.unique(key, return_inverse=True)
    entries = np.bincount(position, np.concatenate(entries))
    starts = np.concatenate([[0], np.cumsum(np.bincount(key // size, minlength=size))])
    return (size, size), (starts.astype("i4"), (key % size).astype("i4"), entries)


def boundary(n):
    mask = np.zeros((n + 1, n + 1), bool)
    mask[0, :] = mask[-1, :] = mask[:, 0] = mask[:, -1] = True
    return mask.ravel()


def prolong(n, y):
    coarse = y.reshape(n + 1, n + 1)
    fine = np.zeros((2 * n + 1, 2 * n + 1))
    fine[::2, ::2] = coarse
    fine[::2, 1::2] = 0.5 * (coarse[:, :-1] + coarse[:, 1:])
    fine[1::2, :] = 0.5 * (fine[:-2:2, :] + fine[2::2, :])
    return fine.ravel()


def relative_kkt(matrix, y, f, edge):
    vector = PETSc.Vec().createWithArray(y.copy())
    slope = matrix.createVecLeft()
    matrix.mult(vector, slope)
    g = slope.getArray() - f
    return np.max(np.abs(np.where(edge, np.minimum(y, g), g))) / np.max(np.abs(f))


def solve(n, values, name):
    """Seconds in SNES and in assembly over all grids, and the relative KKT residual on the finest."""
    seconds, assembly, size, y = 0.0, 0.0, 16, np.zeros(17 * 17)
    while True:
        (shape, csr), f, edge = stiffness(size), load(size, values), boundary(size)
        bound = np.where(edge, 0.0, PETSc.NINFINITY)
        start = time.perf_counter()
        matrix = PETSc.Mat().createAIJ(shape, csr=csr)
        matrix.assemble()
        rhs = PETSc.Vec().createWithArray(f)
        unknown = PETSc.Vec().createWithArray(y.copy())
        lower, upper = matrix.createVecRight(), matrix.createVecRight()
        lower.setArray(bound)
        upper.set(PETSc.INFINITY)
        assembly += time.perf_counter() - start

        def residual(snes, v, out):
            matrix.mult(v, out)
            out.axpy(-1.0, rhs)

        snes = PETSc.SNES().create()
        snes.setOptionsPrefix(name + "_")
        options = PETSc.Options(name + "_")
        for option, value in {**COMMON, **CONFIGURATIONS[name]}.items():
            options[option] = value
        if name == "DMDA":
            options["pc_mg_levels"] = int(np.log2(size)) - 2
            snes.setDM(PETSc.DMDA().create([size + 1, size + 1], dof=1, stencil_width=1))
        snes.setFunction(residual, matrix.createVecLeft())
        snes.setJacobian(lambda *_: None, matrix)
        snes.setVariableBounds(lower, upper)
        snes.setTolerances(rtol=1e-12, atol=1e-9 * np.linalg.norm(f), stol=0, max_it=100)
        snes.getKSP().setTolerances(rtol=1e-3 if size < n else INNER[name])
        snes.setFromOptions()
        start = time.perf_counter()
        snes.solve(None, unknown)
        seconds += time.perf_counter() - start
        y = unknown.getArray().copy()
        if size == n:
            return seconds, assembly, relative_kkt(matrix, y, f, edge), snes.getConvergedReason()
        y, size = prolong(size, y), 2 * size


def ours(n, values, tolerance):
    """Median seconds of multigrid to the tolerance, alone and from f, and its relative KKT residual."""
    command = ["cargo", "bench", "--quiet", "--bench", "multigrid", "--"]
    command += ["1", str(REPEATS), str(n), "--f", text(values), repr(tolerance)]
    answer = json.loads(subprocess.check_output(command, cwd=ROOT))
    unknowns = (n + 1) ** 2
    return answer["ns"] * 1e-9 * unknowns, answer["whole_ns"] * 1e-9 * unknowns, answer["kkt"]


def text(values):
    return f"quadrant(ll)={values[0]}; else={values[1]}"


def main():
    print("# microseconds per unknown, median of", REPEATS, "runs; KKT residuals relative to the load")
    header = ["1/h", "f", "PETSc", "whole", "KKT", "ours", "whole", "KKT", "ratio", "whole"]
    print("#", " ".join(f"{word:>10}" for word in ["with", *header]))
    records = []
    for n in [int(arg) for arg in sys.argv[1:]] or [64, 256, 1024]:
        for values in [(-6, 1.998), (-6, 1.0)]:
            for name in CONFIGURATIONS:
                runs = [solve(n, values, name) for _ in range(REPEATS)]
                if runs[0][3] <= 0:
                    print(f"# {name}, {n}, {text(values)}: SNES did not converge: {runs[0][3]}")
                    continue
                alone = statistics.median(run[0] for run in runs)
                whole = statistics.median(run[0] + run[1] for run in runs)
                kkt = runs[0][2]
                mine, my_whole, my_kkt = ours(n, values, float(kkt))
                micro = 1e6 / (n + 1) ** 2
                row = [f"{alone * micro:.3f}", f"{whole * micro:.3f}", f"{kkt:.1e}"]
                row += [f"{mine * micro:.4f}", f"{my_whole * micro:.4f}", f"{my_kkt:.1e}"]
                row += [f"{alone / mine:.0f}", f"{whole / my_whole:.0f}"]
                words = [name, str(n), str(values).replace(" ", ""), *row]
                print("#", " ".join(f"{word:>10}" for word in words), flush=True)
                for from_f, theirs, time_of_ours in [(False, alone, mine), (True, whole, my_whole)]:
                    records += ["", "[[peer]]", f'solver = "PETSc, SNES vinewtonrsls, CG, {name}, nested"']
                    records += [f'f = "{text(values)}"', f"cells = {n}"]
                    records += [f"theirs = {theirs * micro:.3f}", f"their_kkt = {kkt:.1e}"]
                    records += [f"ours = {time_of_ours * micro:.4f}", f"our_kkt = {my_kkt:.1e}"]
                    records += ["whole = true"] if from_f else []
    print("\n".join(records))


main()
