"""The picture of an identification from logs: constants against the file, energies against what was drawn."""
import numpy as np

from tools.report import plots

SURE = 1.96  # deviations, of 95 %


def _constants(axes, constants):
    told = [one for one in constants if one.is_told and one.file > 0][::-1]
    places = np.arange(len(told))
    axes.axvline(0, color=plots.GREY, linewidth=0.8)
    axes.errorbar([one.change for one in told], places,
                  xerr=[100 * SURE * one.deviation / one.file for one in told], fmt="o", color=plots.BLUE, markersize=4,
                  capsize=2)
    axes.set_yticks(places, [one.key for one in told])
    axes.set_xlabel("fitted against file, %, with 95 %")
    axes.set_title("Constants")


def _energies(axes, segments):
    places = np.arange(1, len(segments) + 1)
    for name, label, colour in (("by_file", "by the file", plots.ORANGE), ("by_fit", "as fitted", plots.GREEN)):
        off = [100 * (getattr(segment, name) / segment.logged - 1) for segment in segments]
        axes.plot(places, off, "o", color=colour, label=label, markersize=4)
    axes.axhline(0, color=plots.GREY, linewidth=0.8)
    axes.set_xlabel("segment")
    axes.set_ylabel("energy against what was drawn, %")
    axes.set_title("Energy of the motion as driven")
    if segments:
        axes.legend()


def picture(name, constants, segments):
    """PNG."""
    figure, (left, right) = plots.new_figure(11, 4.5, 1, 2)
    _constants(left, constants)
    _energies(right, segments)
    figure.suptitle(f"{name}: logs against robot file")
    return plots.png_bytes(figure)
