#!/usr/bin/env python3
"""Power of a study for each term of Table 6 of Uno & Slater (1997), without a simulation.

usage: power.py PARTICIPANTS.csv N: prints term,power of a study of N people. The statistic of a likelihood-ratio test
with one degree of freedom is a non-central chi-squared; its non-centrality is the statistic of exemplary data, where
each answer is its own expectation (Self, Mauritsen & Ohara, Biometrics 48, 1992). The table gives the distribution of
the covariates; its answers are not used.
"""
import csv
import math
import sys

from refit import TERMS, inverse

PUBLISHED = {  # Table 6
    "change(1)": 1.501, "change(2)": -0.9969, "change(3)": 0.7149, "F": 2.112, "sick": -0.6980,
    "vrbefore(2)": -1.580, "change(1).S": -1.496, "change(2).S": 3.786, "change(2).E": -3.836, "change(3).E": -0.5273,
}


def probabilities(x, beta):
    return [1 / (1 + math.exp(-sum(b * v for b, v in zip(beta, row)))) for row in x]


def fitted(x, p):
    """Probabilities of the model with the columns of x that is fitted to the probabilities p."""
    beta = [0.0] * len(x[0])
    for _ in range(60):
        q = probabilities(x, beta)
        slope = [sum(row[j] * (a - b) for row, a, b in zip(x, p, q)) for j in range(len(beta))]
        curve = [[sum(row[i] * row[j] * b * (1 - b) for row, b in zip(x, q)) for j in range(len(beta))]
                 for i in range(len(beta))]
        step = [sum(c * s for c, s in zip(row, slope)) for row in inverse(curve)]
        beta = [b + s for b, s in zip(beta, step)]
        if max(map(abs, step)) < 1e-10:
            return probabilities(x, beta)
    sys.exit("the likelihood has no maximum")


def normal(z):
    return 0.5 * math.erfc(-z / math.sqrt(2))


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        people = [row for row in csv.DictReader(file) if row["counts"] == "yes"]
    x = [[float(term(person)) for term in TERMS.values()] for person in people]
    p = probabilities(x, list(PUBLISHED.values()))
    share = int(sys.argv[2]) / len(people)
    for j, term in enumerate(PUBLISHED):
        q = fitted([row[:j] + row[j + 1:] for row in x], p)
        far = math.sqrt(share * 2 * 6 * sum(
            a * math.log(a / b) + (1 - a) * math.log((1 - a) / (1 - b)) for a, b in zip(p, q)))
        print(f"{term},{normal(far - 1.959964) + normal(-far - 1.959964):.4f}")


if __name__ == "__main__":
    main()
