"""Common look of the figures."""
import base64
import io

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# Okabe and Ito's palette: told apart by colour-blind readers too.
BLUE, ORANGE, GREEN, PURPLE, AMBER, RED = "#0072B2", "#D55E00", "#009E73", "#AA4499", "#E69F00", "#882255"
GREY, INK = "#8A94A0", "#1F2933"

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 10, "text.color": INK,
    "axes.edgecolor": "#B8C0C8", "axes.labelcolor": INK, "axes.titlesize": 11, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "axes.axisbelow": True, "grid.color": "#E4E8EC", "grid.linewidth": 0.8, "xtick.color": "#52606D",
    "ytick.color": "#52606D", "lines.linewidth": 1.6, "legend.frameon": False, "legend.fontsize": 9,
    "svg.hashsalt": "joulepath", "figure.constrained_layout.use": True,
})


def new_figure(width, height, rows=1, columns=1, **options):
    return plt.subplots(rows, columns, figsize=(width, height), **options)


def png_bytes(figure, dpi=150):
    """The figure as PNG without a date or version, so that equal data give equal bytes; closes it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    plt.close(figure)
    return buffer.getvalue()


def inline_png(figure, dpi=150):
    """The figure as a data URI; closes it."""
    return data_uri(png_bytes(figure, dpi))


def data_uri(png):
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


def spans_of(times, holds):
    """(from, until) of the runs of samples for which it holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(int)))
    return [(times[first], times[min(end, len(times) - 1)]) for first, end in zip(edges[::2], edges[1::2])]
