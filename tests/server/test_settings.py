"""Settings: which source wins, and what is said of every value that cannot be used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from server.settings import Settings, SettingsError, read_settings
from server.settings.addresses import without_secrets
from server.store import Database

TOKEN = "correct horse battery staple"


def read(folder: Path, environment: dict[str, str] | None = None, **parts: Any) -> Any:
    return read_settings(environment or {}, folder=folder, **parts)


def write(folder: Path, text: str, name: str = "trainbridge.toml") -> Path:
    file = folder / name
    file.write_text(text)
    return file


def test_the_strongest_source_wins(tmp_path: Path) -> None:
    write(
        tmp_path,
        "port = 1\nslurm_jobs = 2\nquota_bytes = 3\n[limits]\nruns_per_job = 4\nqueued_jobs = 5\n",
    )
    environment = {
        "TRAINBRIDGE_PORT": "11",
        "TRAINBRIDGE_SLURM_JOBS": "12",
        "TRAINBRIDGE_LIMITS_RUNS_PER_JOB": "14",
    }
    found = read(tmp_path, environment, overrides={"port": 21, "host": None})
    settings = found.settings
    assert (settings.port, settings.slurm_jobs, settings.quota_bytes) == (21, 12, 3)
    assert (settings.limits.runs_per_job, settings.limits.queued_jobs) == (14, 5)
    assert settings.host == "127.0.0.1"
    sources = {item.name: item.source for item in found.shown()}
    assert sources["port"] == "command line"
    assert sources["slurm_jobs"] == "variable TRAINBRIDGE_SLURM_JOBS"
    assert sources["limits.runs_per_job"] == "variable TRAINBRIDGE_LIMITS_RUNS_PER_JOB"
    assert sources["quota_bytes"] == f"file {tmp_path / 'trainbridge.toml'}"
    assert sources["host"] == "default"


def test_the_file_can_be_named(tmp_path: Path) -> None:
    write(tmp_path, "port = 1")
    other = write(tmp_path, "port = 2", "other.toml")
    third = write(tmp_path, "port = 3", "third.toml")
    named = {"TRAINBRIDGE_CONFIG": str(other)}
    assert read(tmp_path).settings.port == 1
    assert read(tmp_path, named).settings.port == 2
    assert read(tmp_path, named, config=third).settings.port == 3
    for missing in ({"config": tmp_path / "none.toml"}, {}):
        with pytest.raises(SettingsError, match=r"none\.toml cannot be read"):
            read(tmp_path, {"TRAINBRIDGE_CONFIG": str(tmp_path / "none.toml")}, **missing)
    with pytest.raises(SettingsError, match="is no TOML"):
        read(tmp_path, config=write(tmp_path, "port = = 1", "broken.toml"))


def test_every_kind_of_value_is_read_from_text(tmp_path: Path) -> None:
    environment = {
        "TRAINBRIDGE_COORDINATOR": "no",
        "TRAINBRIDGE_ALLOWED_HOSTS": "a.example.org, b.example.org",
        "TRAINBRIDGE_DATA": "somewhere",
        "TRAINBRIDGE_CHECKPOINT_SECONDS": "0.5",
        "TRAINBRIDGE_TLS_CA_FILE": "",
        "TRAINBRIDGE_ENGINE": "tcp://127.0.0.1:8786",
    }
    settings = read(tmp_path, environment).settings
    assert settings.coordinator is False
    assert settings.allowed_hosts == ("a.example.org", "b.example.org")
    assert settings.data == tmp_path / "somewhere"
    assert settings.checkpoint_seconds == 0.5
    assert settings.tls_ca_file is None
    assert settings.engine == "tcp://127.0.0.1:8786"


def test_database_and_store_lie_in_the_data_folder_unless_said_otherwise(tmp_path: Path) -> None:
    settings = read(tmp_path).settings
    assert settings.database_url == f"{tmp_path}/trainbridge-data/trainbridge.sqlite"
    assert settings.store_url == f"{tmp_path}/trainbridge-data"
    moved = read(
        tmp_path, overrides={"database": "postgresql://me@host/db", "store": "s3://bucket/x"}
    ).settings
    assert (moved.database_url, moved.store_url) == ("postgresql://me@host/db", "s3://bucket/x")


def test_a_store_folder_does_not_move_with_the_process(tmp_path: Path) -> None:
    assert read(tmp_path, {"TRAINBRIDGE_STORE": "runs"}).settings.store_url == f"{tmp_path}/runs"
    for fixed in ("/runs", "s3://bucket/runs"):
        assert read(tmp_path, overrides={"store": fixed}).settings.store_url == fixed


@pytest.mark.parametrize("name", ["what?", "part#2", "100%41"])
def test_a_data_folder_may_have_any_name(tmp_path: Path, name: str) -> None:
    settings = read(tmp_path, overrides={"data": Path(name)}).settings
    settings.data.mkdir()
    Database(settings.database_url).close()
    assert (tmp_path / name / "trainbridge.sqlite").is_file()


@pytest.mark.parametrize(
    ("variable", "value", "words"),
    [
        ("PORT", "eighty", "port = eighty .* is not a whole number"),
        ("PORT", "70000", "must lie between 0 and 65535"),
        ("CONCURRENT_BATCHES", "0", "concurrent_batches = 0 .* must be at least 1"),
        ("QUOTA_BYTES", "-1", "quota_bytes = -1 .* must be at least 0"),
        ("LIMITS_RUNS_PER_JOB", "-5", "limits.runs_per_job = -5 .* must be at least 1"),
        ("LIMITS_MEMORY_FRACTION", "1.5", "must be at most 1"),
        ("LIMITS_BATCH_SECONDS", "0", "must be greater than 0"),
        ("CHECKPOINT_SECONDS", "nan", "is not a finite number"),
        ("CHECKPOINT_SECONDS", "1e999", "is not a finite number"),
        ("RETENTION_DAYS", "-0.5", "must be at least 0"),
        ("COORDINATOR", "perhaps", "is neither true nor false"),
        ("ENGINE", "celery", "engine = celery .* is not an engine. Choose local"),
        ("ENGINE", "tcp://", "is not an engine"),
        ("ENGINE", "tcp://127.0.0.1", "is not an engine"),
        ("ENGINE", "http://127.0.0.1:8786", "is not an engine"),
        ("ENGINE", "tls://host:99999", "is not an engine"),
        ("ENGINE", "tcp://127.0.0.1:8786/path", "is not an engine"),
        ("DATABASE", "mysql://host/db", "is not a database that is supported"),
        ("SLURM_WALLTIME", "a day", "is not a time limit of Slurm"),
        ("SLURM_MEMORY", "8", "is not an amount of memory"),
    ],
)
def test_a_wrong_value_is_explained(tmp_path: Path, variable: str, value: str, words: str) -> None:
    with pytest.raises(SettingsError, match=words) as raised:
        read(tmp_path, {f"TRAINBRIDGE_{variable}": value})
    assert f"variable TRAINBRIDGE_{variable}" in str(raised.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("port = '80'", "port = 80 .* is not a whole number"),
        ("port = true", "is not a whole number"),
        ("port = 80.0", "is not a whole number"),
        ("coordinator = 1", "is neither true nor false"),
        ("engine = 5", "is not a text"),
        ("allowed_hosts = 'a'", "is not a list of texts"),
        ("allowed_hosts = [1]", "is not a list of texts"),
        ("data = 5", "is not the name of a file or folder"),
        ("limits = 5", "limits .* is not a setting"),
        ("[limits]\nrun_per_job = 3", "limits.run_per_job .* Did you mean limits.runs_per_job"),
        ("quota = 3", "quota .* is not a setting"),
        (f"token = '{TOKEN}'", "token .* does not belong into a settings file"),
    ],
)
def test_a_wrong_file_is_explained(tmp_path: Path, text: str, words: str) -> None:
    file = write(tmp_path, text)
    with pytest.raises(SettingsError, match=words) as raised:
        read(tmp_path)
    assert str(file) in str(raised.value)
    assert TOKEN not in str(raised.value)


def test_everything_wrong_is_said_at_once(tmp_path: Path) -> None:
    write(tmp_path, "prot = 80\nslurm_jobs = 0")
    with pytest.raises(SettingsError) as raised:
        read(tmp_path, {"TRAINBRIDGE_HOSTS": "x", "TRAINBRIDGE_PORT": "-1"})
    lines = str(raised.value).splitlines()
    assert len(lines) == 4
    assert any("Did you mean TRAINBRIDGE_HOST" in line for line in lines)


def test_what_others_own_in_the_environment_passes(tmp_path: Path) -> None:
    names = ("NO_SKIP", "SCREENSHOTS", "KILLS", "TOKEN", "SERVER", "CONFIG", "TEST_POSTGRESQL")
    environment = {f"TRAINBRIDGE_{name}": "" for name in names} | {"PATH": "/bin"}
    assert read(tmp_path, environment).settings.token == ""


def test_an_open_scheduler_is_refused(tmp_path: Path) -> None:
    open_one = {"engine": "tcp://10.1.2.3:8786"}
    with pytest.raises(SettingsError, match="runs whatever code anyone on the network sends"):
        read(tmp_path, overrides=open_one)
    allowed = read(tmp_path, overrides={**open_one, "allow_insecure_scheduler": True})
    assert allowed.settings.engine == "tcp://10.1.2.3:8786"
    for near in ("tcp://127.0.0.1:1", "tcp://localhost:1", "tcp://[::1]:1"):
        read(tmp_path, overrides={"engine": near})


def test_tls_needs_its_files(tmp_path: Path) -> None:
    names = ("tls_ca_file", "tls_cert_file", "tls_key_file")
    given: dict[str, Any] = {"engine": "tls://10.1.2.3:8786"}
    for name in names:
        with pytest.raises(SettingsError, match=f"{name} is not set"):
            read(tmp_path, overrides=given)
        given[name] = tmp_path / name
        with pytest.raises(SettingsError, match=rf"{name} = .* is not there"):
            read(tmp_path, overrides=given)
        write(tmp_path, "", name)
    read(tmp_path, overrides=given)


def test_secrets_are_never_shown(tmp_path: Path) -> None:
    file = write(tmp_path, TOKEN, "token")
    database = "postgresql://me:pass@word@host/db?sslpassword=hidden"
    environment = {"TRAINBRIDGE_TOKEN": TOKEN, "TRAINBRIDGE_DATABASE": database}
    found = read(tmp_path, environment, listens=False)
    shown = repr(found.shown())
    assert found.settings.token == TOKEN
    assert found.settings.database_url == database
    for secret in (TOKEN, "pass@", "word", "hidden"):
        assert secret not in shown.replace("sslpassword", "")
    assert TOKEN not in repr(found.settings)
    assert "postgresql://me:***@host/db" in shown
    # An unusable one is not shown either.
    with pytest.raises(SettingsError) as raised:
        read(tmp_path, {"TRAINBRIDGE_DATABASE": "mysql://me:secret@host/db"})
    assert "secret" not in str(raised.value)
    settings = read(tmp_path, {"TRAINBRIDGE_TOKEN_FILE": str(file)}).settings
    assert settings.token == TOKEN


@pytest.mark.parametrize(
    "password", ["plain", "sla/sh", "a/b@c/d", "que?ry", "ha#sh", "col:on", "line\nbreak", "p://x"]
)
def test_no_part_of_a_password_is_shown(password: str) -> None:
    assert without_secrets(f"postgresql://me:{password}@host/db") == "postgresql://me:***@host/db"
    assert without_secrets(f"postgresql://m/e:{password}@host/db").endswith(":***@host/db")


@pytest.mark.parametrize("url", ["postgresql://me@host:5432/db", "s3://bucket/a", "tcp://h:8786"])
def test_an_address_without_secrets_is_shown_whole(url: str) -> None:
    assert without_secrets(url) == url


def test_the_token_comes_from_its_strongest_source(tmp_path: Path) -> None:
    first, second = (write(tmp_path, f"{name} {TOKEN}", name) for name in ("first", "second"))
    write(tmp_path, f"token_file = '{second}'")
    assert read(tmp_path).settings.token == f"second {TOKEN}"
    environment = {"TRAINBRIDGE_TOKEN": f"third {TOKEN}"}
    assert read(tmp_path, environment).settings.token == f"third {TOKEN}"
    assert read(tmp_path, environment, token_file=first).settings.token == f"first {TOKEN}"
    with pytest.raises(SettingsError, match="cannot be read"):
        read(tmp_path, token_file=tmp_path / "none")
    with pytest.raises(SettingsError, match="is empty"):
        read(tmp_path, token_file=write(tmp_path, "", "empty"))


def test_every_setting_has_a_meaning(tmp_path: Path) -> None:
    for item in read(tmp_path).shown():
        assert item.meaning.endswith((".", "]")), item.name


def test_only_who_listens_needs_a_token(tmp_path: Path) -> None:
    everywhere = {"host": "0.0.0.0"}
    with pytest.raises(SettingsError, match="TRAINBRIDGE_TOKEN"):
        read(tmp_path, overrides=everywhere)
    assert read(tmp_path, overrides=everywhere, listens=False).settings.host == "0.0.0.0"
    assert Settings.from_environment({}, host="::1").host == "::1"
