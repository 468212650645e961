"""Exceptions that a user sees as clear lines: they carry what is wrong and are rendered once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, Self


class ToothspaceError(Exception):
    """Base of every error that the package raises on purpose."""


class Problem(NamedTuple):
    """What is wrong with one key, option or file."""

    key: str
    """Path of the key, or the option; empty for what is whole."""
    found: str
    allowed: str
    """What stands there and what may stand there."""
    sentence: str = ""
    """What is said instead, where nothing was found in place of something else."""
    file: str = ""
    """File that it stands in; empty if unknown."""
    line: int = 0
    """Line of the file; zero if unknown."""

    def __str__(self) -> str:
        said = self.sentence or f"found {self.found}, allowed {self.allowed}"
        text = ": ".join(part for part in (self.file, self.key, said) if part)
        return f"{text} (line {self.line})" if self.line else text


class CaseError(ToothspaceError):
    """Something asks for the impossible: names file, key, value found and what is allowed.

    Parameters
    ----------
    *said : object
        Key, what stands there and what may stand there; or one sentence.
    """

    def __init__(self, *said: object) -> None:
        self.problems: tuple[Problem, ...] = ()
        if len(said) == 3:
            key, found, allowed = map(str, said)
            self.problems = (Problem(key, found, allowed),)
        elif said:
            self.problems = (Problem("", "", "", sentence=" ".join(map(str, said))),)
        super().__init__(*said)

    def __str__(self) -> str:
        return "\n".join(map(str, self.problems))

    @classmethod
    def of(cls, problems: Iterable[Problem]) -> Self:
        """Return one error of one or more problems."""
        error = cls()
        error.problems = tuple(problems)
        return error

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).of, (self.problems,)

    def changed(self, change: Callable[[Problem], Problem]) -> Self:
        """Return the same kind of error of changed problems."""
        return self.of(map(change, self.problems))

    def under(self, path: str) -> Self:
        """Return the same error with a path in front of its keys."""
        return self.changed(lambda one: one._replace(key=joined(path, one.key)))

    def read_for(self, key: str) -> Self:
        """Return the same error with the key whose file or parts have its problems."""
        return self.changed(lambda one: one._replace(key=f"{key}: {one.key}" if one.key else key))

    def naming(self, path: str, name: str) -> Self:
        """Return the same error with the name of a file in place of its path."""
        texts = ("key", "found", "allowed", "sentence")

        def short(one: Problem) -> Problem:
            named = {text: getattr(one, text).replace(path, name) for text in texts}
            return one._replace(**named)

        return self.changed(short)

    def in_file(self, name: str) -> Self:
        """Return the same error with the file of problems that name none."""
        return self.changed(lambda one: one._replace(file=one.file or name))


class GeometryError(CaseError):
    """A profile or machine geometry cannot be built: names what was found and what is allowed."""


def joined(path: str, key: str) -> str:
    """Path of a key inside a table or list."""
    return f"{path}{'.' if path and key and not key.startswith('[') else ''}{key}"
