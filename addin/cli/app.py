"""The command line: the same path on files as in Excel, without Excel.

Nothing heavy is imported before a command needs it, so that --help and version answer at once.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from addin.cli.batch import INTERRUPTED, batch
from addin.cli.calibrate import calibrate
from addin.cli.diff import diff
from addin.cli.excel import excel
from addin.cli.libreoffice import calc
from addin.cli.report import report
from addin.cli.serve import serve
from addin.cli.starts import starts
from addin.cli.terminal import Refused, list_problems, progress, refuse_clashes, study_targets
from addin.cli.tolerances import sensitivities, tolerances
from addin.cli.tune import tune
from addin.cli.verify import verify

if TYPE_CHECKING:
    from collections.abc import Callable

    from addin.template.examples import Example
    from addin.writing.recalculate import Recalculated
    from engine.studies.accuracy import AccuracyStudy

__all__ = ["DONE", "INTERNAL", "WRONG_INPUT", "app", "main"]

DONE, WRONG_INPUT, USAGE, INTERNAL = 0, 1, 2, 3

app = typer.Typer(
    name="torsionbook",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help=(
        "Torsional start-up analysis of synchronous-motor trains in Excel workbooks.\n\n"
        "A first run, from an empty folder:\n\n"
        "    torsionbook new train.xlsx --example proposed\n\n"
        "    torsionbook recalc train.xlsx\n\n"
        "Fill in your own train with `torsionbook new mine.xlsx --units us`, check it with "
        "`torsionbook check mine.xlsx`, and calculate it with `torsionbook recalc mine.xlsx`. "
        "Results go to a new file beside it; the workbook you typed is not touched.\n\n"
        "Exit status: 0 done, 1 some input is wrong (every error is listed, nothing is written for "
        "that file), 2 wrong usage, 3 an error inside torsionbook, 130 interrupted by Ctrl-C."
    ),
)

app.add_typer(excel)
app.add_typer(calc)
app.command()(serve)
app.command()(report)
app.command()(verify)
app.command()(diff)
app.command()(batch)
app.command()(tune)
app.command()(tolerances)
app.command()(sensitivities)
app.command()(starts)
app.command()(calibrate)

Files = Annotated[
    list[Path],
    typer.Argument(help="Workbooks (.xlsx, .xlsm) or case JSON files.", show_default=False),
]


def _version_asked(asked: bool) -> None:
    if asked:
        version()
        raise typer.Exit()


@app.callback()
def _program(
    version_asked: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_version_asked, is_eager=True
        ),
    ] = False,
) -> None:
    """See the help of `app`; only --version is added here."""


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="The workbook to make.", show_default=False)],
    units: Annotated[str, typer.Option(help="Units of the blank template: us or si.")] = "us",
    example: Annotated[
        str | None,
        typer.Option(
            help="Instead of a blank template a filled one: the paper's case proposed or modified, "
            "or backlash, the proposed one with gear clearance, bearings and pull-in."
        ),
    ] = None,
    flavour: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="Which program it is for: files (the usual, without functions), excel (an .xlsm: "
            "desktop Excel on Windows, functions through xlwings), server (Excel anywhere, functions "
            "from torsionbook serve) or calc (LibreOffice). All but the first have a sheet Live that "
            "shows modes and margins of what is typed. An .xlsm is for excel.",
            show_default=False,
        ),
    ] = None,
    studies: Annotated[
        bool,
        typer.Option(
            "--studies",
            help="With the sheets of the studies: tuning, tolerances, start matrix, calibration.",
        ),
    ] = False,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="Fill in the inputs of this workbook or case JSON, as they are typed there.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Make a workbook to fill in, one of the filled examples, or one with the inputs of another.

    Examples: `torsionbook new train.xlsx --units si`; `torsionbook new train.xlsm --example proposed`;
    `torsionbook new more.xlsx --from train.xlsx --studies`
    """
    from addin.template.variants import FLAVOURS
    from addin.writing.recalculate import of_file

    if example is not None:
        _choice("--example", example, ("proposed", "modified", "backlash"))
    _choice("--units", units, ("us", "si"))
    if flavour is None:
        flavour = "excel" if file.suffix.lower() == ".xlsm" else "files"
    _choice("--for", flavour, tuple(FLAVOURS))
    chosen = FLAVOURS[flavour]
    if file.suffix.lower() != chosen.suffix:
        more = " (or say --for excel)" if chosen.suffix == ".xlsx" else ""
        raise typer.BadParameter(f"'{file}' must end in {chosen.suffix}{more}.")
    if file.exists() and not force:
        raise Refused(
            f"{file} is there already. Choose another name, or say --force to replace it."
        )
    if not file.parent.is_dir():
        raise Refused(f"The folder {file.parent} does not exist. Make it first.")
    filled = example if source is None else _filled(source, units, example)
    from addin.cli.new import make_workbook
    from addin.excel.errors import ExcelError

    try:
        make_workbook(file, "us" if example else units, filled, chosen, studies=studies)
    except OSError as wrong:
        raise Refused(of_file(file, wrong).message) from wrong
    except ExcelError as wrong:
        raise Refused(f"{file}: {wrong}") from wrong
    typer.echo(f"{file} is ready. Fill in the yellow cells, then: torsionbook recalc {file}")


