#!/usr/bin/env bash
# Checks what docker/ holds without Docker: reads Dockerfile and compose file and what they must keep
# to, carries out the Dockerfile's build in a folder, runs every command and health check of ours
# from it, and the whole topology as processes on loopback.
#
#     docker/check.sh [PYTHON]
#
# PYTHON is a CPython 3.11 that has the packages of trainbridge[test]; without it, one is made that
# has what is needed. PostgreSQL has to be installed (apt-get install postgresql).
set -euo pipefail
cd "$(dirname "$0")/.."

work="$(mktemp -d)"
# The database server runs as another user.
chmod 755 "$work"
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1 PYTHONDONTWRITEBYTECODE=1

if [ $# -gt 0 ]; then
    python="$1"
else
    echo "docker: an environment for the check"
    python3 -m venv "$work/tools"
    python="$work/tools/bin/python"
    "$python" -m pip install --quiet 'moto[s3,server]>=5,<6' 'pyyaml>=6,<7'
fi

if ! "$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then
    echo "docker/requirements.lock is for Python 3.11: name one, docker/check.sh PYTHON" >&2
    exit 1
fi

echo "docker: Dockerfile and compose.yaml"
"$python" docker/checks/files.py
echo "docker: the image's environment, built as the Dockerfile does"
mkdir "$work/image"
"$python" docker/checks/image.py "$work/image"
echo "docker: the services of compose.yaml, as processes"
"$python" docker/checks/topology.py "$work/image"
echo "docker: all checks passed"
