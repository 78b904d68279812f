"""The code in the documentation runs: all Python blocks of a page in order, in one namespace, in its own folder."""

import re
import sys
from pathlib import Path

import pytest
import typer

from floatsim.cli import app

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
HOWTOS = [(f"docs/{page.name}",) for page in PAGES if page.name.startswith("howto_")]


def python_blocks(page: Path) -> str:
    """The page's Python blocks as one script whose line numbers are the page's."""
    text = page.read_text(encoding="utf-8")
    script = ["" for _ in text.splitlines()]
    for block in re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        first = text.count("\n", 0, block.start(1))
        for k, line in enumerate(block[1].splitlines()):
            script[first + k] = line
    assert any(script), f"{page.name} has no Python blocks"
    return "\n".join(script)


@pytest.mark.parametrize(
    "pages",
    [("README.md",), ("docs/tutorial.md", "docs/output.md"), ("docs/contributing.md",), *HOWTOS],
    ids=" ".join,  # output reads tutorial's file
)
def test_code_of_pages_runs(pages: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "models").symlink_to(ROOT / "models")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    for name in pages:
        exec(compile(python_blocks(ROOT / name), str(ROOT / name), "exec"), {"__name__": "page"})


def test_no_page_with_code_is_left_out() -> None:
    tested = {"README.md", "tutorial.md", "output.md", "contributing.md"}
    tested |= {Path(name).name for (name,) in HOWTOS}
    assert {page.name for page in PAGES if "```python" in page.read_text(encoding="utf-8")} == tested


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    made = {"verification.md"}  # by docs/make_verification.py
    assert not [link for link in links if not (page.parent / link).exists() and Path(link).name not in made]


def test_commands_on_pages_exist() -> None:
    """Every verb and long option that README and pages show is one the program has."""
    verbs = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    command = re.compile(r"\bfloatsim ([a-z]+) (?:models/|MODEL|[a-z]+\.nc|OUT)([^\n&|`]*)")
    shown = 0
    for page in PAGES:
        for verb, rest in command.findall(page.read_text(encoding="utf-8")):
            assert verb in verbs, f"{page.name}: floatsim {verb}"
            known = {option for parameter in verbs[verb].params for option in parameter.opts}
            assert set(re.findall(r"(?<= )--[a-z]+", rest)) <= known, f"{page.name}: floatsim {verb} ...{rest}"
            shown += 1
    assert shown >= 10


def test_every_figure_is_drawn_and_shown() -> None:
    drawn = {path.stem for path in (ROOT / "docs" / "figures").glob("*.svg")}
    scripts = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "docs").glob("*figures*.py"))]
    known = {name for script in scripts for name in re.findall(r'^    "([a-z_0-9]+)": \(\1, ', script, re.MULTILINE)}
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"\(figures/([a-z_0-9]+)\.svg\)", page))
    assert drawn == known == shown and drawn