@app.command()
def check(files: Files) -> None:
    """Read and check inputs without calculating: every error with its sheet and cell.

    Where there is none, it says which answers cannot be given yet, and which input is missing for each.

    Example: `torsionbook check train.xlsx`
    """
    from addin.contract.problems import printable
    from addin.studies.registry import of_studies
    from addin.writing.recalculate import Unreadable, read_checked
    from engine.case.missing_inputs import unanswered
    from engine.case.plausibility import implausible

    wrong = 0
    for file in files:
        read = read_checked(file)
        plausible = () if isinstance(read, Unreadable) or read.problems else implausible(read.data)
        for sentence in (*read.warnings, *plausible):
            typer.echo(f"{file}: note: {printable(sentence)}")
        problems = (*read.problems, *of_studies(read))
        if problems:
            wrong += 1
            list_problems(file, problems)
        else:
            typer.echo(f"{file}: no errors.")
            if open_answers := unanswered(read.case()):  # type: ignore[union-attr]
                typer.echo(f"  Not answered yet. {' '.join(open_answers)}")
    if wrong:
        raise typer.Exit(WRONG_INPUT)


@app.command()
def recalc(
    files: Files,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the results; default beside each input.")
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Write into the workbook itself; keeps a .bak copy.")
    ] = False,
    json: Annotated[
        Path | None,
        typer.Option(help="Also write results as JSON: a file, or a folder for several inputs."),
    ] = None,
    method: Annotated[
        str | None, typer.Option(help="exponential (default) or newmark, the paper's method.")
    ] = None,
    tolerance: Annotated[
        str | None, typer.Option(help="Wanted error of peak torques, such as 0.001 or 0.1%.")
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 if a verdict fails.")
    ] = False,
    ignore_lock: Annotated[
        bool, typer.Option("--ignore-lock", help="Go on although a lock file is there.")
    ] = False,
) -> None:
    """Calculate workbooks or case JSON files and write their results.

    Examples: `torsionbook recalc train.xlsx` writes train.out.xlsx;
    `torsionbook recalc *.xlsx --out results --json results` calculates a folder.
    """
    from addin.contract.problems import printable

    if out is not None and in_place:
        raise typer.BadParameter("--out and --in-place exclude each other.")
    overrides = _overrides(method, tolerance)
    targets = [_targets(file, out, json, len(files) > 1) for file in files]
    refuse_clashes(files, targets, in_place)
    histories = _histories(files, targets, in_place)
    done: list[Recalculated] = []
    with progress() as tell:
        for file, (target, json_file), history in zip(files, targets, histories, strict=True):
            done.append(
                _recalculate(
                    file, target, json_file, in_place, overrides, ignore_lock, tell, history
                )
            )
    for one in done:
        list_problems(one.source, one.problems, bool(one.written))
        for sentence in one.warnings:
            typer.echo(f"{one.source}: note: {printable(sentence)}", err=True)
    _summary(done)
    if any(one.problems for one in done):
        raise typer.Exit(WRONG_INPUT)
    if strict and any(_overall(one) == "fail" for one in done):
        raise typer.Exit(WRONG_INPUT)


