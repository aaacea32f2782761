#!/usr/bin/env python3
"""Lets every read of every command fail, one in each run, and looks at what becomes of it.

usage: failing_reads.py HEADPIN TRIAL

A command whose read fails ends with another code than 0 and with a reason, or its results are, to the byte, those of a
run in which nothing failed. Needs strace, which makes the kernel say EIO. Reads of the loader and of libraries count too.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile

CALLS = "read,pread64,readv,preadv,getdents64"


def run(command, folder, number=None):
    """@return  code, what it said, files it made, how many reads there were"""
    count = os.path.join(folder, "..", "calls")
    inject = [] if number is None else ["-e", f"inject={CALLS}:error=EIO:when={number}"]
    # A thread or a child counts for itself, so that the same read fails in each.
    done = subprocess.run(["strace", "-f", "-qq", "-o", count, "-e", "trace=" + CALLS, *inject, *command],
                          cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=120)
    with open(count, encoding="utf-8", errors="replace") as file:
        lines = file.read().splitlines()
    by_task = {}
    for line in lines:
        if re.match(rf"\d+ +({CALLS.replace(',', '|')})\(", line):
            task = line.split()[0]
            by_task[task] = by_task.get(task, 0) + 1
    made = {}
    for place, folders, names in os.walk(folder):
        # What is left over of headpin's own, which the next headpin there removes, is no result.
        folders[:] = [name for name in folders if not name.startswith(".headpin.")]
        for name in names:
            path = os.path.join(place, name)
            if path.endswith(".parts/.headpin") and len(names) == 1:
                continue
            with open(path, "rb") as file:
                made[os.path.relpath(path, folder)] = file.read()
    if command[1] == "stream":  # stamped by the clock
        made = {name: len(content) for name, content in made.items()}
    return done.returncode, done.stdout + done.stderr, made, max(by_task.values(), default=0)


def timeless(text):
    """Without what depends on how long it took."""
    return [line for line in text.splitlines() if b"times real time" not in line and b" samples in " not in line]


def fresh(folder, inputs):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for path in inputs:
        shutil.copy(path, folder)


def main():
    headpin, demo = (os.path.abspath(path) for path in sys.argv[1:3])
    wrong = runs = 0
    with tempfile.TemporaryDirectory() as top:
        states = os.path.join(top, "states.lcmlog")
        subprocess.run([headpin, "replay", demo, "-o", states], check=True, capture_output=True)
        page = os.path.join(top, "page.html")
        with open(page, "w", encoding="utf-8") as file:
            file.write("<!--headpin:data-->" + "x" * 300_000)
        csv = os.path.join(os.path.dirname(demo), "..", "throws")
        throws = [os.path.join(csv, name) for name in sorted(os.listdir(csv)) if name.endswith(".csv")][:1]
        commands = [
            "info states.lcmlog",
            "replay states.lcmlog --verify -o again.lcmlog",
            "compare states.lcmlog states.lcmlog",
            "export states.lcmlog -o tables",
            "plot states.lcmlog -o plot.svg",
            "report states.lcmlog --page page.html -o trial.html",
            "stream states.lcmlog --speed 0 --lcm file://sent.log?mode=w",
            "scenario check german-ninepins",
            "scenario show german-ninepins",
            "synthesize -o made.lcmlog",
            "frames states.lcmlog --frames 0-1 -o drawn",
            "frames states.lcmlog --frames 0-1 --jobs 2 -o drawn",
        ]
        if throws:
            commands.append(f"import {os.path.basename(throws[0])} -o imported.lcmlog")
        folder = os.path.join(top, "work")
        for command in commands:
            words = [headpin, *command.split()]
            fresh(folder, [states, page, *throws])
            code, said, whole, reads = run(words, folder)
            if code != 0 or reads == 0:
                print(f"{command}: ended with {code}: {said.decode(errors='replace')}")
                return 1
            bad = 0
            for number in range(1, reads + 1):
                fresh(folder, [states, page, *throws])
                code, text, made, _ = run(words, folder, number)
                runs += 1
                alike = made == whole and timeless(text) == timeless(said)
                if (code == 0 and not alike) or (code != 0 and not text):
                    bad += 1
                    print(f"{command}: with read {number} failed it ends with {code}: "
                          f"{text.decode(errors='replace')[:300]}"
                          f" ({[name for name in {**whole, **made} if whole.get(name) != made.get(name)]} differ)")
            wrong += bad
            print(f"{command}: {reads} reads, {bad} not noticed", flush=True)
    print(f"{runs} runs, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
