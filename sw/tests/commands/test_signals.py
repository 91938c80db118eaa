# SPDX-License-Identifier: Apache-2.0
"""A command is stopped by SIGINT, SIGTERM and SIGHUP alike, within two seconds, and at once by a second signal."""

import signal
import subprocess
import sys
import time

import pytest

from signum.commands import signals

WAIT_S = 60
"""Most time that a process gets on a busy machine."""

STOPPED = """
import signal, sys, time
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.default_int_handler)  # whatever the tests were started with
from signum.commands import signals
signals.GRACE_S = {grace}
signals.listen()
print("ready", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("stopped", flush=True)
    {after}
    sys.exit(130)
"""


def _start(work: str, after: str = "pass", grace: float = signals.GRACE_S) -> subprocess.Popen[str]:
    process = subprocess.Popen([sys.executable, "-c", STOPPED.format(work=work, after=after, grace=grace)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(0.2)
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_every_signal_interrupts(number: signal.Signals) -> None:
    process = _start("time.sleep(60)")
    process.send_signal(number)
    out, error = process.communicate(timeout=WAIT_S)
    assert process.returncode == 130 and out == "stopped\n" and not error


def test_a_stop_that_takes_long_is_cut_off() -> None:
    process = _start("time.sleep(60)", after="time.sleep(60)")
    process.terminate()
    began = time.monotonic()
    _, error = process.communicate(timeout=WAIT_S)
    assert time.monotonic() - began >= 1 and process.returncode == 130
    assert error == "\nsignum: stopped; what was finished is kept\n"


def test_a_second_signal_ends_at_once() -> None:
    process = _start("time.sleep(600)", after="time.sleep(600)", grace=300)
    process.terminate()
    assert process.stdout is not None and process.stdout.readline() == "stopped\n"
    process.terminate()
    began = time.monotonic()
    process.communicate(timeout=WAIT_S)
    assert process.returncode == 130 and time.monotonic() - began < WAIT_S, "long before the grace ends"


def test_what_is_shielded_ends_first() -> None:
    work = "with signals.shielded():\n        time.sleep(0.8)\n        print('whole', flush=True)\n    time.sleep(60)"
    process = _start(work)
    process.terminate()
    out, _ = process.communicate(timeout=WAIT_S)
    assert process.returncode == 130 and out == "whole\nstopped\n"


def test_an_ignored_signal_stays_ignored() -> None:
    """As under nohup."""
    ignoring = subprocess.run(
        [sys.executable, "-c", "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
         "from signum.commands import signals; signals.listen()\nimport os; os.kill(os.getpid(), signal.SIGHUP)\n"
         "print('alive')"], capture_output=True, text=True, check=False)
    assert ignoring.stdout == "alive\n" and ignoring.returncode == 0
