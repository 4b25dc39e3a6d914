"""True solutions to twenty decimals, by a program that shares no code with ours.

A conformal map to the disc and a scalar Riemann-Hilbert problem there, solved in closed form for given ends of
contact, and Newton's method for the ends. In balls of sixty digits, so that cancellation needs no care, and only for
problems that are symmetric about x = y, with a known number of arcs, so that symmetry closes the gaps. Not needed to
build or test: it takes a minute for all problems and needs PyPI's python-flint, and what it finds is kept.

    python3 benches/peers/truth.py [PROBLEM ...]        all problems: writes pipeline/truth.toml

Positions on the border are perimeter coordinates p, anticlockwise from the lower right corner.
"""

import os
import sys

from flint import acb, arb, arb_mat, ctx

ctx.dps = 60
HALF, PI = arb(1) / 2, arb.pi()
# Nodes of a panel at the two resolutions that must agree, and the decimals on which they do.
RESOLUTIONS, DECIMALS = (32, 44), 20
# Powers of the distance from a special point that a panel's nodes are spread by: at an end of contact the solution
# grows like a square root, at corners and jumps like s log s.
AT_END, AT_KINK = 2, 5
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def rectangle(x0, x1, y0, y1, value):
    return "rectangle", [arb(c) / 4 for c in (x0, x1, y0, y1)], value


def quarter(sign, tenths, value):
    """The part of a disc about the corner (sign / 2, sign / 2) that lies in the square."""
    return "disc", [arb(sign) / 2, arb(tenths) / 10], value


def around(corner):
    """One arc with its middle in a corner, from the distance of its ends."""
    return lambda a: [(corner - a, corner + a)]


# Pieces of f in quarters of the side, f elsewhere, the arcs of contact from distances of their ends from corners, the
# arc first that ends first after p = 4, and a first guess of the distances.
PROBLEMS = {
    "quadrant(ll)=3; else=-1.002": ([rectangle(-8, 0, -8, 0, 3)], arb(-1002) / 1000, around(1), ["0.055"]),
    "quadrant(ll)=-6; else=1.998": ([rectangle(-8, 0, -8, 0, -6)], arb(1998) / 1000, around(3), ["0.0224"]),
    "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5": (
        [rectangle(-1, 1, -1, 1, 4)],
        arb(-3) / 2,
        lambda a: [(k - a, k + a) for k in range(4, 8)],
        ["0.23"],
    ),
    "quadrant(ll)=6; else=-4": ([rectangle(-8, 0, -8, 0, 6)], arb(-4), around(5), ["1.24"]),
    "disc(-0.5,-0.5,0.4)=14; disc(0.5,0.5,0.3)=16; else=-5": (
        [quarter(-1, 4, 14), quarter(1, 3, 16)],
        arb(-5),
        lambda a, b: [(3 + a, 5 - b), (5 + b, 7 - a)],
        ["0.7", "0.6"],
    ),
    "disc(0.5,0.5,0.3)=4; else=-1": ([quarter(1, 3, 4)], arb(-1), around(3), ["1.506"]),
}


# --- the map -----------------------------------------------------------------------------------------------------

NOME = (-PI).exp()
ODD = [NOME ** ((arb(2 * k + 1) / 2) ** 2) for k in range(8)]
EVEN = [NOME ** (k * k) for k in range(8)]


def thetas(z):
    e = acb(0, z).exp()
    square, power = e * e, acb(1)
    first, second, third, fourth = arb(0), arb(0), HALF, HALF
    for k in range(8):
        if k > 0:
            third, fourth = third + EVEN[k] * power.real, fourth + (-1) ** k * EVEN[k] * power.real
        odd = power * e
        first, second = first + (-1) ** k * ODD[k] * odd.imag, second + ODD[k] * odd.real
        power *= square
    return [2 * t for t in (first, second, third, fourth)]


_, T2, T3, T4 = thetas(arb(0))
K = PI / 2 * T3**2


def angle(side, y):
    """The angle on the circle of a place on a side, and its derivative."""
    t1, t2, t3, t4 = thetas(PI * y)
    sn, cn, dn = T3 / T2 * t1 / t4, T4 / T2 * t2 / t4, T4 / T3 * t3 / t4
    return side * PI / 2 + arb.atan2(sn / arb(2).sqrt(), dn), arb(2).sqrt() * K * cn


