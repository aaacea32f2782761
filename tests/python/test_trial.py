"""A trial in Python is that of the commands: every number, every word, whatever happens to the file."""

import csv
import errno
import gc
import os
import shutil
import struct
import subprocess
import threading
import unittest
import warnings

import headpin
import numpy as np
import support

TABLES = {"samples": "trackers", "buttons": "buttons", "events": "events", "throws": "throws",
          "states": "states", "frames_table": "frames"}


def bits(number):
    return struct.pack("<d", number)


def from_csv(text, column):
    """A field of the CSV as the array has it."""
    if column.dtype == object:
        return text
    if column.dtype == np.float64:
        return bits(float(text)) if text else bits(np.nan)
    if column.dtype == np.uint64:
        return int(text, 16)
    return int(text) if text else -1


def from_array(value, column):
    if column.dtype == object:
        return value
    return bits(value) if column.dtype == np.float64 else int(value)


class Tables(unittest.TestCase):
    def compare(self, path):
        folder = path + ".tables"
        support.command("export", path, "-o", folder)
        trial = headpin.Trial(path)
        rows = 0
        for name, table in TABLES.items():
            array = getattr(trial, name)
            with open(os.path.join(folder, table + ".csv"), newline="", encoding="utf-8") as file:
                names, *lines = csv.reader(file)
            self.assertEqual(tuple(names), array.dtype.names)
            self.assertEqual(len(lines), len(array))
            for i, column in enumerate(names):
                expected = [from_csv(line[i], array[column]) for line in lines]
                found = [from_array(value, array[column]) for value in array[column]]
                self.assertEqual(expected, found, f"{name}: {column}")
            rows += len(array)
        return rows

    def test_are_those_of_the_export_to_the_last_bit(self):
        self.assertGreater(self.compare(support.simulated()), 20000)

    def test_are_so_with_buttons_and_games(self):
        samples, path = support.file("participant.lcmlog"), support.file("game.lcmlog")
        support.command("synthesize", "--participant", "7", "--throws", "1", "-o", samples)
        support.command("replay", samples, "-o", path)
        self.compare(path)
        trial = headpin.Trial(path)
        self.assertGreater(len(trial.buttons), 0)
        self.assertGreater(len(trial.throws), 0)

    def test_are_so_with_recorded_frames(self):
        path = support.file("shown.lcmlog")
        support.command("live", support.DEMO, "--look", "1997", "--eyes", "none", "--duration", "1", "--record", path)
        self.compare(path)
        self.assertGreater(len(headpin.Trial(path).frames_table), 0)

    def test_have_the_units_and_meanings_of_the_documentation(self):
        units = headpin.Trial.units
        self.assertEqual(units["states"]["vx_mps"], "m/s")
        self.assertEqual(units["samples"]["qw"], "")
        for name, columns in units.items():
            array = getattr(headpin.Trial(support.DEMO), name)
            self.assertEqual(tuple(columns), array.dtype.names)
            self.assertTrue(all(headpin.Trial.meanings[name].values()))

    def test_are_read_once_and_cannot_be_written(self):
        trial = headpin.Trial(support.DEMO)
        self.assertIs(trial.samples, trial.samples)
        with self.assertRaises(ValueError):
            trial.samples["x_m"][0] = 1.0
        with self.assertRaises(ValueError):
            trial.samples["x_m"].flags.writeable = True

    def test_stay_when_the_trial_and_other_views_are_gone(self):
        trial = headpin.Trial(support.simulated())
        expected = headpin.Trial(support.simulated()).states.copy()
        states = trial.states
        del trial
        gc.collect()
        self.assertTrue((states == expected).all())
        speeds, names = states["vy_mps"], states["body"]
        del states
        gc.collect()
        np.testing.assert_array_equal(speeds, expected["vy_mps"])
        self.assertEqual(list(names), list(expected["body"]))

    def test_go_to_pandas(self):
        trial = headpin.Trial(support.simulated())
        frame = trial.to_pandas("states")
        self.assertEqual(len(frame), len(trial.states))
        np.testing.assert_array_equal(frame["x_m"].to_numpy(), trial.states["x_m"])
        self.assertEqual(list(trial.to_pandas()), list(TABLES))
        with self.assertRaisesRegex(ValueError, "no table 'speeds'; expected one of samples, "):
            trial.to_pandas("speeds")


class Gaps(unittest.TestCase):
    def test_a_limit_that_the_commands_refuse_is_no_fault_of_the_trial(self):
        for limit in (np.inf, np.nan, -1.0, 0.0, 1e7):
            with self.assertRaisesRegex(ValueError, "longest_gap: expected 0.001 to 1000000 s"):
                headpin.Trial(support.simulated(), longest_gap=limit)


class Header(unittest.TestCase):
    def test_is_that_of_info(self):
        said = support.json_of("info", support.simulated())
        trial = headpin.Trial(support.simulated())
        self.assertEqual(said, trial.summary)
        self.assertEqual((said["participant"], said["condition"], said["seed"], said["version"]),
                         (trial.participant, trial.condition, trial.seed, trial.version))
        self.assertEqual(support.command("info", support.simulated(), "--scenario"), trial.scenario)
        self.assertTrue(trial.complete)
        self.assertEqual(trial.warnings, [])


