#!/usr/bin/env python3
"""Damaged trials against every command that reads one.

usage: mutated_logs.py HEADPIN TRIAL [--logs N] [--first K] [--seed S] [--memory MB]
                       [--timeout SECONDS] [--jobs J] [--commands NAME,...]

Makes N logs out of a short session, each damaged in its own way: bits flipped anywhere or in the
times and sizes, events lost, doubled, swapped or cut, a scenario that is none, random bytes between.
Every command must end by itself with one of its exit codes, within the time and the memory allowed,
and without a word from a sanitizer. What does not is kept, and the command that shows it is printed.

The session is TRIAL's throw without the time in which nothing happens: grab, release, a ball among
skittles, every kind of message there is, in 1.8 s. In every other log it stands a second time as
`live` publishes it, on SESSION_*. Its pictures are small, and drawn without a compiler of shaders
(GALLIUM_DRIVER=softpipe): that is Mesa's, and a second of every run else.
"""

import argparse
import json
import os
import random
import resource
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor

MAGIC = b"\xed\xa1\xda\x01"
HEADER = struct.Struct(">IqqII")

# LOG is the damaged one, OUT a name for what is written, PAGE what `report` fills in. None needs a
# network. Of several ways to call one, each log gets the next.
COMMANDS = {
    "info": ("info LOG", "info LOG --json", "info LOG --scenario"),
    "replay": ("replay LOG -o OUT.lcmlog",),
    "replay --verify": ("replay LOG --verify",),
    "frames": ("frames LOG -o OUT --frames 0,30", "frames LOG --verify"),
    "compare": ("compare LOG TRIAL", "compare TRIAL LOG --json"),
    "export": ("export LOG -o OUT",),
    "plot": ("plot LOG -o OUT",),
    "report": ("report LOG -o OUT.html --page PAGE", "report TRIAL LOG -o OUT.html --page PAGE"),
    "import": ("import LOG -o OUT.lcmlog",),
    "stream": ("stream LOG --lcm file://OUT?mode=w --speed 0",),
    "emulate": ("emulate LOG --duration 0.2", "emulate --lcm file://LOG?speed=0 --duration 0.2"),
    "live": ("live --lcm file://LOG?speed=0 --eyes none --duration 0.5",
             "live LOG --record OUT.lcmlog --duration 0.5"),
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


def parts(log):
    """Number, stamp, channel and data of each event."""
    for a, b in events(log):
        _, number, stamp, size, _ = HEADER.unpack_from(log, a)
        name = a + HEADER.size + size
        yield number, stamp, log[a + HEADER.size : name].decode(), log[name:b]


def log_of(messages):
    """A log of stamps, channels and data."""
    out = bytearray()
    for number, (stamp, channel, data) in enumerate(messages):
        name = channel.encode()
        out += HEADER.pack(0xEDA1DA01, number, stamp, len(name), len(data)) + name + data
    return bytes(out)


# What makes a run cheap: small pictures, few ticks, skittles that are weighed in no time.
CHEAP = ("hmd.width=24", "hmd.height=16", "look.samples=1", "look.mirror=false",
         "look.shadow=false", "look.contact=false", "rates.physics_hz=120",
         "skittle.parts=[{shape='cylinder',radius=0.045,low=0.0,high=0.381}]")
# What is kept of the throw [us], and by how much it comes sooner: the grab, and the swing's end.
KEPT = ((1_150_000, 1_300_000, 1_100_000), (3_700_000, 4_050_000, 3_350_000))
END = 1_800_000  # by then the ball has met the skittles
# Where a message has the times of device, host, session and sending.
TIMES = {"TRACKER": (8, 16, -18, -10), "MOUSE3D": (8, 16, -8)}
FRAME = bytes.fromhex("1bf925c665cbce1c")


def sooner(channel, data, by):
    """A sample that much earlier; times of 0 stay."""
    data = bytearray(data)
    for at in TIMES[channel]:
        at %= len(data)
        (time,) = struct.unpack_from(">q", data, at)
        struct.pack_into(">q", data, at, time - by if time else 0)
    return bytes(data)


def throw_of(trial):
    """The header and the samples of a short throw."""
    messages, last = [], {}
    for _, stamp, channel, data in parts(trial):
        if channel == "HEADPIN_TRIAL":
            messages.append((0, channel, data))
        if channel not in TIMES:
            continue
        for begin, end, by in KEPT:
            if begin <= stamp < end:
                last[channel, data[32:36]] = stamp - by, channel, sooner(channel, data, by)
                messages.append((stamp - by, channel, sooner(channel, data, by)))
    for stamp, channel, data in last.values():
        if channel == "TRACKER":  # nobody moves any more
            messages.append((END, channel, sooner(channel, data, stamp - END)))
    return log_of(messages)


def frame(number):
    """A record of a frame, on FRAME."""
    eye = (0.0, 0.0, 1.6, 1.0, 0.0, 0.0, 0.0)
    time = number * 1_000_000 // 60
    return time, "FRAME", FRAME + struct.pack(">3q14dqq", time, number, 2 * number, *eye, *eye, 1, 2)


def session_of(game):
    """A replayed throw with every fifth of its states, and frames."""
    messages, states = [], 0
    for _, stamp, channel, data in parts(game):
        states += channel == "STATE"
        if channel != "STATE" or states % 5 == 0:
            messages.append((stamp, channel, data))
    end = messages.pop()
    messages[1:] = sorted(messages[1:] + [frame(n) for n in (0, 30, 60)], key=lambda m: m[0])
    return messages + [end]


def twice(messages):
    """The session's own messages on SESSION_*, what it listened to beside them."""
    both = []
    for stamp, channel, data in messages:
        both.append((stamp, "SESSION_" + channel, data))
        if channel in TIMES:
            both.append((stamp, channel, data))
    return both


def make_bases(options, folder):
    """The session, as it is published, and with most states told by what is new in them.

    The first is compared with, too."""
    def headpin(*words, unless=None):
        said = subprocess.run([options.headpin, *words], capture_output=True, text=True)
        if said.returncode != 0 and not (unless and unless in said.stderr):
            sys.exit(f"{words[0]}: {said.stderr}")
        return said.stdout
    at = lambda name: os.path.join(folder, name)
    small = [w for key in CHEAP for w in ("--set", key)]
    headpin("replay", options.trial, "-o", at("small.lcmlog"), *small)
    with open(at("small.lcmlog"), "rb") as file, open(at("throw.lcmlog"), "wb") as out:
        out.write(throw_of(file.read()))
    headpin("replay", at("throw.lcmlog"), "-o", at("game.lcmlog"), "--states", "all")
    with open(at("game.lcmlog"), "rb") as file:
        session = session_of(file.read())
    options.trial = at("session.lcmlog")
    with open(options.trial, "wb") as out:
        out.write(log_of(session))
    # Four of five states are left out, so that --verify ends with 1.
    headpin("replay", options.trial, "--verify", unless="the other 43 are equal")
    found = json.loads(headpin("info", options.trial, "--json"))
    kinds = {event["kind"] for event in found["events"]}
    if found["frames"] != 3 or not {"grab", "release", "first_contact"} <= kinds:
        sys.exit(f"the session lacks something: {found['frames']} frames, {sorted(kinds)}")
    headpin("replay", at("throw.lcmlog"), "-o", at("changes.lcmlog"))
    with open(at("changes.lcmlog"), "rb") as file:
        changes = file.read()
    return [log_of(session), log_of(twice(session)), changes]


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


def processor_seconds(process):
    """That it has had; 0 when it is no more."""
    try:
        with open(f"/proc/{process}/stat") as file:
            user, system = file.read().rpartition(")")[2].split()[11:13]
    except OSError:
        return 0.0
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


class Server:
    """The program, loaded once; each run is a child of it. See fork_server.cpp."""

    def __init__(self, options, leaks):
        environment = {**os.environ, "LD_PRELOAD": options.preload, "GALLIUM_DRIVER": "softpipe",
                       "ASAN_OPTIONS": f"verify_asan_link_order=0:detect_leaks={leaks:d}"}
        self.process = subprocess.Popen([options.headpin], env=environment, bufsize=0,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def line(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit("the program's server has ended")
        return line

    def ends_in_time(self, child, timeout):
        """Whether it ends before it has had so much of a processor, or ten times that has passed: a
        machine that is busy with other things lets it wait, and a lock lets it wait for ever."""
        latest = time.monotonic() + 10.0 * timeout
        while not select.select([self.process.stdout], [], [], 0.5)[0]:
            if processor_seconds(child) > timeout or time.monotonic() > latest:
                return False
        return True

    def run(self, words, folder, timeout):
        """Exit code, memory [KB] and words; no exit code where it had to be killed."""
        said = os.path.join(folder, "said")
        request = b"".join(os.fsencode(word) + b"\0" for word in (folder, said, *words))
        self.process.stdin.write(b"%d\n" % len(request) + request)
        child = int(self.line())
        in_time = self.ends_in_time(child, timeout)
        if not in_time:
            os.kill(child, signal.SIGKILL)
        status, memory = map(int, self.line().split())
        if not in_time:
            return None, 0, ""
        with open(said, "rb") as file:
            text = file.read(1 << 20).decode(errors="replace")
        return os.waitstatus_to_exitcode(status), memory, text


def fork_server(folder):
    """Built here: it is no part of the program."""
    library = os.path.join(folder, "fork_server.so")
    source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "fork_server.cpp")
    subprocess.run(["c++", "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    return library


def server_of(options, number, command):
    """This thread's. Every eighth log is asked for leaks, which costs as much as a short run; what
    draws is not, for what leaks there is Mesa's."""
    leaks = number % 8 == 7 and command not in ("frames", "live")
    if leaks not in options.servers.__dict__.setdefault("by_leaks", {}):
        options.servers.by_leaks[leaks] = Server(options, leaks)
    return options.servers.by_leaks[leaks]


def run(words, number, folder, options):
    """What went wrong, or nothing."""
    server = server_of(options, number, words[0])
    code, memory, text = server.run(words, folder, options.timeout)
    if code is None:
        return f"still runs after {options.timeout:.0f} s"
    if code not in EXIT_CODES:
        return f"exit code {code}: {text[-2000:]}"
    if "Sanitizer" in text or "runtime error" in text:
        return f"a sanitizer: {text[:3000]}"
    if memory > options.memory * 1024:
        return f"{memory // 1024} MB"
    return None


def try_log(number, bases, options, kept):
    """Runs every command on one damaged log; returns runs and failures."""
    draw = random.Random(f"{options.seed}/{number}")
    folder = tempfile.mkdtemp(prefix="headpin-mutated-")
    log = os.path.join(folder, "log.lcmlog")
    with open(log, "wb") as file:
        file.write(damage(bases[number % 3], draw))
    failures = []
    for name in options.commands:
        ways = COMMANDS[name]
        words = ways[number // 3 % len(ways)]
        words = words.replace("LOG", log).replace("OUT", "out").replace("TRIAL", options.trial)
        words = words.replace("PAGE", options.page)
        wrong = run(words.split(), number, folder, options)
        if wrong:
            shutil.copy(log, os.path.join(kept, f"{number}.lcmlog"))
            failures.append(f"log {number}, {words}: {wrong}")
        for left in ("out.lcmlog", "out.html", "out"):
            path = os.path.join(folder, left)
            shutil.rmtree(path, ignore_errors=True) if os.path.isdir(path) else None
            if os.path.exists(path):
                os.remove(path)
    shutil.rmtree(folder, ignore_errors=True)
    return len(options.commands), failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("headpin")
    parser.add_argument("trial")
    parser.add_argument("--logs", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="number of the first log")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--memory", type=int, default=200, help="MB; a sanitizer needs more")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds of a processor for each run")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--commands", help="these alone: " + ", ".join(COMMANDS))
    options = parser.parse_args()
    options.commands = options.commands.split(",") if options.commands else list(COMMANDS)
    options.headpin = os.path.abspath(options.headpin)
    options.trial = os.path.abspath(options.trial)
    made = tempfile.mkdtemp(prefix="headpin-session-")
    bases = make_bases(options, made)
    options.preload, options.servers = fork_server(made), threading.local()
    options.page = os.path.join(made, "page.html")
    with open(options.page, "w") as file:
        file.write("<!--headpin:data-->")
    kept = tempfile.mkdtemp(prefix="headpin-failing-logs-")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    began, number, runs, failures = time.monotonic(), 0, 0, []
    with ThreadPoolExecutor(options.jobs) as pool:
        results = pool.map(lambda n: try_log(n, bases, options, kept),
                           range(options.first, options.first + options.logs))
        for count, wrong in results:
            runs += count
            for failure in wrong:
                print(failure, flush=True)
            failures += wrong
            if (number := number + 1) % 100 == 0:
                print(f"{number} logs", file=sys.stderr, flush=True)
    took = time.monotonic() - began
    print(f"{options.logs} logs, {runs} runs, {len(failures)} failures in {took:.0f} s")
    if failures:
        print(f"kept in {kept}")
        sys.exit(1)
    os.rmdir(kept)
    shutil.rmtree(made)


if __name__ == "__main__":
    main()
