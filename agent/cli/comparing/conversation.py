"""The conversation: a view of the newest model, one command of the user, the next view."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.cli.comparing.words import View, lines_of, prompt_of, view_of
from agent.report.terminal_pictures import residual_lines

if TYPE_CHECKING:
    from agent.workbench.comparison import Comparison
    from agent.workbench.session import Workbench

Read = Callable[[str], str | None]
"""Shows a prompt, returns a line; None at the end of input."""
Print = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Files:
    """Writes what a user wants to have in a file; each returns a line to print."""

    report: Callable[[Workbench, Comparison, str], str]
    model: Callable[[Workbench, str], str]


class UnclearError(ValueError):
    """A line is no command; the text says what was expected."""


class Conversation:
    """One session, until the user quits or the input ends."""

    def __init__(
        self, bench: Workbench, read: Read, show: Print, files: Files, keep: Callable[[Workbench], None]
    ) -> None:
        """Begin.

        Args:
            bench: A session whose recording is testable.
            read: Gets one line of the user.
            show: Prints one line.
            files: Writers of reports and models.
            keep: Called after each change, to keep the session.
        """
        self.bench, self._read, self._show, self._files, self._keep = bench, read, show, files, keep
        self._view: View | None = None

    def run(self) -> None:
        """Show the newest model and obey commands until the end."""
        self._present()
        while (line := self._read(prompt_of(self._current()))) is not None:
            try:
                if not self._obey(line.strip()):
                    return
            except ValueError as error:
                self._show(f"{error}")

    def _current(self) -> View:
        if self._view is None:
            self._view = view_of(self.bench.comparison())
            self._keep(self.bench)
        return self._view

    def _present(self) -> None:
        self._lines(lines_of(self._current()))

    def _changed(self) -> None:
        self._view = None
        self._present()

    def _lines(self, lines: Iterable[str]) -> None:
        for line in lines:
            self._show(line)

    def _obey(self, line: str) -> bool:
        """Obey one line; return whether the conversation goes on."""
        word, _, argument = line.partition(" ")
        argument = argument.strip()
        if word in {"quit", "q", "exit"}:
            return False
        if not word:
            self._add_proposed()
        elif word.isdecimal():
            self._add_number(int(word))
        elif word in COMMANDS:
            COMMANDS[word].act(self, argument)
        else:
            raise UnclearError(f"{line!r} is no command; ? lists them")
        return True

    def _add_proposed(self) -> None:
        proposed = self._current().proposed
        if proposed is None:
            raise UnclearError("nothing more is confirmed or suggested; a number adds an effect all the same")
        self.add(proposed)

    def _add_number(self, number: int) -> None:
        numbered = self._current().numbered
        if not 1 <= number <= len(numbered):
            raise UnclearError(f"there is no candidate {number}; numbers go from 1 to {len(numbered)}")
        self.add(numbered[number - 1].effect)

    def add(self, name: str) -> None:
        """Add an effect and show the new step."""
        if not name:
            raise UnclearError("add which effect? For example: add stiction")
        self.bench.add(name)
        self._changed()

    def drop(self, name: str) -> None:
        """Take an effect out and show the new step."""
        if not name:
            raise UnclearError("drop which effect? For example: drop stiction")
        self.bench.drop(name)
        self._changed()

    def undo(self, _: str) -> None:
        """Take back the last step."""
        self.bench.undo()
        self._changed()

    def auto(self, _: str) -> None:
        """Go on until nothing more is confirmed."""
        self.bench.auto()
        self._changed()

    def where(self, axis: str) -> None:
        """Show the residual against an axis."""
        panels = {each.axis: each for each in self._current().found.where_it_fails}
        name = axis.replace(" ", "_")
        if name not in panels:
            raise UnclearError(f"the axes are {', '.join(panels)}; for example: where {next(iter(panels))}")
        self._lines(residual_lines(panels[name]))

    def report(self, path: str) -> None:
        """Write the page of this session."""
        if not path:
            raise UnclearError("to which file? For example: report FIC101.html")
        if not path.lower().endswith((".html", ".htm")):
            raise UnclearError(f"{path}: the report is a page: expected a name that ends with .html")
        self._show(self._files.report(self.bench, self._current().found, path))

    def save(self, path: str) -> None:
        """Write the model."""
        if not path:
            raise UnclearError("to which file? For example: save FIC101.yaml")
        self._show(self._files.model(self.bench, path))

    def show(self, _: str) -> None:
        """Show the newest model again."""
        self._present()

    def help(self, _: str) -> None:
        """List the commands."""
        self._lines(_help_lines())


@dataclass(frozen=True, slots=True)
class Word:
    """What a word does."""

    example: str
    does: str
    act: Callable[[Conversation, str], None]


COMMANDS: Mapping[str, Word] = {
    "add": Word("add stiction", "adds an effect by its name and fits everything again", Conversation.add),
    "drop": Word("drop stiction", "takes an effect out of the model", Conversation.drop),
    "undo": Word("undo", "goes back one step; the step is kept and costs nothing again", Conversation.undo),
    "auto": Word("auto", "adds what is confirmed until nothing more is", Conversation.auto),
    "where": Word("where op_level", "shows the residual against another axis", Conversation.where),
    "show": Word("show", "shows the newest model again", Conversation.show),
    "report": Word("report FIC101.html", "writes a page with all steps and pictures", Conversation.report),
    "save": Word("save FIC101.yaml", "writes the model, for compare --load", Conversation.save),
    "help": Word("help", "lists the commands, as ? does", Conversation.help),
    "?": Word("?", "lists the commands", Conversation.help),
}


def _help_lines() -> Iterator[str]:
    yield f"  {'Enter':22}adds the effect that is proposed"
    yield f"  {'2':22}adds the effect of that number"
    for word, each in COMMANDS.items():
        if word != "?":
            yield f"  {each.example:22}{each.does}"
    yield f"  {'quit':22}ends; the session is kept, and the same command goes on with it"
