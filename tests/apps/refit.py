#!/usr/bin/env python3
"""Fits Table 6 of Uno & Slater (1997) to a study's participants by Newton's method on the likelihood.

usage: refit.py PARTICIPANTS.csv: prints term,estimate,error and the deviance. Standard library alone.
"""
import csv
import math
import sys

TERMS = {
    "change(1)": lambda p: p["changed"] == "elasticity",
    "change(2)": lambda p: p["changed"] == "friction",
    "change(3)": lambda p: p["changed"] == "shape",
    "F": lambda p: p["changed"] != "friction" and p["cell"][1] == "1",
    "sick": lambda p: int(p["sick"]),
    "vrbefore(2)": lambda p: p["vrbefore"] == "no",
    "change(1).S": lambda p: p["changed"] == "elasticity" and p["cell"][2] == "1",
    "change(2).S": lambda p: p["changed"] == "friction" and p["cell"][2] == "1",
    "change(2).E": lambda p: p["changed"] == "friction" and p["cell"][0] == "1",
    "change(3).E": lambda p: p["changed"] == "shape" and p["cell"][0] == "1",
}


def inverse(a):
    n = len(a)
    rows = [list(row) + [float(i == j) for j in range(n)] for i, row in enumerate(a)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for k in range(n):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i])]
    return [row[n:] for row in rows]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        people = [row for row in csv.DictReader(file) if row["counts"] == "yes"]
    x = [[float(term(person)) for term in TERMS.values()] for person in people]
    y = [sum(int(person[f"presence{i}"]) >= 6 for i in range(1, 7)) for person in people]
    beta = [0.0] * len(TERMS)
    for _ in range(40):
        p = [1 / (1 + math.exp(-sum(b * v for b, v in zip(beta, row)))) for row in x]
        slope = [sum(row[j] * (c - 6 * q) for row, c, q in zip(x, y, p)) for j in range(len(beta))]
        curve = [[sum(row[i] * row[j] * 6 * q * (1 - q) for row, q in zip(x, p))
                  for j in range(len(beta))] for i in range(len(beta))]
        covariance = inverse(curve)
        step = [sum(c * s for c, s in zip(row, slope)) for row in covariance]
        beta = [b + s for b, s in zip(beta, step)]
        if max(map(abs, step)) < 1e-12:
            break
    deviance = 2 * sum(
        (c * math.log(c / (6 * q)) if c else 0.0) +
        ((6 - c) * math.log((6 - c) / (6 - 6 * q)) if c < 6 else 0.0) for c, q in zip(y, p))
    for i, term in enumerate(TERMS):
        print(f"{term},{beta[i]!r},{math.sqrt(covariance[i][i])!r}")
    print(f"deviance,{deviance!r},0")


if __name__ == "__main__":
    main()