def place(p):
    """Side, coordinate along it, point, tangent and outer normal."""
    side = int(p.floor().unique_fmpz())
    y = p - side - HALF
    turned = lambda x, y: [(x, y), (-y, x), (-x, -y), (y, -x)][side % 4]
    return side, y, turned(HALF, y), turned(arb(0), arb(1)), turned(arb(1), arb(0))


# --- a potential with the right-hand side f ----------------------------------------------------------------------


def corner(x, y):
    """Whose mixed derivative is log|z|, with its gradient."""
    if x == 0 and y == 0:
        return arb(0), arb(0), arb(0)
    log = (x * x + y * y).log()
    across = arb(0) if x == 0 else (y / x).atan()
    along = arb(0) if y == 0 else (x / y).atan()
    value = (x * y * (log - 3) + x * x * across + y * y * along) / 2
    return value, (y * log + 2 * x * across - 2 * y) / 2, (x * log + 2 * y * along - 2 * x) / 2


class Potential:
    """psi with -Lap psi = f, and its gradient."""

    def __init__(self, pieces, elsewhere):
        self.pieces, self.elsewhere = pieces, elsewhere

    def at(self, point):
        x, y = point
        bend = -self.elsewhere / 4
        total = [bend * (x * x + y * y), 2 * bend * x, 2 * bend * y]
        for kind, shape, value in self.pieces:
            jump = value - self.elsewhere
            if kind == "rectangle":
                x0, x1, y0, y1 = shape
                for sign, a, b in ((1, x0, y0), (-1, x1, y0), (-1, x0, y1), (1, x1, y1)):
                    terms = corner(x - a, y - b)
                    total = [t - sign * jump / (2 * PI) * term for t, term in zip(total, terms)]
            else:
                c, radius = shape
                x_, y_ = x - c, y - c
                square, bound = x_ * x_ + y_ * y_, radius * radius
                if square < bound:
                    terms = (square - bound) / 4, x_ / 2, y_ / 2
                else:
                    terms = bound / 4 * (square / bound).log(), bound / 2 * x_ / square, bound / 2 * y_ / square
                total = [t - jump * term for t, term in zip(total, terms)]
        return total

    def vertices(self):
        """Points near which it is not smooth, or its continuation is not."""
        for kind, shape, _ in self.pieces:
            if kind == "rectangle":
                yield from ((x, y) for x in shape[:2] for y in shape[2:])
            else:
                yield shape[0], shape[0]

    def crossings(self):
        """Where f jumps on the border."""
        for kind, shape, _ in self.pieces:
            if kind == "rectangle":
                x0, x1, y0, y1 = shape
                for x in (x for x in (x0, x1) if abs(x) < HALF):
                    yield from (p for y, p in ((y0, 4 + x - HALF), (y1, 1 + HALF - x)) if abs(y) > HALF)
                for y in (y for y in (y0, y1) if abs(y) < HALF):
                    yield from (p for x, p in ((x1, y + HALF), (x0, 2 + HALF - y)) if abs(x) > HALF)
            else:
                c, radius = shape
                at = 1 if c > 0 else 3
                yield from (at - radius, at + radius)


# --- Gauss's rule and panels -------------------------------------------------------------------------------------

RULES = {}


def rule(n):
    """Nodes and weights on [0, 1], and the integrals from 0 to each node as a matrix, last those to 1."""
    if n not in RULES:
        pairs = [arb.legendre_p_root(n, k, weight=True) for k in reversed(range(n))]
        polynomials = []
        for x, _ in pairs:
            values = [arb(1), x]
            for k in range(1, n + 1):
                values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
            polynomials.append(values)
        integral = lambda values, k: (values[k + 1] - (values[k - 1] if k else -1)) / (2 * k + 1)
        rows = [
            [
                pairs[j][1] / 4 * sum((2 * k + 1) * polynomials[j][k] * integral(values, k) for k in range(n))
                for j in range(n)
            ]
            for values in polynomials
        ]
        nodes = [((1 + x) / 2, w / 2) for x, w in pairs]
        RULES[n] = nodes, rows + [[w for _, w in nodes]]
    return RULES[n]


def spread(a, b, power, n):
    """Positions and weights on [a, b] or [b, a]; crowded towards a."""
    for x, w in rule(n)[0]:
        yield a + (b - a) * x**power, abs(b - a) * power * x ** (power - 1) * w


def distance(point, a, b):
    """From a point to the part of the border between a and b, on one side."""
    _, y, _, tangent, normal = place((a + b) / 2)
    along = point[0] * tangent[0] + point[1] * tangent[1] - y
    across = point[0] * normal[0] + point[1] * normal[1] - HALF
    beyond = max(abs(along) - (b - a) / 2, arb(0))
    return (beyond**2 + across**2).sqrt()


