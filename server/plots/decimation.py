"""Fewer points with the same picture: the extremes of every bucket stay.

An engineer reads peaks off a curve, so a decimated curve must keep every one of them.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import IntVector, Vector

__all__ = ["extreme_indices"]


def extreme_indices(values: Vector, points: int) -> IntVector:
    """Indices of at most ``points`` values that draw the same curve.

    The history is cut into buckets; each hands on its least and its greatest value, in the order
    in which they occur. The first and the last value always stay.

    Args:
        values: The history, shape (n,). Values that are not numbers never win a bucket.
        points: Greatest number of indices, at least 4.

    Returns:
        Ascending indices without repetition, shape (at most points,).
    """
    n_value = values.size
    if n_value <= points:
        return np.arange(n_value, dtype=np.int64)
    n_bucket = (points - 2) // 2
    edges = np.linspace(0, n_value, n_bucket + 1).astype(np.int64)
    finite = np.isfinite(values)
    lowest = _bucket_positions(np.where(finite, values, np.inf), edges, np.minimum)
    highest = _bucket_positions(np.where(finite, values, -np.inf), edges, np.maximum)
    ends = np.array([0, n_value - 1], dtype=np.int64)
    return np.unique(np.concatenate([ends, lowest, highest]))


def _bucket_positions(values: Vector, edges: IntVector, extreme: np.ufunc) -> IntVector:
    """First index of the extreme value in each bucket."""
    per_bucket = extreme.reduceat(values, edges[:-1])
    wanted = np.repeat(per_bucket, np.diff(edges))
    hits = np.flatnonzero(values == wanted)
    bucket = np.searchsorted(edges, hits, side="right") - 1
    _, first = np.unique(bucket, return_index=True)
    return hits[first].astype(np.int64)