@app.command()
def export(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    case: Annotated[Path, typer.Argument(help="The case JSON to write.", show_default=False)],
) -> None:
    """Write the inputs of a workbook as a case JSON, in SI.

    Example: `torsionbook export train.xlsx case.json`
    """
    from addin.reading.case_json import case_to_json
    from addin.writing.recalculate import Unreadable, of_file, read_checked, write_json

    read = read_checked(file)
    if isinstance(read, Unreadable) or read.problems:
        list_problems(file, read.problems)
        raise typer.Exit(WRONG_INPUT)
    try:
        write_json(case, case_to_json(read.data))
    except OSError as wrong:
        raise Refused(of_file(case, wrong).message) from wrong
    typer.echo(f"{case} is written.")


@app.command()
def accuracy(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the result; default beside the input.")
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Write into the workbook itself; keeps a .bak copy.")
    ] = False,
    json: Annotated[
        Path | None, typer.Option(help="Also write the study as JSON: a file or a folder.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Time each setting once instead of five times.")
    ] = False,
    ignore_lock: Annotated[
        bool, typer.Option("--ignore-lock", help="Go on although a lock file is there.")
    ] = False,
) -> None:
    """Show what accuracy costs in time: error against wall time of this very case.

    Calculates the start by both methods at several tolerances, compares with a reference a hundred
    times finer, and writes sheet Accuracy; no other result is touched.

    Example: `torsionbook accuracy train.xlsx` writes train.accuracy.xlsx.
    """
    from addin.contract.problems import printable
    from addin.studies.accuracy import ACCURACY, QUICK_ROUNDS, ROUNDS
    from addin.studies.study import study_one
    from addin.workers.parallel_map import alone

    destination, json = study_targets(file, "accuracy", out, json, in_place)
    with progress() as tell:
        done = study_one(
            ACCURACY,
            file,
            alone(),
            {"rounds": QUICK_ROUNDS if quick else ROUNDS},
            destination=destination,
            in_place=in_place,
            json_file=json,
            ignore_lock=ignore_lock,
            on_stage=lambda stage: tell(f"{file.name}: {stage}"),
        )
    for sentence in done.warnings:
        typer.echo(f"{file}: note: {printable(sentence)}", err=True)
    if done.found is None:
        list_problems(file, done.problems, bool(done.written))
        raise typer.Exit(WRONG_INPUT)
    _show_study(done.found.result)
    for path in done.written:
        typer.echo(f"written: {path}")


@app.command()
def version() -> None:
    """Print the version."""
    from addin.contract.version import product_version

    typer.echo(f"torsionbook {product_version()}")


# --- behind the commands ------------------------------------------------------------------------


def _filled(source: Path, units: str, example: str | None) -> Example:
    """The inputs of another file, as they are typed there."""
    from addin.template.filled import MixedUnits, example_of
    from addin.writing.recalculate import Unreadable, read_checked

    if example is not None:
        raise typer.BadParameter("--from and --example exclude each other.")
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        list_problems(source, read.problems)
        raise typer.Exit(WRONG_INPUT)
    try:
        return example_of(read, units)
    except MixedUnits as wrong:
        raise Refused(f"{source}: {wrong}") from wrong


def _choice(option: str, value: str, words: Sequence[str]) -> None:
    if value not in words:
        raise typer.BadParameter(f"{option} is '{value}'; it must be {' or '.join(words)}.")


