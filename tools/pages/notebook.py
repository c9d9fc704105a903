"""A notebook as a page, with the output that is stored in it."""

from __future__ import annotations

from pathlib import Path


def notebook_page(file: Path) -> dict[str, str | bytes]:
    """Return the files of a notebook's page, by their place in the site: text and pictures."""
    from nbconvert import MarkdownExporter

    pictures = f"{file.stem}_files"
    text, resources = MarkdownExporter().from_filename(
        str(file), resources={"output_files_dir": pictures, "unique_key": file.stem}
    )
    return {f"{file.stem}.md": text, **resources.get("outputs", {})}
