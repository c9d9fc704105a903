"""The page that says of every command what it does and takes, from the command line itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer

from survey.cli import app
from survey.exit_status import MEANINGS

HEAD = """# Every command

`bathyflash COMMAND --help` says the same in a terminal. `SCENARIO` is a file, or the name of one
that comes with the package (`bathyflash scenarios`); `RUN` is a run folder.
"""


def command_reference() -> str:
    """Return every command with its arguments and options, and what exit statuses mean."""
    group: Any = typer.main.get_command(app)
    context = typer.Context(group, info_name="bathyflash")
    lines = [HEAD]
    for name, command in group.commands.items():
        lines += _section(name, command, typer.Context(command, info_name=name, parent=context))
    return "\n".join([*lines, "", *_statuses()]) + "\n"


def _section(name: str, command: Any, context: typer.Context) -> Iterator[str]:
    usage = " ".join(("bathyflash", name, *command.collect_usage_pieces(context)))
    yield from ("", f"## {name}", "", command.help or "", "", "```", usage, "```", "")
    records = [param.get_help_record(context) for param in command.get_params(context)]
    yield from ("| | |", "|---|---|")
    for left, right in filter(None, records):
        yield f"| `{left}` | {_plain(right)} |"


def _plain(text: str) -> str:
    """Return text whose brackets make no link and whose bars make no cell."""
    return " ".join(text.split()).replace("[", "\\[").replace("|", "&#124;")


def _statuses() -> Iterator[str]:
    yield from ("## Exit status", "", "| | |", "|---|---|")
    yield from (f"| {status} | {meaning} |" for status, meaning in MEANINGS.items())
