"""The 3D view of a run that was stopped, through the whole server."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.server.server_case import beam_study, ended, serving, settings_for, submit, until


@pytest.mark.slow
def test_what_a_cancelled_run_left_plays_to_its_end_and_rests(tmp_path: Path) -> None:
    """No more will come: a view that waited for it would stream for ever."""
    study = beam_study(integration={"time_step": 2e-6}, outputs={"frame_interval": 2e-4})
    with serving(settings_for(tmp_path)) as client:
        job = submit(client, study)["id"]
        run = client.json(f"jobs/{job}")["runs"][0]["id"]
        frames = f"/api/v1/runs/{run}/frames"
        until(lambda: client.get(frames), lambda it: it.is_success and it.json()["items"])
        client.post(f"/api/v1/jobs/{job}/cancel")
        assert ended(client, job)["state"] == "cancelled"
        # That is written at once; its process may store some more until it has ended.
        until(lambda: client.app.state.coordinator.process_ids, lambda left: not left)
        view = client.post(f"/api/v1/runs/{run}/viewer").json()["session"]
        last = client.json(f"viewer/{view}")["last_time"]
        client.put(f"/api/v1/viewer/{view}", json={"time": 0.0, "rate": 1.0, "playing": True})
        shown = until(lambda: client.json(f"viewer/{view}"), lambda it: not it["playing"])
        assert shown["time"] == pytest.approx(last)
        client.delete(f"/api/v1/viewer/{view}")
