"""Which nodes are reachable, with counts for the systems above them."""

from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName


class Reachability:
    """The unreachable nodes; every node is unreachable until its first report."""

    def __init__(self, model: SmhModel) -> None:
        self._model = model
        self._unreachable = set(model.nodes)
        self._below = dict.fromkeys(model.systems, 0)
        for node in self._unreachable:
            for system in model.ancestors[node]:
                self._below[system] += 1

    def note(self, node: PartName, *, reachable: bool) -> bool:
        """Record whether a node is reachable; return whether that changed."""
        if reachable is (node not in self._unreachable):
            return False
        if reachable:
            self._unreachable.discard(node)
        else:
            self._unreachable.add(node)
        for system in self._model.ancestors[node]:
            self._below[system] += -1 if reachable else 1
        return True

    def reaches(self, part: PartName) -> bool:
        """Tell whether a node is reachable; for a system, whether all nodes below it are."""
        if part in self._below:
            return self._below[part] == 0
        return part not in self._unreachable
