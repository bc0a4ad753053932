"""A scenario's FMUs joined by fmucontainer of the FMU Manipulation Toolbox: a master that is not ours.

It reads all outputs, writes all inputs, steps all. Its input is JSON, as it does not read the parameters of an .ssp.
"""

import json
import shutil
import subprocess
import sys
from typing import Any


def write_container(system: Any, folder: Any) -> Any:
    """Return the path of the container, made in ``folder``; its outputs are called as ``vehicle.pose.x``."""
    files = {part.name: f"{part.model.name}.fmu" for part in system.parts}
    links = system.connections()
    linked = {(sender.name, name) for sender, _, name in links}
    for part in system.parts:
        shutil.copyfile(part.fmu, folder / files[part.name])
    reported = {
        "name": f"{system.identifier}.fmu",
        "step_size": system.step,
        **{f"auto_{kind}": False for kind in ("link", "input", "output", "parameter")},
        "fmu": list(files.values()),
        "link": [[files[sender.name], name, files[receiver.name], name] for sender, receiver, name in links],
        "output": [
            [files[part.name], variable.name, f"{part.name}.{variable.name}"]
            for part in system.parts
            for variable in part.of("output")
            if (part.name, variable.name) not in linked
        ],
    }
    (folder / "system.json").write_text(json.dumps(reported))
    code = "from fmu_manipulation_toolbox.cli.fmucontainer import fmucontainer; fmucontainer()"
    command = [sys.executable, "-c", code, "-fmu-directory", str(folder), "-container", "system.json"]
    subprocess.run(command, check=True, capture_output=True)
    return folder / reported["name"]
