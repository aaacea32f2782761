"""A replay from Python is that of the command, to the bit."""

import enum
import errno
import os
import signal
import subprocess
import sys
import threading
import tomllib
import unittest

import headpin
import numpy as np
import support

CONDITIONS = [
    ([], {}),
    (["--friction", "0", "--elasticity", "1"], {"friction": 0, "elasticity": 1}),
    (["--shape", "ellipsoid", "--response", "coulomb"], {"shape": "ellipsoid", "response": "coulomb"}),
    (["--detection", "paper", "--iterations", "7", "--warm"], {"detection": "paper", "iterations": 7, "warm": True}),
    (["--set", "ball.mass=5.5", "--set", "collision.shape=ellipsoid", "--set", "rack.spots=[[0,0],[0.2,0.3]]"],
     {"set": {"ball.mass": 5.5, "collision.shape": "ellipsoid", "rack.spots": [[0, 0], [0.2, 0.3]]}}),
    (["--set", "ball.home=[1.5,1.0,0.85]"], {"set": {"ball.home": [1.5, 1.0, 0.85]}}),  # out of reach: nothing falls
]


class Replay(unittest.TestCase):
    def test_has_the_results_of_the_command(self):
        trial = headpin.Trial(support.DEMO)
        hashes = set()
        for options, words in CONDITIONS:
            said = support.json_of("replay", support.DEMO, *options)
            replay = trial.replay(**words)
            self.assertEqual((replay.state_hash, replay.game_hash), (said["state_hash"], said["game_hash"]), options)
            different = {key for key in said if said[key] != replay.summary.get(key, said)}
            self.assertLessEqual(different, {"realtime_factor", "output", "set"}, options)
            self.assertEqual(replay.score, {key: said[key] for key in replay.score})
            self.assertEqual(len(replay.summary["set"]), len(said["set"]))
            hashes.add(replay.game_hash)
        self.assertEqual(len(hashes), len(CONDITIONS))

    def test_with_a_response_of_ones_own_is_the_session_with_it(self):
        def smooth(u, K, N, elasticity, friction):
            return -(1.0 + elasticity) * u.dot(N) / N.dot(K @ N) * N

        trial = headpin.Trial(support.DEMO)
        replay = trial.replay(response=smooth, sliding="coulomb", elasticity=0.9)
        trial.replay(elasticity=0.9).save(support.file("elastic.lcmlog"))
        scenario = headpin.Trial(support.file("elastic.lcmlog")).scenario
        session = headpin.Session(scenario, response=smooth, sliding="coulomb")
        session.push(trial.samples)
        session.push(trial.buttons)
        session.step(trial.replay().summary["ticks"])
        last = replay.states[-len(session.names):]
        for column in ("x_m", "y_m", "z_m", "qw", "vx_mps", "wz_radps"):
            self.assertEqual(last[column].tolist(), session.bodies[column].tolist())
        self.assertEqual(replay.score, session.score)
        self.assertNotEqual(last["x_m"].tolist(), trial.replay(elasticity=0.9).states[-len(last):]["x_m"].tolist())
        self.assertEqual((replay.summary["response"], replay.state_hash, replay.game_hash), ("custom", None, None))
        self.assertIn("response of one's own", repr(replay))
        with self.assertRaisesRegex(ValueError, "^save: nobody could replay"):
            replay.save(support.file("own.lcmlog"))

    def test_refuses_what_would_have_no_effect_or_another_one(self):
        trial = headpin.Trial(support.DEMO)
        for words in ({}, {"response": "paper"}, {"response": None}):
            with self.assertRaisesRegex(ValueError, "^sliding: expected a law of response of your own"):
                trial.replay(sliding="coulomb", **words)
        self.assertEqual(trial.replay(sliding=None).game_hash, trial.replay().game_hash)
        with self.assertRaisesRegex(TypeError, "^friction: expected a number, found True"):
            trial.replay(friction=True)
        with self.assertRaisesRegex(TypeError, "^iterations: expected a whole number, found False"):
            trial.replay(iterations=False)

    def test_says_what_goes_wrong_in_a_response_of_ones_own(self):
        trial = headpin.Trial(support.DEMO)

        def fails(u, K, N, elasticity, friction):
            raise KeyError("rubber")

        def asks(u, K, N, elasticity, friction):
            return len(trial.samples) * N

        with self.assertRaisesRegex(KeyError, "rubber"):
            trial.replay(response=fails)
        with self.assertRaisesRegex(RuntimeError, "is replayed by this thread"):
            trial.replay(response=asks)
        with self.assertRaisesRegex(ValueError, "expected a name, a function"):
            trial.replay(response=1.5)
        with self.assertRaisesRegex(ValueError, "expected a name, a function.*found True"):
            trial.replay(response=True)
        with self.assertRaisesRegex(ValueError, "honey"):
            trial.replay(response=fails, sliding="honey")
        self.assertEqual(len(trial.samples), 841)

    def test_says_why_nothing_fell(self):
        far = headpin.Trial(support.DEMO).replay(set={"ball.home": [1.5, 1.0, 0.85]})
        self.assertIn("too far to take it", far.summary["why_nothing_fell"])
        self.assertNotIn("why_nothing_fell", headpin.Trial(support.DEMO).replay().summary)

    def test_takes_texts_with_any_letter(self):
        name = "caf\u00e9 \U0001f600 \x7f \t \" \\"
        path = support.file("any_letter.lcmlog")
        headpin.Trial(support.DEMO).replay(set={"name": name}).save(path)
        self.assertEqual(tomllib.loads(headpin.Trial(path).scenario)["name"], name)
        with self.assertRaisesRegex(ValueError, "name=.*surrogates"):
            headpin.Trial(support.DEMO).replay(set={"name": "\ud83d"})  # half a letter

    def test_is_saved_as_the_command_saves_it(self):
        paths = [support.file("by_command.lcmlog"), support.file("by_python.lcmlog")]
        support.command("replay", support.DEMO, "--friction", "0.1", "-o", paths[0])
        replay = headpin.Trial(support.DEMO).replay(friction=0.1)
        replay.save(paths[1])
        with open(paths[0], "rb") as a, open(paths[1], "rb") as b:
            self.assertTrue(a.read() == b.read())
        saved = headpin.Trial(paths[1])
        self.assertTrue((replay.states == saved.states).all())
        self.assertTrue((replay.throws["speed_mps"] == saved.throws["speed_mps"]).all())
        own = [event for event in saved.events.tolist() if event[2] not in ("ledger", "game_hash")]
        self.assertEqual(own, replay.events.tolist())
        self.assertIsNone(saved.verify())

    def test_overwrites_nothing_unasked(self):
        path = support.file("there.lcmlog")
        with open(path, "w", encoding="ascii") as file:
            file.write("mine")
        replay = headpin.Trial(support.DEMO).replay()
        with self.assertRaisesRegex(FileExistsError, "there.lcmlog.*overwrite=True") as raised:
            replay.save(path)
        self.assertEqual(raised.exception.errno, errno.EEXIST)
        with open(path, encoding="ascii") as file:
            self.assertEqual(file.read(), "mine")
        replay.save(path, overwrite=True)
        self.assertIsNone(headpin.Trial(path).verify())

    def test_has_no_name_of_another_kind_of_file(self):
        replay = headpin.Trial(support.DEMO).replay()
        for name in ("own.csv", "own.xlsx", "own.LCMLOG"):
            path = support.file(name)
            with self.assertRaisesRegex(ValueError, f"^path: expected a name that ends in .lcmlog, found .*{name}$"):
                replay.save(path)
            self.assertFalse(os.path.exists(path))

    def test_says_when_nothing_can_be_written(self):
        replay = headpin.Trial(support.DEMO).replay()
        with self.assertRaises(OSError):
            replay.save("/dev/full", overwrite=True)
        with self.assertRaisesRegex(OSError, "absent"):
            replay.save(support.file("absent/x.lcmlog"))

    def test_refuses_what_the_command_refuses(self):
        trial = headpin.Trial(support.DEMO)
        for words in ({"friction": 2}, {"friction": float("nan")}, {"shape": "round"}, {"response": "none"},
                      {"iterations": 4}, {"set": {"ball.mas": 5}}, {"set": {"ball.mass": "much"}}):
            with self.assertRaises(ValueError, msg=words):
                trial.replay(**words)
        for words, said in (({"friction": "0.5"}, "friction: expected a number, found '0.5'"),
                            ({"elasticity": [1]}, "elasticity: expected a number, found "),
                            ({"iterations": 5.5}, "iterations: expected a whole number, found 5.5"),
                            ({"set": "ball.mass=5"}, "set: expected a dict, found ")):
            with self.assertRaisesRegex(TypeError, said):
                trial.replay(**words)
        with self.assertRaisesRegex(TypeError, "fricton"):
            trial.replay(fricton=0)
        said = subprocess.run([support.PROGRAM, "replay", support.DEMO, "--set", "ball.mass=-1"], capture_output=True,
                              text=True).stderr
        with self.assertRaises(ValueError) as raised:
            trial.replay(set={"ball.mass": -1})
        self.assertIn(str(raised.exception), said)


