"""All words of the page, a table a language. A table that lacks a word of the first one does not load."""

from elbowroom.page.words.table import LANGUAGES, Words, words_of

__all__ = ["LANGUAGES", "Words", "words_of"]
