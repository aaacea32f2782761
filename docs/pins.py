"""Draws the picture of docs/pins.md from the CSV file of `./dev check pins`.

Run: python3 docs/pins.py out/pins.csv assets/pictures/pins.svg
"""

import csv
import sys

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "pins"
matplotlib.rcParams["svg.fonttype"] = "none"
import matplotlib.pyplot as plt


def read(path):
    """The cells of each condition, in the file's order."""
    maps = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            key = (row["response"], float(row["elasticity"]), float(row["friction"]))
            maps.setdefault(key, []).append(row)
    return maps


def draw(axes, key, cells):
    boards = sorted({float(c["board"]) for c in cells})
    angles = sorted({float(c["angle_deg"]) for c in cells})
    share = [[0.0] * len(boards) for _ in angles]
    for c in cells:
        row, column = angles.index(float(c["angle_deg"])), boards.index(float(c["board"]))
        share[row][column] = 100.0 * int(c["strikes"]) / int(c["throws"])
    axes.imshow(share, origin="lower", cmap="viridis", vmin=0, vmax=100, aspect="auto")
    for row, line in enumerate(share):
        for column, value in enumerate(line):
            axes.text(column, row, f"{value:.0f}", ha="center", va="center", fontsize=7,
                      color="black" if value > 60 else "white")
    pocket = [boards.index(17.0) - 0.5, angles.index(4.0) - 0.5]
    axes.add_patch(plt.Rectangle(pocket, 3, 2, fill=False, edgecolor="red", linewidth=1.5))
    axes.set_xticks(range(0, len(boards), 2), [f"{b:g}" for b in boards[::2]])
    axes.set_yticks(range(len(angles)), [f"{a:g}°" for a in angles])
    response, elasticity, friction = key
    axes.set_title(f"{response}, pair: elasticity {elasticity**2:.2f}, friction {friction**2:.2f}",
                   fontsize=9)


def main():
    maps = read(sys.argv[1])
    figure, all_axes = plt.subplots(2, 2, figsize=(9, 5.2), sharex=True, sharey=True)
    for axes, (key, cells) in zip(all_axes.flat, maps.items()):
        draw(axes, key, cells)
    for axes in all_axes[1]:
        axes.set_xlabel("board at the head pin (20: middle)")
    for axes in all_axes[:, 0]:
        axes.set_ylabel("entry angle")
    figure.suptitle("Strikes of 100 throws; red: the pocket of the USBC's carry study", fontsize=10)
    figure.tight_layout()
    figure.savefig(sys.argv[2], metadata={"Date": None})


main()
