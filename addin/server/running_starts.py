"""One calculation of a start, or of a large train, for everybody who waits for it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from addin.server.processes import Work
from addin.workers.pool import GivenUp, Job
from addin.worksheet.models import AT_SPEED, MODELS, RUN, Model
from addin.worksheet.registry import FunctionError

Tell = Callable[[str], None]
#: Result → task of the pool.
TASK = {RUN: "start", AT_SPEED: "speed"}


async def waited_for(job: Job, tell: Tell | None = None) -> Any:
    """The result of a job; whoever stops waiting gives the job up."""
    loop = asyncio.get_running_loop()
    leave = job.listen(lambda stage: _post(loop, tell, stage))
    try:
        return await asyncio.wrap_future(job.future)
    except asyncio.CancelledError:
        job.cancel()
        raise
    finally:
        leave()


def _post(loop: asyncio.AbstractEventLoop, tell: Tell | None, stage: str) -> None:
    if tell is not None and not loop.is_closed():
        loop.call_soon_threadsafe(tell, stage)


@dataclass
class _Shared:
    """A start on its way, with those who wait."""

    task: asyncio.Task[Any]
    tellers: list[Tell]
    stage: str = ""
    waiting: int = 0

    def tell(self, stage: str) -> None:
        self.stage = stage
        for tell in list(self.tellers):
            tell(stage)


class Starts:
    """The results being calculated, by what can change them.

    Parameters
    ----------
    work : Work
        Where they are calculated.
    """

    def __init__(self, work: Work) -> None:
        self._work = work
        self._shared: dict[tuple[str, str], _Shared] = {}

    async def ready(self, model: Model, tell: Tell | None = None, what: str = RUN) -> Any:
        """A result of a model, kept or calculated in the pool, never in this process.

        Cancelling this call gives the calculation up, unless somebody else waits for it.

        Parameters
        ----------
        model : Model
            The model.
        tell : callable, optional
            Called with each stage. [words]
        what : str
            Name of the result. [name]

        Returns
        -------
        object
            The result, or the `FunctionError` that says why there is none: kept with the model for
            as long as there is memory, so whoever asked takes it from here. [SI]

        Raises
        ------
        Busy, TooLong, RuntimeError
            If there is no result.
        """
        result = model.kept.get(what)
        if result is not None:
            return result
        shared = self._shared.get((model.results, what))
        if shared is None:
            shared = self._begin(model, what)
        elif tell is not None and shared.stage:
            tell(shared.stage)
        if tell is not None:
            shared.tellers.append(tell)
        shared.waiting += 1
        try:
            return await asyncio.shield(shared.task)
        finally:
            shared.waiting -= 1
            if tell is not None:
                shared.tellers.remove(tell)
            if not shared.waiting and not shared.task.done():
                self._forget(model, what, shared)
                shared.task.cancel()

    async def task(self, name: str, payload: Any, tell: Tell | None = None) -> Any:
        """The result of another task, for the one who asks; cancelling this call gives it up.

        Parameters
        ----------
        name : str
            One of `addin.server.tasks.TASKS`. [name]
        payload : object
            What it works on.
        tell : callable, optional
            Called with each stage. [words]

        Returns
        -------
        object
            Its result; not kept.

        Raises
        ------
        Busy, TooLong, RuntimeError, FunctionError
            If there is no result.
        """
        return await waited_for(self._work.submit(name, payload), tell)

    def _begin(self, model: Model, what: str) -> _Shared:
        # what another server may have takes a while to ask for
        job = None if MODELS.store else self._work.submit(TASK[what], model.case)
        shared = _Shared(asyncio.create_task(self._calculate(model, what, job)), [])
        # whoever waited may be gone by the time it fails: that is no error of the server's
        shared.task.add_done_callback(lambda task: task.cancelled() or task.exception())
        self._shared[model.results, what] = shared
        return shared

    async def _calculate(self, model: Model, what: str, job: Job | None) -> Any:
        shared = self._shared[model.results, what]
        try:
            if job is None:
                result = await asyncio.to_thread(MODELS.result_of_others, model, what)
                if result is not None:
                    return result
                job = self._work.submit(TASK[what], model.case)
            try:
                result = await waited_for(job, shared.tell)
            except FunctionError as wrong:  # why the train has none is kept, too
                result = wrong
            await asyncio.to_thread(MODELS.keep, model, what, result)
            return result
        except GivenUp:
            raise RuntimeError("The calculation was stopped. Start it again.") from None
        finally:
            self._forget(model, what, shared)

    def _forget(self, model: Model, what: str, shared: _Shared) -> None:
        if self._shared.get((model.results, what)) is shared:
            del self._shared[model.results, what]
