"""Decodes every message of a log with nothing but the code lcm-gen made, and counts them.

Says a digest of the states of all ticks, too, whole ones or told by what is new in them: so these are
read by what devices/lcm/types/state_change_t.lcm says of them.

usage: read_trial.py FOLDER_OF_GENERATED_CODE LOG
"""

import collections
import hashlib
import struct
import sys

from lcm_log import decode, events

TYPES = {
    "HEADPIN_TRIAL": "trial_t",
    "TRACKER": "tracked_device_t",
    "MOUSE3D": "mouse3d_t",
    "EVENT": "event_t",
    "STATE": "state_t",
    "STATE_CHANGE": "state_change_t",
    "SNAPSHOT": "snapshot_t",
    "FRAME": "frame_t",
    "HEAD_POSE": "rigid_transform_t",
    "HAND_POSE": "rigid_transform_t",
}


def varints(data):
    number = shift = 0
    for byte in data:
        number |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            yield number
            number = shift = 0


def bits(body):
    numbers = body.position + body.quaternion + body.velocity + body.angular_velocity
    return list(struct.unpack(">13Q", struct.pack(">13d", *numbers)))


class States:
    """The bodies of the last two ticks, as bits; a digest of all there were."""

    def __init__(self):
        self.now, self.asleep, self.ticks, self.digest = [], [], 0, hashlib.sha256()

    def whole(self, message):
        self.before = self.now = [bits(body) for body in message.bodies]
        self.asleep = [bool(body.asleep) for body in message.bodies]
        self.take(message)

    def change(self, message):
        before, self.before = self.before, self.now
        self.now = [list(body) for body in self.now]
        numbers = list(varints(message.changes))
        for at in range(0, len(numbers), 14):
            body, self.asleep[numbers[at] // 2] = numbers[at] // 2, numbers[at] % 2 == 1
            for k, zigzag in enumerate(numbers[at + 1 : at + 14]):
                beyond = -(zigzag + 1) // 2 if zigzag % 2 else zigzag // 2
                gone_on = 2 * self.before[body][k] - before[body][k]
                self.now[body][k] = (gone_on + beyond) % 2**64
        self.take(message)

    def take(self, message):
        self.ticks += 1
        head = message.utime, message.tick, message.hash, message.num_contacts
        self.digest.update(repr((head, self.now, self.asleep)).encode())


states = States()
sys.path.insert(0, sys.argv[1])
counts = collections.Counter()
for channel, data in events(sys.argv[2]):
    message = decode(TYPES[channel], data)
    if channel in ("TRACKER", "HEAD_POSE", "HAND_POSE"):
        quaternion = message.quaternion if channel == "TRACKER" else message.quat
        assert abs(sum(q * q for q in quaternion) - 1.0) < 1e-9
    if channel == "STATE":
        assert message.num_bodies == len(message.bodies) > 10
        states.whole(message)
    if channel == "STATE_CHANGE":
        states.change(message)
    counts[channel] += 1
for channel, count in sorted(counts.items()):
    print(channel, count)
if states.ticks:
    print("state of", states.ticks, "ticks", states.digest.hexdigest())
