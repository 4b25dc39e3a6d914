"""PETSc and pyamg beside our solver on triangulations: the same matrices, the same residual, one thread, one run.

PETSc: SNES vinewtonrsls with CG and hypre, nested over the refinements. pyamg: primal-dual active set, nested too, with
CG preconditioned by smoothed aggregation. Needs Debian's python3-petsc4py, numpy, scipy and pyamg; not needed to
build or test.

    python3 benches/peers/meshes.py [REFINEMENTS IN THE PLANE] [IN SPACE]
    python3 benches/peers/meshes.py own            fine meshes of Gmsh, without a coarser one; needs gmsh

The meshes come from `signorini solve --out`; both sides count what follows the assembly of matrix and load, ours also
the set-up of the cycle. Ours stops at the residual that the peer has reached. The last column counts our guaranteed
bounds as well, which no peer has.
"""

import glob
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

if "OMP_NUM_THREADS" not in os.environ:
    os.environ["OMP_NUM_THREADS"] = "1"
    os.environ["RAYON_NUM_THREADS"] = "1"
    os.execv(sys.executable, [sys.executable, *sys.argv])

sys.path[:0] = glob.glob("/usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages")
import numpy as np  # noqa: E402
import petsc4py  # noqa: E402

petsc4py.init()
import pyamg  # noqa: E402
import scipy.sparse as sparse  # noqa: E402
import scipy.sparse.linalg as linalg  # noqa: E402
from petsc4py import PETSc  # noqa: E402

REPEATS = 3
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PROGRAM = os.path.join(ROOT, "target", "release", "signorini")
GEAR = os.path.join(ROOT, "tests", "meshes", "gear.msh")
PLANE, SPACE = "rect(-9,0,-9,0)=-6; else=1", "box(-9,0,-9,0,-9,0)=-9; else=1"
CASES = [
    ("disc", ["--domain", "disc"], PLANE, 8, 0),
    ("lshape", ["--domain", "lshape"], "rect(-9,0,-9,0)=3; else=-2", 8, 0),
    ("annulus", ["--domain", "annulus"], PLANE, 7, 0),
    ("gear", ["--domain", GEAR, "--free", "hole"], PLANE, 5, 0),
    ("ball", ["--domain", "ball"], SPACE, 5, 5),
]


def own_cases(folder):
    """Meshes of about 10^4 to 10^6 nodes; the third has few nodes in contact."""
    import own

    corner = "rect(-9,0,-9,0)=3; else=-2"
    cases = [
        ("disc-4", own.disc(0.0195), PLANE),
        ("disc-5", own.disc(0.006), PLANE),
        ("disc-5", own.disc(0.006), "formula(5*x-0.0002)"),
        ("disc-6", own.disc(0.0018), PLANE),
        ("graded", own.graded(1e-4, 0.02), corner),
        ("layers-30", own.layers(0.009, 30), PLANE),
        ("layers-1000", own.layers(0.009, 1000), PLANE),
        ("ball-4", own.ball(0.048), SPACE),
        ("ball-5", own.ball(0.028), SPACE),
    ]
    return [(name, ["--domain", own.written(name, make, folder)], f, 0, 0) for name, make, f in cases]



def run(arguments, f, refine, *more):
    command = [PROGRAM, "solve", *arguments, "--f", f, "--refine", str(refine), "--json", *more]
    return json.loads(subprocess.check_output(command))


class Level:
    """Matrix and load of one refinement, the nodes in contact, and the interpolation from the mesh before."""

    def __init__(self, arguments, f, refine, folder):
        path = os.path.join(folder, "mesh.npz")
        run(arguments, f, refine, "--out", path)
        with np.load(path) as data:
            points, cells, values = data["points"], data["cells"], data["f"]
        dimension, vertices = points.shape[1], cells.shape[1]
        corners = points[cells]
        edges = corners[:, 1:] - corners[:, :1]
        volume = np.abs(np.linalg.det(edges)) / (2 if dimension == 2 else 6)
        slopes = np.linalg.inv(edges)
        slopes = np.concatenate([-slopes.sum(axis=2, keepdims=True), slopes], axis=2)
        local = np.einsum("cdi,cdj->cij", slopes, slopes) * volume[:, None, None]
        rows = np.repeat(cells, vertices, axis=1).ravel()
        size = len(points)
        matrix = sparse.coo_matrix((local.ravel(), (rows, np.tile(cells, vertices).ravel())), (size, size))
        self.matrix = matrix.tocsr()
        self.matrix.data[np.abs(self.matrix.data) < 1e-13 * np.abs(self.matrix.data).max()] = 0
        self.matrix.eliminate_zeros()
        share = np.repeat((values * volume / vertices)[:, None], vertices, axis=1)
        self.load = np.bincount(cells.ravel(), share.ravel(), size)
        sides = np.concatenate([np.delete(cells, k, axis=1) for k in range(vertices)])
        sides, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
        edge = sides[count == 1]
        if "--free" in arguments:
            edge = edge[np.linalg.norm(points[edge].mean(axis=1), axis=1) > 0.5]
        self.contact = np.zeros(size, bool)
        self.contact[edge.ravel()] = True
        pairs = [(i, j) for i in range(vertices) for j in range(i)]
        edges = np.concatenate([cells[:, pair] for pair in pairs])
        self.edges = np.unique(np.sort(edges, axis=1), axis=0)

    def refined(self, y):
        """Values on the next mesh, whose new nodes are the midpoints of the edges in their order."""
        return np.concatenate([y, y[self.edges].mean(axis=1)])

    def residual(self, y):
        slope = self.matrix @ y - self.load
        return np.abs(np.where(self.contact, np.minimum(y, slope), slope)).max() / np.abs(self.load).max()


