"""Software bills of materials, CycloneDX 1.6: of a wheel and of FMUs. ``python -m fmus.sbom FILE... --out DIR``.

The same file in the same environment gives the same bytes.
"""

import argparse
import hashlib
import json
import re
import sys
import uuid
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmus.files import write_whole

REQUIREMENT = re.compile(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)")
VENDORED = re.compile(r"(?:^|/)third_party/([^/]+)/.*\.js$")
"""A third-party script inside of a wheel."""
VENDORED_VERSION = re.compile(rb"\(v?(\d+(?:\.\d+)+)\)")
Component = dict[str, Any]


def wheel_sbom(path: Path) -> dict[str, Any]:
    """Return the bill of a wheel: what it requires without extras, as installed here, and the scripts inside of it.

    Raises ``ValueError`` if it is no wheel, or if something that it requires is not installed here.
    """
    with _archive(path) as archive:
        places = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        if len(places) != 1:
            raise ValueError(f"{path}: no wheel: it has {len(places)} files METADATA")
        head = archive.read(places[0]).decode().partition("\n\n")[0].splitlines()
        vendored = [_vendor_component(name, archive.read(name)) for name in archive.namelist() if VENDORED.search(name)]
    fields = [tuple(line.split(": ", 1)) for line in head if ": " in line and not line.startswith(" ")]
    name, version = (next(value for key, value in fields if key == wanted) for wanted in ("Name", "Version"))
    top = _component("library", name, version, f"pkg:pypi/{_normal(name)}@{version}", "MIT") | _hashes(
        path.read_bytes()
    )
    wanted = list(_requirement_names(value for key, value in fields if key == "Requires-Dist"))
    needed: dict[str, Component] = {}
    depends = {top["bom-ref"]: [_add(one, needed, path) for one in wanted] + [item["bom-ref"] for item in vendored]}
    depends |= {
        item["bom-ref"]: [_add(one, needed, path) for one in _requirement_names(distribution(key).requires or ())]
        for key, item in needed.items()
    }
    return _bom(top, [*needed.values(), *vendored], depends)


def fmu_sbom(path: Path) -> dict[str, Any]:
    """Return the bill of an FMU: its files, and what made it. Raises ``ValueError`` if it is none."""
    with _archive(path) as archive:
        try:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        except KeyError:
            raise ValueError(f"{path}: no FMU: there is no modelDescription.xml in it") from None
        files = [
            {"type": "file", "bom-ref": f"file:{name}", "name": name, **_hashes(archive.read(name))}
            for name in sorted(archive.namelist())
            if not name.endswith("/")
        ]
    name, version = str(root.get("modelName")), str(root.get("version") or "0")
    token = root.get("guid") or root.get("instantiationToken") or ""
    licence = re.match(r"[A-Za-z0-9.+-]+$", root.get("license") or "")
    top = _component("library", name, version, f"pkg:generic/{name}@{version}", licence[0] if licence else "")
    top |= _hashes(path.read_bytes())
    top["properties"] = [
        {"name": "fmi:version", "value": root.get("fmiVersion")},
        {"name": "fmi:token", "value": token},
        {"name": "fmi:generationTool", "value": root.get("generationTool")},
    ]
    return _bom(top, files, {top["bom-ref"]: [item["bom-ref"] for item in files]})


def _archive(path: Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path}: {error}") from None


def _requirement_names(lines: Iterable[str]) -> Iterator[str]:
    """Yield the names that lines of requirements name, those of extras and of other systems left out."""
    for line in lines:
        text, _, marker = line.partition(";")
        found = REQUIREMENT.match(text)
        if found and "extra ==" not in marker and (not marker or _distribution(found[1]) is not None):
            yield found[1]


def _distribution(name: str) -> Distribution | None:
    try:
        return distribution(name)
    except PackageNotFoundError:
        return None


def _add(name: str, needed: dict[str, Component], path: Path) -> str:
    """Return the reference of a package, which is now among those needed, with all that it needs."""
    found = _distribution(name)
    if found is None:
        raise ValueError(f"{path}: it requires {name}, which is not installed here")
    key, version = _normal(name), found.version
    if key not in needed:
        licence = str(found.metadata.json.get("license_expression") or "")
        needed[key] = _component("library", key, version, f"pkg:pypi/{key}@{version}", licence)
        for other in _requirement_names(found.requires or ()):
            _add(other, needed, path)
    return str(needed[key]["bom-ref"])


def _vendor_component(name: str, content: bytes) -> Component:
    found, version = VENDORED.search(name), VENDORED_VERSION.search(content[:400])
    assert found is not None
    number = version[1].decode() if version else "unknown"
    return _component("library", found[1], number, f"pkg:npm/{found[1]}@{number}", "") | _hashes(content)


def _component(kind: str, name: str, version: str, url: str, licence: str) -> Component:
    stated = {"licenses": [{"expression": licence}]} if licence else {}
    return {"type": kind, "bom-ref": url, "name": name, "version": version, "purl": url, **stated}


def _hashes(content: bytes) -> Component:
    return {"hashes": [{"alg": "SHA-256", "content": hashlib.sha256(content).hexdigest()}]}


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _bom(top: Component, components: list[Component], depends: dict[str, list[str]]) -> dict[str, Any]:
    serial = uuid.uuid5(uuid.NAMESPACE_URL, json.dumps([top, components], sort_keys=True))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{serial}",
        "version": 1,
        "metadata": {"component": top},
        "components": sorted(components, key=lambda item: str(item["bom-ref"])),
        "dependencies": [{"ref": ref, "dependsOn": sorted(set(on))} for ref, on in sorted(depends.items())],
    }


def main(words: list[str] | None = None) -> int:
    """Write ``<file>.cdx.json`` for each file; of files with one name, with the folder before it.

    Returns 0, or 2 if one is neither a wheel nor an FMU.
    """
    parser = argparse.ArgumentParser(prog="python -m fmus.sbom", description=__doc__)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="a wheel (.whl) or an FMU (.fmu)")
    parser.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="where to (default: here)")
    arguments = parser.parse_args(words)
    arguments.out.mkdir(parents=True, exist_ok=True)
    names = Counter(path.name for path in arguments.files)
    for path in arguments.files:
        try:
            bill = wheel_sbom(path) if path.suffix == ".whl" else fmu_sbom(path)
        except ValueError as error:
            print(error, file=sys.stderr)
            return 2
        name = path.name if names[path.name] == 1 else f"{path.resolve().parent.name}-{path.name}"
        target = arguments.out / f"{name}.cdx.json"
        write_whole(target, json.dumps(bill, indent=1) + "\n")
        print(target)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
