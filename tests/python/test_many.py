"""headpin.replay_many: many replays, with the bits of `headpin sweep`."""

import csv
import io
import os
import pathlib
import pty
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
from contextlib import redirect_stderr

import headpin
import numpy as np
import pandas
import support

DESIGN = """trials = ['a.lcmlog', 'b.lcmlog']
[grid]
friction = [0, 0.3, 0.9]
shape = ['true', 'ellipsoid']
[random]
draws = 2
ball.mass = {from = 5, to = 7}
"""
KEYS = ("friction", "shape", "ball.mass")


def cell(text):
    return float(text) if text else np.nan


class Sweep(unittest.TestCase):
    """The same rows as a sweep of the program."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = pathlib.Path(cls.folder.name)
        cls.trials = [path / "a.lcmlog", path / "b.lcmlog"]
        for trial, elasticity in zip(cls.trials, (0.7, 0.9)):
            support.command("replay", support.DEMO, "--elasticity", elasticity, "-o", trial)
        (path / "sweep.toml").write_text(DESIGN)
        support.command("sweep", "plan", path / "sweep.toml", "-o", path / "sweep")
        support.command("sweep", "run", path / "sweep")
        support.command("sweep", "merge", path / "sweep", "-o", path / "all.csv")
        with open(path / "all.csv", newline="", encoding="utf-8") as file:
            cls.rows = list(csv.DictReader(file))
        cls.table = [
            {
                "friction": float(row["friction"]),
                "shape": row["shape"],
                "ball.mass": float(row["ball.mass"]),
            }
            for row in cls.rows[::2]  # both trials of a condition follow each other
        ]
        cls.result = headpin.replay_many(cls.trials, cls.table)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_has_its_columns_to_the_last_bit(self):
        self.assertEqual(len(self.result), 24)
        self.assertEqual(list(self.result.dtype.names), [c for c in self.rows[0] if c != "key"])
        for column in self.result.dtype.names:
            found = self.result[column].tolist()
            expected = [row[column] for row in self.rows]
            if column not in ("trial", "shape", "state_hash", "error"):
                np.testing.assert_array_equal(found, [cell(text) for text in expected], column)
            else:
                self.assertEqual(found, expected, column)
        self.assertGreater(len(set(self.result["state_hash"].tolist())), 12)

    def test_is_the_same_for_any_number_of_threads_and_kind_of_table(self):
        some = self.table[:3]
        expected = self.result[:6]
        frame = pandas.DataFrame(some)
        for threads, table in (
            (1, some),
            (3, {key: [row[key] for row in some] for key in KEYS}),
            (2, frame),
            (7, frame.to_records(index=False)),
        ):
            found = headpin.replay_many([str(t) for t in self.trials], table, threads=threads)
            for column in expected.dtype.names:
                self.assertEqual(str(found[column].tolist()), str(expected[column].tolist()))


class Replays(unittest.TestCase):
    def test_a_condition_is_that_of_the_command(self):
        once = headpin.replay_many(support.DEMO, {"friction": 0.2, "response": "coulomb"})
        summary = support.json_of("replay", support.DEMO, "--friction", 0.2, "--response", "coulomb")
        self.assertEqual(once["state_hash"].tolist(), [summary["state_hash"]])
        self.assertEqual(once["skittles_down"].tolist(), [summary["skittles_down"]])
        self.assertEqual(once["release_speed_mps"].tolist(), [summary["release_speed_mps"]])

    def test_values_may_be_lists_texts_and_truth_values(self):
        table = [{"collision.shape": "ellipsoid", "collision.sleep": False, "ball.home": [0.3, 0.1, 0.9]}]
        once = headpin.replay_many(support.DEMO, table)
        self.assertEqual(once["error"].tolist(), [""])
        words = ["--shape", "ellipsoid", "--set", "collision.sleep=false", "--set", "ball.home=[0.3,0.1,0.9]"]
        summary = support.json_of("replay", support.DEMO, *words)
        self.assertEqual(once["state_hash"].tolist(), [summary["state_hash"]])

    def test_texts_may_have_any_letter(self):
        names = ["\U0001f600", "\x7f", 'caf\u00e9 " \\']
        found = headpin.replay_many(support.DEMO, {"name": names})
        self.assertEqual(found["error"].tolist(), [""] * 3)
        self.assertEqual(found["name"].tolist(), names)
        half = headpin.replay_many(support.DEMO, {"name": ["\ud83d"]})
        self.assertIn("surrogates", half["error"][0])

    def test_a_replay_that_fails_has_its_reason_and_no_numbers(self):
        table = {"ball.mass": [6.0, -1.0]}
        good, bad = headpin.replay_many(support.DEMO, table)
        self.assertEqual(good["error"], "")
        self.assertIn("ball.mass", bad["error"])
        self.assertTrue(np.isnan(bad["skittles_down"]))
        self.assertEqual(bad["state_hash"], "")

    def test_each_item_of_the_list_has_its_rows(self):
        found = headpin.replay_many([support.DEMO, support.DEMO], {"friction": [0.1, 0.6]})
        self.assertEqual(found["friction"].tolist(), [0.1, 0.1, 0.6, 0.6])
        hashes = found["state_hash"].tolist()
        self.assertEqual(hashes[0::2], hashes[1::2])
        self.assertNotEqual(hashes[0], hashes[2])

    def test_no_trial_has_the_columns_of_one(self):
        none, one = (headpin.replay_many(trials, {"friction": [0.2]}) for trials in ([], support.DEMO))
        self.assertEqual(len(none), 0)
        for name in one.dtype.names:
            self.assertEqual(none.dtype[name].kind, one.dtype[name].kind, name)

    def test_refuses_what_is_no_table(self):
        for table, words in (
            ({"frictoin": [0.1]}, "'frictoin' is no key"),
            ({"friction": [0, 1], "elasticity": [0]}, "columns of one length, found friction 2, elasticity 1"),
            ([{"friction": 1}, {"elasticity": 1}], "row 1: expected the keys friction, found elasticity"),
            ({"friction": [None]}, "expected numbers, texts"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                headpin.replay_many(support.DEMO, table)
        with self.assertRaisesRegex(ValueError, "threads: expected 0 to 1024, found -1"):
            headpin.replay_many(support.DEMO, {"friction": 0}, threads=-1)
        with self.assertRaisesRegex(FileNotFoundError, "there-is-none.lcmlog"):
            headpin.replay_many("./there-is-none.lcmlog", {"friction": 0})

    def limited(self, stack, memory):
        """What replays say whose threads have stacks of `stack` GiB in `memory` GiB of addresses."""
        script = (
            "import os, headpin\n"
            "try:\n"
            "    r = headpin.replay_many([os.environ['TRIAL']] * 4, {'friction': [.1, .2]}, 8, False)\n"
            "    print(set(r['error'].tolist()), len(set(r['state_hash'].tolist())))\n"
            "except RuntimeError as error:\n"
            "    print(error)\n"
        )

        def limit():
            resource.setrlimit(resource.RLIMIT_STACK, (int(stack * 2**30), resource.RLIM_INFINITY))
            resource.setrlimit(resource.RLIMIT_AS, (memory * 2**30,) * 2)

        environment = {**os.environ, "TRIAL": support.DEMO, "OPENBLAS_NUM_THREADS": "1"}
        child = subprocess.run(
            [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=environment, preexec_fn=limit
        )
        self.assertEqual(child.returncode, 0)
        return child.stdout

    def test_go_on_with_those_threads_that_can_be_made(self):
        self.assertEqual(self.limited(1.5, 4), "{''} 2\n")
        self.assertRegex(self.limited(6, 4), "^threads: none could be made")

    def test_tells_its_progress_to_a_function_and_stops_at_its_errors(self):
        class Enough(Exception):
            pass

        told = []

        def stop(done, total):
            told.append((done, total))
            raise Enough

        with self.assertRaises(Enough):
            headpin.replay_many(support.DEMO, {"friction": np.linspace(0, 1, 100_000)}, progress=stop)
        self.assertEqual(len(told), 1)
        self.assertEqual(told[0][1], 100_000)

    def test_prints_nothing_where_no_terminal_is(self):
        said = io.StringIO()
        with redirect_stderr(said):
            headpin.replay_many(support.DEMO, {"friction": np.linspace(0, 1, 30)})
        self.assertEqual(said.getvalue(), "")

    def test_shows_a_line_on_a_terminal_and_erases_it(self):
        script = (
            "import headpin, os\n"
            "headpin.replay_many(os.environ['TRIAL'], {'friction': [0.5] * 100})\n"
        )
        near, far = pty.openpty()
        environment = {**os.environ, "TRIAL": support.DEMO}
        child = subprocess.Popen([sys.executable, "-c", script], stderr=far, env=environment)
        os.close(far)
        self.assertEqual(child.wait(), 0)
        with open(near, "rb", buffering=0) as terminal:
            said = terminal.read(4096).decode()
        self.assertRegex(said, r"^\r\d+ of 100 replays")
        self.assertRegex(said, r"\r *\r$")

    def test_stops_at_ctrl_c(self):
        script = (
            "import headpin, os\n"
            "try:\n"
            "    print('replays', flush=True)\n"
            "    headpin.replay_many(os.environ['TRIAL'], {'friction': [0.5] * 1_000_000})\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped')\n"
        )
        environment = {**os.environ, "TRIAL": support.DEMO}
        child = subprocess.Popen(
            [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=environment
        )
        self.assertEqual(child.stdout.readline(), "replays\n")
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.communicate()[0], "stopped\n")


class Tables(unittest.TestCase):
    def test_a_masked_value_is_no_number(self):
        friction = np.ma.array([0.1, 0.2], mask=[False, True])
        for table in ({"friction": friction}, {"ball.home": np.ma.array([[1.5, 1, 0.85]], mask=[[0, 1, 0]])}):
            with self.assertRaisesRegex(ValueError, "found a masked value"):
                headpin.replay_many(support.DEMO, table)
        result = headpin.replay_many(support.DEMO, {"friction": friction[:1]})
        self.assertEqual((list(result["friction"]), list(result["error"])), ([0.1], [""]))

    def test_an_array_without_an_axis_stands_for_all_rows(self):
        expected = headpin.replay_many(support.DEMO, {"friction": [0.5], "shape": "true"})
        for table in (
            {"friction": np.array(0.5), "shape": "true"},
            np.array((0.5, "true"), dtype=[("friction", "f8"), ("shape", "U9")]),
        ):
            result = headpin.replay_many(support.DEMO, table)
            self.assertEqual(result["friction"].dtype, np.float64)
            self.assertEqual(list(result["state_hash"]), list(expected["state_hash"]))

    def test_of_another_kind_are_refused_by_their_row_or_key(self):
        for table, words in (
            ("friction", "row 0: expected a dict of keys and values, found 'f'"),
            ([{"friction": 0.5}, 0.7], "row 1: expected a dict of keys and values, found 0.7"),
            ({3: [0.5]}, "expected texts as keys, found 3"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                headpin.replay_many(support.DEMO, table)

    def test_a_trial_may_be_named_in_bytes(self):
        result = headpin.replay_many(os.fsencode(support.DEMO), {"friction": [0.5]})
        self.assertEqual((list(result["trial"]), list(result["error"])), (["demo"], [""]))


if __name__ == "__main__":
    unittest.main()
