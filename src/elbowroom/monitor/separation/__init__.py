"""How far the machine has to be from what it may hit, and how far it is: reaction time measured, margins each pass."""