class Node:
    """A place on the border with all that integrals need there."""

    __slots__ = ("p", "weight", "half", "slope", "gradient", "kernel", "root", "outer", "psi", "arc", "contact")


class Solver:
    def __init__(self, pieces, elsewhere, arcs, n):
        self.psi, self.arcs, self.n = Potential(pieces, elsewhere), arcs, n
        self.m, self.start = len(arcs), arcs[0][0]
        wrap = lambda p: p - 4 * ((p - self.start) / 4).floor()
        ends = [e for arc in arcs for e in arc]
        kinks = [wrap(arb(k)) for k in range(4)] + [wrap(p) for p in self.psi.crossings()]
        tags = [(e, AT_END) for e in ends] + [(k, AT_KINK) for k in kinks] + [(self.start + 4, AT_END)]
        self.special = sorted(tags, key=lambda tag: tag[0].mid())
        self.angles = [angle(*place(e)[:2])[0] for e in ends]
        self.cache = {}
        self.panels = [panel for pair in zip(self.special, self.special[1:]) for panel in self.cut(*pair)]

    def cut(self, left, right):
        """Panels between special points: (a, b, power), none long beside what is near."""
        (a, _), (b, _) = left, right
        near = [q + shift for q, _ in self.special for shift in (-4, 0, 4)]

        def halve(a, b, first, last):
            others = [q for q in near if not ((first and abs(q - a) < 1e-30) or (last and abs(q - b) < 1e-30))]
            gap = min(min(abs(q - a), abs(q - b)).mid() for q in others)
            gap = min([gap] + [distance(v, a, b).mid() for v in self.psi.vertices() if distance(v, a, b) > 1e-30])
            if (first and last) or b - a > 1.01 * gap or b - a > 0.51:
                middle = (a + b) / 2
                return halve(a, middle, first, False) + halve(middle, b, False, last)
            if last:
                return [(b, a, right[1])]
            return [(a, b, left[1] if first else 1)]

        return halve(a, b, True, True)

    def node(self, p, weight):
        node = Node()
        side, y, point, tangent, normal = place(p)
        theta, node.slope = angle(side, y)
        node.p, node.weight = p, weight
        node.half = (theta / 2).cos(), (theta / 2).sin()
        node.psi, *node.gradient = self.psi.at(point)
        # The arc of contact that it is on, or in the gap after.
        node.arc = max(k for k in range(self.m) if self.arcs[k][0] < p)
        node.contact = bool(p < self.arcs[node.arc][1])
        product = arb(1)
        for end in self.angles:
            product *= 2 * ((theta - end) / 2).sin()
        node.root = (-1) ** node.arc * abs(product).sqrt()
        node.outer = normal
        node.kernel = tangent if node.contact else (-normal[0], -normal[1])
        node.kernel = [weight / node.root * e for e in node.kernel]
        return node

    def nodes(self, a, b, power, n):
        key = (a.mid().str(40), b.mid().str(40), power, n)
        if key not in self.cache:
            self.cache[key] = [self.node(p, w) for p, w in spread(a, b, power, n)]
        return self.cache[key]

    def conditions(self):
        """What vanishes if the ends are right."""
        sums = [acb(0)] * (self.m + 1)
        for a, b, power in self.panels:
            for node in self.nodes(a, b, AT_END if power == AT_END else 1, self.n):
                datum = node.gradient[0] * node.kernel[0] + node.gradient[1] * node.kernel[1]
                turn = acb(*node.half)
                for k in range(self.m % 2, self.m + 1, 2):
                    sums[k] += datum * turn**k
        return [part for k in range(self.m % 2, self.m + 1, 2) for part in (sums[k].real, sums[k].imag)]

    def sources(self, p):
        """Nodes for integrals with a kernel that is large at p."""
        for a, b, power in self.panels:
            if power != AT_KINK:
                yield from self.nodes(a, b, power, self.n)
                continue
            # Towards a corner or a jump, as finely as p is near.
            shift = 4 * int(((p - a) / 4 + HALF).floor().unique_fmpz())
            near, end = abs(p - a - shift), b
            while abs(end - a) > near:
                middle = (a + end) / 2
                yield from self.nodes(*sorted((middle, end), key=lambda q: q.mid()), 1, self.n)
                end = middle
            yield from self.nodes(a, end, 1, self.n)

    def rate(self, target):
        """The multiplier in contact, elsewhere the derivative of v along the border."""
        (c, s), (gx, gy) = target.half, target.gradient
        total = arb(0)
        for node in self.sources(target.p):
            (c_, s_), (gx_, gy_) = node.half, node.gradient
            sine = s * c_ - c * s_
            term = ((gx_ - gx) * node.kernel[0] + (gy_ - gy) * node.kernel[1]) / sine
            total += term if self.m % 2 else term * (c * c_ + s * s_)
        return -total / (2 * PI) * target.root * target.slope

    def solution(self):
        """The energy, v in the centre and in corners, the force of each arc."""
        n = self.n + 9
        energy, centre = -self.particular() / 2, self.psi.at((arb(0), arb(0)))[0]
        forces, corners, v = [arb(0)] * self.m, {}, arb(0)
        for a, b, power in self.panels:
            backward = a > b
            targets = self.nodes(a, b, power, n)
            rates = [self.rate(target) for target in targets]
            if targets[0].contact:
                v, values = arb(0), [arb(0)] * n
                forces[targets[0].arc] += sum(rate * target.weight for rate, target in zip(rates, targets))
            else:
                if any(abs(arc[1] - min(a, b)) < 1e-30 for arc in self.arcs):
                    v = arb(0)
                scaled = [
                    rate * abs(b - a) * power * x ** (power - 1) for rate, (x, _) in zip(rates, rule(n)[0])
                ]
                *inner, whole = [sum(w * r for w, r in zip(row, scaled)) for row in rule(n)[1]]
                values = [v + whole - part if backward else v + part for part in inner]
                v += whole
            last = max(a, b)
            nearest = (last + HALF).floor()
            if abs(last - nearest) < 1e-30:
                corners[int(nearest.unique_fmpz()) % 4] = v
            for target, rate, value in zip(targets, rates, values):
                outer = sum(g * e for g, e in zip(target.gradient, target.outer))
                flux = rate if target.contact else 0
                energy -= target.weight * (target.psi * flux - value * outer) / 2
                centre += target.weight * target.slope * (value - target.psi) / (2 * PI)
        return energy, centre, corners, forces

    def particular(self):
        """The integral of f psi, by Green's identity with |x|^2 / 4 on each piece."""
        whole = [-HALF, HALF, -HALF, HALF]
        elsewhere = self.psi.elsewhere
        total = elsewhere * self.around(outline("rectangle", whole))
        moment = elsewhere * second_moment("rectangle", whole)
        for kind, shape, value in self.psi.pieces:
            if kind == "rectangle":
                shape = [max(min(c, HALF), -HALF) for c in shape]
            jump, inside = value - elsewhere, second_moment(kind, shape)
            total += jump * (self.around(outline(kind, shape)) - value * inside)
            moment += jump * inside
        return total - elsewhere * moment

    def around(self, pieces):
        """The integral of psi q_n - q psi_n along lines and arcs, q = |x|^2 / 4."""
        total = arb(0)
        for at in pieces:
            for a, b in ((0, HALF), (1, HALF)):
                for t, weight in spread(arb(a), arb(b), AT_KINK, self.n + 20):
                    (x, y), (nx, ny) = at(t)
                    psi, gx, gy = self.psi.at((x, y))
                    square = (x * x + y * y) / 4
                    total += weight * (psi * (x * nx + y * ny) / 2 - square * (gx * nx + gy * ny))
        return total