def petsc(levels):
    seconds, y = 0.0, np.zeros(len(levels[0].load))
    for k, level in enumerate(levels):
        csr = level.matrix
        matrix = PETSc.Mat().createAIJ(csr.shape, csr=(csr.indptr, csr.indices, csr.data))
        matrix.assemble()
        rhs, unknown = PETSc.Vec().createWithArray(level.load), PETSc.Vec().createWithArray(y.copy())
        lower, upper = matrix.createVecRight(), matrix.createVecRight()
        lower.setArray(np.where(level.contact, 0.0, PETSc.NINFINITY))
        upper.set(PETSc.INFINITY)

        def gradient(snes, v, out):
            matrix.mult(v, out)
            out.axpy(-1.0, rhs)

        snes = PETSc.SNES().create()
        options = PETSc.Options()
        options["snes_type"], options["ksp_type"], options["pc_type"] = "vinewtonrsls", "cg", "hypre"
        snes.setFunction(gradient, matrix.createVecLeft())
        snes.setJacobian(lambda *_: None, matrix)
        snes.setVariableBounds(lower, upper)
        snes.setTolerances(rtol=1e-12, atol=1e-9 * np.linalg.norm(level.load), stol=0, max_it=100)
        snes.getKSP().setTolerances(rtol=1e-3 if k + 1 < len(levels) else 1e-8)
        snes.setFromOptions()
        start = time.perf_counter()
        snes.solve(None, unknown)
        seconds += time.perf_counter() - start
        y = unknown.getArray().copy()
        if k + 1 < len(levels):
            y = level.refined(y)
    return seconds, y


def active_set(levels):
    seconds, y, slope = 0.0, None, None
    for k, level in enumerate(levels):
        matrix, load = level.matrix, level.load
        start = time.perf_counter()
        if y is None:
            y, held = np.zeros(len(load)), level.contact.copy()
        else:
            held = level.contact & (y <= 1e-12 * np.abs(y).max())
        for _ in range(50):
            free = np.flatnonzero(~held)
            inner = matrix[free][:, free]
            guess = np.where(held, 0.0, y)[free]
            tolerance = 1e-8 if k + 1 == len(levels) else 1e-3
            hierarchy = pyamg.smoothed_aggregation_solver(inner, max_coarse=50)
            solution = hierarchy.solve(load[free], x0=guess, tol=tolerance, accel="cg")
            y = np.zeros(len(load))
            y[free] = solution
            slope = matrix @ y - load
            following = level.contact & np.where(held, slope >= 0, y < 0)
            if (following == held).all():
                break
            held = following
        seconds += time.perf_counter() - start
        if k + 1 < len(levels):
            y = level.refined(np.where(level.contact, np.maximum(y, 0), y))
    return seconds, y


def main():
    is_own = sys.argv[1:] == ["own"]
    cases = own_cases(tempfile.gettempdir()) if is_own else CASES
    more = [] if is_own else [int(argument) for argument in sys.argv[1:]]
    print("# microseconds per unknown, medians; KKT residuals over the largest load")
    print(f"# {'domain':>11} {'unknowns':>9} {'peer':>7} {'theirs':>8} {'KKT':>8} {'ours':>8} {'KKT':>8} {'ratio':>6} {'bounds':>6}")
    for name, arguments, f, refine, space in cases:
        if more:
            refine = more[-1] if space else more[0]
        with tempfile.TemporaryDirectory() as folder:
            levels = [Level(arguments, f, times, folder) for times in range(refine + 1)]
        micro = 1e6 / len(levels[-1].load)
        for peer, solve in [("PETSc", petsc), ("pyamg", active_set)]:
            runs = [solve(levels) for _ in range(REPEATS)]
            theirs, kkt = statistics.median(run[0] for run in runs), levels[-1].residual(runs[0][1])
            answers = [run(arguments, f, refine, "--tolerance", repr(float(kkt))) for _ in range(REPEATS)]
            ours = statistics.median(answer["seconds"]["solve"] for answer in answers)
            whole = ours + statistics.median(answer["seconds"]["bounds"] for answer in answers)
            line = f"{theirs * micro:8.3f} {kkt:8.1e} {ours * micro:8.4f} {answers[0]['kkt']['relative']:8.1e}"
            print(f"  {name:>11} {len(levels[-1].load):>9} {peer:>7} {line} {theirs / ours:6.1f} {theirs / whole:6.1f}", flush=True)


main()
