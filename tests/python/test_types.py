"""The stubs fit the module, and mypy accepts a program that uses them and refuses one that misuses them."""

import os
import pydoc
import subprocess
import sys
import unittest

import headpin
import support

RIGHT = """
import headpin
import numpy as np
import numpy.typing
trial = headpin.Trial("x.lcmlog")
height: float = float(trial.states["z_m"].max())
replay = trial.replay(friction=0.1, set={"ball.mass": 5.0})
own = trial.replay(response=lambda u, K, N, elasticity, friction: [0.0, 0.0, 1.0], sliding="coulomb")
hashes: list[str | None] = [replay.state_hash, replay.game_hash]
frame = trial.frames(250, depth=True)
pixels: np.typing.NDArray[np.uint8] = frame.image
both: list[headpin.Frame] = trial.frames(range(3), eye="both")
difference: str | None = trial.verify()
sample = headpin.TrackerSample(2, 30_000, [0, 0, 1], [1, 0, 0, 0], 1, status="", sequence=3, host_time_us=9_000,
                               session_time_us=0, sent_time_us=8_000, position_estimated=True,
                               orientation_estimated=False)
"""

WRONG = ['headpin.Trial(3)', 'headpin.Trial("x").replay(fricton=0)', 'headpin.Trial("x").frames(1, eye="middle")',
         'headpin.Trial("x").speed']


def mypy(code):
    path = support.file("program.py")
    with open(path, "w", encoding="utf-8") as file:
        file.write(code)
    search = dict(os.environ, MYPYPATH=os.environ["PYTHONPATH"])
    return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", support.file("mypy"), path],
                          capture_output=True, text=True, env=search)


class Types(unittest.TestCase):
    def test_fit_the_module(self):
        search = dict(os.environ, MYPYPATH=os.environ["PYTHONPATH"])
        passed_over = support.file("passed_over")
        with open(passed_over, "w", encoding="ascii") as file:
            file.write(r"headpin(\.\w+)*\.[A-Z]\w*(\.__init__)?" + "\n")  # pybind11's metaclass, and its *args
        said = subprocess.run([sys.executable, "-m", "mypy.stubtest", "headpin", "--allowlist", passed_over,
                               "--ignore-unused-allowlist"], capture_output=True, text=True,
                              cwd=support.folder(), env=search)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)

    def test_accept_a_program(self):
        said = mypy(RIGHT)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)

    def test_refuse_mistakes(self):
        said = mypy("import headpin\n" + "\n".join(WRONG) + "\n").stdout
        for line in range(2, 2 + len(WRONG)):
            self.assertIn(f"program.py:{line}: error:", said)


class Help(unittest.TestCase):
    def test_says_something_of_everything(self):
        for name in headpin.__all__:
            thing = getattr(headpin, name)
            self.assertEqual(getattr(thing, "__module__", "headpin"), "headpin", name)
            if not isinstance(thing, type):
                continue
            for part, value in vars(thing).items():
                if not part.startswith("_") and not isinstance(value, dict):
                    self.assertTrue(value.__doc__, f"{name}.{part}")
        self.assertIn("Trial.units", pydoc.plain(pydoc.render_doc(headpin.Trial)))


if __name__ == "__main__":
    unittest.main()
