"""What the runs of a sweep share, in the store: prepared once, also across machines."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from numpy.typing import NDArray

from server.store.failures import StoreError
from server.store.layout import DONE
from server.store.packing import pack, unpack
from server.store.place import Place

__all__ = ["ModelStore"]

_log = logging.getLogger("trainbridge.store")


class ModelStore:
    """Prepared arrays under a model's key. Implements ``solver.arrays.Cache``.

    Every name is one object with a digest, so that whoever loads it gets all of what was saved or
    nothing; two workers that prepare the same model save the same.
    """

    def __init__(self, place: Place) -> None:
        """Opens nothing yet.

        Args:
            place: ``model_place(store, key)``.
        """
        self.place = place

    def load(self, name: str) -> Mapping[str, NDArray[Any]] | None:
        """The arrays of a name; None where they are missing, damaged or cannot be read."""
        try:
            found = unpack(self.place.read(_object(name)))
        except StoreError as error:
            # Whoever asks can make them; a run shall not fail for want of what saves time.
            _log.warning("the prepared model's %s is made anew: %s", name, error)
            return None
        return None if found is None else found[0]

    def save(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Stores the arrays of a name.

        Raises:
            ValueError: An array holds Python objects.
            StoreError: The store cannot be written.
        """
        self.place.write(_object(name), pack(arrays))

    def complete(self) -> bool:
        """Whether everything that the runs share is there."""
        return self.place.exists(DONE)

    def finish(self) -> None:
        """Marks the model as complete; to be called last."""
        self.place.write(DONE, b"")

    def remove(self) -> None:
        """Removes the model, its mark first: a part of it never looks complete."""
        self.place.remove(DONE)
        self.place.remove()


def _object(name: str) -> str:
    return f"{quote(name, safe='')}.arrays"
