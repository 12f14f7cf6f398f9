"""What the page says of a moment, as text: the same for a run, for a recording and for a report."""

from elbowroom.page.story.headline import headline
from elbowroom.page.story.motions import motion_rows
from elbowroom.page.story.told import told_of, told_of_recorded
from elbowroom.page.story.why_text import why_text

__all__ = ["headline", "motion_rows", "told_of", "told_of_recorded", "why_text"]
