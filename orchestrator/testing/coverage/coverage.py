"""What tests have been through: charts and branches of the models that run in this process."""

from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from modelkit.model import Model
from orchestrator.testing.coverage.branches import Branch, branch_share, watching
from orchestrator.testing.coverage.covered import ChartCoverage, chart_coverage, share
from orchestrator.testing.coverage.tracer import name_of, tracing


class Coverage(NamedTuple):
    """How far tests went."""

    charts: list[ChartCoverage]
    branches: list[Branch]

    def of_ours(self, packages: Collection[str], modes: list[ChartCoverage]) -> "Coverage":
        """Return it without the charts of models that were nowhere in the tests, and with modes of others."""
        ours = [chart for chart in self.charts if chart.name.split(".")[0] in packages]
        return self._replace(charts=[*ours, *modes])

    @property
    def has_list(self) -> bool:
        """Whether anything says which transitions there are."""
        return any(chart.rows and chart.is_listed for chart in self.charts)

    @property
    def transitions_percent(self) -> float:
        """Share of the transitions that were taken [%]."""
        return 100.0 * share(self.charts)

    @property
    def branches_percent(self) -> float:
        """Share of the outcomes of all branches that were seen [%]."""
        return 100.0 * branch_share(self.branches)


@contextmanager
def looking_on(models: Iterable[Model]) -> Iterator[Callable[[], Coverage]]:
    """Yield a function that says how far the tests have been through these models so far."""
    known = list(models)
    charts = [chart for model in known for chart in model.all_charts()]
    packages = [package for model in known for package in model.sources()]
    with watching(packages) as branches, tracing(charts) as seen:
        yield lambda: Coverage(
            [chart_coverage(chart, seen[name_of(chart)]) for chart in charts], branches.list_branches()
        )
