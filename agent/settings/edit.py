"""A configuration file with one entry changed: all else stays as it is written, comments too; pure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

import yaml

Part = Literal["loops", "connections"]
WIDTH = 110
"""Longest line of an entry, characters."""


class EditError(ValueError):
    """The file is not written in a way that can be edited; a person must do it."""


def entry_yaml(entry: Mapping[str, Any]) -> str:
    """Return an entry of a loop or a connection as YAML, a key a line."""
    lines = []
    for key, value in entry.items():
        leaf = not isinstance(value, Mapping | list | tuple)
        lines.append(
            yaml.safe_dump(
                {key: value},
                sort_keys=False,
                allow_unicode=True,
                width=WIDTH,
                default_flow_style=False if leaf else None,
            )
        )
    return "".join(lines)


def written(text: str) -> dict[Part, dict[str, str]]:
    """Return how each entry of a file is written, with its comments: part -> name -> text."""
    root = yaml.compose(text, yaml.SafeLoader)  # once: of a thousand loops it takes half a second
    return {
        "connections": {name: _written(text, each) for name, each in _named(_value(root, "connections"))},
        "loops": {name: _written(text, each) for name, each in _named(_value(root, "loops"))},
    }


def _named(node: yaml.Node | None) -> Iterator[tuple[str, yaml.Node]]:
    """Yield the entries of a part of the file that have a name."""
    if isinstance(node, yaml.MappingNode):
        yield from ((str(key.value), value) for key, value in node.value)
    for each in node.value if isinstance(node, yaml.SequenceNode) else []:
        name = _name_of(each) if isinstance(each, yaml.MappingNode) else None
        if name is not None:
            yield name, each


def _written(text: str, node: yaml.Node) -> str:
    """Return how one entry is written."""
    if not isinstance(node, yaml.MappingNode) or node.flow_style:
        return text[node.start_mark.index : int(node.end_mark.index)] + "\n"
    column = node.start_mark.column
    lines = text[node.start_mark.index : _line_end(text, _end(node))].split("\n")
    return (
        "\n".join([lines[0], *(line[min(column, len(line) - len(line.lstrip())) :] for line in lines[1:])])
        + "\n"
    )


def edited(text: str, part: Part, name: str, entry: str) -> str:
    """Return the text of a file in which the entry called ``name`` is ``entry``; it is new or replaced.

    Args:
        text: The whole file, readable YAML.
        part: Where the entry is.
        name: Of the loop or the connection.
        entry: Its content as YAML, a mapping; that of a loop has its name as well.

    Raises:
        EditError: The entry is no mapping, or its part is missing, or not written with a line for each entry.
    """
    content = yaml.safe_load(entry)
    if not isinstance(content, Mapping) or not content:
        raise EditError("expected a mapping, a line for each setting")
    node = _value(yaml.compose(text, yaml.SafeLoader), part)
    if node is None:
        raise EditError(f"the file has no {part}")
    changed = (_in_list if part == "loops" else _in_mapping)(text, node, name, entry.strip("\n"))
    if _with(yaml.safe_load(text), part, name, content) != yaml.safe_load(changed):
        raise EditError(f"{part} cannot be edited here: it is written with anchors or in an unusual layout")
    return changed


def _entry(node: yaml.Node, name: str) -> yaml.Node | None:
    return next((each for known, each in _named(node) if known == name), None)


def _in_list(text: str, node: yaml.Node, name: str, entry: str) -> str:
    if not isinstance(node, yaml.SequenceNode) or node.flow_style or not node.value:
        raise EditError("loops is not written as a list with a dash for each loop")
    item = _entry(node, name)
    if item is not None:
        return _replaced(text, item.start_mark.index, item, _indented(entry, item.start_mark.column))
    last = node.value[-1]
    line = text[: last.start_mark.index].rpartition("\n")[2]
    dash = " " * line.rindex("-")
    return _after(text, last, f"\n{dash}- {_indented(entry, len(dash) + 2)}")


def _in_mapping(text: str, node: yaml.Node, name: str, entry: str) -> str:
    if not isinstance(node, yaml.MappingNode) or node.flow_style or not node.value:
        raise EditError("connections is not written as a mapping with a line for each connection")
    column = node.value[0][0].start_mark.column
    inner = column + 2
    content = f"\n{' ' * inner}{_indented(entry, inner)}"
    for key, value in node.value:
        if str(key.value) == name:
            return _replaced(text, text.index(":", key.end_mark.index) + 1, value, content)
    key = yaml.safe_dump(name).splitlines()[0]
    return _after(text, node.value[-1][1], f"{' ' * column}{key}:{content}")


def _replaced(text: str, start: int, node: yaml.Node, content: str) -> str:
    return text[:start] + content + text[_line_end(text, _end(node)) :]


def _after(text: str, node: yaml.Node, content: str) -> str:
    """Return the text with lines behind a node."""
    end = _line_end(text, _end(node))
    return f"{text[:end].rstrip(chr(10))}\n{content}{text[end:] or chr(10)}"


def _indented(entry: str, column: int) -> str:
    """Return an entry whose first line begins at ``column``."""
    return "\n".join(
        (" " * column if number and line.strip() else "") + line
        for number, line in enumerate(entry.split("\n"))
    )


def _end(node: yaml.Node) -> int:
    """Return where what is written of a node ends; that of a block ends with the last value in it."""
    if isinstance(node, yaml.MappingNode) and not node.flow_style and node.value:
        return _end(node.value[-1][1])
    if isinstance(node, yaml.SequenceNode) and not node.flow_style and node.value:
        return _end(node.value[-1])
    return int(node.end_mark.index)


def _line_end(text: str, index: int) -> int:
    """Return the end of the line that holds ``index``: a comment behind a value goes with it."""
    end = text.find("\n", index)
    return len(text) if end < 0 else end


def _value(root: yaml.Node | None, key: str) -> yaml.Node | None:
    pairs = root.value if isinstance(root, yaml.MappingNode) else []
    return next((value for each, value in pairs if each.value == key), None)


def _name_of(item: yaml.MappingNode) -> str | None:
    return next((str(value.value) for key, value in item.value if key.value == "name"), None)


def _with(content: Any, part: Part, name: str, entry: Mapping[str, Any]) -> Any:  # noqa: ANN401 - YAML
    """Return the wanted content of the file."""
    if part == "connections":
        return content | {part: content[part] | {name: dict(entry)}}
    loops = [dict(entry) if each.get("name") == name else each for each in content[part]]
    if all(each.get("name") != name for each in content[part]):
        loops.append(dict(entry))
    return content | {part: loops}
