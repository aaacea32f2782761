"""Frames from Python are those of the command, to the bit; cameras are those of --cameras."""

import csv
import json
import os
import struct
import unittest
import zlib

import headpin
import numpy as np
import support

NUMBERS = [60, 250, 251]


def png(path):
    """The values of a PNG without interlacing, rows from the top."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed, head = 8, b"", None
    while at < len(data):
        length, = struct.unpack(">I", data[at:at + 4])
        kind, chunk = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", chunk)
        packed += chunk if kind == b"IDAT" else b""
        at += 12 + length
    width, height, depth, colour, _, _, interlace = head
    assert interlace == 0 and (depth, colour) in ((8, 2), (16, 0))
    per_pixel = 3 if colour == 2 else 2
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * per_pixel)
    out = np.zeros((height, width * per_pixel), np.uint8)
    for y, row in enumerate(rows):
        assert row[0] in (0, 2)  # none, or the difference from the row above
        out[y] = row[1:] + (out[y - 1] if row[0] == 2 and y > 0 else 0)
    return out.reshape(height, width, 3) if colour == 2 else out.view(">u2")


class Frames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder, cls.cameras = support.file("frames"), support.file("cameras.json")
        support.command("frames", support.DEMO, "-o", cls.folder, "--frames", ",".join(map(str, NUMBERS)), "--depth",
                        "--ids", "--cameras", cls.cameras)
        cls.trial = headpin.Trial(support.DEMO)
        cls.frames = cls.trial.frames(NUMBERS, eye="both", depth=True, ids=True)

    def file(self, name):
        return os.path.join(self.folder, name)

    def test_have_the_pixels_of_the_command(self):
        for frame in self.frames:
            for i, eye in enumerate(("left", "right")):
                stem = f"{eye}_{frame.number:06}"
                np.testing.assert_array_equal(frame.image[i], png(self.file(stem + ".png")))
                np.testing.assert_array_equal(frame.ids[i], png(self.file(stem + "_ids.png")))
                raw = np.fromfile(self.file(stem + "_depth.raw"), np.float32).reshape(frame.depth[i].shape)
                np.testing.assert_array_equal(frame.depth[i], raw)
            self.assertIn(1, frame.ids)
        self.assertEqual((self.frames[0].image.dtype, self.frames[0].ids.dtype), (np.uint8, np.uint8))

    def test_have_its_times_and_ticks(self):
        with open(self.file("frames.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(int(row["frame"]), int(row["tick"]), float(row["time_s"])) for row in rows],
                         [(frame.number, frame.tick, frame.time) for frame in self.frames])

    def test_have_its_cameras(self):
        with open(self.cameras, encoding="utf-8") as file:
            said = json.load(file)
        for frame, row in zip(self.frames, said["frames"]):
            for i, eye in enumerate(("left", "right")):
                np.testing.assert_array_equal(frame.K[i], said["cameras"][eye]["K"])
                np.testing.assert_array_equal(frame.gl_projection[i], said["cameras"][eye]["gl_projection"])
                np.testing.assert_array_equal(frame.T_cam_world[i], row[eye]["T_cam_world"])

    def test_show_the_ball_where_both_conventions_put_it(self):
        """The centre of the ball, which rolls on the lane, is projected onto pixels that show it."""
        states = headpin.Trial(support.simulated()).states
        for eye, frame in enumerate([self.frames[1]] * 2):
            row = states[(states["tick"] == frame.tick) & (states["body"] == "ball")][0]
            p = np.array([row["x_m"], row["y_m"], row["z_m"], 1.0])
            seen = frame.T_cam_world[eye] @ p
            x, y, w = frame.K[eye] @ seen[:3]
            self.assertEqual(frame.ids[eye][round(y / w), round(x / w)], 10)
            clip = frame.gl_projection[eye] @ frame.gl_view[eye] @ p
            height, width = frame.ids[eye].shape
            gl = [(1 + clip[0] / clip[3]) / 2 * width - 0.5, (1 - clip[1] / clip[3]) / 2 * height - 0.5]
            np.testing.assert_allclose(gl, [x / w, y / w], atol=1e-9)
            self.assertGreater(seen[2], frame.depth[eye][round(y / w), round(x / w)])  # its surface is nearer

    def test_of_one_eye_have_no_axis_of_eyes(self):
        frame = self.trial.frames(250, eye="right", ids=True)
        np.testing.assert_array_equal(frame.image, self.frames[1].image[1])
        np.testing.assert_array_equal(frame.ids, self.frames[1].ids[1])
        np.testing.assert_array_equal(frame.K, self.frames[1].K[1])
        self.assertIsNone(frame.depth)

    def test_come_in_the_order_asked_for(self):
        self.assertEqual([frame.number for frame in self.trial.frames([9, 3, 9])], [9, 3, 9])
        self.assertEqual(self.trial.frames([]), [])
        self.assertEqual([frame.number for frame in self.trial.frames(np.arange(2, 5))], [2, 3, 4])
        self.assertEqual(self.trial.frames(np.int64(3)).number, 3)
        with self.assertRaisesRegex(TypeError, "frames: expected whole numbers, found "):
            self.trial.frames("12")

    def test_cannot_be_written_and_outlive_their_frame(self):
        image = self.trial.frames(0).image
        again = self.trial.frames(0).image.copy()
        np.testing.assert_array_equal(image, again)
        with self.assertRaises(ValueError):
            image[0, 0, 0] = 1

    def test_that_are_not_there_are_refused(self):
        for number in (-1, 100000):
            with self.assertRaisesRegex(ValueError, "expected frames from 0 to "):
                self.trial.frames(number)
        with self.assertRaisesRegex(ValueError, "eye: expected left, right or both, found middle"):
            self.trial.frames(0, eye="middle")
        with self.assertRaisesRegex(ValueError, "look: expected one of standard, fast, 1997, found nice"):
            self.trial.frames(0, look="nice")
        for number in (1.5, None):
            with self.assertRaisesRegex(TypeError, f"frames: expected a whole number, found {number}"):
                self.trial.frames(number)


if __name__ == "__main__":
    unittest.main()
