"""An object store on loopback for tests."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from unittest.mock import patch

import httpx
from moto.server import ThreadedMotoServer

BUCKET = "trainbridge-test"


@contextmanager
def object_store() -> Generator[str]:
    """A fresh bucket's URL, with the AWS variables set as long as it is open."""
    server = ThreadedMotoServer("127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    address = f"http://{host}:{port}"
    variables = {
        "AWS_ENDPOINT_URL": address,
        "AWS_ACCESS_KEY_ID": "test",
        "AWS_SECRET_ACCESS_KEY": "test",
        "AWS_REGION": "us-east-1",
    }
    try:
        with httpx.Client(trust_env=False) as client:
            client.post(f"{address}/moto-api/reset").raise_for_status()
            client.put(f"{address}/{BUCKET}").raise_for_status()
        with patch.dict(os.environ, variables):
            yield f"s3://{BUCKET}/results"
    finally:
        server.stop()
