"""The C files of an FMU: the model's, the FMI side, the tables, and the one file that is compiled."""

from pathlib import Path

from fmus.compiler import translate
from fmus.native.compilers import FLAGS
from fmus.native.tables import longest_name, runs_file, variables_file
from modelkit.model import Model

C_FILES = Path(__file__).parent / "c"
CORE = ("core.h", "core.c", "state.c")
FACES = {2: ("fmi2.h", "fmi2.c"), 3: ("fmi3.h", "fmi3.c")}
UNIT = """/* The FMU {name}, FMI {fmi}.0 for co-simulation, in one translation unit: compile this file alone.
 *
 *     cc {flags} -fPIC -shared -o {name}.so {unit} -lm
 *
 * The flags are part of the result: no fast-math, no fused a*b + c. No -march is needed.
 */
#include "{name}.c"

#define FMU_MODEL {name}
#define FMU_TOKEN "{token}"
#define FMU_VARIABLES "{name}_variables.h"
#define FMU_RUNS "{name}_runs.h"
#define FMU_LONGEST_NAME {longest}
#include "fmi{fmi}.c"
"""


def unit_name(model: Model, fmi: int) -> str:
    """Return the name of the file that is compiled."""
    return f"{model.name}_fmi{fmi}.c"


def fmu_sources(model: Model, token: str, fmi: int = 2) -> dict[str, str]:
    """Return file name -> text; ``token`` is what the FMU answers to. Raises ``TypeError`` if the model is refused."""
    code = translate(model)
    files = {name: (C_FILES / name).read_text(encoding="utf-8") for name in (*CORE, *FACES[fmi])}
    files |= {f"{model.name}.h": code.header, f"{model.name}.c": code.source}
    files |= {f"{model.name}_variables.h": variables_file(model), f"{model.name}_runs.h": runs_file(model)}
    unit = unit_name(model, fmi)
    files[unit] = UNIT.format(
        name=model.name, fmi=fmi, flags=" ".join(FLAGS), unit=unit, token=token, longest=longest_name(model)
    )
    return files
