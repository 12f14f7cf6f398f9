"""The house keeps its figures, and whoever counts them counts right."""

import inspect
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from house_report import by_folder, figures
from reference import house
from reference.house import House, Place

HouseOf = Callable[[dict[str, str]], House]


@pytest.fixture(scope="module")
def today() -> House:
    return House()


def told(figure: str, offenders: Sequence[Place]) -> str:
    """What a failing figure says."""
    return "\n".join([f"{figure}, see `python tests/house_report.py --list`:", *map(str, offenders)])


# figures of the house


def test_functions_take_few_parameters(today: House) -> None:
    counts = today.parameters()
    figure = f"parameters: {house.above_nine_tenths(counts, house.DUE_PARAMETERS)}; most {max(counts)}"
    assert house.nine_tenths(counts) <= house.DUE_PARAMETERS, told(figure, today.many_parameters())
    assert max(counts) <= house.MOST_PARAMETERS, told(figure, today.many_parameters())


def test_functions_fit_on_a_screen(today: House) -> None:
    counts = today.code_lines()
    figure = f"code lines: {house.above_nine_tenths(counts, house.DUE_LINES)}; most {max(counts)}"
    assert house.nine_tenths(counts) <= house.DUE_LINES, told(figure, today.long_functions())
    assert max(counts) <= house.MOST_LINES, told(figure, today.long_functions())


def test_calls_name_what_they_pass(today: House) -> None:
    calls = today.positional_calls()
    assert len(calls) <= house.DUE_CALLS, told(f"{len(calls)} calls with nine positions or more", calls)


def test_no_circle_of_files_or_folders(today: House) -> None:
    circles = [*today.file_circles(), *today.folder_circles()]
    assert len(circles) <= house.DUE_CIRCLES, told(f"{len(circles)} circles", today.circle_places())


def test_docstrings_tell_of_every_argument(today: House) -> None:
    silent = today.unexplained()
    share = 1 - len(silent) / len(today.explained())
    assert share >= house.DUE_ARGS, told(f"{len(silent)} of {len(today.explained())} without Args", silent)


def test_few_lines_of_pyproject_name_kernels() -> None:
    lines = house.kernel_lines()
    assert len(lines) <= house.DUE_KERNEL_LINES, told(f"{len(lines)} lines name kernels", lines)


# the counter


@pytest.fixture
def house_of(tmp_path: Path) -> HouseOf:
    """house_of({"a/b.py": "..."}) is the house of a package `cottage` with these files."""

    def built(files: dict[str, str]) -> House:
        source = tmp_path / "cottage"
        for name, text in files.items():
            path = source / name
            path.parent.mkdir(parents=True, exist_ok=True)
            for folder in path.parents:
                if folder == tmp_path:
                    break
                (folder / "__init__.py").touch()
            path.write_text(text, encoding="utf-8")
        return House(source)

    return built


def says(places: Sequence[Place]) -> list[str]:
    return [place.says for place in places]


def test_parameters_leave_out_self_and_count_stars_and_keywords(house_of: HouseOf) -> None:
    text = """
class Room:
    def one(self, a, /, b, *rest, c, **more): ...
    @classmethod
    def two(cls, a): ...
    @staticmethod
    def three(a, b): ...
def four(self): ...
"""
    assert [f.parameters for f in house_of({"room.py": text}).functions] == [
        ("a", "b", "rest", "c", "more"),
        ("a",),
        ("a", "b"),
        ("self",),
    ]


def test_commands_are_left_out_wherever_they_are_handed_to_typer(house_of: HouseOf) -> None:
    here = house_of(
        {
            "cli/app.py": """
from cottage.cli.late import late as the_late
@app.command(name="x")
def decorated(a, b, c, d, e, f, g, h, i): ...
@app.callback
def first(a, b, c, d, e, f, g, h, i): ...
def handed(a, b, c, d, e, f, g, h, i): ...
app.command()(handed)
app.command(epilog="y")(the_late)
""",
            "cli/late.py": "def late(a, b, c, d, e, f, g, h, i): ...",
            "stage.py": "def late(a, b, c, d, e, f, g, h, i): ...",
        }
    )
    assert [place.file for place in here.many_parameters()] == ["stage.py"]
    assert here.parameters() == [9]
    assert here.parameters(commands=True) == [9] * 5


def test_code_lines_leave_out_docstrings_blank_lines_and_comments(house_of: HouseOf) -> None:
    text = '''
def outer(a):
    """Says.

    More.
    """
    # why

    kept = """
    two lines, blank

    or not"""

    def inner():
        """Says too."""
        return kept  # why

    return inner
'''
    outer, inner = house_of({"room.py": text}).functions
    assert (outer.name, outer.code_lines) == ("outer", 7)
    assert (inner.name, inner.code_lines) == ("outer.inner", 1)


def test_calls_of_nine_positions_count_a_star_as_one(house_of: HouseOf) -> None:
    text = "f(1, 2, 3, 4, 5, 6, 7, 8, *rest)\ng(1, 2, 3, 4, 5, 6, 7, *rest)\nh(1, 2, 3, 4, 5, 6, 7, 8, i=9)\n"
    assert says(house_of({"room.py": text}).positional_calls()) == ["f(...): 9 positions"]


