"""Meshes as users bring them: unstructured, without a coarser one, made by Gmsh's Python package."""

import math
import os

import gmsh

# Points of the L-shape, the reentrant corner first.
LSHAPE = [(0, 0), (0, -1), (1, -1), (1, 1), (-1, 1), (-1, 0)]


def begin(size):
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.add("own")


def finish(dimension, path):
    gmsh.model.mesh.generate(dimension)
    gmsh.write(path)
    gmsh.finalize()


def disc(size):
    def make(path):
        begin(size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.model.occ.addDisk(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        finish(2, path)

    return make


def ball(size):
    def make(path):
        begin(size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.model.occ.addSphere(0, 0, 0, 1)
        gmsh.model.occ.synchronize()
        finish(3, path)

    return make


def graded(corner, elsewhere):
    """L-shape whose cells shrink towards its corner."""

    def make(path):
        begin(elsewhere)
        geometry = gmsh.model.geo
        points = [geometry.addPoint(x, y, 0, elsewhere) for x, y in LSHAPE]
        gmsh.model.geo.mesh.setSize([(0, points[0])], corner)
        lines = [geometry.addLine(points[k], points[(k + 1) % 6]) for k in range(6)]
        geometry.addPlaneSurface([geometry.addCurveLoop(lines)])
        geometry.synchronize()
        finish(2, path)

    return make


def layers(size, aspect):
    """Disc with layers along its boundary, the first as thin as the aspect of its cells says."""

    def make(path):
        begin(size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size / aspect)
        geometry = gmsh.model.geo
        angles = [math.pi * k / 2 for k in range(4)]
        centre = geometry.addPoint(0, 0, 0)
        points = [geometry.addPoint(math.cos(t), math.sin(t), 0, size) for t in angles]
        arcs = [geometry.addCircleArc(points[k], centre, points[(k + 1) % 4]) for k in range(4)]
        geometry.addPlaneSurface([geometry.addCurveLoop(arcs)])
        geometry.synchronize()
        field = gmsh.model.mesh.field
        layer = field.add("BoundaryLayer")
        field.setNumbers(layer, "CurvesList", arcs)
        for option, value in [("Size", size / aspect), ("Ratio", 1.3), ("Thickness", 0.05), ("Quads", 0)]:
            field.setNumber(layer, option, value)
        field.setAsBoundaryLayer(layer)
        finish(2, path)

    return make


def written(name, make, folder):
    """Path of the mesh of this name, which is made if it is not there."""
    path = os.path.join(folder, f"{name}.msh")
    if not os.path.exists(path):
        make(path)
    return path
