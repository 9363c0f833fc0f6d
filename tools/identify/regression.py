"""Least squares whose uncertainty holds for residuals that go together: smoothed noise, and what a model leaves out."""
from dataclasses import dataclass

import numpy as np

from tools.common import ToolError

BLOCK_WIDTHS = 40  # of the filter: residuals of different blocks are independent
BLOCKS_MIN = 6
RANK_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Estimate:
    values: np.ndarray
    covariance: np.ndarray
    residuals: np.ndarray

    def deviation(self, index):
        return float(np.sqrt(self.covariance[index, index]))


def is_enough(blocks):
    """For an uncertainty."""
    return len(np.unique(blocks)) >= BLOCKS_MIN


def projected(matrix, onto):
    """What the instruments explain of the columns; a matrix of these for each equal part of the rows."""
    parts = []
    for rows, instruments in zip(np.split(matrix, len(onto)), onto):
        basis, size, _ = np.linalg.svd(instruments / np.maximum(np.linalg.norm(instruments, axis=0), 1e-300),
                                       full_matrices=False)
        basis = basis[:, size > RANK_TOLERANCE * size[0]]
        parts.append(basis @ (basis.T @ rows))
    return np.vstack(parts)


def fit(source, matrix, target, blocks, names, instruments=None):
    """Rows of one block go together. Instruments have no part in the noise of the columns, which else would make what
    is sought too small: only what they explain of the columns counts. ToolError names a column that the log does not
    tell from the others."""
    scale = np.linalg.norm(matrix, axis=0)
    empty = [name for name, size in zip(names, scale) if size == 0]
    if empty:
        raise ToolError(f"{source}: nothing in it tells {empty[0]}; drive with turns and changes of speed "
                        "(python -m tools.operate.excite)")
    if not is_enough(blocks):
        raise ToolError(f"{source}: too short to tell how certain it is; log {BLOCKS_MIN} times as long")
    scaled = matrix / scale
    explained = scaled if instruments is None else projected(scaled, instruments)
    if np.linalg.matrix_rank(explained, RANK_TOLERANCE) < len(names):
        raise ToolError(f"{source}: the log does not tell {', '.join(names[:7])} apart; drive with turns and changes "
                        "of speed (python -m tools.operate.excite)")
    bread = np.linalg.inv(explained.T @ scaled)
    values = bread @ (explained.T @ target)
    residuals = target - scaled @ values
    count = len(np.unique(blocks))
    scores = np.zeros((blocks.max() + 1, len(names)))
    np.add.at(scores, blocks, explained * residuals[:, None])
    meat = scores.T @ scores * count / (count - 1) * (len(target) - 1) / max(len(target) - len(names), 1)
    covariance = bread @ meat @ bread.T
    return Estimate(values / scale, covariance / np.outer(scale, scale), residuals)


def blocks_of(times, width):
    """The block of each time."""
    return np.unique(((times - times[0]) / (BLOCK_WIDTHS * width)).astype(int), return_inverse=True)[1]
