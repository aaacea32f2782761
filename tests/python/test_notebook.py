"""docs/notebook.ipynb runs, and its numbers are those of the commands."""

import os
import re
import unittest
from base64 import b64decode

import nbformat
import support
from nbclient import NotebookClient

FOLDER = os.path.join(support.SOURCES, "docs")


def outputs(cell, kind):
    return [o["data"][kind] for o in cell["outputs"] if kind in o.get("data", {})]


def rows_of(table):
    """The rows of a data frame that was written as HTML."""
    names = re.findall("<th>(.+?)</th>", table.split("<tbody>")[0])
    rows = re.findall("<tr>(.*?)</tr>", table.split("<tbody>")[1], re.DOTALL)
    return [dict(zip(names, re.findall("<td>(.*?)</td>", row))) for row in rows]


class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stored = nbformat.read(os.path.join(FOLDER, "notebook.ipynb"), as_version=4)
        cls.played = nbformat.from_dict(cls.stored)
        client = NotebookClient(cls.played, timeout=800, resources={"metadata": {"path": FOLDER}})
        client.execute()  # raises the error of a cell
        cls.code = [cell for cell in cls.played["cells"] if cell["cell_type"] == "code"]

    def test_replays_the_eight_conditions_as_the_command_does(self):
        (table,) = [t for cell in self.code for t in outputs(cell, "text/html") if "skittles_down" in t]
        rows = rows_of(table)
        self.assertEqual(len(rows), 8)
        for row in rows:
            words = [f"--{key}={row[key]}" for key in ("elasticity", "friction", "shape")]
            summary = support.json_of("replay", support.DEMO, *words)
            self.assertEqual(row["state_hash"], summary["state_hash"])
            self.assertEqual(float(row["skittles_down"]), summary["skittles_down"])

    def test_shows_speeds_both_eyes_and_a_map(self):
        pictures = [picture for cell in self.code for picture in outputs(cell, "image/png")]
        self.assertEqual(len(pictures), 3)
        for picture in pictures:
            self.assertTrue(b64decode(picture).startswith(b"\x89PNG"))

    def test_is_stored_with_what_it_shows(self):
        for stored, run in zip(self.stored["cells"], self.played["cells"]):
            if stored["cell_type"] != "code":
                continue
            self.assertEqual(len(outputs(stored, "image/png")), len(outputs(run, "image/png")))
            self.assertEqual(outputs(stored, "text/html"), outputs(run, "text/html"))
        size = os.path.getsize(os.path.join(FOLDER, "notebook.ipynb"))
        self.assertLess(size, 300_000)


if __name__ == "__main__":
    unittest.main()
