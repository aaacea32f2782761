"""Decodes what a live session shows others: the eyes' pictures and the bodies for Drake's viewer.

usage: read_eyes.py FOLDER_OF_GENERATED_CODE LOG RECORDING

Holds the pixels of each picture against the hash that the session's own recording has of that frame,
and prints how many messages of each kind there were.
"""

import collections
import struct
import sys
import zlib

from lcm_log import decode, events

sys.path.insert(0, sys.argv[1])


def unfiltered(kind, row, above):
    """A row of a PNG's RGB bytes (PNG 1.2, section 6)."""
    out = bytearray(row)
    for i, byte in enumerate(row):
        a = out[i - 3] if i >= 3 else 0
        b = above[i]
        c = above[i - 3] if i >= 3 else 0
        nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        out[i] = (byte + (0, a, b, (a + b) // 2, nearest)[kind]) % 256
    return out


def png_pixels(data, width, height):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", data[at + 8 : at + 21])
            assert header == (width, height, 8, 2, 0, 0, 0)  # 8 bits, RGB, not interlaced
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + size]
        at += 12 + size
    raw, stride = zlib.decompress(packed), 3 * width
    assert len(raw) == height * (1 + stride)
    pixels, above = bytearray(), bytes(stride)
    for y in range(height):
        row = raw[y * (1 + stride) : (y + 1) * (1 + stride)]
        above = unfiltered(row[0], row[1:], above)
        pixels += above
    return pixels


def fnv_1a(data):
    value = 14695981039346656037
    for byte in data:
        value = (value ^ byte) * 1099511628211 % 2**64
    return value


def pixel_hash(image):
    assert image.row_stride == 3 * image.width and image.size == len(image.data)
    assert image.pixel_format == image.PIXEL_FORMAT_RGB
    assert image.channel_type == image.CHANNEL_TYPE_UINT8
    if image.compression_method == image.COMPRESSION_METHOD_PNG:
        return fnv_1a(png_pixels(image.data, image.width, image.height))
    assert image.size == image.row_stride * image.height
    return fnv_1a(image.data)


recorded = {}
for channel, data in events(sys.argv[3]):
    if channel == "FRAME":
        frame = decode("frame_t", data)
        recorded[frame.frame] = [frame.left_hash % 2**64, frame.right_hash % 2**64]

counts = collections.Counter()
links = None
for channel, data in events(sys.argv[2]):
    counts[channel] += 1
    if channel == "HEADPIN_EYES" and counts[channel] <= 5:
        eyes = decode("image_array_t", data)
        assert eyes.num_images == len(eyes.images) == 2
        assert [i.header.frame_name for i in eyes.images] == ["left eye", "right eye"]
        assert [(i.width, i.height) for i in eyes.images] == [(360, 240)] * 2
        assert [pixel_hash(i) for i in eyes.images] == recorded[eyes.header.seq]
    if channel == "DRAKE_VIEWER_LOAD_ROBOT":
        load = decode("viewer_load_robot_t", data)
        links = [link.name for link in load.link]
        assert load.num_links == len(links) == len(set(links))
        for link in load.link:
            assert link.num_geom == len(link.geom) > 0
            assert all(g.num_float_data == len(g.float_data) > 0 for g in link.geom)
    if channel == "DRAKE_VIEWER_DRAW":
        draw = decode("viewer_draw_t", data)
        assert links is None or draw.link_name == links
        assert draw.num_links == len(draw.position) == len(draw.quaternion)
        assert all(abs(sum(q * q for q in each) - 1) < 1e-5 for each in draw.quaternion)
for name in ("ball", "skittle 1", "skittle 10", "head", "hand", "lane"):
    assert name in links
for channel in ("HEADPIN_EYES", "DRAKE_VIEWER_LOAD_ROBOT", "DRAKE_VIEWER_DRAW"):
    print(channel, counts[channel])
