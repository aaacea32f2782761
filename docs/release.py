"""Prints the tables of docs/release.md: how near each estimator comes to the true swing.

Shares nothing with the program: its swings are formulas, its estimators are written anew.
Run: python3 docs/release.py
"""

import math
import random

GRIP = (0.0, -0.03, -0.115)  # centre of the ball in the hand [m]
ARM, SHOULDER = 0.64, 1.40  # [m]
LATENCY, TICK = 0.00783, 1.0 / 240.0  # [s] until a sample is there; of the simulation
NOISE_M, NOISE_RAD = 0.0005, math.radians(0.025)  # a Fastrak's, 2.5 m away


def minimum_jerk(s):
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10.0 + s * (-15.0 + 6.0 * s))


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned(r, v):
    return [sum(r[i][k] * v[k] for k in range(3)) for i in range(3)]


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    r = [[float(a == b) for b in range(3)] for a in range(3)]
    r[i][i], r[i][j], r[j][i], r[j][j] = c, -s, s, c
    return r


class Swing:
    """The arm's angle goes from `back` to `through` with the least jerk; 0 hangs down."""

    def __init__(self, back, through, seconds, release, twist=0.0, plane=0.0, step=1.2):
        self.back, self.through = math.radians(back), math.radians(through)
        self.seconds, self.twist, self.plane, self.step = seconds, twist, math.radians(plane), step
        low, high = 0.0, seconds
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.angle(middle) < math.radians(release) else (low, middle)
        self.release = low

    def angle(self, t):
        return self.back + (self.through - self.back) * minimum_jerk(t / self.seconds)

    def hand(self, t):
        """Rotation and place of the hand; -z is along the fingers, y ahead goes to the skittles."""
        turn = self.twist * 0.15 * math.tanh((t - self.release) / 0.15)  # about the forearm
        r = product(about(2, self.plane), product(about(0, self.angle(t)), about(2, math.pi + turn)))
        lean = self.step * t + 0.3 * t * t  # the shoulder goes along
        p = turned(r, (0.0, 0.0, -ARM))
        return r, [p[0], p[1] + lean, p[2] + SHOULDER - 0.15 * t]

    def ball(self, t):
        r, p = self.hand(t)
        return [a + b for a, b in zip(p, turned(r, GRIP))]

    def velocity(self, t, h=1e-5):
        return [(b - a) / (2.0 * h) for a, b in zip(self.ball(t - h), self.ball(t + h))]


SWINGS = {
    "straight": Swing(-75, 125, 0.75, 5),
    "hooked": Swing(-75, 125, 0.72, 8, twist=14.0, plane=6),
    "lofted": Swing(-70, 130, 0.78, 32),
    "short": Swing(-45, 75, 0.42, 3),
}


def samples(swing, rate, phase, noise, rng, begin, end):
    """(time, centre of the ball) of the hand's samples."""
    found = []
    k = math.ceil((begin - phase) * rate)
    while (t := phase + k / rate) <= end:
        r, p = swing.hand(t)
        if noise:
            p = [x + rng.gauss(0.0, NOISE_M) for x in p]
            for axis in range(3):
                r = product(r, about(axis, rng.gauss(0.0, NOISE_RAD)))
        found.append((t, [a + b for a, b in zip(p, turned(r, GRIP))]))
        k += 1
    return found


def solve(a, b):
    """Gauss with pivots; b has three columns."""
    n = len(a)
    m = [row[:] + right[:] for row, right in zip(a, b)]
    for i in range(n):
        best = max(range(i, n), key=lambda k: abs(m[k][i]))
        m[i], m[best] = m[best], m[i]
        for k in range(n):
            if k != i:
                f = m[k][i] / m[i][i]
                m[k] = [x - f * y for x, y in zip(m[k], m[i])]
    return [[x / m[i][i] for x in m[i][n:]] for i in range(n)]


def polynomial(points, at, order, weight=lambda t: 1.0):
    """Slope at `at` of the polynomial through points, by weighted least squares."""
    scale = 0.05
    terms = order + 1
    a = [[0.0] * terms for _ in range(terms)]
    b = [[0.0] * 3 for _ in range(terms)]
    for t, p in points:
        w = weight(t - at)
        x = (t - at) / scale
        for i in range(terms):
            for j in range(terms):
                a[i][j] += w * x ** (i + j)
            for axis in range(3):
                b[i][axis] += w * x**i * p[axis]
    return [x / scale for x in solve(a, b)[1]]


def fit(order, before, after=1.0):
    def estimate(points, at):
        used = [s for s in points if -before <= s[0] - at <= after]
        return polynomial(used, at, min(order, len(used) - 1))
    return estimate


def at_last_sample(points, at):
    past = [s for s in points if s[0] <= at]
    used = [s for s in past if past[-1][0] - s[0] <= 0.06]
    return polynomial(used, used[-1][0], 2 if len(used) >= 4 else 1)


def local(order, before, after):
    def tricube(u):
        return max(0.0, 1.0 - abs(u) ** 3) ** 3

    def estimate(points, at):
        past = max(0.0, at - points[-1][0])  # as much further back as the last sample is old

        def weight(t):
            return tricube(t / (before + past if t < 0.0 else after))
        used = [s for s in points if weight(s[0] - at) > 1e-9]
        return polynomial(used, at, min(order, len(used) - 1), weight)
    return estimate


