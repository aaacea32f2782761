#!/usr/bin/env python3
"""Every library that the build looks for and every package of the page is in the list of parts, under a licence.

usage: parts_test.py SOURCES SPDX COPYRIGHT
"""

import json
import os
import re
import subprocess
import sys

LINKED = {"png", "zlib", "lcm", "osmesa", "egl", "deflate", "assimp", "qhull_r", "threads", "zstd", "microhttpd",
          "gnutls", "pkgconfig", "python3"}  # when it runs
OURS = {"eigen3": "eigen", "nlohmann_json": "nlohmann-json", "cli11": "cli11", "fmt": "fmt",
        "tomlplusplus": "tomlplusplus"}


def main():
    sources, spdx, copyright_file = sys.argv[1:]
    with open(spdx, encoding="utf-8") as file:
        document = json.load(file)
    parts = {package["name"]: package for package in document["packages"]}
    with open(copyright_file, encoding="utf-8") as file:
        legal = file.read()
    wanted, of_module = set(), set()
    for name in subprocess.run(["git", "-C", sources, "ls-files", "apps/CMakeLists.txt", "apps/python/CMakeLists.txt",
                                "scene/CMakeLists.txt", "devices/CMakeLists.txt", "render/CMakeLists.txt",
                                "CMakeLists.txt"],
                               check=True, capture_output=True, text=True).stdout.split():
        with open(f"{sources}/{name}", encoding="utf-8") as file:
            text = file.read()
        for found in re.findall(r"find_package\((\w+)", text) + re.findall(r"IMPORTED_TARGET ([\w+]+)", text):
            low = found.lower().removeprefix("lib")
            if low not in LINKED:
                wanted.add(OURS.get(low, low))
                if name != "apps/CMakeLists.txt":  # the Python module is built with the rest
                    of_module.add(OURS.get(low, low))
    scripts = subprocess.run(["git", "-C", sources, "ls-files", "apps/report/src/*.js"], check=True, capture_output=True,
                             text=True).stdout.split()
    for name in scripts:
        with open(f"{sources}/{name}", encoding="utf-8") as file:
            wanted.update(re.findall(r"from '(\w+)", file.read()))
    missing = [name for name in sorted(wanted) if name not in parts or f"parts of {name} " not in legal]
    for package in parts.values():
        if f"License: {package['licenseDeclared']}\n " not in legal:
            missing.append(f"text of {package['licenseDeclared']}")
    missing += [f"{name} in the Python package" for name in sorted(of_module & set(parts))
                if "Python package" not in parts[name]["comment"]]
    if "forms of CLI11" in legal:
        missing.append("a text of BSD-3-Clause that is of all its parts")
    related = {relation["relatedSpdxElement"] for relation in document["relationships"]}
    missing += [name for name, package in parts.items() if package["SPDXID"] not in related]
    page = f"{sources}/build/report/page.html"
    if os.path.exists(page):
        with open(page, encoding="utf-8") as file:
            notices = re.search(r"<!--\nIn this page:\n(.*?)-->", file.read(), re.DOTALL).group(1)
        for name, package in parts.items():
            places = package.get("comment", "").removeprefix("in: ").split(", ")
            if "page" in places or ("the page's engine" in places and "engine-wasm" in open(page, encoding="utf-8").read()):
                holders = package["copyrightText"]
                if f"\n{name}: {package['licenseDeclared']}, {holders}\n" not in notices:
                    missing.append(f"{name} in the page's notices")
    print(f"{len(parts)} parts; not in the lists: {missing or 'none'}")
    return 1 if missing or len(wanted) < 6 else 0


if __name__ == "__main__":
    sys.exit(main())
