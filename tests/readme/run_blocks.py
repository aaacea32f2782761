#!/usr/bin/env python3
"""Runs the blocks of README.md and docs/ and compares what they print with what is shown.

usage: run_blocks.py SOURCE-FOLDER PROGRAM [PAGE...]

PAGE is a page as named from the source folder; without one, README.md and all pages of docs/.

- A `console` block is one shell, in a folder that all blocks of its page share; `assets` is there
  and `headpin` is found. A line that begins with `$ ` is typed, with those below it that begin with
  `> `; the others are what it must print, on standard output and error together, neither more nor
  fewer. Lines are compared whole, after what may differ from run to run (UNSTABLE, below) has been
  taken out of both.
- A block behind `<!-- runs beside the next block -->` is stopped after the one that follows; that
  one begins when all its lines have been printed.
- What needs a multicast route runs in a network of its own, or is passed over where this user may
  not have one.
- A block that needs what this machine lacks (NEEDS, below) is passed over, and that is said.
- The `python` blocks of a page are one program, in such a folder; the `text` block behind one has what it prints.
  They are passed over where the Python package is not built beside the program.
- `cmake` and `cpp` blocks must stand in tests/package/engine_client, which a test builds and runs.
- `sh` blocks are for a clone: their commands must be known to ./dev, or be git's or cmake's.
- A `bibtex` or `text` block is not run.
"""

import contextlib
import ctypes.util
import glob
import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# What may differ between two runs or machines: (what to look for, what is left of it).
UNSTABLE = [
    (r"^(times real time +)\S+", r"\1N"),  # speed of the machine
    (r"drawn by .*", "drawn by RENDERER"),  # Mesa's version
    (r"^(  written by headpin \S+) \(.*\)", r"\1 (COMMIT)"),
    (r"^(  HEADPIN_TRIAL .* messages ) *(?:\d+|\.\.\.) bytes", r"\1N bytes"),  # the commit is in it
    (r"^/dev/pts/\d+", "/dev/pts/N"),
    (r"; late by .*", "; late by N"),
    (r"(samples in) [\d.]+ s", r"\1 N s"),
    # The line of a live session: how it went depends on the machine; that it went is compared.
    (r"^( +\d+\.\d s  )\d+ samples, .*", r"\1N samples, ..."),
    (r"^( +mean )[\d.]+ ms: .*", r"\1N ms: ..."),
    (r"^ +no skittle fell: .*", ""),  # the noise of a unit far from its transmitter
    # What the machine can draw: said in the middle of whatever else is going on.
    (r"^eyes: about .*", ""),
    # The doctor speaks of this machine: what it looks at is compared.
    (r"^(\S+) +(ok|no) .*", r"\1 ..."),
    (r"^ +type: .*", ""),
]

# What a block needs that a machine may lack: (what to look for in its commands, whether it is there).
NEEDS = [
    ("headpin report", lambda source: os.path.exists(os.path.join(source, "build/report/page.html"))),
    ("Rscript", lambda source: shutil.which("Rscript")),
    ("trial.pdf", lambda source: ctypes.util.find_library("rsvg-2")),
]


def stable(lines):
    """The lines without what may differ; one that is left empty by that is dropped."""
    out = []
    for line in lines:
        text = line.rstrip()
        for pattern, rest in UNSTABLE:
            text = re.sub(pattern, rest, text)
        if text or not line.strip():
            out.append(text)
    return out


class Block:
    def __init__(self, language, lines, at, beside):
        self.language, self.lines, self.beside = language, lines, beside
        self.at = at  # page:line

    def commands(self):
        """(typed, expected lines) in order."""
        found = []
        for line in self.lines:
            if line.startswith("$ "):
                found.append((line[2:], []))
            elif line.startswith("> ") and not found[-1][1]:
                found[-1] = (found[-1][0] + "\n" + line[2:], [])
            else:
                found[-1][1].append(line)
        return found


def blocks(source, page):
    found, block, beside = [], None, False
    with open(os.path.join(source, page), encoding="utf-8") as file:
        lines = file.read().split("\n")
    for number, line in enumerate(lines, 1):
        fence = re.match(r"```(\w*)$", line)
        if block is not None and fence:
            found.append(block)
            block = None
        elif fence:
            block, beside = Block(fence[1], [], f"{page}:{number}", beside), False
        elif block is not None:
            block.lines.append(line)
        elif line.startswith("<!--"):
            beside = "runs beside the next block" in line
    return found


MARK = "@@ "


def script(block):
    """The block for bash: a mark before what each command prints."""
    lines = ["exec 2>&1"]
    for i, (typed, _) in enumerate(block.commands()):
        lines += [f"echo '{MARK}{i}'", typed]
    return "\n".join(lines) + "\n"


def start(block, folder, environment, network):
    """Runs a block; output goes to a file, so that who is killed leaves what it has printed."""
    output = tempfile.TemporaryFile()
    command = ["bash", "-c", script(block)]
    if network and any("udpm:" in line for line in block.lines):
        command = network + command
    process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                               stdout=output, stderr=output, start_new_session=True)
    return process, output


def printed(output):
    output.seek(0)
    parts = [[]]
    for line in output.read().decode("utf-8", "replace").splitlines():
        if line.startswith(MARK):
            parts.append([])
        else:
            parts[-1].append(line)
    return parts[1:]


def complaints(block, parts):
    """What differs, as text; empty where nothing does."""
    said = []
    for i, (typed, expected) in enumerate(block.commands()):
        found = parts[i] if i < len(parts) else []
        if stable(expected) == stable(found):
            continue
        said.append(f"{block.at}: $ {typed}\n  shows\n    " + "\n    ".join(expected) +
                    "\n  and prints\n    " + "\n    ".join(found))
    return said


