"""Whether the disk that jobs may take together has room for one more."""

from __future__ import annotations

from server.errors import Finding, Problem
from server.routes.service import Service
from server.store import used_bytes

__all__ = ["require_room"]


def require_room(service: Service, disk_bytes: float) -> None:
    """Refuses a job that would go beyond the quota.

    What is stored and what accepted jobs may still store count both: what a running job has
    written already counts twice until it ends.

    Args:
        service: Knows the quota, the store and the jobs.
        disk_bytes: What the job is expected to store. [B]

    Raises:
        Problem: 507, with the amounts and how to make room.
    """
    quota = service.settings.quota_bytes
    if not quota:
        return
    used = used_bytes(service.store)
    reserved = service.database.reserved_bytes()
    if used + reserved + disk_bytes <= quota:
        return
    finding = Finding(
        pointer="/study/outputs",
        value=_amount(disk_bytes),
        reason=(
            f"does not fit: results take {_amount(used)} and jobs that have not ended may need "
            f"{_amount(reserved)} of the {_amount(quota)} that this server may use (quota_bytes)"
        ),
        remedy=(
            "Delete jobs that are no longer needed, run `trainbridge clean`, store fewer channels "
            "or frames, or raise quota_bytes"
        ),
    )
    raise Problem(
        507, "No room left", f"The job's {finding.value} {finding.reason}.", errors=[finding]
    )


def _amount(size: float) -> str:
    for unit, scale in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= scale:
            return f"{size / scale:.3g} {unit}"
    return f"{size:.0f} B"
