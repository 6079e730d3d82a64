"""The page: whole in one file, without a way to the network, true to the film."""

from __future__ import annotations

import base64
import json
import re
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mmplan.visualization.clearance import clearance_curve
from mmplan.visualization.exhibit import Exhibit, exhibit_of_scene
from mmplan.visualization.page import page_text, write_page
from mmplan.visualization.part import WORLD
from mmplan.visualization.search import searches


@pytest.fixture(scope="module")
def page(exhibit: Exhibit) -> str:
    problem, plan = exhibit.problem, exhibit.plan
    curve = clearance_curve(problem, plan, exhibit.film)
    return page_text(exhibit, curve, list(searches(problem, plan)))


def element(page: str, name: str) -> str:
    (text,) = re.findall(rf'id="{name}">(.*?)</script>', page, re.S)
    return text


def numbers(page: str) -> bytes:
    return zlib.decompress(base64.b64decode(element(page, "numbers")))


def test_the_page_is_small_and_names_nothing_elsewhere(page: str) -> None:
    assert len(page.encode()) < 1_000_000
    assert not re.findall(r"https?:|//[a-z]+\.|@import|url\(", page)
    for tag, attribute in re.findall(r"<(\w+)[^>]*\b(src|href)=", page):
        assert (tag, attribute) == ("link", "href")
    assert 'href="data:,"' in page
    assert "default-src 'none'" in page


def test_the_page_has_all_parts_and_moments(page: str, exhibit: Exhibit) -> None:
    content, block = json.loads(element(page, "content")), numbers(page)
    film = exhibit.film
    assert [part["name"] for part in content["parts"]] == [
        part.name for part in exhibit.parts
    ]
    for shown, part in zip(content["parts"], exhibit.parts, strict=True):
        offset, count = shown["vertices"]
        vertices = np.frombuffer(block, "<f4", count, offset).reshape(-1, 3)
        assert np.allclose(vertices, part.surface.vertices, atol=1e-6)
        offset, count = shown["triangles"]
        triangles = np.frombuffer(block, "<u4", count, offset)
        assert np.array_equal(triangles, part.surface.triangles.ravel())
        assert content["carriers"][shown["carrier"]] == part.carrier
    carriers = content["carriers"][1:]
    count = 7 * len(carriers) * len(film.times)
    poses = np.frombuffer(block, "<f4", count, content["poses"])
    poses = poses.reshape(len(film.times), len(carriers), 7)
    for k, carrier in enumerate(carriers):
        assert np.allclose(poses[:, k, :3], film.poses[carrier][:, :3, 3], atol=1e-5)


def test_the_page_has_segments_clearances_and_candidates(
    page: str, exhibit: Exhibit
) -> None:
    content = json.loads(element(page, "content"))
    assert [m["name"] for m in content["marks"]] == [m.name for m in exhibit.film.marks]
    assert len(content["clearance"]["times"]) > 20
    assert len(content["searches"]) == 2
    for search in content["searches"]:
        end = search["candidates"][0]["ends"][0]
        assert sum(end["terms"].values()) == pytest.approx(end["total"])
        assert end["links"][0]["from"] != end["links"][0]["to"]
        assert len(search["cycles"]) >= 2


def test_names_cannot_break_out_of_the_page(exhibit: Exhibit) -> None:
    evil = "</script><script>alert(1)</script>{{numbers}}"
    page = page_text(replace(exhibit, title=evil))
    assert "<script>alert" not in page
    assert json.loads(element(page, "content"))["title"] == evil


def test_a_scene_has_a_page_as_well(exhibit: Exhibit, tmp_path: Path) -> None:
    scene = exhibit_of_scene(exhibit.problem)
    write_page(tmp_path / "scene.html", scene)
    content = json.loads(element((tmp_path / "scene.html").read_text(), "content"))
    assert content["marks"] == []
    assert {"reach", "grasps", "ghosts"} <= set(content["layers"])
    names = [part["name"] for part in content["parts"]]
    for name in ("reach about the goal of task 2", "bottle, grasps 'low'"):
        assert name in names
    assert content["carriers"][0] == WORLD
