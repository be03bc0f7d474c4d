#!/usr/bin/env python3
"""Plots what `brace bench scaling --json` found: scaling_plots.py RESULT.json... FOLDER writes
FOLDER/scaling.png. Several results (of single parts) are put together. Needs `apt install python3-matplotlib`.
"""
import io
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, NullFormatter
from PIL import Image

COLOURS = {"cast/native": "#1b6ca8", "cast/dvr": "#c8553d", "cast/dvr, packed": "#c8553d",
           "cast/dvr, sampler": "#8a8d3c"}
LINES = {"T": "-", "S": "--"}
MARKS = {"T": "o", "S": "s"}


def style(renderer, transfer):
    return {"color": COLOURS[renderer], "linestyle": LINES[transfer], "marker": MARKS[transfer],
            "markersize": 4, "linewidth": 1.4}


def sample_ns(row):
    """CPU time of all threads where the work is done on the CPU: a busy machine changes it less."""
    return row["cpu_ns_per_sample"] or row["ns_per_sample"]


def unique(values):
    return list(dict.fromkeys(values))


def log_axis(axis, ticks, text=lambda value: f"{value:g}"):
    axis.set_ticks(ticks)
    axis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))
    axis.set_minor_formatter(NullFormatter())


def plot_threads(axes, result):
    counts = result["thread_counts"]
    pictures = unique((row["width_px"], row["height_px"]) for row in result["threads"])
    for picture, colour in zip(pictures, ["#1b6ca8", "#c8553d", "#5b8c5a"]):
        for skips in (False, True):
            rows = [row for row in result["threads"]
                    if (row["width_px"], row["height_px"]) == picture and row["skips"] == skips]
            worst = [min(values) for values in zip(*(row["speed_ups_counted"] for row in rows))]
            axes.plot(counts, [100 * value / count for value, count in zip(worst, counts)], color=colour,
                      linestyle="--" if skips else "-", marker="o", markersize=3, linewidth=1.4,
                      label=f"{picture[0]}×{picture[1]}" + (", distance map" if skips else ""))
    axes.set_xscale("log", base=2)
    log_axis(axes.xaxis, counts)
    axes.set_ylim(0, 105)
    axes.set_title("Threads: cast/native, simulated from tiles by counted work")
    axes.set_xlabel("threads")
    axes.set_ylabel("speed-up / threads, % (worse of T and S)")
    axes.legend(fontsize=7, loc="lower left")


def plot_image(axes, result):
    for renderer in unique(row["renderer"] for row in result["image"]):
        for transfer in ("T", "S"):
            rows = [row for row in result["image"]
                    if row["renderer"] == renderer and row["transfer"] == transfer and not row["skips"]]
            axes.plot([row["edge_px"] for row in rows], [sample_ns(row) for row in rows],
                      label=f"{renderer}, {transfer}", **style(renderer, transfer))
    axes.set_xscale("log", base=2)
    log_axis(axes.xaxis, unique(row["edge_px"] for row in result["image"]))
    axes.set_ylim(bottom=0)
    axes.set_title(f"Picture, volume {result['edge_voxels']}³")
    axes.set_xlabel("edge of the picture, pixels")
    axes.set_ylabel("CPU time per sample, ns")
    axes.legend(fontsize=7)


def volume_edge(row):
    dims = row["dims"]
    return (dims[0] * dims[1] * dims[2]) ** (1 / 3)


def plot_volume(axes, result):
    for renderer in unique(row["renderer"] for row in result["volume"]):
        for transfer in ("T", "S"):
            rows = [row for row in result["volume"]
                    if row["renderer"] == renderer and row["transfer"] == transfer]
            for same in (False, True):
                line = [row for row in rows if row["same_distance"] == same]
                look = style(renderer, transfer)
                if same:
                    look.update(linewidth=0.8, alpha=0.55, markersize=2.5)
                axes.plot([volume_edge(row) for row in line], [sample_ns(row) for row in line],
                          label=None if same else f"{renderer}, {transfer}", **look)
    axes.plot([], [], color="0.4", linewidth=0.8, alpha=0.55, label="thin: picture grows with it")
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    dims = unique(tuple(row["dims"]) for row in result["volume"])
    edges = [round((d[0] * d[1] * d[2]) ** (1 / 3)) for d in dims]
    names = {edge: f"{d[0]}³" if len(set(d)) == 1 else f"{d[0]}×{d[1]}\n×{d[2]}" for edge, d in zip(edges, dims)}
    # Labels too near each other would overlap: the cube of 512 gives way to the box beside it.
    shown = [edge for k, edge in enumerate(edges) if k + 1 == len(edges) or edges[k + 1] / edge > 1.2]
    log_axis(axes.xaxis, shown, lambda value: names.get(round(value), ""))
    axes.set_ylim(top=3 * axes.get_ylim()[1])  # room for the legend
    low, high = axes.get_ylim()
    log_axis(axes.yaxis, [tick for tick in (0.5, 1, 2, 3, 5, 10, 20, 30, 50) if low <= tick <= high])
    axes.set_title(f"Volume, {result['size_px']}² pixels")
    axes.set_xlabel("voxels")
    axes.set_ylabel("CPU time per sample, ns")
    axes.legend(fontsize=7, ncols=2, loc="upper left")


def plot_empty(axes, result):
    for renderer in unique(row["renderer"] for row in result["empty"]):
        for transfer in ("T", "S"):
            rows = [row for row in result["empty"]
                    if row["renderer"] == renderer and row["transfer"] == transfer]
            axes.plot([100 * row["empty_ratio"] for row in rows], [row["ratio"] for row in rows],
                      label=f"{renderer}, {transfer}", **style(renderer, transfer))
    axes.axhline(1, color="0.7", linewidth=1)
    axes.set_ylim(bottom=0)
    axes.set_title(f"Empty share, volume {result['edge_voxels']}³, {result['size_px']}² pixels")
    axes.set_xlabel("voxels that are invisible, %")
    axes.set_ylabel("time with a distance map / without")
    axes.legend(fontsize=7)


def read(files):
    result = {}
    for file in files:
        for key, value in json.loads(pathlib.Path(file).read_text(encoding="utf-8")).items():
            if value not in ([], None) or key not in result:
                result[key] = value
    return result


def main(files, folder):
    result = read(files)
    plt.rcParams.update({"font.size": 8.5, "axes.titlesize": 9.5, "axes.spines.top": False,
                         "axes.spines.right": False, "axes.grid": True, "grid.color": "0.92",
                         "legend.frameon": False})
    figure, axes = plt.subplots(2, 2, figsize=(9, 7.2), layout="constrained")
    for place, (part, plot) in zip(axes.flat, {"threads": plot_threads, "image": plot_image,
                                               "volume": plot_volume, "empty": plot_empty}.items()):
        if result.get(part):
            plot(place, result)
        else:
            place.set_axis_off()
    picture = io.BytesIO()
    figure.savefig(picture, dpi=110)
    # 64 colours do, and take a third of the bytes.
    Image.open(picture).convert("RGB").quantize(64).save(pathlib.Path(folder) / "scaling.png", optimize=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1:-1], sys.argv[-1])
