#!/usr/bin/env python3
"""Draws frames.svg: the frames W T S H D L R B in the room, seen from behind on the left.

usage: frames.py > frames.svg
"""

# World: x right, y to the skittles, z up [m]. Drawn obliquely: y goes up and to the right.
SCALE, ORIGIN = 165.0, (430.0, 470.0)


def at(p):
    x, y, z = p
    return (ORIGIN[0] + SCALE * (x + 0.5 * y), ORIGIN[1] - SCALE * (0.3 * y + z))


def line(a, b, style):
    (x1, y1), (x2, y2) = at(a), at(b)
    return f"<line x1='{x1:.1f}' y1='{y1:.1f}' x2='{x2:.1f}' y2='{y2:.1f}' {style}/>"


def area(points, style):
    return "<polygon points='" + " ".join("%.1f,%.1f" % at(p) for p in points) + f"' {style}/>"


def add(a, b, k=1.0):
    return tuple(u + k * v for u, v in zip(a, b))


def text(p, says, shift=(0, 0), style=""):
    x, y = at(p)
    return f"<text x='{x + shift[0]:.1f}' y='{y + shift[1]:.1f}' {style}>{says}</text>"


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
minus = lambda v: tuple(-u for u in v)
COLOURS = {"x": "#c0392b", "y": "#2e8b57", "z": "#1f5fb4"}


def frame(name, origin, x, y, z, size, shift=(6, 14), axes=True):
    out = []
    for axis, direction in (("x", x), ("y", y), ("z", z)):
        tip = add(origin, direction, size)
        out.append(line(origin, tip, f"stroke='{COLOURS[axis]}' stroke-width='2' "
                        f"marker-end='url(#{axis})'"))
        if axes:
            out.append(text(add(origin, direction, size + 0.09), axis, (-3, 4),
                            f"fill='{COLOURS[axis]}' font-size='11'"))
    out.append(text(origin, name, shift, "font-weight='bold' font-size='15'"))
    return out


def circle(p, radius, style):
    x, y = at(p)
    return f"<circle cx='{x:.1f}' cy='{y:.1f}' r='{radius * SCALE:.1f}' {style}/>"


out = ["<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 960 620' width='960' height='620' "
       "font-family='sans-serif' font-size='12' fill='#333'>", "<defs>"]
for axis, colour in COLOURS.items():
    out.append(f"<marker id='{axis}' viewBox='0 0 8 8' refX='6' refY='4' markerWidth='6' "
               f"markerHeight='6' orient='auto'><path d='M0 0L8 4L0 8z' fill='{colour}'/></marker>")
out += ["</defs>", "<rect width='100%' height='100%' fill='white'/>"]

# Lane, foul line, skittles.
HALF, END = 0.527, 4.0
out.append(area([(-HALF, -1.5, 0), (HALF, -1.5, 0), (HALF, END, 0), (-HALF, END, 0)],
                "fill='#f6efe2' stroke='#d8c9a8'"))
out.append(line((-HALF, 0, 0), (HALF, 0, 0), "stroke='#b8860b' stroke-width='2'"))
out.append(text((-HALF, 0, 0), "foul line", (6, 16), "fill='#b8860b'"))
for row in reversed(range(4)):
    for i in range(row + 1):
        spot = ((i - 0.5 * row) * 0.26, 3.0 + 0.24 * row, 0)
        out.append(line(spot, add(spot, Z, 0.36), "stroke='#8c8c8c' stroke-width='9' "
                        "stroke-linecap='round'"))
out.append(text((0.62, 3.7, 0), "skittles", (0, 0), "fill='#777'"))

# The player: a stroke each for trunk, arm, head.
hip, neck, head, hand = (-0.5, -1.0, 0.9), (-0.5, -0.95, 1.42), (-0.5, -0.9, 1.68), (0.3, -0.5, 1.2)
body = "stroke='#d5d5d5' stroke-width='22' stroke-linecap='round'"
out += [line((-0.62, -1.0, 0.08), hip, body), line((-0.38, -1.0, 0.08), hip, body),
        line(hip, neck, body), line(neck, hand, body.replace("22", "14")),
        circle(head, 0.15, "fill='#d5d5d5'")]

