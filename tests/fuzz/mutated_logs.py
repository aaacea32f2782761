#!/usr/bin/env python3
"""Damaged trials against every command that reads one.

usage: mutated_logs.py HEADPIN TRIAL [--logs N] [--seed S] [--memory MB] [--timeout SECONDS]

Makes N logs out of TRIAL, each damaged in its own way: bits flipped anywhere or in the times and
sizes, events lost, doubled, swapped or cut, a scenario that is none, random bytes between. Every
command must end by itself with one of its exit codes, within the time and the memory allowed, and
without a word from a sanitizer. What does not is kept, and the command that shows it is printed.
"""

import argparse
import os
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

MAGIC = b"\xed\xa1\xda\x01"
HEADER = struct.Struct(">IqqII")

# LOG is the damaged one, OUT a name for what is written. None needs a network.
COMMANDS = {
    "info": "info LOG",
    "info --json": "info LOG --json",
    "info --scenario": "info LOG --scenario",
    "replay": "replay LOG -o OUT.lcmlog",
    "replay --verify": "replay LOG --verify",
    "frames": "frames LOG -o OUT --frames 0,30",
    "compare": "compare LOG TRIAL",
    "stream": "stream LOG --lcm memq:// --speed 0",
    "emulate": "emulate LOG --duration 0.2",
    "emulate --lcm": "emulate --lcm file://LOG?speed=0 --duration 0.2",
    "live": "live --lcm file://LOG?speed=0 --eyes none --duration 0.5",
}
EXIT_CODES = (0, 1, 2, 75)


def events(log):
    """Start and end of each event."""
    at, spans = 0, []
    while at + HEADER.size <= len(log):
        _, _, _, channel, data = HEADER.unpack_from(log, at)
        end = at + HEADER.size + channel + data
        spans.append((at, end))
        at = end
    return spans


def shortened(log, count):
    """The header, the first samples, and the end."""
    spans = events(log)
    return b"".join(log[a:b] for a, b in spans[:count] + spans[-1:])


def flip(log, at, draw):
    log[at] ^= 1 << draw.randrange(8)


def damage(log, draw):
    """One log, damaged in one to four ways."""
    log = bytearray(log)
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        spans = [(a, min(b, len(log))) for a, b in events(bytes(log))] or [(0, len(log))]
        a, b = draw.choice(spans)
        kind = draw.randrange(11)
        if kind == 0:
            for _ in range(draw.choice((1, 10, 100))):
                flip(log, draw.randrange(len(log)), draw)
        elif kind == 1:  # the stamp of an event, or its number
            flip(log, min(len(log) - 1, a + draw.randrange(4, 20)), draw)
        elif kind == 2:  # the first fields of a message: fingerprint and times
            flip(log, min(len(log) - 1, a + HEADER.size + draw.randrange(7, 40)), draw)
        elif kind == 3:  # sizes that lie
            size = draw.choice((0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, draw.randrange(1 << 20)))
            where = a + draw.choice((20, 24))
            log[where : where + 4] = struct.pack(">I", size)
        elif kind == 4:
            del log[draw.randrange(1, len(log)) :]
        elif kind == 5:
            del log[a:b]
        elif kind == 6:
            log[b:b] = log[a:b] * draw.choice((1, 3, 50))
        elif kind == 7:
            c, d = draw.choice(spans)
            log = bytearray(bytes(log[:a]) + bytes(log[c:d]) + bytes(log[a:]))
        elif kind == 8:
            at = draw.randrange(len(log))
            log[at:at] = draw.randbytes(draw.choice((1, 40, 5000)))
        elif kind == 9:  # the scenario's text, in the header
            end = spans[0][1]
            for _ in range(draw.choice((1, 5))):
                flip(log, draw.randrange(min(end, len(log))), draw)
        else:
            log[a:b] = MAGIC + draw.randbytes(max(0, b - a - 4))
        if not log:
            log = bytearray(MAGIC)
    return bytes(log)


def run(command, folder, options):
    """What went wrong, or nothing."""
    limit = options.memory * 1024
    began = time.monotonic()
    with open(os.path.join(folder, "said"), "wb") as said:
        child = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=said,
                                 stderr=subprocess.STDOUT)
        timer_over = began + options.timeout
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > timer_over:
                os.kill(child.pid, signal.SIGKILL)
                os.wait4(child.pid, 0)
                child.returncode = -signal.SIGKILL
                return f"still runs after {options.timeout:.0f} s"
            time.sleep(0.005)
    child.returncode = code = os.waitstatus_to_exitcode(status)
    with open(os.path.join(folder, "said"), "rb") as said:
        text = said.read(1 << 20).decode(errors="replace")
    if code not in EXIT_CODES:
        return f"exit code {code}: {text[-2000:]}"
    if "Sanitizer" in text or "runtime error" in text:
        return f"a sanitizer: {text[:3000]}"
    if usage.ru_maxrss > limit:
        return f"{usage.ru_maxrss // 1024} MB"
    return None


def try_log(number, trial, options, kept):
    """Runs every command on one damaged log; returns runs and failures."""
    draw = random.Random(f"{options.seed}/{number}")
    folder = tempfile.mkdtemp(prefix="headpin-mutated-")
    log = os.path.join(folder, "log.lcmlog")
    with open(log, "wb") as file:
        file.write(damage(trial, draw))
    failures = []
    for name, words in COMMANDS.items():
        words = words.replace("LOG", log).replace("OUT", "out").replace("TRIAL", options.trial)
        wrong = run([options.headpin] + words.split(), folder, options)
        if wrong:
            shutil.copy(log, os.path.join(kept, f"{number}.lcmlog"))
            failures.append(f"log {number}, {name}: {wrong}")
        for left in ("out.lcmlog", "out"):
            path = os.path.join(folder, left)
            shutil.rmtree(path, ignore_errors=True) if os.path.isdir(path) else None
            if os.path.exists(path):
                os.remove(path)
    shutil.rmtree(folder, ignore_errors=True)
    return len(COMMANDS), failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("headpin")
    parser.add_argument("trial")
    parser.add_argument("--logs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--memory", type=int, default=200, help="MB; a sanitizer needs more")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds for each run")
    parser.add_argument("--events", type=int, default=150, help="of the trial that are used")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    options.headpin = os.path.abspath(options.headpin)
    options.trial = os.path.abspath(options.trial)
    with open(options.trial, "rb") as file:
        trial = shortened(file.read(), options.events)
    kept = tempfile.mkdtemp(prefix="headpin-failing-logs-")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    began, runs, failures = time.monotonic(), 0, []
    with ThreadPoolExecutor(options.jobs) as pool:
        results = pool.map(lambda n: try_log(n, trial, options, kept), range(options.logs))
        for count, wrong in results:
            runs += count
            for failure in wrong:
                print(failure, flush=True)
            failures += wrong
    took = time.monotonic() - began
    print(f"{options.logs} logs, {runs} runs, {len(failures)} failures in {took:.0f} s")
    if failures:
        print(f"kept in {kept}")
        sys.exit(1)
    os.rmdir(kept)


if __name__ == "__main__":
    main()
