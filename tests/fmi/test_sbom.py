"""Bills of materials: what is in them, that they are whole, the same each time, and what is refused."""

import hashlib
import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

from fmus.contents.archive import write_archive
from fmus.sbom import main, wheel_sbom

UPLOT = b"/*! https://github.com/leeoniya/uPlot (v1.6.32) */\n"


def wheel(folder: Path, requires: str) -> Path:
    path = folder / "trial-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("trial/third_party/uplot/uPlot.js", UPLOT)
        archive.writestr("trial-1.0.dist-info/METADATA", f"Name: trial\nVersion: 1.0\n{requires}\n\nText")
    return path


def test_a_wheel_names_what_it_requires_and_what_it_carries(tmp_path: Path) -> None:
    lines = 'Requires-Dist: fmpy<0.4,>=0.3\nRequires-Dist: nosuch; extra == "x"\nRequires-Dist: no2; os_name == "z"'
    bill = wheel_sbom(wheel(tmp_path, lines))
    known = {item["name"]: item for item in bill["components"]}
    assert {"fmpy", "numpy", "lxml", "uplot"} <= known.keys()
    assert known["uplot"]["version"] == "1.6.32"
    assert "nosuch" not in known
    assert "no2" not in known
    references = {bill["metadata"]["component"]["bom-ref"], *(item["bom-ref"] for item in bill["components"])}
    reported = {item["ref"]: item["dependsOn"] for item in bill["dependencies"]}
    assert {one for on in reported.values() for one in on} < references
    assert known["numpy"]["bom-ref"] in reported[known["fmpy"]["bom-ref"]]


def test_an_fmu_lists_its_files_with_their_hashes(native_fmus: Any, tmp_path: Path, capsys: Any) -> None:
    path = native_fmus["Toy"]
    out = tmp_path / "bills"
    assert main([str(path), "--out", str(out)]) == 0
    first = (out / "Toy.fmu.cdx.json").read_bytes()
    assert main([str(path), "--out", str(out)]) == 0
    assert (out / "Toy.fmu.cdx.json").read_bytes() == first
    bill = json.loads(first)
    assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.6")
    with zipfile.ZipFile(path) as archive:
        expected = {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}
    assert {item["name"]: item["hashes"][0]["content"] for item in bill["components"]} == expected
    assert bill["metadata"]["component"]["name"] == "Toy"


def test_fmus_of_one_name_have_a_bill_each(native_fmus: Any, tmp_path: Path) -> None:
    paths = [tmp_path / kind / "Toy.fmu" for kind in ("native", "python")]
    for path in paths:
        path.parent.mkdir()
        path.write_bytes(native_fmus["Toy"].read_bytes())
    assert main([*map(str, paths), "--out", str(tmp_path)]) == 0
    bills = sorted(path.name for path in tmp_path.glob("*.json"))
    assert bills == ["native-Toy.fmu.cdx.json", "python-Toy.fmu.cdx.json"]


@pytest.mark.parametrize("suffix", [".whl", ".fmu"])
def test_another_file_is_refused_in_one_line(tmp_path: Path, capsys: Any, suffix: str) -> None:
    text, empty = tmp_path / f"text{suffix}", tmp_path / f"empty{suffix}"
    text.write_text("x")
    write_archive(empty, {"a": b""})
    for path in (text, empty, tmp_path / f"none{suffix}"):
        assert main([str(path), "--out", str(tmp_path)]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_requirement_that_is_not_installed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="it requires nosuch, which is not installed here"):
        wheel_sbom(wheel(tmp_path, "Requires-Dist: nosuch"))
