"""A command is stopped by SIGINT, SIGTERM and SIGHUP alike, within two seconds, and at once by a second signal."""

import signal
import subprocess
import sys
import time

import pytest

STOPPED = """
import sys, time
from signum.commands import signals
signals.listen()
print("ready", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("stopped", flush=True)
    {after}
    sys.exit(130)
"""


def _start(work: str, after: str = "pass") -> subprocess.Popen[str]:
    process = subprocess.Popen([sys.executable, "-c", STOPPED.format(work=work, after=after)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(0.2)
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_every_signal_interrupts(number: signal.Signals) -> None:
    process = _start("time.sleep(60)")
    process.send_signal(number)
    out, error = process.communicate(timeout=20)
    assert process.returncode == 130 and out == "stopped\n" and not error


def test_a_stop_that_takes_long_is_cut_off() -> None:
    process = _start("time.sleep(60)", after="time.sleep(60)")
    process.terminate()
    began = time.monotonic()
    out, error = process.communicate(timeout=20)
    assert time.monotonic() - began >= 1 and process.returncode == 130
    assert error == "\nsignum: stopped; what was finished is kept\n"


def test_a_second_signal_ends_at_once() -> None:
    process = _start("time.sleep(60)", after="time.sleep(60)")
    process.terminate()
    assert process.stdout is not None and process.stdout.readline() == "stopped\n"
    process.terminate()
    began = time.monotonic()
    assert process.wait(timeout=20) == 130 and time.monotonic() - began < 1.2


def test_what_is_shielded_ends_first() -> None:
    work = "with signals.shielded():\n        time.sleep(0.8)\n        print('whole', flush=True)\n    time.sleep(60)"
    process = _start(work)
    process.terminate()
    out, _ = process.communicate(timeout=20)
    assert process.returncode == 130 and out == "whole\nstopped\n"


def test_an_ignored_signal_stays_ignored() -> None:
    """As under nohup."""
    ignoring = subprocess.run(
        [sys.executable, "-c", "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
         "from signum.commands import signals; signals.listen()\nimport os; os.kill(os.getpid(), signal.SIGHUP)\n"
         "print('alive')"], capture_output=True, text=True, check=False)
    assert ignoring.stdout == "alive\n" and ignoring.returncode == 0
