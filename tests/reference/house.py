"""The figures of the house, counted from the sources alone: nothing of the package is imported.

Functions and methods are counted wherever they stand, also within others; lambdas are not. `self` and `cls` are no
parameters. A typer command is a function that is decorated with, or handed to, `<app>.command(...)` or
`<app>.callback(...)`. Code lines are those below the line of the `def`; docstrings, blank lines and comments are
none. Files of kernels are `kernels/` and all that lies in a folder `kernels`.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

PROJECT = Path(__file__).resolve().parents[2]
SOURCE = PROJECT / "src" / "elbowroom"
DUE_PARAMETERS, MOST_PARAMETERS = 5, 8
CONTRACT = {("reconstruct/reconstruct.py", "reconstruct")}
"""Whose keywords the README promises: not counted among parameters."""
DUE_LINES, MOST_LINES = 22, 60
POSITIONS, DUE_CALLS = 9, 5
DUE_CIRCLES = 0
ARGUMENTS, DUE_ARGS = 3, 1.0
DUE_KERNEL_LINES = 3

_Def = ast.FunctionDef | ast.AsyncFunctionDef
_COUNTED = (ast.Call, ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}


@dataclass(frozen=True, order=True)
class Place:
    """A line of a file, the file named from the source folder on."""

    file: str
    line: int
    says: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}  {self.says}"


@dataclass(frozen=True)
class Function:
    """A function or method, as it stands in its file."""

    file: str
    name: str
    node: _Def
    code_lines: int
    parameters: tuple[str, ...]
    is_command: bool
    is_public: bool

    @property
    def is_contract(self) -> bool:
        """Whether its keywords are those that the README promises."""
        return (self.file, self.name) in CONTRACT

    def place(self, says: str) -> Place:
        return Place(self.file, self.node.lineno, f"{self.name}: {says}")


class House:
    """All files of a package, parsed once."""

    def __init__(self, source: Path = SOURCE) -> None:
        self.source = source
        self.texts = {
            path.relative_to(source).as_posix(): path.read_text(encoding="utf-8")
            for path in sorted(source.rglob("*.py"))
        }
        self.trees = {file: ast.parse(text, file) for file, text in self.texts.items()}
        # looked through many times: what nothing is counted of is left out
        self.nodes = {
            file: [node for node in ast.walk(tree) if isinstance(node, _COUNTED)]
            for file, tree in self.trees.items()
        }
        self._imports = {file: [*self._imported(file)] for file in self.trees}
        commands = {command for file in self.trees for command in self._handed_to_typer(file)}
        self.functions = [
            function
            for file, tree in self.trees.items()
            for function in _functions(file, tree, _code_lines(self.texts[file], self.nodes[file]), commands)
        ]

    def parameters(self, commands: bool = False) -> list[int]:
        """How many each function has, outside typer commands or all of them."""
        return [len(f.parameters) for f in self.functions if commands or not (f.is_command or f.is_contract)]

    def many_parameters(self) -> list[Place]:
        """Functions with more than `MOST_PARAMETERS`, typer commands and the contract left out."""
        return sorted(
            f.place(f"{len(f.parameters)} parameters")
            for f in self.functions
            if len(f.parameters) > MOST_PARAMETERS and not f.is_command and not f.is_contract
        )

    def code_lines(self) -> list[int]:
        """Of each function, typer commands as well."""
        return [f.code_lines for f in self.functions]

    def long_functions(self) -> list[Place]:
        """Functions of more than `MOST_LINES`."""
        return sorted(
            f.place(f"{f.code_lines} code lines") for f in self.functions if f.code_lines > MOST_LINES
        )

    def positional_calls(self) -> list[Place]:
        """Calls with `POSITIONS` or more; a starred one counts as one."""
        return sorted(
            Place(file, node.lineno, f"{ast.unparse(node.func)}(...): {len(node.args)} positions")
            for file, nodes in self.nodes.items()
            for node in nodes
            if isinstance(node, ast.Call) and len(node.args) >= POSITIONS
        )

    def imports(self) -> dict[str, set[str]]:
        """By file, the files that it imports: also within functions and in types only."""
        return {file: {found for found, _ in imported} - {file} for file, imported in self._imports.items()}

    def file_circles(self) -> list[list[str]]:
        """Files that reach each other by imports."""
        return _circles(self.imports())

    def folder_circles(self) -> list[list[str]]:
        """Folders beside each other that reach each other by imports of what lies in them."""
        edges: dict[str, set[str]] = {}
        for file, others in self.imports().items():
            for other in others:
                here, there = _where_they_part(file, other)
                if not (here.endswith(".py") or there.endswith(".py")):
                    edges.setdefault(here, set()).add(there)
                    edges.setdefault(there, set())
        return _circles(edges)

    def circle_places(self) -> list[Place]:
        """The imports that hold the circles together."""
        found = set()
        for circle in self.file_circles():
            for file in circle:
                for other, line in self._imports[file]:
                    if other in circle and other != file:
                        found.add(Place(file, line, f"imports {other}, circle of files: {', '.join(circle)}"))
        for circle in self.folder_circles():
            for file, imported in self._imports.items():
                for other, line in imported:
                    here, there = _where_they_part(file, other)
                    if here != there and here in circle and there in circle:
                        found.add(
                            Place(file, line, f"imports {other}, circle of folders: {', '.join(circle)}")
                        )
        return sorted(found)

    def explained(self) -> list[Function]:
        """Public functions of `ARGUMENTS` or more outside kernels: those whose docstring must have `Args`."""
        return [
            f
            for f in self.functions
            if f.is_public and len(f.parameters) >= ARGUMENTS and not f.is_command and not is_kernels(f.file)
        ]

    def unexplained(self) -> list[Place]:
        """Those of them whose `Args` section is absent or leaves out a name."""
        places = []
        for f in self.explained():
            told = args_told(ast.get_docstring(f.node))
            left_out = [name for name in f.parameters if name not in (told or ())]
            if left_out:
                what = "no Args" if told is None else "Args leave out"
                places.append(f.place(f"{what}: {', '.join(left_out)}"))
        return sorted(places)

    def _imported(self, file: str) -> Iterator[tuple[str, int]]:
        """Files of the package that a file imports, with the line."""
        for node in self.nodes[file]:
            if isinstance(node, ast.Import):
                modules = [(alias.name,) for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = self._base(file, node)
                modules = [(f"{base}.{alias.name}", base) for alias in node.names]
            else:
                continue
            for names in modules:
                found = next(filter(None, map(self._file_of, names)), None)
                if found:
                    yield found, node.lineno

    def _base(self, file: str, node: ast.ImportFrom) -> str:
        """The module behind `from`, also of `from . import`."""
        folders = [self.source.name, *PurePosixPath(file).parts[:-1]]
        above = folders[: len(folders) - node.level + 1] if node.level else []
        return ".".join([*above, *filter(None, [node.module])])

    def _file_of(self, module: str) -> str | None:
        """The file of a module or package; None: no module of this package."""
        first, *parts = module.split(".")
        if first != self.source.name:
            return None
        stem = "/".join(parts)
        files = (f"{stem}.py", f"{stem}/__init__.py") if parts else ("__init__.py",)
        return next((file for file in files if file in self.trees), None)

    def _handed_to_typer(self, file: str) -> Iterator[tuple[str, str]]:
        """File and name of each function of `app.command(...)(function)`, traced to where it is defined."""
        nodes = self.nodes[file]
        home = {
            alias.asname or alias.name: (self._file_of(self._base(file, node)), alias.name)
            for node in nodes
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        for node in nodes:
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Call) and _registers(node.func):
                for handed in node.args:
                    if isinstance(handed, ast.Name):
                        yield home.get(handed.id, (file, handed.id))


def kernel_lines(pyproject: Path = PROJECT / "pyproject.toml") -> list[Place]:
    """Lines of pyproject.toml that name modules or folders of kernels; comments and titles do not."""
    return [
        Place(pyproject.name, number, line.strip())
        for number, line in enumerate(pyproject.read_text(encoding="utf-8").splitlines(), 1)
        if re.match(r"""[^#]*["'][^"']*[./*]_?kernels""", line)
    ]


