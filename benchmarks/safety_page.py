"""docs/safety.md, from safety_text.md and the records of the commands that it tells of: `python -m benchmarks.safety_page`."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

from addin.xlsx.container import DEFAULT_LIMITS

ROOT = Path(__file__).resolve().parents[1]
PAGE, RECORDS = ROOT / "docs" / "safety.md", ROOT / "benchmarks" / "records"
TEXT = Path(__file__).with_name("safety_text.md")
_OF_THE_KILLS = """\
A library between the program and the C library (`make kills`) counts the calls that concern the folder of a command, in all its processes,
and hinders one of them. *Killed*: kill -9 of all processes before each call that changes something, and halfway through each write. *Error*:
a call, reads too, fails with no space, input/output error, no permission or quota, one of the four in turn. *Full disk*: every call that
needs room fails from one on. *Power lost*: disks as they may be after each change, without what was not flushed, without names whose
folder was not flushed, or with half of both; equal disks count once. Demanded of each: every input still there, no file torn, no traceback,
after an error a sentence and an exit status, after a full disk no litter, and the same command, run again, succeeds and leaves no litter
(from equal folders it is run once). A dash: not tried. A share is the part of the calls that was tried.

"""
_WAYS = ("killed", "error", "full disk", "power lost")
_FINE = ("opened", "calculated")
#: What a statement of a case is about.
_KIND = {"peak": "peak", "starts": "number of starts", "bound": "peak with an effect left out"}


def kept(name: str) -> dict[str, Any]:
    """A record; empty where its command has not been run."""
    path = RECORDS / name
    return json.loads(path.read_text("utf-8")) if path.exists() else {}


def keep_stretch(name: str, stretch: dict[str, Any]) -> None:
    """Add a stretch of numbers to a record; one with the same first number is replaced. Then write the page."""
    stretches = kept(name).get("stretches", [])
    same = (stretch["run"], stretch["first"])
    stretches = [one for one in stretches if (one["run"], one["first"]) != same]
    stretches = sorted([*stretches, stretch], key=lambda one: (one["run"], one["first"]))
    for before, after in zip(stretches, stretches[1:], strict=False):
        if before["run"] == after["run"] and before["first"] + before["count"] > after["first"]:
            raise SystemExit(f"{name}: numbers from {after['first']} on would count twice")
    keep(name, {"stretches": stretches})


def keep(name: str, found: dict[str, Any]) -> None:
    """Put what was found into a record, then write the page."""
    text = json.dumps(kept(name) | found, indent=1) + "\n"
    (RECORDS / name).write_text(text, encoding="utf-8")
    write_page()


def kills_table(record: dict[str, Any]) -> str:
    """What was tried with each command."""
    head = "| Command | calls | that change | killed | error | full disk | power lost | faults |"
    rows = [head, "|---|" + "---:|" * 7]
    total = dict.fromkeys((*_WAYS, "faults"), 0)
    for name, one in record.get("commands", {}).items():
        counts = [one[way] for way in _WAYS] + [len(one["faults"])]
        for what, count in zip(total, counts, strict=True):
            total[what] += count
        tried = [_cell(one, way) for way in _WAYS]
        cells = [name, one["calls"], one["changes"], *tried, len(one["faults"])]
        rows.append("| " + " | ".join(map(str, cells)) + " |")
    rows.append("| **all** | | | " + " | ".join(f"{count:,}" for count in total.values()) + " |")
    return "\n".join(rows) + "\n"


def _cell(one: dict[str, Any], way: str) -> str:
    every = one["every"].get(way, 1)
    share = f" (1 of {every})" if every > 1 else ""
    return f"{one[way]}{share}" if one[way] else "–"


def stretches_table(record: dict[str, Any], what: str) -> str:
    """How the numbers of all stretches ended."""
    ends = Counter[str]()
    rows = [f"| {what} | how they ended | faults |", "|---|---|---:|"]
    for one in _joined(record.get("stretches", [])):
        counted = Counter[str]()
        for how, count in one["outcomes"].items():
            counted[how.partition(": ")[2] or how] += count
        ends.update(counted)
        last = one["first"] + one["count"] - 1
        where = f"run {one['run']}, {one['first']:,} to {last:,} ({one['version']})"
        faults = str(len(one["faults"]))
        if mended := sum("after_the_fix" in fault for fault in one["faults"]):
            faults += f", {mended} mended"
        rows.append(f"| {where} | {_counts(counted)} | {faults} |")
    rows.append(f"| **{sum(ends.values()):,} in all** | {_counts(ends)} | |")
    return "\n".join(rows) + "\n"


def claims_sentence(record: dict[str, Any]) -> str:
    """What the mutated cases say of their own errors, beside the truth."""
    if not (runs := record.get("claims")):
        return ""
    starts, sensitive, statements = (
        sum(one[what] for one in runs) for what in ("starts", "sensitive", "statements")
    )
    missed = [answer for one in runs for answer in one["missed"]]
    false = [one for one in missed if one["true"] > one["tolerance"]]
    small = [one for one in missed if one["true"] <= one["tolerance"]]
    text = (
        f"Of one case in {runs[0]['every']} ({len(runs)} times, other cases each time) the errors that it states are compared with its truth "
        f"([claims](claims.md)): {starts:,} starts, {sensitive} of them sensitive and left out, {statements:,} statements, "
        f"{statements - len(missed):,} hold."
    )
    if small:
        ratio = max(one["true"] / one["stated"] for one in small)
        share = max(one["true"] / one["tolerance"] for one in small)
        text += f" {len(small)} are too small, by up to {ratio:.1f} times, at errors of at most {share:.2g} of the tolerance."
    for one in false:
        text += (
            f" Case {one['number']} said {one['stated']:.2g} of a {_KIND[one['kind']]} that was {one['true']:.2g} off (tolerance {one['tolerance']:g})"
            f"{'; mended: ' + one['mended'] if 'mended' in one else ''}."
        )
    return text + "\n"


def _joined(stretches: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Stretches, those that follow one another in one run of one version as one."""
    joined: list[dict[str, Any]] = []
    for one in stretches:
        last = joined[-1] if joined else one
        if joined and (last["run"], last["version"], last["first"] + last["count"]) == (
            one["run"], one["version"], one["first"],
        ):  # fmt: skip
            ends = Counter(last["outcomes"]) + Counter(one["outcomes"])
            both = {"count": last["count"] + one["count"], "outcomes": dict(ends)}
            joined[-1] = last | both | {"faults": last["faults"] + one["faults"]}
        else:
            joined.append(one)
    return joined


