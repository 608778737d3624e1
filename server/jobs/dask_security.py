"""Which schedulers of Dask may be used, and their certificates.

Whoever reaches a scheduler's port can run any code on its workers. Without TLS it is used on this
machine only, unless a setting says otherwise.
"""

from __future__ import annotations

from pathlib import Path

from distributed.security import Security

from server.jobs.engine import EngineError
from server.settings import Settings
from server.settings.addresses import is_loopback, scheduler_address

__all__ = ["scheduler_security", "settings_security", "write_certificate"]


def scheduler_security(url: str, settings: Settings) -> Security | None:
    """What a connection to a scheduler needs, by its address; None for no encryption.

    Raises:
        EngineError: The address is none, is unsafe, or its certificates are missing.
    """
    address = scheduler_address(url)
    if address is None:
        raise EngineError(
            f"{url} is not the address of a Dask scheduler. Write tls://HOST:PORT or "
            "tcp://HOST:PORT."
        )
    scheme, host, _ = address
    if scheme == "tls":
        return settings_security(settings)
    if not is_loopback(host) and not settings.allow_insecure_scheduler:
        raise EngineError(
            f"The scheduler {url} has no TLS: everyone who reaches its port could run any code on "
            "every worker. Use a tls:// address with tls_ca_file, tls_cert_file and tls_key_file, "
            "or, on a network that you trust entirely, set allow_insecure_scheduler."
        )
    return None


def settings_security(settings: Settings) -> Security:
    """The certificates of the settings, encryption required.

    Raises:
        EngineError: One of the three files is not set or cannot be read.
    """
    names = ("tls_ca_file", "tls_cert_file", "tls_key_file")
    files: list[str] = []
    for name in names:
        path: Path | None = getattr(settings, name)
        if path is None:
            raise EngineError(
                f"A tls:// scheduler needs the setting {name}. Set tls_ca_file, tls_cert_file and "
                "tls_key_file to files in PEM format."
            )
        if not path.is_file():
            raise EngineError(f"The file {path} of the setting {name} is not there. Correct it.")
        files.append(str(path))
    return _security(*files)


def write_certificate(folder: Path) -> Security:
    """A new certificate in files that only this user can read, for nodes that share the disk.

    Args:
        folder: Where ``ca.pem``, ``cert.pem`` and ``key.pem`` go; what is there is replaced.
    """
    made = Security.temporary()
    contents = {
        "ca.pem": made.tls_ca_file,
        "cert.pem": made.tls_worker_cert,
        "key.pem": made.tls_worker_key,
    }
    for name, text in contents.items():
        path = folder / name
        path.unlink(missing_ok=True)
        path.touch(mode=0o600)
        path.write_text(str(text), encoding="ascii")
    return _security(*(str(folder / name) for name in contents))


def _security(authority: str, certificate: str, key: str) -> Security:
    """The same files for every part that a process may play, encryption required."""
    parts = ("client", "worker", "scheduler")
    return Security(
        require_encryption=True,
        tls_ca_file=authority,
        **{f"tls_{part}_cert": certificate for part in parts},
        **{f"tls_{part}_key": key for part in parts},
    )
