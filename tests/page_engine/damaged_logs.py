#!/usr/bin/env python3
"""The first damaged trials of mutated_logs.py, as files.

usage: damaged_logs.py HEADPIN TRIAL FOLDER N
"""

import argparse
import os
import random
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fuzz"))
import mutated_logs  # noqa: E402

headpin, trial, folder, count = sys.argv[1:]
os.makedirs(folder)
with tempfile.TemporaryDirectory() as work:
    bases = mutated_logs.make_bases(argparse.Namespace(headpin=headpin, trial=trial), work)
for number in range(int(count)):
    draw = random.Random(f"1/{number}")
    with open(os.path.join(folder, f"{number:06}.lcmlog"), "wb") as file:
        file.write(mutated_logs.damage(bases[number % len(bases)], draw))
