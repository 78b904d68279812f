"""The code in the documentation runs: all Python blocks of a page in order, in one namespace, in an empty folder."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


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


@pytest.mark.parametrize("name", ["README.md", "docs/tutorial.md"])
def test_code_of_page_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "models").symlink_to(ROOT / "models")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    exec(compile(python_blocks(ROOT / name), str(ROOT / name), "exec"), {"__name__": "page"})


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")) + [ROOT / "README.md"], ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    generated = {"verification.md"}  # by docs/make_verification.py
    broken = [link for link in links if "://" not in link and not (page.parent / link).exists()
              and Path(link).name not in generated]  # fmt: skip
    assert not broken


def test_commands_of_readme_exist() -> None:
    """Every verb and option the README and the pages show is one the program has."""
    import typer

    from floatsim.cli import app

    verbs = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        for verb, rest in re.findall(r"\bfloatsim (\w+) (?:models/|\w+\.nc)([^\n&|]*)", page.read_text(encoding="utf-8")):
            assert verb in verbs, f"{page.name}: floatsim {verb}"
            known = {option for parameter in verbs[verb].params for option in parameter.opts}
            assert set(re.findall(r"(?<= )--?[a-z]+", rest)) <= known, f"{page.name}: floatsim {verb} ...{rest}"
