"""What was, so that it can be had again: undo and redo of layouts."""

from dataclasses import dataclass, field

from elbowroom.page.plan.layout import Layout

KEPT = 500
"""So many layouts are kept."""


@dataclass(slots=True, eq=False)
class History:
    """Layouts in the order in which they were made, and where one is in it.

    Args:
        now: the layout that holds.
    """

    now: Layout
    _before: list[Layout] = field(default_factory=list, init=False)
    _after: list[Layout] = field(default_factory=list, init=False)
    _held: str | None = field(default=None, init=False)

    def become(self, layout: Layout, during: str | None = None) -> None:
        """Another layout holds from now on; what was undone before is gone.

        Args:
            layout: the new one.
            during: what goes on, such as the drag of a camera: all of it is one step; None: it is a step by itself.
        """
        if during is None or during != self._held:
            self._before = [*self._before[-KEPT + 1 :], self.now]
        self.now, self._held = layout, during
        self._after.clear()

    def let_go(self) -> None:
        """What went on has ended: what comes next is another step, whatever it is called."""
        self._held = None

    @property
    def can_undo(self) -> bool:
        """Whether anything came before."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether anything was undone."""
        return bool(self._after)

    def undo(self) -> Layout:
        """The layout before this one, which holds from now on; this one if there is none."""
        if self._before:
            self._after.append(self.now)
            self.now = self._before.pop()
        self._held = None
        return self.now

    def redo(self) -> Layout:
        """The layout that was undone last; this one if there is none."""
        if self._after:
            self._before.append(self.now)
            self.now = self._after.pop()
        self._held = None
        return self.now
