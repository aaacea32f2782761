"""headpin.engine: the engine in Python, with the bits of C++."""

import contextlib
import ctypes
import io
import os
import re
import signal
import subprocess
import sys
import threading
import unittest

import numpy as np
import support

from headpin import engine

R, M = 0.1085, 6.8  # of a bowling ball [m, kg]


def ball(**more):
    return engine.Body(engine.Ellipsoid([R, R, R]), "ball", M, 0.4 * M * R * R * np.eye(3), **more)


def lane(**more):
    return engine.Body(engine.HalfSpace(), "lane", kind="fixed", **more)


def strike(**parameters):
    """The world of engine_states.cpp."""
    world = engine.World(**parameters)
    world.add(lane())
    world.add(ball(), [0, 0, 0.5], velocity=[0, 5, 0])
    pin = engine.Compound(
        [
            engine.Part(engine.Cylinder(0.06, 0.15), [0, 0, -0.04]),
            engine.Part(engine.Ellipsoid([0.05, 0.05, 0.05]), [0, 0, 0.14]),
        ]
    )
    for k in (-1, 0, 1):
        body = engine.Body(
            pin, "pin", 1.5, np.diag([0.01, 0.01, 0.003]), elasticity=0.8, friction=0.3
        )
        world.add(body, [0.3 * k, 3.0, 0.19])
    return world


def hashes(world, count):
    found = []
    for _ in range(count):
        world.step()
        found.append(world.state_hash)
    return found


