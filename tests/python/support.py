"""What the tests of the Python package share."""

import json
import os
import subprocess

PROGRAM = os.environ["HEADPIN_PROGRAM"]
SOURCES = os.environ["HEADPIN_SOURCE_DIR"]
DEMO = os.path.join(SOURCES, "assets/trials/demo.lcmlog")


def command(*words):
    """Runs `headpin WORDS`, which must succeed; returns what it prints on standard output."""
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def json_of(*words):
    """What `headpin WORDS --json` prints."""
    return json.loads(command(*words, "--json"))
