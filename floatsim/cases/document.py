"""A YAML file as plain data with the line of every entry: what is wrong with one is said where it stands.

Read by PyYAML's safe loader, with the plain words of YAML 1.2: 1e3 is a number, yes, no, on and off are text, 010 is
ten, a date or a time is text; true, false and null are what they say. A key that is there twice is refused, and so is
a placeholder `<...>` of a template that has not been filled.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from floatsim.errors import CaseError

Key = tuple[str | int, ...]  # names and places from the top of the file to an entry
_COLLECTIONS = ("tag:yaml.org,2002:map", "tag:yaml.org,2002:seq")
_MOST = 200_000  # entries, aliases unfolded


class _Loader(yaml.SafeLoader):
    """The safe loader with the words of YAML 1.2's core schema."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}


for _tag, _pattern, _first in (
    ("null", r"~|null|Null|NULL|", "~nN"),
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
     "-+0123456789."),
):  # fmt: skip
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), [*_first, ""])


class Document:
    """A file's data, and where each entry stands. Raises CaseError for a file that cannot be read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lines: dict[Key, int] = {}
        self._problems: list[str] = []
        self._count = 0
        try:
            root = yaml.compose(path.read_text(encoding="utf-8"), _Loader)
        except OSError as error:
            raise CaseError(f"matrix '{path}' cannot be read: {error.strerror or error}") from None
        except UnicodeDecodeError as error:
            raise CaseError(f"matrix '{path}' is no text in UTF-8: {error.reason}") from None
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            where = f", line {mark.line + 1}" if mark else ""
            said = getattr(error, "problem", None) or " ".join(str(error).split())
            if "<block" in said:  # the parser's word for lines that do not stand in one column
                said = "keys of one level must begin in the same column"
            raise CaseError(f"{path.name}{where}: this is no YAML: {said}") from None
        except RecursionError:
            raise CaseError(f"{path.name}: nested too deeply") from None
        self.data: Any = None if root is None else self._plain(root, (), ())
        if self._problems:
            raise CaseError(self._problems)

    def at(self, key: Key) -> str:
        """`file.yaml, line 12, variables.hs` for an entry, or the nearest one above it."""
        known = key
        while known and known not in self._lines:
            known = known[:-1]
        line = f", line {self._lines[known]}" if known in self._lines else ""
        return f"{self.path.name}{line}" + (f", {dotted(key)}" if key else "")

    def _plain(self, node: yaml.Node, key: Key, above: tuple[int, ...]) -> Any:
        self._count += 1
        if id(node) in above or self._count > _MOST:
            raise CaseError(f"{self.at(key)}: aliases that unfold without end")
        self._lines.setdefault(key, node.start_mark.line + 1)
        above = (*above, id(node))
        if not isinstance(node, yaml.ScalarNode) and node.tag not in _COLLECTIONS:
            self._problems.append(f"{self.at(key)}: the tag {node.tag} is not understood; write plain values")
        if isinstance(node, yaml.MappingNode):
            return self._mapping(node, key, above)
        if isinstance(node, yaml.SequenceNode):
            return [self._plain(item, (*key, k), above) for k, item in enumerate(node.value)]
        assert isinstance(node, yaml.ScalarNode)
        return self._scalar(node, key)

    def _mapping(self, node: yaml.MappingNode, key: Key, above: tuple[int, ...]) -> dict[str, Any]:
        out: dict[str, Any] = {}
        for name_node, value in node.value:
            if not isinstance(name_node, yaml.ScalarNode):
                self._problems.append(f"{self.at(key)}: a key must be a name")
                continue
            name, line = name_node.value, name_node.start_mark.line + 1
            if name in out:
                first = self._lines[(*key, name)]
                self._problems.append(
                    f"{self.path.name}, line {line}, {dotted((*key, name))}: the key is there twice, first in line "
                    f"{first}"
                )
                continue
            self._lines[(*key, name)] = line
            out[name] = self._plain(value, (*key, name), above)
        return out

    def _scalar(self, node: yaml.ScalarNode, key: Key) -> Any:
        text = node.value
        if node.tag.endswith(":str"):
            if re.fullmatch(r"<.*>", text, re.DOTALL):
                self._problems.append(f"{self.at(key)}: to be filled in: {' '.join(text[1:-1].split())}")
            return text
        if node.tag.endswith(":null"):
            return None
        if node.tag.endswith(":bool"):
            return text.lower() == "true"
        try:
            if node.tag.endswith(":int"):
                return int(text)
            if node.tag.endswith(":float"):
                return float(re.sub(r"\.(?=[a-zA-Z])", "", text))
        except ValueError:
            pass
        self._problems.append(f"{self.at(key)}: '{text}' with the tag {node.tag} is not understood; write plain values")
        return None


def dotted(key: Key) -> str:
    """('blocks', 0, 'waves') -> blocks[0].waves."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in key)
    return text.removeprefix(".")