def _overrides(method: str | None, tolerance: str | None) -> dict[str, Any]:
    """Settings of the command line, under the names of the case."""
    from engine.case.data import LEAST_PEAK_ERROR, LEAST_TOLERANCE_PEAK

    settings: dict[str, Any] = {}
    if method is not None:
        _choice("--method", method, ("exponential", "newmark"))
        settings["method"] = method
    if tolerance is not None:
        text = tolerance.strip()
        try:
            value = float(text.rstrip("%")) * (0.01 if text.endswith("%") else 1.0)
        except ValueError:
            raise typer.BadParameter(
                f"--tolerance is '{tolerance}'; write a number such as 0.001 or 0.1%."
            ) from None
        if not LEAST_TOLERANCE_PEAK <= value <= 0.5:
            raise typer.BadParameter(
                f"--tolerance is {value:g}; it must lie between {LEAST_TOLERANCE_PEAK:g} and 0.5 "
                f"(50 %). No peak torque is calculated to better than {LEAST_PEAK_ERROR:g}."
            )
        settings["tolerance_peak"] = value
    return settings


def _targets(
    file: Path, out: Path | None, json: Path | None, several: bool
) -> tuple[Path | None, Path | None]:
    """Result workbook and JSON of one input; None = the default."""
    ending = ".results.json" if file.suffix.lower() == ".json" else file.suffix
    destination = out / f"{file.stem}{ending}" if out is not None else None
    if destination is None and ending == ".results.json" and json is None:
        destination = file.with_name(f"{file.stem}.results.json")
    folder = json is not None and (several or json.is_dir() or json == out)
    json_file = json / f"{file.stem}.results.json" if json is not None and folder else json
    return destination, json_file


def _recalculate(
    file: Path,
    destination: Path | None,
    json_file: Path | None,
    in_place: bool,
    overrides: dict[str, Any],
    ignore_lock: bool,
    tell: Callable[[str], None],
    history: str,
) -> Recalculated:
    from addin.writing.recalculate import recalculate

    return recalculate(
        file,
        destination=destination,
        in_place=in_place,
        json_file=json_file,
        overrides=overrides,
        ignore_lock=ignore_lock,
        on_stage=lambda stage: tell(f"{file.name}: {stage}"),
        history=history,
    )


def _histories(
    files: Sequence[Path], targets: Sequence[tuple[Path | None, Path | None]], in_place: bool
) -> list[str]:
    """Names of histories before ``.history``; empty for the usual one, which no other result has."""
    from addin.writing.history_file import history_stems
    from addin.writing.recalculate import beside

    results = [
        str(file if in_place else target or beside(file))
        for file, (target, _) in zip(files, targets, strict=True)
    ]
    stems = history_stems(results)
    return [Path(one).name if stems[one] == one else "" for one in results]


def _overall(one: Recalculated) -> str:
    if one.calculation is None:
        return "not calculated"
    return next(v.verdict for v in one.calculation.results.verdicts)


#: A terminal narrower than this gets the summary as lines instead of a table.
TABLE_WIDTH = 110


def _summary(done: Sequence[Recalculated]) -> None:
    """The end of a run: file, first modes, worst margin, peak, start, starts, verdict."""
    shown = [one for one in done if one.calculation is not None]
    if not shown:
        return
    import shutil

    from addin.contract.problems import printable

    headers = ("First modes [Hz]", "Worst margin", "Largest peak", "Start", "Starts", "Verdict")
    rows = [
        (one.source.name, [printable(cell) for cell in (*_summary_cells(one), _overall(one))])
        for one in shown
    ]
    if shutil.get_terminal_size().columns >= TABLE_WIDTH:
        from rich.console import Console
        from rich.table import Table

        table = Table("File", *headers, show_edge=False, pad_edge=False)
        for name, cells in rows:
            table.add_row(name, *cells)
        Console(width=max(Console().width, TABLE_WIDTH)).print(table)
    else:
        for name, cells in rows:
            typer.echo(name)
            for header, cell in zip(headers, cells, strict=True):
                typer.echo(f"  {header:<17} {cell}")
    for one in shown:
        for path in one.written:
            typer.echo(f"written: {path}")


