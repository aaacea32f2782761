"""Decodes every message of a log with nothing but the code lcm-gen made, and counts them.

usage: read_trial.py FOLDER_OF_GENERATED_CODE LOG
"""

import collections
import importlib
import struct
import sys

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


def events(data):
    at = 0
    while at < len(data):
        magic, _, _, channel_size, size = struct.unpack(">IqqII", data[at : at + 28])
        assert magic == 0xEDA1DA01
        at += 28
        channel = data[at : at + channel_size].decode()
        at += channel_size
        yield channel, data[at : at + size]
        at += size


sys.path.insert(0, sys.argv[1])
counts = collections.Counter()
for channel, data in events(open(sys.argv[2], "rb").read()):
    name = TYPES[channel]
    message = getattr(importlib.import_module("headpin." + name), name).decode(data)
    if channel in ("TRACKER", "HEAD_POSE", "HAND_POSE"):
        quaternion = message.quaternion if channel == "TRACKER" else message.quat
        assert abs(sum(q * q for q in quaternion) - 1.0) < 1e-9
    if channel == "STATE":
        assert message.num_bodies == len(message.bodies) > 10
    counts[channel] += 1
for channel, count in sorted(counts.items()):
    print(channel, count)
