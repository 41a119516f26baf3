"""Write every generated page: `python -m docs.generate`."""

from pathlib import Path

from docs.generate.pages import FOLDER, PAGES


def main(folder: Path = FOLDER) -> None:
    """Write the pages that changed into a folder, and print their names."""
    for name, make in PAGES.items():
        path = folder / name
        text = make()
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            print(f"renewed {name}")


if __name__ == "__main__":
    main()
