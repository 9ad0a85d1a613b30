"""What a public function raises stands in its docstring."""

from __future__ import annotations

import ast
import inspect
import re

import pytest

from isr_jax import errors

from .conftest import REPOSITORY

PACKAGE = REPOSITORY / "isr_jax"
BASES = {
    name: {base.__name__ for base in kind.__mro__ if issubclass(base, Exception)}
    for name, kind in inspect.getmembers(errors, inspect.isclass)
    if issubclass(kind, errors.IsrError)
}
"""Every error of the package, and what catches it."""
Function = ast.FunctionDef | ast.AsyncFunctionDef
MADE_WITH_THE_CLASS = ("__init__", "__post_init__", "__enter__", "__call__")
"""Methods that a class's own docstring may speak for."""


def caught_names(handler: ast.ExceptHandler) -> set[str]:
    if handler.type is None:
        return {"Exception"}
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return {ast.unparse(kind).rpartition(".")[2] for kind in kinds}


class Raised(ast.NodeVisitor):
    """What one function raises itself, and the functions of its module that it calls.

    What is caught around a place does not leave it; what a handler raises does.
    """

    def __init__(self, makers: dict[str, str]) -> None:
        self.errors: set[str] = set()
        self.calls: list[tuple[str, frozenset[str]]] = []
        self._makers, self._caught = makers, frozenset()

    def visit_Try(self, node: ast.Try) -> None:
        around = self._caught
        self._caught = around.union(*(caught_names(handler) for handler in node.handlers))
        for child in node.body:
            self.visit(child)
        self._caught = around
        for child in (*node.handlers, *node.orelse, *node.finalbody):
            self.visit(child)

    def visit_Raise(self, node: ast.Raise) -> None:
        made = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
        name = made.id if isinstance(made, ast.Name) else ""
        name = self._makers.get(name, name)
        if name in BASES and not BASES[name] & self._caught:
            self.errors.add(name)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        if isinstance(node.func, ast.Name):
            self.calls.append((node.func.id, self._caught))
        elif isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) == "self":
            self.calls.append((f"self.{node.func.attr}", self._caught))
        self.generic_visit(node)


class Module:
    """The functions and methods of a module, and what leaves them."""

    def __init__(self, source: str) -> None:
        self.functions: dict[str, Function] = {}
        self.texts: dict[str, str] = {}
        """Docstrings of classes."""
        for node in ast.parse(source).body:
            if isinstance(node, Function):
                self.functions[node.name] = node
            elif isinstance(node, ast.ClassDef):
                self.texts[node.name] = ast.get_docstring(node) or ""
                methods = [m for m in node.body if isinstance(m, Function)]
                self.functions |= {f"{node.name}.{m.name}": m for m in methods}
        self._makers = {
            name: returned
            for name, node in self.functions.items()
            if node.returns is not None and (returned := ast.unparse(node.returns)) in BASES
        }

    def raised_by(self, name: str, seen: frozenset[str] = frozenset()) -> set[str]:
        """Errors that leave a function, its own or those of private functions that it calls."""
        owner, visitor = name.rpartition(".")[0], Raised(self._makers)
        for statement in self.functions[name].body:
            visitor.visit(statement)
        found = set(visitor.errors)
        for called, caught in visitor.calls:
            target = called.replace("self", owner, 1) if called.startswith("self.") else called
            is_private = target.rpartition(".")[2].startswith("_")
            if is_private and target in self.functions and target not in seen:
                inner = self.raised_by(target, seen | {name})
                found |= {error for error in inner if not BASES[error] & caught}
        return found

    def text_of(self, name: str) -> str:
        """A function's docstring; that of its class too, where the class is what is called."""
        owner, _, method = name.rpartition(".")
        of_class = self.texts.get(owner, "") if method in MADE_WITH_THE_CLASS else ""
        return f"{ast.get_docstring(self.functions[name]) or ''}\n{of_class}"

    def is_public(self, name: str) -> bool:
        parts = [part for part in name.split(".") if part not in MADE_WITH_THE_CLASS]
        return not any(part.startswith("_") for part in parts)


def unsaid(source: str) -> list[str]:
    """``function: Error`` of each error that leaves a public function and is not named there."""
    module = Module(source)
    return [
        f"{name}: {error}"
        for name in module.functions
        if module.is_public(name)
        for error in sorted(module.raised_by(name))
        if not says(module.text_of(name), error)
    ]


def says(text: str, error: str) -> bool:
    in_section = re.search(rf"\bRaises:.*\b{error}\b", text, re.DOTALL)
    return bool(in_section or re.search(rf"\b[Rr]aises?\s+`{error}`", text))


def test_every_error_is_in_the_docstring_of_what_raises_it():
    silent = {
        str(path.relative_to(PACKAGE)): missing
        for path in sorted(PACKAGE.rglob("*.py"))
        if (missing := unsaid(path.read_text("utf-8")))
    }
    assert not silent, f"name them in a Raises: section: {silent}"


RAISING = [
    'def read():\n    """Read."""\n    raise SceneError("a", "b")',
    'def read():\n    """Read."""\n    _parse()\n\n\ndef _parse():\n    raise SceneError("a")',
    'def read():\n    """Read."""\n    raise _bad()\n\n\ndef _bad() -> SceneError: ...',
    "class Reader:\n    def read(self):\n        self._read()\n\n"
    '    def _read(self):\n        raise SceneError("a")',
    'def read():\n    try:\n        go()\n    except OSError:\n        raise SceneError("a")',
    'def read():\n    """Raises:\n    MapError: x."""\n    raise SceneError("a")',
]
FINE = [
    'def read():\n    """Read; raises `SceneError` without one."""\n    raise SceneError("a")',
    'def read():\n    """Read.\n\n    Raises:\n        SceneError: None.\n    """\n'
    '    raise SceneError("a")',
    "def read():\n    try:\n        _parse()\n    except IsrError:\n        return None\n\n\n"
    'def _parse():\n    raise SceneError("a")',
    'def read():\n    """Read."""\n    raise ValueError("a")',
    'def _read():\n    raise SceneError("a")',
    'class _Reader:\n    def read(self):\n        raise SceneError("a")',
    'class Reader:\n    """Raises:\n    SceneError: x."""\n\n    def __init__(self):\n'
    '        raise SceneError("a")',
]


@pytest.mark.parametrize("source", RAISING)
def test_an_error_that_is_not_said_is_found(source):
    assert len(unsaid(source)) == 1 and unsaid(source)[0].endswith(": SceneError")


@pytest.mark.parametrize("source", FINE)
def test_what_is_said_caught_private_or_of_python_is_fine(source):
    assert not unsaid(source)
