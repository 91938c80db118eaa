#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Lists the programs that `make setup` needs and this machine lacks, and the command that installs them. Argument: the Python to use.
python=${1:-python3}
missing=""
need() { missing="$missing $1"; }

command -v g++ >/dev/null 2>&1 || need g++
command -v make >/dev/null 2>&1 || need make
command -v perl >/dev/null 2>&1 || need perl
if ! command -v "$python" >/dev/null 2>&1; then
  need "python3 python3-venv"
elif ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
  echo "signum needs Python 3.11 or later; $python is $("$python" -V 2>&1)." >&2
  echo "Install one and name it: make PYTHON=python3.11 setup" >&2
  exit 1
elif ! "$python" -c 'import venv, ensurepip' >/dev/null 2>&1; then
  need python3-venv
fi
if [ -n "$missing" ]; then
  echo "signum needs programs that this machine lacks. On Debian or Ubuntu:" >&2
  echo "    sudo apt-get install$missing" >&2
  exit 1
fi
