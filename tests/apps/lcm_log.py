"""LCM event logs read with nothing but Python: no reader of ours, no liblcm."""

import importlib
import struct


def events(path):
    """Channel and data of each event."""
    data = open(path, "rb").read()
    at = 0
    while at < len(data):
        magic, _, _, channel_size, size = struct.unpack(">IqqII", data[at : at + 28])
        assert magic == 0xEDA1DA01
        at += 28
        channel = data[at : at + channel_size].decode()
        at += channel_size
        yield channel, data[at : at + size]
        at += size


def decode(name, data):
    """A message by the code that lcm-gen made of its type; raises for another type's bytes."""
    return getattr(importlib.import_module("headpin." + name), name).decode(data)
