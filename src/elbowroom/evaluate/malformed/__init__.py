"""Whether anything that comes from outside crashes, hangs or takes memory that a number in it asks for."""
