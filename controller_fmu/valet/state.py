"""What the valet remembers beside its store: a plan, where it is on its path, what it heard, what it asks."""

from typing import NamedTuple

from controller_fmu.common.external_slot import ExternalSlot
from controller_fmu.interface import Reason
from controller_fmu.planning.plan import (
    Path,
)
from controller_fmu.planning.task import Corner, Request
from controller_fmu.valet.chart import Step
from controller_fmu.valet.found.beside import SideEchoes
from controller_fmu.valet.found.nearby import Nearby
from controller_fmu.valet.found.search import Search
from controller_fmu.valet.found.way_back import WayBack
from controller_fmu.valet.rolling import Ahead
from controller_fmu.valet.sight import SEEN_CORNERS, Sight
from controller_fmu.valet.watch import Watch
from modelkit.vocabulary import Pose


class Tracked(NamedTuple):
    """Where the car is along the piece of path in hand."""

    left: float = 0.0
    """To its end [m]."""
    reference: Pose = Pose()
    lateral_error: float = 0.0
    heading_error: float = 0.0
    front_wheel_angle: float = 0.0
    """That leads back to it [rad]."""
    ahead: Ahead = Ahead()


class ValetState(NamedTuple):
    """Everything the valet remembers beside its store."""

    step: int = Step.PLAN
    reason: int = Reason.NONE
    request: Request = Request()
    searched: int = 0
    """Steps of the search done for the request; 0: there is none yet."""
    plans: int = 0
    path: Path = Path()
    first_margin: float = 0.0
    """Margin [m] of the first path of this drive; 0: there is none yet."""
    piece: int = 0
    """The one in hand."""
    begin: Pose = Pose()
    """Where it begins."""
    tracked: Tracked = Tracked()
    early: float = 0.0
    """The car has been found to stop so much [m] before where it should."""
    manoeuvres: int = 0
    direction: float = 0.0
    """Last driven, 0: not yet."""
    seen: tuple[Corner, ...] = (Corner(),) * SEEN_CORNERS
    """Things heard that the map does not have."""
    seen_count: int = 0
    sight: Sight = Sight()
    watch: Watch = Watch()
    wheel: float = 0.0
    """Steering-wheel angle asked for [rad]."""
    search: Search = Search()
    told: ExternalSlot = ExternalSlot()
    """The slot from outside, as it is told now."""
    nearby: Nearby = Nearby()
    """What is heard on the way into a slot that was found."""
    beside: SideEchoes = SideEchoes()
    """What is heard at the end of the way, standing."""
    back: WayBack = WayBack()
    """The way it came, which it drives back if none leads on; without pieces: nowhere."""
    backs: int = 0
    """How often it did."""
    resumes: bool = False
    """Switched off on the way into a slot, which is still known."""
    speed: float = 0.0
    """Speed asked for [m/s], reverse negative."""
