#!/usr/bin/env python3
"""What the packages ask for is what they can use, and what they leave behind is taken away.

usage: needs_test.py BUILD
"""

import os
import re
import subprocess
import sys


def main():
    build = sys.argv[1]
    with open(f"{build}/CPackConfig.cmake", encoding="utf-8") as file:
        settings = dict(re.findall(r'^set\((\w+) "([^"]*)"\)', file.read(), re.MULTILINE))
    failed = []

    def expect(good, what):
        if not good:
            failed.append(what)

    suggested = settings["CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS"].split(", ")
    for package in ("r-base-core", "r-cran-brglm2", "python3-headpin"):
        expect(package in suggested, f"headpin does not suggest {package}")
    if os.path.exists(f"{build}/wheel/setup.py"):
        with open(f"{build}/wheel/setup.py", encoding="utf-8") as file:
            expect('"numpy>=1.24,<2"' in file.read(), "the wheel takes numpy 2, which pybind11 2.10 does not know")
        scripts = {os.path.basename(path): path
                   for path in settings.get("CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA", "").split(";") if path}
        for name, calls in (("postinst", "py3compile -p python3-headpin"), ("prerm", "py3clean -p python3-headpin")):
            text = ""
            if name in scripts:
                with open(scripts[name], encoding="utf-8") as file:
                    text = file.read()
            expect(calls in text, f"{name} of python3-headpin does not call {calls}")
            expect(subprocess.run(["sh", "-n"], input=text, text=True).returncode == 0, f"{name} is no script")
    print("\n".join(failed) or "as it should be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