class World(unittest.TestCase):
    def test_has_the_bits_of_the_same_world_in_cpp(self):
        program = subprocess.run(
            [os.environ["HEADPIN_ENGINE_STATES"]], capture_output=True, text=True, check=True
        )
        self.assertEqual(hashes(strike(), 480), program.stdout.split())

    def test_of_the_guide_says_what_the_program_of_the_guide_says(self):
        with open(os.path.join(support.SOURCES, "docs/guides/engine.md"), encoding="utf-8") as guide:
            example = re.search(r"```python\n(.*?)```", guide.read(), re.DOTALL).group(1)
        program = os.environ["HEADPIN_ENGINE_GUIDE"]
        said = subprocess.run([program], capture_output=True, text=True, check=True).stdout
        self.assertIn("lands after", said)
        in_python = io.StringIO()
        with contextlib.redirect_stdout(in_python):
            exec(example, {})
        self.assertEqual(in_python.getvalue(), said)

    def test_goes_on_with_the_same_bits_after_it_was_restored(self):
        world = strike()
        world.step(150)
        saved, copy = world.save(), world.copy()
        after = hashes(world, 100)
        restored = strike()
        restored.restore(saved)
        self.assertEqual(restored.tick, 150)
        self.assertEqual(hashes(restored, 100), after)
        self.assertEqual(hashes(copy, 100), after)

    def test_refuses_damaged_saved_states_and_stays_as_it_was(self):
        world = strike()
        world.step(100)
        saved, before = world.save(), world.state_hash
        for bytes_ in (b"", saved[:-1], saved[:50] + bytes([saved[50] ^ 1]) + saved[51:]):
            with self.assertRaisesRegex(ValueError, "^saved world: "):
                world.restore(bytes_)
        self.assertEqual(world.state_hash, before)

    def test_a_ball_falls_as_galileo_says_and_its_event_tells_the_speed(self):
        world = engine.World(rate_hz=1000)
        world.add(lane(elasticity=0.0))
        number = world.add(ball(), [0, 0, R + 1.0])
        while not len(world.events):
            world.step()
        event = world.events[0]
        self.assertEqual({event["a"], event["b"]}, {0, number})
        self.assertTrue(event["first"])
        self.assertAlmostEqual(event["approach_speed"], np.sqrt(2 * 9.81), delta=9.81 / 1000)
        self.assertAlmostEqual(event["position"][2], 0.0, delta=1e-3)
        self.assertGreater(abs(event["impulse"][2]), 0.9 * M * event["approach_speed"])
        touching = world.contacts(margin=1e-3)
        self.assertEqual(len(touching), 1)
        np.testing.assert_allclose(np.abs(touching["normal"][0]), [0, 0, 1], atol=1e-12)

    def test_an_exact_wall_stops_a_ball_under_the_papers_detection(self):
        corners = [[0.1 if i & 1 else -0.1, 1 if i & 2 else -1, 1 if i & 4 else -1] for i in range(8)]
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        world = engine.World(gravity=[0, 0, 0], detection="paper")
        wall = engine.Polyhedron(corners, faces)
        world.add(engine.Body(wall, kind="fixed", elasticity=1, friction=0, exact=True))
        number = world.add(engine.Body(engine.Ellipsoid([0.1] * 3), mass=5, elasticity=1, friction=0),
                           [-2, 0, 0], velocity=[3, 0, 0])
        world.step(480)
        np.testing.assert_allclose(world.states[number]["velocity"], [-3, 0, 0], atol=0.01)

    def test_contacts_of_an_exact_body_are_exact_under_the_papers_detection(self):
        world = engine.World(detection="paper")
        corners = [[5 if i & 1 else -5, 5 if i & 2 else -5, 0.5 if i & 4 else -0.5] for i in range(8)]
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        world.add(engine.Body(engine.Polyhedron(corners, faces), kind="fixed", exact=True), [0, 0, -0.5])
        number = world.add(engine.Body(engine.Ellipsoid([0.1] * 3), mass=5), [1.3, 0.7, 0.105])
        self.assertEqual(len(world.contacts(margin=1e-3)), 0)
        (apart,) = world.contacts(margin=0.01)
        self.assertAlmostEqual(apart["depth"], -0.005, delta=1e-9)
        world.set_state(number, [1.3, 0.7, 0.099])
        (inside,) = world.contacts()
        self.assertAlmostEqual(inside["depth"], 0.001, delta=1e-9)
        np.testing.assert_allclose(inside["position"], [1.3, 0.7, -0.0005], atol=1e-3)
        for margin in (float("nan"), -1.0, float("inf")):
            with self.assertRaises(ValueError):
                world.contacts(margin=margin)

    def test_contacts_have_no_points_at_the_edges_of_boards_that_join(self):
        world = engine.World()
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        corners = [[1 if i & 1 else -1, 0.5 if i & 2 else -0.5, 0 if i & 4 else -0.1] for i in range(8)]
        for y in (-0.5, 0.5):
            board = engine.Part(engine.Polyhedron(corners, faces), [0, y, 0])
            world.add(engine.Body(engine.Compound([board]), kind="fixed"))
        world.add(engine.Body(engine.Ellipsoid([0.1] * 3), mass=5), [0.3, -0.005, 0.0998])
        (point,) = world.contacts()
        self.assertEqual(point["a"], 0)
        np.testing.assert_allclose(point["normal"], [0, 0, 1], atol=1e-6)
        self.assertAlmostEqual(point["depth"], 2e-4, delta=1e-8)

    def test_states_have_what_was_set(self):
        world = engine.World(gravity=[0, 0, 0])
        number = world.add(ball(kind="driven"), [1, 2, 3])
        quaternion = np.array([0.5, 0.5, -0.5, 0.5])
        world.set_state(number, [4, 5, 6], quaternion, [1, 0, 0], [0, 2, 0])
        state = world.states[number]
        np.testing.assert_array_equal(state["position"], [4, 5, 6])
        np.testing.assert_array_equal(state["quaternion"], quaternion)
        np.testing.assert_array_equal(state["velocity"], [1, 0, 0])
        np.testing.assert_array_equal(state["angular_velocity"], [0, 2, 0])
        self.assertFalse(state["asleep"])

    def test_errors_name_what_is_wrong(self):
        world = engine.World()
        for wrong, words in (
            (lambda: engine.World(rate_hz=0), "rate_hz|rate"),
            (lambda: engine.World(response="rubber"), "response: expected one of paper, coulomb"),
            (lambda: engine.World(sliding="rubber"), "^sliding: expected one of paper, coulomb, found 'rubber'"),
            (lambda: engine.World(sliding="coulomb"),
             "^sliding: expected a law of response of your own beside it, found response='paper'"),
            (lambda: engine.World(response="coulomb", sliding="coulomb"), "beside it, found response='coulomb'"),
            (lambda: engine.World(response=None), "^response: expected a name or a law, found None"),
            (lambda: engine.World(detection="none"), "detection: expected one of"),
            (lambda: engine.Body(engine.HalfSpace(), kind="solid"), "kind: expected one of"),
            (lambda: world.add(ball(elasticity=2.0)), "'ball': .*elasticity"),
            (lambda: world.add(ball(), [0, 0, np.nan]), "expected a finite pose"),
            (lambda: world.set_state(7, [0, 0, 0]), "body 7: there are 0"),
            (lambda: engine.Compound([]), "part"),
        ):
            with self.assertRaisesRegex(ValueError, words):
                wrong()

    def test_two_threads_step_two_worlds_as_one_does(self):
        expected = hashes(strike(), 480)[-1]
        worlds = [strike(), strike()]
        threads = [threading.Thread(target=world.step, args=(480,)) for world in worlds]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([world.state_hash for world in worlds], [expected] * 2)

    def test_stops_at_ctrl_c(self):
        script = (
            "import headpin.engine as e\n"
            "world = e.World()\n"
            "world.add(e.Body(e.Ellipsoid([1, 1, 1])))\n"
            "try:\n"
            "    print('steps', flush=True)\n"
            "    world.step(10**15)\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped')\n"
        )
        child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "steps\n")
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.communicate()[0], "stopped\n")