def _counts(ends: Counter[str]) -> str:
    return ", ".join(f"{how} {count:,}" for how, count in sorted(ends.items()))


def foreign_tables(record: dict[str, Any]) -> str:
    """How workbooks of other libraries' tests ended, and what was lost, by name."""
    if not record:
        return "Not tried.\n"
    libraries = record["libraries"]
    files = sum(n for ends in libraries.values() for how, n in ends.items() if how[:6] == "small:")
    text = (
        f"{files:,} workbooks of the tests of {len(libraries)} libraries (none is part of this product): each is opened and parsed, gets sheets with every "
        "input table, results, formulas and a chart behind its own, and is recalculated; some also with the sheets of a filled example. Then "
        f"{record['parts']:,} parts are the same bytes, apart from the lists of sheets, names, parts and styles; in other sheets nothing differs but the stored "
        f"values of formulas: {record['removed']:,} are removed (named below), {record['renewed']:,} are renewed. "
        f"{record['about']}.\n\n"
        "| Library | calculated | with the example | not opened, merged or calculated |\n|---|---:|---:|---|\n"
    )
    for name, ends in libraries.items():
        other = {how.partition(": ")[2]: n for how, n in ends.items() if how.startswith("small: ")}
        done = other.pop("calculated", 0)
        cells = (done, ends.get("example: calculated", 0), _counts(Counter(other)) or "–")
        text += f"| {name} | " + " | ".join(map(str, cells)) + " |\n"
    text += "\nStored values that are removed, until a spreadsheet program opens the file:\n\n| File | removed | cells |\n|---|---:|---|\n"
    for one in record["by_name"]["removed"]:
        more = ", …" if one["count"] > len(one["cells"]) else ""
        cells = "; ".join(
            f"{sheet}: {', '.join(there)}" for sheet, there in _by_sheet(one["cells"])
        )
        text += f"| {_file(one)} | {one['count']} | {cells}{more} |\n"
    text += "\nFiles that are not calculated in, and why:\n\n| File | reason |\n|---|---|\n"
    for one in record["by_name"]["refused"]:
        if one["sheets"] == "small":
            said = one["said"].replace("|", r"\|").replace(one["file"].rpartition("/")[2], "it")
            said = f" {said[:160].rsplit(' ', 1)[0]} …" if len(said) > 160 else f" {said}"
            text += f"| {_file(one)} | {one['how']}:{said} |\n"
    return text


