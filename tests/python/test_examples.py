"""The examples in docs/examples: what they do without the packages that are not needed here."""

import os
import sys
import unittest

import numpy as np
import support

sys.path.insert(0, os.path.join(support.SOURCES, "docs/examples"))
import gymnasium_bowling  # noqa: E402


def throw(sideways):
    """Swings straight ahead for 15 steps, then lets go; returns the loop, the reward and the last observation."""
    loop = gymnasium_bowling.Bowling()
    seen = loop.reset()
    for step in range(16):
        seen, reward, over = loop.act(np.array([sideways, 5.6, 0.0]), step < 15)
    return loop, reward, over, seen


class LoopOfTheGymnasiumExample(unittest.TestCase):
    def test_carries_the_ball_in_the_hand(self):
        loop = gymnasium_bowling.Bowling()
        before = loop.reset()
        np.testing.assert_allclose(before[3:6], [0.0, -1.5, 0.4], atol=1e-6)
        after, reward, over = loop.act(np.array([0.0, 3.0, 0.0]), True)
        self.assertEqual((reward, over), (0.0, False))
        np.testing.assert_allclose(after[:3] - before[:3], [0.0, 3.0 / 60, 0.0], atol=1e-6)
        self.assertGreater(after[4], before[4])

    def test_a_straight_throw_fells_skittles_and_one_to_the_side_none(self):
        loop, reward, over, seen = throw(0.0)
        self.assertTrue(over)
        self.assertGreater(reward, 0.0)
        self.assertEqual(reward, loop.session.score["skittles_down"])
        self.assertGreater(seen[4], 5.0)  # the ball is far down the lane
        _, aside, over, _ = throw(1.0)
        self.assertTrue(over)
        self.assertEqual(aside, 0.0)

    def test_the_same_actions_give_the_same_bits(self):
        self.assertEqual(throw(0.1)[0].session.game_hash, throw(0.1)[0].session.game_hash)


if __name__ == "__main__":
    unittest.main()