# Frames.
out += frame("W", (0, 0, 0), X, Y, Z, 0.55, (-22, 4))
out += frame("T", (-1.3, -1.5, 1.0), Y, X, minus(Z), 0.42, (-20, -4))
out.append(line((-1.3, -1.5, 0.5), (-1.3, -1.5, 0), "stroke='#ccc' stroke-dasharray='3 3'"))
helmet, back = (-0.5, -0.95, 1.98), (0.22, -0.6, 1.55)
out += frame("S", helmet, Y, X, minus(Z), 0.2, (-16, -2), axes=False)
out.append(text(helmet, "station 1, worn on the head", (-178, -2), "fill='#777' font-size='11'"))
out += frame("S", back, Y, X, minus(Z), 0.2, (-6, -14), axes=False)
out.append(line(back, hand, "stroke='#999' stroke-dasharray='2 3'"))
out.append(text(back, "station 2, worn on the hand", (12, -14), "fill='#777' font-size='11'"))
display = (-0.42, -0.72, 1.64)
out += frame("D", display, X, Z, minus(Y), 0.28, (10, 20))
out += frame("H", hand, X, Z, minus(Y), 0.3, (12, 20))
ball = (0.34, -0.5, 0.98)
out.insert(-20, circle(add(ball, (0, 0, 0)), 0.1085, "fill='#9db8d9' stroke='#5a7fb0'"))
out.append(text(ball, "B", (-4, 5), "font-weight='bold' font-size='13'"))

# Beside it: the eyes, large.
out.append("<g transform='translate(640,24)'>"
           "<rect width='290' height='150' fill='#fafafa' stroke='#ddd'/>"
           "<text x='12' y='20' font-weight='bold'>Display and eyes, from behind</text>")
for name, x in (("L", 75), ("D", 130), ("R", 185)):
    y = 100
    out.append(f"<line x1='{x}' y1='{y}' x2='{x + 32}' y2='{y}' stroke='{COLOURS['x']}' "
               "stroke-width='2' marker-end='url(#x)'/>"
               f"<line x1='{x}' y1='{y}' x2='{x}' y2='{y - 32}' stroke='{COLOURS['y']}' "
               "stroke-width='2' marker-end='url(#y)'/>"
               f"<circle cx='{x}' cy='{y}' r='5' fill='white' stroke='{COLOURS['z']}' "
               f"stroke-width='2'/><circle cx='{x}' cy='{y}' r='1.5' fill='{COLOURS['z']}'/>"
               f"<text x='{x - 5}' y='{y + 22}' font-weight='bold' font-size='15'>{name}</text>")
out.append("<text x='12' y='142' font-size='11' fill='#777'>z towards you: each looks along -z; "
           "L to R 64 mm</text></g>")

# What the letters are.
for i, (letter, says) in enumerate((
        ("W", "world: middle of the foul line, on the lane"),
        ("T", "the tracker's transmitter"),
        ("S", "a receiver; a sample is X_TS"),
        ("D", "display, between the eyes L and R"),
        ("H", "virtual hand: palm down, fingers along -z"),
        ("B", "a body, at its centre of mass"))):
    y = 440 + 20 * i
    out.append(f"<text x='640' y='{y}' font-weight='bold'>{letter}</text>"
               f"<text x='663' y='{y}'>{says}</text>")
out.append("<text x='640' y='572' fill='#c0392b'>x</text><text x='655' y='572' fill='#2e8b57'>y</text>"
           "<text x='670' y='572' fill='#1f5fb4'>z</text>"
           "<text x='687' y='572' fill='#777'>axes; right-handed, metres</text>")
out.append("</svg>")
print("\n".join(out))