def _show_study(found: AccuracyStudy) -> None:
    """Table and sentences of an accuracy study."""
    from rich.console import Console
    from rich.table import Table

    table = Table(show_edge=False, pad_edge=False)
    for header in ("Method", "Setting"):
        table.add_column(header, no_wrap=True)
    for header in ("Error peak (%)", "Error starts (%)", "Time (ms)"):
        table.add_column(header, justify="right")
    for row in found.rows:
        errors = [
            "–" if e is None else _decimal(100.0 * e) for e in (row.error_peak, row.error_starts)
        ]
        took = "–" if row.time is None else f"{1e3 * row.time:.3g}"
        table.add_row(row.method, str(row.setting), *errors, took)
    Console(width=max(Console().width, TABLE_WIDTH)).print(table)
    typer.echo(found.sentence)
    typer.echo(f"Reference: {found.reference}")


def _decimal(value: float) -> str:
    """Two digits without powers of ten; what is smaller than a chart can show is a bound."""
    if 0.0 < value < 1e-7:
        return "< 0.0000001"
    digits = 1 if value == 0.0 else max(0, 1 - math.floor(math.log10(value)))
    return f"{value:.{digits}f}"


def _summary_cells(one: Recalculated) -> list[str]:
    assert one.calculation is not None
    from addin.calculation.key_figures import headline

    calculation = one.calculation
    shown = headline(calculation.results, calculation.tables.get("StartupPeaks", ()))
    modes = ", ".join(f"{f:.4g}" for f in shown.frequencies)
    margin, peak, starts = "–", "–", "–"
    if shown.margin is not None:
        margin = f"{100 * shown.margin:.1f} % (mode {shown.margin_mode})"
    if shown.peak_over_rated is not None:
        peak = f"{shown.peak_over_rated:.2f} × rated, {shown.peak_where}"
    elif shown.peak_torque is not None:
        peak = f"{shown.peak_torque:.4g} N m {shown.peak_where}"
    if shown.starts_not_judged:
        starts = "not judged"
    elif shown.starts_unlimited:
        starts = "unlimited"
    elif shown.starts is not None:
        starts = f"{math.floor(shown.starts):,}"
    outcome = "–" if one.calculation.results.start is None else shown.outcome
    return [modes, margin, peak, outcome, starts]


def _by_ctrl_c(ended: BaseException) -> bool:
    """Whether a command was cut short; one that ends of itself after Ctrl-C has had its say."""
    one: BaseException | None = ended
    while one is not None and not isinstance(one, KeyboardInterrupt):
        one = one.__cause__ or one.__context__
    return one is not None


def _tell_interrupted() -> None:
    typer.echo(
        "Interrupted. Files written before are whole; nothing was written for what was being done.",
        err=True,
    )


def main() -> None:
    """Entry point: run the command line and turn what goes wrong into its exit status."""
    # Matrices here have at most some hundred rows: more threads of the linear algebra would only wait for each other,
    # most of all on a busy machine. It is read when numpy is imported, hence before any command.
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    try:
        app(standalone_mode=True)
    except Refused as wrong:
        typer.echo(str(wrong), err=True)
        sys.exit(WRONG_INPUT)
    except SystemExit as ended:
        if ended.code == INTERRUPTED and _by_ctrl_c(ended):
            _tell_interrupted()
        raise
    except KeyboardInterrupt:
        _tell_interrupted()
        sys.exit(INTERRUPTED)
    except Exception:  # the last resort: anything else is ours, and must not look like input
        import traceback

        traceback.print_exc()
        typer.echo(
            "This is an error inside torsionbook. Nothing was written for the file being "
            "calculated. Please report it with the lines above.",
            err=True,
        )
        sys.exit(INTERNAL)


if __name__ == "__main__":
    main()
