"""A place in an object store: one object a document, one object a shard."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import timedelta
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import obstore
from obstore.exceptions import AlreadyExistsError
from obstore.store import from_url
from zarr.storage import ObjectStore, StorePath

from server.store.failures import PlaceError, StoreError, explained
from server.store.local_place import checked_name, is_shard

__all__ = ["ObjectPlace"]

_LOOPBACK = ("127.0.0.1", "::1", "localhost")
_AWS_SCHEMES = ("s3", "s3a")
_RETRY_SECONDS = 20.0
"""A store that is away for longer than this fails the job, which then can be retried. [s]"""


@dataclass(frozen=True)
class ObjectPlace:
    """A prefix in a bucket. Implements ``Place``.

    Attributes:
        root: URL of the bucket.
        prefix: Names below it, joined by slashes.
    """

    root: str
    prefix: str = ""

    @staticmethod
    def of(url: str) -> ObjectPlace:
        """The place of a URL.

        Raises:
            PlaceError: It names no bucket.
        """
        parts = urlsplit(url)
        names = [name for name in parts.path.split("/") if name]
        if not parts.netloc or parts.query or parts.fragment or ".." in names:
            raise PlaceError(f"{url[:80]!r} names no bucket. Give s3://bucket/prefix.")
        root = f"{parts.scheme.lower()}://{parts.netloc}"
        if parts.scheme.lower() not in (*_AWS_SCHEMES, "gs") and names:
            root, names = f"{root}/{names[0]}", names[1:]  # az://account/container
        return ObjectPlace(root, "/".join(names))

    @property
    def url(self) -> str:
        """As ``open_place`` takes it."""
        return f"{self.root}/{self.prefix}" if self.prefix else self.root

    @property
    def local(self) -> Path | None:
        """None: it is no folder."""
        return None

    def child(self, *names: str) -> ObjectPlace:
        """The prefix below this one."""
        return ObjectPlace(self.root, "/".join([*self._parts(), *map(checked_name, names)]))

    def read(self, name: str) -> bytes | None:
        """An object's content, None where there is none."""
        with explained(self.url):
            try:
                return bytes(obstore.get(self._client, self._key(name)).bytes())
            except FileNotFoundError as error:
                self._refuse_missing_bucket(error)
                return None

    def write(self, name: str, data: bytes) -> None:
        """Puts an object; object stores replace whole objects."""
        with explained(self.url):
            try:
                obstore.put(self._client, self._key(name), data)
            except FileNotFoundError as error:
                raise self._missing_bucket() from error

    def create(self, name: str, data: bytes) -> bool:
        """Puts an object unless it exists (``If-None-Match``)."""
        with explained(self.url):
            try:
                obstore.put(self._client, self._key(name), data, mode="create", use_multipart=False)
            except AlreadyExistsError:
                return False
            except FileNotFoundError as error:
                raise self._missing_bucket() from error
            return True

    def exists(self, name: str) -> bool:
        """Whether there is an object of this name."""
        with explained(self.url):
            try:
                obstore.head(self._client, self._key(name))
            except FileNotFoundError:
                return False
            return True

    def names(self) -> list[str]:
        """Objects and prefixes directly below."""
        with explained(self.url):
            found = obstore.list_with_delimiter(self._client, self.prefix or None)
        paths = [*found["common_prefixes"], *(item["path"] for item in found["objects"])]
        below = len(self._parts())
        names = [path.strip("/").split("/") for path in paths]
        return sorted({parts[below] for parts in names if len(parts) > below})

    def remove(self, name: str | None = None) -> None:
        """Removes an object and everything below its name, or everything below this place."""
        place = self if name is None else self.child(name)
        keys = [str(item["path"]) for item in place._objects()]
        if name is not None:
            keys.append(place.prefix)
        with explained(self.url):
            for start in range(0, len(keys), 1000):  # as many as one request takes
                try:
                    obstore.delete(self._client, keys[start : start + 1000])
                except FileNotFoundError:
                    continue

    def size(self) -> int:
        """Everything below. [B]"""
        return sum(int(item["size"]) for item in self._objects())

    def copy(self, source: Any, name: str) -> None:
        """Copies an object, inside the store where both places lie in one."""
        if isinstance(source, ObjectPlace) and source.root == self.root:
            with explained(self.url):
                obstore.copy(self._client, source._key(name), self._key(name))
            return
        data = source.read(name)
        if data is None:
            raise FileNotFoundError(f"{source.url}/{name}")
        self.write(name, data)

    def sync(self, store: Any) -> None:
        """Nothing is left to do: an object that was put is stored."""

    def zarr(self, name: str, *, read_only: bool) -> Any:
        """A Zarr store below this place."""
        kind = _ReadingObjects if read_only else ObjectStore
        return StorePath(kind(self._client, read_only=read_only), self._key(name))

    @property
    def _client(self) -> Any:
        settings = {key: value for key, value in os.environ.items() if key.startswith("AWS_")}
        return _client(self.root, tuple(sorted(settings.items())))

    def _parts(self) -> list[str]:
        return self.prefix.split("/") if self.prefix else []

    def _key(self, name: str) -> str:
        return self.child(name).prefix

    def _objects(self) -> list[Any]:
        # Object stores list by path component: "a" finds "a/b" but not "ab".
        with explained(self.url):
            return list(obstore.list(self._client, self.prefix or None).collect())

    def _refuse_missing_bucket(self, error: FileNotFoundError) -> None:
        """A read tells a missing bucket from a missing object by its text only."""
        if "NoSuchBucket" in str(error):
            raise self._missing_bucket() from error

    def _missing_bucket(self) -> StoreError:
        return StoreError(
            f"There is no bucket at {self.root}. Create it, or give another store; then retry."
        )


class _ReadingObjects(ObjectStore[Any]):
    """Zarr's object store, for which a shard that is missing is an error."""

    async def get(self, key: str, prototype: Any, byte_range: Any = None) -> Any:
        found = await super().get(key, prototype, byte_range)
        if found is None and is_shard(key):
            raise FileNotFoundError(key)
        return found


@lru_cache(maxsize=8)
def _client(root: str, environment: tuple[tuple[str, str], ...]) -> Any:
    """One client a bucket, so that its connections are used again."""
    settings = dict(environment)
    options: Any = {"timeout": "60s", "connect_timeout": "5s"}
    config: Any = {}
    if urlsplit(root).scheme in _AWS_SCHEMES:
        endpoint = settings.get("AWS_ENDPOINT_URL") or settings.get("AWS_ENDPOINT") or ""
        # Our options replace those that the client would take from the environment.
        if settings.get("AWS_ALLOW_HTTP", "").lower() == "true":
            options["allow_http"] = True
        if urlsplit(endpoint).hostname in _LOOPBACK:
            options["allow_http"] = True
            options["proxy_excludes"] = ",".join(_LOOPBACK)
        if not {"AWS_REGION", "AWS_DEFAULT_REGION"} & set(settings):
            config["region"] = "us-east-1"
    try:
        return from_url(
            root,
            config=config,
            client_options=options,
            retry_config={
                "max_retries": 5,
                "retry_timeout": timedelta(seconds=_RETRY_SECONDS),
            },
        )
    except Exception as error:
        raise PlaceError(
            f"The object store at {root} cannot be used ({str(error).splitlines()[0][:200]}). "
            "Check the AWS_* variables of the environment."
        ) from error
