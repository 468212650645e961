"""Directive ``command``: usage, arguments and options of a command, read from the program."""

from __future__ import annotations

import inspect
from typing import Any

import typer
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from toothspace.cli.application import application

KINDS = {"Path": "FILE", "int": "NUMBER", "float": "NUMBER", "str": "TEXT"}


def commands() -> dict[str, Any]:
    """Every command of the program by its name."""
    return dict(typer.main.get_command(application).commands)


def shown(parameter: Any) -> str:
    """One option as it is typed."""
    names = ", ".join(f"`{name}`" for name in (*parameter.opts, *parameter.secondary_opts))
    if getattr(parameter, "is_flag", False):
        return names
    kind = getattr(parameter.type_descriptor.annotation, "__name__", "TEXT")
    return f"{names} `{parameter.metavar or KINDS.get(kind, kind.upper())}`"


def default_of(parameter: Any) -> str:
    """What an option is when it is left out."""
    value = parameter.default
    plain = isinstance(value, str | int | float) or hasattr(value, "suffix")
    hidden = not plain or isinstance(value, bool) or not str(value)
    return "" if hidden else f" Default `{value}`."


def markdown(name: str) -> str:
    """Usage, arguments and options of a command."""
    command = commands()[name]
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option"]
    typed = [p.metavar if p.required else f"[{p.metavar}]" for p in arguments]
    usage = " ".join(["toothspace", name, *(["[OPTIONS]"] if options else []), *typed])
    lines = [inspect.cleandoc(command.help), "", "```sh", usage, "```", ""]
    if command.params:
        lines += ["| argument or option | meaning |", "|---|---|"]
        lines += [f"| `{p.metavar}` | {p.help or ''} |" for p in arguments]
        lines += [f"| {shown(p)} | {p.help or ''}{default_of(p)} |" for p in options]
    return "\n".join(lines) + "\n"


class CommandDirective(SphinxDirective):
    """``{command} run``."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Put the description in place of the directive."""
        (name,) = self.arguments
        if name not in commands():
            raise self.error(f"no command {name!r}, there are {', '.join(commands())}")
        return self.parse_text_to_nodes(markdown(name))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command", CommandDirective)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