def kalman(jerk, sigma, before=0.25):
    """Smoother of Rauch, Tung and Striebel: white jerk of density `jerk` [m2/s5]."""
    def mul(a, b):
        return [[sum(a[i][k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))] for i in range(len(a))]

    def add(a, b, f=1.0):
        return [[x + f * y for x, y in zip(r, s)] for r, s in zip(a, b)]

    def estimate(points, at):
        rows = [(t, p) for t, p in points if t >= at - before] + [(at, None)]
        rows.sort(key=lambda row: row[0])
        x = [list(rows[0][1]), [0.0] * 3, [0.0] * 3]
        P = [[sigma**2, 0, 0], [0, 100.0, 0], [0, 0, 1e4]]
        kept = []
        last = rows[0][0]
        for t, p in rows:
            d = t - last
            last = t
            F = [[1, d, d * d / 2], [0, 1, d], [0, 0, 1]]
            Q = [[jerk * v for v in r] for r in ([d**5 / 20, d**4 / 8, d**3 / 6], [d**4 / 8, d**3 / 3, d * d / 2], [d**3 / 6, d * d / 2, d])]
            xp = mul(F, x)
            Pp = add(mul(mul(F, P), [list(c) for c in zip(*F)]), Q)
            x, P = xp, Pp
            if p is not None:
                s = Pp[0][0] + sigma**2
                K = [Pp[i][0] / s for i in range(3)]
                x = [[xp[i][a] + K[i] * (p[a] - xp[0][a]) for a in range(3)] for i in range(3)]
                P = [[Pp[i][j] - K[i] * Pp[0][j] for j in range(3)] for i in range(3)]
            kept.append((t, F, xp, Pp, x, P))
        xs = kept[-1][4]
        for k in range(len(kept) - 1, -1, -1):
            if kept[k][0] == at and k == len(kept) - 1:
                return kept[k][4][1]
            if k < len(kept) - 1:
                _, F, xp, Pp, _, _ = kept[k + 1]
                C = mul(kept[k][5], [list(c) for c in zip(*F)])
                gain = [list(c) for c in zip(*solve([list(c) for c in zip(*Pp)], [list(c) for c in zip(*C)]))]
                xs = add(kept[k][4], mul(gain, add(xs, xp, -1.0)))
                if kept[k][0] == at:
                    return xs[1]
        raise AssertionError

    return estimate


def direction(v):
    return math.degrees(math.atan2(v[2], math.hypot(v[0], v[1]))), math.degrees(math.atan2(v[0], v[1]))


def measured(estimate, swing, rate, noise, delay, throws=51, repeats=1):
    """Errors over releases 1 ms apart: elevation, azimuth [degrees], speed [m/s]; jump from one to the next."""
    errors, jump, before = [], 0.0, None
    for k in range(throws * repeats):
        rng = random.Random(k)
        at = swing.release - 0.025 + 0.001 * (k % throws)
        tick = math.ceil((at + delay) / TICK - 1e-9) * TICK
        known = samples(swing, rate, 0.0031 + 0.00071 * (k // throws), noise, rng, at - 0.4, tick - LATENCY)
        v, true = estimate(known, at), swing.velocity(at)
        (e, a), (et, at_) = direction(v), direction(true)
        error = (e - et, a - at_, math.hypot(*v) - math.hypot(*true))
        off = [x - y for x, y in zip(v, true)]
        if before is not None and k % throws:
            jump = max(jump, math.dist(off, before))
        before = off
        errors.append(error)
    return errors, jump


def mean_and_spread(values):
    mean = sum(values) / len(values)
    return mean, math.sqrt(sum((x - mean) ** 2 for x in values) / len(values))


ESTIMATORS = {
    "parabola of 60 ms that ends at the last sample before (until now)": at_last_sample,
    "line, 60 ms": fit(1, 0.06),
    "parabola, 60 ms": fit(2, 0.06),
    "parabola, 80 ms": fit(2, 0.08),
    "cubic, 80 ms": fit(3, 0.08),
    "cubic, 100 ms": fit(3, 0.10),
    "cubic, 120 ms": fit(3, 0.12),
    "local quadratic, 80 ms": local(2, 0.08, 0.04),
    "local quadratic, 100 ms": local(2, 0.10, 0.04),
    "**local cubic, 120 ms**": local(3, 0.12, 0.04),
    "local cubic, 160 ms": local(3, 0.16, 0.04),
    "Kalman smoother, jerk 1e4 m2/s5": kalman(1e4, NOISE_M),
    "Kalman smoother, jerk 1e5 m2/s5": kalman(1e5, NOISE_M),
}


def main():
    for delay, rate, noise in [
        (0.025, 60, False), (0.025, 60, True), (0.025, 120, True), (0.025, 240, True),
        (0.0, 60, False), (0.0, 60, True), (0.0, 120, True), (0.0, 240, True),
    ]:
        print(f"\n### {rate} Hz, delay {1e3 * delay:.0f} ms, {'a Fastrak' + chr(39) + 's noise' if noise else 'no noise'}\n")
        print("| estimator | " + " | ".join(SWINGS) + " | azimuth | jump |")
        print("|---|" + "---|" * (len(SWINGS) + 2))
        for name, estimate in ESTIMATORS.items():
            cells, aside, jumps = [], 0.0, 0.0
            for swing in SWINGS.values():
                errors, jump = measured(estimate, swing, rate, noise, delay, repeats=2 if noise else 1)
                up, az, speed = (mean_and_spread(column) for column in zip(*errors))
                cells.append(f"{up[0]:+.2f} ± {up[1]:.2f}, {speed[0]:+.3f}")
                aside, jumps = max(aside, az[1]), max(jumps, jump)
            print(f"| {name} | " + " | ".join(cells) + f" | {aside:.2f} | {jumps:.2f} |", flush=True)


if __name__ == "__main__":
    main()