class DamagedTrials(unittest.TestCase):
    def test_say_so_in_the_words_of_the_commands(self):
        path = support.damaged("cut.lcmlog", lambda all: all[:len(all) * 2 // 3])
        with self.assertWarnsRegex(UserWarning, "cut.lcmlog: is incomplete: it ends at "):
            trial = headpin.Trial(path)
        self.assertFalse(trial.complete)
        said = subprocess.run([support.PROGRAM, "replay", path], check=True, capture_output=True, text=True).stderr
        self.assertEqual(said, f"headpin replay: {path}: {trial.warnings[0]}; see `headpin info`\n")

    def test_have_the_rows_that_can_be_read(self):
        def spoil(all):
            for at in range(20000, len(all), 30011):
                all[at:at + 8] = bytes(8)
            return all

        path = support.damaged("spoilt.lcmlog", spoil)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            trial = headpin.Trial(path)
            self.assertGreater(sum(len(getattr(trial, name)) for name in TABLES), 100)
            Tables.compare(self, path)

    def test_that_hold_no_trial_are_refused(self):
        for name, bytes_ in {"empty": b"", "text": b"no trial\n" * 100}.items():
            path = support.file(name + ".lcmlog")
            with open(path, "wb") as file:
                file.write(bytes_)
            with self.assertRaisesRegex(headpin.DamagedTrial, name + ".lcmlog"):
                headpin.Trial(path)
        with self.assertRaises(headpin.DamagedTrial):
            headpin.Trial(support.folder())

    def test_that_are_not_there_are_not_found(self):
        said = subprocess.run([support.PROGRAM, "replay", "absent.lcmlog"], capture_output=True, text=True).stderr
        with self.assertRaises(FileNotFoundError) as raised:
            headpin.Trial("absent.lcmlog")
        self.assertIn(str(raised.exception), said)
        self.assertEqual(raised.exception.errno, errno.ENOENT)


class Files(unittest.TestCase):
    def test_may_be_deleted_while_they_are_open(self):
        path = support.file("deleted.lcmlog")
        shutil.copy(support.simulated(), path)
        trial = headpin.Trial(path)
        os.remove(path)
        self.assertEqual(len(trial.states), len(headpin.Trial(support.simulated()).states))
        self.assertIsNone(trial.verify())

    def test_are_those_that_were_opened_also_from_another_folder(self):
        self.addCleanup(os.chdir, os.getcwd())
        folders = [support.file("here"), support.file("there")]
        for folder, friction in zip(folders, ("0.1", "0.9")):
            os.mkdir(folder)
            support.command("replay", support.DEMO, "--friction", friction, "-o", os.path.join(folder, "t.lcmlog"))
        os.chdir(folders[0])
        with open("t.lcmlog", "rb") as file:
            recording = file.read()
        trial = headpin.Trial("t.lcmlog")
        replay = trial.replay()
        expected = headpin.replay_many(trial, {}, progress=False)
        os.chdir(folders[1])
        found = headpin.replay_many([trial], {}, progress=False)
        for name in expected.dtype.names:
            np.testing.assert_array_equal(found[name], expected[name], name)
        self.assertEqual(found["trial"].tolist(), ["t"])
        self.assertEqual(found["state_hash"].tolist(), [replay.state_hash])
        self.assertEqual(trial.path, "t.lcmlog")
        with self.assertRaisesRegex(OSError, "is an input of this command"):
            replay.save("../here/t.lcmlog", overwrite=True)
        with open("../here/t.lcmlog", "rb") as file:
            self.assertTrue(file.read() == recording)
        replay.save("t.lcmlog", overwrite=True)  # another file
        self.assertEqual(headpin.Trial("t.lcmlog").replay().state_hash, replay.state_hash)

    def test_that_shrink_while_they_are_open_are_an_error(self):
        path = support.file("shrunk.lcmlog")
        support.command("replay", support.DEMO, "--states", "all", "-o", path)  # some megabytes
        trial = headpin.Trial(path)
        os.truncate(path, os.path.getsize(path) // 2)
        with self.assertRaisesRegex(RuntimeError, "shrunk.lcmlog"):
            len(trial.states)

    def test_may_be_read_by_several_threads_at_once(self):
        trial = headpin.Trial(support.simulated())
        expected = headpin.Trial(support.simulated())
        found = []

        def read():
            found.append((len(trial.states), trial.replay(friction=0.2).game_hash, len(trial.samples)))

        threads = [threading.Thread(target=read) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        right = (len(expected.states), expected.replay(friction=0.2).game_hash, len(expected.samples))
        self.assertEqual(found, [right] * 4)

    def test_that_are_dropped_leave_no_memory(self):
        def resident():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

        def use(times):
            for _ in range(times):
                trial = headpin.Trial(support.DEMO)
                self.assertGreater(len(trial.samples) + len(trial.events), 0)

        times = int(os.environ.get("HEADPIN_TRIALS", 300))
        use(50)
        gc.collect()
        before = resident()
        use(times)
        gc.collect()
        size = headpin.Trial(support.DEMO).samples.nbytes
        self.assertLess(resident() - before, times * size // 10)


if __name__ == "__main__":
    unittest.main()