def above_nine_tenths(numbers: list[int], due: int) -> str:
    """How many numbers lie above what nine tenths of them should not pass, and how many may."""
    above = sum(number > due for number in numbers)
    return f"{above} above {due}, where {len(numbers) // 10} may be"


def is_kernels(file: str) -> bool:
    """Whether a file, named from the source folder on, holds kernels."""
    path = PurePosixPath(file)
    return path.name.startswith("_kernels") or "kernels" in path.parts[:-1]


def nine_tenths(numbers: list[int]) -> int:
    """Their 90th percentile: the least that nine tenths of the numbers do not pass."""
    return sorted(numbers)[-(-9 * len(numbers) // 10) - 1]


def args_told(docstring: str | None) -> set[str] | None:
    """Names that the `Args` section tells of; None: it has none. `rule, detail: ...` tells of both."""
    section = re.search(r"^Args:\n((?:[ ]+.*\n|\n)*)", f"{docstring or ''}\n", re.MULTILINE)
    if section is None:
        return None
    entries = re.findall(r"^ {4}(\S[^:\n]*):", section[1], re.MULTILINE)
    names = (re.sub(r"\(.*?\)", "", name) for entry in entries for name in entry.split(","))
    return {name.strip(" *`") for name in names}


def _functions(
    file: str, tree: ast.Module, code: set[int], commands: set[tuple[str, str]]
) -> Iterator[Function]:
    """All functions and methods of a file, in its order."""
    parts = PurePosixPath(file).parts
    public_file = not any(part.startswith("_") and part != "__init__.py" for part in parts)

    def within(node: ast.AST, names: tuple[str, ...], in_class: bool, seen: bool) -> Iterator[Function]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, _Def):
                called = (*names, child.name)
                handed = (file, child.name) in commands and not names
                yield Function(
                    file=file,
                    name=".".join(called),
                    node=child,
                    code_lines=len(code & set(range(child.lineno + 1, child.end_lineno + 1))),
                    parameters=_parameters(child, in_class),
                    is_command=handed or any(map(_registers, child.decorator_list)),
                    is_public=seen and not child.name.startswith("_"),
                )
                yield from within(child, called, in_class=False, seen=False)
            elif isinstance(child, ast.ClassDef):
                shown = seen and not child.name.startswith("_")
                yield from within(child, (*names, child.name), in_class=True, seen=shown)
            elif not isinstance(child, ast.expr):  # which holds no function
                yield from within(child, names, in_class, seen)

    yield from within(tree, (), in_class=False, seen=public_file)


def _registers(node: ast.expr) -> bool:
    """Whether this is `<app>.command(...)`, `<app>.callback(...)`, or either without brackets."""
    called = node.func if isinstance(node, ast.Call) else node
    return isinstance(called, ast.Attribute) and called.attr in {"command", "callback"}


def _parameters(node: _Def, in_class: bool) -> tuple[str, ...]:
    given = node.args
    names = [argument.arg for argument in (*given.posonlyargs, *given.args)]
    if in_class and names[:1] in (["self"], ["cls"]):
        del names[0]
    rest = [given.vararg, *given.kwonlyargs, given.kwarg]
    return (*names, *(argument.arg for argument in rest if argument is not None))


def _code_lines(text: str, nodes: list[ast.AST]) -> set[int]:
    """Numbers of lines that hold code: no blank lines, comments or docstrings."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in nodes:
        if isinstance(node, _Def | ast.ClassDef) and ast.get_docstring(node) is not None:
            lines.difference_update(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    return lines


def _where_they_part(file: str, other: str) -> tuple[str, str]:
    """The two paths, each down to the first part that they do not share."""
    here, there = PurePosixPath(file).parts, PurePosixPath(other).parts
    shared = next((i for i, pair in enumerate(zip(here, there, strict=False)) if pair[0] != pair[1]), 0)
    return "/".join(here[: shared + 1]), "/".join(there[: shared + 1])


def _circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Sets of two or more nodes, each of which reaches all the others."""

    def reached(start: str) -> set[str]:
        seen, left = {start}, [start]
        while left:
            new = edges[left.pop()] - seen
            seen |= new
            left += new
        return seen

    reach = {node: reached(node) for node in edges}
    circles = {frozenset(other for other in reach[node] if node in reach[other]) for node in edges}
    return sorted(sorted(circle) for circle in circles if len(circle) > 1)
