"""Writes the table of broken scenes and what `mmplan explain` says of each.

    python benchmarks/make_explained_scenes.py

The table stands in docs/explain.md, between the two comments that name this script.
"""

from __future__ import annotations

import re
from pathlib import Path

from mmplan.explanation import Explanation, explain
from mmplan.files.yaml_reader import read_document
from mmplan.scene_file import load_problem

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "explain.md"
TABLE = re.compile(r"(<!-- make_explained_scenes -->\n).*?(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Explain every scene and put the table into the page."""
    rows = ["| Scene | What is wrong | Cause named first | Nearest miss | What helps |"]
    rows.append("| --- | --- | --- | --- | --- |")
    for path in sorted((ROOT / "tests" / "broken").glob("*.yaml")):
        (found,) = explain(load_problem(path), paths=path.stem == "walled_in")
        wrong = read_document(path).get("description")
        cells = [f"`{path.stem}`", str(wrong), *_told(found)]
        rows.append(f"| {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    text = "\n".join(rows) + "\n"
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(TABLE.sub(lambda m: m[1] + text + m[2], page), encoding="utf-8")


def _told(found: Explanation) -> list[str]:
    """The first cause, the nearest miss and the changes that help."""
    helps = "; ".join(r.text for r in found.relaxations if r.solvable)
    return [str(found.causes[0]), str(found.near_miss or ""), helps]


if __name__ == "__main__":
    main()
