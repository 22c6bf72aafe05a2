# SPDX-License-Identifier: MIT
"""The kd-tree, which follows from its number of partitions (docs/file_format.md, section 1)."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Callable, Iterator, NamedTuple, Sequence, Union

from .asked import whole
from .errors import UsageError


class Node(NamedTuple):
    """A node of the tree: its level from the root (0) down, and its number from left to right."""

    level: int
    index: int  # type: ignore[assignment]  # tuples have a method of that name

    def __str__(self) -> str:
        return f"{self.level}/{self.index}"


NodeLike = Union[Node, Sequence[int], str]
"""What names a node: a Node, (level, index), or "LEVEL/INDEX" as the program writes it."""


def as_node(value: NodeLike) -> Node:
    """The node of that name, whether a tree has it or not. Raises UsageError for what is no name."""
    refusal = 'a node is (level, index), "LEVEL/INDEX" or a Node, of whole numbers from 0 up'
    if isinstance(value, str):
        if not re.fullmatch(r"[0-9]{1,2}/[0-9]{1,10}", value):
            raise UsageError(f"{refusal}, not {value!r}")
        value = [int(number) for number in value.split("/")]
    try:
        level, index = value
    except (TypeError, ValueError):
        raise UsageError(f"{refusal}, not {value!r}") from None
    node = Node(whole(level, refusal), whole(index, refusal))
    if min(node) < 0:
        raise UsageError(f"{refusal}, not {node}")
    return node


class Tree:
    """The nodes of a hierarchy of `partitions` partitions. Its functions raise UsageError for a node that is not in it."""

    def __init__(self, partitions: int) -> None:
        self.partitions = partitions
        self.depth: int = (partitions - 1).bit_length()

    def node(self, name: NodeLike) -> Node:
        """The node of that name."""
        node = as_node(name)
        most = self.partitions if node.level == self.depth else 2**node.level
        if node.level > self.depth or node.index >= most:
            raise UsageError(f"there is no node {node}; " + (f"level {node.level} has 0 to {most - 1}" if node.level <= self.depth else f"the last level is {self.depth}"))
        return node

    def range(self, node: NodeLike) -> tuple[int, int]:
        """The partitions [first, end) of a node."""
        level, index = self.node(node)
        if level == self.depth:
            return index, index + 1
        first, end, _ = _walk(self.partitions, level, lambda at, _: index >> (level - 1 - at) & 1 == 1)
        return first, end

    def is_early(self, node: NodeLike) -> bool:
        """Whether the node holds one partition above the last level, and so has no tile."""
        node = self.node(node)
        first, end = self.range(node)
        return node.level < self.depth and end - first == 1

    def tile(self, node: NodeLike) -> Node:
        """The node whose tile stands for `node`: itself, or the partition of an early one."""
        node = self.node(node)
        return Node(self.depth, self.range(node)[0]) if self.is_early(node) else node

    def ancestor(self, node: NodeLike, level: int) -> Node:
        """The node of `level` that holds `node`."""
        node = self.node(node)
        if not 0 <= whole(level, "a level is a whole number") <= node.level:
            raise UsageError(f"node {node} has ancestors on the levels 0 to {node.level}, not on {level}")
        if level == node.level:
            return node
        if node.level < self.depth:
            return Node(level, node.index >> (node.level - level))
        return Node(level, _path(self.partitions, self.depth, node.index) >> (self.depth - level))

    def children(self, node: NodeLike) -> list[Node]:
        """The nodes below that have tiles: two, or none of a partition."""
        node = self.node(node)
        if node.level == self.depth:
            return []
        if node.level == self.depth - 1:
            first, end = self.range(node)
            return [Node(self.depth, p) for p in range(first, end)]
        return [self.tile(Node(node.level + 1, 2 * node.index + k)) for k in (0, 1)]

    def level(self, level: int) -> list[Node]:
        """The nodes with tiles that show the whole model at a level: early ones as their partitions."""
        if not 0 <= whole(level, "a level is a whole number") <= self.depth:
            raise UsageError(f"there is no level {level}; the last one is {self.depth}")
        if level == self.depth:
            return [Node(level, p) for p in range(self.partitions)]
        return [self.tile(Node(level, index)) for index in range(2**level)]

    def tiles(self) -> Iterator[Node]:
        """All nodes with tiles, in the order of the index."""
        for level in range(self.depth):
            for index in range(2**level):
                if not self.is_early(Node(level, index)):
                    yield Node(level, index)
        for partition in range(self.partitions):
            yield Node(self.depth, partition)

    def common_level(self, one: NodeLike, other: NodeLike) -> int:
        """The level of the deepest node that holds both, which are on one level."""
        one, other = self.node(one), self.node(other)
        if one.level != other.level:
            raise UsageError(f"{one} and {other} are on two levels")
        level = one.level
        while self.ancestor(one, level) != self.ancestor(other, level):
            level -= 1
        return level


def _walk(partitions: int, levels: int, is_right: Callable[[int, int], bool]) -> tuple[int, int, int]:
    """Goes down from the root: the partitions [first, end) that are left, and which halves were taken, a bit each.

    `is_right(level, middle)` says whether to take the half from `middle` on.
    """
    first, end, path = 0, partitions, 0
    for level in range(levels):
        middle = first + (end - first + 1) // 2
        right = is_right(level, middle)
        first, end, path = (middle, end, 2 * path + 1) if right else (first, middle, 2 * path)
    return first, end, path


@lru_cache(maxsize=1 << 16)
def _path(partitions: int, depth: int, partition: int) -> int:
    """Which halves lead to a partition; below an early node: the left one."""
    return _walk(partitions, depth, lambda _, middle: partition >= middle)[2]
