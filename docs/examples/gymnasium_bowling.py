"""A throw as an environment for reinforcement learning (Gymnasium is not needed to import this file).

    pip install gymnasium
    python3 docs/examples/gymnasium_bowling.py

The agent moves the hand that holds the ball, 60 times a second, and lets go. Then the simulation goes on until the
ball has stopped or left, and the reward is the number of skittles that fell.
"""

import tomllib

import headpin
import numpy as np

SCENARIO = "name = 'one-throw'\n"  # everything else is the default
RATE = 60  # samples of the hand a second
TICKS = 4  # of the simulation, 240 Hz, for each of them
FASTEST = 8.0  # of the hand [m/s]
LONGEST_SWING, LONGEST_ROLL = 2 * RATE, 8 * RATE  # steps


class Bowling:
    """The loop: one throw, step by step."""

    def __init__(self, scenario=SCENARIO):
        self.scenario = scenario
        self.grip = np.array(tomllib.loads(scenario).get("hand", {}).get("grip", [0.0, -0.03, -0.115]))

    def reset(self):
        """The ball is in the hand, 1.5 m before the foul line, a knee's height above the floor."""
        self.session = headpin.Session(self.scenario)
        self.ball = self.session.names.index("ball")
        self.time_us = 0
        self.hand = self._ball("x_m", "y_m", "z_m") - self.grip
        self._move()
        self.session.push(headpin.MouseSample(self.time_us, trigger=True))
        self._move()
        start, end = self.hand, np.array([0.0, -1.5, 0.4]) - self.grip
        for part in np.linspace(0.0, 1.0, RATE):
            self.hand = start + part * (end - start)
            self._move()
        return self.observation()

    def act(self, velocity, holds):
        """Moves the hand for 1/60 s. Returns the observation, the reward, and whether the throw is over.

        velocity: of the hand (3,), x to the right, y to the skittles, z up [m/s].
        holds: False lets the ball go; its roll is simulated at once.
        """
        self.hand = self.hand + np.clip(velocity, -FASTEST, FASTEST) / RATE
        self.hand[2] = max(self.hand[2], 0.3)
        self._move()
        if holds and self.time_us < 1_000_000 + LONGEST_SWING * 1_000_000 // RATE:
            return self.observation(), 0.0, False
        self.session.push(headpin.MouseSample(self.time_us, trigger=False))
        for _ in range(LONGEST_ROLL):
            self._move()
            if np.linalg.norm(self._ball("vx_mps", "vy_mps", "vz_mps")) < 0.01:
                break
        return self.observation(), float(self.session.score["skittles_down"]), True

    def observation(self):
        """Place of the hand [m], place [m] and velocity [m/s] of the ball: (9,)."""
        ball = self._ball("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")
        return np.concatenate([self.hand, ball]).astype(np.float32)

    def _ball(self, *columns):
        row = self.session.bodies[self.ball]
        return np.array([row[column] for column in columns])

    def _move(self):
        """One sample of the hand, and the ticks until the next one."""
        self.time_us += 1_000_000 // RATE
        self.session.push(headpin.TrackerSample(2, self.time_us, self.hand, [1, 0, 0, 0]))
        self.session.step(TICKS)


def environment():
    """The same as a gymnasium.Env."""
    import gymnasium

    class BowlingEnv(gymnasium.Env):
        def __init__(self):
            self.loop = Bowling()
            # velocity of the hand as a part of the fastest, and whether it holds the ball (above 0)
            self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
            self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (9,), np.float32)

        def reset(self, *, seed=None, options=None):
            super().reset(seed=seed)
            return self.loop.reset(), {}

        def step(self, action):
            seen, reward, over = self.loop.act(FASTEST * action[:3], action[3] > 0)
            return seen, reward, over, False, {}

    return BowlingEnv()


if __name__ == "__main__":
    env = environment()
    for direction in (-0.02, 0.0, 0.02):
        env.reset(seed=1)
        reward, over, steps = 0.0, False, 0
        while not over:
            steps += 1
            _, reward, over, _, _ = env.step(np.array([direction, 0.7, 0.0, 1.0 if steps < 16 else -1.0]))
        print(f"direction {direction:+.2f}: {reward:.0f} skittles")