class OwnResponse(unittest.TestCase):
    @staticmethod
    def smooth(u, K, N, elasticity, friction):
        """The paper's response without friction."""
        return -(1.0 + elasticity) * u.dot(N) / N.dot(K @ N) * N

    def bounces(self, **parameters):
        """Where a smooth ball is while it rises from its first bounce, and the world."""
        world = engine.World(**parameters)
        world.add(lane(friction=0.0))
        world.add(ball(friction=0.0), [0, 0, 1.0], velocity=[0, 2, 0])
        world.step(130)
        return world.states[1]["position"], world

    def test_of_the_papers_formula_moves_bodies_as_the_paper_does(self):
        paper, _ = self.bounces(response="paper")
        own, world = self.bounces(response=self.smooth)
        self.assertEqual(world.response, "custom")
        np.testing.assert_allclose(own, paper, rtol=0, atol=1e-9)
        dull, _ = self.bounces(response=lambda u, K, N, e, f: self.smooth(u, K, N, 0.0, f))
        self.assertGreater(np.abs(dull - paper).max(), 1e-3)

    def test_of_a_c_function_has_the_bits_of_the_same_one_in_python(self):
        numbers = ctypes.POINTER(ctypes.c_double)

        @ctypes.CFUNCTYPE(
            None, numbers, numbers, numbers, ctypes.c_double, ctypes.c_double, numbers
        )
        def law(u, K, N, elasticity, friction, impulse):
            u, K, N = np.array(u[:3]), np.array(K[:9]).reshape(3, 3), np.array(N[:3])
            impulse[0], impulse[1], impulse[2] = self.smooth(u, K, N, elasticity, friction)

        address = ctypes.cast(law, ctypes.c_void_p).value
        _, in_c = self.bounces(response=address)
        _, in_python = self.bounces(response=self.smooth)
        self.assertEqual(in_c.state_hash, in_python.state_hash)

    def test_raises_its_errors_from_step_and_leaves_the_world_as_before(self):
        class Oops(Exception):
            pass

        def fails(u, K, N, elasticity, friction):
            raise Oops("no impulse")

        world = engine.World(response=fails)
        world.add(lane())
        world.add(ball(), [0, 0, 0.3])
        with self.assertRaisesRegex(Oops, "no impulse"):
            world.step(300)
        tick, before = world.tick, world.state_hash
        self.assertTrue(0 < tick < 300)
        with self.assertRaises(Oops):
            world.step()
        self.assertEqual((world.tick, world.state_hash), (tick, before))

    def test_is_not_in_saved_bytes_and_must_be_given_again(self):
        def dull(u, K, N, elasticity, friction):
            return self.smooth(u, K, N, 0.0, friction)

        def falling(response):
            world = engine.World(response=response)
            world.add(lane(friction=0.0))
            world.add(ball(friction=0.0), [0, 0, 1.0])
            return world

        saved = falling(self.smooth)
        saved.step(50)  # before it lands
        bytes_ = saved.save()
        again, other, whole = falling(self.smooth), falling(dull), falling(dull)
        whole.step(50)
        for world in (again, other):
            world.restore(bytes_)
        for world in (saved, again, other, whole):
            world.step(80)
        self.assertEqual(again.state_hash, saved.state_hash)
        self.assertEqual(other.state_hash, whole.state_hash)
        self.assertNotEqual(other.state_hash, saved.state_hash)
        with self.assertRaisesRegex(ValueError, "other bodies or parameters"):
            falling("paper").restore(bytes_)
        for told in (engine.World.save.__doc__, engine.World.restore.__doc__):
            self.assertRegex(told, r"law\s+of\s+one's\s+own\s+(is|are)\s+not")

    def test_must_give_three_finite_numbers(self):
        for given in ([1.0, 2.0], [0.0, np.nan, 0.0], "none", None):
            with self.assertRaisesRegex(ValueError, "expected an impulse of three finite numbers"):
                self.bounces(response=lambda *_, given=given: given)

    def test_is_a_function_or_an_address(self):
        for wrong in (1.5, True, False, -1, 2**64):
            with self.assertRaisesRegex(ValueError, "expected a name, a function or the address.*found " + repr(wrong)):
                engine.World(response=wrong)
        with self.assertRaisesRegex(ValueError, "the address of its function is 0"):
            engine.World(response=0)

    def test_cannot_use_the_world_that_calls_it(self):
        def law(u, K, N, elasticity, friction):
            world.step()

        world = engine.World(response=law)
        world.add(lane())
        world.add(ball(), [0, 0, 0.3])
        with self.assertRaisesRegex(RuntimeError, "world: is making a step in another call"):
            world.step(300)


