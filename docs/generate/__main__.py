"""Write every page that follows from the code: `python -m docs.generate`."""

from pathlib import Path

from docs.generate.pages import FOLDER, PAGES


def main(folder: Path = FOLDER) -> None:
    """Write the pages that differ into a folder, and say which."""
    for name, make in PAGES.items():
        path = folder / name
        text = make()
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            print(f"renewed {name}")


if __name__ == "__main__":
    main()
