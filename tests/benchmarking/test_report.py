"""The report: one page without anything from elsewhere, tables, pictures, logs."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from mmplan.benchmarking import Record, Store, write_report
from mmplan.benchmarking.contests import contests
from mmplan.benchmarking.published import TABLE_I
from mmplan.benchmarking.table import Table
from mmplan.benchmarking.tables import tables
from mmplan.exceptions import InputError
from tests.benchmarking.made import entry, failed, made_up

PNG = b"\x89PNG\r\n\x1a\n"
LABELS = {"coevolution": "CoEvolution", "random": "RandomSampling"}


def a_contest(
    problem: str, runs: int, evaluations: int = 6940, draw: int = 0
) -> list[Record]:
    """Co-evolution ahead of random sampling, which fails once."""
    rng = np.random.default_rng(draw)
    records = [
        made_up(
            problem=problem,
            optimizer=name,
            label=label,
            seed=seed,
            evaluations=evaluations,
            score=float(rng.normal(mean, 2.0)),
            cycles=3.35 if name == "coevolution" else None,
        )
        for name, label, mean in (
            ("coevolution", "CoEvolution", 90.0),
            ("random", "RandomSampling", 75.0),
        )
        for seed in range(runs)
    ]
    lost = failed(
        **{k: getattr(records[-1], k) for k in ("problem", "optimizer", "label")},
        seed=runs - 1,
        evaluations=evaluations,
        cycles=None,
    )
    return [*records[:-1], lost]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    fill(folder, [*a_contest("wineglass", 20), *a_contest("plate", 20, 500)])
    return folder


def fill(folder: Path, records: list[Record]) -> None:
    with Store(folder, create=True) as store:
        for name in dict.fromkeys(r.problem for r in records):
            store.register(entry(name), "mmplan 1, <numpy> 2")
        for record in records:
            store.add(record)


def by_title(folder: Path) -> dict[str, Table]:
    with Store(folder) as store:
        return {table.title: table for table in tables(contests(store))}


def columns(table: Table) -> list[dict[str, str]]:
    return [dict(zip(table.header, row, strict=True)) for row in table.rows]


def test_scores_are_normalized_by_the_best_ever_found(folder: Path) -> None:
    with Store(folder) as store:
        records, best = store.records(), store.best()["wineglass"]
    mine = [
        100 * r.score / best
        for r in records
        if (r.problem, r.optimizer) == ("wineglass", "random") and r.success
    ]
    rows = columns(by_title(folder)["Scores"])
    row = rows[1]
    assert (row["problem"], row["contender"]) == ("wineglass", "RandomSampling")
    assert row["success"] == "95.0 % (76.4 to 99.1)"
    assert row["mean score"] == f"{np.mean(mine):.2f}"
    assert row["std. dev."] == f"{np.std(mine, ddof=1):.2f}"
    assert f"{best:.2f} (wineglass)" in by_title(folder)["Scores"].note
    assert [r["cycles"] for r in rows] == ["3.35", "", "3.35", ""]


def test_a_failed_run_counts_as_nothing_in_a_difference(folder: Path) -> None:
    with Store(folder) as store:
        contest = contests(store)[0]
    a, b = (contest.normalized(label) for label in LABELS.values())
    mean = np.mean([a[seed] - b[seed] for seed in range(20)])
    assert b[19] == 0.0
    row = columns(by_title(folder)["Paired differences"])[0]
    assert row["contenders"] == "CoEvolution − RandomSampling"
    assert (row["pairs"], row["difference"]) == ("20", f"{mean:+.2f}")
    low, high = map(float, row["95 %"].split(" to "))
    assert 0.0 < low < mean < high


def test_the_papers_table_stands_beside_ours(folder: Path) -> None:
    table = by_title(folder)["Table I of the paper, and ours"]
    rows = columns(table)
    # Only the paper's own budget is compared.
    assert {(r["problem"], r["contender"]) for r in rows} == {
        ("wineglass", label) for label in LABELS.values()
    }
    assert table.rows[0][2:5] == ("99.0 %", "91.74", "3.77")
    assert table.rows[1][2:5] == ("99.0 %", "72.57", "6.13")
    assert "scenes and models are not published" in table.note
    assert "not comparable" in table.note


def test_the_paper_is_quoted_rightly() -> None:
    assert {key: tuple(row) for key, row in TABLE_I.items()} == {
        ("wineglass", "coevolution"): (99.0, 91.74, 3.77),
        ("wineglass", "random"): (99.0, 72.57, 6.13),
        ("plate", "coevolution"): (100.0, 90.18, 3.94),
        ("plate", "random"): (100.0, 78.06, 4.52),
    }


def test_planned_runs_have_a_table_of_motions(tmp_path: Path) -> None:
    clearance = {"distance": 0.0031}
    plan = {
        "verified": True,
        "tried": 2,
        "refuted": 1,
        "attempts": [],
        "duration": 21.5,
        "verification": {"clearance": clearance},
    }
    none = {"verified": False, "tried": 4, "refuted": 0, "attempts": []}
    named = {"label": "CoEvolution+RRTConnect", "planner": "RRTConnect"}
    fill(tmp_path, [made_up(plan=plan, **named), made_up(seed=1, plan=none, **named)])
    (row,) = columns(by_title(tmp_path)["Motions"])
    assert row["verified"].startswith("50.0 %")
    assert row["tried"] == "3.00"
    assert row["refused"] == "1"
    assert row["duration, s"] == "21.50"
    assert row["clearance, mm"] == "3.10"


class Outside(HTMLParser):
    """Collects what a page would fetch, and the pictures that it has in itself."""

    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.pictures: list[bytes] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag not in ("script", "link", "iframe")
        for name, value in attrs:
            if name not in ("src", "href", "srcset") or value is None:
                continue
            head, _, data = value.partition(",")
            if head == "data:image/png;base64":
                self.pictures.append(base64.b64decode(data, validate=True))
            else:
                self.fetched.append(value)


def test_the_page_needs_nothing_from_elsewhere(folder: Path) -> None:
    report = write_report(folder)
    page = report.page.read_text()
    outside = Outside()
    outside.feed(page)
    assert outside.fetched == []
    assert not re.search(r"url\(|@import|https?://", page)
    assert len(outside.pictures) == len(report.figures) == 8
    assert all(picture.startswith(PNG) for picture in outside.pictures)
    assert outside.pictures == [path.read_bytes() for path in report.figures]
    assert "&lt;numpy&gt;" in page
    assert [t.title for t in report.tables] == list(by_title(folder))
    for table in report.tables:
        assert table.title in page
        assert table.title in (folder / "tables.md").read_text()


def test_every_contest_has_a_log(folder: Path) -> None:
    logs = {path.name for path in write_report(folder).logs}
    assert logs == {"wineglass_6940.log", "plate_500.log"}


def test_pictures_are_drawn_where_nothing_was_found(tmp_path: Path) -> None:
    fill(tmp_path, [failed(), failed(seed=1)])
    report = write_report(tmp_path)
    assert len(report.figures) == 4
    (row,) = columns(report.tables[0])
    assert (row["success"], row["mean score"]) == ("0.0 % (0.0 to 65.8)", "")


def test_one_run_is_enough_for_a_report(tmp_path: Path) -> None:
    fill(tmp_path, [made_up()])
    assert [t.title for t in write_report(tmp_path).tables] == [
        "Scores",
        "Table I of the paper, and ours",
        "Time by stage",
    ]


def test_problems_beyond_the_first_few_go_without_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mmplan.benchmarking.report._MOST_PICTURED", 1)
    fill(tmp_path, [made_up(problem=f"shelf_{i}") for i in range(3)])
    report = write_report(tmp_path)
    assert {path.name.partition("_")[0] for path in report.figures} == {"shelf"}
    assert len(report.figures) == 4
    page = report.page.read_text()
    assert "No pictures of shelf_1, shelf_2: this page shows at most 1" in page
    assert len(report.tables[0].rows) == len(report.logs) == 3


def test_an_empty_store_has_no_report(tmp_path: Path) -> None:
    Store(tmp_path, create=True).close()
    with pytest.raises(InputError, match="holds no runs yet"):
        write_report(tmp_path)


def test_missing_libraries_are_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "mmplan.benchmarking.report._LIBRARIES", ("jinja2", "no_such_library")
    )
    with pytest.raises(InputError, match=r"needs no_such_library: pip install 'mmpl"):
        write_report(folder)


def test_text_and_markdown_hold_every_cell(folder: Path) -> None:
    for table in by_title(folder).values():
        wide = replace(table, note="")
        for row in table.rows:
            for cell in row:
                assert cell in wide.text()
                assert cell in wide.markdown()
        lines = wide.text().splitlines()[2 : 3 + len(table.rows)]
        assert len({len(line) for line in lines}) == 1


def many_problems() -> list[Record]:
    """Eight problems of two families; co-evolution is ahead on each."""
    names = [f"{family}-{i}" for family in ("shelf", "bin") for i in range(4)]
    return [r for i, name in enumerate(names) for r in a_contest(name, 3, 500, i)]


def test_families_are_told_together_and_each_problem_counts_once(
    tmp_path: Path,
) -> None:
    fill(tmp_path, [*many_problems(), *a_contest("wineglass", 3, 500)])
    with Store(tmp_path) as store:
        found = [c for c in contests(store) if c.problem.name.startswith("bin")]
    scores = columns(by_title(tmp_path)["Families of problems"])
    assert [r["family"] for r in scores] == ["bin"] * 2 + ["shelf"] * 2 + ["all"] * 2
    row = next(r for r in scores if r["contender"] == "RandomSampling")
    assert (row["problems"], row["runs"]) == ("4", "12")
    assert row["success"].startswith("66.7 %")
    each = [np.mean(list(c.normalized("RandomSampling").values())) for c in found]
    assert row["mean score"] == f"{np.mean(each):.2f}"
    ahead = columns(by_title(tmp_path)["Paired differences by family"])
    together = next(r for r in ahead if r["family"] == "all")
    assert together["problems"] == "8"
    low, high = map(float, together["95 %"].split(" to "))
    assert 0.0 < low < float(together["difference"]) < high


def test_a_problem_alone_makes_no_family(tmp_path: Path) -> None:
    fill(tmp_path, [*a_contest("shelf-0", 3), *a_contest("wineglass", 3)])
    assert "Families of problems" not in by_title(tmp_path)


def test_rows_for_each_of_many_problems_are_for_files_alone(tmp_path: Path) -> None:
    names = [f"shelf-{i}" for i in range(13)]
    fill(tmp_path, [record for name in names for record in a_contest(name, 2)])
    shown = {title: not table.detailed for title, table in by_title(tmp_path).items()}
    assert shown["Families of problems"]
    assert not shown["Scores"]
    page = write_report(tmp_path).page.read_text()
    assert page.count("<details>") == page.count("</details>") > 0
    assert "shelf-12" in (tmp_path / "tables.md").read_text()
