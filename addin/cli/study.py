"""What the commands of the studies have in common: targets, processes, Ctrl-C, the words at the end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import typer

from addin.batch.scheduler import Abandoned, Stop, Stopped
from addin.cli.status import INTERRUPTED, WRONG_INPUT, Refused
from addin.cli.terminal import list_problems, progress, study_targets
from addin.contract.problems import printable
from addin.studies.study import Found, Study, study_one
from addin.workers.cluster import ClusterRefused
from addin.workers.parallel_map import Cancelled, UnitLost, spread_over


def run_study(
    study: Study,
    file: Path,
    settings: Mapping[str, Any],
    *,
    out: Path | None = None,
    in_place: bool = False,
    json: Path | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    ignore_lock: bool = False,
    show: Callable[[Found], None] = lambda found: None,
    then: Callable[[Found], None] = lambda found: None,
) -> None:
    """Run a study from the command line and tell what became of it.

    Raises
    ------
    typer.Exit
        With 1 for wrong input, 130 after Ctrl-C, whether or not the part that was calculated could be
        written; everything has been told.
    """
    destination, json = study_targets(file, study.command, out, json, in_place)
    stop = Stop()

    def on_stage(stage: str) -> None:
        stop()  # a second Ctrl-C gives up between units as well
        tell(_progress(file, stage, stop))

    try:
        with (
            progress() as tell,
            stop.listening(tell),
            spread_over(jobs, scheduler, stop) as spread,
        ):
            done = study_one(
                study,
                file,
                spread,
                settings,
                destination=destination,
                in_place=in_place,
                json_file=json,
                ignore_lock=ignore_lock,
                on_stage=on_stage,
            )
    except (Abandoned, Cancelled, KeyboardInterrupt) as ended:
        why = f" {ended.why}" if isinstance(ended, Cancelled) and ended.why else ""
        typer.echo(f"{file}: ended by Ctrl-C.{why} Nothing was written.", err=True)
        raise typer.Exit(INTERRUPTED) from None
    except (ClusterRefused, Stopped, UnitLost) as wrong:
        raise Refused(f"{file}: {wrong}") from wrong
    for sentence in done.warnings:
        typer.echo(f"{file}: note: {printable(sentence)}", err=True)
    if done.found is None:
        list_problems(file, done.problems, bool(done.written))
        raise typer.Exit(WRONG_INPUT)
    show(done.found)
    typer.echo(printable(done.found.sentence))
    for path in done.written:
        typer.echo(f"written: {path}")
    then(done.found)
    if done.found.cut_short is not None:
        raise typer.Exit(INTERRUPTED)


def _progress(file: Path, stage: str, stop: Stop) -> str:
    return f"{file.name}: {stage}" + (" (stopping)" if stop.asked else "")
