"""Decodes every message of a log with nothing but the code lcm-gen made, and counts them.

usage: read_trial.py FOLDER_OF_GENERATED_CODE LOG
"""

import collections
import sys

from lcm_log import decode, events

TYPES = {
    "HEADPIN_TRIAL": "trial_t",
    "TRACKER": "tracked_device_t",
    "MOUSE3D": "mouse3d_t",
    "EVENT": "event_t",
    "STATE": "state_t",
    "FRAME": "frame_t",
    "HEAD_POSE": "rigid_transform_t",
    "HAND_POSE": "rigid_transform_t",
}

sys.path.insert(0, sys.argv[1])
counts = collections.Counter()
for channel, data in events(sys.argv[2]):
    message = decode(TYPES[channel], data)
    if channel in ("TRACKER", "HEAD_POSE", "HAND_POSE"):
        quaternion = message.quaternion if channel == "TRACKER" else message.quat
        assert abs(sum(q * q for q in quaternion) - 1.0) < 1e-9
    if channel == "STATE":
        assert message.num_bodies == len(message.bodies) > 10
    counts[channel] += 1
for channel, count in sorted(counts.items()):
    print(channel, count)
