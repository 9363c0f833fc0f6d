"""What energy models of drives have in common (skid_model.py, four_wheel_model.py)."""
from dataclasses import dataclass, fields, replace

import numpy as np


class Parameters:
    """A frozen dataclass of numbers."""

    def with_values(self, names, values):
        return replace(self, **dict(zip(names, values)))


@dataclass(frozen=True)
class Pieces:
    """Arrays whose last axis is the pieces; `group` numbers what is summed up."""
    seconds: np.ndarray
    energy: np.ndarray  # measured, J
    group: np.ndarray

    def chosen(self, which):
        """The pieces that are chosen, their groups numbered anew."""
        parts = {field.name: getattr(self, field.name)[..., which] for field in fields(self)}
        return replace(self, **{**parts, "group": np.unique(parts["group"], return_inverse=True)[1]})

    def by_group(self, values):
        return np.bincount(self.group, values)


def ratio(a, b):
    """0 where b is."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0)
