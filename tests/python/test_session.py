"""headpin.Session: a session tick by tick, with the bits of the commands."""

import csv
import gc
import os
import pathlib
import shutil
import tempfile
import threading
import unittest

import headpin
import numpy as np
import support

SCENARIO = os.path.join(support.SOURCES, "assets/scenarios/uno-slater-1997.toml")


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def us(seconds):
    return round(float(seconds) * 1e6)


def samples_of(folder):
    """The samples of an exported trial."""
    trackers = [
        headpin.TrackerSample(
            int(r["station"]),
            us(r["device_time_s"]),
            [float(r[k]) for k in ("x_m", "y_m", "z_m")],
            [float(r[k]) for k in ("qw", "qx", "qy", "qz")],
            int(r["stylus"]),
            status=r["status"],
            sequence=int(r["sequence"]),
            host_time_us=us(r["host_time_s"]),
            session_time_us=us(r["session_time_s"]),
            sent_time_us=us(r["sent_time_s"]),
            position_estimated=r["position_estimated"] == "1",
            orientation_estimated=r["orientation_estimated"] == "1",
        )
        for r in rows(os.path.join(folder, "trackers.csv"))
    ]
    buttons = [
        headpin.MouseSample(
            us(r["device_time_s"]),
            r["left_thumb"] == "1",
            r["right_thumb"] == "1",
            r["trigger"] == "1",
            host_time_us=us(r["host_time_s"]),
            session_time_us=us(r["session_time_s"]),
        )
        for r in rows(os.path.join(folder, "buttons.csv"))
    ]
    return trackers + buttons


