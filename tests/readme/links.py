#!/usr/bin/env python3
"""Checks that the links of the documentation lead somewhere, and that README leads to every page.

usage: links.py FOLDER

- Every relative link of README.md, CHANGELOG.md, CONTRIBUTING.md, docs/ and the README.md of tests/
  names a file or a folder that is there, and an anchor that is a heading of that page.
- From README.md every page of docs/ is reached by two clicks; README.md has at most 150 lines.
- The map, docs/README.md, has every page of docs/.

FOLDER is that of the sources, or share/doc/headpin of an installation. There the pages have no link
into the sources (cmake/installed_page.cmake).
"""

import glob
import os
import re
import sys

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"#{1,6} +(.*?)\s*$")
README_MOST = 150


def lines_outside_code(text):
    """Lines of Markdown that are neither in a fenced block nor code between backquotes."""
    fenced = False
    for line in text.split("\n"):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield line


def anchor_of(heading):
    """The anchor of a heading, as GitHub and GitLab make it."""
    words = re.sub(r"[*`]|!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


class Page:
    def __init__(self, root, name):
        self.name = name
        with open(os.path.join(root, name), encoding="utf-8") as file:
            text = file.read()
        self.length = text.count("\n")
        self.anchors, self.links, seen = set(), [], {}
        for line in lines_outside_code(text):
            if heading := HEADING.match(line):
                anchor = anchor_of(heading[1])
                again = seen[anchor] = seen.get(anchor, -1) + 1
                self.anchors.add(f"{anchor}-{again}" if again else anchor)
            for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if not re.match(r"[a-z]+:", target):
                    self.links.append(target)


def resolved(page, target):
    """(path from the root, anchor) of a link."""
    path, _, anchor = target.partition("#")
    here = os.path.dirname(page.name)
    return os.path.normpath(os.path.join(here, path)) if path else page.name, anchor


def pages_in(root):
    patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**/*.md", "tests/**/README.md"]
    paths = [path for pattern in patterns
             for path in glob.glob(os.path.join(root, pattern), recursive=True)
             if "node_modules" not in path]  # other people's
    return {name: Page(root, name) for name in (os.path.relpath(path, root) for path in paths)}


def broken_links(root, pages):
    for page in pages.values():
        for target in page.links:
            path, anchor = resolved(page, target)
            if not os.path.exists(os.path.join(root, path)):
                yield f"{page.name}: {target}: {path} is not there"
            elif anchor and path in pages and anchor not in pages[path].anchors:
                yield f"{page.name}: {target}: {path} has no heading '{anchor}'"


def within_two_clicks(pages):
    reached = {"README.md"}
    for _ in range(2):
        reached |= {resolved(pages[name], target)[0]
                    for name in reached if name in pages for target in pages[name].links}
    return reached


def lost_pages(pages):
    reached = within_two_clicks(pages)
    listed = {resolved(pages["docs/README.md"], target)[0]
              for target in pages["docs/README.md"].links}
    for name in pages:
        if not name.startswith("docs/"):
            continue
        if name not in reached:
            yield f"{name}: more than two clicks from README.md"
        if name not in listed and name != "docs/README.md":
            yield f"{name}: docs/README.md does not list it"


def main():
    root = sys.argv[1]
    pages = pages_in(root)
    said = list(broken_links(root, pages)) + list(lost_pages(pages))
    if pages["README.md"].length > README_MOST:
        said.append(f"README.md: {pages['README.md'].length} lines, expected {README_MOST} at most")
    links = sum(len(page.links) for page in pages.values())
    print("\n".join(said + [f"{len(pages)} pages, {links} links"]))
    sys.exit(1 if said or len(pages) < 25 or links < 150 else 0)


main()