def outline(kind, shape):
    """Parts of the border of a piece as functions of [0, 1]: point, and outer normal times speed."""

    def line(a, b):
        dx, dy = b[0] - a[0], b[1] - a[1]
        return lambda t: ((a[0] + t * dx, a[1] + t * dy), (dy, -dx))

    if kind == "rectangle":
        x0, x1, y0, y1 = shape
        # Cut wherever f may jump, which here is at multiples of 1/20: there psi is not smooth.
        points = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        cuts = [arb(k) / 20 for k in range(-10, 11)]
        for a, b in zip(points, points[1:]):
            axis = 0 if a[1] == b[1] else 1
            low, high = sorted((a[axis], b[axis]), key=lambda c: c.mid())
            stops = [low] + [c for c in cuts if low < c < high] + [high]
            if a[axis] > b[axis]:
                stops.reverse()
            point = lambda c: (c, a[1]) if axis == 0 else (a[0], c)
            for one, other in zip(stops, stops[1:]):
                yield line(point(one), point(other))
    else:
        c, radius = shape
        inward, speed = -2 * c, radius * PI / 2

        def arc(t):
            x, y = inward * (t * PI / 2).cos(), inward * (t * PI / 2).sin()
            return (c + radius * x, c + radius * y), (x * speed, y * speed)

        # Anticlockwise: out along one leg, round, and back along the other.
        yield line((c, c), (c + inward * radius, c))
        yield arc
        yield line((c, c + inward * radius), (c, c))


