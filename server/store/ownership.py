"""One database a store: nobody else knows which of its runs are needed."""

from __future__ import annotations

from server.store.database import Database
from server.store.failures import PlaceError
from server.store.place import Place

__all__ = ["OWNER", "claim_store"]

OWNER = "OWNER"
"""Document in the store's root: the installation whose database speaks of the files below."""


def claim_store(store: Place, database: Database) -> None:
    """Makes sure that a store belongs to a database; one that belongs to none does from now on.

    So the store of an earlier version, which has runs and no owner, is taken over.

    Args:
        store: The store.
        database: The database.

    Raises:
        PlaceError: It belongs to another database.
        StoreError: It cannot be read or written.
    """
    installation = database.installation().encode()
    found = store.read(OWNER)
    if found is None:
        if store.create(OWNER, installation):
            return
        found = store.read(OWNER)
    if found != installation:
        raise PlaceError(
            f"The store {store.url} belongs to another database. Name that one with --database or "
            "--data, or give another --store. If it is gone for good, remove the document "
            f"{OWNER} from the store: this database takes it over, and `trainbridge clean` then "
            "removes what only the other one knew."
        )