class Verify(unittest.TestCase):
    def test_finds_no_difference_in_a_replay(self):
        self.assertIsNone(headpin.Trial(support.simulated()).verify())

    def test_says_the_first_difference_as_the_command(self):
        path = support.file("nudged.lcmlog")
        support.command("replay", support.DEMO, "--states", "all", "-o", path)
        with open(path, "r+b") as file:
            all = bytearray(file.read())
            data = all.find(b"STATE", len(all) // 2) + len("STATE")
            all[data + 47] ^= 1  # the last bit of the first body's first coordinate (state_t.lcm)
            file.seek(0)
            file.write(all)
        said = subprocess.run([support.PROGRAM, "replay", path, "--verify"], capture_output=True, text=True)
        self.assertEqual(said.returncode, 1)
        difference = headpin.Trial(path).verify()
        self.assertIn(difference, said.stderr)
        self.assertIn("tick", difference)

    def test_needs_states(self):
        with self.assertRaisesRegex(RuntimeError, "holds no states to compare with"):
            headpin.Trial(support.DEMO).verify()


class Interrupts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.long = support.file("long.lcmlog")
        support.command("synthesize", "--duration", "600", "-o", cls.long)

    def test_stop_a_long_replay(self):
        code = ("import headpin, sys\n"
                "t = headpin.Trial(sys.argv[1])\n"
                "try:\n"
                "    print('begins', flush=True)\n"
                "    while True: t.replay()\n"
                "except KeyboardInterrupt:\n"
                "    print('stopped')\n"
                "    print(len(t.samples) > 0)\n")
        child = subprocess.Popen([sys.executable, "-c", code, self.long], stdout=subprocess.PIPE, text=True)
        with child:
            self.assertEqual(child.stdout.readline(), "begins\n")
            child.send_signal(signal.SIGINT)
            said, _ = child.communicate()
        self.assertEqual(said, "stopped\nTrue\n")

    def test_are_looked_for_while_it_simulates(self):
        """Without that, signals that come during a call are handled once, after it."""
        handled = []
        self.addCleanup(signal.signal, signal.SIGALRM, signal.signal(signal.SIGALRM, lambda *_: handled.append(True)))
        self.addCleanup(signal.setitimer, signal.ITIMER_REAL, 0)
        trial = headpin.Trial(self.long)
        most = 0
        signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
        for _ in range(20):
            handled.clear()
            trial.replay()
            most = max(most, len(handled))
            if most > 2:
                break
        self.assertGreater(most, 2)


class Threads(unittest.TestCase):
    def test_go_on_while_one_simulates(self):
        """Python never takes the lock from a thread here: another one runs only where a call gives it away."""
        usual = sys.getswitchinterval()
        self.addCleanup(sys.setswitchinterval, usual)
        sys.setswitchinterval(1000)
        trial = headpin.Trial(support.DEMO)
        began, others_ran, ended = threading.Event(), [], []

        def simulate():
            began.set()
            for _ in range(100):
                if not others_ran:
                    trial.replay()
            ended.append(True)

        thread = threading.Thread(target=simulate)
        thread.start()
        began.wait()
        if not ended:
            others_ran.append(True)
        thread.join()
        self.assertEqual(others_ran, [True])


class Values(unittest.TestCase):
    """Values of `set` that Python was ended by, or that had other words than their number."""

    def test_that_hold_themselves_or_have_no_other_form_are_refused(self):
        trial = headpin.Trial(support.DEMO)
        endless = []
        endless.append(endless)
        with self.assertRaises(RecursionError):
            trial.replay(set={"ball.home": endless})
        for value in (np.longdouble(5), [np.longdouble(5)], np.array([5], dtype=np.longdouble)):
            with self.assertRaisesRegex(TypeError, "expected a number, bool, text, list or dict, found .*numpy"):
                trial.replay(set={"ball.mass": value})

    def test_of_an_enum_are_its_numbers(self):
        mass = enum.IntEnum("Mass", {"HEAVY": 5})
        trial = headpin.Trial(support.DEMO)
        heavy, five = (trial.replay(set={"ball.mass": value}) for value in (mass.HEAVY, 5))
        self.assertEqual(heavy.game_hash, five.game_hash)
        result = headpin.replay_many(trial, {"ball.mass": [mass.HEAVY, 5]})
        self.assertEqual(list(result["error"]), ["", ""])
        self.assertEqual(*result["state_hash"])


if __name__ == "__main__":
    unittest.main()
