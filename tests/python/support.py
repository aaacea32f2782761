"""What the tests of the Python package share."""

import atexit
import functools
import json
import os
import shutil
import subprocess
import tempfile

PROGRAM = os.environ["HEADPIN_PROGRAM"]
SOURCES = os.environ["HEADPIN_SOURCE_DIR"]
DEMO = os.path.join(SOURCES, "assets/trials/demo.lcmlog")


def command(*words):
    """Runs `headpin WORDS`, which must succeed; returns what it prints on standard output."""
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def json_of(*words):
    """What `headpin WORDS --json` prints."""
    return json.loads(command(*words, "--json"))


@functools.cache
def folder():
    """A temporary folder for this process."""
    made = tempfile.mkdtemp(prefix="headpin-python-")
    atexit.register(shutil.rmtree, made)
    return made


def file(name):
    return os.path.join(folder(), name)


@functools.cache
def simulated():
    """The bundled trial, simulated: it has events and states."""
    path = file("simulated.lcmlog")
    command("replay", DEMO, "-o", path)
    return path


def damaged(name, change):
    """A copy of the simulated trial whose bytes `change` has changed."""
    path = file(name)
    with open(simulated(), "rb") as source, open(path, "wb") as copy:
        copy.write(change(bytearray(source.read())))
    return path
