"""The command line, one module a command; the only room that prints.

================  ================================================================================
module            responsibility
================  ================================================================================
`options`         arguments and options that several commands take
`overrides`       settings of a calculation that are given on the command line
`status`          how a command ends: the exit statuses, and the refusal of an input or a file
`terminal`        what commands print: tables, written files, progress, problems, refusals
`diff_view`       differences as tables on the terminal
`batch`           ``torsionbook batch``: folders of workbooks, overnight
`calc`            ``torsionbook calc``: the worksheet functions in LibreOffice Calc
`diff`            ``torsionbook diff``: what changed between two revisions, and what it did
`excel`           ``torsionbook excel``: the worksheet functions into a workbook, and help where
                  they do not work
`serve`           `torsionbook serve`
`mcp`             `torsionbook mcp`
`study_commands`  commands of the studies and their lines of help; written by `make generated`
`app`             the command line: the same path on files as in Excel, without Excel
`check`           `torsionbook check`: errors of inputs with their cells, and answers that cannot
                  be given yet
`export`          `torsionbook export`: inputs as a case JSON, or the train as others read it
`upgrade`         a workbook of an earlier release as one of this version
`new`             A workbook to fill in, of the variant that its program needs
`import_`         `torsionbook import`: a train from a table of text, openTorsion or ROSS
`recalc`          `torsionbook recalc`: inputs calculated, results written, and a summary of them
`report`          `torsionbook report`
`study`           what the commands of the studies have in common: targets, processes, Ctrl-C, the
                  words at the end
`verify`          ``torsionbook verify``: whether the results in a file follow from the inputs in
                  it
`version`         `torsionbook version`
================  ================================================================================
"""

from addin.cli.app import main

__all__ = ["main"]
