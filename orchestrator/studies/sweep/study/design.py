"""The design of a study: one line of numbers for each run, a seed, and what the run is called."""

import hashlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.fields import Field


class Design(NamedTuple):
    """All runs of a study."""

    fields: list[Field]
    values: Array
    """(runs, fields), SI units; states and truth values as numbers."""
    seeds: NDArray[np.int64]
    labels: Mapping[str, NDArray[Any]] = MappingProxyType({})
    """What tells the runs apart for people, where that is not the numbers: words or numbers, one for each run."""

    def part(self, first: int, every: int) -> "Design":
        """Return each ``every``-th run from number ``first`` on."""
        labels = {key: words[first::every] for key, words in self.labels.items()}
        return Design(self.fields, np.ascontiguousarray(self.values[first::every]), self.seeds[first::every], labels)

    def digest(self) -> str:
        """Return a hash of everything: equal for equal designs."""
        made = hashlib.sha256("\n".join(field.key for field in self.fields).encode())
        made.update(np.ascontiguousarray(self.values).tobytes())
        made.update(self.seeds.tobytes())
        for key, words in self.labels.items():
            made.update(f"{key}: {words.tolist()}".encode())
        return made.hexdigest()
