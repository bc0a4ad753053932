"""ParkingSystem.fmu: one FMU with the whole system inside, joined by fmucontainer of the FMU Manipulation Toolbox.

The container steps its FMUs as our master does: read all outputs, write all inputs, step all. It is
made from JSON, not from the .ssp, because the toolbox does not read the parameters of an .ssp.
"""

import json
import re
import shutil
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fmus.children import run_child
from fmus.contents.archive import DESCRIPTION, content_guid, write_archive
from fmus.contents.description import AUTHOR, GENERATED
from fmus.contents.xml_file import as_text
from fmus.files import folder_for_a_while
from fmus.systems.system import NAME, System

PACKAGE = "fmu_manipulation_toolbox"
INSTALL = "pip install fmu-manipulation-toolbox"


def write_container(system: System, path: Path) -> Path:
    """Write the container. Raises ``RuntimeError`` if the toolbox is not installed or refuses."""
    if find_spec(PACKAGE) is None:
        raise RuntimeError(f"a container needs fmucontainer: {INSTALL}")
    with folder_for_a_while("container") as here:
        for part in system.parts:
            shutil.copyfile(part.fmu, here / f"{part.model.name}.fmu")
        file = here / f"{NAME}.json"
        file.write_text(json.dumps(assembly(system), indent=1))
        code = f"from {PACKAGE}.cli.fmucontainer import fmucontainer; fmucontainer()"
        command = [sys.executable, "-P", "-c", code, "-fmu-directory", str(here), "-container", file.name]
        done = run_child(command)
        made = here / f"{NAME}.fmu"
        if done.returncode or not made.is_file():
            raise RuntimeError(f"fmucontainer: {(done.stdout + done.stderr).strip()}")
        return write_archive(path, _ours(made))


def _ours(made: Path) -> dict[str, bytes]:
    """Return the files of a container without what the toolbox knows of this machine: user, clock, random GUID."""
    with zipfile.ZipFile(made) as archive:
        files = {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}
    text = files[DESCRIPTION].decode()
    for attribute, value in {"guid": "", "generationDateAndTime": GENERATED, "author": AUTHOR}.items():
        text = re.sub(rf' {attribute}="[^"]*"', f' {attribute}="{value}"', text, count=1)
    files[DESCRIPTION] = text.encode()
    files[DESCRIPTION] = text.replace(' guid=""', f' guid="{content_guid(files)}"', 1).encode()
    return files


def assembly(system: System) -> dict[str, Any]:
    """Return what fmucontainer is told: FMUs, links, start values, outputs as ``vehicle.pose.x``.

    A linked output is left out: the container shows it under the same name as a local variable.
    """
    linked = {(sender.name, name) for sender, _, name in system.connections()}
    files = {part.name: f"{part.model.name}.fmu" for part in system.parts}
    return {
        "name": f"{NAME}.fmu",
        "step_size": system.step,
        "auto_link": False,
        "auto_input": False,
        "auto_output": False,
        "auto_parameter": False,
        "fmu": list(files.values()),
        "link": [
            [files[sender.name], name, files[receiver.name], name] for sender, receiver, name in system.connections()
        ],
        "output": [
            [files[part.name], variable.name, f"{part.name}.{variable.name}"]
            for part in system.parts
            for variable in part.of("output")
            if (part.name, variable.name) not in linked
        ],
        "start": [
            [files[part.name], variable.name, as_text(value)]
            for part in system.parts
            for variable, value in part.settings()
        ],
    }
