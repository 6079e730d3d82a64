"""Every faulty URDF of the corpus is refused with exactly the faults it announces.

A file of `faulty_urdfs/` has one comment a fault: `expect: line:column: message`.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mmplan.assets import example_robots, robot_names, robots_folder
from mmplan.exceptions import InputError
from mmplan.files.urdf_faults import read_sound_urdf, unresolved_visuals

CORPUS = Path(__file__).parents[1] / "faulty_urdfs"
FILES = sorted(CORPUS.glob("*.urdf"))
EXPECTATION = re.compile(r"<!-- expect: (\d+):(\d+): (.*) -->")


def faults_of(path: Path, *package_dirs: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        read_sound_urdf(path, package_dirs)
    return caught.value


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_faulty_urdf_names_exactly_its_faults(path: Path) -> None:
    expected = EXPECTATION.findall(path.read_text())
    assert expected, "every file of the corpus says what it expects"
    found = faults_of(path).diagnostics
    for diagnostic, (line, column, message) in zip(found, expected, strict=True):
        assert diagnostic.file == str(path)
        assert (diagnostic.line, diagnostic.column) == (int(line), int(column))
        assert diagnostic.message.startswith(message)


def test_the_folders_tried_for_a_package_are_named(tmp_path: Path) -> None:
    urdf = CORPUS / "unresolved_package.urdf"
    message = faults_of(urdf, tmp_path).diagnostics[0].message
    for folder in (CORPUS, tmp_path, CORPUS.parent):
        assert str(folder) in message


def test_a_package_above_the_urdf_is_found(tmp_path: Path) -> None:
    package = tmp_path / "lever_description"
    for folder in ("urdf", "meshes"):
        (package / folder).mkdir(parents=True)
    urdf = package / "urdf" / "lever.urdf"
    urdf.write_text((CORPUS / "unresolved_package.urdf").read_text())
    faults_of(urdf)
    (package / "meshes" / "lever.stl").touch()
    assert read_sound_urdf(urdf).root.get("name") == "lever"


def test_a_missing_file_is_one_fault(tmp_path: Path) -> None:
    error = faults_of(tmp_path / "nowhere.urdf")
    assert "nowhere.urdf: cannot be read: No such file" in str(error)


def test_what_is_only_shown_may_be_missing(tmp_path: Path) -> None:
    text = (CORPUS / "missing_mesh.urdf").read_text()
    urdf = tmp_path / "shown.urdf"
    urdf.write_text(text.replace("collision>", "visual>"))
    assert list(unresolved_visuals(read_sound_urdf(urdf))) == ["meshes/lever.stl"]


@pytest.mark.parametrize("name", robot_names())
def test_urdfs_of_shipped_robots_are_sound(name: str) -> None:
    for urdf in (robots_folder() / name).glob("*.urdf"):
        read_sound_urdf(urdf)


def is_refused(urdf: Path, share: Path) -> bool:
    try:
        read_sound_urdf(urdf, (share,))
    except InputError:
        return True
    return False


def test_sound_urdfs_of_the_wheel_are_not_refused() -> None:
    share = example_robots()
    if share is None:
        pytest.skip("needs example-robot-data")
    folder = share / "example-robot-data" / "robots"
    urdfs = sorted(folder.rglob("*.urdf"))
    assert len(urdfs) > 50
    refused = [urdf.name for urdf in urdfs if is_refused(urdf, share)]
    # The one mimics joints that are not there, the other is an empty frame.
    assert refused == ["alex_psyonic_hands.urdf", "ur3.urdf"]