def second_moment(kind, shape):
    """The integral of |x|^2 / 4 over a piece."""
    if kind == "rectangle":
        x0, x1, y0, y1 = shape
        return ((x1**3 - x0**3) * (y1 - y0) + (y1**3 - y0**3) * (x1 - x0)) / 12
    # c^2 is 1/4, and the leg from (c, c) runs against c.
    _, radius = shape
    return (PI * radius**2 / 8 - 2 * radius**3 / 3 + PI * radius**4 / 8) / 4


# --- the ends, and what is printed -------------------------------------------------------------------------------


def find_ends(pieces, elsewhere, arcs, guess, n):
    """Gauss-Newton in the distances of the ends; symmetry makes some of the conditions void."""
    at = lambda distances: Solver(pieces, elsewhere, arcs(*distances), n).conditions()
    distances, step = [arb(d) for d in guess], arb("1e-25")
    for _ in range(12):
        distances = [d.mid() for d in distances]
        here = at(distances)
        columns = []
        for k in range(len(distances)):
            moved = [d + (step if j == k else 0) for j, d in enumerate(distances)]
            columns.append([(there - value) / step for there, value in zip(at(moved), here)])
        rows = arb_mat(columns)
        change = (rows * rows.transpose()).solve(rows * arb_mat([[value] for value in here])).entries()
        distances = [old - new for old, new in zip(distances, change)]
        if max(abs(c).mid() for c in change) < 1e-32:
            return [d.mid() for d in distances]
    raise ArithmeticError("the ends do not settle")


def solve(f, n):
    """All numbers by name, in the order of the file; lists where there are several."""
    pieces, elsewhere, arcs, guess = PROBLEMS[f]
    distances = find_ends(pieces, elsewhere, arcs, guess, n)
    arcs = arcs(*distances)
    energy, centre, corners, forces = Solver(pieces, elsewhere, arcs, n).solution()
    point = lambda p: list(place(p)[2])
    return {
        "energy": energy,
        "centre": centre,
        "corners": [corners[k] for k in (3, 0, 1, 2)],
        "contact": [{"from": point(a), "to": point(b), "force": force} for (a, b), force in zip(arcs, forces)],
    }


def numbers(value):
    if isinstance(value, (dict, list)):
        return [one for part in (value.values() if isinstance(value, dict) else value) for one in numbers(part)]
    return [value]


def written(value):
    """As TOML; exact halves and zeros without further decimals."""
    if isinstance(value, list):
        return "[" + ", ".join(written(one) for one in value) + "]"
    if value.is_exact() and (2 * value).is_integer():
        return f'"{float(value):g}"'
    units = (value * 10**DECIMALS + HALF).floor().unique_fmpz()
    return f'"{"-" if units < 0 else ""}{abs(int(units)) // 10**DECIMALS}.{abs(int(units)) % 10**DECIMALS:0{DECIMALS}}"'


if __name__ == "__main__":
    text = "# Written by benches/peers/truth.py; decimals on which two resolutions agree.\n"
    for f in sys.argv[1:] or PROBLEMS:
        coarse, fine = [solve(f, n) for n in RESOLUTIONS]
        apart = max(abs(a - b).upper() for a, b in zip(numbers(coarse), numbers(fine)))
        assert apart < arb(10) ** -DECIMALS / 100, f"{f}: resolutions differ by {apart.str(3)}"
        text += f'\n[[solution]]\nf = "{f}"\n'
        text += "".join(f"{key} = {written(value)}\n" for key, value in fine.items() if key != "contact")
        for arc in fine["contact"]:
            text += "[[solution.contact]]\n" + "".join(f"{key} = {written(value)}\n" for key, value in arc.items())
        print(f"{f}: resolutions differ by {apart.str(3, radius=False)}", file=sys.stderr)
    if sys.argv[1:]:
        print(text)
    else:
        with open(os.path.join(ROOT, "pipeline", "truth.toml"), "w") as file:
            file.write(text)
