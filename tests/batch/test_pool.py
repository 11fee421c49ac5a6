"""The pool of processes: order, crashes, stopping, orphans."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command_line import environment

from addin.workers.pool import Crashed, Pool, Task


def doubled(number):
    return 2 * number


def die_once(path):
    """Ends its process the first time, answers the second."""
    if not Path(path).exists():
        Path(path).write_text("died")
        os._exit(7)
    return "second"


def die(_):
    os.kill(os.getpid(), signal.SIGKILL)


def slow(number):
    time.sleep(0.3)
    return number


@pytest.fixture
def pool():
    pool = Pool(2)
    yield pool
    pool.close()


def never() -> bool:
    return False


def test_every_task_is_answered_once(pool):
    for number in range(20):
        pool.add(Task(doubled, number, tag=f"t{number}"))
    found = {task.tag: answer for task, answer in pool.answers(never)}
    assert found == {f"t{n}": 2 * n for n in range(20)}


def test_tasks_may_be_added_while_answers_are_taken(pool):
    pool.add(Task(doubled, 1))
    seen = []
    for _, answer in pool.answers(never):
        seen.append(answer)
        if answer < 50:
            pool.add(Task(doubled, answer))
    assert seen == [2, 4, 8, 16, 32, 64]


def test_a_process_that_dies_loses_nothing(pool, tmp_path):
    for number in range(4):
        pool.add(Task(doubled, number))
    pool.add(Task(die_once, str(tmp_path / "mark")))
    answers = [answer for _, answer in pool.answers(never)]
    assert sorted(map(str, answers)) == ["0", "2", "4", "6", "second"]


@pytest.mark.skipif(os.name == "nt", reason="there are no signals on Windows")
def test_a_task_that_always_kills_its_process_is_given_up_and_named(pool):
    pool.add(Task(die, None, tag="bad"))
    pool.add(Task(doubled, 4, tag="good"))
    found = {task.tag: answer for task, answer in pool.answers(never)}
    assert found["good"] == 8
    assert isinstance(found["bad"], Crashed)
    assert "SIGKILL" in found["bad"].sentence


def test_stopping_finishes_what_runs_and_begins_nothing(pool):
    for number in range(50):
        pool.add(Task(slow, number))
    seen = []
    for _, answer in pool.answers(lambda: len(seen) > 0):
        seen.append(answer)
    assert 1 <= len(seen) <= 2


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_processes_end_when_the_batch_is_killed(tmp_path):
    """Even in the middle of a task."""
    script = (
        "import test_pool; from addin.workers.pool import Pool, Task\n"
        "if __name__ == '__main__':\n"
        "    pool = Pool(2); pool.add(Task(test_pool.sleeping, None))\n"
        "    list(pool.answers(lambda: False))\n"
    )
    (tmp_path / "script.py").write_text(script)
    here, place = environment(), Path(__file__).parent
    here["PYTHONPATH"] = os.pathsep.join((here["PYTHONPATH"], str(place), str(place.parent)))
    batch = subprocess.Popen(
        [sys.executable, str(tmp_path / "script.py")], stdout=subprocess.PIPE, env=here
    )
    pid = int(batch.stdout.readline())
    batch.kill()
    batch.wait()
    until = time.monotonic() + 30
    while Path(f"/proc/{pid}/stat").exists() and time.monotonic() < until:
        if Path(f"/proc/{pid}/stat").read_text().split()[2] == "Z":
            break  # ended; nobody has asked for its status
        time.sleep(0.05)
    else:
        assert not Path(f"/proc/{pid}").exists()


def sleeping(_):
    print(os.getpid(), flush=True)
    time.sleep(120)