def _file(one: dict[str, Any]) -> str:
    return f"{one['library'].partition('/')[2]}: `{one['file'].rpartition('/')[2]}`"


def _by_sheet(cells: list[str]) -> list[tuple[str, list[str]]]:
    sheets: dict[str, list[str]] = {}
    for cell in cells:
        part, _, where = cell.partition(" ")
        sheets.setdefault(part.removesuffix(".xml"), []).append(where)
    return list(sheets.items())


def validators_sentence(record: dict[str, Any]) -> str:
    """What other programs said of the files that this one writes."""
    if not record:
        return "`make validate` has the Open XML SDK, Apache POI and veraPDF judge files of every kind; no run is recorded.\n"
    return (
        "`make validate` has the Open XML SDK, Apache POI and veraPDF judge files of every kind, and compares every cell with what Apache POI reads: "
        f"{record['files']} files, {record['parts']:,} parts, {record['cells']:,} cells, {record['errors']} errors ({record['version']}).\n"
    )


def soak_sentence(record: dict[str, Any]) -> str:
    """A million short calls of one server, and what its memory did."""
    if not record:
        return "No run of `python -m benchmarks.server_soak` is recorded.\n"
    first, *later = record["memory"]
    tenth, last = later[0], later[-1]
    return (
        f"`python -m benchmarks.server_soak` made {record['calls']:,} short calls of one server process in {record['requests']:,} requests of 1 to 100 calls (half of "
        f"them of one); half of the calls had to fail. Wrong answers: {len(record['wrong'])}. Resident memory of the server: {first['server']:.1f} MB before the "
        f"first call, {tenth['server']:.1f} MB after {tenth['calls']:,}, {last['server']:.1f} MB after {last['calls']:,}; largest on the way "
        f"{max(one['server'] for one in later):.1f} MB; of its processes {tenth['processes']:.1f} and {last['processes']:.1f} MB ({record['about']}).\n"
    )


def page() -> str:
    """The page."""
    limits, megabyte = DEFAULT_LIMITS, 2**20
    parts = {
        "{ratio}": limits.ratio,
        "{entries}": f"{limits.entries:,}",
        **{
            f"{{{name}}}": getattr(limits, name) // megabyte
            for name in (
                "ratio_from",
                "part_size",
                "total_size",
                "file_size",
                "inflated",
                "texts",
                "strict",
            )
        },
        "{fuzz}": stretches_table(kept("workbook_fuzz.json"), "Workbooks"),
        "{mutations}": stretches_table(kept("mutated_cases.json"), "Cases"),
        "{claims}": claims_sentence(kept("mutated_cases.json")),
        "{foreign}": foreign_tables(kept("foreign_workbooks.json")),
        "{soak}": soak_sentence(kept("server_soak.json")),
        "{validate}": validators_sentence(kept("validate.json")),
        "{kills}": _OF_THE_KILLS + kills_table(kept("file_calls.json")),
    }
    text = TEXT.read_text("utf-8")
    for mark, value in parts.items():
        if mark not in text:
            raise SystemExit(f"{TEXT.name} has no place for {mark}")
        text = text.replace(mark, str(value))
    return text


def write_page() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    write_page()
