"""The command that adds an optional extra to this installation: pip, pipx, uv, or a source checkout."""

import json
import shlex
import sys
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote, urlsplit

DISTRIBUTION = "apa-cosim"


def install_command(extras: str) -> str:
    """Return the shell command that installs ``extras`` (``"native"``, ``"native,sweep"``) where this program runs.

    pipx and uv keep each tool in an environment of its own, so pip would install elsewhere: their environments are
    recognised by the receipts that they write. An editable installation is repeated from its folder.
    """
    environment = Path(sys.prefix)
    folder = _editable_folder()
    wanted = shlex.quote(f"{folder or DISTRIBUTION}[{extras}]")
    editable = "-e " if folder else ""
    if (environment / "pipx_metadata.json").is_file():
        return f"pipx install --force {editable}{wanted}"
    if (environment / "uv-receipt.toml").is_file():
        return f"uv tool install --force {editable}{wanted}"
    if find_spec("pip") is None:
        return f"uv pip install --python {shlex.quote(sys.executable)} {editable}{wanted}"
    if not sys.executable:
        return f"pip install {editable}{wanted}"
    return f"{shlex.quote(sys.executable)} -m pip install {editable}{wanted}"


def _editable_folder() -> str:
    """Return the folder of an editable installation, empty for any other (PEP 610, ``direct_url.json``)."""
    try:
        text = distribution(DISTRIBUTION).read_text("direct_url.json")
    except PackageNotFoundError:
        return ""
    about = json.loads(text) if text else {}
    if not about.get("dir_info", {}).get("editable"):
        return ""
    return unquote(urlsplit(about["url"]).path)


def missing_package(package: str, extras: str) -> str:
    """Return the message for an optional package that is not installed, with the command that installs it."""
    return f"the package {package} is not installed; run: {install_command(extras)}"