def private_network():
    """A command that runs another in a network with a multicast route; None where that cannot be."""
    command = ["unshare", "-rn", "bash", "-c",
               'ip link set lo up && ip link set lo multicast on && '
               'ip route add 224.0.0.0/4 dev lo && exec "$@"', "bash"]
    try:
        subprocess.run(command + ["true"], check=True, capture_output=True)
        return command
    except (OSError, subprocess.CalledProcessError):
        return None


def missing(source, block):
    """What the block needs and this machine lacks; empty where it can be run."""
    return [what for what, there in NEEDS
            if any(what in typed for typed, _ in block.commands()) and not there(source)]


def run_console(source, program, consoles):
    folder = tempfile.mkdtemp(prefix="headpin-readme-")
    os.symlink(os.path.join(source, "assets"), os.path.join(folder, "assets"))
    environment = dict(os.environ, LC_ALL="C.UTF-8", LSAN_OPTIONS="print_suppressions=0")
    environment["PATH"] = os.path.dirname(program) + ":" + environment["PATH"]
    network = private_network()
    said, waiting = [], None
    try:
        for block in consoles:
            if network is None and any("udpm:" in line for line in block.lines):
                print(f"{block.at}: passed over: no network of its own with multicast")
                continue
            if lacks := missing(source, block):
                print(f"{block.at}: passed over: no {', '.join(lacks)}")
                continue
            process, output = start(block, folder, environment, network)
            if block.beside:
                while complaints(block, printed(output)) and process.poll() is None:
                    time.sleep(0.05)
                said += complaints(block, printed(output))
                waiting = process
                continue
            process.wait()
            said += complaints(block, printed(output))
            if waiting:
                end(waiting, signal.SIGTERM)
                waiting = None
    finally:
        if waiting:
            end(waiting, signal.SIGKILL)
        shutil.rmtree(folder)
    return said


def end(process, how):
    """Ends a block that runs beside others, and what it started; it may have ended by itself."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, how)
    process.wait()


def check_sources(source, block):
    client = os.path.join(source, "tests/package/engine_client")
    name = "client.cpp" if block.language == "cpp" else "CMakeLists.txt"
    if "\n".join(block.lines) in open(os.path.join(client, name), encoding="utf-8").read():
        return []
    return [f"{block.at}: expected to stand in tests/package/engine_client/{name}"]


def check_shell(source, block):
    known = subprocess.run([os.path.join(source, "dev"), "help"], check=True, text=True,
                           capture_output=True).stdout
    said = []
    for line in block.lines:
        words = line.split("#")[0].split()
        if not words or words[0] in ("git", "cd", "cmake", "export"):
            continue
        if words[0] != "./dev" or not re.search(rf"^  {words[1]}\b", known, re.M):
            said.append(f"{block.at}: ./dev does not know: {line}")
    return said


def run_python(source, program, found):
    """Runs the python blocks as one program that prints a mark before each of them."""
    package = os.path.join(os.path.dirname(program), "python")
    pairs = [(block, found[i + 1].lines if found[i + 1:] and found[i + 1].language == "text" else [])
             for i, block in enumerate(found) if block.language == "python"]
    if pairs and not os.path.isdir(package):
        print(f"{pairs[0][0].at}: passed over: no {package}")
        return []
    code = "".join(f"print('{MARK}')\n" + "\n".join(block.lines) + "\n" for block, _ in pairs)
    with tempfile.TemporaryDirectory(prefix="headpin-readme-") as folder:
        os.symlink(os.path.join(source, "assets"), os.path.join(folder, "assets"))
        done = subprocess.run([sys.executable, "-B", "-c", code], cwd=folder, env=dict(os.environ, PYTHONPATH=package),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    parts = [part.splitlines() for part in ("\n" + done.stdout).split("\n" + MARK + "\n")[1:]]
    return [f"{block.at}: shows\n    " + "\n    ".join(expected) + "\n  and prints\n    " + "\n    ".join(printed)
            for (block, expected), printed in itertools.zip_longest(pairs, parts, fillvalue=[]) if expected != printed]


def check_page(source, program, page):
    """What is wrong on a page, and how many console blocks and blocks it has."""
    found = blocks(source, page)
    said = []
    for block in found:
        if block.language in ("cmake", "cpp"):
            said += check_sources(source, block)
        elif block.language == "sh":
            said += check_shell(source, block)
        elif block.language not in ("console", "python", "bibtex", "text", ""):
            said.append(f"{block.at}: nobody knows how to try a {block.language} block")
    if any(block.language == "python" for block in found):
        said += run_python(source, program, found)
    consoles = [block for block in found if block.language == "console"]
    if consoles:
        said += run_console(source, program, consoles)
    return said, len(consoles), len(found)


def pages_of(source):
    found = glob.glob(os.path.join(source, "docs/**/*.md"), recursive=True)
    return ["README.md"] + sorted(os.path.relpath(path, source) for path in found)


def main():
    source, program = map(os.path.abspath, sys.argv[1:3])
    pages = sys.argv[3:]
    failed, consoles, total = False, 0, 0
    for page in pages or pages_of(source):
        began = time.monotonic()
        said, of_console, of_any = check_page(source, program, page)
        consoles, total = consoles + of_console, total + of_any
        if of_any:
            print(f"{page}: {of_console} console blocks, {of_any} in all,"
                  f" {time.monotonic() - began:.0f} s", flush=True)
        if said:
            failed = True
            print("\n\n".join(said), flush=True)
    print(f"{consoles} console blocks, {total} in all")
    sys.exit(1 if failed or (not pages and consoles < 30) else 0)


main()