@pytest.mark.parametrize(
    "back",
    [
        "from cottage.b import B",
        "from cottage import b",
        "import cottage.b",
        "from . import b",
        "from .b import B",
        "def f():\n    from cottage.b import B",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from cottage.b import B",
    ],
    ids=["name", "module", "import", "relative module", "relative name", "in a function", "in types"],
)
def test_circle_of_files_is_found(house_of: HouseOf, back: str) -> None:
    here = house_of({"a.py": back, "b.py": "from cottage.a import A", "c.py": "from cottage.a import A"})
    assert here.file_circles() == [["a.py", "b.py"]]
    assert {place.file for place in here.circle_places()} == {"a.py", "b.py"}


def test_name_of_a_package_leads_to_its_init_and_not_through_it(house_of: HouseOf) -> None:
    here = house_of(
        {
            "stage/__init__.py": "from cottage.stage.a import A",
            "stage/a.py": "",
            "b.py": "from cottage.stage import A",
        }
    )
    assert here.imports()["b.py"] == {"stage/__init__.py"}
    assert here.imports()["stage/__init__.py"] == {"stage/a.py"}
    assert here.file_circles() == here.folder_circles() == []


def test_circle_through_three_files_is_one(house_of: HouseOf) -> None:
    here = house_of({"a.py": "import cottage.b", "b.py": "import cottage.c", "c.py": "import cottage.a"})
    assert here.file_circles() == [["a.py", "b.py", "c.py"]]


def test_strings_and_other_packages_are_no_imports(house_of: HouseOf) -> None:
    here = house_of({"a.py": "import numpy\nfrom b import B\nHOME = 'cottage.b'", "b.py": "import cottage.a"})
    assert here.imports()["a.py"] == set()


def test_circle_of_folders_needs_no_circle_of_files(house_of: HouseOf) -> None:
    here = house_of(
        {
            "x/a.py": "from cottage.y.b import B",
            "y/b.py": "",
            "y/inner/c.py": "from cottage.x.d import D",
            "x/d.py": "",
        }
    )
    assert here.file_circles() == []
    assert here.folder_circles() == [["x", "y"]]
    assert [place.file for place in here.circle_places()] == ["x/a.py", "y/inner/c.py"]


def test_args_are_told_by_groups_and_with_stars_and_types() -> None:
    docstring = """Says.

    Args:
        rule, detail: of the carve: strict
            or not: as it is.
        size (int): [m].

        *rest: more.

    Returns:
        other: no argument.
    """
    assert house.args_told(inspect.cleandoc(docstring)) == {"rule", "detail", "size", "rest"}
    assert house.args_told("Says.") is None
    assert house.args_told(None) is None


def test_args_that_leave_out_a_name_are_listed(house_of: HouseOf) -> None:
    text = '''
def whole(a, b, c):
    """Says.

    Args:
        a, b: these.
        c: that.
    """
def partly(a, b, c):
    """Says.

    Args:
        a, b: these.
    """
class Room:
    """Args of the constructor are no Args of a method.

    Args:
        a, b, c: these.
    """
    def silent(self, a, b, c):
        """Says."""
    def short(self, a, b):
        """Says."""
'''
    here = house_of({"room.py": text})
    assert says(here.unexplained()) == ["partly: Args leave out: c", "Room.silent: no Args: a, b, c"]
    assert len(here.explained()) == 3


def test_args_are_asked_of_public_functions_outside_kernels_only(house_of: HouseOf) -> None:
    function = "def f(a, b, c): ...\n"
    here = house_of(
        {
            "stage/_kernels.py": function,
            "stage/_kernels_look.py": function,
            "stage/kernels/look.py": function,
            "_private.py": function,
            "room.py": "def _f(a, b, c): ...\nclass _Room:\n    def f(self, a, b, c): ...\n"
            "def g():\n    def f(a, b, c): ...\n@app.command()\ndef h(a, b, c): ...\n",
            "stage/__init__.py": function,
        }
    )
    assert [place.file for place in here.unexplained()] == ["stage/__init__.py"]


def test_ninetieth_percentile_is_what_nine_tenths_do_not_pass() -> None:
    assert house.nine_tenths(list(range(1, 11))) == 9
    assert house.nine_tenths(list(range(1, 12))) == 10
    assert house.nine_tenths([3]) == 3
    assert house.above_nine_tenths(list(range(1, 12)), 9) == "2 above 9, where 1 may be"


def test_kernels_are_counted_by_module_and_by_folder(tmp_path: Path) -> None:
    path = tmp_path / "pyproject.toml"
    path.write_text(
        '# "cottage.stage._kernels" is a comment\n'
        'name = "Kernels know arrays"\n'
        'module = [\n  "cottage.stage._kernels_look",\n  "cottage.*.kernels.*",\n]\n'
        'ignore = ["cottage.** -> cottage.stage._kernels"]\n',
        encoding="utf-8",
    )
    assert [place.line for place in house.kernel_lines(path)] == [4, 5, 7]


def test_the_report_names_each_figure_and_where(today: House, tmp_path: Path) -> None:
    places = house.kernel_lines()
    told_of = figures(today, places)
    listed = "\n".join(by_folder(told_of, []))
    for figure in (
        "parameters, 90 % / max",
        "code lines",
        "calls",
        "circles",
        "Args",
        "lines that name kernels",
    ):
        assert any(one.name.startswith(figure) for one in told_of)
    assert all(str(place) in listed for place in places)
    small = tmp_path / "src" / "small"
    small.mkdir(parents=True)
    (tmp_path / "pyproject.toml").write_text("[tool]\n")
    (small / "one.py").write_text("def one(a, b, c):\n    return a\n")
    report = Path(__file__).with_name("house_report.py")
    done = subprocess.run(
        [sys.executable, report, small, "--list"], capture_output=True, text=True, check=True
    )
    assert all(one.name in done.stdout for one in told_of) and "one.py" in done.stdout
