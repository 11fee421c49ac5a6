"""Many calculations in turn, whose starts run side by side in the lanes of one loop.

A study calculates one case after the other by the same functions. Here some of them (`AT_ONCE`) take turns, one at a
time: each goes on until it wants a start simulated, and waits. When all wait, their starts run side by side. Nothing in a calculation knows of it, and each has the same bits alone.
"""

from __future__ import annotations

import contextvars
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

from engine.errors import InternalError
from engine.start.simulation import Simulation, form_of, turning_of_starts
from engine.start.trajectory import SingleRun
from engine.stepping.linear_loop import LANES

#: Calculations that take turns: twice as many as there are lanes, so that starts of about as many steps can go together
#: and lanes are filled where forms differ. More fill them better, but cost more than that saves. [count]
AT_ONCE = 2 * LANES

Item = TypeVar("Item")
Answer = TypeVar("Answer")


class _Cancelled(BaseException):
    """Another calculation of the group failed, or the whole was stopped."""


class _Member:
    """One of the calculations that take turns."""

    def __init__(self, group: _Group) -> None:
        self.group = group
        self.turn = threading.Semaphore(0)
        self.wanted: Simulation | None = None
        self.answer: SingleRun | InternalError | None = None
        self.done = False

    def simulate(self, simulation: Simulation) -> SingleRun:
        """Wait until the others want a start, too."""
        self.wanted = simulation
        self.group.back.release()
        self.turn.acquire()
        if self.group.ended:
            raise _Cancelled
        answer, self.answer = self.answer, None
        if answer is None or isinstance(answer, InternalError):
            raise answer or InternalError("a start was not simulated")
        return answer


class _Group:
    """Members, and whose turn it is."""

    def __init__(self) -> None:
        self.back = threading.Semaphore(0)
        self.ended = False


_current = threading.local()


def turning_of_start(simulation: Simulation) -> SingleRun:
    """Turning points of a start, calculated beside those of the other members of a group if there is one.

    Parameters
    ----------
    simulation : Simulation
        The start. [SI]

    Returns
    -------
    SingleRun
        From rest to its end, without histories of torques. [SI]

    Raises
    ------
    InternalError
        If it diverges.
    """
    member: _Member | None = getattr(_current, "member", None)
    if member is not None:
        return member.simulate(simulation)
    answer = turning_of_starts([simulation])[0]
    if isinstance(answer, InternalError):
        raise answer
    return answer


def side_by_side(
    calculate: Callable[[Item], Answer], items: Iterable[Item], at_once: int = AT_ONCE
) -> list[Answer]:
    """Answers of a calculation for each of some items, in their order; their starts run side by side.

    Parameters
    ----------
    calculate : callable
        Takes one item. It is called in other threads, one of them at a time. [function]
    items : iterable
        The items. [any]
    at_once : int, optional
        Calculations that take turns. [count]

    Returns
    -------
    list
        Answers. An error of one is raised after the others of its group have waited or ended. [any]
    """
    answers: dict[int, Answer] = {}
    items = list(items)
    todo = iter(enumerate(items))
    group = _Group()
    errors: list[BaseException] = []

    def work(member: _Member) -> None:
        _current.member = member
        member.turn.acquire()
        try:
            while not group.ended and not errors:
                item = next(todo, None)
                if item is None:
                    break
                answers[item[0]] = calculate(item[1])
        except _Cancelled:
            pass
        except BaseException as error:
            errors.append(error)
        finally:
            member.done = True
            group.back.release()

    members = [_Member(group) for _ in range(min(at_once, len(items)))]
    threads = [
        threading.Thread(target=contextvars.copy_context().run, args=(work, m), daemon=True)
        for m in members
    ]
    for thread in threads:
        thread.start()
    try:
        for _ in _rounds(members, group):
            if errors:
                break
    finally:
        group.ended = True
        for member in members:
            member.turn.release()
        for thread in threads:
            thread.join()
    if errors:
        raise errors[0]
    return [answers[i] for i in range(len(answers))]


def _rounds(members: Sequence[_Member], group: _Group) -> Iterator[None]:
    """Each member's turn, then the starts they want; until all are done."""
    while True:
        for member in members:
            if member.done:
                continue
            member.turn.release()
            group.back.acquire()
        waiting = [m for m in members if not m.done]
        if not waiting:
            return
        forms: dict[object, list[_Member]] = {}
        for member in waiting:
            assert member.wanted is not None
            forms.setdefault(form_of(member.wanted), []).append(member)
        for alike in forms.values():
            wanted = [m.wanted for m in alike if m.wanted is not None]
            for member, answer in zip(alike, turning_of_starts(wanted), strict=True):
                member.wanted, member.answer = None, answer
        yield
