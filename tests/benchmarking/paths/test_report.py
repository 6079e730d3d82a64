"""Tables and logs of path benchmarks, and the command that makes them."""

from __future__ import annotations

import json
from contextlib import closing
from pathlib import Path

import pytest

from mmplan.benchmarking.paths.records import PathRecord, PathStore
from mmplan.benchmarking.paths.report import write_path_report
from mmplan.benchmarking.paths.tables import path_tables
from mmplan.benchmarking.run_store import ProblemEntry
from mmplan.cli import main
from tests.benchmarking.made import converted
from tests.benchmarking.paths.made import problem, problem_file, record


def column(records: list[PathRecord], name: str, table: int = 0) -> list[str]:
    made = path_tables(records)[table]
    return [row[made.header.index(name)] for row in made.rows]


def test_counts_times_and_lengths() -> None:
    seconds = [0.001 * (i + 1) for i in range(21)]
    records = [record(seed=i, first_seconds=s) for i, s in enumerate(seconds)]
    records.append(record(seed=99, family="other", valid=False, first_seconds=1.0))
    lost = {"first": None, "first_length": None, "first_way": None, "path": None}
    failed = {"solved": False, "valid_first": False, "valid": False}
    records.append(record(seed=100, first_seconds=2.0, **lost, **failed))
    assert column(records, "family") == ["all", "pillar", "other"]
    assert column(records, "solved") == ["22", "21", "1"]
    assert column(records, "first valid") == ["22", "21", "1"]
    assert column(records, "valid") == ["21", "21", "0"]
    assert column(records, "runs") == ["23", "22", "1"]
    # The run that found nothing counts with its time.
    assert column(records, "first path, ms")[1] == "11.5 / 20.9"
    assert column(records[:21], "first path, ms")[0] == "11.0 / 20.0"
    assert column(records, "first, rad")[0] == "3.00"


def test_contenders_come_in_the_order_of_their_times() -> None:
    slow = record(planner="slow", first_seconds=2.0, states=None, seconds=None)
    quick = record(planner="quick", first_seconds=1.0)
    assert column([slow, quick], "contender")[:2] == ["quick", "slow"]
    assert column([slow, quick], "shortened, ms")[:2] == ["20.0 / 20.0", ""]
    assert column([slow, quick], "states", table=1) == ["100", ""]


def test_settings_tell_contenders_of_one_name_apart() -> None:
    records = [
        record(settings=json.dumps({"resolution": r, "shortcuts": 5}))
        for r in (0.01, 0.02)
    ]
    assert column(records, "contender")[:2] == [
        "RRTConnect (resolution 0.01)",
        "RRTConnect (resolution 0.02)",
    ]


def test_the_converter_reads_the_logs(tmp_path: Path) -> None:
    good, bad = record(), record(seed=1, solved=False, seconds=None, length=None)
    with PathStore(tmp_path / "out", create=True) as store:
        store.register(ProblemEntry("p", "/p.json", "0123", {}), "mmplan")
        store.add(good)
        store.add(bad)
    (log,) = write_path_report(tmp_path / "out").logs
    assert log.name == "p_pillar.log"
    with closing(converted(log.read_text(), tmp_path)) as database:
        rows = database.execute("SELECT * FROM runs ORDER BY seed").fetchall()
        experiment = database.execute("SELECT * FROM experiments").fetchone()
        names = database.execute("SELECT name FROM plannerConfigs").fetchall()
    assert [n["name"] for n in names] == ["RRTConnect"]
    assert experiment["name"] == "p_pillar"
    assert (rows[0]["time"], rows[0]["solution_length"]) == (0.02, 1.5)
    assert (rows[0]["time_to_first_path"], rows[0]["solved"]) == (0.01, 1)
    assert (rows[1]["time"], rows[1]["solution_length"]) == (0.01, None)
    assert (rows[1]["solved"], rows[1]["states"]) == (0, 100)


def test_the_command_runs_goes_on_and_reports(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, folder = str(problem_file(tmp_path, problem())), str(tmp_path / "out")
    command = ["benchmark", "paths", path, "-o", folder, "--shortcuts", "5"]
    assert main([*command, "--runs", "1"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("1 runs done, 0 were there before\nPaths\n")
    assert told.out.endswith(f"written to {folder}/paths.md\n")
    assert told.err == ""
    assert main([*command, "--runs", "2", "--json"]) == 0
    values = json.loads(capsys.readouterr().out)
    assert (values["before"], values["done"], values["left"]) == (1, 1, 0)
    assert values["tables"][0]["rows"][0][:6] == ["all", "RRTConnect", *"2222"]
    assert main(["benchmark", "report", folder]) == 0
    assert "RRTConnect" in capsys.readouterr().out
    assert (tmp_path / "out" / "ompl" / "p_pillar.log").is_file()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--planners", "RRTConect"), "did you mean 'RRTConnect'?"),
        (("--robot", "none"), "unknown robot 'none'"),
        (("--robot", "ur5_mobile"), "has 7 joints; ur5_mobile has 9 in base and arm"),
        (("--hand", "0.01,0.02"), "the hand of panda has 1 joints; got 2 positions"),
    ],
)
def test_wrong_input_is_refused_before_anything_is_stored(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    message: str,
) -> None:
    path, folder = str(problem_file(tmp_path)), tmp_path / "out"
    assert main(["benchmark", "paths", path, "-o", str(folder), *options]) == 2
    assert message in capsys.readouterr().err
    assert not folder.exists()


@pytest.mark.parametrize("option", ["--resolution", "--time-limit"])
@pytest.mark.parametrize("value", ["0", "-1", "inf", "fine"])
def test_options_without_sense_are_refused(
    capsys: pytest.CaptureFixture[str], option: str, value: str
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["benchmark", "paths", "p.json", "-o", "out", f"{option}={value}"])
    assert f"expected a number > 0, got '{value}'" in capsys.readouterr().err


def test_a_store_without_runs_is_refused(tmp_path: Path) -> None:
    PathStore(tmp_path, create=True).close()
    assert main(["benchmark", "report", str(tmp_path)]) == 2
