# SPDX-License-Identifier: MIT
"""Words of names, in letters that are folded: object_words.bin (docs/file_format.md, section 9.1)."""

from __future__ import annotations

import re
from typing import Callable, NamedTuple, Optional, Sequence

_MOST_LETTERS = 32
_RUNNING, _UNSPACED = 1, 2
_LAST_CODE_POINT = 0x10FFFF


class AskedWord(NamedTuple):
    """A word that someone looks for; words that go on fit, too, where it is the beginning of one."""

    word: str
    is_beginning: bool


class _Range(NamedTuple):
    first: int
    last: int
    step: int
    is_running: bool
    to: str


def _hangul(point: int) -> str:
    """The letters of a syllable of Hangul (The Unicode Standard, section 3.12)."""
    syllable = point - 0xAC00
    final = syllable % 28
    return chr(0x1100 + syllable // 588) + chr(0x1161 + syllable // 28 % 21) + (chr(0x11A7 + final) if final else "")


class Letters:
    """What letters become, as a table says."""

    def __init__(self, text: str, fail: Callable[[str], Exception]) -> None:
        self._ranges: list[_Range] = []
        self._unspaced: list[_Range] = []
        for row in text.splitlines():
            try:
                first, count, step, kind, *to = (int(number, 16) for number in row.split(" "))
                letters = "".join(map(chr, to))
            except (ValueError, OverflowError):
                raise fail("a row of the table of letters is not as it must be") from None
            last = first + (count - 1) * step
            span = last - first if kind == _RUNNING else 0
            if min(first, count - 1, step - 1, kind) < 0 or max([last, *(point + span for point in to)]) > _LAST_CODE_POINT or kind > _UNSPACED or (kind == _RUNNING and len(to) != 1):
                raise fail("a row of the table of letters is not as it must be")
            ranges = self._unspaced if kind == _UNSPACED else self._ranges
            if ranges and first <= ranges[-1].last:
                raise fail("the table of letters does not ascend")
            ranges.append(_Range(first, last, step, kind == _RUNNING, letters))
        self._known: dict[str, str] = {}

    def words(self, name: str) -> list[str]:
        """The words of a name, some perhaps twice."""
        words: list[str] = []
        for is_unspaced, letters in self._runs(name):
            words += [letters[i : i + 2] for i in range(len(letters))] if is_unspaced else [letters[:_MOST_LETTERS]]
        return words

    def asked(self, text: str) -> list[AskedWord]:
        """The words that a name must have to be found; the last one may be the beginning of a word."""
        runs = self._runs(text)
        asked: list[AskedWord] = []
        for i, (is_unspaced, letters) in enumerate(runs):
            if not is_unspaced:
                asked.append(AskedWord(letters[:_MOST_LETTERS], i == len(runs) - 1))
            elif len(letters) == 1:
                asked.append(AskedWord(letters, True))
            else:
                asked += [AskedWord(letters[k : k + 2], False) for k in range(len(letters) - 1)]
        return asked

    def _runs(self, text: str) -> list[tuple[bool, str]]:
        runs: list[tuple[bool, str]] = []
        goes_on = False
        for letter in "".join(self._folded(each) for each in text):
            is_unspaced = _range_of(self._unspaced, ord(letter)) is not None
            if letter == " ":
                goes_on = False
            elif goes_on and runs[-1][0] == is_unspaced:
                runs[-1] = (is_unspaced, runs[-1][1] + letter)
            else:
                runs.append((is_unspaced, letter))
                goes_on = True
        return runs

    def _folded(self, letter: str) -> str:
        if letter not in self._known:
            self._known[letter] = self._fold(letter)
        return self._known[letter]

    def _fold(self, letter: str) -> str:
        point = ord(letter)
        if 0xAC00 <= point <= 0xD7A3:
            return _hangul(point)
        found = _range_of(self._ranges, point)
        if found is None or (point - found.first) % found.step:
            return letter
        return chr(ord(found.to) + point - found.first) if found.is_running else found.to


def _range_of(ranges: Sequence[_Range], point: int) -> Optional[_Range]:
    return next((each for each in ranges if each.first <= point <= each.last), None)


def fits(words: Sequence[str], asked: Sequence[AskedWord]) -> bool:
    """Whether a name of these words is found."""
    return all(any(word.startswith(wanted) if is_beginning else word == wanted for word in words) for wanted, is_beginning in asked)


def objects_of_row(name: str, text: str, fail: Callable[[str], Exception]) -> list[int]:
    """The objects of a row of the table of words."""
    if not re.fullmatch(r" [0-9a-f]{6}", name[-7:]):
        raise fail(f'the objects of the word "{name}" have no first one')
    objects, distance, shift = [int(name[-6:], 16)], 0, 0
    for letter in text:
        digit = ord(letter)
        if digit >= 128 or shift >= 24:
            raise fail(f'the objects of the word "{name}" have too long a number')
        distance |= digit % 64 << shift
        shift += 6
        if digit < 64:
            objects.append(objects[-1] + distance + 1)
            distance, shift = 0, 0
    if shift:
        raise fail(f'the objects of the word "{name}" have a number that does not end')
    return objects
