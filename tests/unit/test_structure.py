"""The habits of this repository that no other tool checks."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]
PACKAGES = ("api", "domain", "service", "web")
MAX_FILE_LINES = 500
MAX_FUNCTION_LINES = 50
NOT_OURS = {"__pycache__", "build", "dist", "mutants", "node_modules"}
# Escaped, so that this file does not hold the names that it looks for.
REGISTRY = re.compile(
    r"pypi\.org|pythonhosted\.|npmjs\.|--(?:extra-)?index-url|--find-link[s]|--trusted-hos[t]"
)

THESE_LOAD_NUMPY = {
    # When a profile is analysed.
    "api/cli/profile_run.py",
    "api/profiling/analysis.py",
    "api/profiling/plot.py",
    "api/profiling/report.py",
    # By rclpy, which need not be there.
    "service/ros/graph/link.py",
}
# Prints the first module that loads it.
IMPORTS = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
    if "numpy" in sys.modules:
        sys.exit(print(name))
"""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def _modules(*packages: str) -> list[Path]:
    return sorted(path for package in packages for path in (PROJECT / package).rglob("*.py"))


def _functions(module: Path) -> Iterator[Function]:
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, Function):
            yield node


def _does_something(function: Function) -> bool:
    """Tell a function with a body from the declaration of one, as in a Protocol."""
    return not all(
        isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
        for statement in function.body
    )


def _names(paths: list[Path]) -> str:
    return "\n".join(str(path.relative_to(PROJECT)) for path in paths)


def _committed_files() -> Iterator[Path]:
    folders = [PROJECT]
    while folders:
        for path in folders.pop().iterdir():
            if path.is_dir():
                hidden = path.name.startswith(".") and path.name != ".ci"
                if not hidden and path.name not in NOT_OURS and path.suffix != ".egg-info":
                    folders.append(path)
            elif path.name != "uv.lock":
                yield path


def test_every_module_that_does_something_has_a_test_file_in_the_same_place() -> None:
    untested = [
        module
        for module in _modules("api", "domain", "service")
        if module.name != "__init__.py"
        and any(_does_something(function) for function in _functions(module))
        and not _test_file_of(module).is_file()
    ]

    assert not untested, _names(untested)


def test_no_module_loads_numpy_when_it_is_imported() -> None:
    # A robot at rest needs none of it: `domain.arrays` loads it when it is used.
    names = [
        ".".join(module.relative_to(PROJECT).with_suffix("").parts)
        for package in ("domain", "service", "api")
        for module in _modules(package)
        if module.relative_to(PROJECT).as_posix() not in THESE_LOAD_NUMPY
    ]
    done = subprocess.run(
        [sys.executable, "-c", IMPORTS, *names],
        cwd=PROJECT,
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.stdout == ""
    assert done.returncode == 0, done.stderr


def _test_file_of(module: Path) -> Path:
    mirrored = PROJECT / "tests" / "unit" / module.relative_to(PROJECT)
    return mirrored.with_name(f"test_{module.name.lstrip('_')}")


def test_no_package_hides_the_source_from_the_tests() -> None:
    # With tests/unit/domain/__init__.py, `import domain` would find the folder of tests.
    packages = [path.parent for path in _modules("tests") if path.name == "__init__.py"]

    assert _names(packages) == "tests"


@pytest.mark.parametrize("package", PACKAGES)
def test_a_file_is_short_enough_to_be_read_in_one_go(package: str) -> None:
    too_long = [
        path
        for path in _committed_files()
        if path.relative_to(PROJECT).parts[0] == package
        and path.suffix in {".py", ".js", ".css", ".html"}
        and len(path.read_text(encoding="utf-8").splitlines()) > MAX_FILE_LINES
    ]

    assert not too_long, _names(too_long)


@pytest.mark.parametrize("package", PACKAGES)
def test_a_function_fits_on_a_screen(package: str) -> None:
    too_long = [
        f"{module.relative_to(PROJECT)}:{function.lineno} {function.name}"
        for module in _modules(package)
        for function in _functions(module)
        if (function.end_lineno or function.lineno) - function.lineno + 1 > MAX_FUNCTION_LINES
    ]

    assert not too_long, "\n".join(too_long)


def test_nothing_names_a_package_registry() -> None:
    # Where packages come from is a matter of the machine that installs them.
    naming = [
        path
        for path in _committed_files()
        if REGISTRY.search(path.read_text(encoding="utf-8", errors="ignore"))
    ]

    assert not naming, _names(naming)


def test_the_lock_holds_hashes_and_no_addresses() -> None:
    lock = (PROJECT / "requirements.lock").read_text(encoding="utf-8")

    assert "://" not in lock
    assert "--hash=sha256:" in lock
