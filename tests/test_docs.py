"""What the documentation says of the project is true of the project."""

import ast
import json
import re
import runpy
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from elbowroom.cli.app import app
from elbowroom.sensing import NOISE_PRESETS

PROJECT = Path(__file__).resolve().parents[1]
SOURCE = PROJECT / "src" / "elbowroom"
PAGES = [*PROJECT.glob("*.md"), *(PROJECT / "docs").glob("*.md"), *(PROJECT / "examples").glob("*.md")]
TEST_COMMAND = "python3 -m venv .venv && .venv/bin/pip install -e '.[test]' && .venv/bin/pytest"
MAIN_COMMAND = "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/elbowroom monitor"
KERNELS = sorted(p for p in SOURCE.rglob("kernels/*.py") if p.stem != "__init__")
KERNEL_LIBRARIES = {"math", "typing", "numpy", "numba", "llvmlite"}


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(SOURCE.parent).with_suffix("").parts)


def anchors_of(page: Path) -> set[str]:
    """Headings as GitHub names them in links."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path).resolve() if path else page
        assert linked.exists(), f"{page.name}: {target} leads nowhere"
        if anchor:
            assert anchor in anchors_of(linked), f"{page.name}: {target} has no such heading"


def test_readme_has_the_two_commands_word_for_word() -> None:
    lines = (PROJECT / "README.md").read_text(encoding="utf-8").splitlines()
    commands = [line.strip() for line in lines if line.strip().startswith("python3 -m venv")]
    assert commands == [MAIN_COMMAND, TEST_COMMAND]


def test_example_of_the_readme_answers_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(
        r"```python\n(.*?)```", (PROJECT / "README.md").read_text(encoding="utf-8"), re.DOTALL
    )
    (example,) = blocks
    names: dict[str, Any] = {}
    exec(compile(example, "README.md", "exec"), names)
    space, verdict = names["space"], names["verdict"]
    told = re.search(r"verdict\.cause  # (.*)$", example, re.MULTILINE)
    assert told is not None
    assert told[1] == f'{verdict.level}, "{verdict.band}", {verdict.free_travel:.3f}, {verdict.cause}'
    assert "is free\n  north: sees through it" in capsys.readouterr().out
    assert space.free.shape == (200, 200, 125)
    assert (space.free.astype(int) + space.surface + space.unseen == 1).all()
    assert (names["truth"].free | space.surface).all()
    assert names["lidar"].cameras == ("lidar-1",)


def test_continuous_integration_runs_the_test_command_of_the_readme() -> None:
    lines = (PROJECT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert TEST_COMMAND in [line.strip() for line in lines]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_that_pages_name_exist(page: Path) -> None:
    root = typer.main.get_command(app)
    for words in re.findall(r"\belbowroom ((?:[a-z]+(?:-[a-z]+)* ?)+)", commands_in(page)):
        command = root
        for word in words.split():
            known = getattr(command, "commands", None)
            if known is None:
                break
            assert word in known, f"{page.name}: elbowroom {words} is no command"
            command = known[word]


def commands_in(page: Path) -> str:
    """All code of a page that may hold a command line, a piece a line."""
    text = page.read_text(encoding="utf-8")
    indented = re.findall(r"^    (\S.*)$", text, re.MULTILINE)
    return "\n".join([*re.findall(r"`(elbowroom [^`]+)`", text), *indented])


def test_headings_that_code_points_to_exist() -> None:
    for path in SOURCE.rglob("*.py"):
        text = " ".join(path.read_text(encoding="utf-8").split())
        for name, heading in re.findall(r'(docs/\w+\.md)(?:, "([^"]+)")?', text):
            assert (PROJECT / name).is_file(), f"{path.name}: {name}"
            found = f"## {heading}\n" in (PROJECT / name).read_text(encoding="utf-8")
            assert found or not heading, f"{path.name}: {name} has no heading {heading}"


def test_noise_table_has_every_preset_with_its_coefficients() -> None:
    text = (PROJECT / "docs" / "safety.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", text, re.MULTILINE))
    for name, model in NOISE_PRESETS.items():
        told = {float(number) for number in re.findall(r"\d+\.\d+", rows[name])}
        given = {model.constant_m, model.linear, model.quadratic, model.offset_m} - {0.0}
        assert told == given, f"safety.md: {name}"


def _forget_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [
        name for name in sys.modules if name.partition(".")[0] in ("ages", "render_docs", "result_tables")
    ]:
        monkeypatch.delitem(sys.modules, name)


@pytest.mark.parametrize("page, script", [("benchmarks", "docs"), ("reliability", "reliability")])
def test_page_of_benchmarks_is_what_the_results_say(
    page: str, script: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(PROJECT / "benchmarks"))
    rendered = runpy.run_path(str(PROJECT / "benchmarks" / f"render_{script}.py"))["render"]()
    _forget_tables(monkeypatch)
    text = (PROJECT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    assert text.replace(_since(), "") == rendered, f"run: python benchmarks/render_{script}.py"


def test_page_of_benchmarks_shows_what_misses_its_due_figure(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.syspath_prepend(str(PROJECT / "benchmarks"))
    names = runpy.run_path(str(PROJECT / "benchmarks" / "render_docs.py"))
    render = names["render"]
    _forget_tables(monkeypatch)
    room = '"cameras": 21, "width": 640, "height": 480, "rule": "three", "detail": "pixel", "noise": false'
    for found, words in ((96.5, "**96.50** (due ≥ 97: missed)"), (97.5, "97.50 (due ≥ 97)")):
        row = f'{{"voxel_size_m": 0.02, {room}, "occupied_pct": 100.0, "found_pct": {found}}}'
        text = f'{{"meta": {{"command": "c", "commit": "abc", "processor": "p"}}, "rows": [{row}]}}'
        (tmp_path / "evaluate_room.json").write_text(text)
        page = render(tmp_path)
        assert words in page
        assert "Measured by `c`; commit abc; p." in page
        assert page.count("Not measured yet.") == len(names["SECTIONS"]) - 1


@pytest.mark.parametrize("path", KERNELS, ids=module_name)
def test_kernels_import_numbers_and_other_kernels_only(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        for name in names:
            is_kernel = name.startswith("elbowroom.") and "kernels" in name.split(".")
            assert is_kernel or name.partition(".")[0] in KERNEL_LIBRARIES, f"{path.name} imports {name}"


def test_nothing_is_compiled_outside_the_folders_of_kernels() -> None:
    outside = [path for path in SOURCE.rglob("*.py") if "kernels" not in path.parts]
    assert not [
        path for path in outside if re.search(r"^@(njit|uncounted)\b", path.read_text(encoding="utf-8"), re.M)
    ]


def test_pictures_are_light() -> None:
    for picture in (PROJECT / "docs" / "images").iterdir():
        assert picture.stat().st_size <= 300_000, picture.name


def test_page_of_the_experiments_is_what_the_results_say(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(PROJECT / "benchmarks"))
    rendered = runpy.run_path(str(PROJECT / "benchmarks" / "render_evaluation.py"))["render"]()
    page = (PROJECT / "docs" / "evaluation.md").read_text(encoding="utf-8")
    _forget_tables(monkeypatch)
    assert page.replace(_since(), "") == rendered, "run: python benchmarks/render_evaluation.py"


def _ages() -> dict[str, Any]:
    return runpy.run_path(str(PROJECT / "benchmarks" / "ages.py"))


def _since() -> str:
    return str(_ages()["SINCE"])


@pytest.mark.parametrize("page", ("benchmarks.md", "evaluation.md", "reliability.md"))
def test_a_figure_that_is_older_than_the_core_says_so(page: str) -> None:
    ages = _ages()
    if not ages["has_history"]():
        pytest.skip("no checkout with all its commits")
    unsaid = ages["unsaid"]((PROJECT / "docs" / page).read_text(encoding="utf-8"))
    script = {"benchmarks.md": "docs"}.get(page, page.removesuffix(".md"))
    assert not unsaid, f"{unsaid}; run: python benchmarks/render_{script}.py"


@pytest.mark.parametrize(
    "result", sorted((PROJECT / "benchmarks" / "results").glob("*.json")), ids=lambda path: path.name
)
def test_results_come_from_a_commit_that_anybody_can_check_out(result: Path) -> None:
    commit = json.loads(result.read_text(encoding="utf-8"))["meta"]["commit"]
    assert re.fullmatch(r"[0-9a-f]{7,40}", commit), commit