class Shapes(unittest.TestCase):
    def test_balls_are_apart_by_the_distance_of_their_centres_less_their_radii(self):
        a, b = engine.Ellipsoid([0.1] * 3), engine.Ellipsoid([0.2] * 3)
        apart = engine.closest_points(a, b, [0.5, 0, 0], margin=1.0)
        self.assertTrue(apart["separated"])
        self.assertAlmostEqual(apart["distance"], 0.2, places=9)
        np.testing.assert_allclose(apart["point_a"], [0.1, 0, 0], atol=1e-9)
        deep = engine.closest_points(a, b, [0.25, 0, 0])
        self.assertFalse(deep["separated"])
        self.assertAlmostEqual(deep["distance"], -0.05, places=9)
        np.testing.assert_allclose(deep["normal"], [1, 0, 0], atol=1e-9)

    def test_beyond_the_margin_shapes_are_apart_by_their_gap_or_more_than_said(self):
        a, b, turn = engine.Cylinder(0.1, 0.3), engine.Cylinder(0.2, 0.1), [np.cos(0.4), np.sin(0.4), 0, 0]
        gap = engine.closest_points(a, b, [0.5, 0.7, 0.9], turn, margin=np.inf)
        self.assertAlmostEqual(np.linalg.norm(gap["point_b"] - gap["point_a"]), gap["distance"], places=4)
        said = engine.closest_points(a, b, [0.5, 0.7, 0.9], turn)
        self.assertTrue(said["separated"])
        self.assertLess(said["distance"], gap["distance"] - 0.01)
        between_planes = said["normal"].dot(said["point_b"] - said["point_a"])
        self.assertAlmostEqual(between_planes, said["distance"], places=9)

    def test_a_cylinder_weighs_what_geometry_says(self):
        radius, half, density = 0.06, 0.2, 700.0
        mass = np.pi * radius**2 * 2 * half * density
        of = engine.mass_properties(engine.Cylinder(radius, half), density)
        self.assertAlmostEqual(of.mass, mass, places=12)
        across = mass * (3 * radius**2 + (2 * half) ** 2) / 12
        along = mass * radius**2 / 2
        np.testing.assert_allclose(of.inertia, np.diag([across, across, along]), atol=1e-12)
        body = engine.Body(engine.Cylinder(radius, half), mass=2 * mass)
        np.testing.assert_allclose(body.inertia, 2 * of.inertia, atol=1e-12)

    def test_a_polyhedron_that_is_not_closed_is_refused_with_its_fault(self):
        corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        self.assertEqual(len(engine.Polyhedron(corners, faces).vertices), 4)
        with self.assertRaisesRegex(ValueError, "edge"):
            engine.Polyhedron(corners, [faces[0][::-1], *faces[1:]])

    def test_a_wrong_measure_is_named_wherever_the_shape_goes(self):
        for shape, words in ((lambda: engine.Ellipsoid([0.1, 0.1, -0.1]), "ellipsoid radius: -0.1"),
                             (lambda: engine.Ellipsoid([np.nan, 1, 1]), "ellipsoid radius: nan"),
                             (lambda: engine.Cylinder(-1, 1), "cylinder radius: -1"),
                             (lambda: engine.Cone(1, 0), "cone height: 0")):
            with self.assertRaisesRegex(ValueError, words):
                engine.Body(shape())
        with self.assertRaisesRegex(ValueError, "no principal moment above the sum of the two others"):
            engine.Body(engine.Ellipsoid([0.1] * 3), inertia=np.diag([1.0, 1.0, 5.0]))
        with self.assertRaisesRegex(ValueError, "count: expected 0 or more, found -5"):
            engine.World().step(-5)
        ball = engine.Ellipsoid([0.1] * 3)
        for position, quaternion in (([1, 0, 0], [2, 0, 2, 0]), ([np.nan, 0, 0], [1, 0, 0, 0])):
            with self.assertRaisesRegex(ValueError, "position is not finite or quaternion not unit"):
                engine.closest_points(ball, ball, position, quaternion)
        with self.assertRaisesRegex(ValueError, "margin: expected 0 or more, found nan"):
            engine.closest_points(ball, ball, [1, 0, 0], margin=np.nan)
        for density in (0, -1, np.nan, np.inf):
            for weigh in (engine.mass_properties, engine.about_centre):
                with self.assertRaisesRegex(ValueError, "density: expected finite and above 0"):
                    weigh(ball, density)

    def test_a_compound_is_put_about_its_centre(self):
        parts = [engine.Part(engine.Ellipsoid([0.1] * 3), [x, 0, 0]) for x in (0.0, 1.0)]
        off = engine.Compound(parts)
        with self.assertRaisesRegex(ValueError, "about_centre"):
            engine.Body(off)
        centred = engine.about_centre(off, 1000.0)
        np.testing.assert_allclose(centred["position"], [0.5, 0, 0], atol=1e-9)
        body = engine.Body(centred["compound"], mass=centred["mass"])
        np.testing.assert_allclose(body.inertia, centred["inertia"], rtol=1e-6, atol=1e-9)


if __name__ == "__main__":
    unittest.main()
