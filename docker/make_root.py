"""Makes the root file system of the image: a Python interpreter, its libraries, and Pilothouse.

Runs in the build stage, on a Debian base with Python: `make_root.py ENVIRONMENT ROOT`.
"""

import compileall
import os
import py_compile
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path

UID = 10001
ELF = b"\x7fELF"
NOT_OF_THE_LIBRARY = shutil.ignore_patterns(
    "__pycache__",
    "config-*",
    "dist-packages",
    "distutils",
    "ensurepip",
    "idlelib",
    "lib2to3",
    "pydoc_data",
    "site-packages",
    "test",
    "tests",
    "tkinter",
    "turtledemo",
    "venv",
    # C extension modules that nothing here imports; each would add libraries.
    "_curses*.so",
    "_dbm*.so",
    "_gdbm*.so",
    "_test*.so",
    "_tkinter*.so",
    "_xxtestfuzz*.so",
    "nis.*.so",
    "readline.*.so",
)
NOT_OF_THE_ENVIRONMENT = shutil.ignore_patterns(
    "__pycache__",
    "Activate.ps1",
    "activate*",
    "include",
    "tests",
    # Build tools of numpy, and those of its packages that it loads only when asked for. Not `ma`:
    # np.unique, and with it np.quantile, asks for it.
    "distutils",
    "f2py*",
    "fft",
    "mrecords.py",
    "polynomial",
    "testing",
    # Of pygments, with which rich could colour source code.
    "lexers",
    # Modules of C that only the tests of numpy import.
    "_*_tests.*.so",
    "_simd.*.so",
    "*.pxd",
    "*.pyx",
    "*.a",
    "*.h",
    "*.pyi",
)
FILES = {
    "etc/group": f"root:x:0:\npilothouse:x:{UID}:\n",
    "etc/nsswitch.conf": "hosts: files dns\n",
    "etc/passwd": f"root:x:0:0:root:/:\npilothouse:x:{UID}:{UID}:Pilothouse:/data:\n",
}
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
OS_RELEASE = Path("/etc/os-release")


def main(environment: Path, root: Path) -> None:
    """Create `root` and fill it with everything that the environment needs to run."""
    library = Path(sysconfig.get_path("stdlib"))
    root.mkdir()
    for folder in ("bin", "lib", "lib64", "sbin"):
        # Since the /usr merge these are links, and paths of libraries start with them.
        if (Path("/") / folder).is_symlink():
            (root / folder).symlink_to(os.readlink(Path("/") / folder))
    copy_tree(library, root, NOT_OF_THE_LIBRARY)
    copy_tree(environment, root, NOT_OF_THE_ENVIRONMENT)
    copied: set[Path] = set()
    for file in (environment / "bin" / "python", CERTIFICATES, OS_RELEASE):
        copied |= copy_file(file, root)
    for binary in list(elf_files(root)):
        for needed in libraries_of(Path("/") / binary.relative_to(root)):
            copied |= copy_file(needed, root)
    strip(library, environment, root)
    copy_licenses(copied | {library / "os.py"}, root)
    for name, content in FILES.items():
        (root / name).write_text(content, encoding="ascii")
    (root / "tmp").mkdir()
    (root / "tmp").chmod(0o1777)
    # For libraries outside the default folders of the loader, such as /usr/local/lib.
    shutil.copytree("/etc/ld.so.conf.d", root / "etc" / "ld.so.conf.d")
    copy_file(Path("/etc/ld.so.conf"), root)
    subprocess.run(["ldconfig", "-r", root], check=True)
    compile_all(root)


def copy_tree(folder: Path, root: Path, ignore: Callable[[str, list[str]], set[str]]) -> None:
    """Copy a folder of this system to the same path below `root`."""
    shutil.copytree(folder, placed(folder, root), symlinks=True, ignore=ignore, dirs_exist_ok=True)


def copy_file(file: Path, root: Path) -> set[Path]:
    """Copy a file and the links that lead to it; return the paths of all of them."""
    real = file.parent.resolve() / file.name
    place = placed(real, root)
    place.parent.mkdir(parents=True, exist_ok=True)
    if not os.path.lexists(place):
        shutil.copy2(real, place, follow_symlinks=False)
    if real.is_symlink():
        return {real} | copy_file(real.parent / os.readlink(real), root)
    return {real}


def placed(path: Path, root: Path) -> Path:
    """Return the path below `root` that corresponds to a path of this system."""
    return root / path.relative_to("/")


def strip(library: Path, environment: Path, root: Path) -> None:
    """Strip debug symbols from Python and its modules; those of Debian have none."""
    folders = [placed(library, root)]
    for packages in placed(environment, root).glob("lib/python*/site-packages"):
        for package in packages.iterdir():
            # Wheels with bundled libraries were patched in a way that `strip` breaks.
            patched = package.suffix == ".libs" or package.with_suffix(".libs").exists()
            if package.is_dir() and not patched:
                folders.append(package)
    binaries = {binary for folder in folders for binary in elf_files(folder)}
    binaries |= {file for file in root.rglob("libpython3*.so*") if not file.is_symlink()}
    for binary in sorted(binaries):
        subprocess.run(["strip", "--strip-unneeded", binary], check=True)


def elf_files(root: Path) -> Iterator[Path]:
    """Yield all executables and libraries below `root`."""
    for path in root.rglob("*"):
        if path.is_file() and not path.is_symlink():
            with path.open("rb") as file:
                if file.read(len(ELF)) == ELF:
                    yield path


def libraries_of(binary: Path) -> Iterator[Path]:
    """Yield the libraries that an executable or library of this system loads, and its loader."""
    listed = subprocess.run(["ldd", binary], capture_output=True, text=True, check=True).stdout
    for line in listed.splitlines():
        name, _, where = line.partition("=>")
        path = (where or name).split("(")[0].strip()
        if path == "not found":
            raise SystemExit(f"{binary} needs {name.strip()}, which the base does not have")
        if path.startswith("/"):
            yield Path(path)


def copy_licenses(files: set[Path], root: Path) -> None:
    """Copy the licenses of the Debian packages that contain the files."""
    # By name only, since the database lists /lib for files that are in /usr/lib.
    asked = subprocess.run(
        ["dpkg", "--search", *sorted({f"*/{file.name}" for file in files})],
        capture_output=True,
        text=True,
        check=False,
    )
    packages = {line.split(":")[0] for line in asked.stdout.splitlines()}
    for package in packages:
        license_ = Path("/usr/share/doc") / package / "copyright"
        if license_.exists():
            copy_file(license_, root)


def compile_all(root: Path) -> None:
    """Compile all modules now, since the image is read-only; never check source timestamps."""
    mode = py_compile.PycInvalidationMode.UNCHECKED_HASH
    if not compileall.compile_dir(
        root, quiet=1, stripdir=str(root), prependdir="/", invalidation_mode=mode, maxlevels=20
    ):
        raise SystemExit("some modules cannot be compiled")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
