"""Those who ask take turns, whoever has more waiting."""

import threading

from hypothesis import given
from hypothesis import strategies as st

from addin.workers.pool import Job, JobQueue, Task


def job(owner: str, number: int) -> Job:
    return Job(Task(print, number, owner=owner))


@given(st.lists(st.sampled_from("abc"), max_size=40))
def test_between_two_jobs_of_one_client_comes_one_of_everybody_who_waits(owners):
    jobs = JobQueue()
    for number, owner in enumerate(owners):
        jobs.put(job(owner, number))
    jobs.put(None)
    taken = []
    while (one := jobs.get()) is not None:
        taken.append(one.task)
    assert sorted(task.payload for task in taken) == list(range(len(owners)))
    left = list(owners)
    for before, after in zip(taken, taken[1:], strict=False):
        left.remove(before.owner)
        if before.owner == after.owner:
            assert set(left) == {after.owner}, "somebody else was waiting"
    for owner in "abc":
        own = [task.payload for task in taken if task.owner == owner]
        assert own == sorted(own)


def test_a_client_that_comes_late_is_the_next_but_one():
    jobs = JobQueue()
    for number in range(30):
        jobs.put(job("many", number))
    jobs.put(job("one", 99))
    first, second = jobs.get(), jobs.get()
    assert first is not None
    assert second is not None
    assert (first.task.owner, second.task.owner) == ("many", "one")


def test_whoever_waits_for_a_job_gets_one_as_it_comes():
    jobs, found = JobQueue(), []
    waiting = threading.Thread(target=lambda: found.append(jobs.get()))
    waiting.start()
    jobs.put(job("", 1))
    waiting.join(10.0)
    assert [one.task.payload for one in found] == [1]
