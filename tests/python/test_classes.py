"""Objects whose __init__ did not run are refused wherever they are used. They ended Python."""

import copy
import pickle
import unittest

import headpin
import numpy as np
import support
from headpin import engine

WORDS = "expected an object that was made by a call of its class; found one whose __init__ was not called"
CLASSES = sorted({thing for module in (headpin, engine) for thing in vars(module).values()
                  if isinstance(thing, type) and not issubclass(thing, Exception)}, key=lambda c: c.__name__)


def only_new(of):
    return of.__new__(of)


class AnObjectWithoutInit(unittest.TestCase):
    def refused(self, use, *objects):
        with self.assertRaisesRegex(TypeError, WORDS):
            use(*objects)

    def test_has_no_values(self):
        self.assertEqual(len(CLASSES), 16)
        tried = 0
        for of in CLASSES:
            for name, member in vars(of).items():
                if isinstance(member, property):
                    self.refused(lambda: getattr(only_new(of), name))
                    tried += 1
        self.assertGreater(tried, 50)

    def test_has_no_calls(self):
        for use in (engine.World.step, engine.World.save, engine.World.copy, copy.copy):
            self.refused(use, only_new(engine.World))
        self.refused(headpin.Session.step, only_new(headpin.Session))
        self.refused(headpin.Trial.verify, only_new(headpin.Trial))
        self.refused(headpin.Trial.replay, only_new(headpin.Trial))
        self.refused(repr, only_new(headpin.Trial))
        self.refused(headpin.Replay.save, only_new(headpin.Replay), support.file("none.lcmlog"))

    def test_is_no_argument(self):
        for shape in (engine.Ellipsoid, engine.Cylinder, engine.Cone, engine.HalfSpace, engine.Polyhedron):
            for use in (engine.Body, engine.Compound, engine.Part, lambda s: engine.mass_properties(s, 1.0),
                        lambda s: engine.closest_points(engine.HalfSpace(), s, [0, 0, 0])):
                self.refused(use, only_new(shape))
        self.refused(engine.Body, only_new(engine.Compound))
        self.refused(engine.Compound, [only_new(engine.Part)])
        self.refused(engine.World().add, only_new(engine.Body))
        session = headpin.Session("uno-slater-1997")
        for sample in (headpin.TrackerSample, headpin.MouseSample):
            self.refused(session.push, only_new(sample))
            self.refused(session.push, [only_new(sample)])

    def test_may_be_of_a_class_of_ones_own(self):
        class Early(engine.World):
            def __init__(self):
                self.step()
                super().__init__()

        class Never(engine.World):
            def __init__(self):
                pass

        self.refused(Early)
        self.refused(lambda: only_new(Never).step())
        with self.assertRaisesRegex(TypeError, "__init__"):
            Never()

    def test_gets_its_values_by_init(self):
        world = only_new(engine.World)
        world.__init__(rate_hz=480)
        world.step()
        self.assertEqual(world.tick, 1)


class AnObject(unittest.TestCase):
    def test_is_copied_as_before(self):
        world = engine.World()
        world.step()
        self.assertEqual(copy.copy(world).state_hash, world.state_hash)
        for one in (world, engine.HalfSpace(), headpin.MouseSample(0)):
            with self.assertRaisesRegex(TypeError, "cannot pickle"):
                pickle.dumps(one)

    def test_may_be_of_a_class_of_ones_own(self):
        class Fast(engine.World):
            def __init__(self):
                super().__init__(rate_hz=960)
                self.added = self.add(engine.Body(engine.Ellipsoid([1, 1, 1])))

        self.assertEqual(Fast().added, 0)

    def test_arrays_of_a_frame_keep_it(self):
        frame = headpin.Trial(support.DEMO).frames(0, depth=True)
        image = frame.image
        self.assertIs(image.base, frame)
        expected = image.copy()
        del frame
        np.testing.assert_array_equal(image, expected)


if __name__ == "__main__":
    unittest.main()
