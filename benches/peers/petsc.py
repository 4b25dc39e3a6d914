"""PETSc's best configuration beside ours, on the same load vectors, one thread, one machine, one run.

SNES vinewtonrsls with CG and hypre, started by nested iteration from h = 1/16 as a user would do it by
hand. Needs Debian's python3-petsc4py, which this script installs if it may; not needed to build or test.

    python3 benches/peers/petsc.py [N ...]        finest grids, default 64 256 1024

Ours stops at the residual that PETSc has reached; in the last columns it goes to the rounding floor. Both
repeat in one process; the times of PETSc leave out the assembly of its matrices and vectors, ours the
allocation of the workspace.

What it prints last can be put at the end of pipeline/timings.toml, if that was recorded on the same
machine; the book then shows it, and `signorini bench --record` keeps it.
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

petsc4py.init(["-snes_type", "vinewtonrsls", "-ksp_type", "cg", "-pc_type", "hypre"])
import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

REPEATS = 5
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
    """The five-point stiffness matrix with its half edges, as PETSc AIJ."""
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
    csr = (starts.astype("i4"), (key % size).astype("i4"), entries)
    matrix = PETSc.Mat().createAIJ((size, size), csr=csr)
    matrix.assemble()
    return matrix


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


def solve(n, values):
    """Seconds in SNES over all grids, and the relative KKT residual on the finest."""
    seconds, size, y = 0.0, 16, np.zeros(17 * 17)
    while True:
        matrix, f, edge = stiffness(size), load(size, values), boundary(size)
        rhs = PETSc.Vec().createWithArray(f)
        unknown = PETSc.Vec().createWithArray(y.copy())
        lower, upper = matrix.createVecRight(), matrix.createVecRight()
        lower.setArray(np.where(edge, 0.0, PETSc.NINFINITY))
        upper.set(PETSc.INFINITY)

        def residual(snes, v, out):
            matrix.mult(v, out)
            out.axpy(-1.0, rhs)

        snes = PETSc.SNES().create()
        snes.setFunction(residual, matrix.createVecLeft())
        snes.setJacobian(lambda *_: None, matrix)
        snes.setVariableBounds(lower, upper)
        snes.setTolerances(rtol=1e-12, atol=1e-9 * np.linalg.norm(f), stol=0, max_it=100)
        snes.getKSP().setTolerances(rtol=1e-3 if size < n else 1e-8)
        snes.setFromOptions()
        start = time.perf_counter()
        snes.solve(None, unknown)
        seconds += time.perf_counter() - start
        y = unknown.getArray().copy()
        if size == n:
            return seconds, relative_kkt(matrix, y, f, edge), snes.getConvergedReason()
        y, size = prolong(size, y), 2 * size


def ours(n, values, tolerance):
    """Median seconds and relative KKT residual of multigrid, to the tolerance and to the rounding floor."""
    f = f"quadrant(ll)={values[0]}; else={values[1]}"
    command = ["cargo", "bench", "--quiet", "--bench", "multigrid", "--"]
    command += ["1", str(REPEATS), str(n), "--f", f, repr(tolerance)]
    answers = json.loads(subprocess.check_output(command, cwd=ROOT))
    return [(answer["ns"] * 1e-9 * (n + 1) ** 2, answer["kkt"]) for answer in answers]


def main():
    print("# microseconds per unknown, median of", REPEATS, "runs; KKT residuals relative to the load")
    print(f"# {'1/h':>6} {'f':>11} {'PETSc':>9} {'KKT':>9} {'ours':>9} {'KKT':>9} {'ratio':>7} {'ours, floor':>12} {'ratio':>7}")
    records = []
    for n in [int(arg) for arg in sys.argv[1:]] or [64, 256, 1024]:
        for values in [(-6, 1.998), (-6, 1.0)]:
            runs = [solve(n, values) for _ in range(REPEATS)]
            theirs, their_kkt = statistics.median(run[0] for run in runs), runs[0][1]
            (equal, equal_kkt), (floor, _) = ours(n, values, float(their_kkt))
            micro = 1e6 / (n + 1) ** 2
            print(
                f"# {n:6} {str(values):>11} {theirs * micro:9.3f} {their_kkt:9.1e} {equal * micro:9.4f} "
                f"{equal_kkt:9.1e} {theirs / equal:7.0f} {floor * micro:12.4f} {theirs / floor:7.0f}"
                + ("" if runs[0][2] > 0 else f"  (SNES did not converge: {runs[0][2]})"),
                flush=True,
            )
            records += ["", "[[peer]]", 'solver = "PETSc, SNES vinewtonrsls, CG, hypre, nested"']
            records += [f'f = "quadrant(ll)={values[0]}; else={values[1]}"', f"cells = {n}"]
            records += [f"theirs = {theirs * micro:.3f}", f"their_kkt = {their_kkt:.1e}"]
            records += [f"ours = {equal * micro:.4f}", f"our_kkt = {equal_kkt:.1e}", "warm = true"]
    print("\n".join(records))


main()