class OfATrial(unittest.TestCase):
    """A session that gets the samples of the bundled trial."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = cls.folder.name
        cls.trial = os.path.join(path, "trial.lcmlog")
        cls.summary = support.json_of("replay", support.DEMO, "-o", cls.trial)
        cls.tables = os.path.join(path, "tables")
        support.command("export", cls.trial, "-o", cls.tables)
        cls.scenario = support.command("info", support.DEMO, "--scenario")
        cls.samples = samples_of(cls.tables)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_has_the_hashes_events_bodies_and_summary_of_the_trial(self):
        session = headpin.Session(self.scenario)
        session.push(self.samples)
        session.step(self.summary["ticks"])
        self.assertEqual(session.tick, self.summary["ticks"])
        self.assertEqual(session.state_hash, self.summary["state_hash"])
        self.assertEqual(session.game_hash, self.summary["game_hash"])
        self.assertGreater(session.score["skittles_down"], 0)
        for key, value in session.score.items():
            self.assertEqual(value, self.summary[key], key)
        for key, value in session.summary.items():
            self.assertEqual(value, self.summary[key], key)

        events = [e for e in rows(os.path.join(self.tables, "events.csv")) if int(e["tick"]) > 0]
        events = [e for e in events if e["kind"] not in ("ledger", "game_hash")]  # of the file
        self.assertEqual(len(session.events), len(events))
        for found, expected in zip(session.events, events):
            self.assertEqual(";".join(found["bodies"]), expected["bodies"])
            for text in ("kind", "detail"):
                self.assertEqual(found[text], expected[text])
            for number in set(expected) - {"kind", "bodies", "detail"}:
                self.assertEqual(found[number], float(expected[number]), number)

        last = [
            s
            for s in rows(os.path.join(self.tables, "states.csv"))
            if int(s["tick"]) == session.tick
        ]
        self.assertEqual(session.names, [s["body"] for s in last])
        for column in session.bodies.dtype.names:
            found = session.bodies[column].astype(float).tolist()
            self.assertEqual(found, [float(s[column]) for s in last], column)

    def test_has_the_same_bits_when_samples_come_tick_by_tick(self):
        waiting = sorted(self.samples, key=lambda s: s.session_time_us)
        session = headpin.Session(self.scenario)
        ticks = self.summary["ticks"]
        rate = round(ticks / self.summary["simulated_s"])
        for tick in range(1, ticks + 1):
            while waiting and waiting[0].session_time_us <= tick * 1e6 / rate:
                session.push(waiting.pop(0))
            session.step()
        self.assertEqual(waiting, [])
        self.assertEqual(session.game_hash, self.summary["game_hash"])

    def test_takes_the_tables_of_a_trial(self):
        trial = headpin.Trial(support.DEMO)
        session = headpin.Session(trial.scenario)
        session.push(trial.samples)
        for row in trial.buttons:
            session.push(row)
        with self.assertRaisesRegex(ValueError, "count: expected 0 or more, found -3"):
            session.step(-3)
        session.step(self.summary["ticks"])
        self.assertEqual(session.game_hash, self.summary["game_hash"])

    def test_under_another_response_has_the_hash_of_that_replay(self):
        expected = support.json_of("replay", support.DEMO, "--response", "coulomb")
        session = headpin.Session(self.scenario, response="coulomb")
        session.push(self.samples)
        session.step(expected["ticks"])
        self.assertEqual(session.state_hash, expected["state_hash"])
        self.assertEqual(session.summary["response"], "coulomb")

    def test_with_a_response_of_ones_own_says_so_and_has_no_hash(self):
        calls = []

        def smooth(u, K, N, elasticity, friction):
            calls.append((elasticity, friction))
            return -(1.0 + elasticity) * u.dot(N) / N.dot(K @ N) * N

        session = headpin.Session(self.scenario, response=smooth)
        session.push(self.samples)
        session.step(self.summary["ticks"])
        self.assertGreater(len(calls), 10)
        self.assertIn((0.7 * 0.7, 0.7 * 0.7), calls)
        self.assertEqual(session.response, "custom")
        self.assertEqual(session.summary["response"], "custom")
        self.assertEqual((session.state_hash, session.game_hash), (None, None))
        self.assertIsNone(session.summary["state_hash"])
        self.assertGreater(session.score["skittles_down"], 0)

    def test_cannot_go_on_after_an_error_in_its_response(self):
        def fails(u, K, N, elasticity, friction):
            raise KeyError("rubber")

        session = headpin.Session(self.scenario, response=fails)
        session.push(self.samples)
        with self.assertRaisesRegex(KeyError, "rubber"):
            session.step(self.summary["ticks"])
        with self.assertRaisesRegex(RuntimeError, f"session: tick {session.tick + 1} was not"):
            session.step()


class OfAScenario(unittest.TestCase):
    def test_is_the_same_by_path_and_by_text(self):
        with open(SCENARIO, encoding="utf-8") as file:
            of_text = headpin.Session(file.read())
        of_path = headpin.Session(SCENARIO)
        self.assertEqual(of_text.state_hash, of_path.state_hash)
        self.assertEqual(of_text.names, of_path.names)
        self.assertIn("ball", of_path.names)

    def test_may_be_a_path_with_any_letter(self):
        of_path = headpin.Session(SCENARIO)
        for name in ("friction=0.1.toml", "fr=1", "two\nlines.toml", "caf\udce9.toml"):
            path = pathlib.Path(support.file(name))
            shutil.copy(SCENARIO, path)
            self.assertEqual(headpin.Session(path).state_hash, of_path.state_hash, ascii(name))
        self.assertEqual(headpin.Session(support.file("fr=1")).state_hash, of_path.state_hash)
        with self.assertRaisesRegex(FileNotFoundError, "ball.mass=6"):
            headpin.Session(pathlib.Path("ball.mass=6"))
        headpin.Session("ball.mass=6")  # a text

    def test_moves_the_solid_hand_with_its_samples(self):
        session = headpin.Session(SCENARIO)
        hand = session.names.index("hand")
        hidden = session.bodies[hand]["z_m"]
        session.push(headpin.TrackerSample(1, 0, [0, 0, 1.7], [1, 0, 0, 0]))
        session.push(headpin.TrackerSample(2, 0, [0.2, 0.3, 0.9], [1, 0, 0, 0]))
        session.step(24)
        self.assertLess(hidden, -1.0)
        self.assertGreater(session.bodies[hand]["z_m"], 0.0)

    def test_uses_a_late_sample_in_the_next_tick(self):
        early, late = headpin.Session(SCENARIO), headpin.Session(SCENARIO)
        hand = early.names.index("hand")
        sample = headpin.TrackerSample(2, 100_000, [0.2, 0.3, 0.9], [1, 0, 0, 0])
        early.push(sample)
        early.step(48)
        late.step(48)
        self.assertNotEqual(late.bodies[hand]["z_m"], early.bodies[hand]["z_m"])
        late.push(sample)
        late.step()
        self.assertGreater(late.bodies[hand]["z_m"], -1.0)

    def test_refuses_what_is_no_scenario_as_the_commands_do(self):
        with self.assertRaisesRegex(ValueError, "no scenario is called 'bowls'"):
            headpin.Session("bowls")
        with self.assertRaisesRegex(ValueError, "ball.mas"):
            headpin.Session("[ball]\nmas = 6\n")
        with self.assertRaisesRegex(FileNotFoundError, "there-is-none.toml"):
            headpin.Session("./there-is-none.toml")
        with self.assertRaisesRegex(ValueError, "paper"):
            headpin.Session(SCENARIO, response="rubber")
        with self.assertRaisesRegex(ValueError, "a name, a function or the address.*found True"):
            headpin.Session(SCENARIO, response=True)

    def test_refuses_samples_that_cannot_be(self):
        session = headpin.Session(SCENARIO)
        for wrong, words in (
            (
                lambda: headpin.TrackerSample(0, 0, [0, 0, 0], [1, 0, 0, 0]),
                "station: expected 1 or more",
            ),
            (
                lambda: headpin.TrackerSample(
                    1, 2_000_001, [0, 0, 0], [1, 0, 0, 0], sent_time_us=1_000_000
                ),
                "sent_time_us: expected at most 1 s from time_us",
            ),
            (lambda: headpin.TrackerSample(1, 0, [0, 0, np.nan], [1, 0, 0, 0]), "finite position"),
            (lambda: headpin.TrackerSample(1, 0, [0, 0, 0], [1, 1, 0, 0]), "unit quaternion"),
            (lambda: headpin.MouseSample(-(2**63)), "all times within the limits of a log"),
            (lambda: headpin.MouseSample(0, host_time_us=2**63 - 1), "all times within"),
            (lambda: headpin.MouseSample(0, session_time_us=4 * 10**15), "all times within"),
            (lambda: session.push("sample"), "expected a TrackerSample or a MouseSample"),
            (lambda: session.push(np.zeros(3)), "expected rows of the table"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                wrong()

    def test_refuses_tables_with_times_that_cannot_be(self):
        trial = headpin.Trial(support.DEMO)
        session = headpin.Session(trial.scenario)
        for table in (trial.samples, trial.buttons):
            for column in ("device_time_s", "host_time_s", "session_time_s"):
                for time in (np.nan, np.inf, -1e300, 5e9):
                    wrong = table.copy()
                    wrong[column][-1] = time
                    with self.assertRaisesRegex(ValueError, "within the limits of a log", msg=(column, time)):
                        session.push(wrong)
            session.push(table)  # nothing of the others was taken
        session.step(trial.replay().summary["ticks"])
        self.assertEqual(session.game_hash, trial.replay().game_hash)

    def test_refuses_tables_with_a_status_of_several_letters(self):
        trial = headpin.Trial(support.DEMO)
        session = headpin.Session(trial.scenario)
        for status in ("AB", "nan", " "):
            table = trial.samples.copy()
            table["status"][2] = status
            if len(status) == 1:
                session.push(table)
                continue
            words = f"^row 2: sample: status: expected one letter or none, found '{status}'"
            with self.assertRaisesRegex(ValueError, words):
                session.push(table)

    def test_refuses_tables_with_numbers_that_cannot_be_and_laws_of_sliding_that_are_none(self):
        scenario = headpin.Trial(support.DEMO).scenario
        session = headpin.Session(scenario)
        wrong = headpin.Trial(support.DEMO).samples.copy()
        wrong["station"][0] = 2**40
        with self.assertRaisesRegex(ValueError, f"sample: station: expected a whole number .*found {2**40}"):
            session.push(wrong)
        for words in ({}, {"response": "coulomb"}, {"response": lambda *_: [0, 0, 0]}):
            with self.assertRaisesRegex(ValueError, "^sliding: expected one of paper, coulomb, found 'honey'"):
                headpin.Session(scenario, sliding="honey", **words)

    def test_refuses_a_law_of_sliding_beside_a_law_that_has_its_own(self):
        scenario = headpin.Trial(support.DEMO).scenario
        for words in ({}, {"response": None}, {"response": "coulomb"}):
            with self.assertRaisesRegex(ValueError, "^sliding: expected a law of response of your own beside it, found"):
                headpin.Session(scenario, sliding="coulomb", **words)
        headpin.Session(scenario, sliding=None, response="coulomb")
        headpin.Session(scenario, sliding="coulomb", response=lambda *_: [0, 0, 0])


class TwoThreads(unittest.TestCase):
    def test_push_refuses_a_session_that_steps_since_its_samples_are_read(self):
        inside, go_on = threading.Event(), threading.Event()

        def waits(u, K, N, elasticity, friction):
            inside.set()
            go_on.wait(60)
            return -u.dot(N) / N.dot(K @ N) * N

        trial = headpin.Trial(support.DEMO)
        session = headpin.Session(trial.scenario, response=waits)
        session.push([trial.samples, trial.buttons])
        thread = threading.Thread(target=session.step, args=(1200,))

        class Rows:
            """Rows of a table; another thread is in a step when they have been read."""

            @property
            def dtype(self):
                if not inside.is_set():
                    thread.start()
                    inside.wait(60)
                return trial.samples.dtype

            def __array__(self):
                return trial.samples[:1]

        try:
            with self.assertRaisesRegex(RuntimeError, "is making a step in another call"):
                session.push(Rows())
        finally:
            go_on.set()
            thread.join()
        self.assertEqual(session.tick, 1200)

    def test_events_are_those_of_the_call_also_when_a_step_is_made_meanwhile(self):
        trial = headpin.Trial(support.DEMO)
        session = headpin.Session(trial.scenario)
        session.push([trial.samples, trial.buttons])
        session.step(1682)
        expected, stepped = session.events, []

        def step(phase, _):
            if phase == "start" and not stepped:
                stepped.append(True)
                session.step(1)

        usual = gc.get_threshold()
        self.addCleanup(gc.set_threshold, *usual)
        gc.set_threshold(20)  # the collector comes in the middle of the list
        gc.collect()
        gc.callbacks.append(step)
        try:
            found = session.events
        finally:
            gc.callbacks.remove(step)
        self.assertEqual(stepped, [True])
        self.assertEqual(found, expected)


if __name__ == "__main__":
    unittest.main()
