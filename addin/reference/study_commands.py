"""The commands of the studies as a small table, so that --help needs none of their modules."""

from __future__ import annotations

from addin.studies.registry import found_studies


def study_commands() -> str:
    """The text of that module, of the studies that are found."""
    lines = [
        '"""Commands of the studies and their lines of help; written by `make generated`."""',
        "",
        "STUDY_COMMANDS = {",
    ]
    for study in found_studies():
        line = " ".join(study.command_help.split("\n\n")[0].split())
        lines.append(f'    "{study.command}": "{line}",')
    return "\n".join([*lines, "}", ""])
