"""A model as a C library without FMI: its .c and .h, an example program, a Makefile."""

from pathlib import Path

from fmus.compiler import members
from fmus.files import write_whole
from fmus.native.compilers import FLAGS
from fmus.native.sources import translate_model
from modelkit.model import Model

PRINTED_OUTPUTS = 4
"""Outputs the example prints."""
PRINTED_ROWS = 20
EXAMPLE_DURATION = 10.0
"""Simulated time of the example [s], unless the model's own experiment is shorter."""
EXAMPLE = """/* Steps the model {name} with the inputs at their start values, and prints outputs with all their digits.
 *
 *     cc {flags} -o example main.c {name}.c -lm
 */
#include <stdio.h>

#include "{name}.h"

static {name} model; /* all memory of an instance: parameters, inputs, outputs, state */

int main(void) {{
    const int64_t step_ns = {step_ns}; /* {step:g} s */
    {name}_defaults(&model.params, &model.inputs);
    /* here is the place to change parameters */
    {name}_initialize(&model.params, &model.state, &model.outputs);
    for (int64_t k = 0; k <= {steps}; k++) {{
        if (k % {every} == 0) {{
            printf("%g", (double)(k * step_ns) * 1e-9);
{prints}
            printf("\\n");
        }}
{inputs}        {name}_step({store}&model.state, &model.inputs, &model.params, step_ns, &model.outputs);
    }}
    return 0;
}}
"""
MAKEFILE = """CFLAGS = {flags}

example: main.o lib{name}.a
\t$(CC) -o $@ main.o lib{name}.a -lm

lib{name}.a: {name}.o
\t$(AR) rcs $@ $^

main.o {name}.o: {name}.h

clean:
\trm -f example *.o *.a
"""


def write_c_library(model: Model, folder: Path) -> list[Path]:
    """Return the files written to ``folder``. Raises ``TypeError`` if the model cannot be translated."""
    code, flags = translate_model(model), " ".join(FLAGS)
    files = {
        f"{model.name}.h": code.header,
        f"{model.name}.c": code.source,
        "main.c": example(model),
        "Makefile": MAKEFILE.format(name=model.name, flags=flags),
    }
    for name, text in files.items():
        write_whole(folder / name, text)
    return [folder / name for name in files]


def example(model: Model) -> str:
    """Return main.c."""
    known = members(model)
    outputs = [item for item in known if item.group == "outputs" and item.kind is float][:PRINTED_OUTPUTS]
    inputs = [item for item in known if item.group == "inputs"]
    steps = round(min(EXAMPLE_DURATION, model.stop_time) / model.step_size)
    return EXAMPLE.format(
        name=model.name,
        store="" if model.store is None else "&model.store, ",
        flags=" ".join(FLAGS),
        step=model.step_size,
        step_ns=round(model.step_size * 1e9),
        steps=steps,
        every=max(1, steps // PRINTED_ROWS),
        prints="\n".join(f'            printf("  {item.name} %.17g", model.{item.path});' for item in outputs),
        inputs=f"        /* and here to set inputs, such as model.{inputs[0].path} */\n" if inputs else "",
    )
