"""The command of a study that has no module of its own here: made from its record."""

from __future__ import annotations

from collections.abc import Callable

from addin.cli.options import (
    FileArgument,
    IgnoreLockOption,
    InPlaceOption,
    JobsOption,
    JsonOption,
    OutOption,
    SchedulerOption,
)
from addin.cli.study import run_study
from addin.studies.registry import study_of_command


def study_command(command: str) -> Callable[..., None]:
    """The function of the command of a study."""
    study = study_of_command(command)

    def make_study(
        file: FileArgument,
        out: OutOption = None,
        in_place: InPlaceOption = False,
        json: JsonOption = None,
        jobs: JobsOption = None,
        scheduler: SchedulerOption = None,
        ignore_lock: IgnoreLockOption = False,
    ) -> None:
        run_study(
            study,
            file,
            {},
            out=out,
            in_place=in_place,
            json=json,
            jobs=jobs,
            scheduler=scheduler,
            ignore_lock=ignore_lock,
        )

    make_study.__doc__ = study.spec.intro
    return make_study
